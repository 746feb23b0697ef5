"""Passages: the necks of free space, the walls that form them, and the parts between them.

Modules, in reading order:

walls  The floor as a Delaunay triangulation of wall corners, and the widths that follow.
necks  Passages: necks of the floor, with the width of the floor on either side.
partition  Parts of the floor: what stays connected when it is cut along passages.
narrow_stretches  How far the floor stays narrow about a passage.

Public names: `Walls`, `find_walls`, `Passage`, `find_passages`, `find_parts`, `narrow_squares`.
"""
