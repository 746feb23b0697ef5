"""Certificates made by hand, right and wrong, and some that the search found."""

import json
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.certificates.drawn import drawn_walk
from benchmarks.certificates.mutants import mutants
from benchmarks.certificates.recorded import RecordedWalk, recorded_walk
from benchmarks.certificates.truth import holds, lost_truth
from tests.tables import few
from utak.geometry import Screen
from utak.kb.body import Command, Grasp, Move, Push, Release
from utak.simulator.certificates.checker import is_one_room, verify
from utak.simulator.certificates.courses import LEVEL_RANGES, SAMPLED_FIELDS, RefusedError, spread
from utak.simulator.certificates.search import NoCertificateError, certificate_of
from utak.simulator.cli.main import main
from utak.simulator.scenario.picture import read_picture

ROOM = """
bbbbbbbbbbbb
b.........Ub
b..........b
b..gg......b
b..gg......b
b..........b
bbbbbbbbbbbb
"""
(OWN_FIELD,) = {*range(160)} - SAMPLED_FIELDS
Change = Callable[[dict[str, Any]], None]


def walk(
    tmp_path: Path,
    room: str,
    commands: Sequence[Command],
    *goals: str,
    claims: Sequence[str] = (),
    noise: tuple[float, int] = (0.0, 0),
) -> RecordedWalk:
    path = tmp_path / "world.txt"
    path.write_text(room.strip() + "\n")
    return recorded_walk(read_picture(path), commands, goals, claims, ("x", "y"), noise=noise)


def certificate(walk: RecordedWalk, cases: list[Any], **more: Any) -> dict[str, Any]:
    steps = [len(walk.places) - 1] * len(walk.goals)
    head = {"utak": "certificate", "version": 1, "claim": "done", "goals": list(walk.goals)}
    return {**head, "steps": steps, "meaning": {}, "given": [], "risk": 0, "cases": cases, **more}


def shown(walk: RecordedWalk, stated: dict[str, Any]) -> str:
    return verify(walk.text, json.dumps(stated))


def refused(walk: RecordedWalk, stated: dict[str, Any]) -> str:
    with pytest.raises(RefusedError) as caught:
        shown(walk, stated)
    return str(caught.value)


def found_certificate(walk: RecordedWalk, verdict: str = "done") -> str:
    return certificate_of(walk.text.splitlines(keepends=True), verdict)


def in_corner(tmp_path: Path) -> tuple[RecordedWalk, dict[str, Any]]:
    """Return a robot that goes into the corner, and the certificate that it is there if it woke along the grid."""
    found = walk(tmp_path, ROOM.replace(".U", "U."), [Move(1.0, 0.0)], "at(utak,corner(northeast))")
    cases = json.loads(found_certificate(found))["cases"]
    return found, certificate(found, cases[: cases.index(["angle", 1])], given=["along(grid)"])


def test_levels_stand_for_the_counts_that_show_them() -> None:
    assert [LEVEL_RANGES[4, level] for level in (0, 1, 7)] == [[0, 1], [2, 3], [15, 16]]
    assert [LEVEL_RANGES[2, level] for level in (0, 2, 4, 5, 7)] == [[n, n] for n in range(5)]
    assert (2, 3) not in LEVEL_RANGES


def test_the_cases_along_the_grid_show_a_corner(tmp_path: Path) -> None:
    found, stated = in_corner(tmp_path)
    assert shown(found, stated) == "done: at(utak,corner(northeast)) at step 1; given along(grid)"


def test_a_square_of_the_wall_in_which_the_robot_was_stopped_is_no_floor(tmp_path: Path) -> None:
    way = [Move(1.0, 0.0), Move(0.0, 3.0), Move(0.0, -0.3)]
    found = walk(tmp_path, ROOM.replace(".U", "U."), way, "at(utak,corner(northeast))")
    assert found.places[2][1] == 6.0  # its square is the one beyond
    assert shown(found, json.loads(found_certificate(found))).startswith("done: at(utak,corner(northeast)) at step 3")


def without(cases: list[Any], word: str) -> None:
    """Take all lines of a kind away."""
    cases[:] = [line for line in cases if line[0] != word]


