"""What can be reached on the state lattice is what has a cost to go."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity, box

from utak.geometry.state_lattice.footprints import PUSH_DIRECTIONS, new_footprints
from utak.geometry.state_lattice.heuristic import COST_UNREACHABLE, NO_DIRECTION, can_reach_end, cost_to_go
from utak.geometry.state_lattice.lattice import (
    COMMAND_COST,
    StateLattice,
    new_lattice_body,
    new_lattice_floor,
    new_lattice_grid,
    new_state_lattice,
    turn_cost,
)

SHAPES = [box(0, 0, 1, 1), box(0, 0, 4, 2), shapely.Polygon([(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)])]


def near_origin(shape: shapely.Polygon) -> shapely.Polygon:
    """Return a shape moved by whole squares so that its centroid lies in the square (0, 0)."""
    middle = shape.centroid
    return affinity.translate(shape, -np.floor(middle.x), -np.floor(middle.y))


@st.composite
def floors(draw: st.DrawFn) -> np.ndarray:
    """Return a room of up to 12 x 14 free squares with some blocks in it."""
    free = np.zeros((draw(st.integers(6, 14)), draw(st.integers(6, 16))), np.bool_)
    free[1:-1, 1:-1] = True
    for _ in range(draw(st.integers(0, 7))):
        row, column = draw(st.integers(0, 12)), draw(st.integers(0, 14))
        free[row : row + draw(st.integers(1, 4)), column : column + draw(st.integers(1, 4))] = False
    return free


def lattice_of(shape: shapely.Polygon, free: np.ndarray) -> tuple[StateLattice, np.ndarray]:
    """Return the state lattice of a shape on a floor, and the numbers of the squares of the table."""
    body = new_footprints(near_origin(shape))
    on_grid = new_lattice_body(new_lattice_grid(free.shape[1], free.shape[0], body, body), body, body)
    grips, allowed = np.zeros(len(body.holds), np.int32), np.ones((4, len(body.holds), 8), np.bool_)
    floor = new_lattice_floor(free, on_grid)
    return new_state_lattice(floor, on_grid, free, grips, allowed, COMMAND_COST), on_grid.grid.table_squares()


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(SHAPES), floors(), st.data())
def test_an_end_can_be_reached_where_there_is_a_cost_to_go(
    shape: shapely.Polygon, free: np.ndarray, data: st.DataObject
) -> None:
    lattice, table = lattice_of(shape, free)
    ends = np.full((4, len(lattice.solid)), -1, np.int32)
    for _ in range(data.draw(st.integers(0, 3))):
        ends[data.draw(st.integers(0, 3)), table[data.draw(st.integers(0, len(table) - 1))]] = 0
    remaining = cost_to_go(lattice, ends, COMMAND_COST)
    for place in table.tolist():
        reached = 0 <= remaining[0, NO_DIRECTION, place] < COST_UNREACHABLE
        assert can_reach_end(lattice, ends, place) == reached


def are_free(free: np.ndarray, offsets: np.ndarray, square: np.ndarray) -> bool:
    """Return whether all squares at some offsets (east, north) from a square (row, column) are free."""
    met = offsets + square[::-1] + 20
    return bool(np.pad(free, 20)[met[:, 1], met[:, 0]].all())


@pytest.mark.long
@settings(max_examples=30, deadline=None)
@given(st.sampled_from(SHAPES), floors())
def test_a_push_is_free_where_all_the_squares_that_it_meets_are(shape: shapely.Polygon, free: np.ndarray) -> None:
    (lattice, table), body = lattice_of(shape, free), new_footprints(near_origin(shape))
    for place, square in zip(table.tolist(), np.argwhere(np.ones_like(free)), strict=True):
        for d in range(len(PUSH_DIRECTIONS)):
            assert (lattice.push_cost[0, d, place] > 0) == are_free(free, body.steps[d], square)


@settings(max_examples=30, deadline=None)
@given(st.sampled_from(SHAPES), floors())
def test_a_turn_is_free_where_all_the_squares_that_it_meets_are(shape: shapely.Polygon, free: np.ndarray) -> None:
    (lattice, table), body = lattice_of(shape, free), new_footprints(near_origin(shape))
    for place, square in zip(table.tolist(), np.argwhere(np.ones_like(free)), strict=True):
        for hold, turn in enumerate(body.turns):
            met = np.vstack([turn, body.lying])
            assert (turn_cost(lattice, hold, 0, place, 1) == 0) == are_free(free, met, square)
