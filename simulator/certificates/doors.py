"""Doors by which a goal is shown: three rectangles of squares, the door and the rooms that it joins."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import product

from utak.simulator.certificates.checker import CertificateCheck
from utak.simulator.certificates.courses import Course, Spot, Spots

UNSETTLED_WALL = 3  # squares of a wall beside a door that may be left open; a bound on time
ALONG_ROWS, ALONG_COLUMNS = (0, 1, 2, 3), (1, 0, 3, 2)  # how the numbers of a rectangle are read where a door leads so
Rectangle = list[int]  # the least column and row, the greatest column and row
Squares = set[Spot]


def door_shown(
    checker: CertificateCheck, case: Course, likely: Sequence[Rectangle] = (), step: int | None = None
) -> list[Rectangle] | None:
    """Return a door and its rooms by which all goals of rooms hold in a case, at their steps or one; None for none."""
    wanted = [(goal, at if step is None else step) for at, goal in checker.timed if goal[0] == "room"]

    def shows(door: Sequence[Rectangle]) -> bool:
        return all(checker.holds(goal, case, at, list(door)) for goal, at in wanted)

    if likely and shows(likely):
        return list(likely)
    extents = [case.extent(checker.episode, checker.felt(what), at) for (_, what, *_), at in wanted]
    if not all(part for extent in extents for part in extent):
        return None
    return next(filter(shows, _doors(case, extents)), None)


def _doors(case: Course, extents: Sequence[tuple[Spots, Spots]]) -> Iterator[list[Rectangle]]:
    """Yield doors, each with rectangles on both sides; extents : where things began and where they lie."""
    began = Spots().union(*(began for began, _ in extents))
    floor = {(i, j) for i, j, _ in case.occupied if case.was_free((i, j))} | began | {*case.squares}
    walls = {(i, j) for (i, j, _), is_occupied in case.occupied.items() if is_occupied} - began
    islands = _islands(case, floor)
    for order in (ALONG_ROWS, ALONG_COLUMNS):
        ground, sides, *lots = (_turned(lot, order) for lot in (floor, walls, *islands))
        ends = [(_turned(one, order), _turned(other, order)) for one, other in extents]
        for door in _necks(ground, sides):
            parts: dict[bool, Squares] = {False: set(), True: set()}  # before and behind the door
            for (one, other), is_behind in product(ends, (False, True)):
                if all((i > door[2]) == is_behind for i, _ in one):
                    parts[is_behind] |= one
                    parts[not is_behind] |= other
            behind = list(_rooms(ground, lots, door, 1, parts[True]))
            for before in _rooms(ground, lots, door, -1, parts[False]) if behind else ():
                yield from ([[one[k] for k in order] for one in (door, before, after)] for after in behind)


def _turned(squares: Iterable[Spot], order: tuple[int, ...]) -> Squares:
    """Return squares with columns for rows where a door leads along the columns."""
    return {(i, j) if order == ALONG_ROWS else (j, i) for i, j in squares}


def _islands(case: Course, floor: Squares) -> list[Spots]:
    """Return squares all about which floor is seen, each lot by itself: things, or what hides between them."""
    unseen = {(i, j) for i, j, _ in case.occupied} - floor
    bounds = [(min(at[k] for at in floor), max(at[k] for at in floor)) for k in (0, 1)]
    islands: list[Spots] = []
    while unseen:
        island = case.unsettled({unseen.pop()}, case.step)
        unseen -= island
        if all(low <= at[k] <= high for k, (low, high) in enumerate(bounds) for at in island):
            islands.append(island)
    return islands


def _necks(floor: Squares, walls: Squares) -> Iterator[Rectangle]:
    """Yield rectangles of floor between two walls, and longer ones that have the same walls somewhere."""
    runs: dict[tuple[int, int], set[int]] = {}  # of floor between two walls: its columns
    for i, j in walls:
        n = j + 1
        while (i, n) in floor:
            n += 1
        if n > j + 1 and (i, n) in walls:
            runs.setdefault((j + 1, n - 1), set()).add(i)
    for (s, n), columns in sorted(runs.items()):
        reach = range(min(UNSETTLED_WALL + 1, 2 * (n - s + 1)))
        for w in sorted(columns - {i + 1 for i in columns}):
            e = w
            while e + 1 in columns:
                e += 1
            for before, after in product(reach, reach):
                if all((i, j) in floor for i in range(w - before, e + after + 1) for j in range(s, n + 1)):
                    yield [w - before, s, e + after, n]


def _rooms(floor: Squares, islands: list[Squares], door: Rectangle, way: int, spots: Squares) -> Iterator[Rectangle]:
    """Yield least rectangles of floor beyond a door that are twice as wide as it and have some squares in them."""
    w, s, e, n = door
    first, wide = (e + 1 if way > 0 else w - 1), 2 * (n - s + 1)
    if not spots or any(way * (i - first) < 0 for i, _ in spots):
        return
    depth = max(wide, *(way * (i - first) + 1 for i, _ in spots))
    low, high = min(s, *(j for _, j in spots)), max(n, *(j for _, j in spots))
    for bottom in range(low - max(wide - (high - low + 1), 0), low + 1):
        ends = sorted((first, first + way * (depth - 1)))
        room = [ends[0], bottom, ends[1], max(high, bottom + wide - 1)]
        inside = [island for island in islands if island & _squares(room)]
        if inside and not _squares(room) <= floor:
            columns, rows = zip(*set[Spot]().union(*inside), strict=True)
            room = [min(room[0], *columns), min(room[1], *rows), max(room[2], *columns), max(room[3], *rows)]
        if room[0 if way > 0 else 2] == first and _squares(room) <= floor.union(*inside):
            yield room


def _squares(room: Rectangle) -> Squares:
    """Return the squares of a rectangle."""
    return {*product(range(room[0], room[2] + 1), range(room[1], room[3] + 1))}
