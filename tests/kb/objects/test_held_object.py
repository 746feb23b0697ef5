"""A held object is subtracted from an impression exactly, whatever it hides; and the outcomes of its motions."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from tests.kb.eyes import impression, random_room, world_of
from tests.kb.localisation.hypotheses.test_remap import around
from utak.geometry.counts.retina import FIELDS, OWN_FIELD
from utak.geometry.motion.se2 import Rotate, Translate
from utak.kb.localisation.hypotheses.carry_outcomes import other_outcomes, predicted_outcome
from utak.kb.mapping.occupancy import OccupancyMap
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import HeldObject, outline_tolerance, snap_to_grid, subtract_held_objects
from utak.kb.perception.frame import Frame
from utak.kb.perception.retina import count_ranges

BRICK = shapely.box(0, 0, 4, 2)
ELL = shapely.Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)])


def load(polygon: shapely.Polygon, slack: float = 0.0) -> HeldObject:
    return HeldObject("o1", polygon, polygon, slack)


def squares_of(polygon: shapely.Polygon) -> set[tuple[int, int]]:
    """Return the squares that a polygon covers, computed by shapely alone."""
    x0, y0, x1, y1 = (int(np.floor(v)) for v in polygon.bounds)
    return {
        (x, y)
        for x in range(x0, x1 + 2)
        for y in range(y0, y1 + 2)
        if shapely.box(x, y, x + 1, y + 1).intersection(polygon).area > 1e-9
    }


@given(st.floats(-20, 20), st.floats(-20, 20), st.floats(0, 360))
@settings(max_examples=60, deadline=None)
def test_a_held_object_covers_its_squares(x: float, y: float, degrees: float) -> None:
    polygon = translate(rotate(ELL, degrees), round(x, 3), round(y, 3))
    assert patch_of_polygon(polygon).squares() == squares_of(polygon)


@given(st.floats(0, 1) | st.sampled_from([5e-324, 1e-17, 1e-12, 1e-6]))
@settings(max_examples=60, deadline=None)
def test_a_held_object_may_cover_at_least_the_squares_that_it_surely_covers(far: float) -> None:
    some = replace(load(ELL), astray=far)
    assert some.sure.squares() <= squares_of(ELL) <= some.possible.squares()


@given(st.integers(-9, 9), st.integers(-9, 9), st.integers(0, 3), st.integers(-44, 45), st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_an_impression_without_the_held_object_is_that_of_a_table_without_it(
    x: int, y: int, quarter: int, angle: int, seed: int
) -> None:
    polygon = snap_to_grid(translate(rotate(ELL, 90 * quarter, origin=(0, 0)), x, y))
    own = squares_of(polygon)
    if (0, 0) in own:
        return
    others = {tuple(square) for square in np.random.default_rng(seed).integers(-14, 14, (80, 2)).tolist()} - own
    with_load = impression(lambda i, j: (i, j) in others or (i, j) in own, (0, 0), angle)
    samples, ranges = subtract_held_objects(
        Frame(angle).samples(), count_ranges(with_load.retina), 0, 0, [load(polygon)]
    )
    for number in range(len(FIELDS)):
        if number == OWN_FIELD:
            continue
        seen = zip(samples.columns[number], samples.rows[number], samples.weight[number], strict=True)
        count = sum(int(weight) for column, row, weight in seen if (int(column), int(row)) in others)
        slack = int(samples.slack[number])
        assert ranges[number, 0] - slack <= count <= ranges[number, 1]


def test_subtracting_an_object_that_is_not_there_gives_negative_counts() -> None:
    empty = impression(lambda i, j: False, (0, 0))
    _, ranges = subtract_held_objects(
        Frame().samples(), count_ranges(empty.retina), 0, 0, [load(translate(BRICK, 1, 1))]
    )
    assert (ranges[:, 1] < 0).any()


def test_the_edge_squares_of_a_slanted_held_object_are_open_until_seen() -> None:
    askew = translate(rotate(BRICK, 20), 0.3, 1.2)
    assert outline_tolerance(askew) > 0 == outline_tolerance(BRICK)
    before = load(askew, outline_tolerance(askew))
    assert before.sure.squares() < patch_of_polygon(askew).squares() < before.possible.squares()
    true = squares_of(askew)
    observation = impression(lambda i, j: (i, j) in true, (2, -1))
    after = before.seen(Frame().samples(), count_ranges(observation.retina), 2, -1)
    near = {(i, j) for i in range(-2, 6) for j in range(-5, 3)}
    assert after.sure.squares() & near == after.possible.squares() & near == true & near


def test_a_motion_may_go_as_commanded_or_not_at_all_or_end_early() -> None:
    place, motion = (5.5, 0.5), Translate(3.0, 0.0)
    assert predicted_outcome(place, BRICK, motion).polygon.equals(translate(BRICK, 3, 0))
    outcomes = list(other_outcomes(place, BRICK, motion))
    stuck = [o for o in outcomes if o.how == "stuck"]
    assert [o.place for o in stuck] == [place]
    assert stuck[0].polygon.equals(BRICK)
    stops = [o.place[0] for o in outcomes if o.how == "blocked"]
    assert stops == sorted(stops, reverse=True)
    assert 5.5 < stops[-1] < stops[0] < 8.5
    for outcome in outcomes:
        assert outcome.place[0] - outcome.polygon.bounds[0] == pytest.approx(5.5)


def test_a_turn_keeps_the_robot_in_place_and_its_centre_is_uncertain() -> None:
    place, motion = (5.5, 0.5), Rotate(90.0, (5.5, 0.5))
    true = rotate(BRICK, 90, origin=(5.25, 0.75))
    outcomes = [predicted_outcome(place, BRICK, motion), *other_outcomes(place, BRICK, motion)]
    assert {outcome.place for outcome in outcomes} == {place}
    assert min(outcome.polygon.symmetric_difference(true).area for outcome in outcomes) < 0.2


@pytest.mark.long
@example(991676, 10, 55.031408332442226, True)
@example(322096, 45, 109.93298110907814, True)
@given(st.integers(0, 10_000), st.sampled_from([0, 10, 30, 45, 326]), st.floats(0, 360), st.booleans())
@settings(max_examples=80, deadline=None)
def test_an_impression_of_the_true_table_never_contradicts_the_map(
    seed: int, heading: int, degrees: float, whole_: bool
) -> None:
    rng = np.random.default_rng(seed)
    rows = random_room(rng, 24, 24, 4)
    frame = Frame((heading + 45) % 90 - 45)
    free = [(i, j) for j, row in enumerate(reversed(rows)) for i, mark in enumerate(row) if mark == "."]
    occupancy, occupied = OccupancyMap(), world_of(rows)
    quarters = round((heading - frame.angle) / 90)
    for number, at in enumerate(rng.choice(len(free), 3)):
        there = free[at]
        ranges = count_ranges(impression(occupied, there, heading).retina)
        occupancy.observe(frame.samples(), ranges, *on_lattice(there, quarters), number)
    middle, here = (free[at] for at in rng.choice(len(free), 2))
    turn = 90.0 * round(degrees / 90) if whole_ else round(degrees, 3)
    thing = translate(rotate(ELL, turn, origin=(0, 0)), *middle)
    with_it = around(thing, occupied)
    assume(not with_it(*here))
    lying = rotate(thing, -90 * quarters, origin=(0, 0))
    observation = count_ranges(impression(with_it, here, heading).retina)
    x, y = on_lattice(here, quarters)
    freed = subtract_held_objects(frame.samples(), observation, x, y, [load(snap_to_grid(lying))])
    assert occupancy.clashes(*freed, x, y) == 0


def on_lattice(square: tuple[int, int], quarters: int) -> tuple[int, int]:
    """Return a square of the table in the map frame, if the robot frame is turned by quarter turns."""
    x, y = square[0] + 0.5, square[1] + 0.5
    for _ in range(quarters % 4):
        x, y = y, -x
    return math.floor(x), math.floor(y)
