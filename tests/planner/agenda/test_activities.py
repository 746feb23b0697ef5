"""The agenda: activities are chosen by rules that users can extend, and the record says what was refused before."""

from collections.abc import Sequence
from pathlib import Path

import pytest

import utak
from tests.kb.drawings import known_model
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.reader import facts_from_text
from utak.kb.task.task import Task
from utak.kb.tracing.decisions import SolverCall, record_decisions
from utak.planner.agenda.decider import Decider
from utak.planner.decision import Decision

ROOM = ["bbbbbbb", "b.....b", "b..U..b", "b.....b", "bbbbbbb"]
JUTTING = ["bbbbbbb", "b.....b", "b.....b", "bbb...b", "b..U..b", "bbbbbbb"]  # a wall, or something against it
NEXT_ROOM = Task({}, (), facts_from_text("in(utak, room(next))."))


def decided(tmp_path: Path, rules: str = "", room: Sequence[str] = ROOM) -> tuple[Decision, SolverCall]:
    """Return what a robot in a closed room decides, and the record of the agenda. rules : of the user."""
    file = tmp_path / "mine.lp"
    file.write_text(rules)
    model = known_model(room)
    with record_decisions() as record:
        decision = Decider(NEXT_ROOM, rules=(file,) if rules else ()).decide(model, [model.place])
    (choice,) = [call for call in record if call.encoding == "deciding"]
    return decision, choice


@pytest.mark.parametrize(
    ("rules", "planned"),
    [
        ("", ["touch"]),
        ("price(touch(S), 7) :- stuck(S, _).", ["make_way", "touch"]),
        (":- occurs(touch(_), _).", ["make_way", "try", "feel"]),
    ],
)
def test_what_may_stand_against_a_wall_is_touched_by_a_step_of_the_plan(
    rules: str, planned: list[str], tmp_path: Path
) -> None:
    decision, choice = decided(tmp_path, rules, JUTTING)
    assert decision.command is not None and ("stands against the wall" in decision.why) == ("touch" in planned)
    steps = [fact for fact in choice.facts if fact.startswith("planned(")]
    assert steps == [f"planned({step}(robot))" for step in planned]


def test_before_a_verdict_walls_are_felt_and_the_record_says_what_was_refused_before(tmp_path: Path) -> None:
    decision, choice = decided(tmp_path)
    assert "felt" in decision.why and decision.command is not None
    assert "do(feel(robot))" in (choice.answer or ())
    refused = [fact for fact in choice.facts if fact.startswith(("came_to", "planned"))]
    assert refused == [
        "came_to(errand,idle)",
        "came_to(go,impossible)",
        "planned(make_way(robot))",
        "came_to(make_way(robot),idle)",
        "planned(try(robot))",
        "came_to(try(robot),idle)",
        "planned(feel(robot))",
    ]


def test_a_rule_that_forbids_an_activity_ends_in_limit_and_says_so(tmp_path: Path) -> None:
    decision, choice = decided(tmp_path, ":- do(feel(_)).")
    assert (decision.command, decision.verdict) == (None, "limit")
    assert f"users' rules forbid all that may still be done, by the rule at {tmp_path}" in decision.why
    assert choice.answer == ("stuck(robot,impossible)",)


def test_a_rule_that_forbids_a_step_of_the_plan_ends_in_limit_and_says_so(tmp_path: Path) -> None:
    decision, _ = decided(tmp_path, ":- occurs(feel(_), T), time(T). :- occurs(bare(_), T), time(T).")
    assert (decision.command, decision.verdict) == (None, "limit")
    assert f"users' rules forbid bare(robot) and feel(robot), by the rule at {tmp_path}" in decision.why


def test_a_rule_about_what_the_robot_is_stuck_with_counts_only_there(tmp_path: Path) -> None:
    assert decided(tmp_path, ":- do(feel(S)), stuck(S, limit).")[0].command is not None
    assert decided(tmp_path, ":- do(feel(S)), stuck(S, impossible).")[0].verdict == "limit"


def test_rules_cannot_say_what_came_of_an_activity(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="came_to/2 says what there is, and rules add nothing to it"):
        decided(tmp_path, "came_to(feel(robot), idle).")


@pytest.mark.parametrize("fact", ["waits(g1)", "settled(robot, 0)", "settling(0)", "left(feel(robot))", "holds(o1)"])
def test_rules_cannot_say_what_is_settled_in_the_task_plan(tmp_path: Path, fact: str) -> None:
    with pytest.raises(BadInputError, match="says what there is, and rules add nothing to it"):
        decided(tmp_path, f"{fact}.")


NARROW_DOOR = "\n".join(
    [
        "b" * 24,
        "b" + "." * 10 + "bb" + "." * 10 + "b",
        "b..U" + "." * 7 + "bb" + "." * 10 + "b",
        *["b" + "." * 10 + "bb" + "." * 10 + "b"] * 2,
        *["b....ggg...bb" + "." * 10 + "b"],
        *["b....ggg" + "." * 15 + "b"],
        *["b....ggg" + "." * 15 + "b"],
        *["b" + "." * 10 + "bb" + "." * 10 + "b"] * 5,
        "b" * 24,
    ]
)


def narrow_door_run(folder: Path, rules: str) -> tuple[utak.Episode, list[str]]:
    """Return a run in which a square is wider than the only door, and the steps of its plans, each once."""
    (folder / "mine.lp").write_text(rules)
    scenario = utak.Scenario.from_text(
        world=NARROW_DOOR, start="object(x). shape(x, square).", goal="in(x, room(next))."
    )
    episode = utak.Run(scenario, rules=[folder / "mine.lp"] if rules else []).finish()
    facts = (fact for step in episode for fact in step.line["belief"]["facts"] if fact.startswith("plan(0,"))
    return episode, list(dict.fromkeys(facts))


@pytest.mark.long
def test_what_geometry_refuses_is_checked_by_steps_of_the_plan(tmp_path: Path) -> None:
    episode, steps = narrow_door_run(tmp_path, "")
    assert episode.verdict == "impossible" and "too narrow by" in episode.reason
    wanted = ["plan(0,measure(g1)).", "plan(0,probe(g1)).", "plan(0,gauge(g1))."]
    assert [step for step in steps if step in wanted] == wanted


@pytest.mark.long
def test_a_rule_that_forbids_such_a_step_ends_in_limit_and_says_so(tmp_path: Path) -> None:
    episode, steps = narrow_door_run(tmp_path, ":- occurs(measure(_), _). :- occurs(probe(_), _).")
    assert episode.verdict == "limit" and "users' rules forbid measure(g1) and probe(g1)" in episode.reason
    assert not any(name in step for step in steps for name in ("measure", "probe", "gauge"))
