"""Two checkers of certificates, the second written from docs/certificates.md alone, agree on the same certificates."""

import json
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from benchmarks.certificates.drawn import drawn_walk
from benchmarks.certificates.mutants import mutants
from tests.simulator.certificates.test_checker import (
    BOX,
    CARRIED,
    CLOSED,
    DUMBBELL,
    L_ROOM,
    ROOM,
    ROUND,
    TO_THING,
    WRONG_CHANGES,
    Change,
    certificate,
    felt_all_round,
    found_certificate,
    in_corner,
    walk,
)
from tests.tables import few
from utak.kb.body import Grasp, Move, Push, Release
from utak.simulator.certificates.checker import verify
from utak.simulator.certificates.courses import RefusedError

SECOND = Path(__file__).resolve().parents[3] / "simulator" / "replay" / "page_parts" / "certificate.js"
NODE = shutil.which("node") or shutil.which("nodejs")
pytestmark = pytest.mark.skipif(NODE is None, reason="no Node was found")
FELT = ROOM.replace("U", ".").replace("b..gg......b", "b..ggU.....b", 1)


def second_answers(folder: Path, episode: str, certificates: Sequence[str]) -> list[str]:
    """Return what the second checker says of certificates of an episode, in a line each."""
    paths = [folder / f"certificate{n}.json" for n in range(len(certificates))]
    (folder / "episode.jsonl").write_text(episode)
    for path, text in zip(paths, certificates, strict=True):
        path.write_text(text)
    command = [str(NODE), str(SECOND), str(folder / "episode.jsonl"), *map(str, paths)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120).stdout.splitlines()


def is_accepted(episode: str, text: str) -> bool:
    """Return whether the first checker accepts a certificate."""
    try:
        verify(episode, text)
    except (RefusedError, ValueError):
        return False
    return True


def accepted_by_both(folder: Path, episode: str, certificates: Sequence[str]) -> int:
    """Return how many certificates both checkers accept; no other one is accepted by one of them."""
    answers = second_answers(folder, episode, certificates)
    for text, answer in zip(certificates, answers, strict=True):
        assert answer.startswith("accepted: " if is_accepted(episode, text) else "refused: "), (answer, text)
    return sum(answer.startswith("accepted: ") for answer in answers)


def changed(stated: dict[str, Any], change: Change) -> str:
    """Return the text of a certificate that was changed."""
    copy = json.loads(json.dumps(stated))
    change(copy)
    return json.dumps(copy)


def test_both_refuse_what_does_not_show_it(tmp_path: Path) -> None:
    found, stated = in_corner(tmp_path)
    texts = [json.dumps(stated), *(changed(stated, change) for change, _ in WRONG_CHANGES)]
    assert accepted_by_both(tmp_path, found.text, texts) == 1


def test_both_agree_on_mutants(tmp_path: Path) -> None:
    goals = "first(at(utak,corner(northeast)))", "then(at(utak,start))"
    found = walk(tmp_path, ROOM, [Move(-2.0, -1.0), Move(2.0, 1.0)], *goals)
    cases = json.loads(found_certificate(found))["cases"]
    stated = certificate(found, cases[: cases.index(["angle", 1])], steps=[0, 2], given=["along(grid)"])
    assert accepted_by_both(tmp_path, found.text, [json.dumps(stated), *map(json.dumps, mutants(stated, 100, 1))]) > 1


def test_both_agree_on_a_thing_that_was_felt(tmp_path: Path) -> None:
    claims = ["colour(x,g)", "shape(x,square)", "beside(y,x)"]
    found = walk(tmp_path, FELT, [], "at(utak,x)", claims=claims)
    stated = certificate(found, [], meaning={"x": [0, 6]}, given=claims[1:])
    texts = [json.dumps(stated | {"given": given}) for given in (claims[1:], claims, claims[:2], claims[:0:-1])]
    texts += [json.dumps(stated | {"meaning": meaning}) for meaning in ({"x": [0, 2]}, {"y": [0, 6]}, {"x": [1, 6]})]
    assert accepted_by_both(tmp_path, found.text, texts) == 1


@pytest.mark.parametrize("direction", ["west", "east"])
def test_both_say_nothing_of_places_after_a_grasp_that_may_have_taken(tmp_path: Path, direction: str) -> None:
    found = walk(tmp_path, FELT, [Grasp(direction)], "at(utak,start)")
    stated = certificate(found, [["angle", 0], ["end", 0, 0], ["holds"]], given=["along(grid)"])
    assert accepted_by_both(tmp_path, found.text, [json.dumps(stated)]) == (direction == "east")


def test_both_agree_on_a_room_without_a_way_out(tmp_path: Path) -> None:
    way = [(-1, 0), (0, 2), (0, 2), (2, 0), (3, 0), (0, -2), (0, -2), (-2, 0), (-2, 0)]
    found = walk(tmp_path, CLOSED, [Move(float(e), float(n)) for e, n in way], "in(utak,room(next))")
    stated = json.loads(found_certificate(found, "impossible"))
    texts = [json.dumps(stated), *map(json.dumps, mutants(stated, 8, 3))]
    assert accepted_by_both(tmp_path, found.text, texts) > 0