WRONG_CHANGES: list[tuple[Change, str]] = [
    (lambda c: without(c["cases"], "count"), ""),
    (lambda c: without(c["cases"], "end"), ""),
    (lambda c: without(c["cases"], "holds"), ""),
    (lambda c: c["cases"].pop(), "all cases are treated"),
    (lambda c: c.update(given=[]), "all cases are treated"),  # 89 orientations are left
    (lambda c: c.update(claim="impossible"), "may not hold"),
    (lambda c: c.update(goals=["at(utak,corner(southwest))"]), "of goals of the episode"),
    (lambda c: c.update(steps=[2]), "does not have"),
    (lambda c: c.update(steps=[]), "step for each goal"),
    (lambda c: c.update(steps=[None]), "does not have"),
    (lambda c: c.update(steps=[0]), "does not hold at the end"),
    (lambda c: c.update(more=1), "no others"),
    (lambda c: c.pop("risk"), "no others"),
    (lambda c: c.update(risk=1), "its risk must be"),  # nothing is left to chance
    (lambda c: c["cases"].insert(1, ["trust", "me"]), "no line that may stand here"),
    (lambda c: c["cases"].insert(1, ["holds"]), "no line that may stand here"),
    (lambda c: c["cases"].insert(1, ["count", [1, 0, 1]]), "no field of an impression so far"),
    (
        lambda c: c["cases"].insert(1, ["count", [0, OWN_FIELD, 1]]),
        "no field of an impression so far",
    ),  # its own square
    (lambda c: c["cases"].insert(1, ["count", [-1, 0, 1]]), "no field of an impression so far"),
    (lambda c: c["cases"].insert(1, ["count", [0, 0, True]]), "no line that may stand here"),
    (lambda c: c.update(version=True), "no certificate of version 1"),
    (lambda c: c.update(version=1.0), "no certificate of version 1"),
    (lambda c: c["cases"].__setitem__(0, ["angle", 0.0]), "no line that may stand here"),
    (lambda c: c["cases"].__setitem__(0, ["angle", False]), "no line that may stand here"),
]


@pytest.mark.parametrize(("change", "why"), WRONG_CHANGES)
def test_what_does_not_show_it_is_refused(tmp_path: Path, change: Change, why: str) -> None:
    found, stated = in_corner(tmp_path)
    change(stated)
    assert why in refused(found, stated)


def test_another_corner_is_further(tmp_path: Path) -> None:
    found = walk(tmp_path, ROOM.replace(".U", "U."), [Move(1.0, 0.0)], "at(utak,corner(southeast))")
    assert "may not hold" in refused(found, certificate(found, in_corner(tmp_path)[1]["cases"], given=["along(grid)"]))


def test_the_place_of_waking_is_shown_in_each_orientation(tmp_path: Path) -> None:
    found = walk(tmp_path, ROOM, [], "at(utak,start)")
    cases = [line for angle in range(90) for line in (["angle", angle], ["holds"])]
    assert shown(found, certificate(found, cases)) == "done: at(utak,start) at step 0"
    assert "no line that may stand here" in refused(found, certificate(found, cases[:40] + cases[42:]))
    assert "agrees with no world" in refused(found, certificate(found, []))


def test_a_thing_is_what_was_felt(tmp_path: Path) -> None:
    room = ROOM.replace("U", ".").replace("b..gg......b", "b..ggU.....b", 1)
    found = walk(tmp_path, room, [], "at(utak,x)", claims=["colour(x,g)", "shape(x,square)"])
    stated = certificate(found, [], meaning={"x": [0, 6]}, given=["shape(x,square)"])
    assert shown(found, stated).endswith("x is the thing felt at step 0, touch 6; given shape(x,square)")
    assert "must be" in refused(found, stated | {"given": []})
    assert "nothing was felt" in refused(found, stated | {"meaning": {"x": [0, 2]}})
    assert "not named by a step" in refused(found, stated | {"meaning": {"x": [-1, 6]}})
    with pytest.raises(ValueError, match="damaged"):
        shown(found, stated | {"meaning": {"x": [1, 6]}})
    assert "of each thing" in refused(found, stated | {"meaning": {"y": [0, 6]}})
    red = walk(tmp_path, room, [], "at(utak,x)", claims=["colour(x,r)"])
    assert "another colour" in refused(red, certificate(red, [], meaning={"x": [0, 6]}, given=["colour(x,r)"]))


