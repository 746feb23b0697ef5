"""Connected components of a raster against flood filling."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.raster.components import bounding_boxes, components


def flood(mask: np.ndarray) -> np.ndarray:
    """Return labels in raster order, found by flood filling."""
    labels, count = np.zeros(mask.shape, int), 0
    for start in np.argwhere(mask).tolist():
        if labels[tuple(start)]:
            continue
        count += 1
        edge = [tuple(start)]
        while edge:
            row, column = edge.pop()
            if (
                0 <= row < mask.shape[0]
                and 0 <= column < mask.shape[1]
                and mask[row, column]
                and not labels[row, column]
            ):
                labels[row, column] = count
                edge += [(row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)]
    return labels


@settings(max_examples=300, deadline=None)
@given(st.integers(1, 14), st.integers(1, 14), st.integers(0, 2**32 - 1), st.floats(0, 1))
def test_labels_equal_those_of_flood_filling(rows: int, columns: int, seed: int, density: float) -> None:
    mask = np.random.default_rng(seed).random((rows, columns)) < density
    found = components(mask)
    want = flood(mask)
    assert found.number == want.max()
    assert np.array_equal(found.labels, want)


@settings(max_examples=100, deadline=None)
@given(st.integers(1, 14), st.integers(1, 14), st.integers(0, 2**32 - 1), st.floats(0, 1))
def test_bounding_rectangles_fit_their_components(rows: int, columns: int, seed: int, density: float) -> None:
    found = components(np.random.default_rng(seed).random((rows, columns)) < density)
    for label, box in enumerate(bounding_boxes(found.labels, found.number).tolist()):
        places = np.argwhere(found.labels == label)
        if label or len(places):
            assert box == [*places.min(0).tolist(), *places.max(0).tolist()]


def test_a_label_without_squares_has_no_rectangle() -> None:
    assert bounding_boxes(np.ones((2, 3), np.int32), 2).tolist() == [[2, 3, -1, -1], [0, 0, 1, 2], [2, 3, -1, -1]]


def test_a_comb_and_a_spiral_are_one_component_each() -> None:
    comb = np.zeros((9, 41), bool)
    comb[:, ::2] = comb[4] = True
    assert components(comb).number == 1
    spiral = np.array(
        [list(row) for row in ("#######", "......#", "#####.#", "#...#.#", "#.###.#", "#.....#", "#######")]
    )
    assert components(spiral == "#").number == 1
    assert components(spiral == ".").number == 1


def test_views_of_larger_arrays_are_accepted() -> None:
    mask = np.zeros((8, 8), bool)
    mask[::2] = True
    assert components(mask[:, ::3]).number == 4
    assert components(mask.T).number == 4
