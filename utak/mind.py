"""Another mind in the same body: it gets impressions, gives commands, and is judged like the robot's own mind."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from utak.kb.body import COMMANDS, Body, Command, Impression
from utak.kb.task.task import Task
from utak.planner.decision import Decision, StepReport, TaskEnd, TaskVerdict
from utak.simulator.run.session import CannotAdoptError
from utak.simulator.scenario.settings import Settings

VERDICT_KINDS = tuple(map(str, TaskVerdict))  # as episodes name them (docs/files.md)


@dataclass(frozen=True)
class Verdict:
    """The verdict of a mind at the end of a task.

    Attributes
    ----------
    kind : str
        "done" when every goal holds, "impossible" when no plan exists, "possible_if" when one exists under a condition
        that cannot be settled, "limit" when the mind gives up.
    reason : str
        Why, in words.
    """

    kind: str
    reason: str = ""

    def __post_init__(self) -> None:
        """Raise ValueError unless the kind is one of the four."""
        if self.kind not in VERDICT_KINDS:
            raise ValueError(f"no such verdict: {self.kind!r}; one of {', '.join(VERDICT_KINDS)} is meant")


class Mind:
    """A mind for Utak's body; derive from it and give `step` a body of its own.

    It sees what the robot sees, and nothing else: the task once, then one impression after each command. Use it with
    `utak.Run(scenario, mind=Mine)`.

    Examples
    --------
    >>> class Northward(Mind):
    ...     def step(self, impression):
    ...         ahead = impression.touch[0]  # the colour of the square to the north
    ...         return Move(0, 1) if ahead is None else Verdict("limit", f"{ahead} is ahead")
    """

    def begin(self, task: Task) -> None:
        """Take in the task before the first impression; nothing by default.

        Parameters
        ----------
        task : Task
            `goals`, `parameters` and `claims`, as start.lp and goal.lp state them.
        """

    def step(self, impression: Impression) -> Command | Verdict:
        """Return the next command, or the verdict that ends the run.

        Parameters
        ----------
        impression : Impression
            What is sensed now: `retina`, 160 gray levels, and `touch`, the colours of the 8 adjacent squares clockwise
            from north, in the robot frame. The first one is that of waking.

        Returns
        -------
        Move, Push, Turn, Grasp, Release or Verdict
            Lengths in squares, angles in degrees, counter-clockwise positive, directions in the robot frame.
        """
        raise TypeError(f"{type(self).__name__} has no method step(impression)")

    def facts(self) -> Iterable[str]:
        """Return what the mind believes now, as facts with full stops; none by default.

        They are recorded, so that questions can be asked about them (docs/reference/vocabulary.md has the predicates).
        """
        return ()


class MindRobot:
    """A robot whose mind is a `Mind`; satisfies the protocol of `utak.simulator.run.session`."""

    def __init__(self, body: Body, task: Task, settings: Settings, mind: Mind) -> None:
        self.mind = mind
        self._body, self._task, self._settings = body, task, settings
        self._next: Command | Verdict = Verdict("limit", "the robot has not been woken yet")
        self._steps = 0
        mind.begin(task)

    def wake(self) -> StepReport:
        """Take the first impression and return the report on it."""
        return self._taken_in(None, self._body.wake())

    def step(self) -> StepReport:
        """Give the command that the mind has chosen, and return the report on the impression after it."""
        if isinstance(self._next, Verdict):
            raise ValueError("the run is finished")
        command, self._steps = self._next, self._steps + 1
        return self._taken_in(command, self._body.act(command))

    @property
    def finished(self) -> bool:
        """Whether the mind has given a verdict, or the commands are used up."""
        return isinstance(self._next, Verdict)

    @property
    def verdict(self) -> TaskEnd:
        """The verdict at the end."""
        found = self._next if isinstance(self._next, Verdict) else Verdict("limit", "the run was not finished")
        return TaskEnd(found.kind == "done", TaskVerdict(found.kind), found.reason)

    def adopt(self, task: Task, settings: Settings) -> StepReport:
        """Take another task and other options from the newest impression on, and return the report on it anew."""
        # Raises CannotAdoptError for other rules: a mind has none.
        if settings.kb_files != self._settings.kb_files:
            raise CannotAdoptError(f"{type(self.mind).__name__} takes no rules: a mind of its own reasons without them")
        before, self._task, self._settings = self._task, task, settings
        if task != before:
            self.mind.begin(task)
        if task != before or self.finished:
            self._next = self._asked(self._newest[1])
        return self._report(*self._newest)

    @property
    def decision(self) -> Decision:
        """The next command with its reason; without a command at the end."""
        if isinstance(self._next, Verdict):
            return Decision(None, self._next.reason)
        return Decision(self._next, f"{type(self.mind).__name__} chose it")

    def _asked(self, impression: Impression) -> Command | Verdict:
        """Return what the mind answers to an impression: a command, or the verdict; also when commands are used up."""
        chosen = self.mind.step(impression)
        if not isinstance(chosen, (*COMMANDS, Verdict)):
            kinds = ", ".join(kind.__name__ for kind in (*COMMANDS, Verdict))
            raise TypeError(f"{type(self.mind).__name__}.step must return one of {kinds}, not {chosen!r}")
        if not isinstance(chosen, Verdict) and self._steps >= self._settings.max_steps:
            chosen = Verdict("limit", f"not done after {self._steps} commands")
        return chosen

    def _taken_in(self, command: Command | None, impression: Impression) -> StepReport:
        """Ask the mind for the next command, and return the report."""
        self._next, self._newest = self._asked(impression), (command, impression)
        return self._report(command, impression)

    def _report(self, command: Command | None, impression: Impression) -> StepReport:
        name = type(self.mind).__name__
        facts = [str(fact) for fact in self.mind.facts()]
        return StepReport(command, impression, {"facts": facts}, f"{name} {'wakes' if command is None else 'chose it'}")


def mind_maker(mind: Callable[[], Mind]) -> Callable[[Body, Task, Settings], MindRobot]:
    """Return what makes a robot with a new mind for a body, a task and the options of a run."""

    def make(body: Body, task: Task, settings: Settings) -> MindRobot:
        made = mind()
        if not isinstance(made, Mind):
            raise TypeError(f"mind must make a utak.Mind, not {made!r}")
        return MindRobot(body, task, settings, made)

    return make