def test_the_verge_is_no_thing(tmp_path: Path) -> None:
    found = walk(tmp_path, ROOM, [], "at(utak,x)")
    assert "or verge" in refused(found, certificate(found, [], meaning={"x": [0, 0]}))


def test_a_walk_there_and_back_is_found_in_all_orientations(tmp_path: Path) -> None:
    found = walk(tmp_path, ROOM, [Move(-7.0, 0.0), Move(7.0, 0.0)], "at(utak,start)")
    assert verify(found.text, found_certificate(found)) == "done: at(utak,start) at step 2"


def test_a_robot_that_was_stopped_has_no_certificate(tmp_path: Path) -> None:
    room = ROOM.replace("U", ".").replace("b..gg......b", "b..gg...U..b", 1)
    found = walk(tmp_path, room, [Move(-7.0, 0.0), Move(7.0, 0.0)], "at(utak,start)")
    assert abs(found.places[-1][0] - found.places[0][0]) > 1
    with pytest.raises(NoCertificateError):
        found_certificate(found)


def test_a_robot_that_may_hold_something_pushes_or_releases_it(tmp_path: Path) -> None:
    room = ROOM.replace("U", ".").replace("b..gg......b", "b..ggU.....b", 1)
    found = walk(tmp_path, room, [Grasp("west"), Move(1.0, 0.0)], "at(utak,start)")
    with pytest.raises(NoCertificateError, match="not pushed or released"):
        found_certificate(found)


CARRIED = """
bbbbbbbbbbbbbbb
b.............b
b.............b
b.............b
b.....gg......b
b..U..gg..k...b
b.............b
b.............b
bbbbbbbbbbbbbbb
"""
TO_THING = [Move(2.0, 0.0), Grasp("east")]


def test_what_was_carried_to_a_square_that_was_free_covers_it(tmp_path: Path) -> None:
    found = walk(tmp_path, CARRIED, [*TO_THING, Push(-3.0, 0.0)], "at(x,start)")
    text = found_certificate(found)
    assert verify(found.text, text) == "done: at(x,start) at step 3, x is the thing felt at step 1, touch 2"
    stated = json.loads(text)
    assert "may not hold" in refused(found, stated | {"meaning": {"x": [2, 2]}})  # felt, and not grasped next
    assert "may not hold" in refused(found, stated | {"meaning": {"x": [1, 1]}})


@pytest.mark.parametrize("push", [Push(-1.0, 0.0), Push(-2.0, -2.0), Push(3.0, 0.0)])
def test_what_was_carried_elsewhere_has_no_certificate(tmp_path: Path, push: Push) -> None:
    found = walk(tmp_path, CARRIED, [*TO_THING, push], "at(x,start)")
    with pytest.raises(NoCertificateError, match="nothing shows"):
        found_certificate(found)


@pytest.mark.parametrize("goal", ["beside(x,y)", "at(x,y)"])
def test_what_was_carried_lies_beside_what_was_felt(tmp_path: Path, goal: str) -> None:
    look = [Move(4.0, -2.0), Move(-2.0, 2.0), Grasp("east")]  # where it is carried to is seen to be free before
    way = [Push(2.0, 0.0), Release(), Move(0.0, -2.0), Move(4.0, 1.0)]
    found = walk(tmp_path, CARRIED, [*look, *way], goal)
    assert verify(found.text, found_certificate(found)).startswith(f"done: {goal} at step 7")
    found = walk(tmp_path, CARRIED, [*look, Push(1.0, 0.0), *way[1:]], goal)
    with pytest.raises(NoCertificateError, match="nothing shows"):
        found_certificate(found)


def test_what_leans_on_a_wall_may_be_larger_than_the_checker_looks(tmp_path: Path) -> None:
    room = ROOM.replace("U", ".").replace("b..........b", "bggU.......b", 1)
    found = walk(tmp_path, room, [Grasp("west"), Push(1.0, 0.0), Push(-1.0, 0.0)], "at(utak,start)")
    with pytest.raises(NoCertificateError, match="nothing bounds"):
        found_certificate(found)


