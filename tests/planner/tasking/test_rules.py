"""The ten rules of docs/rules: each changes the task plan as its sentence says. Small worlds that are wholly known."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.orders.planning import house
from benchmarks.worlds.drawn import drawn_problem, drawn_situation
from tests.planner.carrying.test_carrying import run, scene
from tests.planner.situations import known_situation
from tests.planner.tasking.test_search import SWAPPED, moved
from utak.geometry.manipulation.goals import End, Inside
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.body import Grasp
from utak.kb.language.reader import facts_from_text
from utak.kb.reasoning.solver import solve_within
from utak.planner.goals.object_goals import goal_placement
from utak.planner.goals.robot_goals import destination
from utak.planner.oracles.carry import CarryOracle
from utak.planner.situation import Situation
from utak.planner.stages import Stage
from utak.planner.tasking.proposal import MAX_PLAN_CONFLICTS, TASK_ENCODING
from utak.planner.tasking.rule_effects import (
    DoorRules,
    doors_led_round,
    facts_rules_read,
    rules_about_doors,
    rules_close_all_doors,
    rules_that_close,
    rules_without_plan,
)
from utak.planner.tasking.search import MadePlan, make_plan
from utak.planner.tasking.setting import WhereGoalsHold, problem_of
from utak.simulator.scenario.settings import Settings

RULES = Path(__file__).resolve().parents[3] / "docs" / "rules"
WALL = "b" * 30
SIDE, MIDDLE = "." * 12, "." * 16


def three_rooms(middle: Mapping[int, str], first: tuple[int, int] = (5, 4)) -> list[str]:
    """Return three rooms; a door of 4 leads west from the middle one, one of 6 east. middle : its rows, by number."""
    # first : the first row of each door
    rows = []
    for number in range(14):
        west, east = (".." if least <= number <= 13 - least else "bb" for least in first)
        rows.append(f"b{SIDE}{west}{middle.get(number, MIDDLE)}{east}{SIDE}b")
    return ["b" * len(rows[0]), *rows, "b" * len(rows[0])]


WALKER = three_rooms({8: "....U..........."})
SMALL = three_rooms({n: row for n in (8, 9, 10) for row in ("..ggg....hhh....",)} | {12: "......U........."})
BIG = three_rooms(dict.fromkeys((8, 9, 10), "..gggg..........") | {12: "......U........."})
WIDE_BLOCKED = three_rooms(dict.fromkeys((4, 5, 6, 7, 8, 9), "..ggg.......hhh.") | {12: "......U........."})
TWO_IN_THE_WAY = [  # h stands in the upper corridor, the greater k in the lower one; g must go through one of them
    WALL,
    "b..........bbbbbbbb.........bb",
    *["b.............hhh..........bbb"] * 3,
    "b..........bbbbbbbb.........bb",
    "b.gg.......bbbbbbbb.........bb",
    "b.gg...U...bbbbbbbb.........bb",
    "b..........bbbbbbbb.........bb",
    *["b............kkkk..........bbb"] * 3,
    "b..........bbbbbbbb.........bb",
    WALL,
]


def rule(name: str) -> tuple[Path, ...]:
    """Return the file of a rule, by the beginning of its name."""
    (found,) = RULES.glob(f"{name}_*.lp")
    return (found,)


def situation_with(rows: list[str], rules: tuple[Path, ...], bound: Mapping[str, str]) -> Situation:
    """Return a situation that is wholly known, with users' rules and what the task calls things."""
    return replace(known_situation(rows), rules=rules, binding=bound)


def made_with(
    rows: list[str], ends: Mapping[str, End], rules: tuple[Path, ...], bound: Mapping[str, str]
) -> tuple[MadePlan, Situation]:
    """Return the plan with users' rules, and its situation."""
    situation = situation_with(rows, rules, bound)
    problem = drawn_problem(situation, ends)
    return make_plan(problem, situation, CarryOracle(problem, situation)), situation


NO_DOOR_RULES = DoorRules()


