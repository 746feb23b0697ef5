"""The kinds of this package by name."""

from benchmarks.worlds.odd.kinds import OddWorldMaker
from benchmarks.worlds.seams import crowded, described, doors, enclosed, headings, references, walls

SEAM_KINDS: dict[str, OddWorldMaker] = {
    walls.THING_WALL_KIND: walls.thing_wall,
    walls.PART_GAP_KIND: walls.part_gap,
    references.REFERENCE_KIND: references.world,
    doors.TWO_DOORS_KIND: doors.two_doors,
    doors.DOOR_RULE_KIND: doors.door_rule,
    described.DESCRIBED_KIND: described.world,
    enclosed.ENCLOSED_KIND: enclosed.enclosed,
    enclosed.LEANING_KIND: enclosed.leaning,
    crowded.PACKED_KIND: crowded.world,
    headings.HEADING_KIND: headings.world,
}
