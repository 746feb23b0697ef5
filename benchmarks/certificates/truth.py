"""Whether what a certificate claims of a recorded walk holds on the true table, and is among what the rules allow."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from benchmarks.certificates.recorded import RecordedWalk
from utak.geometry.counts.retina import FIELDS
from utak.simulator.certificates.checker import Evidence, Sampling, waking_case
from utak.simulator.certificates.search import settle_all
from utak.simulator.world.table import Table

SLACK = 1e-5  # squares; what the checker allows for rounding


def is_given(walk: RecordedWalk, given: Sequence[str]) -> bool:
    """Return whether the grid lies as it is given."""
    return "along(grid)" not in given or walk.world.heading % 90 == 0


def holds(walk: RecordedWalk, goal: str, step: int, meaning: Mapping[str, Sequence[int]]) -> bool:
    """Return whether a goal holds at a step."""
    here, start = walk.places[step], walk.places[0]
    if goal == "at(utak,start)":
        return all(abs(a - b) <= 1 + SLACK for a, b in zip(here, start, strict=True))
    if goal.startswith("at(utak,corner("):
        return _is_at_corner(walk, goal[15:-2], step)
    return _winds(walk, step, *meaning["x"])


def lost_truth(walk: RecordedWalk) -> str:
    """Return where the checker's rules exclude what really happened, in words; "" where they never do."""
    evidence, table = Evidence(walk.text), Table(walk.world)
    quarters, angle = divmod(walk.world.heading, 90)

    def turned(x: float, y: float, quarters: int) -> tuple[float, float]:
        for _ in range(quarters % 4):
            x, y = -y, x
        return x, y

    places = [turned(x, y, -quarters) for x, y in walk.places]
    middles = [turned(math.floor(x) + 0.5, math.floor(y) + 0.5, -quarters) for x, y in walk.places]
    squares = [(math.floor(x), math.floor(y)) for x, y in middles]
    west, south = squares[0]

    def is_occupied(square: tuple[int, int]) -> bool:
        x, y = turned(square[0] + west + 0.5, square[1] + south + 0.5, quarters)
        i, j = math.floor(x), math.floor(y)
        return not (0 <= i < table.width and 0 <= j < table.height) or bool(table.colours[j, i])

    case, samples = waking_case(angle, evidence), Sampling(angle)
    for step, (place, square) in enumerate(zip(places, squares, strict=True)):
        if step:
            end = case.ends(evidence).get((square[0] - west, square[1] - south))
            if end is None:
                return f"step {step}: it cannot have ended there"
            case = end
        for replays in (False, True):
            contradiction = settle_all(case, evidence, samples)[1]
            if contradiction is not None:
                return f"step {step}: contradicted by {contradiction.line}"
            if wrong := [spot for spot, occupied in case.occupied.items() if occupied != is_occupied(spot)]:
                return f"step {step}: {wrong[0]} is not so"
            ends = zip(place, places[0], case.ways[step], case.waking, (west, south), strict=True)
            for here, woke, way, waking, edge in ends:
                way, waking = ((low / evidence.unit, high / evidence.unit) for low, high in (way, waking))
                if not (way[0] - SLACK <= here - woke <= way[1] + SLACK):
                    return f"step {step}: the way is another"
                if not (waking[0] - SLACK <= woke - edge <= waking[1] + SLACK):
                    return f"step {step}: the point of waking is another"
            if not replays:
                again = case.replayed(evidence)
                if again is None:
                    return f"step {step}: it cannot have ended there, played again"
                case = again
    return ""


def _is_at_corner(walk: RecordedWalk, name: str, step: int) -> bool:
    """Return whether the robot is at a corner beyond which no field shows nothing but floor."""
    heading = math.radians(walk.world.heading)
    e, n = (1 if "east" in name else -1), (1 if "north" in name else -1)
    u, v = e * math.cos(heading) - n * math.sin(heading), e * math.sin(heading) + n * math.cos(heading)
    table = Table(walk.world)

    def occupied(i: int, j: int) -> bool:
        return not (0 <= i < table.width and 0 <= j < table.height) or bool(table.colours[j, i])

    def reach(i: int, j: int) -> float:
        return u * (i + (u > 0)) + v * (j + (v > 0))

    own = [tuple(math.floor(p) for p in place) for place in walk.places[: step + 1]]
    found = []
    for i in range(own[-1][0] - 1, own[-1][0] + 2):
        for j in range(own[-1][1] - 1, own[-1][1] + 2):
            edge = i + (u > 0), j + (v > 0)
            near = all(abs(a - b) <= 1 + SLACK for a, b in zip(edge, walk.places[step], strict=True))
            walls = occupied(i + int(np.sign(u)), j) and occupied(i, j + int(np.sign(v)))
            if near and walls and (not occupied(i, j) or (i, j) == own[-1]):
                found.append(reach(i, j))
    seen = [reach(*square) for square in own]
    cosine, sine = math.cos(heading), math.sin(heading)
    for x, y in own:
        for east, north, side in FIELDS:
            if side == 1:
                i, j = x + round(east * cosine - north * sine), y + round(east * sine + north * cosine)
                if not occupied(i, j):
                    seen.append(reach(i, j))
    return bool(found) and max(found) >= max(seen) - SLACK


def _winds(walk: RecordedWalk, step: int, felt: int, touch: int) -> bool:
    """Return whether the track winds about the whole of a thing that covers the square of a touch."""
    heading = math.radians(walk.world.heading)
    e, n = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))[touch]
    x, y = (math.floor(p) for p in walk.places[felt])
    i = x + round(e * math.cos(heading) - n * math.sin(heading))
    j = y + round(e * math.sin(heading) + n * math.cos(heading))
    square = shapely.box(i, j, i + 1, j + 1)
    things = [thing.polygon for thing in walk.world.movable if thing.polygon.intersection(square).area > 0]
    track = np.array([*walk.places[: step + 1], walk.places[0]])
    if math.dist(track[-2], track[-1]) > SLACK:
        return False
    return any(abs(_winding(track, np.array(thing.representative_point().coords[0]))) >= 1 for thing in things)


def _winding(track: "np.ndarray[tuple[int, int], np.dtype[np.float64]]", centre: object) -> int:
    """Return how often a closed track winds about a point."""
    away = track - centre  # type: ignore[operator]
    angles = np.unwrap(np.arctan2(away[:, 1], away[:, 0]))
    return round(float(angles[-1] - angles[0]) / (2 * math.pi))
