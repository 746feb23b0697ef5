"""One run: the robot wakes in a scenario and acts until he stops, and the truth is written down as it happens."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from kb.body import Body, Command, Impression
from kb.task.task import Task
from simulator.episode.episode import EpisodeLine, EpisodeLog
from simulator.episode.record import action_entry, header, motion_entry
from simulator.run.embodiment import Embodiment
from simulator.scenario.expectation import Snapshot, should_fail, unmet
from simulator.scenario.scenario import Scenario
from simulator.scenario.settings import Settings
from simulator.world.physics import Tabletop
from simulator.world.world import outer_ring


class StepReportProtocol(Protocol):
    """What the robot says after an impression: the command that led to it (None on waking), his belief, and why."""

    @property
    def command(self) -> Command | None: ...
    @property
    def impression(self) -> Impression: ...
    @property
    def belief(self) -> dict[str, Any]: ...
    @property
    def why(self) -> str: ...


class VerdictProtocol(Protocol):
    """How the robot judges the end: whether he believes that the task is done, the kind of verdict, and the reason."""

    @property
    def believed(self) -> bool: ...
    @property
    def verdict(self) -> str: ...
    @property
    def reason(self) -> str: ...


class RobotProtocol(Protocol):
    """The mind: given a body and a task, it wakes and takes one step after the other."""

    def wake(self) -> StepReportProtocol: ...
    def step(self) -> StepReportProtocol: ...
    @property
    def finished(self) -> bool: ...
    @property
    def verdict(self) -> VerdictProtocol: ...


RobotMaker = Callable[[Body, Task, Settings], RobotProtocol]


@dataclass(frozen=True)
class Result:
    """How a run ended.

    Attributes
    ----------
    believed : Utak believes that the task is done.
    achieved : it is, by expect.lp; None when there is no expect.lp.
    verdict : done, impossible, possible_if or limit.
    reason : in words.
    steps : how many commands were given.
    unmet : the expectations that the truth does not meet, as text.
    """

    believed: bool
    achieved: bool | None
    verdict: str
    reason: str
    steps: int
    unmet: tuple[str, ...] = field(default=())

    @property
    def line(self) -> EpisodeLine:
        """The last line of the episode."""
        names = ("believed", "achieved", "verdict", "reason", "steps")
        return {"result": {name: getattr(self, name) for name in names}}


class Session:
    """A run that is driven step by step; `line` is the last line of the episode so far."""

    def __init__(self, scenario: Scenario, settings: Settings, make: RobotMaker, log: EpisodeLog) -> None:
        self.scenario, self.settings = scenario, settings
        self.table = Tabletop(scenario.world, settings.noise, settings.seed)
        self.robot = make(Embodiment(self.table), scenario.task, settings)
        self.line: EpisodeLine = {}
        self._log = log
        self._track: list[Snapshot] = []

    def wake(self) -> EpisodeLine:
        """Write the header, let the robot wake, and write step 0."""
        self._log.write(header(self.scenario, self.settings))
        return self._record(self.robot.wake())

    def step(self) -> EpisodeLine:
        """Let the robot act once, and write what happened. A step without a command is not written."""
        report = self.robot.step()
        return self.line if report.command is None else self._record(report)

    @property
    def finished(self) -> bool:
        """Whether the robot has come to a verdict."""
        return self.robot.finished

    def end(self) -> Result:
        """Compare the verdict with the truth, and write the result."""
        verdict = self.robot.verdict
        expectations = self.scenario.expectations
        missed = unmet(expectations, self.scenario.world, self._track) if expectations is not None else []
        achieved = None if expectations is None else not missed and not should_fail(expectations)
        steps = self._track[-1].step
        result = Result(verdict.believed, achieved, verdict.verdict, verdict.reason, steps, tuple(map(str, missed)))
        self._log.write(result.line)
        return result

    def run(self, watch: Callable[["Session"], None] = lambda session: None) -> Result:
        """Wake, act until finished, and end; `watch` is called after every step."""
        self.wake()
        watch(self)
        while not self.finished:
            self.step()
            watch(self)
        return self.end()

    def _record(self, report: StepReportProtocol) -> EpisodeLine:
        table, number = self.table, len(self._track)
        self._track.append(Snapshot(number, table.utak, dict(table.polygons)))
        self.line = {
            "step": number,
            "action": action_entry(report.command),
            "motion": motion_entry(table.motion),
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
