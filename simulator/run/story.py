"""An episode as it can be read step by step: one that runs now, or one that was recorded."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import shapely

from kb.language.diagnostics import BadInputError, Problem, Span
from kb.language.reader import parse_facts
from kb.language.source_text import decode
from simulator.episode.episode import Episode, EpisodeLine, EpisodeLog, read_episode
from simulator.episode.record import recorded_world
from simulator.run.robots import make_robot
from simulator.run.session import Session
from simulator.scenario.picture import draw
from simulator.scenario.scenario import read_scenario
from simulator.scenario.settings import Settings


class Story(Protocol):
    """A sequence of episode lines with a place in it."""

    @property
    def line(self) -> EpisodeLine:
        """The line of the step at which the story stands."""

    @property
    def result(self) -> EpisodeLine | None:
        """How it ended, once it has: `believed`, `achieved`, `verdict`, `reason`, `steps`."""

    def advance(self) -> bool:
        """Go on by one step; False when there is none."""

    @property
    def facts(self) -> list[str]:
        """The world model of this step as facts, which are well formed. Raises BadInputError."""

    def picture(self) -> str:
        """The table at this step."""


class RunState(NamedTuple):
    """What is known of a run after one of its steps: its line, its end, where things lay and where Utak stood."""

    line: EpisodeLine
    result: EpisodeLine | None
    polygons: Mapping[str, Any]
    utak: tuple[float, float]


class LiveStory:
    """A run of the robot in a scenario; it wakes at once.

    A step is whole or did not happen. One that was broken off, at whatever point, leaves a robot and a table that
    nothing is known of; they are made anew by repeating the run up to the last whole step, which gives the same.

    Parameters
    ----------
    begin : returns a fresh session of the same run.
    """

    def __init__(self, begin: Callable[[], Session]) -> None:
        self._begin = begin
        session = begin()
        session.wake()
        self._world = session.table.world
        self._moment = _run_state(session)
        self._session: Session | None = session

    @property
    def line(self) -> EpisodeLine:
        """The line of the last step."""
        return self._moment.line

    @property
    def result(self) -> EpisodeLine | None:
        """How it ended, once it has."""
        return self._moment.result

    def advance(self) -> bool:
        """Let the robot act once."""
        if self.result is not None:
            return False
        session = self._session or self._repeated()
        self._session = None  # whatever breaks this off, the session is not gone on with
        session.step()
        self._moment = _run_state(session)
        self._session = session
        return True

    @property
    def facts(self) -> list[str]:
        """The world model after the last step."""
        return facts_of_line(self.line)

    def picture(self) -> str:
        """The table now."""
        return draw(self._world, self._moment.polygons, self._moment.utak)

    def _repeated(self) -> Session:
        """A session at the last whole step."""
        session = self._begin()
        session.wake()
        while session.line["step"] != self.line["step"]:
            session.step()
        return session


def _run_state(session: Session) -> RunState:
    """What is known after a step of a session; it is ended when the robot has come to a verdict."""
    result = session.end().line["result"] if session.finished else None
    table = session.table
    return RunState(session.line, result, dict(table.polygons), table.utak)


class RecordedStory:
    """An episode that was written to a file."""

    def __init__(self, name: str, episode: Episode) -> None:
        self._name, self._episode = name, episode
        self._at = 0

    @property
    def line(self) -> EpisodeLine:
        """The line of this step."""
        return self._episode.steps[self._at]

    @property
    def result(self) -> EpisodeLine | None:
        """How it ended, at the last step."""
        return self._episode.result if self._at == len(self._episode.steps) - 1 else None

    def advance(self) -> bool:
        """Turn to the next line."""
        if self._at == len(self._episode.steps) - 1:
            return False
        self._at += 1
        return True

    @property
    def facts(self) -> list[str]:
        """The world model of this step, read as the facts of a file are."""
        facts = facts_of_line(self.line)
        try:
            parse_facts(decode(self._name, "\n".join(facts).encode("utf-8")))
        except BadInputError as bad:
            first = bad.problems[0]
            what = f"belief.facts, number {first.span.line}: {first.what}: the episode is damaged"
            raise BadInputError([Problem(self._name, Span(self._at + 2, 1, 1), what)]) from None
        return facts

    def picture(self) -> str:
        """The table at this step."""
        try:
            world = recorded_world(self._episode.header)
            polygons = {name: shapely.Polygon(ring) for name, ring in self.line["objects"].items()}
            x, y = self.line["utak"]
            return draw(world, polygons, (x, y))
        except (ValueError, shapely.errors.ShapelyError):  # a boundary that crosses itself, say
            what = f"step {self._at} does not record a table that can be drawn: the episode is damaged"
            raise BadInputError([Problem(self._name, Span(self._at + 2, 1, 1), what)]) from None


def open_story(path: Path | str, settings: Settings) -> Story:
    """Return the story of a scenario folder, which is run, or of an episode file, which is read; it stands at step 0.

    Raises CannotOpenError or BadInputError.
    """
    if Path(path).is_dir():
        scenario = read_scenario(path)
        return LiveStory(lambda: Session(scenario, settings, make_robot, EpisodeLog(None)))
    episode = read_episode(path)
    if not episode.steps:
        raise BadInputError([Problem(str(path), Span(1, 1, 1), "the episode ends before its first step")])
    return RecordedStory(str(path), episode)


def facts_of_line(line: EpisodeLine) -> list[str]:
    """Return the world model of a step as facts; empty when the step records none."""
    belief: Any = line.get("belief")
    facts: Any = belief.get("facts") if isinstance(belief, dict) else None
    return [str(fact) for fact in facts] if isinstance(facts, list) else []
