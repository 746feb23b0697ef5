"""The robot in a scenario, step by step: what it does, believes and plans; forks of a run."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

from kb.body import Command, Impression
from simulator.episode.episode import Episode as EpisodeRecord
from simulator.episode.episode import EpisodeLog
from simulator.episode.record import action_entry, header
from simulator.run.robots import make_robot
from simulator.run.session import RobotMaker, Session
from simulator.scenario.settings import PATH_CHOICES, Settings, kb_files_named
from simulator.terminal.action_in_words import describe
from utak.beliefs import World
from utak.episode import Episode, Step
from utak.errors import RunNotRepeatedError
from utak.markup import framed
from utak.mind import Mind, mind_maker
from utak.scenario import Scenario


@dataclass(frozen=True)
class Plan:
    """What is planned after a step.

    Attributes
    ----------
    command : Move, Push, Turn, Grasp, Release or None
        The next command, in the robot frame; None when the run has ended.
    why : str
        Its reason, or that of the verdict, in words.
    steps : tuple of str
        The symbolic plan, as facts without full stops; () where the mind states none.
    route : tuple of (east, north)
        The way that was chosen for it, in squares, robot frame; () where none was weighed.
    """

    command: Command | None
    why: str
    steps: tuple[str, ...] = ()
    route: tuple[tuple[float, float], ...] = ()

    def __str__(self) -> str:
        """Return the next command with its reason, and the steps below."""
        return "\n".join(
            [f"{describe(action_entry(self.command)) if self.command else 'end'}: {self.why}", *self.steps]
        )


class Run:
    r"""A run of the robot, or of another mind in its body. The robot wakes at once.

    The same arguments give the same run, command by command. A run shows itself in notebooks as a picture of its last
    step.

    Examples
    --------
    >>> room = "bbbbbbbb\nb......b\nb......b\nb.U....b\nbbbbbbbb"
    >>> run = Run(Scenario.from_text(world=room, goal="at(utak, corner(northeast))."))
    >>> run.step()
    <Step 1: move(3, 2): the way to the goal is known; at(utak,corner(northeast))>
    >>> run.finish()
    <Episode of 3 commands; done: at(utak,corner(northeast)) holds>
    """

    def __init__(
        self,
        scenario: Scenario,
        seed: int = 1,
        noise: float = 0.0,
        *,
        paths: str = "skeleton",
        max_steps: int = 200,
        pull: bool = True,
        rules: tuple[Path | str, ...] | list[Path | str] = (),
        mind: Callable[[], Mind] | None = None,
    ) -> None:
        """Let the robot wake in a scenario.

        Parameters
        ----------
        scenario : Scenario
            The world and the task.
        seed : int
            The seed of all randomness, from 0.
        noise : float
            How much motions are disturbed, from 0 to 1 (docs/files.md).
        paths : str
            The path-finder: "skeleton", "visibility" or "grid".
        max_steps : int
            The number of commands after which the robot gives up.
        pull : bool
            Whether a held object may be pulled.
        rules : sequence of Path or str
            Files with rules that are added to the robot's own, as `--kb`.
        mind : callable, optional
            A class derived from `Mind`, or a function that returns a new mind; None for the robot's own.

        Raises
        ------
        ValueError
            An option is out of its range.
        BadInputError
            Rules have errors.
        CannotOpenError
            A file with rules cannot be read.
        """
        if not 0.0 <= noise <= 1.0:
            raise ValueError(f"noise must be from 0 to 1, not {noise}")
        if seed < 0 or max_steps < 0:
            raise ValueError(f"seed and max_steps must be 0 or greater, not {seed} and {max_steps}")
        if paths not in PATH_CHOICES:
            raise ValueError(f"no such path-finder: {paths!r}; one of {', '.join(PATH_CHOICES)} is meant")
        files = kb_files_named([str(file) for file in rules])
        settings = Settings(int(seed), float(noise), paths, max_steps, files, pull)
        make: RobotMaker = make_robot if mind is None else mind_maker(mind)
        session = _begin(scenario, settings, make)
        self._set(scenario, settings, partial(_begin, scenario, settings, make), session, (session.line,))

    def _set(
        self,
        scenario: Scenario,
        settings: Settings,
        begin: Callable[[], Session],
        session: Session,
        lines: tuple[dict[str, Any], ...],
    ) -> None:
        """Set all that a run consists of.

        begin : makes the session anew, at the step at which this run began. lines : the lines of the episode so far.
        """
        self.scenario, self.settings = scenario, settings
        self._begin = begin
        self._began_at = len(lines) - 1
        self._lines = list(lines)
        self._head = header(scenario.content, settings)
        self._session: Session | None = session
        self._result: dict[str, Any] | None = None
        self._end_if_finished(session)

    def step(self) -> Step | None:
        """Let the robot act once.

        Returns
        -------
        Step or None
            The new step; None when the run has ended before.

        Raises
        ------
        RunNotRepeatedError
            A step was interrupted before this one, and the mind does not repeat its commands.
        """
        if self._result is not None:
            return None
        session = self._session or self._repeated()
        self._session = None  # a session with an interrupted step is not used again
        self._lines.append(session.step())
        self._end_if_finished(session)
        self._session = session
        return self.episode[-1]

    def finish(self) -> Episode:
        """Let the robot act until it has a verdict, and return the episode."""
        while self.step() is not None:
            pass
        return self.episode

    def __iter__(self) -> Iterator[Step]:
        """Yield the steps that are still to come."""
        while (step := self.step()) is not None:
            yield step

    @property
    def episode(self) -> Episode:
        """The episode so far, from waking on; it does not grow when the run goes on."""
        return Episode(EpisodeRecord(self._head, tuple(self._lines), self._result), self.settings.kb_files)

    @property
    def world(self) -> World:
        """What is believed now."""
        return self.episode[-1].world

    @property
    def impression(self) -> Impression:
        """What was sensed last: `retina`, 160 gray levels, and `touch`, the colours of 8 squares."""
        return self.episode[-1].impression

    @property
    def plan(self) -> Plan:
        """What is planned now: the next command and why, and the way that was chosen for it."""
        belief = self._lines[-1].get("belief", {})
        steps = tuple(fact.removesuffix(".") for fact in belief.get("facts", ()) if fact.startswith("plan("))
        chosen = next((route["points"] for route in belief.get("routes", ()) if route["chosen"]), ())
        route = tuple((float(east), float(north)) for east, north in chosen)
        if self._result is not None:
            return Plan(None, str(self._result["reason"]), steps)
        if self._session is None:  # a step was interrupted
            self._session = self._repeated()
        robot: Any = self._session.robot
        return Plan(robot.decision.command, robot.decision.why, steps, route)

    @property
    def finished(self) -> bool:
        """Whether there is a verdict."""
        return self._result is not None

    @property
    def verdict(self) -> str | None:
        """The verdict: done, impossible, possible_if or limit; None while the run goes on."""
        return self.episode.verdict

    @property
    def reason(self) -> str:
        """The reason of the verdict, in words; "" while the run goes on."""
        return self.episode.reason

    @property
    def achieved(self) -> bool | None:
        """Whether the table is as expect.lp expects; None without expectations, or while the run goes on."""
        return self.episode.achieved

    def __repr__(self) -> str:
        """Return the number of commands and how the run ended, if it did."""
        commands = len(self._lines) - 1
        end = "" if self._result is None else f"; {self._result['verdict']}: {self._result['reason']}"
        return f"<Run after {commands} command{'s' * (commands != 1)}{end}>"

    def _repr_svg_(self) -> str:
        """Return the last step as a picture for notebooks."""
        return self.episode[-1]._repr_svg_()

    def _repr_html_(self) -> str:
        """Return the last step and what is planned for notebooks."""
        last = self.episode[-1]
        plan = f"<br>next: {escape(str(self.plan))}" if not self.finished else f"<br>{escape(repr(self)[1:-1])}"
        caption = f"<b>{last.number}: {escape(last.action)}</b> {escape(last.why)}{plan}"
        return framed(caption, self._repr_svg_())

    def _end_if_finished(self, session: Session) -> None:
        """Judge the run when the robot has a verdict."""
        if session.finished:
            self._result = session.end().line["result"]

    def _repeated(self) -> Session:
        """Return a new session at the last complete step of this run."""
        session = self._begin()
        for line in self._lines[self._began_at + 1 :]:
            if session.step() != line:
                raise RunNotRepeatedError(f"step {line['step']} came out otherwise when the run was repeated")
        return session


def _begin(scenario: Scenario, settings: Settings, make: RobotMaker) -> Session:
    """Return a new session in which the robot is awake."""
    session = Session(scenario.content, settings, make, EpisodeLog(None))
    session.wake()
    return session
