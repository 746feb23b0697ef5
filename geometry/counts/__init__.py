"""Counts of occupied squares under overlapping fields: what they settle, what contradicts them, what agrees with them.

Modules, in reading order:

retina  The plan of the retina: its fields, and the gray levels of counts.
settle  Squares that the counts settle as free or occupied.
contradictions  Squares and fields of several observations that contradict each other.
uncover  Squares that an object covers, taken out of the fields of an observation.
gibbs  Gibbs sampling of simple rasters that agree with counts (Geman and Geman 1984).
moments  The connected parts of a raster, and their moments.

Public names: `settle`, `remaining_counts`, `misfits`, `total_contradictions`, `remove_covered_squares`, `Counts`,
`pictures`, `costs`, `Blobs`, `blobs`.
"""
