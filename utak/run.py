"""The robot in a scenario, step by step: what it does, believes and plans; forks of a run."""

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

from utak.beliefs import World
from utak.episode import Episode, Step
from utak.kb.body import Command, Impression
from utak.kb.language.diagnostics import BadInputError
from utak.kb.world.stated_plan import StatedPlan, stated_plan
from utak.markup import framed, table
from utak.mind import Mind, mind_maker
from utak.scenario import Scenario
from utak.simulator.episode.record import action_entry
from utak.simulator.run.robots import make_robot
from utak.simulator.run.story import live_story
from utak.simulator.scenario.settings import PATH_CHOICES, USUAL_RISK, Settings, kb_files_named
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
        return describe(action_entry(self.command)) if self.command else "end"

    def _repr_html_(self) -> str:
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
        disturb: Path | str | None = None,
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
        disturb : Path or str, optional
            A file that states what others do meanwhile, as `--disturb` (docs/files.md); None for nothing.

        Raises
        ------
        ValueError
            An option is out of its range.
        BadInputError
            Rules, disturbances, or files of the folder, have errors.
        CannotOpenError
            A file with rules, that of disturbances, or the folder, cannot be read.
        """
        if not isinstance(scenario, Scenario):
            scenario = Scenario.read(scenario)
        if disturb is not None:
            scenario = scenario.disturbed(disturb)
        files = kb_files_named([str(file) for file in rules])
        settings = Settings(int(seed), float(noise), paths, max_steps, files, pull)
        _check(settings)
        self.scenario, self.settings = scenario, settings
        make = make_robot if mind is None else mind_maker(mind)
        self._story = live_story(scenario.content, settings, make, goes_back=False)
        assert self._story.line  # the robot wakes

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
        return self.episode[-1] if self._story.advance() else None

    def finish(self) -> Episode:
        """Let the robot act until it has a verdict, and return the episode."""
        while self.step() is not None:
            pass
        return self.episode

    def certificate(self, risk: float = USUAL_RISK) -> str:
        """Return why the verdict follows, as `Episode.certificate` does; raises NoCertificateError where nothing does.

        Parameters
        ----------
        risk : float
            With noise: how likely it may be wrong, at most, in percent, 0.0001 to 99. Without noise it has none.

        Returns
        -------
        str
            A JSON text (docs/certificates.md).
        """
        return self.episode.certificate(risk)

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
        forked = copy(self)
        forked._story = self._story.fork()
        if scenario is not self.scenario or settings != self.settings:
            forked.scenario, forked.settings = scenario, settings
            forked._story.adopt(scenario.content, settings)
        return forked

    def __iter__(self) -> Iterator[Step]:
        """Yield the steps that are still to come."""
        while (step := self.step()) is not None:
            yield step

    @property
    def episode(self) -> Episode:
        """The episode so far, from waking on; it does not grow when the run goes on."""
        return Episode(self._story.episode, self.settings.kb_files)

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
        belief = self._story.line["belief"]
        facts = belief["facts"]
        steps = tuple(fact.removesuffix(".") for fact in facts if fact.startswith("plan("))
        task = _task_plan(facts)
        chosen = next((route["points"] for route in belief.get("routes", ()) if route["chosen"]), ())
        route = tuple((float(east), float(north)) for east, north in chosen)
        result, decision = self._story.result, self._story.decision
        if result is not None or decision is None:
            return Plan(None, "" if result is None else str(result["reason"]), steps, (), task)
        return Plan(decision.command, decision.why, steps, route, task)

    @property
    def finished(self) -> bool:
        """Whether there is a verdict."""
        return self._story.result is not None

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
        commands, result = self._story.at, self._story.result
        end = "" if result is None else f"; {result['verdict']}: {result['reason']}"
        return f"<Run after {commands} command{'s' * (commands != 1)}{end}>"

    def _repr_svg_(self) -> str:
        return self.episode[-1]._repr_svg_()

    def _repr_html_(self) -> str:
        last = self.episode[-1]
        plan = f"<br/>{escape(repr(self)[1:-1])}" if self.finished else self.plan._repr_html_()
        caption = f"<b>{last.number}: {escape(last.action)}</b> {escape(last.why)}{plan}"
        return framed(caption, self._repr_svg_())


def _task_plan(facts: Sequence[str]) -> StatedPlan | None:
    """Return the task plan that facts state; None for none, and for facts of a mind's own that are no task plan."""
    try:
        return stated_plan(facts)
    except BadInputError:
        return None


def _check(settings: Settings) -> None:
    """Raise ValueError when an option is out of its range."""
    if not 0.0 <= settings.noise <= 1.0:
        raise ValueError(f"noise must be from 0 to 1, not {settings.noise}")
    if settings.seed < 0 or settings.max_steps < 0:
        raise ValueError(f"seed and max_steps must be 0 or greater, not {settings.seed} and {settings.max_steps}")
    if settings.paths not in PATH_CHOICES:
        raise ValueError(f"no such path-finder: {settings.paths!r}; one of {', '.join(PATH_CHOICES)} is meant")
