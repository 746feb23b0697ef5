"""One run of the robot in a task, within bounds of commands and processor time, judged by the truth."""

import json
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from shapely import Point, Polygon

from benchmarks.claims.refute import Countersearch, refuted, searched
from benchmarks.harness.judging import findings
from benchmarks.orders.asked import AskedRun
from benchmarks.orders.carried_out import does_task
from benchmarks.orders.row import (
    CAN_BE_DONE,
    MAY_BE_DONE,
    RUN_BROKE,
    RUN_OUT_OF_TIME,
    OrderRow,
    RunBounds,
    row_of_entry,
)
from benchmarks.orders.search import search
from benchmarks.worlds.scenes import write
from benchmarks.worlds.several.kinds import several_world
from benchmarks.worlds.several.tasks import SeveralWorld, stages_reached
from utak.kb.language.goal_words import ROBOT
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Result, RobotMaker, Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.sweep.executors.tasks import TOO_LONG, TaskOutcome, WorkerTask, reason_of

EPISODE_NAME = "episode.jsonl"
# A run ends itself after its processor seconds, unless compiled code does not return, or the machine is busy with other
# work. Then its process is ended: after so many times the seconds of run and search by the clock, and so many more.
PROCESS_FACTOR, PROCESS_EXTRA_SECONDS = 4, 180
SECONDS_BETWEEN_ALARMS = 5.0  # until the alarm is raised again, should code have swallowed it


class RunTooLongError(Exception):
    """Raised in a run that has used up its processor time."""


def run_task(asked: AskedRun, bounds: RunBounds, folder: Path) -> WorkerTask:
    """Return a run as a task of a worker process. folder : where its scenario and its episode are written."""
    argument = {"asked": asked._asdict(), "bounds": asdict(bounds), "folder": str(folder)}
    seconds = PROCESS_FACTOR * (bounds.seconds + bounds.search) + PROCESS_EXTRA_SECONDS
    return WorkerTask("benchmarks.orders.run:run_entry", argument, seconds)


def run_entry(argument: dict[str, Any]) -> dict[str, Any]:
    """Run a task in a worker process and return its row as a JSON object; the argument is that of `run_task`."""
    asked, bounds = AskedRun(**argument["asked"]), RunBounds(**argument["bounds"])
    return run_order(asked, bounds, Path(argument["folder"])).entry()


def row_of_outcome(asked: AskedRun, bounds: RunBounds, folder: Path, outcome: TaskOutcome) -> OrderRow:
    """Return the row of a run that has ended in a worker process.

    When the process was ended, or ended itself, the row holds how many commands were given and the time by the clock.
    """
    if not outcome.failure:
        return row_of_entry(outcome.value)
    return replace(
        _first_row(asked, bounds),
        verdict=RUN_OUT_OF_TIME if outcome.failure == TOO_LONG else RUN_BROKE,
        reason=outcome.reason,
        took=round(outcome.seconds, 1),
        commands=max(0, len(list(_track(place_of(asked, folder) / EPISODE_NAME))) - 1),
    )


def place_of(asked: AskedRun, folder: Path) -> Path:
    """Return the folder of a run."""
    return folder / f"{asked.kind}-{asked.name}"


def run_order(asked: AskedRun, bounds: RunBounds, folder: Path, maker: RobotMaker = make_robot) -> OrderRow:
    """Run the robot in a task and return the row. folder : where the scenario and the episode are written."""
    place, known = place_of(asked, folder), _first_row(asked, bounds)
    place.mkdir(parents=True, exist_ok=True)
    (place / EPISODE_NAME).unlink(missing_ok=True)
    if asked.folder:
        return _judged(known, None, Path(asked.folder), place / EPISODE_NAME, bounds, maker)
    world = several_world(asked.kind, int(asked.name))
    write(world, place)
    known = replace(known, variant=world.variant)
    found = search(world, bounds.search, bounds.pull)
    if found.way and does_task(world, found.way):
        known = replace(known, possible=CAN_BE_DONE, carries=found.carries)
    return _judged(known, world, place, place / EPISODE_NAME, bounds, maker)


def _first_row(asked: AskedRun, bounds: RunBounds) -> OrderRow:
    """Return the row of a run before anything is found out about it."""
    possible = CAN_BE_DONE if asked.solvable and bounds.pull else MAY_BE_DONE
    return OrderRow(asked.kind, asked.name, asked.variant, bounds.pull, bounds.max_steps, bounds.seconds, possible)