def walk_with(
    rules: tuple[Path, ...], rows: list[str] = WALKER, found: DoorRules = NO_DOOR_RULES
) -> tuple[MadePlan, Situation]:
    """Return the plan of a robot that shall go to a next room. found : what rules do to doors."""
    situation = situation_with(rows, rules, {})
    situation = replace(situation, door_prices=found.prices, door_reliefs=found.reliefs)
    stage = Stage(facts_from_text("in(utak, room(next))."))
    problem = problem_of(stage, situation, WhereGoalsHold(goal_placement, lambda *_: (0.5, 0.5), destination))
    assert problem is not None and len(problem.stands) == 2
    return make_plan(problem, situation, CarryOracle(problem, situation)), situation


def to_room(name: str, number: int, situation: Situation) -> Inside:
    """Return the end of a thing anywhere in a room."""
    return Inside(mask_to_polygon(situation.rooms.labels == number))


def actions(made: MadePlan) -> list[tuple[str, str]]:
    """Return the steps of a plan: action and object."""
    return [(errand.action, errand.subject) for errand in made.plan.errands]


def room_after(made: MadePlan, name: str, situation: Situation) -> int:
    """Return the number of the room in which a thing lies after a plan; its own when it is not moved."""
    outline = made.states[0].things[name].outline
    for errand in made.plan.errands:
        if errand.subject == name:
            spot = made.places[name, errand.place]
            assert isinstance(spot, Inside)
            outline = spot.polygon
    x, y = outline.centroid.coords[0]
    return int(situation.rooms.labels[int(y), int(x)])


def width_of(name: str, situation: Situation) -> float:
    """Return the width of a door, in squares."""
    return next(float(door.width) for door in situation.rooms.doors if door.name == name)


def test_there_are_ten_rules_and_each_has_its_sentence() -> None:
    files = sorted(RULES.glob("*.lp"))
    assert [file.name[:2] for file in files] == [f"{number:02}" for number in range(1, 11)]
    assert all('%! because "' in file.read_text() for file in files)


def test_a_narrow_door_is_not_passed_and_is_closed_to_the_robot() -> None:
    made, situation = walk_with(rule("01"))
    (errand,) = made.plan.errands
    assert [width_of(door, situation) for door in errand.doors] == [6.0]
    (closed,) = rules_about_doors(situation).closed
    assert width_of(closed, situation) == 4.0 and rules_without_plan(made, situation) == ()
    assert rules_that_close(replace(situation, closed=frozenset([closed]))) == (f"{rule('01')[0]}:2",)
    without, situation = walk_with(())
    assert rules_about_doors(situation).closed == frozenset() and not without.plan.unmet


def test_all_that_rules_read_of_the_world_counts_for_a_plan_that_is_kept(tmp_path: Path) -> None:
    """What is not read does not count, nor what the plan itself changes."""
    own = tmp_path / "own.lp"
    own.write_text(
        ":- occurs(go(D), T), door(D, C), C < 95, lies(utak, P, r1), at(utak, P, T).\n"
        ":- unseen(R, N), in(utak, R), N > 900."
    )
    situation = situation_with(WALKER, (own,), {})
    read = {fact.partition("(")[0] for fact in facts_rules_read(situation)}
    assert read == {"door", "unseen", "in"}
    assert facts_rules_read(situation_with(WALKER, (), {})) == frozenset()


@pytest.mark.parametrize(("width", "all_"), [("", True), (", width(D, W), W < 450", False)])
def test_rules_close_whatever_door_may_be_found_where_they_read_nothing_of_it(
    tmp_path: Path, width: str, all_: bool
) -> None:
    """A fact that would show another door overturns nothing where a rule closes every door."""
    own = tmp_path / "own.lp"
    own.write_text(f":- occurs(go(D), T){width}.")
    situation = situation_with(WALKER, (own,), {})
    closed = replace(situation, closed=rules_about_doors(situation).closed)
    assert closed.closed and rules_close_all_doors(closed) is all_


