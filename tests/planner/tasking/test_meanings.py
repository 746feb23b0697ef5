"""What parameters mean is part of the task plan: what is cheaper, two things for two, nothing that is out of reach."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from tests.planner.situations import known_situation
from tests.planner.tasking.test_wishes import origin, stage_of
from utak.kb.language.reader import facts_from_text
from utak.kb.task.binding import Reconciliation, as_well_by_parameter
from utak.kb.task.task import Task
from utak.planner.goals.object_goals import goal_placement
from utak.planner.goals.robot_goals import destination
from utak.planner.oracles.carry import CarryOracle
from utak.planner.situation import Situation
from utak.planner.stages import parameters_that_keep_meaning
from utak.planner.tasking.intention import Intention, with_meanings
from utak.planner.tasking.rule_effects import rules_without_plan
from utak.planner.tasking.search import MadePlan, make_plan
from utak.planner.tasking.setting import WhereGoalsHold, problem_of

WALL = "b" * 34
IN_POCKET = [  # g lies nearer to the robot, in a pocket: it takes two pushes more than h
    WALL,
    *["b................................b"] * 3,
    *["b...hhh..........................b"] * 3,
    *["b................................b"] * 2,
    "b.........bbbbbbbbbbbbb..........b",
    "b.....................b..........b",
    "b..............ggg....b..........b",
    "b...........U..ggg....b..........b",
    "b..............ggg....b..........b",
    "b.....................b..........b",
    "b.........bbbbbbbbbbbbb..........b",
    *["b................................b"] * 2,
    WALL,
]
ACROSS = [  # two rooms, a thing in each; the robot stands in the door
    WALL,
    *["b...............b................b"] * 4,
    *["b...............b..........hhh...b"] * 3,
    *["b................................b"] * 2,
    "b...............U................b",
    *["b................................b"] * 2,
    "b...............b................b",
    *["b...ggg.........b................b"] * 3,
    "b...............b................b",
    WALL,
]
WALLED_IN = [  # the robot cannot come to g
    WALL,
    *["b................................b"] * 3,
    *["b...hhh..........................b"] * 3,
    *["b................................b"] * 2,
    "b.........bbbbbbbbbbbbb..........b",
    "b.........b...........b..........b",
    "b.........b....ggg....b....U.....b",
    *["b.........b....ggg....b..........b"] * 2,
    "b.........b...........b..........b",
    "b.........bbbbbbbbbbbbb..........b",
    *["b................................b"] * 2,
    WALL,
]
BOTH = {"x": ("h",), "y": ("g",)}


def situation_with(rows: list[str], as_well: Mapping[str, tuple[str, ...]], rules: tuple[Path, ...] = ()) -> Situation:
    """Return the situation in a drawn world, whose things g and h the task calls x and y, as far as it names them."""
    binding = {"x": "g", "y": "h"} if "y" in as_well or not as_well else {"x": "g"}
    return replace(known_situation(rows), binding=binding, as_well=as_well, rules=rules)


WHERE = WhereGoalsHold(goal_placement, origin, destination)


def planned(situation: Situation, text: str, meant: Mapping[str, str] | None = None) -> MadePlan:
    """Return the plan for a task. text : as in goal.lp. meant : what the plan before meant."""
    problem = problem_of(stage_of(text), situation, WHERE)
    assert problem is not None
    return make_plan(problem, situation, CarryOracle(problem, situation), (), meant or {})


def pose(parameter: str, x: int, y: int, rows: list[str]) -> str:
    """Return the goal that the middle of a thing is at (x, y) from the southwest corner of a drawing."""
    south, west = next((n, row.index("U")) for n, row in enumerate(reversed(rows)) if "U" in row)
    return f'pose({parameter}, "POINT ({x - west} {y - south})", 0).'


POCKET_GOAL = pose("x", 28, 13, IN_POCKET)
ACROSS_GOALS = pose("x", 28, 3, ACROSS) + pose("y", 5, 12, ACROSS)


def test_the_thing_that_is_cheaper_to_bring_is_meant_though_it_lies_further_away() -> None:
    alone = planned(situation_with(IN_POCKET, {"x": ()}), POCKET_GOAL)
    both = planned(situation_with(IN_POCKET, {"x": ("h",)}), POCKET_GOAL)
    assert alone.plan.meanings == () or dict(alone.plan.meanings) == {"x": "g"}
    assert dict(both.plan.meanings) == {"x": "h"}
    assert [errand.subject for errand in both.plan.errands] == ["h"]
    assert both.plan.cost < alone.plan.cost and both.plan.proved


def test_two_things_are_meant_the_other_way_round_where_that_is_cheaper() -> None:
    fixed = planned(situation_with(ACROSS, {}), ACROSS_GOALS)
    free = planned(situation_with(ACROSS, BOTH), ACROSS_GOALS)
    assert dict(fixed.plan.meanings) == {"x": "g", "y": "h"}
    assert dict(free.plan.meanings) == {"x": "h", "y": "g"}
    assert free.plan.cost < fixed.plan.cost and free.plan.proved


def test_what_cannot_be_reached_is_not_meant() -> None:
    goal = pose("x", 28, 13, WALLED_IN)
    assert planned(situation_with(WALLED_IN, {"x": ()}), goal).plan.unmet == ("g1",)
    made = planned(situation_with(WALLED_IN, {"x": ("h",)}), goal)
    assert not made.plan.unmet and dict(made.plan.meanings) == {"x": "h"}


def test_a_goal_holds_at_once_where_another_thing_that_is_meant_lies_there() -> None:
    goal = pose("x", 5, 13, IN_POCKET)
    made = planned(situation_with(IN_POCKET, {"x": ("h",)}), goal)
    assert made.plan.errands == () and not made.plan.unmet and dict(made.plan.meanings) == {"x": "h"}


def test_two_parameters_mean_two_things_though_one_would_do_for_both() -> None:
    goals = pose("x", 28, 13, IN_POCKET) + pose("y", 28, 3, IN_POCKET)
    made = planned(situation_with(IN_POCKET, BOTH), goals)
    assert sorted(name for _, name in made.plan.meanings) == ["g", "h"] and not made.plan.unmet


def test_what_the_plan_before_meant_is_given_up_for_many_commands_alone() -> None:
    situation = situation_with(ACROSS, BOTH)
    free = planned(situation, ACROSS_GOALS)
    fixed = planned(situation_with(ACROSS, {}), ACROSS_GOALS)
    kept = planned(situation, ACROSS_GOALS, {"x": "g", "y": "h"})
    assert fixed.plan.cost - free.plan.cost <= 6  # two changes of meaning at 3 commands
    assert dict(kept.plan.meanings) == {"x": "g", "y": "h"} and kept.plan.cost == fixed.plan.cost


def test_the_robot_pursues_what_the_plan_means_and_keeps_to_it() -> None:
    situation, stage = situation_with(IN_POCKET, {"x": ("h",)}), stage_of(POCKET_GOAL)
    intention = Intention(WHERE)
    after = intention.update(stage, situation, {}, 1.0)
    assert after.binding == {"x": "h"} and after.as_well == {"x": ("g",)} and intention.meanings == {"x": "h"}
    found = intention.next_errand(stage, after)
    assert found is not None and found.node.name == "h" and found.goal == stage.goals[0]
    plan = intention.plan
    again = intention.update(stage, after, {}, 1.0)
    assert again.binding == {"x": "h"} and intention.plan == plan
    # Where reconciliation takes x for g after all, nothing of the plan is left.
    back = intention.update(stage, replace(situation, as_well={}), {}, 1.0)
    assert back.binding == {"x": "g"} and intention.meanings == {}


def test_what_is_in_hand_is_what_its_parameter_means() -> None:
    situation = situation_with(ACROSS, BOTH)
    held = replace(situation, model=replace(situation.model, held="g"))
    problem = problem_of(stage_of(ACROSS_GOALS), held, WHERE)
    assert problem is not None and "x" not in problem.meanings and problem.meanings["y"] == ("h", "g")
    made = make_plan(problem, held, CarryOracle(problem, held))
    assert dict(made.plan.meanings) == {"x": "g", "y": "h"}


def written(tmp_path: Path, rule: str) -> tuple[Path, ...]:
    """Return the file of a rule."""
    (tmp_path / "rule.lp").write_text(rule)
    return (tmp_path / "rule.lp",)


@pytest.mark.parametrize(
    ("rule", "meant"),
    [
        (":- meaning(x, h).", "g"),
        (":~ meaning(x, h). [9@1, x]", "g"),
        (":~ meaning(x, h). [1@1, x]", "h"),
        (":- meaning(x, N), size(N, S), S > 100.", "h"),
    ],
)
def test_a_users_rule_forbids_or_prices_a_meaning(tmp_path: Path, rule: str, meant: str) -> None:
    rule = rule.replace("h)", "o2)")
    rows = IN_POCKET
    situation = renamed(situation_with(rows, {"x": ("h",)}, written(tmp_path, rule)))
    made = planned(situation, POCKET_GOAL)
    assert dict(made.plan.meanings) == {"x": {"g": "o1", "h": "o2"}[meant]} and not made.plan.unmet


def test_a_rule_that_leaves_nothing_to_mean_leaves_no_plan_and_is_named(tmp_path: Path) -> None:
    situation = renamed(situation_with(IN_POCKET, {"x": ("h",)}, written(tmp_path, ":- meaning(x, _).")))
    made = planned(situation, POCKET_GOAL)
    assert made.plan.unmet == ("g1",)
    assert rules_without_plan(made, situation) == (f"{tmp_path / 'rule.lp'}:1",)


def renamed(situation: Situation) -> Situation:
    """Return a situation whose things g and h are called o1 and o2, as users' rules know things."""
    names = {"g": "o1", "h": "o2"}
    objects = tuple(replace(node, name=names[node.name]) for node in situation.model.objects)
    return replace(
        situation,
        model=replace(situation.model, objects=objects),
        binding={parameter: names[name] for parameter, name in situation.binding.items()},
        as_well={parameter: tuple(names[n] for n in found) for parameter, found in situation.as_well.items()},
    )


