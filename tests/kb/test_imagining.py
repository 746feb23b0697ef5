"""What is likely to stand where nothing is settled."""

import numpy as np
import pytest
from shapely import Point, box

from geometry.sketch import DRAWN, blobs
from kb.evidence import OPEN, Evidence
from kb.imagining import Imagination, likeness
from kb.lattice import Lattice
from kb.retina import count_ranges
from tests.kb.eyes import impression, world_of

ROOM = ["b" * 44, *["b" + "." * 42 + "b"] * 42, "b" * 44]


def drawing(east: int, north: int, wide: int, high: int) -> list[str]:
    """A room with a thing whose lower left square is (east, north)."""
    rows = [list(row) for row in ROOM]
    for row in range(north, north + high):
        for column in range(east, east + wide):
            rows[len(rows) - 1 - row][column] = "g"
    return ["".join(row) for row in rows]


def looked(rows: list[str], squares: list[tuple[int, int]]) -> Evidence:
    """The evidence of looks from some squares; the first one is (0, 0) of the lattice."""
    occupied, evidence = world_of(rows), Evidence()
    samples = Lattice().samples()
    for number, (x, y) in enumerate(squares):
        seen = count_ranges(impression(occupied, (x, y), 0).retina)
        at = (x - squares[0][0], y - squares[0][1])
        evidence.look(samples, seen, *at, number)
        evidence.stand(*at, number)
    return evidence


@pytest.mark.parametrize(("wide", "high", "square"), [(5, 5, True), (4, 4, True), (8, 3, False), (10, 2, False)])
def test_a_square_is_told_from_afar(wide: int, high: int, square: bool) -> None:
    view = looked(drawing(31, 30, wide, high), [(20, 20), (22, 21), (23, 23)]).view()
    likely = Imagination().likely(view, Lattice(), "square")
    row, column = view.locate(31 + wide / 2 - 20, 30 + high / 2 - 20)
    assert (likely[row, column] > 0.4) == square
    assert (view.state[row - 1 : row + 2, column - 2 : column + 3] == OPEN).any()


def test_an_empty_room_holds_no_square() -> None:
    view = looked(ROOM, [(12, 12), (14, 13), (16, 15)]).view()
    assert Imagination().likely(view, Lattice(), "square").max() < 0.3


def test_the_next_picture_begins_with_the_last() -> None:
    mind = Imagination()
    evidence = looked(drawing(31, 30, 5, 5), [(20, 20), (22, 21)])
    first = mind.likely(evidence.view(), Lattice(), "square")
    again = mind.likely(evidence.view(), Lattice(), "square")
    assert first.shape == again.shape
    assert mind.likely(evidence.view(), Lattice(9), "square").shape == again.shape


def filled(polygon) -> np.ndarray:
    rows, columns = np.mgrid[:24, :24]
    inside = [polygon.contains(Point(x + 0.5, y + 0.5)) for x, y in zip(columns.ravel(), rows.ravel(), strict=True)]
    return np.array(inside).reshape(24, 24).astype(np.int8)


SHAPES = {
    "square": box(5, 5, 11, 11),
    "brick": box(5, 5, 15, 9),
    "disc": Point(12, 12).buffer(7),
    "l_shape": box(5, 5, 15, 7).union(box(5, 5, 7, 15)),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_is_liker_itself_than_any_other(shape: str) -> None:
    found = blobs(filled(SHAPES[shape]), np.full((24, 24), DRAWN, np.int8))
    like = {name: float(likeness(found, name)[0]) for name in SHAPES}
    assert max(like, key=lambda name: like[name]) == shape
    rectangle = float(likeness(found, "rectangle")[0])
    assert (rectangle > 0.5) == (shape in ("square", "brick"))