@pytest.mark.parametrize(("key", "value"), [("forked", []), ("options", {"noise": 0.0, "kb": ["rules.lp"]})])
def test_in_other_circumstances_nothing_is_said_of_places(tmp_path: Path, key: str, value: Any) -> None:
    found = walk(tmp_path, ROOM, [], "at(utak,start)")
    head, *rows = found.text.splitlines(keepends=True)
    text = json.dumps(json.loads(head) | {key: value}) + "\n" + "".join(rows)
    with pytest.raises(RefusedError, match="nothing is said of where the robot is"):
        verify(text, json.dumps(certificate(found, [["angle", 0], ["holds"]], given=["along(grid)"])))
    with pytest.raises(NoCertificateError, match="nothing is said of where the robot is"):
        certificate_of(text.splitlines(keepends=True), "done")


CLOSED = "bbbbbbbb\nb......b\nb......b\nb..kk..b\nb......b\nb.U....b\nbbbbbbbb"


@pytest.mark.parametrize(
    ("room", "is_shown"),
    [
        (CLOSED, True),
        (CLOSED.replace("b......b", "b.......", 1), False),  # a door
        (CLOSED.replace("b......b", "b...b..b", 1), False),  # a stub of wall may make rooms
        (CLOSED.replace("b......b", "b......k", 1), False),  # what fills the wall may be moved
    ],
)
def test_a_room_whose_walls_were_felt_has_no_next_one(tmp_path: Path, room: str, is_shown: bool) -> None:
    way = [(-1, 0), (0, 2), (0, 2), (2, 0), (3, 0), (0, -2), (0, -2), (-2, 0), (-2, 0)]
    found = walk(tmp_path, room, [Move(float(e), float(n)) for e, n in way], "in(utak,room(next))")
    if is_shown:
        told = verify(found.text, found_certificate(found, "impossible"))
        assert told == "impossible: in(utak,room(next)) at step 9; given whole(squares), isolated(things)"
    else:
        with pytest.raises(NoCertificateError):
            found_certificate(found, "impossible")


BOX = "bbbbbbbbbb\nb........b\nb........b\nb........b\nb..kkk...b\nb..kkk....\nb..kkk....\nbU.......b\nbbbbbbbbbb"
ROUND = [
    (0, 2),
    (0, 2),
    (0, 2),
    (2, 0),
    (2, 0),
    (2, 0),
    (1, 0),
    (0, -2),
    (0, -1),
    (0, -2),
    (0, -1),
    (-2, 0),
    (-2, 0),
    (-1, 0),
]


@pytest.mark.parametrize(
    ("room", "why"),
    [
        (BOX, ""),
        (BOX.replace("kkk", "kk."), "nothing shows"),  # a thing of two by three squares goes through
        (BOX.replace("b........b", "b.........", 3), "nothing shows"),  # the gap is as wide as it
        (BOX.replace("kkk", "k.k", 1), "nothing shows"),  # a part of it is no wider than the gap
    ],
)
def test_what_is_wider_than_each_gap_does_not_get_out(tmp_path: Path, room: str, why: str) -> None:
    way = [Move(float(e), float(n)) for e, n in ROUND]
    found = walk(tmp_path, room, [Move(1.0, 0.0), Move(-1.0, 0.0), *way], "in(x,room(next))")
    if why:
        with pytest.raises(NoCertificateError, match=why):
            found_certificate(found, "impossible")
        return
    text = found_certificate(found, "impossible")
    given = "given whole(squares), isolated(things), apart(things)"
    assert verify(found.text, text).startswith("impossible: in(x,room(next)) at step 16, x is the thing felt")
    assert verify(found.text, text).endswith(given)
    stated = json.loads(text)
    for step in range(len(found.places) - 1):  # before all was felt
        assert refused(found, stated | {"steps": [step]})
    assert "may not hold" in refused(found, stated | {"given": []})
    assert "must be" in refused(found, stated | {"given": given[6:].split(", ")[:2]})


