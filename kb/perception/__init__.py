"""Perception: from the retina's gray levels and touches to regions, and to what each region is.

Modules in reading order:

retina          the counts of occupied squares that a gray level stands for
frame           the frame of the grid of squares: orientation and origin, and the squares that each field samples
regions         regions of free and of occupied cells or squares, and which surrounds which
interpretation  what each region is (floor, verge, object), and which shape an object has, decided in ASP
protrusions     parts of the bounds of the floor that stick out into it, and may be things that touch a wall
seams           where one thing ends and another begins in a region, by the colours felt on it

Public names: `Frame`, `Samples` (frame); `count_ranges` (retina); `Percept`, `Region`, `map_regions`
(regions); `Kinds`, `interpret_regions`, `classify_shapes` (interpretation).
"""
