"""Which facts stated as known contradict the table: counted over runs of random worlds, or of scenarios that are named.

    python -m benchmarks.claims.true_facts [--count N] [--seed S] [--noise S] [--kinds KIND,KIND] [SCENARIO ...]

Checked at every step: adjacent/3, in/3, door/2, connects/4 and corner/4 with 100 percent, and width/3 of all doors that
are believed with MIN_DOOR_CONFIDENCE percent. It prints how many statements there were, those that are false, and exits
with 1 when there is one. Coordinates are squares of the truth.
"""

import argparse
import math
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely

import utak
from benchmarks.claims.asked import all_kinds, worlds_of, written
from utak.geometry.kernels.arrays import XY, Bools, Labels
from utak.geometry.raster.components import components
from utak.geometry.raster.rasterize import squares
from utak.kb.language.atoms import atom_parts
from utak.kb.world.model import FACT_UNITS_PER_SQUARE, ROOT_NODE, VERGE_NODE
from utak.kb.world.rooms import MIN_DOOR_CONFIDENCE
from utak.simulator.scenario.scenario import read_any_world

CHECKED = {("adjacent", 3), ("in", 3), ("door", 2), ("connects", 4), ("corner", 4)}
NEAR_END = math.sqrt(2) + 1e-6  # squares: a wall that meets the square at an end of a door's line is so near
FACT_ROUNDING = 0.02  # squares: facts are whole hundredths
DOOR_WINDOW = 3.0  # squares: the walls of a door are sought so far about its line; a convention


class TrueTable(NamedTuple):
    """The truth at one step."""

    verge: shapely.Geometry
    things: Mapping[str, shapely.Polygon]
    width: int
    height: int
    woke: XY
    heading: float  # degrees from the table's north, counter-clockwise
    robot: XY

    def place(self, east: float, north: float) -> XY:
        """Return a point of the robot frame, in squares, as one of the truth."""
        turn = math.radians(self.heading)
        x, y = east * math.cos(turn) - north * math.sin(turn), east * math.sin(turn) + north * math.cos(turn)
        return self.woke[0] + x, self.woke[1] + y

    def mask(self, shape: shapely.Geometry) -> Bools:
        """Return the squares that a shape takes up, with one square about the truth, which is verge."""
        return np.pad(squares(shape, self.width, self.height), 1)

    @property
    def walls(self) -> Bools:
        """Return the squares of the verge, with one square about the truth."""
        return np.pad(squares(self.verge, self.width, self.height), 1, constant_values=True)

    def square(self, place: XY) -> tuple[int, int]:
        """Return the index [row, column] of a point's square in masks."""
        return math.floor(place[1]) + 1, math.floor(place[0]) + 1


class Said(NamedTuple):
    """The facts of one step by predicate, their arguments as text."""

    rows: Mapping[tuple[str, int], Sequence[tuple[str, ...]]]

    def number(self, name: str, arity: int, *begin: str) -> list[float]:
        """Return the numbers behind the first arguments of a fact, in squares; [] where there is none."""
        for row in self.rows.get((name, arity), ()):
            if row[: len(begin)] == begin:
                return [int(value) / FACT_UNITS_PER_SQUARE for value in row[len(begin) :]]
        return []


def said(facts: Sequence[str]) -> Said:
    """Return facts by predicate."""
    rows: dict[tuple[str, int], list[tuple[str, ...]]] = {}
    for name, arguments in map(atom_parts, facts):
        rows.setdefault((name, len(arguments)), []).append(arguments)
    return Said(rows)


def false_facts(facts: Sequence[str], truth: TrueTable) -> Iterator[str]:
    """Yield the facts of a step that are stated as known and contradict the truth, each with what is true."""
    known = said(facts)
    lines = {door: _line(known, door, truth) for door, *_ in known.rows.get(("threshold", 5), ())}
    for one, other, share in known.rows.get(("adjacent", 3), ()):
        if share == "100" and not _touch(_squares_of(one, known, truth), _squares_of(other, known, truth)):
            yield f"adjacent({one},{other},100)"
    yield from _false_rooms(known, truth, list(lines.values()))
    for door, share in known.rows.get(("door", 2), ()):
        if share == "100" and (why := _no_door(lines[door], truth)):
            yield f"door({door},100): {why}"
        if int(share) >= MIN_DOOR_CONFIDENCE and (true := _true_width(lines[door], truth)) is not None:
            least, most = next((_numbers(row[1:])) for row in known.rows["width", 3] if row[0] == door)
            if not least - FACT_ROUNDING <= true <= most + FACT_ROUNDING:
                yield f"width({door},{least},{most}): it is {true:.2f}"
    for side, *place, share in known.rows.get(("corner", 4), ()):
        if share == "100" and not _is_corner(truth.place(*_numbers(place)), truth):
            yield f"corner({side},{','.join(place)},100)"


