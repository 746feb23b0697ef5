"""One world from its folder to its row: written, run in its own process, judged, and its claims checked."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from shapely import Polygon

from benchmarks.claims import child
from benchmarks.claims.asked import Asked, written
from benchmarks.claims.refute import Countersearch, refuted, searched, trespassed
from benchmarks.claims.row import ERROR, TIME, ClaimRow
from benchmarks.harness.judging import CHECKOUT, judge_path
from utak.launcher import isolated_command
from utak.simulator.run.warming import warm_all

WARMING_TASKS = (5, 9)  # tasks: walking, and carrying
WALL_CLOCK_FACTOR = (
    6  # times the processor seconds that a run may take by the clock: other programs may be at work as well
)
JUDGING = 300  # seconds
ERRORS = "stderr.txt"
OUT_OF_TIME = (-24, -9)  # SIGXCPU, SIGKILL


@dataclass(frozen=True)
class Limits:
    """The conditions of all runs: noise, its seed, limits of commands, processor time, memory and search.

    pull : whether a held object may be pulled.
    """

    noise: float = 0.0
    noise_seed: int = 0
    max_steps: int = 200
    seconds: int = 120
    megabytes: int = 6000
    search: int = 30
    pull: bool = True


def run_child(place: Path, limits: Limits) -> str:
    """Run the robot in a child process; return what stands in place of a verdict when it left no result."""
    options = {
        "--noise": limits.noise,
        "--noise-seed": limits.noise_seed,
        "--max-steps": limits.max_steps,
        "--seconds": limits.seconds,
        "--megabytes": limits.megabytes,
    }
    given = [part for name, value in options.items() for part in (name, str(value))] + ["--no-pull"] * (not limits.pull)
    call = isolated_command("benchmarks.claims.child", str(place.resolve()), *given)
    with (place / ERRORS).open("w") as errors:
        try:
            done = subprocess.run(
                call, cwd=CHECKOUT, stdout=errors, stderr=errors, timeout=WALL_CLOCK_FACTOR * limits.seconds or None
            )
        except subprocess.TimeoutExpired:
            return TIME
    return TIME if done.returncode in OUT_OF_TIME else ERROR


Runner = Callable[[Path, Limits], str]


def run_world(
    asked: Asked, limits: Limits, folder: Path, keep: Path | None = None, runner: Runner = run_child
) -> ClaimRow:
    """Run a world in a temporary folder and return its row; a copy of what went wrong stays in `keep`.

    runner : runs the robot in a scenario's folder as `run_child` does.
    """
    place = folder / asked.name.replace(":", "-")
    known = written(asked, place)
    ended = runner(place, limits)
    cycles, told = _cycles(place), _result(place)
    steps = told.get("steps", max(0, len(cycles) - 1))
    if not told and ended == TIME:  # the command under way has taken what is left of the seconds, or longer
        cycles.append(max(0.0, limits.seconds - sum(cycles)))
    verdict = told.get("verdict", ended)
    believed, achieved = bool(told.get("believed")), bool(told.get("achieved"))
    unmet = [*told.get("unmet", []), *_misses(place, told)]
    if told and trespassed(place / child.EPISODE_FILE, known.avoid):
        unmet.append("the robot was where the goal forbids it to be")
        achieved = False
    search = searched(place, limits.search, limits.pull) if verdict == "impossible" else Countersearch("")
    claims = refuted(verdict, believed, achieved, unmet, known.possible, search)
    row = ClaimRow(
        kind=asked.kind,
        seed=asked.seed,
        task=asked.task,
        goal=known.task,
        variant=known.variant,
        possible=known.possible,
        noise=limits.noise,
        verdict=verdict,
        reason=told.get("reason", ""),
        believed=believed,
        achieved=achieved,
        commands=steps,
        cycles=cycles[1:],
        judged=judged(place) if told else None,
        countersearch=search.answer,
        false_done=claims.false_done,
        false_impossible=claims.false_impossible,
        refutation=claims.refutation,
        error="" if told else _last_line(place),
    )
    if keep is not None and row.faulty:
        shutil.copytree(place, keep / place.name, dirs_exist_ok=True)
        (keep / place.name / "row.json").write_text(row.line() + "\n")
    shutil.rmtree(place)
    return row


def warm_up(folder: Path) -> None:
    """Compile kernels and run some worlds without limits, so that all are in the cache before any clock runs."""
    warm_all()
    for task in WARMING_TASKS:
        place = folder / f"warming-up-{task}"
        written(Asked("own_wide", 0, task), place)
        run_child(place, Limits(max_steps=20, seconds=0, megabytes=0))
        shutil.rmtree(place)


def _cycles(place: Path) -> list[float]:
    path = place / child.CYCLES_FILE
    return [float(line) for line in path.read_text().splitlines()] if path.exists() else []


def _result(place: Path) -> dict[str, Any]:
    path = place / child.RESULT_FILE
    return dict(json.loads(path.read_text())) if path.exists() else {}


def _misses(place: Path, told: dict[str, Any]) -> list[str]:
    """Return, for a run that does not meet its expectations, where the robot and the objects ended, in squares."""
    if not told.get("unmet"):
        return []
    last = json.loads((place / child.EPISODE_FILE).read_text().splitlines()[-2])
    things = [f"{name} about ({x:.2f}, {y:.2f})" for name, (x, y) in _middles(last["objects"]).items()]
    return ["the robot ended at ({:.2f}, {:.2f})".format(*last["utak"]), *things]


def _middles(objects: dict[str, list[list[float]]]) -> dict[str, tuple[float, float]]:
    return {name: (Polygon(ring).centroid.x, Polygon(ring).centroid.y) for name, ring in sorted(objects.items())}


def _last_line(place: Path) -> str:
    lines = (place / ERRORS).read_text().strip().splitlines()
    return lines[-1] if lines else ""


def judged(place: Path) -> list[str] | None:
    """Run the judge in a process of its own and return its findings; None without a judge."""
    judge = judge_path()
    if judge is None:
        return None
    call = [sys.executable, str(judge), str(place), str(place / child.EPISODE_FILE)]
    try:
        done = subprocess.run(call, capture_output=True, text=True, timeout=JUDGING)
    except subprocess.TimeoutExpired:
        return ["the judge took too long"]
    if done.returncode == 0:
        return []
    return done.stdout.splitlines() or [f"the judge failed: {(done.stderr.splitlines() or [''])[-1]}"]
