"""Rasters sampled to agree with counts, and the parts of a raster."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from utak.geometry.counts.gibbs import (
    CORNER_COST,
    COUNT_ERROR_COST,
    DRAWN,
    EDGE_COST,
    FINAL_INVERSE_TEMPERATURE,
    FREE,
    NEIGHBOUR_STEPS,
    OCCUPIED,
    UNSEEN_SQUARE,
    Counts,
    _flip_costs,
    costs,
    pictures,
)
from utak.geometry.counts.moments import blobs


def counts_of(truth: np.ndarray, side: int, shift: int = 0) -> Counts:
    """Return the exact counts of fields of side x side squares laid over a raster."""
    rows, columns = truth.shape
    flat = np.arange(truth.size).reshape(truth.shape)
    fields = [
        flat[r : r + side, c : c + side].ravel()
        for r in range(shift, rows - side + 1, side)
        for c in range(shift, columns - side + 1, side)
    ]
    where = np.array(fields, np.int32)
    count = truth.ravel()[where].sum(1).astype(np.int16)
    return Counts(where, np.ones(where.shape, np.int16), count, count)


def joined_counts(one: Counts, two: Counts) -> Counts:
    return Counts(*(np.concatenate(pair) for pair in zip(one, two, strict=True)))


NOTHING_COUNTED = Counts(
    np.zeros((0, 16), np.int32), np.zeros((0, 16), np.int16), np.zeros(0, np.int16), np.zeros(0, np.int16)
)


def square_world() -> np.ndarray:
    truth = np.zeros((24, 24), np.int8)
    truth[:4] = 1
    truth[9:14, 10:15] = 1
    return truth


def test_samples_show_what_the_counts_of_two_observations_determine() -> None:
    truth = square_world()
    ground = np.full(truth.shape, DRAWN, np.int8)
    counts = joined_counts(counts_of(truth, 4), counts_of(truth, 4, 2))
    drawn = pictures(ground, counts, np.zeros((8, *truth.shape), np.int8), 60, 0.5)
    assert np.abs(drawn.mean(0) - truth).mean() < 0.02


def test_samples_keep_fixed_squares_and_show_nothing_unseen() -> None:
    truth = square_world()
    ground = np.full(truth.shape, DRAWN, np.int8)
    ground[9:14, 10:15], ground[20:], ground[5, 5] = OCCUPIED, UNSEEN_SQUARE, FREE
    drawn = pictures(ground, counts_of(truth, 4), np.ones((3, *truth.shape), np.int8), 10, 0.5)
    assert drawn.shape == (3, 24, 24)
    assert (drawn[:, 9:14, 10:15] == 1).all()
    assert not drawn[:, 20:].any()
    assert not drawn[:, 5, 5].any()


def test_a_wall_one_square_off_is_moved_as_a_whole() -> None:
    truth = np.zeros((20, 20), np.int8)
    truth[:, 7:9] = 1
    ground = np.full(truth.shape, DRAWN, np.int8)
    ground[:, [0, -1]] = ground[[0, -1]] = UNSEEN_SQUARE
    beside = np.roll(truth, 1, axis=1)
    counts = joined_counts(counts_of(truth, 4, 1), counts_of(truth, 4, 3))
    drawn = pictures(ground, counts, np.repeat(beside[None], 6, 0), 4, FINAL_INVERSE_TEMPERATURE)
    shown = ground == DRAWN
    assert (drawn[:, shown] == truth[shown]).mean() > 0.97


def cost(image: np.ndarray, ground: np.ndarray, edge: float = EDGE_COST) -> float:
    """Return the cost of the outline of a raster, edge by edge and corner by corner."""
    total = 0.0
    for row, column in np.ndindex(image.shape[0] - 1, image.shape[1] - 1):
        part = slice(row, row + 2), slice(column, column + 2)
        if (ground[part] == UNSEEN_SQUARE).any():
            continue
        (a, b), (c, d) = image[part].tolist()
        edges = (a != b) + (c != d) + (a != c) + (b != d)
        corners = {0: 0, 2: 0 if a != d else 1, 4: 2}[edges] if edges != 2 or (a, b, c, d).count(1) == 2 else 1
        total += edge * edges / 2 + CORNER_COST * corners
    return total


@given(
    arrays(np.int8, (5, 5), elements=st.integers(0, 1)),
    arrays(np.int8, (5, 5), elements=st.sampled_from([DRAWN, DRAWN, DRAWN, UNSEEN_SQUARE])),
)
def test_the_cost_of_a_flip_is_the_difference_of_two_rasters(image: np.ndarray, ground: np.ndarray) -> None:
    ground[2, 2] = DRAWN
    image[ground == UNSEEN_SQUARE] = 0
    changed = image.copy()
    changed[2, 2] = 1 - image[2, 2]
    shown = 0
    for point in range(4):
        row, column = 2 - point // 2, 2 - point % 2
        shown |= int((ground[row : row + 2, column : column + 2] != UNSEEN_SQUARE).all()) << point
    neighbours = sum(int(image[2 + rows, 2 + across]) << n for n, (rows, across) in enumerate(NEIGHBOUR_STEPS))
    change = _flip_costs()[(shown << 9) + (neighbours << 1) + int(image[2, 2])]
    assert change == pytest.approx(cost(changed, ground) - cost(image, ground), abs=1e-5)


@given(
    arrays(np.int8, (2, 6, 7), elements=st.integers(0, 1)),
    arrays(np.int8, (6, 7), elements=st.sampled_from([DRAWN, DRAWN, DRAWN, UNSEEN_SQUARE])),
    arrays(np.int8, (6, 7), elements=st.integers(0, 1)),
    st.sampled_from([EDGE_COST, 0.0]),
)
def test_a_raster_costs_its_outline_and_the_errors_of_its_counts(
    images: np.ndarray, ground: np.ndarray, truth: np.ndarray, edge: float
) -> None:
    images[:, ground == UNSEEN_SQUARE] = 0
    counts = counts_of(truth, 3)
    where = counts.where.reshape(-1, 9)
    for image, found in zip(images, costs(images, ground, counts, edge), strict=True):
        off = abs(image.ravel()[where].sum(1, dtype=int) - truth.ravel()[where].sum(1, dtype=int)).sum()
        assert found == pytest.approx(cost(image, ground, edge) + COUNT_ERROR_COST * off)


def test_the_same_arguments_give_the_same_samples() -> None:
    truth = square_world()
    ground = np.full(truth.shape, DRAWN, np.int8)
    first, again = (
        pictures(ground, counts_of(truth, 4), np.zeros((4, *truth.shape), np.int8), 20, 0.5) for _ in range(2)
    )
    assert np.array_equal(first, again)


def test_straight_sides_are_preferred() -> None:
    truth = np.zeros((16, 16), np.int8)
    truth[:, :6] = 1  # a field of side 4 is half full wherever the wall's edge lies in it
    drawn = pictures(
        np.full(truth.shape, DRAWN, np.int8), counts_of(truth, 4), np.zeros((8, *truth.shape), np.int8), 80, 0.5
    )
    assert np.abs(drawn.mean(0) - truth).mean() < 0.08


@pytest.mark.parametrize("begun", [0, 1])
def test_a_square_under_no_field_is_drawn_so_that_the_raster_is_simple(begun: int) -> None:
    truth = square_world()
    ground = truth.copy()
    corner, middle, floor, wall = (9, 10), (11, 12), (16, 5), (3, 20)
    for square in (corner, middle, floor, wall):
        ground[square] = DRAWN
    drawn = pictures(ground, NOTHING_COUNTED, np.full((12, *truth.shape), begun, np.int8), 40, 1.0)
    share = np.abs(drawn - truth).mean(0)
    assert share[corner] < 0.3  # without it the square has two corners more
    assert max(share[middle], share[floor], share[wall]) < 0.05


def test_without_fields_there_is_nothing_to_draw() -> None:
    ground, first = np.full((3, 4), OCCUPIED, np.int8), np.zeros((2, 3, 4), np.int8)
    assert pictures(ground, NOTHING_COUNTED, first, 5, 0.5).tolist() == [[[1] * 4] * 3] * 2


@pytest.mark.parametrize(("side", "seen"), [(1, True), (5, True), (5, False)])
def test_moments_of_a_square(side: int, seen: bool) -> None:
    image = np.zeros((side + 2, side + 2), np.int8)
    image[1:-1, 1:-1] = 1
    ground = np.where(image == 1, DRAWN, DRAWN if seen else UNSEEN_SQUARE).astype(np.int8)
    found = blobs(image, ground)
    assert found.area.tolist() == [side * side]
    assert found.outward.tolist() == [0 if seen else 4 * side]
    assert found.spread == pytest.approx([1 / 6])
    assert found.lengthy == pytest.approx([0])


def test_parts_that_touch_at_a_corner_are_two() -> None:
    found = blobs(np.eye(4, dtype=np.int8), np.full((4, 4), DRAWN, np.int8))
    assert found.area.tolist() == [1] * 4
    assert found.labels.max() == 4


def test_an_empty_raster_has_no_parts() -> None:
    assert blobs(np.zeros((4, 4), np.int8), np.full((4, 4), DRAWN, np.int8)).area.tolist() == []