def test_a_door_that_is_hardly_one_is_closed_by_a_rule_about_confidence(tmp_path: Path) -> None:
    own = tmp_path / "own.lp"
    own.write_text(":- occurs(go(D), T), door(D, C), C < 80.")
    situation = situation_with(WALKER, (own,), {})
    west, east = situation.rooms.doors
    unsure = replace(situation, rooms=replace(situation.rooms, doors=(replace(west, confidence=40), east)))
    assert rules_about_doors(unsure).closed == {west.name} and not rules_about_doors(situation).closed


def test_a_door_with_a_price_is_led_round_and_not_closed() -> None:
    made, situation = walk_with(rule("10"))
    (errand,) = made.plan.errands
    assert [width_of(door, situation) for door in errand.doors] == [6.0]
    found = rules_about_doors(situation)
    assert found.closed == frozenset() and [(width_of(d, situation), n) for d, n in found.prices.items()] == [(4.0, 10)]
    assert [len(doors) for doors in doors_led_round(made, situation)] == [1]


@pytest.mark.parametrize("first", [(6, 5), (5, 6)])
def test_of_two_priced_doors_that_which_may_be_wide_enough_is_passed(first: tuple[int, int]) -> None:
    """A door of 2 squares is narrower than 5 in any case; one of 4 counts half, for it may be up to 6 wide."""
    rows = three_rooms({8: "....U..........."}, first)
    _, situation = walk_with(rule("10"), rows)
    found = rules_about_doors(situation)
    assert {width_of(door, situation): price for door, price in found.prices.items()} == {2.0: 20, 4.0: 10}
    made, _ = walk_with(rule("10"), rows, found)
    (errand,) = made.plan.errands
    assert [width_of(door, situation) for door in errand.doors] == [4.0]


@pytest.mark.parametrize("name", ["02", "03"])
def test_the_second_thing_is_brought_first(name: str) -> None:
    ends = {"g": moved(0, 2), "h": moved(0, 2)}
    assert actions(made_with(SWAPPED, ends, (), {"x": "g", "y": "h"})[0]) == [("carry", "g"), ("carry", "h")]
    made, _ = made_with(SWAPPED, ends, rule(name), {"x": "g", "y": "h"})
    assert actions(made) == [("carry", "h"), ("carry", "g")] and not made.plan.unmet


def test_a_strict_order_leaves_no_plan_where_a_preferred_one_gives_way() -> None:
    ends = {"g": moved(0, 2)}  # h has no place of its own
    strict, situation = made_with(SWAPPED, ends, rule("02"), {"x": "g", "y": "h"})
    assert strict.plan.unmet == ("g1",)
    assert rules_without_plan(strict, situation) == (f"{rule('02')[0]}:4",)
    assert actions(made_with(SWAPPED, ends, rule("03"), {"x": "g", "y": "h"})[0]) == [("carry", "g")]


