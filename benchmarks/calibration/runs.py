"""Runs of the robot in which each moment is looked at with the truth beside it."""

import json
import signal
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.calibration.dealt import DealtWorld, made
from benchmarks.calibration.moments import Moment, moment_of
from benchmarks.calibration.truth import TableTruth, frame_of
from benchmarks.claims.asked import Asked
from benchmarks.worlds.scenes import RULES_FILE, write
from utak.geometry.kernels.arrays import XY
from utak.kb.task.task import Task
from utak.kb.world.facts import Places
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings


class LookedAt(NamedTuple):
    """The moment after an impression: belief, truth, and what encodings were given."""

    moment: Moment
    model: Any  # kb.world.model.WorldModel
    places: Places  # the rooms and corners that are believed
    frame: Any  # benchmarks.harness.beliefs.TableFrame
    step: int
    decisions: tuple[tuple[str, tuple[str, ...]], ...]  # what each encoding was given at this step: its name, and facts


class Ended(NamedTuple):
    """The end of a run, with what was noted of it."""

    asked: Asked
    noise: float
    verdict: str  # or "time", or the name of an error
    achieved: bool
    steps: int
    looks: tuple[Any, ...]  # what was noted at the chosen moments, first to last

    @property
    def name(self) -> str:
        """The name of the world, with the noise where there is some."""
        return world_name(self.asked, self.noise)

    def line(self) -> str:
        """Return the end as JSON, without the looks."""
        told = {"world": self.asked.name, "noise": self.noise, "verdict": self.verdict}
        return json.dumps(told | {"achieved": self.achieved, "steps": self.steps})


class TimeOverError(Exception):
    """A run took more than its seconds."""


def world_name(asked: Asked, noise: float) -> str:
    """Return the name of a world, with the noise where there is some."""
    return f"{asked.name} at noise {noise:g}" if noise else asked.name


def numbers(text: str) -> list[float]:
    """Return the numbers that a text has between commas."""
    return [float(part) for part in text.split(",")]


def watched(
    asked: Asked, noise: float, max_steps: int, seconds: int, note: Callable[[LookedAt], Any], parts: int
) -> Ended:
    """Run the robot in a world and return what `note` returned at parts + 1 moments, from the first to the last step.

    seconds : after which a run is ended, and its last step so far counts; 0 for no limit.
    """
    dealt = made(asked)
    taken: list[_Taken] = []
    verdict, achieved = "time", False
    with tempfile.TemporaryDirectory(prefix="utak-calibration-") as folder:
        scenario = read_scenario(write(dealt.world, Path(folder)))
        rules = Path(folder) / RULES_FILE
        kb_files = (str(rules),) if rules.exists() else ()
        settings = Settings(seed=asked.seed, noise=noise, max_steps=max_steps, kb_files=kb_files)
        session = Session(scenario, settings, make_robot, EpisodeLog(None))

        written: dict[tuple[int, int], list[Any]] = {}

        def look(at: Session) -> None:
            taken.append(_taken(at, taken[-1].track if taken else (), _decisions(at.line, written)))

        before = signal.signal(signal.SIGALRM, _ring)
        signal.alarm(seconds)
        try:
            result = session.run(look)
            verdict, achieved = result.verdict, bool(result.achieved)
        except TimeOverError:
            pass
        except Exception as error:  # a run that breaks is a result, too
            verdict = f"{type(error).__name__}: {error}"
        finally:
            signal.alarm(0)
            signal.signal(signal.SIGALRM, before)
    last = len(taken) - 1
    chosen = dict.fromkeys(round(last * part / parts) for part in range(parts + 1)) if taken else {}
    looks = tuple(note(_look(dealt, taken[number])) for number in chosen)
    return Ended(asked, noise, verdict, achieved, max(0, last), looks)


def _ring(number: int, frame: object) -> None:
    raise TimeOverError


def _decisions(
    line: dict[str, Any], written: dict[tuple[int, int], list[Any]]
) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Return what encodings were given at a step. written : decisions of earlier steps, by step and index; added to."""
    step, found = line["step"], []
    for index, entry in enumerate(line["belief"]["solved"]):
        whole = written[tuple(entry[1])] if len(entry) == 2 else entry
        written[step, index] = whole
        found.append((whole[0], tuple(whole[1])))
    return tuple(found)


class _Taken(NamedTuple):
    """A moment as it is kept while the run goes on: afterwards it is compared with the truth, where it is chosen."""

    task: Task
    model: Any  # kb.world.model.WorldModel
    places: Places
    step: int
    facts: tuple[str, ...]
    decisions: tuple[tuple[str, tuple[str, ...]], ...]
    polygons: dict[str, Any]  # of the movable things, table frame
    track: tuple[XY, ...]  # where the robot stood so far, table frame


def _taken(session: Session, track: Sequence[XY], decisions: tuple[tuple[str, tuple[str, ...]], ...]) -> _Taken:
    """Return the present moment of a run."""
    robot: Any = session.robot
    places = Places(robot.decider.rooms, robot.decider.corners)
    facts = tuple(fact.rstrip(".") for fact in session.line["belief"]["facts"])
    now = (*track, session.table.utak)
    polygons, task = dict(session.table.polygons), robot.decider.task
    return _Taken(task, robot.model, places, session.line["step"], facts, decisions, polygons, now)


def _look(dealt: DealtWorld, taken: _Taken) -> LookedAt:
    """Return a moment of a run with the truth beside it."""
    task, model, places, step, facts, decisions, polygons, track = taken
    world = dealt.world
    truth = TableTruth(dealt, polygons, track[-1], track)
    frame = frame_of(model, truth, (world.utak.x, world.utak.y))
    moment = moment_of(task, model, facts, truth, frame, places.rooms)
    return LookedAt(moment, model, places, frame, step, decisions)
