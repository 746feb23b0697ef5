"""Task plans: order, places and what is moved aside, in small worlds that are wholly known."""

import re
from collections.abc import Mapping
from itertools import pairwise

import pytest
import shapely

from benchmarks.worlds.drawn import drawn_problem
from tests.planner.situations import known_situation
from utak.geometry.manipulation.goals import At, End, Inside, is_goal_met
from utak.geometry.motion.se2 import Pose
from utak.kb.language.goal_words import ROBOT
from utak.planner.goals.placement import to_view_frame
from utak.planner.oracles.carry import CarryOracle, Certainty
from utak.planner.oracles.problem import PlacedGoal, TaskProblem
from utak.planner.situation import Situation
from utak.planner.tasking.search import MadePlan, make_plan
from utak.planner.tasking.task_plan import RefutedStep, TaskPlan
from utak.planner.under_way import UNDER_WAY

WALL = "b" * 24
DEAD_END = [  # g must go to the far end of the corridor, h right into its mouth
    WALL,
    *["b..........bbbbbbbbbbbbb"] * 3,
    "b.ggg......bbbbbbbbbbbbb",
    "b.ggg.U....bbbbbbbbbbbbb",
    "b.ggg......bbbbbbbbbbbbb",
    *["b..........bbbbbbbbbbbbb"] * 2,
    *["b......................b"] * 2,
    "b.hhh..................b",
    "b.hhh..................b",
    "b.hhh..................b",
    *["b......................b"] * 2,
    WALL,
]
BLOCKED = [  # h stands in the corridor through which g must go
    WALL,
    *["b..........bbbbbbbbbbbbb"] * 2,
    "b.ggg......bbbbbbbbbbbbb",
    "b.ggg.U....bbbbbbbbbbbbb",
    "b.ggg......bbbbbbbbbbbbb",
    *["b..........bbbbbbbbbbbbb"] * 2,
    *["b............hhh.......b"] * 3,
    *["b......................b"] * 2,
    WALL,
]
SWAPPED = [
    WALL,
    *["b......................b"] * 3,
    *["b.ggg.....U......hhh...b"] * 3,
    *["b......................b"] * 3,
    WALL,
]
WALLED_IN = [  # the robot cannot come to h
    WALL,
    *["b.............b........b"] * 3,
    *["b.ggg.....U...b..hhh...b"] * 3,
    *["b.............b........b"] * 3,
    WALL,
]


BOLT = [  # h lets g pass below it when it is pushed up as far as it goes; the end of the corridor was not seen yet
    "b" * 34,
    *["b" * 16 + ".." + "b" * 16] * 2,
    *["b" * 16 + "hh" + "b" * 16] * 5,
    *["b...gg.........." + "hh" + "." * 10 + "?" * 6] * 2,
    *["bU" + "." * 14 + "hh" + "." * 10 + "?" * 6] * 1,
    *["b" + "." * 15 + "hh" + "." * 10 + "?" * 6] * 2,
    "b" * 34,
]
EXCHANGED = [  # g must go to where h lies, which leaves the dead end only once g is out of it
    "b" * 26,
    *["b..........bbbbbbbbbbbbbbb"] * 4,
    "b........................b",
    "b..............ggg.......b",
    "b..............ggg.hhh...b",
    "b..............ggg.hhh...b",
    "b..................hhh...b",
    "b........................b",
    "b...U......bbbbbbbbbbbbbbb",
    *["b..........bbbbbbbbbbbbbbb"] * 4,
    "b" * 26,
]
CLOSET = [  # each of the things fits into the closet by itself, right behind the door; all do only along its walls
    "b" * 29,
    "b...............bbbbbbbbbbbbb",
    "b...............bb..........b",
    "b.hhhh..........bb..........b",
    "b.hhhh......................b",
    "b.hhhh......................b",
    "b.hhhh......................b",
    "b......U....................b",
    "b...........................b",
    "b.ggggggggg.....bb..........b",
    "b.ggggggggg.....bb..........b",
    "b.ggggggggg.....bb..........b",
    "b.ggggggggg.kkkkbbbbbbbbbbbbb",
    "b...........kkkkbbbbbbbbbbbbb",
    "b...........kkkkbbbbbbbbbbbbb",
    "b...........kkkkbbbbbbbbbbbbb",
    "b" * 29,
]


def moved(dx: float, dy: float) -> At:
    """Return the end of a thing that is moved by (dx, dy) squares."""
    return At(Pose(dx, dy, 0.0))


