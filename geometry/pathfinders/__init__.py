"""Shortest paths over free squares by other methods than the pathgraph, for use and for comparison.

Modules, in reading order:

polyanya  The shortest path of all at any angle (Cui, Harabor and Grastien 2017), on strips.
visibility_graph  A* along straight lines between extreme points, as Shakey's (Nilsson 1984).
grid_astar  A* on the eight-connected grid (Hart, Nilsson and Raphael 1968).

Public names: `shortest_line`, `visibility_way`, `extreme_points`, `line_open`, `grid_way`.
"""
