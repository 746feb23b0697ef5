"""Rigid motion in the plane: what moves, what stands in the way, and where exactly a motion is stopped.

Modules in reading order:

    se2               poses, translations and rotations as frozen values
    first_contact     exact first contact of a moving body with polygons
    time_of_impact    the kernels of first contact: times at which corners meet edges
    validation        checks of numbers and polygons that callers hand in
    body              a body made ready to be moved: edges about its centre, inscribed discs
    cell_clearance    distance between body and obstacles, and the classification of cells of poses
    obstacle_field    obstacles and bounds prepared once for many motions

Public names: ``Pose``, ``Translate``, ``Rotate``, ``Motion`` (se2); ``ContactBody``, ``Obstacles``
(first_contact); ``ObstacleField`` (obstacle_field).
"""
