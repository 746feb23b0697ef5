"""Other minds in the body: commands, verdicts, limits, and forks of their runs."""

import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import utak
from utak.simulator.run.session import CannotAdoptError, Session

WORLD = "bbbbbbb\nb.....b\nb.....b\nb..U..b\nbbbbbbb\n"
ROOM = utak.Scenario.from_text(
    WORLD, "at(utak, corner(northwest)).", expect='inside(utak, "POLYGON ((1 3, 2 3, 2 4, 1 4, 1 3))").'
)


def session_of(run: utak.Run) -> Session:
    """Return the session that rests at the last step of a run."""
    return run._story._moment.sessions[run._story.at]


class Follower(utak.Mind):
    """Goes north and then west, as far as it feels floor."""

    def __init__(self) -> None:
        self.tasks: list[Any] = []
        self.steps = 0

    def begin(self, task: Any) -> None:
        self.tasks.append([str(goal) for goal in task.goals])

    def step(self, impression: utak.Impression) -> Any:
        self.steps += 1
        if impression.touch[0] is None:
            return utak.Move(0, 1)
        if impression.touch[6] is None:
            return utak.Move(-1, 0)
        return utak.Verdict("done", "it is in the corner")

    def facts(self) -> list[str]:
        return [f"unseen(r1,{self.steps})."]


def test_a_mind_is_judged_like_the_robot(tmp_path: Path) -> None:
    episode = utak.Run(ROOM, mind=Follower).finish()
    assert (episode.verdict, episode.reason, episode.achieved) == ("done", "it is in the corner", True)
    assert [step.action for step in episode] == ["wake", "move(0, 1)", "move(0, 1)", "move(-1, 0)", "move(-1, 0)"]
    assert episode.world.query("unseen(r1, N)").rows == ((5,),)
    episode.save(tmp_path / "mind.jsonl")
    assert utak.Episode.read(tmp_path / "mind.jsonl").record == episode.record
    lazy = utak.Run(ROOM, mind=lambda: Saying(utak.Verdict("done", "so I say"))).finish()
    assert (lazy.verdict, lazy.achieved, len(lazy)) == ("done", False, 1)


class Saying(utak.Mind):
    """Answers the same to every impression."""

    def __init__(self, answer: Any) -> None:
        self.answer = answer

    def step(self, impression: utak.Impression) -> Any:
        return self.answer


def test_a_mind_that_never_ends_reaches_the_limit() -> None:
    run = utak.Run(ROOM, mind=lambda: Saying(utak.Release()), max_steps=3)
    assert run.plan.command == utak.Release()
    episode = run.finish()
    assert (episode.verdict, episode.reason, len(episode)) == ("limit", "not done after 3 commands", 4)


def test_what_is_no_answer_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="must return one of Move, Push, Turn, Grasp, Release, Verdict, not 'north'"):
        utak.Run(ROOM, mind=lambda: Saying("north"))
    with pytest.raises(TypeError, match="has no method step"):
        utak.Run(ROOM, mind=utak.Mind)
    with pytest.raises(TypeError, match=r"must make a utak\.Mind"):
        utak.Run(ROOM, mind=dict)
    with pytest.raises(ValueError, match="no such verdict"):
        utak.Verdict("maybe")


def test_the_run_of_a_mind_is_forked_with_the_mind() -> None:
    run = utak.Run(ROOM, mind=Follower)
    run.step()
    fork = run.fork()
    assert fork.finish().record == run.finish().record
    other = run.fork(goal="at(utak, start).")
    assert other.verdict == "done"  # the mind was asked again, and stands in the corner
    assert session_of(other).robot.mind.tasks == [["at(utak,corner(northwest))"], ["at(utak,start)"]]
    assert session_of(run).robot.mind.tasks == [["at(utak,corner(northwest))"]]


def test_a_mind_takes_no_rules() -> None:
    """Rules would have no effect on a mind that reasons by itself, so they are refused."""
    run = utak.Run(ROOM, mind=Follower)
    session = session_of(run)
    assert session is not None
    with pytest.raises(CannotAdoptError, match="Follower takes no rules"):
        session.adopt(ROOM.content, replace(run.settings, kb_files=("rules.lp",)))


class Locked(Follower):
    """Holds something that cannot be copied."""

    def __init__(self) -> None:
        super().__init__()
        self.lock = threading.Lock()


class Counting(utak.Mind):
    """Goes on where the last mind stopped counting: the same run never comes out twice."""

    made = 0

    def __init__(self) -> None:
        self.lock = threading.Lock()

    def step(self, impression: utak.Impression) -> Any:
        Counting.made += 1
        return utak.Move(0.01 * Counting.made, 0)


def test_a_mind_that_cannot_be_copied_is_made_anew_and_repeats_the_run() -> None:
    run = utak.Run(ROOM, mind=Locked)
    run.step()
    run.step()
    assert run.fork().finish().record == run.finish().record
    fickle = utak.Run(ROOM, mind=Counting)
    fickle.step()
    with pytest.raises(utak.RunNotRepeatedError, match="step 1 came out otherwise"):
        fickle.fork()
