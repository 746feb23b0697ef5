"""Skills: small procedures that give commands where no plan does.

into_corner    the robot halts beside the walls of a corner, and presses on where they lie askew
press          a held object is pressed against walls, to be sure that it is in their corner
take_along     a held object is taken along to where the robot wants to look
unjam          an object that stands against something is drawn back and aside
failed_grasps  grasps by which an object did not move, and that are not tried again
measure_size   active size estimation: pushes by parts of a square
measure_gap    the robot walks against both sides of a passage, to tell how wide it is
try_passage    an object is pushed through a passage whose walls may lie further back than the squares show

Public names: IntoCorner, Presser, FailedGrasps, SizeEstimator.
"""
