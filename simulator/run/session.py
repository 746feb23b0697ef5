"""One run: the robot wakes in a scenario and acts until it has a verdict; the truth is recorded as it happens."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Protocol

from utak.kb.body import Body, Command
from utak.kb.task.task import Task
from utak.planner.decision import StepReport, TaskEnd, TaskVerdict
from utak.simulator.episode.episode import EpisodeLine, EpisodeLog
from utak.simulator.episode.record import action_entry, disturbance_entries, header, motion_entry
from utak.simulator.run.embodiment import Embodiment
from utak.simulator.run.time_limit import TimeLimit, TimeOver
from utak.simulator.scenario.expectation import Snapshot, shortfalls, should_fail
from utak.simulator.scenario.points import ExpectationOutcome, judge_expectations
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import outer_ring


class RobotProtocol(Protocol):
    """A robot: given a body and a task, it wakes and then takes one step after the other."""

    def wake(self) -> StepReport:
        """Take the first impression and return the report on it."""

    def step(self) -> StepReport:
        """Choose a command, act and return the report; without a command when the run ends."""

    @property
    def finished(self) -> bool:
        """Whether the robot has a verdict."""

    @property
    def verdict(self) -> TaskEnd:
        """The verdict at the end."""


class RunNotRepeatedError(Exception):
    """A run was repeated, and a step came out otherwise: a mind, or what it uses, is not deterministic."""


class CannotAdoptError(Exception):
    """Raised where a robot does not take another task or other options while it runs."""


# Makes a robot from its body, its task and the options of the run.
RobotMaker = Callable[[Body, Task, Settings], RobotProtocol]


@dataclass(frozen=True)
class Result:
    """The end of a run."""

    believed: bool  # whether Utak believes that the task is done
    achieved: bool | None  # whether it is done by expect.lp; None without expect.lp.
    verdict: str  # done, impossible, possible_if or limit
    reason: str  # the reason in words
    steps: int  # the number of commands
    unmet: tuple[str, ...] = field(default=())  # the expectations that the truth does not meet, as text
    came: tuple[str, ...] = field(default=())  # what came instead of each of them, in words
    # What came of each expectation that a test tests, with its points
    outcomes: tuple[ExpectationOutcome, ...] = field(default=())
    seconds: float | None = None  # the limit of time that ended the run; None when the robot ended it
    idle_rules: tuple[str, ...] = field(default=())  # the users' rules that never applied, in words with file and line

    @property
    def line(self) -> EpisodeLine:
        """The last line of the episode."""
        names = ("believed", "achieved", "verdict", "reason", "steps")
        values = {name: getattr(self, name) for name in names}
        values |= {} if self.seconds is None else {"seconds": self.seconds}
        return {"result": values | ({"idle_rules": list(self.idle_rules)} if self.idle_rules else {})}


class Session:
    """A run that is advanced step by step."""

    def __init__(self, scenario: Scenario, settings: Settings, make: RobotMaker, log: EpisodeLog) -> None:
        self.scenario, self.settings = scenario, settings
        self.table = Tabletop(scenario.world, settings.noise, settings.seed)
        self.robot = make(Embodiment(self.table), scenario.task, settings)
        self.line: EpisodeLine = {}
        self._log = log
        self._track: list[Snapshot] = []

    def wake(self, limit: TimeLimit | None = None) -> EpisodeLine:
        """Write the header, let the robot wake, write step 0 and return that line."""
        # None for none.
        self._log.write(header(self.scenario, self.settings))
        with self._cutting(limit):
            report = self.robot.wake()
        return self._record(report)

    def adopt(self, scenario: Scenario, settings: Settings) -> EpisodeLine:
        """Go on from the present step with another scenario in the same world, and with other options."""
        # Robots that adopt interpret the newest impression anew, as if task and options had been these.
        adopt: Callable[[Task, Settings], StepReport] | None = getattr(self.robot, "adopt", None)
        if adopt is None:
            raise CannotAdoptError("this robot takes no assumptions and no other goals while it runs")
        report = adopt(scenario.task, settings)
        self.table.disturb(settings.noise, settings.seed if settings.seed != self.settings.seed else None)
        self.scenario, self.settings = scenario, settings
        self.line = self.line | {"belief": report.belief, "why": report.why}
        return self.line

    def write_to(self, log: EpisodeLog) -> None:
        """Write the lines from now on, the last one first, to another episode."""
        self._log = log
        log.write(self.line)

    def step(self, limit: TimeLimit | None = None) -> EpisodeLine:
        """Let the robot act once, write what happened, and return the last line."""
        # None for none.
        with self._cutting(limit):
            report = self.robot.step()
        return self.line if report.command is None else self._record(report)

    def follow(self, command: Command, why: str) -> EpisodeLine:
        """Let the robot give a command that comes from outside, write what happened, and return the line."""
        follow: Callable[[Command, str], StepReport] | None = getattr(self.robot, "follow", None)
        if follow is None:
            raise TypeError("this robot takes no commands from outside")
        return self._record(follow(command, why))

    @property
    def finished(self) -> bool:
        """Whether the robot has a verdict."""
        return self.robot.finished

    def end(self, limit: TimeLimit | None = None, within: bool = False) -> Result:
        """Compare the verdict with the truth, write the result and return it."""
        verdict: TaskEnd = self.robot.verdict if limit is None else self._verdict_of(limit, within)
        expected = self.scenario.expectations or ()
        if not self._track:  # the robot did not wake in time
            self._track.append(Snapshot(0, self.table.utak, dict(self.table.polygons)))
        missed = shortfalls(expected, self.scenario.world, self._track, str(verdict.verdict))
        achieved = None if self.scenario.expectations is None else not missed and not should_fail(expected)
        outcomes = judge_expectations(expected, missed, verdict.believed, verdict.reason)
        steps = self._track[-1].step
        unmet, came = tuple(map(str, missed)), tuple(missed.values())
        seconds = None if limit is None else limit.seconds
        end = (verdict.believed, achieved, verdict.verdict, verdict.reason, steps)
        idle = tuple(getattr(self.robot, "idle_rules", ()))  # other minds have no rules
        result = Result(*end, unmet, came, outcomes, seconds, idle)
        self._log.write(result.line)
        return result

    def run(self, watch: Callable[["Session"], None] = lambda session: None, limit: TimeLimit | None = None) -> Result:
        """Run from waking, or from the present step, to the end, and return the result."""
        if limit is not None:
            limit.begin()
        try:
            if not self._track:
                self.wake(limit)
                watch(self)
            while not self.finished:
                if limit is not None and self._log.is_repeating:
                    limit.begin()
                elif limit is not None and limit.is_over:
                    return self.end(limit)
                self.step(limit)
                watch(self)
        except TimeOver:
            return self.end(limit, within=True)
        return self.end()

    def _cutting(self, limit: TimeLimit | None) -> AbstractContextManager[None]:
        """Return what raises TimeOver in a block; nothing does while the episode that is resumed is repeated."""
        return nullcontext() if limit is None or self._log.is_repeating else limit.cutting()

    def _verdict_of(self, limit: TimeLimit, within: bool) -> TaskEnd:
        """Return the verdict of a run that a limit of time ends; `within` a step or between two."""
        decision = None if within else getattr(self.robot, "decision", None)
        coming = "" if decision is None else f"; the next command would be: {decision.why}"
        coming = "; the time was over within a step, which does not count" if within else coming
        return TaskEnd(
            False, TaskVerdict.LIMIT, f"not done after {limit.seconds:g} second{'s' * (limit.seconds != 1)}{coming}"
        )

    def fork(self) -> "Session":
        """Return a copy of this run that goes on by itself and writes no episode; this run is not changed."""
        # Raises TypeError or another exception of `copy.deepcopy` when the robot cannot be copied.
        nothing = EpisodeLog(None)
        return deepcopy(self, {id(self._log): nothing, id(self.scenario): self.scenario, id(nothing): nothing})

    def _record(self, report: StepReport) -> EpisodeLine:
        table, number = self.table, len(self._track)
        self._track.append(Snapshot(number, table.utak, dict(table.polygons)))
        self.line = {
            "step": number,
            "action": action_entry(report.command),
            "motion": motion_entry(table.motion),
            **disturbance_entries(table.disturbed, table.refused),
            "utak": list(table.utak),
            "held": table.held,
            "objects": {name: [list(point) for point in outer_ring(shape)] for name, shape in table.polygons.items()},
            "retina": list(report.impression.retina),
            "touch": list(report.impression.touch),
            "belief": report.belief,
            "why": report.why,
        }
        self._log.write(self.line)
        return self.line
