"""Rules of users about where the robot goes to look, in whole runs."""

from pathlib import Path

import pytest

import utak
from utak.kb.reasoning.interfaces import SUBGOAL_KINDS
from utak.planner.subgoal_kind import SubgoalKind

RULES = Path(__file__).resolve().parents[3] / "docs" / "look_rules"
INSIDE = "(2 2, 40 2, 40 9, 42 9, 42 2, 58 2, 58 28, 42 28, 42 15, 40 15, 40 28, 2 28, 2 2)"
ROOM_AND_NEXT = utak.Scenario.from_text(  # the robot wakes near the door to the room in which the square is
    world=f"""table(60, 30). verge("POLYGON ((0 0, 0 30, 60 30, 60 0, 0 0), {INSIDE})").
    object(x, c, "POLYGON ((50 20, 54 20, 54 24, 50 24, 50 20))"). utak("POINT (31.5 12.5)", 0).""",
    start="object(x). shape(x, square).",
    goal="beside(utak, x).",
)
WEST, DOOR = 20.0, 40.0  # what lies west of WEST is out of sight where the robot wakes


def looked(rule: str = "") -> tuple[utak.Episode, list[float]]:
    """Return a run, and how far in the east the robot halted, one number for each impression."""
    rules = (str(RULES / f"{rule}.lp"),) if rule else ()
    episode = utak.Run(ROOM_AND_NEXT, rules=rules, max_steps=40).finish()
    assert not episode.idle_rules
    return episode, [float(step.line["utak"][0]) for step in episode]


@pytest.mark.long
def test_a_price_changes_where_the_robot_looks_first() -> None:
    episode, halts = looked()
    assert episode.verdict == "done" and min(halts) > WEST
    for rule in ("01_west_first", "02_own_room_first"):
        episode, halts = looked(rule)
        assert episode.verdict == "done"
        assert min(halts) < WEST and all(east < DOOR for east in halts[: halts.index(min(halts))])


PIERS = "(2 2, 40 2, 40 10, 42 10, 42 2, 58 2, 58 28, 42 28, 42 27, 40 27, 40 28, 2 28, 2 2)"
BETWEEN = "((40 14, 42 14, 42 19, 40 19, 40 14))"
TWO_DOORS = utak.Scenario.from_text(  # the southern door is 4 squares wide, the northern one 8
    world=f"""table(60, 30). verge("MULTIPOLYGON (((0 0, 0 30, 60 30, 60 0, 0 0), {PIERS}), {BETWEEN})").
    object(x, c, "POLYGON ((54 22, 57 22, 57 25, 54 25, 54 22))"). utak("POINT (31.5 12.5)", 0).""",
    start="object(x). shape(x, square).",
    goal="beside(utak, x).",
)


@pytest.mark.long
def test_a_rule_may_speak_of_subgoal_and_walk_together() -> None:
    through = []
    for rules in ((), (str(RULES / "04_narrow_doors_only_to_attain.lp"),)):
        episode = utak.Run(TWO_DOORS, rules=rules, max_steps=40).finish()
        assert episode.verdict == "done" and not episode.idle_rules
        places = [step.line["utak"][:2] for step in episode]
        through.append(next(north for east, north in places if east > DOOR + 1))
    assert through[0] < 14 < 19 < through[1]


def test_where_rules_leave_no_place_to_look_the_verdict_names_them() -> None:
    episode, halts = looked("03_stays_in_its_room")
    assert episode.verdict == "limit" and max(halts) < DOOR
    assert f"the rule at {RULES / '03_stays_in_its_room.lp'}:2 forbids every place to go to" in episode.reason


def test_rules_know_the_kinds_of_subgoals() -> None:
    assert set(SUBGOAL_KINDS) == set(SubgoalKind)