@pytest.mark.parametrize("seed", few([48, 14, 28, 31], 1))
def test_both_agree_on_drawn_walks(tmp_path: Path, seed: int) -> None:
    found = drawn_walk(seed)
    stated = json.loads(found_certificate(found))
    assert accepted_by_both(tmp_path, found.text, [json.dumps(stated), *map(json.dumps, mutants(stated, 5, seed))]) > 0


@pytest.mark.parametrize("goal", few(["at(x,start)", "beside(x,y)"], 1))
def test_both_agree_on_what_was_carried(tmp_path: Path, goal: str) -> None:
    look = [Move(4.0, -2.0), Move(-2.0, 2.0), Grasp("east"), Push(2.0, 0.0), Release(), Move(0.0, -2.0), Move(4.0, 1.0)]
    way = [*TO_THING, Push(-3.0, 0.0)] if goal == "at(x,start)" else look
    found = walk(tmp_path, CARRIED, way, goal)
    stated = json.loads(found_certificate(found))
    meant = [{**stated["meaning"], "x": [step, touch]} for step in range(3) for touch in (1, 2)]
    texts = [json.dumps(stated | {"meaning": meaning}) for meaning in meant]
    assert accepted_by_both(tmp_path, found.text, [*texts, *map(json.dumps, mutants(stated, 20, 4))]) > 0


def test_both_agree_on_what_is_wider_than_each_gap(tmp_path: Path) -> None:
    way = [Move(1.0, 0.0), Move(-1.0, 0.0), *(Move(float(e), float(n)) for e, n in ROUND)]
    found = walk(tmp_path, BOX, way, "in(x,room(next))")
    text = found_certificate(found, "impossible")
    stated = json.loads(text)
    texts = [text, text.replace('["holds"]', '["holds",1]')]
    texts += [json.dumps(stated | {"steps": [step]}) for step in (-1, 0, 8, 15, None)]
    texts += [json.dumps(stated | {"given": stated["given"][:number]}) for number in range(3)]
    assert accepted_by_both(tmp_path, found.text, texts) == 1


@pytest.mark.parametrize(("room", "is_shown"), [(L_ROOM, True), (DUMBBELL, False)])
def test_both_agree_on_rooms_of_any_shape(tmp_path: Path, room: str, is_shown: bool) -> None:
    found = walk(tmp_path, room, felt_all_round(room), "in(utak,room(next))")
    shown = walk(tmp_path, L_ROOM, felt_all_round(L_ROOM), "in(utak,room(next))")
    stated = json.loads(found_certificate(shown, "impossible"))
    forged = [json.dumps(stated), *map(json.dumps, mutants(stated, 8, 5))]
    assert (accepted_by_both(tmp_path, found.text, forged) > 0) == is_shown


def test_both_agree_on_corners_that_are_too_far_apart(tmp_path: Path) -> None:
    for goals in (["northeast", "southwest"], ["northeast", "northwest"]):
        found = walk(tmp_path, L_ROOM, [], *(f"at(utak,corner({name}))" for name in goals))
        far = walk(tmp_path, L_ROOM, [], "at(utak,corner(northeast))", "at(utak,corner(southwest))")
        stated = json.loads(found_certificate(far, "impossible")) | {"goals": list(found.goals)}
        texts = [json.dumps(stated), *map(json.dumps, mutants(stated, 12, 7))]
        assert (accepted_by_both(tmp_path, found.text, texts) > 0) == ("southwest" in goals)


def test_numbers_are_read_as_they_are_written(tmp_path: Path) -> None:
    found, stated = in_corner(tmp_path)
    texts = [json.dumps(stated), json.dumps(stated).replace('["count", [0,', '["count", [0.0,')]
    assert accepted_by_both(tmp_path, found.text, texts) == 1
    assert accepted_by_both(tmp_path, found.text.replace('"east": 1.0', '"east": 100e-2'), texts) == 1
    assert accepted_by_both(tmp_path, found.text.replace('"east": 1.0', '"east": 0.3'), texts) == 0


@pytest.mark.parametrize(
    ("line", "change"),
    [(1, {"result": {}}), (2, {"action": {"do": "fly"}}), (2, {"action": None}), (2, {"step": 2})],
)
def test_both_refuse_an_episode_that_is_none(tmp_path: Path, line: int, change: dict[str, Any]) -> None:
    found, stated = in_corner(tmp_path)
    rows = found.text.splitlines(keepends=True)
    rows[line] = json.dumps(json.loads(rows[line]) | change) + "\n"
    assert accepted_by_both(tmp_path, "".join(rows), [json.dumps(stated)]) == 0
    assert accepted_by_both(tmp_path, found.text + '{"result": {}}\n', [json.dumps(stated)]) == 1


def test_an_unknown_command_counts_also_after_what_is_shown(tmp_path: Path) -> None:
    found = walk(tmp_path, L_ROOM, [], "at(utak,corner(northeast))", "at(utak,corner(southwest))")
    text = found_certificate(found, "impossible")
    step = json.loads(found.text.splitlines()[1]) | {"step": 1, "action": {"do": "fly"}}
    assert accepted_by_both(tmp_path, found.text, [text]) == 1
    assert accepted_by_both(tmp_path, found.text + json.dumps(step) + "\n", [text]) == 0