def planned(rows: list[str], ends: Mapping[str, End], pull: bool = True) -> tuple[MadePlan, TaskProblem, Situation]:
    """Return the plan in a drawn world, with its problem and situation."""
    situation = known_situation(rows)
    problem = drawn_problem(situation, ends)
    return make_plan(problem, situation, CarryOracle(problem, situation, pull)), problem, situation


def steps(made: MadePlan) -> list[str]:
    """Return the steps of a plan as text."""
    return [str(errand) for errand in made.plan.errands]


@pytest.mark.parametrize("order", [("g", "h"), ("h", "g")])
def test_what_would_block_the_rest_goes_last_whatever_the_order_of_the_task(order: tuple[str, str]) -> None:
    ends = {"g": moved(17, -7), "h": moved(10, 0)}
    made, _, _ = planned(DEAD_END, {name: ends[name] for name in order})
    number = {name: n for n, name in enumerate(order, 1)}
    assert steps(made) == [f"carry(g,g{number['g']}_pose)", f"carry(h,g{number['h']}_pose)"]
    assert made.plan.proved and not made.plan.unmet


def test_an_obstacle_is_moved_aside_first() -> None:
    made, _, _ = planned(BLOCKED, {"g": moved(17, -5)})
    actions = [(errand.action, errand.subject) for errand in made.plan.errands]
    assert actions == [("clear", "h"), ("carry", "g")]
    assert made.plan.verified
    said = re.fullmatch(r"plan of at most (\d) steps, proposal (\d+) of at most 80", UNDER_WAY.words)
    assert said is not None and (int(said[1]), int(said[2])) == (2, made.plan.rounds), (
        "it is said how far the search is"
    )


def test_two_things_change_places_by_way_of_a_third_place() -> None:
    made, _, _ = planned(SWAPPED, {"g": moved(15, 0), "h": moved(-15, 0)})
    subjects = [errand.subject for errand in made.plan.errands]
    assert len(subjects) == 3 and subjects[0] == subjects[2] != subjects[1]
    assert made.plan.errands[0].action == "clear"


def test_a_thing_in_the_way_is_moved_where_another_one_can_pass_to_where_nothing_was_seen_yet() -> None:
    situation = known_situation(BOLT)
    problem = drawn_problem(situation, {"g": moved(26, -3)})
    made = make_plan(problem, situation, CarryOracle(problem, situation, on_lattice=True))
    assert [(errand.action, errand.subject) for errand in made.plan.errands] == [("clear", "h"), ("carry", "g")]
    before, after = (state.things["h"].outline.bounds for state in made.states)
    assert after[1] - before[1] == pytest.approx(2.0)


@pytest.mark.long
def test_two_things_in_a_dead_end_are_exchanged_though_one_can_leave_only_after_the_other() -> None:
    situation = known_situation(EXCHANGED)
    problem = drawn_problem(situation, {"g": moved(4, -1), "h": moved(-4, 0)})
    made = make_plan(problem, situation, CarryOracle(problem, situation, on_lattice=True))
    assert [errand.subject for errand in made.plan.errands] == ["g", "h", "g", "h"]
    assert made.plan.verified and not made.plan.unmet


@pytest.mark.long
def test_things_are_packed_along_the_walls_of_a_closet_and_no_place_in_a_refuted_region_is_asked_about() -> None:
    situation = known_situation(CLOSET)
    problem = drawn_problem(situation, {})
    west, south = problem.state.things["g"].outline.bounds[:2]
    closet = Inside(shapely.box(west + 16, south + 1, west + 26, south + 11))
    problem = drawn_problem(situation, {"g": closet, "h": closet, "k": closet})
    made = make_plan(problem, situation, CarryOracle(problem, situation, on_lattice=True))
    assert not made.plan.unmet and len(made.plan.errands) == 3
    known: set[tuple[object, ...]] = set()
    for one in made.plan.refutations:
        region = "_".join(one.place.split("_")[:2])
        assert region == one.place or (one.subject, region, one.origin, one.given, one.stood) not in known
        known.add((one.subject, one.place, one.origin, one.given, one.stood))


def test_as_many_goals_as_possible_are_attained_and_the_others_named() -> None:
    made, _, _ = planned(WALLED_IN, {"g": moved(3, 0), "h": moved(1, 0)})
    assert made.plan.unmet == ("g2",)
    assert RefutedStep("h", "here", "g2_pose", (), "start") in made.plan.refutations


def test_things_that_need_not_move_stay() -> None:
    made, _, _ = planned(SWAPPED, {"g": moved(0, 2)})
    assert steps(made) == ["carry(g,g1_pose)"]


