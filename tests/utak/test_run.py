"""Runs step by step: the same as those of the command, forks, plans, and steps that were interrupted."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

import utak
from utak.kb.language.vocabulary import PLAN_PREDICATES
from utak.simulator.cli.main import main
from utak.simulator.run.session import Session

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
NEXT_ROOM = utak.Scenario.read(EXAMPLES / "go_next_room")
PUSH = utak.Scenario.read(EXAMPLES / "push_square_next_room")


def session_of(run: utak.Run) -> Session:
    """Return the session that rests at the last step of a run."""
    return run._story._moment.sessions[run._story.at]


def test_a_run_is_that_of_the_command(tmp_path: Path) -> None:
    log = tmp_path / "run.jsonl"
    assert main(["run", str(EXAMPLES / "go_next_room"), "--seed", "1", "--noise", "0.02", "--log", str(log)]) == 0
    episode = utak.Run(NEXT_ROOM, seed=1, noise=0.02).finish()
    saved = tmp_path / "saved.jsonl"
    episode.save(saved)
    assert saved.read_text() == log.read_text()
    assert utak.Episode.read(log).record == episode.record


def test_a_run_takes_a_folder() -> None:
    assert utak.Run(str(EXAMPLES / "go_next_room")).episode.record == utak.Run(NEXT_ROOM).episode.record


@pytest.mark.long
def test_a_run_is_followed_step_by_step() -> None:
    run = utak.Run(NEXT_ROOM)
    assert (run.verdict, run.reason, run.finished, len(run.episode)) == (None, "", False, 1)
    planned = run.plan
    step = run.step()
    assert step is not None
    assert step.number == 1
    assert str(planned).splitlines()[0] == f"{step.action}: {step.why}"
    assert planned.task is not None and planned.task.robot[0].startswith("go(")
    assert run.impression == step.impression
    assert run.world == step.world
    kept = run.episode
    numbers = [step.number for step in run]
    assert numbers == list(range(2, len(numbers) + 2))
    assert len(kept) == 2  # an episode does not grow
    assert run.step() is None
    assert (run.verdict, run.achieved, run.plan.command) == ("done", True, None)
    assert run.plan.why == run.reason == run.finish().reason


@pytest.mark.long
def test_a_fork_goes_on_like_the_run_it_comes_from() -> None:
    run = utak.Run(PUSH, seed=3, noise=0.02)
    forks = []
    for number in range(1, 6):
        run.step()
        if number in (2, 5):
            forks.append(run.fork())
            assert len(forks[-1].episode) == number + 1
    whole = run.finish()
    for fork in forks:
        assert fork.finish().record == whole.record
    assert run.fork().finish().record == whole.record  # of a run that has ended


@pytest.mark.long
def test_a_fork_may_be_disturbed_otherwise() -> None:
    run = utak.Run(PUSH, seed=3, noise=0.05)
    run.step()
    other = run.fork(seed=4, max_steps=3)
    again = run.fork(seed=4, max_steps=3)
    calm = run.fork(noise=0.0, max_steps=2)
    assert other.finish().record == again.finish().record
    assert other.episode.record.steps[:2] == run.episode.record.steps
    assert other.episode.record.steps[2]["motion"] != calm.finish().record.steps[2]["motion"]
    assert other.verdict == "limit"
    (stage,) = other.episode.record.header["forked"]
    assert (stage["until"], stage["options"]["seed"]) == (1, 3)
    assert other.episode.record.header["options"]["seed"] == 4
    with pytest.raises(ValueError, match="noise must be from 0 to 1"):
        run.fork(noise=2.0)


@pytest.mark.long
def test_a_fork_may_have_another_goal() -> None:
    run = utak.Run(NEXT_ROOM)
    run.step()
    fork = run.fork(goal="at(utak, corner(southwest)).", expect="within(30).")
    planned = {f"{name}(" for name, _ in PLAN_PREDICATES}
    said, before = ([fact for fact in one.world.facts if not fact.startswith(tuple(planned))] for one in (fork, run))
    assert said == before
    assert fork.finish().reason == "at(utak,corner(southwest)) holds"
    assert (fork.achieved, fork.scenario.goals) == (True, ("at(utak,corner(southwest))",))
    assert run.finish().reason == "in(utak,room(next)) holds"
    after = run.fork(goal="at(utak, start).")  # from the end of the run
    assert not after.finished
    assert after.finish().verdict == "done"
    with pytest.raises(ValueError, match="give goal, too"):
        run.fork(expect="within(3).")


@pytest.mark.long
def test_a_fork_of_a_fork_is_made_anew_after_an_interrupted_step(monkeypatch: pytest.MonkeyPatch) -> None:
    run = utak.Run(PUSH, seed=3, noise=0.05)
    run.step()
    fork = run.fork(seed=4)
    fork.step()
    second = fork.fork(max_steps=5)
    second.step()
    same = second.fork()
    session = session_of(second)
    assert session is not None

    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(session.robot, "step", interrupted)
    with pytest.raises(KeyboardInterrupt):
        second.step()
    before = len(second.episode)
    assert str(second.plan) == str(same.plan)  # the step did not happen
    assert second.finish().record == same.finish().record
    assert len(second.episode) > before
    assert [stage["until"] for stage in second.episode.record.header["forked"]] == [1, 2]


@pytest.mark.long
def test_the_episode_of_a_fork_can_be_forked_by_the_command(tmp_path: Path) -> None:
    run = utak.Run(NEXT_ROOM, seed=3, noise=0.02)
    run.step()
    path = tmp_path / "fork.jsonl"
    run.fork(seed=4, max_steps=2).finish().save(path)
    command = ["run", str(EXAMPLES / "go_next_room"), "--from", str(path), "--at", "2", "--max-steps", "2"]
    assert main([*command, "--log", str(tmp_path / "again.jsonl")]) in (0, 1, 75)
    again = utak.Episode.read(tmp_path / "again.jsonl")
    assert again.record.steps[:3] == utak.Episode.read(path).record.steps[:3]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"noise": -0.1}, "noise must be from 0 to 1"),
        ({"seed": -1}, "0 or greater"),
        ({"max_steps": -1}, "0 or greater"),
        ({"paths": "straight"}, "no such path-finder"),
    ],
)
def test_options_out_of_range_are_errors(options: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        utak.Run(NEXT_ROOM, **options)


@pytest.mark.long
def test_rules_of_users_take_part_and_may_be_asked(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("wide(D) :- width(D, L), L >= 300.\n")
    run = utak.Run(NEXT_ROOM, rules=[rules])
    run.step()
    assert run.world.query("wide(D)").kind in ("bindings", "no", "don't know")
    rules.write_text("broad(D) :- width(D, L), L >= 300.\n")
    with pytest.raises(utak.BadInputError, match="wide"):
        run.world.query("wide(D)")
    rules.unlink()
    with pytest.raises(utak.CannotOpenError):
        run.world.query("wide(D)")
    with pytest.raises(utak.CannotOpenError):
        utak.Run(NEXT_ROOM, rules=[rules])


@pytest.mark.long
def test_a_run_shows_itself() -> None:
    run = utak.Run(NEXT_ROOM)
    assert repr(run) == "<Run after 0 commands>"
    assert run.plan._repr_html_() in run._repr_html_()
    ElementTree.fromstring(run._repr_svg_())
    run.finish()
    assert repr(run).startswith(f"<Run after {len(run.episode) - 1} commands; done: ")
    assert json.dumps(run.episode.record.header)
