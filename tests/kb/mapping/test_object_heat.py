"""The probability that an object of a shape is where nothing is settled."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import Point, affinity, box

from tests.kb.drawings import LARGE_ROOM, drawing, looked
from utak.geometry.counts.gibbs import DRAWN
from utak.geometry.counts.moments import Blobs, blobs
from utak.kb.mapping.object_heat import end_probability, likeness, summarise_completions
from utak.kb.mapping.occupancy import OPEN


@pytest.mark.parametrize(("wide", "high", "square"), [(5, 5, True), (4, 4, True), (8, 3, False), (10, 2, False)])
def test_a_square_is_recognised_from_afar(wide: int, high: int, square: bool) -> None:
    view = looked(drawing(31, 30, wide, high), [(20, 20), (22, 21), (23, 23)]).view()
    found = summarise_completions(view).likely("square")
    row, column = view.locate(31 + wide / 2 - 20, 30 + high / 2 - 20)
    assert (found[row, column] > 0.4) == square
    assert (view.state[row - 1 : row + 2, column - 2 : column + 3] == OPEN).any()


@pytest.mark.parametrize("shown", [3, 4, 5])
def test_a_part_at_the_edge_of_the_seen_map_may_be_a_square(shown: int) -> None:
    view = looked(drawing(36 - shown, 18, 5, 5), [(20, 20)]).view()
    row, column = view.locate(15, 0)
    assert not view.seen[row, column + 1 :].any()
    assert 0.3 < summarise_completions(view).likely("square")[row, column] < 0.9


def test_a_wall_at_the_edge_of_the_seen_map_is_no_square() -> None:
    view = looked(drawing(24, 18, 12, 3), [(20, 20)]).view()
    row, column = view.locate(15, -1)
    assert view.seen[row, column]
    assert summarise_completions(view).likely("square")[row, column] < 0.1


def test_an_empty_room_holds_no_square() -> None:
    view = looked(LARGE_ROOM, [(12, 12), (14, 13), (16, 15)]).view()
    assert summarise_completions(view).likely("square").max() < 0.3


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
def test_a_shape_is_most_like_itself(shape: str) -> None:
    found = blobs(filled(SHAPES[shape]), np.full((24, 24), DRAWN, np.int8))
    like = {name: float(likeness(found, name)[0]) for name in SHAPES}
    assert max(like, key=lambda name: like[name]) == shape
    rectangle = float(likeness(found, "rectangle")[0])
    assert (rectangle > 0.5) == (shape in ("square", "brick"))


ANGLES, PARTS = st.floats(0.0, 90.0), st.floats(0.0, 1.0)


def turned(polygon, degrees: float, east: float, north: float) -> Blobs:
    """Return the greatest part of the raster of a shape at any orientation."""
    away = 12 + east - polygon.centroid.x, 12 + north - polygon.centroid.y
    image = filled(affinity.translate(affinity.rotate(polygon, degrees), *away))
    found = blobs(image, np.full((24, 24), DRAWN, np.int8))
    best = int(found.area.argmax())
    return Blobs(found.labels, *(values[best : best + 1] for values in found[1:]))


@given(ANGLES, PARTS, PARTS, st.integers(16, 22))
def test_a_piece_of_wall_is_neither_a_brick_nor_an_l(degrees: float, east: float, north: float, length: int) -> None:
    found = turned(box(0, 0, length, 2), degrees, east, north)
    for shape in ("brick", "rectangle", "l_shape", "t_shape"):
        assert likeness(found, shape)[0] < 0.25


@given(ANGLES, PARTS, PARTS, st.integers(6, 9), st.integers(6, 9))
def test_an_l_is_recognised_at_any_orientation(degrees: float, east: float, north: float, wide: int, high: int) -> None:
    found = turned(box(0, 0, wide, 2).union(box(0, 0, 2, high)), degrees, east, north)
    assert likeness(found, "l_shape")[0] > 0.5


@pytest.mark.parametrize(("length", "likely"), [(6, True), (9, True), (10, False), (20, False)])
def test_a_long_part_that_goes_on_unseen_does_not_end_there(length: int, likely: bool) -> None:
    picture = np.zeros((9, 30), np.int8)
    picture[3:6, :length] = 1
    found = blobs(picture, np.full(picture.shape, DRAWN, np.int8))
    assert found.outward.tolist() == [3]
    assert (end_probability(found)[0] > 0.3) == likely
    assert end_probability(found._replace(outward=np.zeros(1, np.int64)))[0] == 1.0
