"""Routes: topologically distinct shortest paths over a screen, by the pathgraph.

Modules, in reading order:

route  A route: a tight path and its homotopy class.
layer  A layer: pathgraph, strips and landmarks.
astar  A* over the pathgraph, and exact distances to the goal.
k_shortest  The k shortest paths over the pathgraph (Yen 1971, Lawler 1972).
router  The kernel: start and goal anchored, paths found, each pulled tight.
lifting  From a word to its path over the skeleton: its chains and its clearance.
queries  All queries about one layer, and their scratch.

Public names: `Route`, `Layer`, `LayerQueries`.
"""
