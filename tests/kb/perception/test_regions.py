"""Regions, and which surrounds which, on drawings and random rasters, against brute-force flooding."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.perception.regions import Percept, label_of, map_regions

STEPS = ((1, 0), (-1, 0), (0, 1), (0, -1))


def flooded(cells: set, near) -> list[frozenset]:  # type: ignore[no-untyped-def]
    """Return the connected parts of a set under a neighbourhood relation."""
    left, parts = set(cells), []
    while left:
        part, edge = set(), [min(left)]
        while edge:
            cell = edge.pop()
            if cell in left:
                left.remove(cell)
                part.add(cell)
                edge += [other for other in near(cell) if other in left]
        parts.append(frozenset(part))
    return parts


def drawn(rows: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return the occupied and the seen squares of a drawing, its north row first: `.` floor, `?` unseen."""
    marks = np.array([list(row) for row in reversed(rows)])
    return ~np.isin(marks, [".", "?"]), marks != "?"


def named(percept: Percept, labels: np.ndarray, x: int, y: int) -> str:
    return f"part{labels[y, x]}"


masks = st.tuples(st.integers(1, 9), st.integers(1, 9), st.integers(0, 2**32 - 1))


def random_map(rows: int, columns: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.random((rows, columns)) < rng.uniform(0.2, 0.8), rng.random((rows, columns)) < rng.uniform(0.6, 1.0)


@settings(max_examples=150, deadline=None)
@given(masks)
def test_map_regions_are_the_edge_connected_parts(shape: tuple[int, int, int]) -> None:
    occupied, seen = random_map(*shape)
    percept, labels = map_regions(occupied, seen, seen)
    want = set()
    for kind in (False, True):
        squares = {(r, c) for r, c in np.argwhere(seen & (occupied == kind)).tolist()}
        want |= set(flooded(squares, lambda s: [(s[0] + a, s[1] + b) for a, b in STEPS]))
    found = {
        frozenset(map(tuple, np.argwhere(labels == label_of(region.name)).tolist())): region
        for region in percept.regions
    }
    assert set(found) == want
    assert (labels[~seen] == 0).all()
    for part, region in found.items():
        row, column = min(part)
        assert region.occupied == occupied[row, column]
        heights, widths = zip(*part, strict=True)
        assert region.extent == max(max(heights) - min(heights), max(widths) - min(widths)) + 1
        beyond = {(r + a, c + b) for r, c in part for a, b in STEPS}
        inside = {(r, c) for r, c in beyond if 0 <= r < labels.shape[0] and 0 <= c < labels.shape[1]}
        assert region.rim == (inside != beyond or any(not seen[square] for square in inside))


@settings(max_examples=150, deadline=None)
@given(masks)
def test_a_region_is_surrounded_if_no_way_leads_out_of_it(shape: tuple[int, int, int]) -> None:
    occupied, seen = random_map(*shape)
    percept, labels = map_regions(occupied, seen, seen)
    framed = np.pad(labels, 1)
    for barrier in percept.regions:
        passable = {(r, c) for r, c in np.argwhere(framed != label_of(barrier.name)).tolist()}
        # every unseen square leads out
        parts = flooded(passable, lambda s: [(s[0] + a, s[1] + b) for a, b in STEPS])
        shut_in = {framed[s] for part in parts if not any(framed[s] == 0 for s in part) for s in part}
        assert {inner for outer, inner in percept.surrounds if outer == barrier.name} == {f"part{n}" for n in shut_in}


@settings(max_examples=60, deadline=None)
@given(masks)
def test_adjacent_is_symmetric_and_true(shape: tuple[int, int, int]) -> None:
    occupied, seen = random_map(*shape)
    percept, labels = map_regions(occupied, seen, seen)
    want = set()
    for (r, c), label in np.ndenumerate(labels):
        for a, b in ((0, 1), (1, 0)):
            if r + a < labels.shape[0] and c + b < labels.shape[1]:
                other = labels[r + a, c + b]
                if label and other and label != other:
                    want |= {(f"part{label}", f"part{other}"), (f"part{other}", f"part{label}")}
    assert percept.adjacent == want


def test_certain_is_the_share_of_settled_squares() -> None:
    occupied, seen = drawn(["....", "...."])
    certain = np.zeros_like(seen)
    certain[0, :3] = True
    percept, _ = map_regions(occupied, seen, certain)
    assert [region.certain for region in percept.regions] == [37]


def test_a_room_with_a_thing_and_a_thing_at_the_rim() -> None:
    occupied, seen = drawn(
        [
            "bbbbbbb???",
            "b.....b???",
            "b.gg..b???",
            "b.gg.....?",
            "b.....b.g?",
            "bbbbbbb.g?",
        ]
    )
    percept, labels = map_regions(occupied, seen, seen)
    floor, wall, thing = (named(percept, labels, *p) for p in ((1, 1), (0, 0), (2, 2)))
    other = named(percept, labels, 8, 0)
    assert (floor, thing) in percept.surrounds
    assert (wall, floor) not in percept.surrounds  # the floor goes on through the door
    assert not {pair for pair in percept.surrounds if other in pair}


def test_diagonal_squares_are_not_connected() -> None:
    occupied, seen = drawn(["g.", ".g"])
    percept, _ = map_regions(occupied, seen, seen)
    assert len(percept.regions) == 4
