"""What is believed of the necks of the floor: how surely they are open, and bounded by verge on both ends."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry import Passage, Screen
from geometry.raster.components import components
from kb.perception.protrusions import VERGE
from kb.perception.regions import extents
from kb.world.model import SMALLEST_WALL, WorldModel

Mask = NDArray[np.bool_]
Floats = NDArray[np.float64]
Indices = tuple[NDArray[np.int64], NDArray[np.int64]]
Segment = tuple[tuple[float, float], tuple[float, float]]
LIKELY = 0.75  # that squares are occupied which are taken for parts of one thing
ANYWHERE = 2 * math.sqrt(2)  # squares: by so much a neck may be wider whose walls end anywhere in two squares
BEHIND = 10  # squares that the floor is supposed to go on where it is not seen
OPENING = 1.25  # times as wide as a neck is the floor on both sides of it at least, where that is worth naming
HAIR = 1e-6
UNCLEAR = 2.0  # squares by which it may be unclear on either side how wide a door is


class DoorwayNeck(NamedTuple):
    """A neck of the floor in the frame of the view's arrays.

    line : where it was seen best, from wall to wall. certainty : percent of belief that it is open and that verge
    bounds it on both ends.
    """

    passage: Passage
    line: Segment
    certainty: int


class DoorwayNecks(NamedTuple):
    """The necks of a floor, and that floor: in a frame of BEHIND squares, and what was never seen counts as floor."""

    necks: list[DoorwayNeck]
    screen: Screen

    def narrow(self, neck: DoorwayNeck) -> Mask:
        """(rows, columns): the squares where the neck itself may be, if its walls lie anywhere in their squares."""
        mask = np.zeros(self.screen.shape, np.bool_)
        for column, row in self.screen.narrows(neck.passage.shifted(BEHIND, BEHIND), ANYWHERE):
            mask[row, column] = True
        return mask[BEHIND:-BEHIND, BEHIND:-BEHIND]


def find_necks(model: WorldModel, verge: Mask, doubtful: Mask) -> DoorwayNecks:
    """All necks of the floor, those first that have floor twice as wide on both sides.

    verge : (rows, columns) what bounds the floor; doubtful : what may, but rather does not.
    """
    walls, seen_verge = _walls(model), verge & model.view.seen
    screen = Screen(np.pad(~verge, BEHIND, constant_values=True))
    found = []
    for passage in _passages(screen):
        lines = list(dict.fromkeys([(passage.a, passage.b), *passage.mouths]))
        known = [
            (_known(passage, line, across, model, seen_verge, doubtful, walls), -number)
            for number, line in enumerate(lines)
            for across in _along(passage, line, verge.shape)
        ]
        certainty, number = max(known)
        found.append(DoorwayNeck(passage, lines[-number], certainty))
    return DoorwayNecks(found, screen)


def _passages(screen: Screen) -> list[Passage]:
    """The necks within the frame of a screen, in the frame of the view; those at its edge too: it may go on behind."""
    doors = screen.passages()
    mouths = {frozenset(mouth) for passage in doors for mouth in passage.mouths}
    others = [p for p in screen.passages(OPENING) if not any(frozenset(mouth) in mouths for mouth in p.mouths)]
    height, width = (size - 2 * BEHIND for size in screen.shape)

    def within(passage: Passage) -> bool:
        ends = [point for mouth in passage.mouths for point in mouth]
        return all(0 < x < width and 0 < y < height for x, y in ends)

    return [p for p in (passage.shifted(-BEHIND, -BEHIND) for passage in (*doors, *others)) if within(p)]


def _along(passage: Passage, line: Segment, shape: tuple[int, ...]) -> list[Indices]:
    """The squares along a line through a passage, twice a square: on one side of it and on the other.

    Of a mouth those alone that lie in the doorway, where it has some depth.
    """
    (ax, ay), (bx, by) = line
    one, two = passage.mouths
    sides = (1,) if line == one != two else (-1,) if line == two != one else (-1, 1)
    hairs = [side * HAIR * np.array([ay - by, bx - ax]) for side in sides]
    parts = _parts(line)
    return [_squares(ax + x + (bx - ax) * parts, ay + y + (by - ay) * parts, shape) for x, y in hairs]


def _parts(line: Segment) -> Floats:
    """Where on a line it is looked at, as parts of its length."""
    count = max(2, round(2 * math.dist(*line)))
    parts: Floats = (np.arange(count) + 0.5) / count
    return parts


class _Walls(NamedTuple):
    """What is very likely one thing: (rows, columns) labels, 0 for none, and by label how long it is, in squares.

    What was felt to be verge counts for as long as a wall is at least.
    """

    labels: NDArray[np.int32]
    extents: NDArray[np.int64]


def _walls(model: WorldModel) -> _Walls:
    found = components(model.view.seen & (model.view.probability >= LIKELY))
    long = extents(found.labels, found.number)
    height, width = found.labels.shape
    for row, column in (model.view.locate(*square) for square, colour in model.felt.items() if colour == VERGE):
        label = found.labels[row, column] if 0 <= row < height and 0 <= column < width else 0
        if label:  # verge, however short it is
            long[label] = max(long[label], SMALLEST_WALL)
    return _Walls(found.labels, long)


def _known(
    passage: Passage,
    line: Segment,
    across: Indices,
    model: WorldModel,
    verge: Mask,
    doubtful: Mask,
    walls: _Walls,
) -> int:
    """Percent of belief that a neck is open along a line from wall to wall and that its walls are verge.

    Just how wide it is need not be clear: the squares beside its walls tell that, but not whether it is a door.

    across : the squares along the line. verge : (rows, columns) what bounds the floor; doubtful : what may, but rather
    does not.
    """
    parts = _parts(line)
    inner = np.minimum(parts, 1 - parts) * passage.width >= min(UNCLEAR, passage.width / 4) - 1e-9
    if not (model.view.seen[across] & ~verge[across] & ~(doubtful[across] & inner)).all():
        return 0
    jambs = [jamb(verge, end) for end in line]
    if not all(len(rows) for rows, _ in jambs):
        return 0
    walled = min(int(walls.extents[walls.labels[jamb]].max()) for jamb in jambs)
    if walled < SMALLEST_WALL:
        return min(50, round(50 * walled / SMALLEST_WALL))
    middle = np.add(*line) / 2
    spare = (min(passage.sides) - passage.width) / 2  # squares: as much wider on both sides it still were a door
    told = verge & model.told
    shares = [
        _share_told(jamb, np.subtract(end, middle), min(UNCLEAR, spare), told)
        for end, jamb in zip(line, jambs, strict=True)
    ]
    return round(50 + 50 * min(float(model.told[across][inner].mean()), *shares))


def _share_told(jamb: Indices, outward: Floats, furthest: float, told: Mask) -> float:
    """How much of a jamb is surely wall, or of what lies behind it, at most so many squares further outward."""
    ahead = outward / max(float(np.hypot(*outward)), 1e-9)
    shares = []
    for deeper in range(max(math.floor(furthest), 0) + 1):
        dx, dy = np.rint(ahead * deeper).astype(int)
        rows, columns = np.clip(jamb[0] + dy, 0, told.shape[0] - 1), np.clip(jamb[1] + dx, 0, told.shape[1] - 1)
        shares.append(float(told[rows, columns].mean()))
    return max(shares)


def jamb(wall: Mask, end: tuple[float, float]) -> Indices:
    """The squares of a wall that an end of a neck touches, as rows and columns."""
    columns, rows = (sorted({math.floor(v - 0.5), math.floor(v + 0.5)}) for v in end)
    touched = [
        (row, column)
        for row in rows
        for column in columns
        if 0 <= row < wall.shape[0] and 0 <= column < wall.shape[1] and wall[row, column]
    ]
    pairs = np.array(touched, np.int64).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def _squares(x: Floats, y: Floats, shape: tuple[int, ...]) -> Indices:
    rows = np.clip(np.floor(y).astype(int), 0, shape[0] - 1)
    return rows, np.clip(np.floor(x).astype(int), 0, shape[1] - 1)
