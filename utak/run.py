"""The robot in a scenario, step by step: what it does, believes and plans; forks of a run."""

from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

from utak.beliefs import World
from utak.episode import Episode, Step
from utak.errors import RunNotRepeatedError
from utak.kb.body import Command, Impression
from utak.kb.language.diagnostics import BadInputError
from utak.kb.world.stated_plan import StatedPlan, stated_plan
from utak.markup import framed, table
from utak.mind import Mind, mind_maker
from utak.scenario import Scenario
from utak.simulator.episode.episode import Episode as EpisodeRecord
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.episode.record import action_entry, header
from utak.simulator.run.robots import make_robot, warm_for
from utak.simulator.run.session import RobotMaker, Session
from utak.simulator.scenario.settings import PATH_CHOICES, Settings, kb_files_named
from utak.simulator.terminal.action_in_words import describe


@dataclass(frozen=True)
class Plan:
    """The plan after a step. It prints itself, and shows itself in notebooks as a table.

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
    task : kb.world.stated_plan.StatedPlan or None
        The task plan that the steps are of: `goals`, `steps`, `refutations`, `cost`, `least`, `proved`, `gap`. Where
        no plan was found, `found` is False, and the goals tell which are not attained; None where nothing is known.
    """

    command: Command | None
    why: str
    steps: tuple[str, ...] = ()
    route: tuple[tuple[float, float], ...] = ()
    task: StatedPlan | None = None

    def __str__(self) -> str:
        """Return the next command with its reason, and the task plan below."""
        below = self.steps if self.task is None else tuple(self.task.lines())
        return "\n".join([f"{self._next}: {self.why}", *below])

    def __repr__(self) -> str:
        """Return the plan as `print` shows it, so that it can be read at a prompt."""
        return str(self)

    @property
    def _next(self) -> str:
        """The next command in words."""
        return describe(action_entry(self.command)) if self.command else "end"

    def _repr_html_(self) -> str:
        """Return the plan for notebooks: the next command, and a table of the steps of the task plan."""
        shown = f"<p>next: <b>{escape(self._next)}</b>: {escape(self.why)}</p>"
        if self.task is None:
            return shown + "".join(f"<div><code>{escape(step)}</code></div>" for step in self.steps)
        rows = [
            (one.number, one.step, one.words, ", ".join(one.doors), one.commands or "", one.certainty)
            for one in self.task.steps
        ]
        shown += table(("", "step", "what", "doors", "commands", "geometry"), rows)
        others = [line for line in self.task.lines() if line.startswith(("goal ", "cost:", "refuted:"))]
        return shown + "".join(f"<div>{escape(line)}</div>" for line in others)


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
        scenario: Scenario | Path | str,
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
        scenario : Scenario, Path or str
            The world and the task, or the folder that holds them.
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
            Rules, or files of the folder, have errors.
        CannotOpenError
            A file with rules, or the folder, cannot be read.
        """
        if not isinstance(scenario, Scenario):
            scenario = Scenario.read(scenario)
        files = kb_files_named([str(file) for file in rules])
        settings = Settings(int(seed), float(noise), paths, max_steps, files, pull)
        _check(settings)
        make = make_robot if mind is None else mind_maker(mind)
        self._set(scenario, settings, make, partial(_begin, scenario, settings, make))

    def _set(self, scenario: Scenario, settings: Settings, make: RobotMaker, begin: Callable[[], Session]) -> None:
        """Set all that a run consists of, and begin it."""
        self.scenario, self.settings = scenario, settings
        self._make, self._begin = make, begin
        self._head = header(scenario.content, settings)
        session = begin()
        self._session: Session | None = session
        self._lines = [session.line]
        self._first_own = 1  # the number of the first step that is not repeated by `begin`
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

    def fork(
        self,
        *,
        seed: int | None = None,
        noise: float | None = None,
        goal: str | None = None,
        start: str | None = None,
        expect: str | None = None,
        max_steps: int | None = None,
    ) -> "Run":
        """Return a copy of this run that goes on independently; without arguments it goes on exactly like this one.

        The mind and the table are copied. A mind that cannot be copied is made anew, and the run is repeated up to this
        step.

        Parameters
        ----------
        seed : int, optional
            The seed of all randomness from now on; the same random numbers go on if None.
        noise : float, optional
            How much motions are disturbed from now on, 0 to 1.
        goal : str, optional
            Another goal from now on, as in `goal.lp`. What is known is kept. What is held is released first.
        start : str, optional
            The parameters of that goal, as in `start.lp`; those of this run if None.
        expect : str, optional
            What a test expects of that goal, as in `expect.lp`.
        max_steps : int, optional
            The number of commands after which the robot gives up, those already given included.

        Returns
        -------
        Run
            The copy. The header of its episode says at which step it was forked (docs/files.md).

        Raises
        ------
        ValueError
            An option is out of its range, or `start` or `expect` is given without `goal`.
        BadInputError
            Texts have errors.
        RunNotRepeatedError
            The mind could not be copied, and does not repeat its commands.
        """
        if goal is None and (start is not None or expect is not None):
            raise ValueError("start and expect belong to another goal: give goal, too")
        scenario = self.scenario if goal is None else self.scenario.with_task(goal, start, expect)
        given: dict[str, Any] = {"seed": seed, "noise": noise, "max_steps": max_steps}
        settings = replace(self.settings, **{name: value for name, value in given.items() if value is not None})
        _check(settings)
        copied = Run.__new__(Run)
        copied.scenario, copied.settings, copied._make = scenario, settings, self._make
        copied._lines, copied._head, copied._result = list(self._lines), self._head, self._result
        copied._begin, copied._first_own = self._begin, self._first_own
        session = self._copied_session()
        if scenario is not self.scenario or settings != self.settings:
            copied._begin = partial(
                _changed, self._begin, self._lines[self._first_own :], scenario, settings, self._make
            )
            copied._first_own = len(self._lines)
            stage = {"until": len(self._lines) - 1, "options": self._head["options"], "task": self._head["task"]}
            stages = [*self._head.get("forked", ()), stage]
            copied._head = header(scenario.content, settings) | {"forked": stages}
            copied._result = None
            warm_for(self._make, scenario.content.task, settings)
            copied._lines[-1] = session.adopt(scenario.content, settings)
            copied._end_if_finished(session)
        copied._session = session
        return copied

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
        """The world model now."""
        return self.episode[-1].world

    @property
    def impression(self) -> Impression:
        """The newest impression: `retina`, 160 gray levels, and `touch`, the colours of 8 squares."""
        return self.episode[-1].impression

    @property
    def plan(self) -> Plan:
        """The plan now: the next command and why, the way that was chosen for it, and the task plan."""
        belief = self._lines[-1].get("belief", {})
        facts = tuple(belief.get("facts", ()))
        steps = tuple(fact.removesuffix(".") for fact in facts if fact.startswith("plan("))
        task = _task_plan(facts)
        chosen = next((route["points"] for route in belief.get("routes", ()) if route["chosen"]), ())
        route = tuple((float(east), float(north)) for east, north in chosen)
        if self._result is not None:
            return Plan(None, str(self._result["reason"]), steps, (), task)
        if self._session is None:  # a step was interrupted
            self._session = self._repeated()
        robot: Any = self._session.robot
        return Plan(robot.decision.command, robot.decision.why, steps, route, task)

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
        plan = f"<br/>{escape(repr(self)[1:-1])}" if self.finished else self.plan._repr_html_()
        caption = f"<b>{last.number}: {escape(last.action)}</b> {escape(last.why)}{plan}"
        return framed(caption, self._repr_svg_())

    def _end_if_finished(self, session: Session) -> None:
        """Judge the run when the robot has a verdict."""
        if session.finished:
            self._result = session.end().line["result"]

    def _copied_session(self) -> Session:
        """Return a session in the state of this run's last step, which shares nothing with this run."""
        if self._session is None:
            return self._repeated()
        try:
            return deepcopy(self._session)
        except Exception:  # of whatever kind: a mind may hold files, locks or generators
            return self._repeated()

    def _repeated(self) -> Session:
        """Return a new session at the last complete step of this run."""
        return _repeat(self._begin, self._lines[self._first_own :])