def _numbers(texts: Sequence[str]) -> list[float]:
    return [int(text) / FACT_UNITS_PER_SQUARE for text in texts]


def _line(known: Said, door: str, truth: TrueTable) -> tuple[XY, XY]:
    west, south, east, north = known.number("threshold", 5, door)
    return truth.place(west, south), truth.place(east, north)


def _squares_of(node: str, known: Said, truth: TrueTable) -> Bools:
    """Return the squares of the verge, of the robot, or of the true things that a node is taken for."""
    # Things that touch are one node. A node that is nearest to the verge is part of it.
    if node == VERGE_NODE:
        return truth.walls
    if node == ROOT_NODE:
        mask = np.zeros((truth.height + 2, truth.width + 2), np.bool_)
        mask[truth.square(truth.robot)] = True
        return mask
    thing = _thing_of(node, known, truth)
    if thing is None:
        return truth.walls
    within = shapely.Polygon([truth.place(east, north) for east, north in _corners(known.number("rect", 5, node))])
    parts = [one for name, one in truth.things.items() if name == thing or within.contains(one.centroid)]
    mask: Bools = np.logical_or.reduce([truth.mask(one) for one in parts])
    return mask


def _corners(rectangle: Sequence[float]) -> Sequence[XY]:
    """Return the corners of a rectangle (west, south, east, north); those of a point for [], which contain nothing."""
    west, south, east, north = rectangle or (0.0, 0.0, 0.0, 0.0)
    return (west, south), (east, south), (east, north), (west, north)


def _thing_of(node: str, known: Said, truth: TrueTable) -> str | None:
    """Return the true thing at the place of a node; None where the verge is nearer."""
    at = shapely.Point(truth.place(*known.number("offset", 3, node)))
    nearest = min(truth.things, key=lambda name: truth.things[name].distance(at), default=None)
    if nearest is None or truth.verge.distance(at) < truth.things[nearest].distance(at):
        return None
    return nearest


def _touch(one: Bools, other: Bools) -> bool:
    """Return whether a square of one mask is one of the other, or one of the eight about it."""
    rows, columns = one.shape
    padded = np.pad(one, 1)
    about = np.logical_or.reduce([padded[i : i + rows, j : j + columns] for i in range(3) for j in range(3)])
    return bool((about & other).any())


def _false_rooms(known: Said, truth: TrueTable, lines: Sequence[tuple[XY, XY]]) -> Iterator[str]:
    """Yield pairs of things that are known to be in one room, between which a wall or a door lies."""
    labels = _rooms(truth, lines)
    where: dict[str, list[tuple[str, int]]] = {}
    for node, room, share in known.rows.get(("in", 3), ()):
        if share != "100":
            continue
        thing = None if node == ROOT_NODE else _thing_of(node, known, truth)
        if thing is None and node != ROOT_NODE:
            continue
        middle = truth.robot if thing is None else (truth.things[thing].centroid.x, truth.things[thing].centroid.y)
        row, column = truth.square(middle)
        about = labels[row - 1 : row + 2, column - 1 : column + 2]
        label = int(labels[row, column]) or int(about.max())  # a square that a wall meets may be free in part
        if label:  # the middle of a bent thing may lie outside of it, even in a wall
            where.setdefault(room, []).append((node, label))
    for room, there in where.items():
        for (one, first), (other, second) in pairwise(there):
            if first != second:
                yield f"in({one},{room},100), in({other},{room},100)"


def _rooms(truth: TrueTable, lines: Sequence[tuple[XY, XY]]) -> Labels:
    """Return the parts of the true floor between the lines of doors, on a raster twice as fine: labels of squares."""
    floor = np.kron(~truth.walls, np.ones((2, 2), np.bool_))
    for line in lines:
        cut = shapely.LineString(line).buffer(0.26)
        placed = shapely.transform(cut, lambda points: 2 * (points + 1))
        floor &= ~squares(placed, floor.shape[1], floor.shape[0])
    fine = components(floor).labels
    return fine.reshape(truth.height + 2, 2, truth.width + 2, 2).max(axis=(1, 3))


