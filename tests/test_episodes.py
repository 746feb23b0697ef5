"""Episodes of the examples: judged by one who shares no code with us, the same every time, and as they were before.

`UTAK_GOLDEN=write python -m pytest -m 'long or not long' tests/test_episodes.py` writes golden_episodes.json anew,
when a change of what Utak does is meant.
"""

import hashlib
import json
import os
import subprocess
import sys
from functools import cache
from itertools import product
from pathlib import Path

import pytest

from benchmarks.episodes.planned import REFLEXES, differences, planned
from tests.tables import few
from utak.simulator.cli.main import main
from utak.simulator.scenario.scenario import read_any_world

ROOT = Path(__file__).resolve().parent.parent
GOLDEN = Path(__file__).with_name("golden_episodes.json")
JUDGE = Path(os.environ.get("UTAK_JUDGE") or ROOT.parent / "shared" / "judge" / "judge.py")
EXAMPLES = sorted(path.parent.name for path in (ROOT / "examples").glob("*/goal.lp"))
REMEMBERED = ["go_northeast", "go_to_square", "go_round_square", "go_next_room_askew", "push_square_next_room"]
TRIED = [
    "go_northeast",
    "go_to_square",
    "go_round_square",
    "push_square_next_room",
]  # by default


@pytest.fixture(scope="module")
def episode(tmp_path_factory: pytest.TempPathFactory):  # type: ignore[no-untyped-def]
    """The episode of an example, by name; each is run once."""

    @cache
    def of(name: str) -> Path:
        log = tmp_path_factory.mktemp("episodes") / f"{name}.jsonl"
        assert main(["run", str(ROOT / "examples" / name), "--log", str(log)]) in (0, 1, 75)
        return log

    return of


def world_text(folder: Path) -> str:
    """The world of a scenario as facts, as one who reads no pictures wants it."""
    world = read_any_world(folder)
    facts = [f"table({world.width}, {world.height})."]
    facts += [f'verge("{world.verge.wkt}").'] if not world.verge.is_empty else []
    for kind, things in (("object", world.movable), ("fixed", world.fixed)):
        facts += [f'{kind}({thing.name}, {thing.colour}, "{thing.polygon.wkt}").' for thing in things]
    x, y = world.utak
    return "\n".join([*facts, f'utak("POINT ({x} {y})", {world.heading}).', ""])


def judged(name: str, episode: Path, folder: Path) -> str:
    """What the judge finds in the episode of an example, "" for nothing or without a judge; `folder` is empty."""
    if not JUDGE.exists():
        return ""
    example = ROOT / "examples" / name
    (folder / "world.lp").write_text(world_text(example))
    for part in ("start.lp", "goal.lp", "expect.lp"):
        (folder / part).write_text((example / part).read_text())
    command = [sys.executable, str(JUDGE), str(folder), str(episode)]
    found = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    return "" if found.returncode == 0 else found.stdout + found.stderr


@pytest.mark.parametrize("name", few(EXAMPLES, TRIED))
def test_what_is_claimed_is_so_and_the_judge_finds_nothing(name: str, episode, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """Without the judge (set UTAK_JUDGE to judge.py) only the claim is compared; one test, so that each runs once."""
    last = json.loads(episode(name).read_text().splitlines()[-1])["result"]
    fails = "fails." in (ROOT / "examples" / name / "expect.lp").read_text()
    assert last["believed"] == last["achieved"] == (not fails)
    assert last["verdict"] == "done" or last["reason"]
    assert (last["verdict"] == "done") == last["believed"]
    assert judged(name, episode(name), tmp_path) == ""


@pytest.mark.parametrize("name", few(EXAMPLES, TRIED))
def test_each_command_is_the_first_step_of_what_was_planned(name: str, episode) -> None:  # type: ignore[no-untyped-def]
    """The robot says before each command with which steps it goes on, and these can be done one after the other."""
    lines = [line for line in map(json.loads, episode(name).read_text().splitlines()) if "step" in line]
    assert list(differences(lines)) == []
    reflexes = sum(planned(line)[0][0].startswith(REFLEXES) for line in lines[:-1])
    assert reflexes <= 0.03 * (len(lines) - 1)


@pytest.mark.parametrize("name", few(REMEMBERED, TRIED))
def test_memory_of_what_happened(name: str, episode) -> None:  # type: ignore[no-untyped-def]
    """Commands, motions, impressions and verdict, as they were when the memory was written."""
    before, now = json.loads(GOLDEN.read_text()), fingerprint(episode(name))
    if os.environ.get("UTAK_GOLDEN") == "write":
        before[name] = now
        GOLDEN.write_text(json.dumps(before, indent=2) + "\n")
    assert now == before[name]


def fingerprint(log: Path) -> dict[str, object]:
    """How many commands, and a hash of all that happened, to a millionth of a square."""
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    kept = [[line[key] for key in ("action", "motion", "utak", "retina", "touch")] for line in lines if "step" in line]
    result = lines[-1]["result"]
    text = json.dumps([rounded(kept), result["verdict"], result["steps"]])
    return {"steps": result["steps"], "sha256": hashlib.sha256(text.encode()).hexdigest()}


def rounded(value):  # type: ignore[no-untyped-def]
    """A JSON value with its numbers rounded."""
    if isinstance(value, float):
        return round(value, 6) + 0.0
    if isinstance(value, list):
        return [rounded(part) for part in value]
    return {key: rounded(part) for key, part in value.items()} if isinstance(value, dict) else value


HASH_SEEDS = [("push_square_next_room", "1"), *product(["go_northeast_askew", "go_to_square_two"], ["0", "1", "2"])]


@pytest.mark.parametrize(("name", "seed"), few(HASH_SEEDS, 1))
def test_the_same_seed_gives_the_same_bytes(name: str, seed: str, tmp_path: Path, episode) -> None:  # type: ignore[no-untyped-def]
    log = tmp_path / "episode.jsonl"
    command = [sys.executable, "-m", "utak.simulator.cli", "run", str(ROOT / "examples" / name), "--log", str(log)]
    subprocess.run(command, cwd=ROOT, env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, check=False)
    assert log.read_bytes() == episode(name).read_bytes()


@pytest.mark.long
def test_noise_is_the_seed_s(tmp_path: Path) -> None:
    logs = []
    for number, seed in enumerate(("3", "3", "4")):
        log = tmp_path / f"{number}.jsonl"
        main(["run", str(ROOT / "examples" / "go_northeast"), "--noise", "0.05", "--seed", seed, "--log", str(log)])
        logs.append(log.read_text().splitlines()[1:])
    assert logs[0] == logs[1]
    assert logs[0] != logs[2]