def test_what_was_bound_may_be_meant_again_after_a_plan_chose_another_thing() -> None:
    situation = with_meanings(situation_with(ACROSS, BOTH), {"x": "h", "y": "g"})
    assert situation.binding == {"x": "h", "y": "g"} and situation.as_well == {"x": ("g",), "y": ("h",)}


@pytest.mark.parametrize(
    ("goals", "attained", "kept"),
    [
        ("in(x, room(next)).", 0, ()),
        ("in(x, room(next)). beside(y, x).", 0, ("x",)),
        ("at(utak, y). in(x, room(next)).", 0, ("y",)),
        ("in(x, room(next)). then(at(utak, x)).", 0, ("x",)),
        ("in(x, room(next)). not_through(x, d).", 0, ("x",)),
        ("in(x, room(next)). prefer(beside(x, y), 9).", 0, ("y",)),
        ("first(in(x, room(next))). then(in(y, room(next))).", 0, ()),
        ("first(in(x, room(next))). then(in(y, room(next))).", 1, ("x",)),
    ],
)
def test_what_the_task_names_otherwise_keeps_its_meaning(goals: str, attained: int, kept: tuple[str, ...]) -> None:
    task = Task(dict.fromkeys("xyd"), (), facts_from_text(goals))  # type: ignore[arg-type]
    assert parameters_that_keep_meaning(task, attained) & {"x", "y"} == frozenset(kept)


def test_pairs_that_match_as_well_are_told_by_parameter() -> None:
    found = Reconciliation({"x": "a"}, (), (), (), as_well=(("x", "b"), ("x", "c"), ("y", "b")))
    assert as_well_by_parameter(found) == {"x": ("b", "c"), "y": ("b",)}
