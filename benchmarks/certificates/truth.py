"""Whether what a certificate claims of a recorded walk holds on the true table, and is among what the rules allow."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import shapely

from benchmarks.certificates.recorded import SLACK, RecordedWalk
from utak.geometry.counts.retina import FIELDS
from utak.simulator.certificates.checker import OF_COLOURS, OWN_NAME, goal_of
from utak.simulator.certificates.courses import TOUCH_NAMES, Course, Evidence, RefusedError, Spots, waking_case
from utak.simulator.certificates.search import settle_all
from utak.simulator.world.table import Table, project


def is_given(walk: RecordedWalk, given: Sequence[str], cases: Sequence[Sequence[Any]] = ()) -> bool:
    """Return whether what is given is so; that verge lies nowhere within floor is so in all drawn worlds."""
    colours = [thing.colour for thing in walk.world.movable]
    if "single(colours)" in given and len(set(colours)) < len(colours):
        return False
    if "parted(rooms)" in given and not walk.rooms.are_parted:
        return False
    outlines = [walk.world.verge, *walk.things[0].values()]
    if "along(grid)" in given and walk.world.heading % 90 != 0:
        return False
    if "whole(squares)" in given:
        for outline in outlines:
            if abs(outline.area - project(outline).covered.sum()) > SLACK:
                return False
    if "verge(walls)" in given and not any(_has_walls(walk, door) for door in _true_doors(walk, cases)):
        return False
    parts = [_covered(walk, name, 0) for name in walk.things[0]] if "apart(things)" in given else []
    pairs = itertools.combinations(parts, 2)
    return not any(
        abs(i - a) + abs(j - b) <= 1 for one, other in pairs for (i, j), (a, b) in itertools.product(one, other)
    )


def _true_doors(walk: RecordedWalk, cases: Sequence[Sequence[Any]]) -> Iterator[Sequence[int]]:
    """Yield the doors that the cases name in which the grid lies as it does."""
    angle = 0
    for word, *args in cases:
        angle = args[0] if word == "angle" else angle
        if word == "holds" and angle == walk.world.heading % 90:
            yield args[0]


def _has_walls(walk: RecordedWalk, door: Sequence[int]) -> bool:
    """Return whether verge covers all of the squares on both sides of a door, along the rows or along the columns."""
    found = []
    for order in ((0, 1, 2, 3), (1, 0, 3, 2)):
        w, s, e, n = (door[k] for k in order)
        pairs = [[((i, j)[:: 1 if order[0] == 0 else -1]) for j in (s - 1, n + 1)] for i in range(w, e + 1)]
        walled = [all(_is_verge(walk, at) for at in pair) for pair in pairs]
        found.append(any(walled) and walled.count(False) < 2 * (n - s + 1))
    return any(found)


def _is_verge(walk: RecordedWalk, at: tuple[int, int]) -> bool:
    """Return whether verge covers all of a square of the map frame."""
    x, y = at
    for _ in range(walk.world.heading // 90 % 4):
        x, y = -y, x
    i, j = _square(walk.places[0])
    square = shapely.box(i + x, j + y, i + x + 1, j + y + 1)
    table = shapely.box(0, 0, walk.world.width, walk.world.height)
    return bool((square & table).difference(walk.world.verge).area < SLACK)


def _is_in_next_room(walk: RecordedWalk, thing: str | None, step: int) -> bool:
    """Return whether all of a thing, or of the robot, began in a room and is in one next to it."""
    began, is_now = (shapely.Point(walk.places[k]) if thing is None else walk.things[k][thing] for k in (0, step))
    rooms = [shapely.buffer(part, SLACK, join_style="mitre") for part in walk.rooms.parts]
    pairs = itertools.product(
        *([number for number, room in enumerate(rooms) if room.covers(shape)] for shape in (began, is_now))
    )
    return any((min(pair), max(pair)) in walk.rooms.doors for pair in pairs)


def holds(walk: RecordedWalk, goal: str, step: int, meaning: Mapping[str, Sequence[int]]) -> bool:
    """Return whether a goal holds at a step."""
    kind, what, name, _ = goal_of(goal, "done")
    if kind == "room":
        thing = None if what == OWN_NAME else walk.felt(*meaning[what]) or ""
        return thing != "" and _is_in_next_room(walk, thing, step)
    if kind == "circled":
        return _winds(walk, step, *meaning[name])
    if kind == "corner":
        return _is_at_corner(walk, name, step, None if what == OWN_NAME else walk.felt(*meaning[what]))
    here, start = walk.places[step], walk.places[0]
    if kind == "start" and what == OWN_NAME:
        return all(abs(a - b) <= 1 + SLACK for a, b in zip(here, start, strict=True))
    one = _squares(walk, what, step, meaning)
    other = {_square(start)} if kind == "start" else _squares(walk, name, step, meaning)
    away = 0 if kind == "start" else 1
    return any(max(abs(i - a), abs(j - b)) <= away for i, j in one for a, b in other)


def _square(place: Sequence[float]) -> tuple[int, int]:
    return math.floor(place[0]), math.floor(place[1])


def _squares(walk: RecordedWalk, name: str, step: int, meaning: Mapping[str, Sequence[int]]) -> set[tuple[int, int]]:
    """Return the squares that the robot or the thing felt covers."""
    if name == OWN_NAME:
        return {_square(walk.places[step])}
    thing = walk.felt(*meaning[name])
    return set() if thing is None else _covered(walk, thing, step)


def _covered(walk: RecordedWalk, thing: str, step: int) -> set[tuple[int, int]]:
    part = project(walk.things[step][thing])
    return {(part.west + int(i), part.south + int(j)) for j, i in zip(*part.covered.nonzero(), strict=True)}


def lost_truth(walk: RecordedWalk, risk: int = 0) -> str:
    """Return where the checker's rules exclude what really happened, in words; "" where they never do.

    risk : in millionths, with noise.
    """
    evidence = walk.evidence(risk)
    evidence.allow(evidence.risk, is_given(walk, OF_COLOURS))
    tables = [Table(walk.world.moved(things, walk.places[0])) for things in walk.things]
    quarters, angle = divmod(walk.world.heading, 90)

    def turned(x: float, y: float, quarters: int) -> tuple[float, float]:
        for _ in range(quarters % 4):
            x, y = -y, x
        return x, y

    places = [turned(x, y, -quarters) for x, y in walk.places]
    middles = [turned(math.floor(x) + 0.5, math.floor(y) + 0.5, -quarters) for x, y in walk.places]
    squares = [(math.floor(x), math.floor(y)) for x, y in middles]
    west, south = squares[0]

    def true_square(square: tuple[int, int]) -> tuple[int, int]:
        return _square(turned(square[0] + west + 0.5, square[1] + south + 0.5, quarters))

    def is_occupied(square: tuple[int, int], step: int) -> bool:
        (i, j), table = true_square(square), tables[step]
        return not (0 <= i < table.width and 0 <= j < table.height) or bool(table.colours[j, i])

    case = waking_case(angle, evidence)
    for step, (place, square) in enumerate(zip(places, squares, strict=True)):
        if step:
            try:
                end = case.ends(evidence).get((square[0] - west, square[1] - south))
            except RefusedError:
                return ""  # the rules say nothing of what follows
            if end is None:
                return f"step {step}: it cannot have ended there"
            case = end._replace(occupied=dict(end.occupied))
        for replays in (False, True):
            contradiction = settle_all(case, evidence)[1]
            if contradiction is not None:
                return f"step {step}: contradicted by {contradiction.line}"
            for i, j, since in case.occupied:
                for when in (since, step):
                    is_known = case.at((i, j), when)
                    if is_known is not None and is_known != is_occupied((i, j), when):
                        return f"step {step}: {(i, j)} is not so at step {when}"
            for here, edge, side in zip(place, (west, south), case.places[step], strict=True):
                if not (side[0] / evidence.unit - SLACK <= here - edge <= side[1] / evidence.unit + SLACK):
                    return f"step {step}: the place is another"
            thing = walk.held[step]
            within = {true_square(one) for one in case.held[step]}
            if thing is not None and not _covered(walk, thing, step) <= within:
                return f"step {step}: what is held lies elsewhere"
            for felt in itertools.product(range(step + 1), range(len(TOUCH_NAMES))):
                if name := walk.felt(*felt):
                    truly, (_, lies) = _covered(walk, name, step), _lies(case, evidence, felt, step)
                    if not {true_square(at) for at in case.covered(evidence, felt, step)} <= truly:
                        return f"step {step}: what was felt at {felt} does not cover this"
                    if lies and not truly <= {true_square(at) for at in lies}:
                        return f"step {step}: what was felt at {felt} lies elsewhere"
            if not replays:
                again = case.replayed(evidence)
                if again is None:
                    return f"step {step}: it cannot have ended there, played again"
                case = again._replace(occupied=dict(again.occupied))
    return ""


def _lies(case: Course, evidence: Evidence, felt: tuple[int, int], step: int) -> tuple[Spots, Spots]:
    """Return where a thing began and lies, as the rules say; nothing where they refuse."""
    try:
        return case.extent(evidence, felt, step)
    except RefusedError:
        return Spots(), Spots()


def _is_at_corner(walk: RecordedWalk, name: str, step: int, thing: str | None) -> bool:
    """Return whether the robot or a thing is at a corner beyond which no field shows nothing but floor."""
    heading = math.radians(walk.world.heading)
    e, n = (1 if "east" in name else -1), (1 if "north" in name else -1)
    u, v = e * math.cos(heading) - n * math.sin(heading), e * math.sin(heading) + n * math.cos(heading)

    def occupied(i: int, j: int, step: int, without: str | None = None) -> bool:
        things = {other: outline for other, outline in walk.things[step].items() if other != without}
        table = walk.world
        is_off = not (0 <= i < table.width and 0 <= j < table.height)
        return is_off or any(project(one).covers(i, j) for one in (table.verge, *things.values()))

    def reach(i: int, j: int) -> float:
        return u * (i + (u > 0)) + v * (j + (v > 0))

    place = walk.places[step]
    bounds = walk.things[step][thing].bounds if thing else (*place, *place)
    ends = bounds[2 if u > 0 else 0], bounds[3 if v > 0 else 1]
    own = [_square(place) for place in walk.places[: step + 1]]
    at = _square(ends)
    found = []
    for i in range(at[0] - 2, at[0] + 3):
        for j in range(at[1] - 2, at[1] + 3):
            edge = i + (u > 0), j + (v > 0)
            near = all(abs(a - b) <= 1 + SLACK for a, b in zip(edge, ends, strict=True))
            ahead = (i + int(np.sign(u)), j), (i, j + int(np.sign(v)))
            walls = all(occupied(*square, step, thing) for square in ahead)
            if near and walls and (not occupied(i, j, step, thing) or (i, j) == own[-1]):
                found.append(reach(i, j))
    seen = [reach(*square) for k, square in enumerate(own) if not occupied(*square, k)]
    cosine, sine = math.cos(heading), math.sin(heading)
    for k, (x, y) in enumerate(own):
        for east, north, side in FIELDS:
            if side == 1:
                i, j = x + round(east * cosine - north * sine), y + round(east * sine + north * cosine)
                if (east, north) != (0, 0) and not occupied(i, j, k):
                    seen.append(reach(i, j))
    return bool(found) and max(found) >= max(seen) - SLACK


def _winds(walk: RecordedWalk, step: int, felt: int, touch: int) -> bool:
    """Return whether the track winds about the whole of the thing that a touch felt; its ends are in one square."""
    thing = walk.felt(felt, touch)
    track = np.array([*walk.places[: step + 1], walk.places[0]])
    if thing is None or _square(walk.places[step]) != _square(walk.places[0]):
        return False
    return abs(_winding(track, np.array(walk.things[step][thing].representative_point().coords[0]))) >= 1


def _winding(track: "np.ndarray[tuple[int, int], np.dtype[np.float64]]", centre: object) -> int:
    """Return how often a closed track winds about a point."""
    away = track - centre  # type: ignore[operator]
    angles = np.unwrap(np.arctan2(away[:, 1], away[:, 0]))
    return round(float(angles[-1] - angles[0]) / (2 * math.pi))