def _task_plan(facts: Sequence[str]) -> StatedPlan | None:
    """Return the task plan that facts state; None for none, and for facts of a mind's own that are no task plan."""
    try:
        return stated_plan(facts)
    except BadInputError:
        return None


def _begin(scenario: Scenario, settings: Settings, make: RobotMaker) -> Session:
    """Return a new session in which the robot is awake."""
    session = Session(scenario.content, settings, make, EpisodeLog(None))
    session.wake()
    return session


def _repeat(begin: Callable[[], Session], lines: Sequence[dict[str, Any]]) -> Session:
    """Return a new session that went through some steps again."""
    # Raises RunNotRepeatedError when one came out otherwise.
    session = begin()
    for line in lines:
        if session.finished or session.step() != line:
            raise RunNotRepeatedError(f"step {line['step']} came out otherwise when the run was repeated")
    return session


def _changed(
    begin: Callable[[], Session],
    lines: Sequence[dict[str, Any]],
    scenario: Scenario,
    settings: Settings,
    make: RobotMaker,
) -> Session:
    """Return a new session that went through some steps again, and then goes on with other options."""
    session = _repeat(begin, lines)
    warm_for(make, scenario.content.task, settings)
    session.adopt(scenario.content, settings)
    return session


def _check(settings: Settings) -> None:
    """Raise ValueError when an option is out of its range."""
    if not 0.0 <= settings.noise <= 1.0:
        raise ValueError(f"noise must be from 0 to 1, not {settings.noise}")
    if settings.seed < 0 or settings.max_steps < 0:
        raise ValueError(f"seed and max_steps must be 0 or greater, not {settings.seed} and {settings.max_steps}")
    if settings.paths not in PATH_CHOICES:
        raise ValueError(f"no such path-finder: {settings.paths!r}; one of {', '.join(PATH_CHOICES)} is meant")
