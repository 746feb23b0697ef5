"""Disturbed runs as records: the header states them, their lines are honest, and they repeat, resume and fork."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import utak
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.run.story import recorded_story

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "push_square_corner"
WORLD = """
bbbbbbbbbbbbbbbbbbbbbbbb
b......................b
b......................b
b...gg.................b
b...gg.................b
b..........U...........b
b......................b
b......................b
b......................b
bbbbbbbbbbbbbbbbbbbbbbbb
"""
START, GOAL = "object(x). shape(x, square).", "at(x, corner(northeast))."
FACTS = """move(g1, "POINT (14 3)", 2).
appear(a1, r, "POLYGON ((2 2, 3 2, 3 3, 2 3, 2 2))", 3). move(a1, "POINT (14 3)", 4). vanish(a1, 5).
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a scenario `scene`, the file `others.lp`, and the episode `first.jsonl` of both."""
    made = tmp_path_factory.mktemp("disturbed")
    (made / "scene").mkdir()
    for name, text in (("world.txt", WORLD.lstrip()), ("start.lp", START), ("goal.lp", GOAL)):
        (made / "scene" / name).write_text(text)
    (made / "others.lp").write_text(FACTS)
    command = ["run", str(made / "scene"), "--disturb", str(made / "others.lp"), "--log", str(made / "first.jsonl")]
    assert main([*command, "--max-steps", "8"]) in (0, 75)
    return made


def test_the_episode_says_what_others_did_and_could_not_do(folder: Path) -> None:
    episode = read_episode(folder / "first.jsonl")
    assert episode.header["world"]["disturbances"][0] == 'move(g1,"POINT (14 3)",2)'
    assert [line["step"] for line in episode.steps if "disturbed" in line] == [2, 3, 5]
    assert episode.steps[2]["disturbed"]["g1"] == episode.steps[2]["objects"]["g1"]
    (why,) = episode.steps[4]["refused"].values()
    assert "a1 would overlap g1" in why


def test_a_disturbed_run_is_resumed_without_the_file(folder: Path) -> None:
    whole = (folder / "first.jsonl").read_bytes()
    log = folder / "cut.jsonl"
    log.write_bytes(b"".join(whole.splitlines(True)[:5]))
    assert main(["run", str(folder / "scene"), "--log", str(log), "--resume", "--max-steps", "8"]) in (0, 75)
    assert log.read_bytes() == whole


def test_a_fork_may_be_disturbed_otherwise_only_later(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = folder / "other.lp"
    command = ["run", str(folder / "scene"), "--from", str(folder / "first.jsonl"), "--at", "1", "--disturb"]
    other.write_text(FACTS.replace("14 3", "15 3"))
    assert main([*command, str(other)]) in (0, 75)
    other.write_text(FACTS.replace('"POINT (14 3)", 2', '"POINT (14 3)", 1'))
    assert main([*command, str(other)]) == 65
    assert "another world" in capsys.readouterr().err


def test_a_disturbed_episode_is_lived_again_and_replayed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    episode = read_episode(folder / "first.jsonl")
    story = recorded_story("first.jsonl", episode)
    story.go_to(4)
    live, differing = story.relive()
    assert differing is None and live.line == episode.steps[4]
    assert main(["replay", str(folder / "first.jsonl")]) == 0
    told = capsys.readouterr().out
    assert "before it others put elsewhere: g1" in told and "not disturbed: move(a1," in told
    assert main(["explain", str(folder / "first.jsonl")]) == 0


def test_from_python_it_is_the_same_run(folder: Path) -> None:
    run = utak.Run(folder / "scene", seed=0, max_steps=8, disturb=folder / "others.lp")
    assert run.finish()[-1].world.facts == utak.Episode.read(folder / "first.jsonl")[-1].world.facts


def test_malformed_files_are_reported(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = folder / "bad.lp"
    bad.write_text('move(g2, "POINT (14 3)", 2).\nlift(utak, "POINT (0.5 3)", 2).\n')
    assert main(["run", str(folder / "scene"), "--disturb", str(bad)]) == 65
    told = capsys.readouterr().err
    assert "bad.lp:1:6-7: error: the world has no object g2" in told and "bad.lp:2:12-" in told
    assert main(["run", str(folder / "scene"), "--disturb", str(folder / "none.lp")]) == 66


@pytest.mark.skipif(not os.environ.get("UTAK_JUDGE"), reason="UTAK_JUDGE names no judge of episodes")
def test_the_independent_judge_finds_nothing(folder: Path) -> None:
    others, log = folder / "moves.lp", folder / "moves.jsonl"
    others.write_text('move(g1, "POINT (14 3)", 2). lift(utak, "POINT (4.5 3.5)", 4). vanish(g1, 6).')
    scene, world = str(folder / "scene"), folder / "judged"
    world.mkdir()
    (world / "world.txt").write_text(WORLD.lstrip())
    assert main(["run", scene, "--disturb", str(others), "--log", str(log), "--max-steps", "7"]) in (0, 1, 75)
    judged = subprocess.run([sys.executable, os.environ["UTAK_JUDGE"], str(world), str(log)], capture_output=True)
    assert judged.returncode == 0, judged.stdout


def run_disturbed(folder: Path, facts: str) -> utak.Episode:
    """Return the episode of an example in which a square is pushed into a corner, disturbed by some facts."""
    (folder / "acts.lp").write_text(facts)
    return utak.Run(EXAMPLE, seed=0, disturb=folder / "acts.lp").finish()


def test_a_thing_that_others_moved_is_noticed_at_once_and_the_task_goes_on(tmp_path: Path) -> None:
    episode = run_disturbed(tmp_path, 'move(g1, "POINT (19.5 17.5)", 2).')
    assert (episode.verdict, episode.achieved) == ("done", True)
    assert [step.line["belief"]["pose"] for step in episode][2] == "changed"
    assert episode[-1].world.query("bound(x, o1)").kind == "yes"  # it is the same thing


def test_a_lifted_robot_knows_where_it_is_and_the_task_goes_on(tmp_path: Path) -> None:
    episode = run_disturbed(tmp_path, 'lift(utak, "POINT (27.3 5.2)", 3).')
    assert (episode.verdict, episode.achieved) == ("done", True)
    line, first = episode[3].line, episode[0].line
    assert line["belief"]["pose"] == "lifted"
    true = [here - woke for here, woke in zip(line["utak"], first["utak"], strict=True)]
    assert line["belief"]["place"] == pytest.approx(true, abs=1.0)


def test_a_thing_that_others_took_for_good_makes_no_verdict_impossible(tmp_path: Path) -> None:
    episode = run_disturbed(tmp_path, "vanish(g1, 2).")
    assert episode.verdict in ("possible_if", "limit")


def test_what_is_out_of_sight_is_less_sure_once_others_took_something_away(tmp_path: Path) -> None:
    appear = 'appear(a1, r, "POLYGON ((5 5, 7 5, 7 7, 5 7, 5 5))", 1).'
    stated = {}
    for number, moved in enumerate(("", 'move(g1, "POINT (28.5 6.5)", 10).')):
        (tmp_path / "acts.lp").write_text(f"{appear} {moved}")
        scenario = EXAMPLE.parent / "go_with_empty_hands"
        episode = utak.Run(scenario, seed=0, disturb=tmp_path / "acts.lp").finish()
        assert (episode.verdict, episode.achieved) == ("done", True)
        stated[number] = [fact for step in episode for fact in step.world.facts if fact.startswith("persists(")]
    assert not stated[0]
    assert stated[1] and all(0 < int(fact.split(",")[1][:-2]) < 100 for fact in stated[1])