@pytest.mark.parametrize("rows", [DEAD_END, BLOCKED, SWAPPED])
@pytest.mark.parametrize("pull", [True, False])
def test_states_follow_from_each_other_and_end_at_the_goals(rows: list[str], pull: bool) -> None:
    ends = (
        {"g": moved(17, -7), "h": moved(10, 0)} if rows is DEAD_END else {"g": moved(15, -5 if rows is BLOCKED else 0)}
    )
    if rows is SWAPPED:
        ends["h"] = moved(-15, 0)
    made, problem, situation = planned(rows, ends, pull)
    if made.plan.unmet:  # without pulling some things cannot be brought away from walls
        assert not pull
        return
    oracle = CarryOracle(problem, situation, pull)
    state = problem.state
    for errand, before in zip(made.plan.errands, made.states, strict=True):
        assert state.things == before.things
        answer = oracle.bring(state, errand.subject, made.places[errand.subject, errand.place], errand.place)
        assert answer.certainty == errand.certainty == Certainty.SURE and answer.after is not None
        moved_things = [name for name, one in answer.after.things.items() if one != state.things[name]]
        assert moved_things == [errand.subject]
        state = answer.after
    for name, end in ends.items():
        start = problem.state.things[name].outline
        assert is_goal_met(state.things[name].reach(end), state.things[name].outline, state.things[name].outline), start
    outlines = [one.outline for one in state.things.values()]
    assert all(a.intersection(b).area < 1e-9 for a, b in pairwise(outlines))


@pytest.mark.parametrize(("rows", "ends"), [(DEAD_END, {"h": (10, 0), "g": (17, -7)}), (BLOCKED, {"g": (17, -5)})])
def test_each_circumstance_of_a_refutation_matters(rows: list[str], ends: Mapping[str, tuple[int, int]]) -> None:
    made, problem, situation = planned(rows, {name: moved(*end) for name, end in ends.items()})
    oracle = CarryOracle(problem, situation)
    checked = 0
    for refutation in made.plan.refutations:
        others = {name for name, _ in refutation.given}
        if any(place not in ("here", f"g{n}_pose") for _, place in refutation.given for n in (1,)):
            continue
        state = problem.state
        for name, place in refutation.given:
            if place != "here":
                answer = oracle.bring(state, name, made.places[name, place], place)
                assert answer.after is not None
                state = answer.after
        unrelated = frozenset(state.things) - others - {refutation.subject}
        end = made.places[refutation.subject, refutation.place]
        bring = refutation.subject, end, refutation.place
        assert oracle.bring(state.without(unrelated), *bring).certainty == Certainty.REFUTED
        for name in others:
            assert oracle.bring(state.without(unrelated | {name}), *bring).certainty != Certainty.REFUTED
            checked += 1
    assert checked


def test_a_place_within_a_region_is_chosen_so_that_others_pass() -> None:
    rows = [row.replace("hhh", "...") if n < 11 else row for n, row in enumerate(DEAD_END)]
    situation = known_situation(rows)
    region = Inside(to_view_frame(shapely.box(0, 0, 1, 1), situation).envelope.buffer(0))
    x0, y0, _, _ = to_view_frame(situation.model.objects[1].polygon, situation).bounds
    region = Inside(shapely.box(x0 + 9, y0 - 2, x0 + 21, y0 + 5))  # the corridor
    made, _, _ = planned(rows, {"h": region, "g": region})
    assert not made.plan.unmet
    assert {errand.subject for errand in made.plan.errands} == {"g", "h"}


def test_the_robot_itself_goes_last() -> None:
    situation = known_situation(SWAPPED)
    problem = drawn_problem(situation, {"g": moved(0, 2)})
    row, column = situation.model.view.locate(*situation.model.place)
    stand = [row * situation.model.labels.shape[1] + column + 3]
    goals = (PlacedGoal("g2", "at(utak,start)", ROBOT, False), *problem.goals)
    fulfils = {**problem.fulfils, (ROBOT, "g2_there"): ("g2",)}
    problem = TaskProblem(problem.nodes, goals, problem.places, fulfils, {"g2_there": stand}, problem.state)
    made = make_plan(problem, situation, CarryOracle(problem, situation))
    assert steps(made) == ["carry(g,g1_pose)", "arrive(g2_there)"]


def test_a_plan_about_nothing_is_not_stated() -> None:
    """Users' rules have a plan sought while it is not known where any goal holds: then there is none to follow."""
    assert TaskPlan(()).facts == ()
    assert TaskPlan((), unmet=("apart",)).facts[0] == "unmet(apart)"
    assert "price(0,0,proved)" in TaskPlan((), rounds=1, goals=(PlacedGoal("g1", "at(x,start)", "g", False),)).facts
