"""Small changes of a screen: what depends on the changed squares is computed anew, and the rest stays.

In reading order:

    update           a change of squares, from the clearance to the pathgraph: change_squares
    affected_region  the cells whose clearance a change can alter
    update_distance  clearances measured anew in a part of a block
    update_skeleton  ascents taken back and climbed again where clearances differ
    update_graph     nodes and chains of the skeleton's graph that a change meets
    splice_arrays    new nodes and chains put into the arrays of the old ones

Reached through ``geometry.Screen.changed``.
"""