def test_of_other_goals_nothing_shows_that_they_are_impossible(tmp_path: Path) -> None:
    found = walk(tmp_path, CLOSED, [], "at(utak,x)")
    with pytest.raises(NoCertificateError, match="show nothing of them"):
        found_certificate(found, "impossible")
    stated = certificate(found, [], claim="impossible", given=["whole(squares)", "isolated(things)"])
    assert "nothing is shown of at(utak,x)" in refused(found, stated)


L_ROOM = """
bbbbbbbbbbbbbbb
b.............b
b.............b
b.............b
b.U...........b
b.............b
b.............b
bbbbbbb.......b
bbbbbbb.......b
bbbbbbb.......b
bbbbbbb.......b
bbbbbbb.......b
bbbbbbbbbbbbbbb
"""
FLOOR_SIDE = 30  # squares, of random floors with all about them
DUMBBELL = L_ROOM.replace("bbbbbbb.......b", "bbbbbbbbbb.bbbb", 1)  # a door between two parts


def felt_all_round(room: str) -> list[Command]:
    """Return moves from one square to the next that beside them has a wall, on and on around the floor."""
    rows = room.strip().splitlines()
    free = {(i, len(rows) - 1 - j) for j, row in enumerate(rows) for i, letter in enumerate(row) if letter in ".U"}
    (here,) = [(i, len(rows) - 1 - j) for j, row in enumerate(rows) for i, letter in enumerate(row) if letter == "U"]
    rim = {(i, j) for i, j in free if not {(i + a, j + b) for a in (-1, 0, 1) for b in (-1, 0, 1)} <= free}
    way = [Move(0.0, float(min(j for i, j in rim if i == here[0]) - here[1]))]
    here = start = (here[0], min(j for i, j in rim if i == here[0]))
    a, b = 1, 0
    while True:  # the wall is on the right
        if (here[0] + b, here[1] - a) in free:
            a, b = b, -a
        elif (here[0] + a, here[1] + b) not in free:
            a, b = -b, a
            continue
        here = here[0] + a, here[1] + b
        way.append(Move(float(a), float(b)))
        if here == start:
            return way


@pytest.mark.parametrize(("room", "is_shown"), [(L_ROOM, True), (DUMBBELL, False)])
def test_a_room_may_have_any_shape_without_a_door(tmp_path: Path, room: str, is_shown: bool) -> None:
    found = walk(tmp_path, room, felt_all_round(room), "in(utak,room(next))")
    if is_shown:
        assert verify(found.text, found_certificate(found, "impossible")).startswith("impossible: in(utak,room(next))")
    else:
        with pytest.raises(NoCertificateError, match="nothing shows"):
            found_certificate(found, "impossible")


def random_floor(seed: int) -> frozenset[tuple[int, int]]:
    """Return the squares of some rectangles that hang together, without holes, columns and rows from 1 to 28."""
    random = np.random.default_rng(seed)
    parts = [(random.integers(1, 16, 2), random.integers(1, 12, 2)) for _ in range(int(random.integers(1, 5)))]
    free = {(int(w) + i, int(s) + j) for (w, s), (e, n) in parts for i in range(e) for j in range(n)}
    floor = spread(frozenset([min(free)]), lambda at: at in free)
    around = spread(frozenset([(0, 0)]), lambda at: at not in floor and min(at) >= 0 and max(at) < FLOOR_SIDE)
    return frozenset((i, j) for i in range(FLOOR_SIDE) for j in range(FLOOR_SIDE)) - around


@pytest.mark.parametrize("seed", few(range(60), 20))
def test_a_floor_that_is_one_room_has_no_doors(seed: int) -> None:
    floor = random_floor(seed)
    free = np.zeros((FLOOR_SIDE, FLOOR_SIDE), dtype=bool)
    free[tuple(zip(*floor, strict=True))] = True
    assert not (is_one_room(floor, 1) and Screen(free).passages())


def test_the_corners_of_a_large_floor_are_too_far_apart(tmp_path: Path) -> None:
    goals = "at(utak,corner(northeast))", "at(utak,corner(southwest))"
    found = walk(tmp_path, L_ROOM, [], *goals)
    text = found_certificate(found, "impossible")
    assert verify(found.text, text) == f"impossible: {goals[0]} at step 0, {goals[1]} at step 0"
    stated = json.loads(text)
    assert stated["given"] == []  # things may cover a part of a square
    assert "may not hold" in refused(found, stated | {"steps": [0, None]})
    small = walk(tmp_path, "bbbbb\nb.U.b\nb...b\nbbbbb", [], *goals)
    assert "may not hold" in refused(small, stated | {"cases": [["angle", 0], ["holds"]], "given": ["along(grid)"]})


