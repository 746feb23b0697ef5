"""Forks: a recorded run is repeated up to a step and goes on; without any change it is the same run."""

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

import utak
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import EpisodeLog, encode, read_episode
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Session
from utak.simulator.run.story import WORLD_KEYS, live_story
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings

ROOT = Path(__file__).resolve().parents[3]
EXERCISES = ROOT / "docs" / "exercises"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the scenario `scene`, in which a square is pushed, and its episode `first.jsonl`."""
    folder = tmp_path_factory.mktemp("forking")
    shutil.copytree(EXERCISES / "05_push_it", folder / "scene")
    shutil.copy(EXERCISES / "05_push_it" / "solution" / "goal.lp", folder / "scene" / "goal.lp")
    assert main(["run", str(folder / "scene"), "--log", str(folder / "first.jsonl")]) == 0
    return folder


def fork(folder: Path, at: int, *more: str, scene: str = "scene", origin: str = "first.jsonl") -> int:
    """Fork an episode into `fork.jsonl`; return the exit code."""
    files = ["--from", str(folder / origin), "--log", str(folder / "fork.jsonl"), "--force"]
    return main(["run", str(folder / scene), *files, "--at", str(at), *more])


def lines(path: Path) -> list[str]:
    return path.read_text().splitlines()


def with_goal(folder: Path, name: str, goal: str) -> str:
    """Write the scenario under another name with another goal, and without expectations; return the name."""
    place = shutil.copytree(folder / "scene", folder / name, dirs_exist_ok=True)
    (place / "goal.lp").write_text(goal)
    (place / "expect.lp").unlink(missing_ok=True)
    return name


def test_a_fork_without_a_change_is_the_same_run(recorded: Path) -> None:
    first = lines(recorded / "first.jsonl")
    for at in (0, 2, len(first) - 3):
        assert fork(recorded, at) == 0
        assert lines(recorded / "fork.jsonl")[1:] == first[1:]
        stages = json.loads(lines(recorded / "fork.jsonl")[0])["forked"]
        assert [stage["until"] for stage in stages] == [at]
    read_episode(recorded / "fork.jsonl")


def test_a_fork_goes_on_with_another_goal_and_releases_what_is_held(recorded: Path) -> None:
    first = read_episode(recorded / "first.jsonl")
    at = next(step["step"] for step in first.steps if step["held"])
    assert fork(recorded, at, scene=with_goal(recorded, "home", "at(utak, start).")) == 0
    forked = read_episode(recorded / "fork.jsonl")
    assert forked.steps[:at] == first.steps[:at]
    assert [forked.steps[at].get(key) for key in WORLD_KEYS] == [first.steps[at].get(key) for key in WORLD_KEYS]
    assert forked.steps[at]["belief"] != first.steps[at]["belief"]  # it holds what was decided for the new task
    assert forked.steps[at + 1]["action"] == {"do": "release"}
    assert "goes on with another task" in forked.steps[at + 1]["why"]
    assert forked.header["task"]["goals"] == ["at(utak,start)"]
    assert forked.header["forked"][0]["task"] == first.header["task"]
    assert forked.result is not None
    assert forked.result["verdict"] == "done"


@pytest.mark.long
def test_a_fork_is_resumed_and_forked_again_without_the_first_episode(recorded: Path, tmp_path: Path) -> None:
    assert fork(recorded, 2, "--noise", "0.05", "--seed", "4", "--max-steps", "8") in (0, 1, 75)
    whole = (recorded / "fork.jsonl").read_bytes()
    first = read_episode(recorded / "first.jsonl")
    assert json.loads(lines(recorded / "fork.jsonl")[3])["belief"] == first.steps[2]["belief"]
    assert json.loads(lines(recorded / "fork.jsonl")[4])["utak"] != first.steps[3]["utak"]  # the noise is felt
    cut = tmp_path / "cut.jsonl"
    for kept in (2, 5):
        cut.write_bytes(b"".join(whole.splitlines(keepends=True)[:kept]) + b'{"step": 3, "act')
        code = main(["run", str(recorded / "scene"), "--log", str(cut), "--resume"])
        assert code in (0, 1, 75)
        assert cut.read_bytes() == whole
    shutil.copy(cut, recorded / "noisy.jsonl")
    assert fork(recorded, 3, "--noise", "0", "--max-steps", "9", origin="noisy.jsonl") in (0, 1, 75)
    again = read_episode(recorded / "fork.jsonl")
    assert [(stage["until"], stage["options"]["noise"]) for stage in again.header["forked"]] == [(2, 0.0), (3, 0.05)]
    assert again.header["options"]["seed"] == 4
    assert fork(recorded, 1, "--noise", "0", "--seed", "0", "--max-steps", "200", origin="noisy.jsonl") == 0
    assert lines(recorded / "fork.jsonl")[1:] == lines(recorded / "first.jsonl")[1:]


@pytest.mark.long
def test_the_limit_of_commands_can_be_raised(recorded: Path) -> None:
    short = recorded / "short.jsonl"
    assert main(["run", str(recorded / "scene"), "--log", str(short), "--max-steps", "3"]) == 75
    assert fork(recorded, 3, origin="short.jsonl") == 75
    assert fork(recorded, 3, "--max-steps", "200", origin="short.jsonl") == 0
    assert lines(recorded / "fork.jsonl")[1:] == lines(recorded / "first.jsonl")[1:]


def test_whatever_is_adopted_at_a_step_the_same_command_comes_next(recorded: Path) -> None:
    """What a mind decided last changes nothing in the mind as it was before, which interprets the impression anew."""
    scene, settings = read_scenario(recorded / "scene"), Settings()
    session = Session(scene, settings, make_robot, EpisodeLog(None))
    session.wake()
    presses = 0
    while not session.finished:
        decided = session.robot.decision
        for _ in range(2):
            session.adopt(scene, settings)
            assert session.robot.decision == decided
        presses += "pressed" in decided.why
        session.step()
    assert presses == 2  # the second press follows from what was pressed before: memory that a copy must not share


@pytest.mark.long
def test_rules_of_the_recorded_run_are_given_again_or_left_behind(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules = recorded / "rules.lp"
    rules.write_text("shape(N, disc, 90) :- fit(N, square, M, 1), M < 3.\n")
    origin = recorded / "ruled.jsonl"
    shutil.copytree(EXERCISES / "06_ask", recorded / "looked_at", dirs_exist_ok=True)
    assert main(["run", str(recorded / "looked_at"), "--kb", str(rules), "--log", str(origin)]) == 0

    def forked(*more: str) -> int:
        return fork(recorded, 1, *more, scene="looked_at", origin="ruled.jsonl")

    assert forked() == 65
    err = capsys.readouterr().err
    assert "ruled.jsonl:1:1-1: error: the recorded run had a file of rules that is not given" in err
    assert "--from-kb" in err
    assert forked("--kb", str(rules)) == 0
    assert lines(recorded / "fork.jsonl")[1:] == lines(origin)[1:]
    assert forked("--from-kb", str(rules)) == 0
    header = read_episode(recorded / "fork.jsonl").header
    assert header["options"]["kb"] == []
    assert len(header["forked"][0]["options"]["kb"]) == 1
    discs = [
        any("disc,90" in fact for fact in step["belief"]["facts"])
        for step in read_episode(recorded / "fork.jsonl").steps
    ]
    assert discs == [True, False, False, False]  # the impression of step 1 is interpreted without the rules


@pytest.mark.long
def test_prompt_fork_and_python_change_a_run_alike(recorded: Path, tmp_path: Path) -> None:
    """A goal and a rule from step 2 on give the same lines from there, in whatever way they are given."""
    rule = "shape(o1, disc, 90) :- full_squares(o1, N), N > 3."
    (tmp_path / "rule.lp").write_text(f"{rule}\n")
    scene = with_goal(recorded, "home", "at(utak, start).")
    want = None
    for kind, text, more in (("goal", "at(utak, start).", ()), ("assume", rule, ("--kb", str(tmp_path / "rule.lp")))):
        story = live_story(read_scenario(recorded / "scene"), Settings())
        while story.at < 2:
            assert story.advance()
        story.change(kind, text)
        while story.advance():
            pass
        assert fork(recorded, 2, *more, scene=scene if kind == "goal" else "scene") in (0, 1)
        lines_of_fork = read_episode(recorded / "fork.jsonl").steps
        assert lines_of_fork == tuple(json.loads(encode(line)) for line in story.lines)
        assert lines_of_fork != want
        want = lines_of_fork
        if kind == "goal":
            run = utak.Run(utak.Scenario.read(recorded / "scene"), seed=0)
            run.step()
            run.step()
            assert run.fork(goal=text).finish().record.steps == tuple(story.lines)


@pytest.mark.long
def test_stages_of_tasks_that_are_attained_stay_so_when_rules_change(recorded: Path, tmp_path: Path) -> None:
    """Other rules or another path-finder do not make the robot do again what it has done."""
    scene = with_goal(recorded, "tour", "first(at(utak, corner(southwest))).\nthen(at(utak, corner(southeast))).\n")
    path = recorded / "tour.jsonl"
    assert main(["run", str(recorded / scene), "--log", str(path)]) == 0
    first = read_episode(path)
    at = len(first.steps) - 2  # it stands in the first corner, or is on its way to the second
    (tmp_path / "rule.lp").write_text("shape(o1, disc, 90) :- full_squares(o1, N), N > 3.\n")
    for more in (("--kb", str(tmp_path / "rule.lp")), ("--paths", "grid")):
        assert fork(recorded, at, *more, scene=scene, origin="tour.jsonl") == 0
        assert len(read_episode(recorded / "fork.jsonl").steps) == len(first.steps)


def changed(folder: Path, change: Any) -> str:
    """Write the first episode with its lines changed; return the name."""
    rows = [json.loads(line) for line in lines(folder / "first.jsonl")]
    change(rows)
    (folder / "changed.jsonl").write_text("".join(json.dumps(row, separators=(",", ":")) + "\n" for row in rows))
    return "changed.jsonl"


DAMAGE = {
    "changed.jsonl:3:1-1: error: the run does not repeat this line": lambda rows: rows[2].update(why="because"),
    "changed.jsonl:2:1-1: error: the run does not repeat this line": lambda rows: rows[1]["retina"].reverse(),
    "changed.jsonl:1:1-1: error: the episode is of another world": lambda rows: rows[0]["world"].update(heading=90),
    "changed.jsonl:1:1-1: error: task: unknown predicate att/2": lambda rows: rows[0]["task"].update(
        goals=["att(a,b)"]
    ),
    "task: a claim is no fact with a confidence": lambda rows: rows[0]["task"].update(claims=[["a(b)"]]),
    "forked: a list of values is wanted": lambda rows: rows[0].update(forked=3),
    "the run was changed at the prompt, from step 2 on": lambda rows: rows[0].update(
        changes=[{"step": 2, "assume": "shape(o1,square,90)."}]
    ),
    "the key until is missing": lambda rows: rows[0].update(forked=[{"options": {}, "task": {}}]),
}


@pytest.mark.parametrize("message", DAMAGE)
def test_a_repetition_that_differs_is_refused_with_its_place(
    message: str, recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fork(recorded, 2, origin=changed(recorded, DAMAGE[message])) == 65
    assert message in capsys.readouterr().err


def test_wrong_usage_and_missing_steps_are_refused(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, first = str(recorded / "scene"), str(recorded / "first.jsonl")
    before = (recorded / "first.jsonl").read_bytes()
    assert main(["run", scene, "--from", first]) == 2
    assert main(["run", scene, "--at", "2"]) == 2
    assert main(["run", scene, "--from", first, "--at", "2", "--log", first]) == 2
    assert main(["run", scene, "--from", first, "--at", "2", "--log", str(tmp_path / "x"), "--resume"]) == 2
    assert main(["run", scene, "--from", str(tmp_path / "none"), "--at", "2"]) == 66
    capsys.readouterr()
    assert main(["run", scene, "--from", first, "--at", "99"]) == 65
    assert "first.jsonl:1:1-1: error: there is no step 99: the last is 5" in capsys.readouterr().err
    assert (recorded / "first.jsonl").read_bytes() == before
