"""Files of geometry: maps to read, and pictures to write.

Modules, in reading order:

movingai  Maps of the Moving AI benchmarks (Sturtevant 2012).
svg  A screen drawn as SVG, with skeleton, pathgraph and routes.

Public names: `parse_map`, `MapError`, `draw`.
"""