def through_a_corridor(rules: tuple[Path, ...], bound: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return the plan for g through one of two corridors in which something stands."""
    made, _ = made_with(TWO_IN_THE_WAY, {"g": moved(20, 0)}, rules, bound)
    assert not made.plan.unmet
    return actions(made)


def test_the_nearest_thing_is_moved_aside_without_rules() -> None:
    assert through_a_corridor((), {})[-1] == ("carry", "g")


@pytest.mark.parametrize(("kept", "other"), [("h", "k"), ("k", "h")])
def test_what_is_kept_where_it_is_is_not_moved_aside(kept: str, other: str) -> None:
    assert through_a_corridor(rule("04"), {"keep": kept}) == [("clear", other), ("carry", "g")]


def test_only_small_things_are_moved_aside() -> None:
    assert through_a_corridor(rule("05"), {}) == [("clear", "h"), ("carry", "g")]


@pytest.mark.parametrize(("rows", "unmet"), [(BIG, ("g1",)), (SMALL, ())])
def test_nothing_big_is_brought_through_doors(rows: list[str], unmet: tuple[str, ...]) -> None:
    east = {"g": to_room("g", 3, known_situation(rows))}
    assert not made_with(rows, east, (), {})[0].plan.unmet
    made, situation = made_with(rows, east, rule("07"), {})
    assert made.plan.unmet == unmet
    assert bool(rules_without_plan(made, situation)) == bool(unmet)


@pytest.mark.long
def test_a_thing_is_moved_aside_within_its_room() -> None:
    rooms = []
    for rules in ((), rule("06")):
        made, situation = made_with(WIDE_BLOCKED, {"g": to_room("g", 3, known_situation(WIDE_BLOCKED))}, rules, {})
        assert [name for action, name in actions(made) if action == "clear"] == ["h"]
        rooms.append(room_after(made, "h", situation))
    assert rooms[1] == 1


@pytest.mark.long
def test_a_goal_of_the_users_own_is_attained() -> None:
    bound = {"x": "g", "y": "h"}
    ends = {"g": moved(0, 2)}
    assert actions(made_with(SMALL, ends, (), bound)[0]) == [("carry", "g")]
    made, situation = made_with(SMALL, ends, rule("08"), bound)
    assert sorted(actions(made)) == [("carry", "g"), ("clear", "h")] and not made.plan.unmet
    assert room_after(made, "h", situation) != 1


def test_a_rule_that_leaves_no_plan_is_named() -> None:
    made, situation = made_with(SWAPPED, {"g": moved(0, 2)}, rule("09"), {})
    assert made.plan.unmet == ("g1",)
    assert rules_without_plan(made, situation) == (f"{rule('09')[0]}:2",)


def test_nothing_is_touched_where_a_rule_leaves_no_plan(tmp_path: Path) -> None:
    example = Path(__file__).resolve().parents[3] / "examples" / "push_square_next_room"
    found = run(example, Settings(kb_files=tuple(map(str, rule("09")))))
    assert not found.result.believed and "09_touch_nothing.lp:2 leaves no plan" in found.result.reason
    assert not any(isinstance(command, Grasp) for command in found.commands)


@pytest.mark.long
@pytest.mark.parametrize(("rules", "room"), [((), "west"), (rule("01"), "east")])
def test_the_robot_takes_another_door_where_a_rule_forbids_the_nearest(
    rules: tuple[Path, ...], room: str, tmp_path: Path
) -> None:
    ring = "2 2, 15 2, 15 7, 17 7, 17 2, 30 2, 30 6, 32 6, 32 2, 44 2, 44 16, 32 16, 32 12, 30 12, 30 16, 17 16, 17 11"
    verge = f'verge("POLYGON ((0 0, 0 18, 46 18, 46 0, 0 0), ({ring}, 15 11, 15 16, 2 16, 2 2))").'
    world = f'table(46, 18).\n{verge}\nutak("POINT (22.5 9.5)", 0).\n'
    found = run(scene(tmp_path, world, "", "in(utak, room(next))."), Settings(kb_files=tuple(map(str, rules))))
    assert found.result.believed
    assert (found.session.table.utak[0] < 16) == (room == "west")


def test_a_rule_that_forbids_nothing_costs_no_answer(tmp_path: Path) -> None:
    """In six rooms with six goals the cheapest plan is proved with it as without it, at the same cost."""
    rule = tmp_path / "idle.lp"
    rule.write_text(":- occurs(carry(X, P), T), size(X, S), S > 5000.\n")
    rows, ends = house(np.random.default_rng([1, 6, 6]), 6, 6, 6)
    situation = replace(drawn_situation(rows), rules=(rule,))
    problem = drawn_problem(situation, ends)
    made = make_plan(problem, situation, CarryOracle(problem, situation, on_lattice=True))
    assert made.plan.unmet == ()
    without, ruled = (solve_within([TASK_ENCODING, *rules], made.facts, MAX_PLAN_CONFLICTS) for rules in ((), (rule,)))
    assert without.proved and ruled.proved and without.cost == ruled.cost
