"""The true frame is never given up while motions are exact; wrong ones are."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.eyes import random_room, retina, world_of
from utak.kb.localisation.hypotheses.frames import (
    CENTRED_HYPOTHESES,
    FRAME_ANGLES,
    ORIGIN_GRID,
    Hypothesis,
    Observation,
    UnsettledDisc,
    any_origin,
    consistent_hypotheses,
    count_contradictions,
    frames_to_try,
    grid_cell_size,
    is_cramped,
    origin_box,
    origin_grid,
    prune_hypotheses,
)
from utak.kb.perception.frame import CENTRE, Frame, turned
from utak.kb.perception.retina import count_ranges

Point = tuple[float, float]


def angle_of(heading: int) -> int:
    """Return the orientation of the grid for a heading on the table: what quarter turns leave, in degrees."""
    return (heading + 44) % 90 - 44


def observations_of(rows: list[str], heading: int, places: list[Point]) -> list[Observation]:
    """Return the observations from exact points of the table frame; Utak wakes at the first one."""
    occupied = world_of(rows)
    observations = []
    for x, y in places:
        seen = retina(occupied, (math.floor(x), math.floor(y)), heading)
        observations.append(Observation(count_ranges(seen), turned(x - places[0][0], y - places[0][1], -heading)))
    return observations


def origin(heading: int, point: Point) -> Point:
    """Return the true origin within the square of waking, map frame. point : table frame."""
    quarters = heading - angle_of(heading)
    x, y = turned(point[0] % 1 - 0.5, point[1] % 1 - 0.5, -quarters)
    return x + 0.5, y + 0.5


def holds(hypothesis: Hypothesis, angle: int, point: Point) -> bool:
    """Return whether a hypothesis allows an orientation and an origin."""
    west, south, east, north = hypothesis.box
    slack = 1e-9
    inside = west - slack <= point[0] <= east + slack and south - slack <= point[1] <= north + slack
    return hypothesis.angle == angle and inside


def scene(seed: int, count: int) -> tuple[list[str], int, list[Point]]:
    rng = np.random.default_rng(seed)
    rows = random_room(rng, *rng.integers(12, 36, 2), things=rng.integers(1, 7))
    free = [(i, len(rows) - 1 - n) for n, row in enumerate(rows) for i, mark in enumerate(row) if mark == "."]
    chosen = [free[k] for k in rng.integers(len(free), size=count)]
    places = [(x + rng.uniform(0.02, 0.98), y + rng.uniform(0.02, 0.98)) for x, y in chosen]
    return rows, int(rng.integers(360)), places


@settings(max_examples=6, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_true_frame_is_never_given_up(seed: int) -> None:
    rows, heading, places = scene(seed, 3)
    observations = observations_of(rows, heading, places)
    left = consistent_hypotheses(observations)
    assert any(holds(h, angle_of(heading), origin(heading, places[0])) for h in left)
    for angle in {h.angle for h in left}:  # parts of one square
        assert sum(h.area for h in left if h.angle == angle) <= 1 + 1e-9


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_an_origin_in_the_middle_is_never_given_up(seed: int) -> None:
    rows, heading, places = scene(seed, 4)
    centred = (math.floor(places[0][0]) + 0.5, math.floor(places[0][1]) + 0.5)
    observations = observations_of(rows, heading, [centred, *places[1:]])
    hypotheses = CENTRED_HYPOTHESES
    for number in range(1, len(observations) + 1):
        hypotheses = prune_hypotheses(hypotheses, observations[:number])
        assert angle_of(heading) in {h.angle for h in hypotheses}
        assert count_contradictions(Frame(angle_of(heading)), observations[:number]) == 0


ROOM = [
    "b" * 26,
    *["b" + "." * 24 + "b"] * 8,
    *["b.....ggg................b"] * 3,
    *["b" + "." * 24 + "b"] * 9,
    "b" * 26,
]


@pytest.mark.parametrize("heading", [20, 117, 300])
def test_wrong_orientations_are_given_up(heading: int) -> None:
    observations = observations_of(ROOM, heading, [(12.5, 10.5), (14.7, 6.2), (5.5, 15.5), (20.1, 4.4)])
    assert count_contradictions(Frame(0), observations) > 0
    hypotheses = CENTRED_HYPOTHESES
    for number in range(1, len(observations) + 1):
        hypotheses = prune_hypotheses(hypotheses, observations[:number])
    assert hypotheses
    assert all(abs(h.angle - angle_of(heading)) <= 6 for h in hypotheses)


def test_observations_of_an_oblique_edge_give_up_utaks_own_axes() -> None:
    observations = observations_of(ROOM, 27, [(4.5, 4.5)])
    assert 0 in {h.angle for h in CENTRED_HYPOTHESES}
    later = observations_of(ROOM, 27, [(4.5, 4.5), (7.5, 4.5), (4.5, 7.5)])
    assert count_contradictions(Frame(0), later) > 0
    assert count_contradictions(Frame(27), observations) == 0


def test_a_wrong_place_is_a_contradiction() -> None:
    honest = observations_of(ROOM, 0, [(12.5, 10.5), (12.5, 8.5)])
    moved = [honest[0], Observation(honest[1].ranges, (3.0, 0.0))]
    assert count_contradictions(Frame(0), honest) == 0
    assert count_contradictions(Frame(0), moved) > 0


@given(st.integers(-44, 45), st.tuples(st.floats(-40, 40), st.floats(-40, 40)))
def test_a_split_covers_the_box_and_separates_squares(angle: int, place: Point) -> None:
    whole = Hypothesis(angle, (0.0, 0.0, 1.0, 1.0))
    parts = whole.split(place)
    area = sum(part.area for part in parts)
    assert area == pytest.approx(1.0)
    for w, s, e, n in (part.box for part in parts):
        squares = set()
        for fx, fy in ((0.01, 0.01), (0.5, 0.5), (0.99, 0.99), (0.01, 0.99)):
            point = (w + fx * (e - w), s + fy * (n - s))
            x, y = Frame(angle, point).place_from_utak(*place)
            squares.add((math.floor(x), math.floor(y)))
        if min(e - w, n - s) > 1e-6:
            assert len(squares) == 1


def test_the_believed_frame_is_tried_first_then_utaks_own_axes() -> None:
    held = Frame(3)
    tried = frames_to_try(CENTRED_HYPOTHESES, held)
    assert tried[:2] == [held, Frame(0)]
    assert sorted(frame.angle for frame in tried) == list(range(-44, 46))


def test_of_other_orientations_the_median_is_tried_first() -> None:
    others = tuple(h for h in CENTRED_HYPOTHESES if h.angle > 10)
    tried = frames_to_try(others, Frame(3))
    assert tried[0].angle == 28  # the middle of 11 to 45
    away = [abs(frame.angle - 28) for frame in tried]
    assert away == sorted(away)
    assert frames_to_try((), Frame(3)) == []


def test_every_orientation_is_tried_once() -> None:
    assert sorted(FRAME_ANGLES) == list(range(-44, 46))
    assert FRAME_ANGLES[0] == 0
    assert all(h.frame.origin == CENTRE for h in CENTRED_HYPOTHESES)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_every_origin_of_the_box_has_the_same_squares(seed: int) -> None:
    rows, heading, places = scene(seed, 4)
    observations = observations_of(rows, heading, places)
    true = Frame(angle_of(heading), origin(heading, places[0]))
    west, south, east, north = origin_box(true, observations)
    assert west <= true.origin[0] <= east
    assert south <= true.origin[1] <= north
    squares = {tuple(math.floor(v) for v in true.place_from_utak(*observation.place)) for observation in observations}
    for point in origin_grid(true, observations):
        other = point.frame
        assert {
            tuple(math.floor(v) for v in other.place_from_utak(*observation.place)) for observation in observations
        } == squares
    if east < 1:
        other = Frame(true.angle, (east + 1e-6, true.origin[1]))
        assert {
            tuple(math.floor(v) for v in other.place_from_utak(*observation.place)) for observation in observations
        } != squares


def test_observations_need_not_agree_where_an_object_was_moved() -> None:
    gone = [row.replace("ggg", "...") for row in ROOM]
    observations = [*observations_of(ROOM, 0, [(12.5, 10.5)]), *observations_of(gone, 0, [(12.5, 10.5)])]
    assert count_contradictions(Frame(), observations) > 0
    away = UnsettledDisc((7.5 - 12.5, 11.5 - 10.5), 4.0)
    assert count_contradictions(Frame(), observations, [away]) == 0
    assert count_contradictions(Frame(), observations, [UnsettledDisc((9.0, -7.0), 2.0)]) > 0
    turned_observations = observations_of(ROOM, 3, [(12.5, 10.5), (14.7, 6.2), (5.5, 15.5), (20.1, 4.4)])
    assert 0 not in {h.angle for h in consistent_hypotheses(turned_observations, any_origin((0,)), [away])}
    assert 3 in {h.angle for h in consistent_hypotheses(turned_observations, any_origin((0, 3)), [away])}


def test_a_hypothesis_contains_the_frames_of_its_box() -> None:
    half = Hypothesis(2, (0.0, 0.0, 0.5, 1.0))
    assert half.contains(Frame(2, (0.2, 0.9)))
    assert not half.contains(Frame(2, (0.7, 0.9)))
    assert not half.contains(Frame(1, (0.2, 0.9)))
    point = Hypothesis(0, CENTRE + CENTRE)
    assert point.is_point
    assert point.contains(Frame())
    assert not point.contains(Frame(0, (0.5, 0.6)))


def test_of_one_orientation_the_largest_box_is_tried_first() -> None:
    boxes = (Hypothesis(0, (0.0, 0.0, 0.1, 0.1)), Hypothesis(0, (0.6, 0.0, 1.0, 1.0)))
    assert frames_to_try(boxes, Frame())[0].origin == (0.8, 0.5)


def test_true_observations_rarely_leave_a_cramped_origin() -> None:
    rng, found, tried = np.random.default_rng(4), 0, 4000
    for _ in range(tried):
        observations = int(rng.integers(1, 15))
        box = []
        for origin in rng.random(2):
            cuts = np.sort(np.append(rng.random(observations), (0.0, 1.0)))
            at = int(np.searchsorted(cuts, origin))
            box.append((cuts[at - 1], cuts[at]))
        (west, east), (south, north) = box
        found += is_cramped([Hypothesis(3, (west, south, east, north))], observations)
    assert found / tried < 0.02


def test_a_thin_box_is_cramped_whatever_its_length() -> None:
    assert is_cramped([Hypothesis(1, (0.1, 0.4, 0.9, 0.402))], 3)
    assert not is_cramped([Hypothesis(1, (0.1, 0.4, 0.9, 0.402)), Hypothesis(2, (0.1, 0.4, 0.2, 0.6))], 3)
    assert not is_cramped(CENTRED_HYPOTHESES[:2], 3)
    assert not is_cramped([], 3)


def test_the_cells_of_an_origin_grid_fill_its_box() -> None:
    observations = observations_of(ROOM, 0, [(12.5, 10.5), (14.5, 6.25)])
    west, south, east, north = origin_box(Frame(), observations)
    where = origin_grid(Frame(), observations)
    assert grid_cell_size(where) == pytest.approx(((east - west) / ORIGIN_GRID, (north - south) / ORIGIN_GRID))
    assert grid_cell_size(where[3:40]) == pytest.approx(grid_cell_size(where))
    assert grid_cell_size(where[:1]) == (0.0, 0.0)
