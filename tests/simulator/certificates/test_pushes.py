"""Certificates of things that were pushed into corners, and of some that were not."""

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks.certificates.drawn import drawn_push
from benchmarks.certificates.mutants import mutants
from benchmarks.certificates.recorded import RecordedWalk
from benchmarks.certificates.truth import holds, lost_truth
from tests.simulator.certificates.test_checker import found_certificate, refused, shown, walk
from tests.simulator.certificates.test_second_checker import NODE, accepted_by_both
from tests.tables import few
from utak.kb.body import Command, Grasp, Move, Push, Release
from utak.simulator.certificates.search import NoCertificateError

HALL = """
bbbbbbbbbbbbbbbbb
bbbbbbbbbbbbbbbbb
bb.............bb
bb.............bb
bb.............bb
bb.............bb
bb.....ggg.....bb
bb....Uggg.....bb
bb.............bb
bbbbbbbbbbbbbbbbb
bbbbbbbbbbbbbbbbb
"""
NORTHEAST = "at(x,corner(northeast))"
SINGLE = "single(colours)"
INTO_CORNER: list[Command] = [Grasp("east"), Push(5.0, 0.0), Push(0.0, 4.0), Release()]


def pushed(tmp_path: Path, *commands: Command, goal: str = NORTHEAST, room: str = HALL) -> RecordedWalk:
    return walk(tmp_path, room, commands, goal)


def corner_certificate(tmp_path: Path) -> tuple[RecordedWalk, dict[str, Any]]:
    """Return a walk that pushed a thing into a corner, and its certificate if the robot woke along the grid."""
    found = pushed(tmp_path, *INTO_CORNER)
    return found, json.loads(found_certificate(found))


def test_what_was_pushed_into_a_corner_is_there(tmp_path: Path) -> None:
    found, stated = corner_certificate(tmp_path)
    assert stated["given"] == ["along(grid)"]
    assert shown(found, stated).startswith(f"done: {NORTHEAST} at step 4, x is the thing felt at step 0, touch 2")
    assert holds(found, NORTHEAST, 4, stated["meaning"])
    assert "may not hold" in refused(found, stated | {"meaning": {"x": [4, 2]}})  # where it began is not known then


@pytest.mark.parametrize("corner", ["northwest", "southeast", "southwest"])
def test_it_is_in_no_other_corner(tmp_path: Path, corner: str) -> None:
    found = pushed(tmp_path, *INTO_CORNER, goal=f"at(x,corner({corner}))")
    stated = corner_certificate(tmp_path)[1] | {"goals": list(found.goals)}
    assert "may not hold" in refused(found, stated)


@pytest.mark.parametrize(
    ("way", "room"),
    [
        ([Push(3.0, 0.0), Push(0.0, 4.0)], HALL),  # free squares are left before the wall
        ([Push(5.0, 0.0), Push(0.0, 2.0)], HALL),
        ([Push(5.0, 0.0), Push(0.0, 4.0)], HALL.replace("bb.............bb", "bb..............b", 1)),
        ([Push(4.0, 0.0), Push(0.0, 4.0)], HALL.replace("bb.............bb", "bb..........b..bb", 1)),  # a stub
    ],
)
def test_what_is_not_in_the_corner_has_no_certificate(tmp_path: Path, way: list[Command], room: str) -> None:
    found = pushed(tmp_path, Grasp("east"), *way, room=room)
    with pytest.raises(NoCertificateError, match="nothing shows"):
        found_certificate(found)


def test_a_colour_tells_a_thing_where_it_is_the_only_one_of_it() -> None:
    found = drawn_push(23)  # the corner was not seen square by square before the thing came
    stated = json.loads(found_certificate(found))
    assert stated["given"] == [SINGLE]
    assert refused(found, stated | {"given": []})
    assert "must be" in refused(found, stated | {"given": [SINGLE, SINGLE]})


def test_what_leans_on_a_wall_is_as_wide_as_it_was(tmp_path: Path) -> None:
    to_wall = [Grasp("east"), Push(5.0, 0.0), Release()]
    way = [*to_wall, Move(0.0, -1.0), Move(1.0, 0.0), Grasp("north"), Push(0.0, 4.0)]
    found = pushed(tmp_path, *way)
    text = found_certificate(found)
    assert shown(found, json.loads(text)).startswith(f"done: {NORTHEAST} at step {len(way)}")


@pytest.mark.parametrize("seed", [33])
def test_a_gap_beside_the_last_row_of_wall_is_seen(seed: int) -> None:
    with pytest.raises(NoCertificateError):  # the thing covers a part of a row that is wall, and is 1.66 squares off
        found_certificate(drawn_push(seed))


@pytest.mark.skipif(NODE is None, reason="no Node was found")
@pytest.mark.parametrize("seed", few([23, 27], 1))
def test_both_checkers_agree_on_what_was_pushed(tmp_path: Path, seed: int) -> None:
    found, stated = corner_certificate(tmp_path)
    texts = [json.dumps(stated), json.dumps(stated | {"given": []})]
    texts += [json.dumps(stated | {"given": [SINGLE, "along(grid)"], "meaning": {"x": [k, 2]}}) for k in range(5)]
    assert accepted_by_both(tmp_path, found.text, [*texts, *map(json.dumps, mutants(stated, 60, 2))]) > 1
    drawn = drawn_push(seed)
    stated = json.loads(found_certificate(drawn))
    assert accepted_by_both(tmp_path, drawn.text, [json.dumps(stated), *map(json.dumps, mutants(stated, 6, seed))]) > 0


@pytest.mark.parametrize("seed", few(range(30), 6))
def test_the_rules_allow_what_was_pushed(seed: int) -> None:
    assert lost_truth(drawn_push(seed)) == ""