def _no_door(line: tuple[XY, XY], truth: TrueTable) -> str:
    """Return why no door is at a line: a wall crosses it, or does not bound it; "" where one is."""
    whole = shapely.LineString(line)
    if not whole.interpolate(0.5, normalized=True).buffer(max(whole.length / 2 - 1, 0.1)).disjoint(truth.verge):
        return "verge lies in it"
    if any(truth.verge.distance(shapely.Point(end)) > NEAR_END for end in line):
        return "no verge bounds it"
    return ""


def _true_width(line: tuple[XY, XY], truth: TrueTable) -> float | None:
    """Return the width of the true gap at the line of a door; None where there are no two walls."""
    whole = shapely.LineString(line)
    window = whole.buffer(DOOR_WINDOW)
    parts = shapely.get_parts(shapely.intersection(truth.verge, window)).tolist()
    near = [min(parts, key=shapely.Point(end).distance, default=None) for end in line]
    if (
        near[0] is None
        or near[0] is near[1]
        or any(part.distance(shapely.Point(end)) > NEAR_END for part, end in zip(near, line, strict=True))
    ):
        return None
    return float(near[0].distance(near[1]))


def _is_corner(place: XY, truth: TrueTable) -> bool:
    """Return whether one of the four squares about a point is free, and the others are walls."""
    row, column = (round(value) + 1 for value in place[::-1])
    about = truth.walls[max(row - 1, 0) : row + 1, max(column - 1, 0) : column + 1]
    return int((~about).sum()) == 1


def false_in_run(folder: Path, noise: float = 0.0, seed: int = 1) -> tuple[Counter[str], list[str]]:
    """Return how many facts of a run were checked, by predicate, and those that are false, each once."""
    world = read_any_world(folder)
    run = utak.Run(utak.Scenario.read(folder), seed=seed, noise=noise)
    episode = run.finish()
    counts, found = Counter[str](), dict[str, int]()
    fixed = {thing.name: thing.polygon for thing in world.fixed}
    for line in episode_lines(episode):
        things = {name: shapely.Polygon(points) for name, points in line["objects"].items()} | fixed
        truth = TrueTable(
            world.verge,
            things,
            world.width,
            world.height,
            world.utak,
            world.heading,
            (line["utak"][0], line["utak"][1]),
        )
        facts = [str(fact).removesuffix(".") for fact in line["belief"]["facts"]]
        for name, arguments in map(atom_parts, facts):
            counts[name] += ((name, len(arguments)) in CHECKED and arguments[-1] == "100") or (
                name == "width" and len(arguments) == 3
            )
        for one in false_facts(facts, truth):
            found.setdefault(one, line["step"])
    return counts, [f"step {step}: {one}" for one, step in found.items()]


def episode_lines(episode: utak.Episode) -> Sequence[Mapping[str, Any]]:
    """Return the lines of the steps of an episode."""
    return [step.line for step in episode]


def main(arguments: Sequence[str] | None = None) -> int:
    """Check runs and print what is false; return 1 when anything is."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenarios", nargs="*", type=Path)
    parser.add_argument("--count", type=int, default=1, help="random worlds of each kind (default 1)")
    parser.add_argument("--seed", type=int, default=9000, help="the first seed (default 9000)")
    parser.add_argument("--noise", type=float, default=0.0)
    parser.add_argument("--kinds", default="", help="kinds of benchmarks.claims, with commas (default all)")
    options = parser.parse_args(arguments)
    counts, wrong = Counter[str](), 0
    with tempfile.TemporaryDirectory() as made:
        folders = {str(folder): folder for folder in options.scenarios}
        kinds = options.kinds.split(",") if options.kinds else all_kinds()
        for asked in [] if folders else worlds_of(kinds, options.seed, options.count):
            folders[asked.name] = Path(made) / asked.name.replace(":", "-")
            folders[asked.name].mkdir()
            written(asked, folders[asked.name])
        for name, folder in folders.items():
            stated, found = false_in_run(folder, options.noise)
            counts += stated
            wrong += len(found)
            print(f"{name}: {len(found)} false of {stated.total()}", *found, sep="\n  ", flush=True)
    print(f"{wrong} false; stated:", ", ".join(f"{count} {name}" for name, count in sorted(counts.items())))
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
