"""The steps of the robot itself: what is recorded before each command, and users' rules about them, in whole runs."""

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import utak
from benchmarks.episodes.planned import differences, planned
from tests.tables import few
from utak.kb.language.atoms import atom_parts

ROOT = Path(__file__).resolve().parents[2]
ROOM = """table(32, 22).
verge("POLYGON ((0 0, 32 0, 32 22, 0 22, 0 0), (2 2, 2 20, 30 20, 30 2, 2 2))").
utak("POINT (15.5 14.5)", 0).
"""
SQUARE = 'object(t, g, "POLYGON ((8 6, 11 6, 11 9, 8 9, 8 6))").'
INTO_CORNER = (f"{ROOM}{SQUARE}", "object(x). shape(x, square).", "at(x, corner(northeast)).")
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


def has(kind: str, is_so: Callable[[Command], bool] = lambda command: True) -> Callable[[utak.Episode], bool]:
    """Return a function that tells whether an episode has a command of a kind of which something is so."""
    return lambda episode: any(c["do"] == kind and is_so(c) for c in commands(episode))


def goes(what: str, is_so: Callable[[float, float], bool]) -> Callable[[utak.Episode], bool]:
    """Return a function that tells whether the robot goes to a point of which something is so, or looks from it."""

    def of(episode: utak.Episode) -> bool:
        steps = [atom_parts(one) for step in list(episode)[:-1] for one in planned(step.line)[1]]
        return any(name == what and is_so(int(found[0]) / 100, int(found[1]) / 100) for name, found in steps)

    return of


# By the name of a rule: what it is tried in, what it forbids, and the verdict with it.
CASES: dict[str, tuple[tuple[str, str, str] | str, Callable[[utak.Episode], bool], str]] = {
    "01_no_turns": ("push_l_next_room", has("turn"), "limit"),
    "02_not_from_the_south": ("push_exchange_rooms", has("grasp", lambda c: c["direction"] == "north"), "done"),
    "03_short_pushes": (INTO_CORNER, has("push", lambda c: length(c) > 8), "done"),
    "04_small_turns": ("push_brick_regrasp", has("turn", lambda c: abs(c["degrees"]) > 45), "done"),
    "05_not_to_the_west": ("push_exchange_rooms", has("push", lambda c: c["east"] < 0), "limit"),
    "06_not_far_north": ("go_northeast", goes("go", lambda _, north: north > 8), "limit"),
    "07_looks_from_near": ("go_to_square_unseen", goes("look", lambda *point: math.hypot(*point) > 20), "done"),
    "08_nothing_is_felt": ("go_next_room_blocked", goes("feel", lambda *_: True), "done"),
    "09_green_stays": (INTO_CORNER, has("push"), "limit"),
    "10_two_motions": ("push_l_next_room", lambda episode: len(moved(episode)) > 2, "limit"),
}
QUICK = ["03_short_pushes", "06_not_far_north", "09_green_stays"]


def moved(episode: utak.Episode) -> list[Command]:
    return [command for command in commands(episode) if command["do"] in ("push", "turn")]


def test_each_rule_is_tried() -> None:
    assert sorted(path.stem for path in (ROOT / "docs" / "step_rules").glob("*.lp")) == sorted(CASES)


@pytest.mark.parametrize("rule", few(list(CASES), QUICK))
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