def test_a_corner_beyond_the_wall_of_a_closed_room_is_impossible(tmp_path: Path) -> None:
    beyond = "........\n" * 7  # north of the wall
    room = "\n".join(line + "........" for line in f"{beyond}{CLOSED}".splitlines())
    way = [(-1, 0), (0, 2), (0, 2), (2, 0), (3, 0), (0, -2), (0, -2), (-2, 0), (-2, 0)]
    found = walk(tmp_path, room, [Move(float(e), float(n)) for e, n in way], "at(utak,corner(northeast))")
    told = verify(found.text, found_certificate(found, "impossible"))
    assert told.startswith("impossible: at(utak,corner(northeast)) at step 9; given whole(squares), isolated(things)")


def test_what_is_impossible_may_be_shown_of_an_earlier_step(tmp_path: Path) -> None:
    way = [(-1, 0), (0, 2), (0, 2), (2, 0), (3, 0), (0, -2), (0, -2), (-2, 0), (-2, 0)]
    commands = [*(Move(float(e), float(n)) for e, n in way), Move(0.0, 2.0), Grasp("east"), Move(1.0, 0.0)]
    found = walk(tmp_path, CLOSED, commands, "in(utak,room(next))")
    stated = json.loads(found_certificate(found, "impossible"))
    assert stated["steps"] == [11]  # the move may be none, with something in hand
    assert shown(found, stated).startswith("impossible: in(utak,room(next)) at step 11")


@pytest.mark.parametrize("goal", ["in(utak,r)", "around(utak,corner)", 'avoid(utak,"POINT (1 1)")', "circled(x,y)"])
def test_other_goals_are_refused(tmp_path: Path, goal: str) -> None:
    found = walk(tmp_path, ROOM, [], goal)
    assert "nothing is shown of" in refused(found, certificate(found, []))


def test_mutants_that_are_accepted_claim_the_same(tmp_path: Path) -> None:
    goals = "first(at(utak,corner(northeast)))", "then(at(utak,start))"
    found = walk(tmp_path, ROOM, [Move(-2.0, -1.0), Move(2.0, 1.0)], *goals)
    stated = json.loads(found_certificate(found))
    stated["cases"] = stated["cases"][: stated["cases"].index(["angle", 1])]
    stated["given"] = ["along(grid)"]
    assert shown(found, stated)
    accepted = 0
    for mutant in mutants(stated, 200, seed=1):
        with suppress(RefusedError):
            shown(found, mutant)
            accepted += 1
            assert mutant["given"] == stated["given"]
            assert holds(found, goals[0][6:-1], mutant["steps"][0], {})
    assert 0 < accepted < 60  # such as a line told twice


@pytest.mark.parametrize("seed", few(range(30), 6))
def test_the_rules_allow_what_happened(seed: int) -> None:
    assert lost_truth(drawn_walk(seed)) == ""


def test_the_command_says_what_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found, stated = in_corner(tmp_path)
    episode, good, bad = tmp_path / "ep.jsonl", tmp_path / "good.json", tmp_path / "bad.json"
    episode.write_text(found.text)
    good.write_text(json.dumps(stated))
    bad.write_text(json.dumps(stated | {"steps": []}))
    assert main(["verify", str(episode), str(good)]) == 0
    assert capsys.readouterr().out.startswith("accepted: done: at(utak,corner(northeast))")
    assert main(["verify", str(episode), str(bad)]) == 1
    assert capsys.readouterr().out.startswith("refused: ")
    assert main(["verify", str(good), str(good)]) == 65
    assert "good.json" in capsys.readouterr().err
    good.write_text('{"utak": 1, "utak": 1e99999}')
    assert main(["verify", str(episode), str(good)]) == 65
    assert main(["verify", str(episode), str(tmp_path / "none")]) == 66
