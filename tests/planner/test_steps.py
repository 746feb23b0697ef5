"""The steps of the robot itself: what is recorded before each command, and users' rules about them, in whole runs."""

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import utak
from benchmarks.episodes.planned import differences

ROOT = Path(__file__).resolve().parents[2]
ROOM = """table(32, 22).
verge("POLYGON ((0 0, 32 0, 32 22, 0 22, 0 0), (2 2, 2 20, 30 20, 30 2, 2 2))").
utak("POINT (15.5 14.5)", 0).
"""
SQUARE = 'object(t, g, "POLYGON ((8 6, 11 6, 11 9, 8 9, 8 6))").'
INTO_CORNER = (f"{ROOM}{SQUARE}", "object(x). shape(x, square).", "at(x, corner(northeast)).")
TURNED = (f"{ROOM}{SQUARE}", "object(x). shape(x, square).", 'pose(x, "POINT (14.5 -6.5)", 90).')
TO_CORNER = (ROOM, "", "at(utak, corner(northeast)).")

Command = dict[str, Any]


def run(scene: tuple[str, str, str] | str, *rules: str) -> utak.Episode:
    """Return the episode of an example, or of a scene of one's own, with rules of docs/step_rules."""
    if isinstance(scene, str):
        scenario: Any = str(ROOT / "examples" / scene)
    else:
        world, start, goal = scene
        scenario = utak.Scenario.from_text(world=world, start=start, goal=goal)
    files = tuple(str(ROOT / "docs" / "step_rules" / f"{rule}.lp") for rule in rules)
    return utak.Run(scenario, rules=files, max_steps=40).finish()


@cache
def without_rules(scene: tuple[str, str, str] | str) -> utak.Episode:
    return run(scene)


def commands(episode: utak.Episode) -> list[Command]:
    return [step.line["action"] for step in episode if step.line["action"]]


def length(command: Command) -> float:
    return math.hypot(command["east"], command["north"])


def places(episode: utak.Episode) -> list[tuple[float, float]]:
    return [tuple(step.line["belief"]["place"]) for step in episode]


CASES: dict[str, tuple[tuple[str, str, str] | str, Callable[[utak.Episode], bool], str]] = {
    # a rule, what it is tried in, whether an episode is as it forbids, and the verdict with it
    "02_not_from_the_south": (
        "push_exchange_rooms",
        lambda episode: any(c["do"] == "grasp" and c["direction"] == "north" for c in commands(episode)),
        "done",
    ),
    "03_short_pushes": (
        INTO_CORNER,
        lambda episode: any(c["do"] == "push" and length(c) > 8 for c in commands(episode)),
        "done",
    ),
    "05_straight_pushes": (
        INTO_CORNER,
        lambda episode: any(c["do"] == "push" and c["east"] and c["north"] for c in commands(episode)),
        "done",
    ),
    "09_green_stays": (INTO_CORNER, lambda episode: any(c["do"] == "push" for c in commands(episode)), "limit"),
}


@pytest.mark.parametrize("rule", CASES)
def test_a_rule_about_steps_changes_what_its_sentence_says(rule: str) -> None:
    scene, is_forbidden, verdict = CASES[rule]
    before, after = without_rules(scene), run(scene, rule)
    assert is_forbidden(before)
    assert not is_forbidden(after)
    assert after.verdict == verdict, after.reason
    assert not after.idle_rules
    if verdict != "done":
        assert f"{rule}.lp:2" in after.reason
    for episode in (before, after):
        assert list(differences([step.line for step in episode])) == []
