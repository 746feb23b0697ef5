"""Necks of the floor, and how certain it is that each is a doorway: open, and bounded by verge on both ends.

A neck is a locally narrowest passage of the floor (geometry.Screen.passages). It is sought on a raster in which all
that was never seen counts as free, so that a doorway is found by its two jambs before the room behind it was seen.

The view frame is the one of the map view's arrays: x to the east, y to the north, in squares, origin at the south-west
corner of the view's square [0, 0].
"""

import math
from typing import NamedTuple

import numpy as np

from utak.geometry import Passage, Screen
from utak.geometry.kernels.arrays import XY, Bools, Floats, Labels, Longs
from utak.geometry.passages.necks import Segment
from utak.geometry.raster.components import components
from utak.kb.perception.protrusions import VERGE_TOUCH_COLOUR
from utak.kb.perception.regions import extents
from utak.kb.reasoning.encodings import KB_ENCODINGS, encoding_constant
from utak.kb.world.model import WorldModel

Indices = tuple[Longs, Longs]  # the rows and the columns of some squares
ENCODED_DOOR_RATIO = float(
    encoding_constant(KB_ENCODINGS / "rooms.lp", "door_ratio")
)  # as many times as wide is the floor beside a door
SHORTEST_WALL = encoding_constant(KB_ENCODINGS / "rooms.lp", "shortest_wall")  # squares: what is so long is a wall
JAMB_PROBABILITY = 0.75  # squares occupied with at least this probability are taken for parts of one thing; tuned
WIDTH_UNCERTAINTY = 2 * math.sqrt(2)  # squares: a neck is so much wider at most if its walls end anywhere in 2 squares
NECK_UNSEEN_MARGIN = 10  # squares: free border laid about the map, since the floor may go on there; convention
MIN_OPENING_RATIO = 1.25  # a neck is reported when the floor is so many times as wide on both sides; convention
SIDEWAYS_STEP = 1e-6  # of a neck's width: how far beside its line the squares on both sides of the line are looked up
MAX_UNWALLED = 50  # percent of belief in a neck that something shorter than a wall bounds, at most; a convention
UNCLEAR_EDGE = 2.0  # squares: on either side of a neck so much of its width may be unclear; tuned


class DoorwayNeck(NamedTuple):
    """A neck of the floor."""

    # The neck as geometry found it, in squares, view frame (origin at the south-west corner of the map view's square
    # [0, 0]): its width, mouths, and the clearance on both sides
    passage: Passage
    # The line across it, two points (x, y) on the walls, where it was seen best; in squares, view frame. The first is
    # the end on the left of a robot that goes from the neck's first side to its second.
    line: Segment
    certainty: int  # Percent of belief that it is open along that line and that verge bounds it on both ends


class DoorwayNecks(NamedTuple):
    """The necks of a floor."""

    # The necks in the view frame, those first that have floor ENCODED_DOOR_RATIO times as wide on both sides
    necks: list[DoorwayNeck]
    # The floor on which they were found: the view with NECK_UNSEEN_MARGIN free squares about it, so that its origin
    # lies that many squares further west and south than that of the view frame
    screen: Screen

    def narrow(self, neck: DoorwayNeck) -> Bools:
        """Return the squares where the narrowest line of a neck may be, wherever in their squares its walls end."""
        mask = np.zeros(self.screen.shape, np.bool_)
        for column, row in self.screen.narrows(
            neck.passage.shifted(NECK_UNSEEN_MARGIN, NECK_UNSEEN_MARGIN), WIDTH_UNCERTAINTY
        ):
            mask[row, column] = True
        return mask[NECK_UNSEEN_MARGIN:-NECK_UNSEEN_MARGIN, NECK_UNSEEN_MARGIN:-NECK_UNSEEN_MARGIN]


def find_necks(model: WorldModel, verge: Bools, doubtful: Bools) -> DoorwayNecks:
    """Find all necks of the floor, those first that have floor ENCODED_DOOR_RATIO times as wide on both sides."""
    walls, seen_verge = _wall_parts(model), verge & model.view.seen
    screen = Screen(np.pad(~verge, NECK_UNSEEN_MARGIN, constant_values=True))
    found = []
    for passage in _passages(screen):
        lines = list(dict.fromkeys([(passage.a, passage.b), *passage.mouths]))
        known = [
            (_certainty(passage, line, across, model, seen_verge, doubtful, walls), -number)
            for number, line in enumerate(lines)
            for across in _squares_along(passage, line, verge.shape)
        ]
        certainty, number = max(known)
        found.append(DoorwayNeck(passage, lines[-number], certainty))
    return DoorwayNecks(found, screen)


def necks_of(screen: Screen) -> list[Passage]:
    """Return the necks of a floor, those first that have floor ENCODED_DOOR_RATIO times as wide on both sides."""
    doors = screen.passages(ENCODED_DOOR_RATIO)
    mouths = {frozenset(mouth) for passage in doors for mouth in passage.mouths}
    others = screen.passages(MIN_OPENING_RATIO)
    return [*doors, *(p for p in others if not any(frozenset(m) in mouths for m in p.mouths))]


def _passages(screen: Screen) -> list[Passage]:
    """Return the necks whose ends lie within the view, in the view frame; `screen` has the margin about it."""
    height, width = (size - 2 * NECK_UNSEEN_MARGIN for size in screen.shape)

    def within(passage: Passage) -> bool:
        """Return whether all ends of a passage's mouths lie inside the view, not on its edge; view frame."""
        ends = [point for mouth in passage.mouths for point in mouth]
        return all(0 < x < width and 0 < y < height for x, y in ends)

    moved = (passage.shifted(-NECK_UNSEEN_MARGIN, -NECK_UNSEEN_MARGIN) for passage in necks_of(screen))
    return [passage for passage in moved if within(passage)]


