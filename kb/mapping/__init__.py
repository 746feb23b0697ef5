"""Mapping: which squares are occupied, from the counts under the fields of all impressions.

Modules in reading order:

occupancy        the map: counts of overlapping fields, solved as far as they settle squares, and the view of it
occupancy_odds   the probability that an open square is occupied, by counts alone
patch            a set of squares, and where it lies
completions      sampled maps that agree with all counts
object_heat      what the completions have in common: probabilities, and where an object of a shape may be
obstacle_chance  the probability that something stands on the squares that a motion enters

Public names: `OccupancyMap`, `MapView`, `FREE`, `OCCUPIED`, `OPEN` (occupancy); `Patch`, `patch_of`,
`patch_of_polygon` (patch);
`Completions` (completions); `CompletionSummary` (object_heat); `ObstacleChance` (obstacle_chance).
"""
