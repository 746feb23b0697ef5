"""One trial: the robot in one random world, judged, and compared with the truth and with the shortest way."""

import math
import signal
import traceback
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from shapely import Polygon

from benchmarks.harness.beliefs import Score, beliefs, compare, under_fovea
from benchmarks.harness.judging import findings
from benchmarks.harness.knowing import knowing
from benchmarks.harness.narrowness import Narrowness, narrowness
from benchmarks.harness.shortest import free_space, shortest_loop, shortest_way
from benchmarks.harness.stopwatch import Seconds, TimedBody, TimedRobot
from benchmarks.worlds.makers import scenario
from benchmarks.worlds.placing import digital
from benchmarks.worlds.scenes import RandomScenario, write
from utak.kb.body import Body
from utak.kb.task.task import Task
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Result, RobotMaker, Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.sweep.executors.tasks import TaskOutcome, WorkerTask

LOOPS = (4,)  # tasks whose shortest way is a loop
# A trial ends itself after its seconds, unless compiled code does not return. Then its process is ended; a convention.
PROCESS_LIMIT_FACTOR, PROCESS_START_SECONDS = 10, 60


@dataclass(frozen=True)
class Conditions:
    """The conditions of a trial: noise and its seed, path-finder, greatest number of commands and of processor seconds.

    knowing : whether a robot that knows everything is run, too. kind : of the world, see benchmarks.worlds.makers.
    """

    noise: float = 0.0
    seed: int = 0
    paths: str = "skeleton"
    max_steps: int = 200
    seconds: int = 120
    knowing: bool = False
    kind: str = "wide"


@dataclass(frozen=True)
class CampaignTrial:
    """The result of one world.

    Attributes
    ----------
    narrow : the named passage that is too narrow, compared with the truth; None where there is none.
    needed : the number of commands of the same planner when it knows everything; 0 when not tried, or not achieved.
    judged : the judge's findings, None without a judge.
    cycles : the times of each cycle.
    walked, shortest : lengths in squares; nan where there is no such way.
    crash : the last line of an error, if there was one.
    """

    task: int
    seed: int
    possible: bool
    believed: bool = False
    achieved: bool = False
    verdict: str = "crash"
    reason: str = ""
    steps: int = 0
    walked: float = math.nan
    shortest: float = math.nan
    judged: list[str] | None = None
    cycles: list[Seconds] = field(default_factory=list)
    score: Score | None = None
    crash: str = ""
    needed: int = 0
    narrow: Narrowness | None = None

    @property
    def false_done(self) -> bool:
        """Whether the task was believed done, and was not."""
        return self.believed and not self.achieved

    @property
    def right(self) -> bool:
        """Whether the task was achieved where possible, and refused with a reason where impossible."""
        return self.achieved if self.possible else not (self.crash or self.believed or not self.reason)

    @property
    def clean(self) -> bool:
        """Whether nothing went wrong: right, no finding of the judge, and no certain square wrong."""
        return self.right and not self.judged and not (self.score and self.score.wrong)

    def row(self) -> dict[str, Any]:
        """Return the trial as a JSON object."""
        row = asdict(self) | {"score": self.score and self.score._asdict(), "clean": self.clean}
        return {name: None if isinstance(v, float) and not math.isfinite(v) else v for name, v in row.items()}


def trial_of(row: dict[str, Any]) -> CampaignTrial:
    """Return the trial of which `CampaignTrial.row` made a row, also after the row has been JSON text."""
    values = {name: value for name, value in row.items() if name != "clean"}
    for name in ("walked", "shortest"):
        values[name] = math.nan if values[name] is None else values[name]
    values["cycles"] = [Seconds(*cycle) for cycle in values["cycles"]]
    if values["score"] is not None:
        values["score"] = Score(**{**values["score"], "mistaken": tuple(values["score"]["mistaken"])})
    values["narrow"] = None if values["narrow"] is None else Narrowness(*values["narrow"])
    return CampaignTrial(**values)


def trial_task(task: int, seed: int, conditions: Conditions, folder: Path) -> WorkerTask:
    """Return a trial as a task of a worker process; the limit of its process is beyond that of the trial itself."""
    argument = {"task": task, "seed": seed, "conditions": asdict(conditions), "folder": str(folder)}
    seconds = PROCESS_LIMIT_FACTOR * conditions.seconds + PROCESS_START_SECONDS if conditions.seconds else None
    return WorkerTask("benchmarks.harness.trial:trial_row", argument, seconds)


def trial_row(argument: dict[str, Any]) -> dict[str, Any]:
    """Run a trial in a worker process and return its row; the argument is that of `trial_task`."""
    conditions = Conditions(**argument["conditions"])
    return run_trial(argument["task"], argument["seed"], conditions, Path(argument["folder"])).row()


