"""One run: the robot wakes in a scenario and acts until he stops, and the truth is written down as it happens."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from geometry.rigid import Motion, Translate
from kb.body import Body, Command, Grasp, Impression, Release, Turn
from kb.source import read_source
from kb.task import Task
from simulator.contents import Thing, World, ring_of
from simulator.embodiment import Embodiment
from simulator.episode import VERSION, EpisodeLog, Line
from simulator.expectation import Snapshot, should_fail, unmet
from simulator.scenario import Scenario
from simulator.tabletop import Tabletop


class StepReport(Protocol):
    """What the robot says after an impression: the command that led to it (None on waking), his belief, and why."""

    @property
    def command(self) -> Command | None: ...
    @property
    def impression(self) -> Impression: ...
    @property
    def belief(self) -> dict[str, Any]: ...
    @property
    def why(self) -> str: ...


class Verdict(Protocol):
    """How the robot judges the end: whether he believes that the task is done, the kind of verdict, and the reason."""

    @property
    def believed(self) -> bool: ...
    @property
    def verdict(self) -> str: ...
    @property
    def reason(self) -> str: ...


class Robot(Protocol):
    """The mind: given a body and a task, it wakes and takes one step after the other."""

    def wake(self) -> StepReport: ...
    def step(self) -> StepReport: ...
    @property
    def finished(self) -> bool: ...
    @property
    def verdict(self) -> Verdict: ...


@dataclass(frozen=True)
class Settings:
    """The options of a run that decide what happens in it."""

    seed: int = 0
    noise: float = 0.0
    paths: str = "skeleton"
    max_steps: int = 200
    kb_files: tuple[str, ...] = ()


RobotMaker = Callable[[Body, Task, Settings], Robot]


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
    def line(self) -> Line:
        """The last line of the episode."""
        names = ("believed", "achieved", "verdict", "reason", "steps")
        return {"result": {name: getattr(self, name) for name in names}}


class Session:
    """A run that is driven step by step; `line` is the last line of the episode so far."""

    def __init__(self, scenario: Scenario, settings: Settings, make: RobotMaker, log: EpisodeLog) -> None:
        self.scenario, self.settings = scenario, settings
        self.table = Tabletop(scenario.world, settings.noise, settings.seed)
        self.robot = make(Embodiment(self.table), scenario.task, settings)
        self.line: Line = {}
        self._log = log
        self._track: list[Snapshot] = []

    def wake(self) -> Line:
        """Write the header, let the robot wake, and write step 0."""
        self._log.write(header(self.scenario, self.settings))
        return self._record(self.robot.wake())

    def step(self) -> Line:
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

    def _record(self, report: StepReport) -> Line:
        table, number = self.table, len(self._track)
        self._track.append(Snapshot(number, table.utak, dict(table.polygons)))
        self.line = {
            "step": number,
            "action": action_entry(report.command),
            "motion": motion_entry(table.motion),
            "utak": list(table.utak),
            "held": table.held,
            "objects": {name: [list(point) for point in ring_of(shape)] for name, shape in table.polygons.items()},
            "retina": list(report.impression.retina),
            "touch": list(report.impression.touch),
            "belief": report.belief,
            "why": report.why,
        }
        self._log.write(self.line)
        return self.line


def action_entry(command: Command | None) -> Line | None:
    """Return a command as an episode states it, in Utak's frame."""
    if command is None:
        return None
    do = type(command).__name__.lower()
    if isinstance(command, Grasp):
        return {"do": do, "direction": command.direction}
    if isinstance(command, Turn):
        return {"do": do, "degrees": command.degrees}
    if isinstance(command, Release):
        return {"do": do}
    return {"do": do, "east": command.east, "north": command.north}


def motion_entry(motion: Motion | None) -> Line | None:
    """Return what really happened as an episode states it, in the table's frame."""
    if motion is None:
        return None
    if isinstance(motion, Translate):
        return {"translate": [motion.dx, motion.dy]}
    return {"rotate": motion.degrees, "about": list(motion.about)}


def header(scenario: Scenario, settings: Settings) -> Line:
    """Return the first line of an episode: options, world and task, without times or paths."""
    world, task = scenario.world, scenario.task
    rules = [read_source(path).text for path in settings.kb_files]
    options = {
        "seed": settings.seed,
        "noise": settings.noise,
        "paths": settings.paths,
        "max_steps": settings.max_steps,
        "kb": [hashlib.sha256(text.encode()).hexdigest() for text in rules],
    }
    told = {
        "parameters": {name: parameter.kind for name, parameter in task.parameters.items()},
        "claims": [[str(claim.fact), claim.confidence] for claim in task.claims],
        "goals": [str(goal) for goal in task.goals],
        "expect": None if scenario.expectations is None else [str(fact) for fact in scenario.expectations],
    }
    return {"utak": "episode", "version": VERSION, "options": options, "world": _world_entry(world), "task": told}


def _world_entry(world: World) -> Line:
    def entry(thing: Thing) -> Line:
        return {"colour": thing.colour, "rings": _rings(thing.polygon)}

    return {
        "table": [world.width, world.height],
        "heading": world.heading,
        "verge": [_rings(part) for part in getattr(world.verge, "geoms", [world.verge]) if not part.is_empty],
        "fixed": {thing.name: entry(thing) for thing in world.fixed},
        "movable": {thing.name: entry(thing) for thing in world.movable},
    }


def _rings(polygon: Any) -> list[list[list[float]]]:
    """The outer ring and the holes of a polygon, each without its repeated last point."""
    rings = [polygon.exterior, *polygon.interiors]
    return [[[float(x), float(y)] for x, y in ring.coords[:-1]] for ring in rings]


def kb_files_named(paths: list[str]) -> tuple[str, ...]:
    """Return the rule files of --kb, each read once to make sure that it can be."""
    for path in paths:
        read_source(Path(path))
    return tuple(paths)
