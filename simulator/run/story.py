"""A run or a recorded episode, read step by step."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import shapely

from kb.language.diagnostics import BadInputError, Problem, SourceSpan
from kb.language.reader import parse_facts
from kb.language.source_text import source_from_bytes
from simulator.episode.episode import Episode, EpisodeLine, EpisodeLog, read_episode
from simulator.episode.record import recorded_world
from simulator.run.robots import make_robot
from simulator.run.session import Session
from simulator.scenario.picture import draw
from simulator.scenario.scenario import read_scenario
from simulator.scenario.settings import Settings


class Story(Protocol):
    """A sequence of episode lines, with a current step."""

    @property
    def line(self) -> EpisodeLine:
        """The line of the current step."""

    @property
    def result(self) -> EpisodeLine | None:
        """The end, at the last step: `believed`, `achieved`, `verdict`, `reason`, `steps`; else None."""

    def advance(self) -> bool:
        """Go on by one step. Return whether there was one."""

    @property
    def facts(self) -> list[str]:
        """The world model at the current step, as well-formed facts. Raises BadInputError for a damaged episode."""

    def picture(self) -> str:
        """Return the true table at the current step as a picture."""


class RunState(NamedTuple):
    """The state of a run after a complete step.

    Attributes
    ----------
    line : the line of the step.
    result : the end, or None.
    polygons : the outlines of the movable things by name, squares, table frame.
    utak : Utak's place (x, y), squares, table frame.
    """

    line: EpisodeLine
    result: EpisodeLine | None
    polygons: Mapping[str, Any]
    utak: tuple[float, float]


class LiveStory:
    """A run of the robot in a scenario; the robot wakes at once.

    A step is either complete or did not happen. After an interrupted step the state of robot and table is unknown; so
    they are made anew, and the run is repeated up to the last complete step, which gives the same state.

    Parameters
    ----------
    begin : returns a new session of the same run.
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
        """The line of the last complete step."""
        return self._moment.line

    @property
    def result(self) -> EpisodeLine | None:
        """The end of the run, or None."""
        return self._moment.result

    def advance(self) -> bool:
        """Let the robot act once. Return whether it did."""
        if self.result is not None:
            return False
        session = self._session or self._repeated()
        self._session = None  # a session with an interrupted step is not used again
        session.step()
        self._moment = _run_state(session)
        self._session = session
        return True

    @property
    def facts(self) -> list[str]:
        """The world model after the last step, as facts."""
        return facts_of_line(self.line)

    def picture(self) -> str:
        """Return the true table as a picture."""
        return draw(self._world, self._moment.polygons, self._moment.utak)

    def _repeated(self) -> Session:
        """Return a new session at the last complete step."""
        session = self._begin()
        session.wake()
        while session.line["step"] != self.line["step"]:
            session.step()
        return session


def _run_state(session: Session) -> RunState:
    """Return the state after a step; end the session when the robot has a verdict."""
    result = session.end().line["result"] if session.finished else None
    table = session.table
    return RunState(session.line, result, dict(table.polygons), table.utak)


class RecordedStory:
    """An episode that was read from a file.

    Parameters
    ----------
    name : the name of the file, for messages.
    episode : the episode.
    """

    def __init__(self, name: str, episode: Episode) -> None:
        self._name, self._episode = name, episode
        self._at = 0

    @property
    def line(self) -> EpisodeLine:
        """The line of the current step."""
        return self._episode.steps[self._at]

    @property
    def result(self) -> EpisodeLine | None:
        """The end, at the last step; else None."""
        return self._episode.result if self._at == len(self._episode.steps) - 1 else None

    def advance(self) -> bool:
        """Go on by one step. Return whether there was one."""
        if self._at == len(self._episode.steps) - 1:
            return False
        self._at += 1
        return True

    @property
    def facts(self) -> list[str]:
        """The world model at the current step, as well-formed facts."""
        facts = facts_of_line(self.line)
        try:
            parse_facts(source_from_bytes(self._name, "\n".join(facts).encode("utf-8")))
        except BadInputError as bad:
            first = bad.problems[0]
            what = f"belief.facts, number {first.span.line}: {first.what}: the episode is damaged"
            raise BadInputError([Problem(self._name, SourceSpan(self._at + 2, 1, 1), what)]) from None
        return facts

    def picture(self) -> str:
        """Return the true table at the current step as a picture."""
        try:
            world = recorded_world(self._episode.header)
            polygons = {name: shapely.Polygon(ring) for name, ring in self.line["objects"].items()}
            x, y = self.line["utak"]
            return draw(world, polygons, (x, y))
        except (ValueError, shapely.errors.ShapelyError):  # a boundary that crosses itself, say
            what = f"step {self._at} does not record a table that can be drawn: the episode is damaged"
            raise BadInputError([Problem(self._name, SourceSpan(self._at + 2, 1, 1), what)]) from None


def open_story(path: Path | str, settings: Settings) -> Story:
    """Return the story of a scenario folder, which is run, or of an episode file, at step 0.

    Parameters
    ----------
    path : a scenario folder or an episode.
    settings : the options of the run; not used for an episode.

    Returns
    -------
    The story.

    Raises
    ------
    CannotOpenError : a file cannot be read.
    BadInputError : a file has errors.
    """
    if Path(path).is_dir():
        scenario = read_scenario(path)
        return LiveStory(lambda: Session(scenario, settings, make_robot, EpisodeLog(None)))
    episode = read_episode(path)
    if not episode.steps:
        raise BadInputError([Problem(str(path), SourceSpan(1, 1, 1), "the episode ends before its first step")])
    return RecordedStory(str(path), episode)


def facts_of_line(line: EpisodeLine) -> list[str]:
    """Return the world model in an episode's line as facts; [] when it has none."""
    belief: Any = line.get("belief")
    facts: Any = belief.get("facts") if isinstance(belief, dict) else None
    return [str(fact) for fact in facts] if isinstance(facts, list) else []
