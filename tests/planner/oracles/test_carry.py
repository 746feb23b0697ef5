"""The oracle of carrying, in drawn rooms: what it finds can be carried out, and what it refutes is shut off."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.worlds.drawn import drawn_problem, drawn_situation
from tests.planner.situations import known_situation
from utak.geometry.manipulation.goals import At, Inside
from utak.geometry.motion.se2 import Pose, Translate
from utak.planner.oracles.carry import CarryOracle, Certainty
from utak.planner.oracles.spots import corner_spots, kept_way_of, spots, turned_corner_outlines

ROOM = [
    "b" * 20,
    *["b" + "." * 18 + "b"] * 4,
    *["b...ggg.....hhh....b"] * 3,
    "b" + "." * 9 + "U" + "." * 8 + "b",
    *["b" + "." * 18 + "b"] * 3,
    "b" * 20,
]
CORRIDOR = [
    "b" * 20,
    *["b" + "." * 8 + "b" * 11] * 2,
    *["b..ggg.............b"] * 3,
    "b.......U" + "b" * 11,
    *["b" + "." * 8 + "b" * 11] * 2,
    "b" * 20,
]
UNSEEN_END = [  # nothing shows whether the corridor leads on
    "b" * 14 + "?" * 20,
    "b......bbbbbbb" + "?" * 20,
    *["b.ggg........." + "?" * 20] * 2,
    "b.gggU........" + "?" * 20,
    "b......bbbbbbb" + "?" * 20,
    "b" * 14 + "?" * 20,
]


def test_a_thing_is_brought_to_a_pose_and_the_robot_stands_beside_it() -> None:
    situation = drawn_situation(ROOM)
    problem = drawn_problem(situation, {"g": At(Pose(2.0, 3.0, 0.0))})
    oracle = CarryOracle(problem, situation)
    answer = oracle.bring(problem.state, "g", problem.places["g", "g1_pose"], "g1_pose")
    assert answer.certainty == Certainty.SURE and answer.after is not None
    before, after = problem.state.things["g"], answer.after.things["g"]
    assert after.outline.equals_exact(Translate(2.0, 3.0).carry(before.outline), 1e-9)
    assert after.outline.distance(shapely.Point(answer.after.robot)) <= np.sqrt(0.5) + 1e-9
    assert answer.after.things["h"] == problem.state.things["h"]
    assert after.reach(problem.places["g", "g1_pose"]) == At(Pose(0.0, 0.0, 0.0))


def test_an_answer_is_remembered() -> None:
    situation = drawn_situation(ROOM)
    problem = drawn_problem(situation, {"g": At(Pose(2.0, 3.0, 0.0))})
    oracle = CarryOracle(problem, situation)
    answers = [oracle.bring(problem.state, "g", problem.places["g", "g1_pose"], "g1_pose") for _ in range(2)]
    assert answers[0] is answers[1] and oracle.asked == 1


@pytest.mark.parametrize("on_lattice", [True, False])
def test_the_robot_does_not_end_behind_a_thing_where_the_floor_is_only_hoped_to_lead_on(on_lattice: bool) -> None:
    situation = known_situation(UNSEEN_END)
    problem = drawn_problem(situation, {"g": At(Pose(10.0, 0.0, 0.0))})
    oracle = CarryOracle(problem, situation, on_lattice=on_lattice)
    answer = oracle.bring(problem.state, "g", problem.places["g", "g1_pose"], "g1_pose")
    assert answer.certainty == Certainty.HOPED and answer.after is not None and answer.avoid
    assert answer.after.robot[0] < answer.after.things["g"].outline.bounds[0]


@pytest.mark.parametrize("on_lattice", [True, False])
def test_a_pose_within_a_wall_is_refuted_wherever_the_robot_stands(on_lattice: bool) -> None:
    situation = drawn_situation(ROOM)
    problem = drawn_problem(situation, {"g": At(Pose(-6.0, 0.0, 0.0))})
    oracle = CarryOracle(problem, situation, on_lattice=on_lattice)
    end = problem.places["g", "g1_pose"]
    assert oracle.is_refuted(problem.state, "g", end, frozenset())
    assert oracle.asked == 1  # geometry is asked about the most floor alone
    assert oracle.bring(problem.state, "g", end, "g1_pose").certainty == Certainty.REFUTED
    assert oracle.is_refuted_from_anywhere(problem.state, "g", end, frozenset())


def test_a_thing_is_not_pulled_into_a_dead_end_in_front_of_the_robot() -> None:
    situation = drawn_situation(CORRIDOR)
    problem = drawn_problem(situation, {"g": At(Pose(8.0, 0.0, 0.0))})
    answer = CarryOracle(problem, situation).bring(problem.state, "g", problem.places["g", "g1_pose"], "g1_pose")
    assert answer.after is not None
    assert answer.after.robot[0] < answer.after.things["g"].outline.bounds[0]


@settings(max_examples=25, deadline=None)
@given(st.integers(-9, 9), st.integers(-7, 7))
def test_found_and_refuted_poses_are_those_that_fit(dx: int, dy: int) -> None:
    """In an open room a thing can be brought to just the poses in which it lies on the floor and on no other thing."""
    situation = drawn_situation(ROOM)
    problem = drawn_problem(situation, {"g": At(Pose(float(dx), float(dy), 0.0))})
    oracle = CarryOracle(problem, situation, on_lattice=True)
    outline = Translate(float(dx), float(dy)).carry(problem.state.things["g"].outline)
    rows, columns = situation.model.labels.shape
    fits = shapely.box(1, 1, columns - 1, rows - 1).contains(outline)
    fits = fits and outline.intersection(problem.state.things["h"].outline).area == 0
    answer = oracle.bring(problem.state, "g", problem.places["g", "g1_pose"], "g1_pose")
    assert (answer.certainty != Certainty.REFUTED) == fits


@settings(max_examples=25, deadline=None)
@given(st.data())
def test_spots_lie_on_the_floor_apart_from_each_other_and_off_what_must_stay_clear(data: st.DataObject) -> None:
    rows, columns = data.draw(st.integers(8, 16)), data.draw(st.integers(8, 16))
    floor = np.ones((rows, columns), np.bool_)
    floor[0] = floor[-1] = False
    floor[:, 0] = floor[:, -1] = False
    keep = np.zeros_like(floor)
    keep[data.draw(st.integers(1, rows - 2))] = True
    outline = shapely.box(2, 2, 4, 4)
    moves = spots(outline, floor, floor, keep)
    places = [Translate(float(x), float(y)).carry(outline) for x, y in moves]
    inside = shapely.box(1, 1, columns - 1, rows - 1)
    assert all(inside.contains(place) for place in places)
    assert len(set(moves)) == len(moves) and (0, 0) not in moves
    on_keep = [bool(keep[int(place.bounds[1]) : int(place.bounds[3]), 2].any()) for place in places]
    assert on_keep == sorted(on_keep)  # places off what must stay clear come first


@settings(max_examples=25, deadline=None)
@given(st.data())
def test_corner_spots_touch_two_walls_and_the_furthest_comes_first(data: st.DataObject) -> None:
    rows, columns = data.draw(st.integers(8, 16)), data.draw(st.integers(8, 16))
    width, height = data.draw(st.integers(1, 4)), data.draw(st.integers(1, 4))
    floor = np.zeros((rows, columns), np.bool_)
    floor[1:-1, 1:-1] = True
    x, y = data.draw(st.integers(1, columns - 1 - width)), data.draw(st.integers(1, rows - 1 - height))
    moves = corner_spots(shapely.box(x, y, x + width, y + height), floor, floor)
    places = {(x + dx, y + dy) for dx, dy in moves}
    corners = {(a, b) for a in (1, columns - 1 - width) for b in (1, rows - 1 - height)}
    assert len(moves) == len(places) and (x, y) not in places
    assert places == corners - {(x, y)} or ((x, y) in corners and places >= corners - {(x, y)})
    lengths = [max(abs(dx), abs(dy)) + 0.42 * min(abs(dx), abs(dy)) for dx, dy in moves]
    assert lengths == pytest.approx(sorted(lengths, reverse=True), abs=1.5)


@settings(max_examples=25, deadline=None)
@given(st.data())
def test_turned_corner_outlines_are_the_thing_turned_by_quarters_in_the_corners_of_the_floor(
    data: st.DataObject,
) -> None:
    rows, columns = data.draw(st.integers(8, 16)), data.draw(st.integers(8, 16))
    width, height = data.draw(st.integers(1, 4)), data.draw(st.integers(1, 4))
    floor = np.zeros((rows, columns), np.bool_)
    floor[1:-1, 1:-1] = True
    outline = shapely.box(1, 1, 1 + width, 1 + height)
    if data.draw(st.booleans()):
        outline = shapely.Polygon([(1, 1), (5, 1), (5, 2), (2, 2), (2, 5), (1, 5)])  # an L
    found = turned_corner_outlines(outline, floor)
    assert len(found) == (12 if len(outline.exterior.coords) > 5 else 0 if width == height else 4)
    for one in found:
        low, high = np.round(one.bounds[:2]), np.round(one.bounds[2:])
        assert one.area == pytest.approx(outline.area)
        assert low[0] == 1 or high[0] == columns - 1
        assert low[1] == 1 or high[1] == rows - 1


def test_among_spots_on_the_ways_of_others_those_come_first_that_leave_them_a_way() -> None:
    """In a corridor three squares wide with a bay, a thing of two squares lets another one pass in the bay alone."""
    floor = np.zeros((9, 30), np.bool_)
    floor[1:4, 1:29] = True
    floor[4:7, 12:15] = True  # the bay
    outline = shapely.box(4, 1, 6, 3)
    way = kept_way_of(shapely.box(1, 1, 3, 3), shapely.box(26, 1, 28, 3), floor)
    assert way is not None
    keep = np.ones_like(floor)  # no place is off the ways of others
    moves = spots(outline, floor, floor, keep, [way])
    first = Translate(*map(float, moves[0])).carry(outline)
    assert first.bounds[1] >= 3.0  # two squares of the corridor stay free
    assert len(moves) > len(spots(outline, floor, floor, keep))


def test_a_passage_is_that_of_a_thing_that_is_not_turned() -> None:
    floor = np.ones((8, 8), np.bool_)
    assert kept_way_of(shapely.box(1, 1, 3, 2), shapely.box(4, 4, 6, 5), floor) is not None
    assert kept_way_of(shapely.box(1, 1, 3, 2), shapely.box(4, 4, 5, 6), floor) is None


def test_a_region_is_reached_where_it_is_free() -> None:
    situation = drawn_situation(ROOM)
    x0, y0, x1, y1 = drawn_problem(situation, {}).state.things["h"].outline.bounds
    problem = drawn_problem(situation, {"g": Inside(shapely.box(x0 - 1, y0 - 1, x1 + 1, y1 + 4))})
    answer = CarryOracle(problem, situation).bring(problem.state, "g", problem.places["g", "g1_pose"], "g1_pose")
    assert answer.after is not None
    assert not answer.after.things["g"].outline.intersection(answer.after.things["h"].outline).area