def trial_of_outcome(task: int, seed: int, conditions: Conditions, outcome: TaskOutcome) -> CampaignTrial:
    """Return the trial of a task that has ended; a worker process that died is a crash."""
    if outcome.failure:
        possible = scenario(task, seed, conditions.kind).possible
        return CampaignTrial(task, seed, possible, crash=outcome.reason)
    return trial_of(outcome.value)


class _TooLongError(Exception):
    """The trial took more than its seconds of processor time."""


def run_trial(
    task: int,
    seed: int,
    conditions: Conditions,
    folder: Path,
    watch: Callable[[Session], None] = lambda session: None,
    maker: RobotMaker = make_robot,
) -> CampaignTrial:
    """Make a world, run the robot in it, and judge its episode; errors of the robot end up in the trial."""
    world = scenario(task, seed, conditions.kind)
    place = write(world, folder / world.name)
    try:
        with _alarm(conditions.seconds):
            needed = _needed(world, place, conditions) if conditions.knowing and world.possible else 0
            return replace(_ran(world, place, conditions, watch, maker), needed=needed)
    except Exception as error:  # a crash is a result of the trial
        (place / "crash.txt").write_text(traceback.format_exc())
        frame = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(frame.filename).name}:{frame.lineno}"
        return CampaignTrial(task, seed, world.possible, crash=f"{type(error).__name__}: {error} ({where})")


def _needed(world: RandomScenario, place: Path, conditions: Conditions) -> int:
    """Return the number of commands that the same planner gives when it knows everything; 0 when it fails the task."""
    settings = Settings(conditions.seed, 0.0, conditions.paths, conditions.max_steps)
    with EpisodeLog(place / "knowing.jsonl") as log:
        result = Session(read_scenario(place), settings, knowing(world), log).run()
    return result.steps if result.achieved else 0


def _ran(
    world: RandomScenario, place: Path, conditions: Conditions, watch: Callable[[Session], None], maker: RobotMaker
) -> CampaignTrial:
    robots: list[TimedRobot] = []

    def make(body: Body, told: Task, settings: Settings) -> TimedRobot:
        timed = TimedBody(body)
        robots.append(TimedRobot(maker(timed, told, settings), timed))
        return robots[0]

    settings = Settings(conditions.seed, conditions.noise, conditions.paths, conditions.max_steps)
    track: list[tuple[float, float]] = []
    with EpisodeLog(place / "episode.jsonl") as log:
        session = Session(read_scenario(place), settings, make, log)

        def follow(at: Session) -> None:
            track.append(at.table.utak)
            watch(at)

        result = session.run(follow)
    return _trial(world, place, result, robots[0], session, track)


def _trial(
    world: RandomScenario,
    place: Path,
    result: Result,
    robot: TimedRobot,
    session: Session,
    track: list[tuple[float, float]],
) -> CampaignTrial:
    return CampaignTrial(
        task=world.task,
        seed=world.seed,
        possible=world.possible,
        believed=result.believed,
        achieved=bool(result.achieved),
        verdict=result.verdict,
        reason=result.reason,
        steps=result.steps,
        walked=sum(math.dist(a, b) for a, b in pairwise(track)),
        shortest=_shortest(world),
        judged=findings(place, place / "episode.jsonl"),
        cycles=robot.cycles,
        narrow=narrowness(world, result.reason),
        score=_scored(world, robot.robot, dict(session.table.polygons), track),
    )


def _shortest(world: RandomScenario) -> float:
    if not world.possible or (world.target.is_empty and world.task not in LOOPS) or world.task > max(LOOPS):
        return math.nan
    free = free_space(world.plan.floor, [thing.polygon for thing in world.things], world.utak)
    if world.task in LOOPS:
        return shortest_loop(free, world.utak, world.things[0].polygon.centroid)
    return shortest_way(free, world.utak, world.target)


def _scored(world: RandomScenario, robot: Any, moved: dict[str, Polygon], track: list[tuple[float, float]]) -> Score:
    """Compare the robot's beliefs at the end with the truth at the end."""
    plan = world.plan
    things = {}
    occupied = digital(plan.verge, plan.width, plan.height)
    for thing in world.things:
        polygon = moved.get(thing.name, thing.polygon)
        grid = digital(polygon, plan.width, plan.height)
        occupied |= grid
        if thing.shape != "wall" and polygon.distance(plan.verge) > 0:
            things[thing.name] = (thing.shape, polygon, grid)
    held = beliefs(robot, (world.utak.x, world.utak.y), track[-1], world.heading)
    return compare(held, things, np.asarray(occupied), under_fovea(track, world.heading))


class _alarm:  # noqa: N801
    """A context within which an alarm ends what takes too many seconds of processor time. seconds : 0 for never."""

    def __init__(self, seconds: int) -> None:
        self._seconds = seconds

    def __enter__(self) -> None:
        def ring(number: int, frame: object) -> None:
            raise _TooLongError(f"took more than {self._seconds} s")

        self._before = signal.signal(signal.SIGPROF, ring)
        signal.setitimer(signal.ITIMER_PROF, self._seconds)

    def __exit__(self, *_: object) -> None:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, self._before)
