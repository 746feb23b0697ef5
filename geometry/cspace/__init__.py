"""Motion planning in the configuration space of a polygon: place and angle, among polygons.

Modules in reading order:

    plan_motion       the entry: find a certified motion or prove that there is none
    solver            one planning problem: rounds of search until an answer
    rounds            one round: find a channel, follow it, split what is to blame
    cell_tree         subdivision of the configuration space into cells
    search_tree       the paths of a search, of which a part is cut off quickly
    channel           search for a chain of cells from the start to the goal
    refine            follow a channel hop by hop, split cells where a hop fails
    local_planner     one hop between two poses, certified by exact first contact
    smoothing         shorten a path of hops, write it as motions
    fewest_motions    reduce the number of motions of a path
    disc_bounds       decide by inscribed and enclosing discs what is too small for cells
    bottleneck        the passage that is too narrow, and by how much

Public names: ``plan_motion``, ``MotionPlan``, ``Inside`` (plan_motion); ``Bottleneck`` (bottleneck);
``fewest_motions`` (fewest_motions).
"""