def _squares_along(passage: Passage, line: Segment, shape: tuple[int, ...]) -> list[Indices]:
    """Return the squares along a line across a passage, at two samples a square."""
    (ax, ay), (bx, by) = line
    one, two = passage.mouths
    sides = (1,) if line == one != two else (-1,) if line == two != one else (-1, 1)
    steps = [side * SIDEWAYS_STEP * np.array([ay - by, bx - ax]) for side in sides]
    parts = _sample_positions(line)
    return [_indices(ax + x + (bx - ax) * parts, ay + y + (by - ay) * parts, shape) for x, y in steps]


def _sample_positions(line: Segment) -> Floats:
    """Return the positions on a line at which squares are looked up, as fractions of its length."""
    count = max(2, round(2 * math.dist(*line)))
    parts: Floats = (np.arange(count) + 0.5) / count
    return parts


class _WallParts(NamedTuple):
    """Connected parts of what is probably occupied."""

    labels: Labels  # The number of each square's part, 0 for none, on the view's arrays
    # Index n: the longer side of the containing rectangle of part n, in squares. A part that was felt to be verge
    # counts as at least as long as the shortest wall.
    extents: Longs


def _wall_parts(model: WorldModel) -> _WallParts:
    """Return the edge-connected parts of what is probably occupied, on the view's arrays."""
    found = components(model.view.seen & (model.view.probability >= JAMB_PROBABILITY))
    longer = extents(found.labels, found.number)
    height, width = found.labels.shape
    for row, column in (
        model.view.locate(*square) for square, colour in model.felt.items() if colour == VERGE_TOUCH_COLOUR
    ):
        label = found.labels[row, column] if 0 <= row < height and 0 <= column < width else 0
        if label:  # verge, however short it is
            longer[label] = max(longer[label], SHORTEST_WALL)
    return _WallParts(found.labels, longer)


def _certainty(
    passage: Passage,
    line: Segment,
    across: Indices,
    model: WorldModel,
    verge: Bools,
    doubtful: Bools,
    walls: _WallParts,
) -> int:
    """Return the percent of belief that a neck is open along a line and that verge bounds it on both ends."""
    # The exact width need not be clear: squares beside the walls tell the width, but not whether it is a door. 0 when a
    # square along the line is unseen or occupied, or an end touches no verge; up to 50 when what stands at an end is
    # shorter than the shortest wall; from 50 to 100 by how much of the line and of its ends is determined.
    parts = _sample_positions(line)
    inner = np.minimum(parts, 1 - parts) * passage.width >= min(UNCLEAR_EDGE, passage.width / 4) - 1e-9
    if not (model.view.seen[across] & ~verge[across] & ~(doubtful[across] & inner)).all():
        return 0
    jambs = [jamb(verge, end) for end in line]
    if not all(len(rows) for rows, _ in jambs):
        return 0
    walled = min(int(walls.extents[walls.labels[jamb]].max()) for jamb in jambs)
    if walled < SHORTEST_WALL:
        return min(MAX_UNWALLED, round(MAX_UNWALLED * walled / SHORTEST_WALL))
    middle = np.add(*line) / 2
    spare = (
        2 * min(passage.sides) / ENCODED_DOOR_RATIO - passage.width
    ) / 2  # squares: wider by so much on both ends, still a door
    surely_wall = verge & model.told
    shares = [
        _share_determined(jamb, np.subtract(end, middle), min(UNCLEAR_EDGE, spare), surely_wall)
        for end, jamb in zip(line, jambs, strict=True)
    ]
    return round(MAX_UNWALLED + (100 - MAX_UNWALLED) * min(float(model.told[across][inner].mean()), *shares))


def _share_determined(jamb: Indices, outward: Floats, furthest: float, surely_wall: Bools) -> float:
    """Return the share of a jamb's squares that are surely wall, 0 to 1."""
    ahead = outward / max(float(np.hypot(*outward)), 1e-9)
    shares = []
    for deeper in range(max(math.floor(furthest), 0) + 1):
        dx, dy = np.rint(ahead * deeper).astype(int)
        rows, columns = (
            np.clip(jamb[0] + dy, 0, surely_wall.shape[0] - 1),
            np.clip(jamb[1] + dx, 0, surely_wall.shape[1] - 1),
        )
        shares.append(float(surely_wall[rows, columns].mean()))
    return max(shares)


def jamb(wall: Bools, end: XY) -> Indices:
    """Return the squares of a wall that one end of a neck touches."""
    columns, rows = (sorted({math.floor(v - 0.5), math.floor(v + 0.5)}) for v in end)
    touched = [
        (row, column)
        for row in rows
        for column in columns
        if 0 <= row < wall.shape[0] and 0 <= column < wall.shape[1] and wall[row, column]
    ]
    pairs = np.array(touched, np.int64).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def _indices(x: Floats, y: Floats, shape: tuple[int, ...]) -> Indices:
    """Return the squares in which points lie: rows and columns, clipped to an array of shape (rows, columns)."""
    rows = np.clip(np.floor(y).astype(int), 0, shape[0] - 1)
    return rows, np.clip(np.floor(x).astype(int), 0, shape[1] - 1)