def _judged(
    known: OrderRow, world: SeveralWorld | None, scenario: Path, episode: Path, bounds: RunBounds, maker: RobotMaker
) -> OrderRow:
    """Run the robot and return the row with all that is found out about the run.

    known : the row so far. world : of a random task. scenario : its folder. episode : the file that is written.
    """
    begun, broke = time.process_time(), ""
    try:
        result = _ran(scenario, episode, bounds, maker)
    except Exception as error:  # a crash is the result of the run
        result, broke = None, "" if _is_too_long(error) else reason_of(error)
    took = round(time.process_time() - begun, 1)
    track = list(_track(episode))
    row = replace(known, took=took, commands=max(0, len(track) - 1), verdict=RUN_OUT_OF_TIME)
    met, wanted = _met(world, track)
    row = replace(row, met=met, wanted=wanted, carried=carries_made(episode))
    if broke:
        return replace(row, verdict=RUN_BROKE, reason=broke)
    if result is None:
        return replace(row, reason=f"more than {bounds.seconds} s of processor time")
    achieved = bool(result.achieved) and met == wanted
    unmet = [*result.unmet, *([f"{met} of {wanted} steps or goals are reached"] if met != wanted else [])]
    counter = Countersearch("")
    if result.verdict == "impossible" and row.possible != CAN_BE_DONE:
        counter = searched(scenario, bounds.search, bounds.pull)
    claims = refuted(result.verdict, result.believed, achieved, unmet, row.possible, counter)
    return replace(
        row,
        verdict=result.verdict,
        reason=result.reason,
        believed=result.believed,
        achieved=achieved,
        judged=findings(scenario, episode),
        false_done=claims.false_done,
        false_impossible=claims.false_impossible,
        refutation=claims.refutation,
    )


def _ran(scenario: Path, episode: Path, bounds: RunBounds, maker: RobotMaker) -> Result | None:
    """Run the robot and write its episode; None when it takes more than its processor seconds."""
    settings = Settings(max_steps=bounds.max_steps, pull=bounds.pull)
    with EpisodeLog(episode) as log, suppress(RunTooLongError), _processor_limit(bounds.seconds):
        return Session(read_scenario(scenario), settings, maker, log).run()
    return None


def _is_too_long(error: BaseException | None) -> bool:
    """Return whether an error comes of the alarm. Where it rings in compiled code, Python makes another one of it."""
    while error is not None and not isinstance(error, RunTooLongError):
        error = error.__cause__ or error.__context__
    return error is not None


@contextmanager
def _processor_limit(seconds: float) -> Iterator[None]:
    """Raise RunTooLongError within the context when this process has used so many seconds of the processor.

    Where Python drops all exceptions, such as in a callback of its garbage collector, the next alarm raises it.
    """

    def ring(number: int, frame: object) -> None:
        raise RunTooLongError(f"more than {seconds} s of processor time")

    def drop(lost: "sys.UnraisableHookArgs") -> None:
        if not issubclass(lost.exc_type, RunTooLongError):
            dropped_before(lost)

    alarm_before, dropped_before = signal.signal(signal.SIGPROF, ring), sys.unraisablehook
    sys.unraisablehook = drop
    signal.setitimer(signal.ITIMER_PROF, seconds, SECONDS_BETWEEN_ALARMS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, alarm_before)
        sys.unraisablehook = dropped_before


def _track(episode: Path) -> Iterator[dict[str, Any]]:
    """Yield how everything lay at each step of an episode, by name, squares, table frame; nothing without a file."""
    for entry in _steps(episode):
        yield {ROBOT: Point(entry["utak"]), **{name: Polygon(ring) for name, ring in entry["objects"].items()}}


def _steps(episode: Path) -> Iterator[dict[str, Any]]:
    """Yield the lines of the steps of an episode; nothing without a file. An incomplete line is left out."""
    if not episode.is_file():
        return
    with episode.open() as lines:
        for line in lines:
            with suppress(json.JSONDecodeError):
                entry = json.loads(line)
                if "step" in entry:
                    yield entry


def carries_made(episode: Path) -> int:
    """Return how often the robot took something in hand and moved it before it let go, by an episode."""
    count, moved = 0, False
    for entry in _steps(episode):
        if entry["held"] is None:
            moved = False
        elif entry["motion"] is not None and not moved:
            count, moved = count + 1, True
    return count


def _met(world: SeveralWorld | None, track: list[dict[str, Any]]) -> tuple[int, int]:
    """Return how much of what a task wants is reached, and how much it wants; (0, 0) where that is not known."""
    if world is None or not track:
        return 0, 0
    if len(world.stages) > 1:
        return stages_reached(world.stages, track), len(world.stages)
    return sum(want.holds(track[-1]) for want in world.stages[0]), len(world.stages[0])
