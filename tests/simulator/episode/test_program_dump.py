"""`--dump-asp`: plain clingo finds in each file what the robot decided; nothing but facts and encodings gets there."""

import copy
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from utak.kb.language.diagnostics import BadInputError
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.episode.program_dump import ProgramDump, dump_episode

pytestmark = pytest.mark.long

ROOT = Path(__file__).resolve().parents[3]
RUNS = (("push_square_next_room", "0"), ("go_northeast_rooms", "0.05"))  # scenario and noise
RULES = """\
% Floor seen with less than half of the fields is rather verge; and what is peculiar.
kind(R, verge, 60) :- region(R, nonzero, _), extent(R, N), N > 20.
peculiar(X) :- shape(X, square, C), C > 10.
"""
Dump = tuple[Path, Path, str]


@pytest.fixture(scope="module", params=RUNS, ids=lambda run: run[0])
def dump(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Dump:
    """Return the folder with the decisions of a run, its episode, and the name of the example."""
    name, noise = request.param
    place = tmp_path_factory.mktemp("dump")
    options = ["--noise", noise, "--max-steps", "2", "--log", str(place / "ep.jsonl"), "--dump-asp", str(place / "asp")]
    assert main(["run", str(ROOT / "examples" / name), *options]) in (0, 1, 75)
    return place / "asp", place / "ep.jsonl", name


def index_of(folder: Path) -> list[dict[str, Any]]:
    """Return the entries of an index."""
    return [json.loads(line) for line in (folder / "index.jsonl").read_text().splitlines()]


def plain_clingo(path: Path, *further: str) -> tuple[list[str] | None, list[int]]:
    """Return the shown atoms and the costs of the best answer that plain clingo finds; None for no answer."""
    words = [sys.executable, "-m", "clingo", "--outf=2", "--quiet=1", "--warn=none", str(path), *further]
    said = json.loads(subprocess.run(words, capture_output=True, text=True, check=False).stdout)
    if said["Result"] == "UNSATISFIABLE":
        return None, []
    best = said["Call"][-1]["Witnesses"][-1]
    return sorted(best["Value"]), best.get("Costs", [])


def check_decision(path: Path, answer: list[str] | None, tmp_path: Path) -> None:
    """Compare what plain clingo finds with an answer; of several best ones, the answer must be one."""
    found, costs = plain_clingo(path)
    if found == answer:
        return
    assert answer is not None
    forced = tmp_path / "forced.lp"
    forced.write_text("".join(f":- not {atom}.\n" for atom in answer))
    again, same = plain_clingo(path, str(forced))
    assert again == answer
    assert same == costs


def test_plain_clingo_decides_as_the_robot_did(dump: Dump, tmp_path: Path) -> None:
    folder = dump[0]
    first: dict[str, dict[str, Any]] = {}
    for entry in index_of(folder):
        first.setdefault(entry["file"], entry)
    assert {entry["encoding"] for entry in first.values()} >= {"interpretation", "shapes", "rooms", "corners"}
    for name, entry in first.items():
        check_decision(folder / name, entry["answer"], tmp_path)


def test_index_and_files_are_those_of_the_episode(dump: Dump) -> None:
    folder, log, _ = dump
    entries = index_of(folder)
    steps = read_episode(log).steps
    wanted = [(line["step"], n, call[0]) for line in steps for n, call in enumerate(line["belief"]["solved"])]
    assert [(entry["step"], entry["number"], entry["encoding"]) for entry in entries] == wanted
    assert {path.name for path in folder.iterdir()} == {"index.jsonl", *(entry["file"] for entry in entries)}
    for entry in entries:
        step, encoding, number = re.fullmatch(r"(\d{4})-(\w+)-(\d+)\.lp", entry["file"]).groups()
        assert encoding == entry["encoding"]
        assert steps[int(step)]["belief"]["solved"][int(number)][2] == entry["answer"]


def test_a_recorded_episode_gives_the_same_files(dump: Dump, tmp_path: Path) -> None:
    folder, log, _ = dump
    assert main(["query", str(log), "node(X)", "--dump-asp", str(tmp_path / "again")]) == 0
    for path in folder.iterdir():
        assert (tmp_path / "again" / path.name).read_text() == path.read_text()
    assert main(["query", str(log), "node(X)", "--at", "1", "--dump-asp", str(tmp_path / "part")]) == 0
    assert {entry["step"] for entry in index_of(tmp_path / "part")} == {0, 1}


def test_a_resumed_run_gives_the_same_files(dump: Dump, tmp_path: Path) -> None:
    folder, log, name = dump
    part = tmp_path / "ep.jsonl"
    part.write_bytes(b"".join(log.read_bytes().splitlines(keepends=True)[:3]))
    options = ["--log", str(part), "--resume", "--dump-asp", str(tmp_path / "asp")]
    assert main(["run", str(ROOT / "examples" / name), *options]) in (0, 1, 75)
    assert {path.name: path.read_text() for path in (tmp_path / "asp").iterdir()} == {
        path.name: path.read_text() for path in folder.iterdir()
    }


def test_rules_of_the_user_stand_in_the_programs_that_they_reach(tmp_path: Path) -> None:
    rules, folder = tmp_path / "mine.lp", tmp_path / "asp"
    rules.write_text(RULES)
    scenario = str(ROOT / "examples" / "push_square_next_room")
    options = ["--max-steps", "1", "--kb", str(rules), "--log", str(tmp_path / "ep.jsonl"), "--dump-asp", str(folder)]
    assert main(["run", scenario, *options]) in (0, 1, 75)
    files = {entry["file"]: entry for entry in index_of(folder)}
    reached = {entry["encoding"] for name, entry in files.items() if "--kb" in (folder / name).read_text()}
    assert "interpretation" in reached
    assert "accommodation" not in reached
    for name, entry in files.items():
        if entry["encoding"] in reached:
            check_decision(folder / name, entry["answer"], tmp_path)
    again = ["query", str(tmp_path / "ep.jsonl"), "node(X)", "--dump-asp"]
    assert main([*again, str(tmp_path / "b")]) == 65  # the rules of the run must be given again
    assert main([*again, str(tmp_path / "c"), "--kb", str(rules)]) == 0
    assert (tmp_path / "c" / "index.jsonl").read_text() == (folder / "index.jsonl").read_text()


HOSTILE = {
    "a script": ["rooms", ["a. #script (python) import os #end. b"], [], []],
    "a rule": ["rooms", ["a :- b"], [], []],
    "an inclusion": ["rooms", ['a. #include "/etc/passwd". b'], [], []],
    "two facts": ["rooms", ["a. b"], [], []],
    "a comment": ["rooms", ["a %"], [], []],
    "another encoding": ["banana", ["a"], [], []],
    "a path": ["../../etc/passwd", ["a"], [], []],
    "a reference to nothing": ["rooms", [0, 99]],
    "a reference to another encoding": ["rooms", [0, 0]],
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_episodes_are_refused(name: str, dump: Dump, tmp_path: Path) -> None:
    rows = [json.loads(line) for line in dump[1].read_text().splitlines()]
    rows[2]["belief"]["solved"] = [copy.deepcopy(HOSTILE[name])]
    path = tmp_path / "ep.jsonl"
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    with pytest.raises(BadInputError, match=r"ep\.jsonl:3:1-1: error: "):
        dump_episode(tmp_path / "asp", str(path), read_episode(path), None, [])
    assert main(["query", str(path), "node(X)", "--dump-asp", str(tmp_path / "asp"), "--force"]) == 65
    assert not any(
        "script" in one.read_text() and "#end" in one.read_text() for one in (tmp_path / "asp").glob("0001*")
    )


def test_folders_that_are_not_empty_are_left_alone_without_force(dump: Dump, tmp_path: Path) -> None:
    (tmp_path / "mine.lp").write_text("mine.")
    (tmp_path / "index.jsonl").symlink_to(tmp_path / "mine.lp")
    arguments = ["query", str(dump[1]), "node(X)", "--dump-asp"]
    assert main([*arguments, str(tmp_path)]) == 66
    assert main([*arguments, str(tmp_path / "mine.lp")]) == 66
    assert main([*arguments, str(tmp_path), "--force"]) == 0
    assert (tmp_path / "mine.lp").read_text() == "mine."


def test_a_scenario_is_dumped_by_run_alone(tmp_path: Path) -> None:
    scenario = str(ROOT / "examples" / "go_northeast")
    assert main(["query", scenario, "node(X)", "--dump-asp", str(tmp_path / "asp")]) == 2


def test_older_episodes_have_no_decisions(dump: Dump, tmp_path: Path) -> None:
    episode = read_episode(dump[1])
    writer = ProgramDump(tmp_path / "asp", "ep")
    writer.add(episode.header)
    line = copy.deepcopy(episode.steps[0])
    del line["belief"]["solved"]
    writer.add(line)
    assert (tmp_path / "asp" / "index.jsonl").read_text() == ""
