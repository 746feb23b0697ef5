"""A run that is read back and forth: copies of it go on unchanged, and changes fork it."""

import json
import random
from pathlib import Path
from typing import Any

import pytest
import scripted_robot
from random_scenes import write_scene

from utak.kb.language.diagnostics import BadInputError
from utak.kb.task.task import Task
from utak.simulator.cli.commands.files.new import NEW_SCENARIO_FILES
from utak.simulator.episode.episode import EpisodeLog, encode
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import CannotAdoptError, Session
from utak.simulator.run.story import MAX_KEPT_SESSIONS, live_story
from utak.simulator.scenario.scenario import Scenario, read_scenario
from utak.simulator.scenario.settings import Settings

ROOT = Path(__file__).resolve().parents[3]


def scripted(body: Any, task: Task, settings: Settings) -> Any:
    return scripted_robot.Robot(body, task, scripted_robot.Options(max_steps=settings.max_steps))


class StubbornRobot(scripted_robot.Robot):
    """A robot that cannot be copied."""

    def __deepcopy__(self, memo: Any) -> Any:
        raise TypeError("this robot is one of a kind")


def stubborn(body: Any, task: Task, settings: Settings) -> Any:
    return StubbornRobot(body, task, scripted_robot.Options(max_steps=settings.max_steps))


@pytest.fixture
def scene(tmp_path: Path) -> Scenario:
    return read_scenario(write_scene(tmp_path / "scene", 3))


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    """A scenario that takes the real robot two steps."""
    folder = tmp_path_factory.mktemp("small")
    for name, text in NEW_SCENARIO_FILES.items():
        (folder / name).write_text(text)
    return read_scenario(folder)


def lines_of_run(scenario: Scenario, settings: Settings, make: Any) -> list[str]:
    session = Session(scenario, settings, make, EpisodeLog(None))
    session.wake()
    lines = [encode(session.line)]
    while not session.finished:
        session.step()
        lines.append(encode(session.line))
    return lines


@pytest.mark.parametrize("make", [scripted, stubborn])
def test_any_way_back_and_forth_shows_the_lines_of_the_run(scene: Scenario, make: Any) -> None:
    settings = Settings(noise=0.05, seed=5)
    whole = lines_of_run(scene, settings, make)
    story, draw = live_story(scene, settings, make), random.Random(2)
    assert not story.is_awake
    for _ in range(80):
        if draw.random() < 0.6:
            assert story.advance() == (story.at < len(whole) - 1 or False) or story.result is not None
        else:
            story.go_to(draw.randrange(len(story.lines)))
        assert encode(story.line) == whole[story.at]
        assert (story.result is not None) == (story.at == len(whole) - 1)
    assert len(story._moment.sessions) <= MAX_KEPT_SESSIONS + 1
    for bad in (-1, len(story.lines)):
        with pytest.raises(IndexError):
            story.go_to(bad)


@pytest.mark.long
def test_a_fork_of_the_real_robot_does_what_the_run_does() -> None:
    scenario = read_scenario(ROOT / "examples" / "push_square_next_room")
    settings = Settings(noise=0.01, seed=2, max_steps=5)
    session = Session(scenario, settings, make_robot, EpisodeLog(None))
    session.wake()
    forks = []
    while not session.finished:
        forks.append(session.fork())
        session.step()
    for fork in forks[:: max(1, len(forks) - 1)]:
        assert fork is not session
        while not fork.finished:
            fork.step()
        assert encode(fork.line) == encode(session.line)
        assert fork.end() == session.end()


def test_a_fork_writes_no_episode(scene: Scenario, tmp_path: Path) -> None:
    path = tmp_path / "ep.jsonl"
    with EpisodeLog(path) as log:
        session = Session(scene, Settings(), scripted, log)
        session.wake()
        before = path.read_bytes()
        session.fork().step()
        assert path.read_bytes() == before
        session.step()
        assert path.read_bytes() != before


@pytest.mark.long
def test_a_change_forks_the_run_and_is_repeated_with_it(small: Scenario) -> None:
    story = live_story(small, Settings())
    while story.advance():
        pass
    plain = [encode(line) for line in story.lines]
    story.go_to(1)
    story.change("goal", "at(utak, corner(southwest)).")
    assert len(story.lines) == 2
    assert [change.entry for change in story.changes] == [{"step": 1, "goal": "at(utak, corner(southwest))."}]
    assert encode(story.lines[0]) == plain[0]
    before, world = json.loads(plain[1]), ("action", "motion", "utak", "held", "objects", "retina", "touch")
    assert {key: json.loads(encode(story.line))[key] for key in world} == {key: before[key] for key in world}
    while story.advance():
        pass
    assert story.result is not None
    assert story.result["reason"] == "at(utak,corner(southwest)) holds"
    story._moment = story._moment._replace(sessions={})  # nothing is kept: the run is repeated, change and all
    last = encode(story.line)
    story.go_to(len(story.lines) - 2)
    again = story._session_at(story._moment, len(story.lines) - 1)
    assert encode(again.line) == last
    story.go_to(0)
    assert story.header.get("changes") is None
    assert story.conditions.scenario is small


def test_a_change_that_fails_changes_nothing(small: Scenario) -> None:
    story = live_story(small, Settings())
    story.advance()
    before = story._moment
    for kind, text in (("assume", "shape(o1, sqare, 9)."), ("retract", "door(d1)."), ("goal", "at(utak, nowhere).")):
        with pytest.raises(BadInputError):
            story.change(kind, text)
        assert story._moment is before
    with pytest.raises(BadInputError, match="assumed already"):
        for _ in range(2):
            story.change("assume", "door(d1).")


def test_rules_that_derive_nonsense_later_are_told_of_as_typed(small: Scenario) -> None:
    story = live_story(small, Settings())
    rule = "shape(o1, square, C) :- full_squares(o1, N), C = 200 + N."
    with pytest.raises(BadInputError, match=r"^assume:1:1-1: error: these rules derive shape\(o1,square,2\d+\)"):
        story.change("assume", rule)
    assert story.changes == ()


def test_a_robot_without_changes_refuses_them(scene: Scenario) -> None:
    story = live_story(scene, Settings(), scripted)
    with pytest.raises(CannotAdoptError):
        story.change("assume", "shape(o1, square, 90).")
    assert story.changes == ()
    story.change("assume", "door(d1).")  # queries alone
    assert story.conditions.assumptions[0].facts == ("door(d1).",)
