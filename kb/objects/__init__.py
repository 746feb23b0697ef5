"""Objects: what is believed of their shape and extent, and of where an object lies that the robot has held.

Modules in reading order:

subcell_extent  how far the sides of an object lie within the squares in which it was seen
shape_fit       the shape classes that fit the squares of a patch, measured by geometry
parts           the parts of an outline, such as the legs of an L
proportions     whether a rectangle is a square or a brick, as far as its extent is known
held_object     an object that the robot has held: its outline, its place, and how exactly both are known
movability      whether things can be moved, decided by kb/asp/movable.lp
persistence     how likely things out of sight still lie where they lay, by kb/asp/persistence.lp
touches         the colours that were felt, square by square

Public names: `SubcellExtent`, `SideValues` (subcell_extent); `ShapeMeasurement`, `measure_seen`, `measure_whole`
(shape_fit); `possible_rectangle_shapes`, `corrected_shape` (proportions); `HeldObject` (held_object); `movabilities`,
`Movability`, `MotionHistory` (movability); `persistences`, `Persistence`, `ChangesByOthers` (persistence);
`Touches` (touches).
"""
