"""Certificates of what was led into the next room: doors, walls, and rooms that are none."""

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks.certificates.doors import drawn_doors
from benchmarks.certificates.recorded import RecordedWalk
from benchmarks.certificates.truth import holds, is_given, lost_truth
from tests.simulator.certificates.test_checker import Change, certificate, found_certificate, refused, shown, walk
from tests.simulator.certificates.test_second_checker import NODE, accepted_by_both
from tests.tables import few
from utak.kb.body import Command, Grasp, Move, Push, Release
from utak.simulator.certificates.search import NoCertificateError

ROOMS = """
bbbbbbbbbbbbbbbbb
b......b........b
b......b........b
b......b........b
b.U.............b
b.............y.b
b......b........b
b......b........b
bbbbbbbbbbbbbbbbb
"""
THROUGH: list[Command] = [Move(3.0, 0.0), Move(4.0, 0.0), Move(2.0, 1.0)]
GIVEN = ["verge(walls)", "isolated(things)", "parted(rooms)"]
THING_ROOMS = ROOMS.replace("b.U.............b", "b..U............b").replace("b.............y.b", "b..kk...........b")
CARRYING: list[Command] = [Grasp("south"), Push(4.0, 0.0), Push(6.0, 0.0), Release(), Move(-2.0, 1.0)]


def along_grid(found: RecordedWalk) -> dict[str, Any]:
    """Return the certificate of a walk, in the orientation that is the true one."""
    stated: dict[str, Any] = json.loads(found_certificate(found))
    stated["cases"] = stated["cases"][: stated["cases"].index(["angle", 1])]
    return stated | {"given": [*stated["given"], "along(grid)"]}


def through(tmp_path: Path, room: str = ROOMS, goal: str = "in(utak,room(next))") -> RecordedWalk:
    return walk(tmp_path, room, THROUGH, goal)


def test_a_door_between_rooms_that_are_seen_is_shown(tmp_path: Path) -> None:
    stated = along_grid(through(tmp_path))
    assert shown(through(tmp_path), stated).endswith(f"; given {', '.join([*GIVEN, 'along(grid)'])}")
    (line,) = (line for line in stated["cases"] if line[0] == "holds")
    assert line[1] == [5, -1, 5, 0]  # the door, from the square of waking


@pytest.mark.parametrize(
    ("room", "why"),
    [
        (ROOMS.replace("b......b........b", "b...............b", 4), "nothing shows"),  # there is no wall
        (ROOMS.replace("b......b........b", "b...............b", 1), "nothing shows"),  # nor one on this side
        (ROOMS.replace("b......b........b", "b.b....b........b"), "nothing shows"),  # it is wider than half of this
    ],
)
def test_other_gaps_are_no_doors(tmp_path: Path, room: str, why: str) -> None:
    if room.count("b...............b") == 1:
        room = room.replace("b......b", "b.......")
    with pytest.raises(NoCertificateError, match=why):
        found_certificate(through(tmp_path, room))


def change_of(rectangle: int, side: int, by: int) -> Change:
    """Return the change of a side of the door (1) or of the room before (2) or behind it (3)."""

    def change(stated: dict[str, Any]) -> None:
        (line,) = (line for line in stated["cases"] if line[0] == "holds")
        line[rectangle][side] += by

    return change


WRONG_DOORS = [
    *(change_of(1, side, by) for side in range(4) for by in (-1, 1)),  # narrower or wider than the gap, or elsewhere
    change_of(2, 2, -1),  # it does not reach the door
    change_of(3, 0, 1),
    change_of(2, 0, 3),  # the robot began outside
    change_of(3, 2, -8),  # it is outside now
    change_of(2, 0, -9),  # there is wall in it
    change_of(3, 3, 9),
]


@pytest.mark.parametrize("change", WRONG_DOORS)
def test_other_rectangles_are_refused(tmp_path: Path, change: Change) -> None:
    stated = along_grid(through(tmp_path))
    change(stated)
    assert "may not hold" in refused(through(tmp_path), stated)


def test_what_is_given_and_named_must_be_so(tmp_path: Path) -> None:
    found = through(tmp_path)
    stated = along_grid(found)
    assert "must be" in refused(found, stated | {"given": ["along(grid)"]})
    number = next(n for n, line in enumerate(stated["cases"]) if line[0] == "holds")
    for line in (["holds"], ["holds", *stated["cases"][number][1:3]], ["holds", *stated["cases"][number][1]]):
        cases = [*stated["cases"][:number], line, *stated["cases"][number + 1 :]]
        refused(found, stated | {"cases": cases})


def test_a_thing_that_was_pushed_through_is_in_the_next_room(tmp_path: Path) -> None:
    found = walk(tmp_path, THING_ROOMS, CARRYING, "in(x,room(next))")
    stated = along_grid(found)
    assert shown(found, stated).endswith(f"x is the thing felt at step 0, touch 4; given {', '.join(stated['given'])}")
    short = walk(tmp_path, THING_ROOMS, [*CARRYING[:2], Release(), Move(-2.0, 1.0)], "in(x,room(next))")
    with pytest.raises(NoCertificateError, match="nothing shows"):
        found_certificate(short)  # a part of it is in the door


@pytest.mark.skipif(NODE is None, reason="no Node was found")
def test_both_agree_on_doors(tmp_path: Path) -> None:
    found = through(tmp_path)
    stated = along_grid(found)
    texts = [json.dumps(stated), json.dumps(stated | {"given": stated["given"][1:]})]
    for change in WRONG_DOORS:
        copy = json.loads(json.dumps(stated))
        change(copy)
        texts.append(json.dumps(copy))
    assert accepted_by_both(tmp_path, found.text, texts) == 1


@pytest.mark.skipif(NODE is None, reason="no Node was found")
def test_both_agree_on_what_was_pushed_through(tmp_path: Path) -> None:
    found = walk(tmp_path, THING_ROOMS, CARRYING, "in(x,room(next))")
    stated = along_grid(found)
    texts = [json.dumps(stated), *(json.dumps(stated | {"meaning": {"x": [k, 4]}}) for k in range(1, 6))]
    assert accepted_by_both(tmp_path, found.text, texts) == 1


@pytest.mark.skipif(NODE is None, reason="no Node was found")
def test_both_take_no_door_for_a_thing_or_the_robot(tmp_path: Path) -> None:
    found = walk(tmp_path, THING_ROOMS, [], "at(x,start)")
    episode = found.text.replace('"x": "object"', '"x": "door"')
    stated = certificate(found, [["angle", 0], ["holds"]], given=["along(grid)"])
    texts = [json.dumps(stated | {"meaning": meaning}) for meaning in ({}, {"x": [0, 4]})]
    assert episode != found.text
    assert accepted_by_both(tmp_path, episode, texts) == 0


@pytest.mark.parametrize("seed", few(range(20), 5))
def test_the_rules_allow_what_happened_at_doors(seed: int) -> None:
    assert lost_truth(drawn_doors(seed)) == ""


@pytest.mark.parametrize("seed", few([3005, 3011, 3006], 2))
def test_what_is_shown_of_drawn_doors_is_true(seed: int) -> None:
    found = drawn_doors(seed)
    stated = json.loads(found_certificate(found))
    is_true = holds(found, found.goals[0], stated["steps"][0], stated["meaning"])
    assert is_true or not is_given(found, stated["given"], stated["cases"])
