"""Claims against the truth: a `done` that is not achieved, and an `impossible` to which a plan is known.

A task is known to be possible by the construction of its world, or by a search that knows the true world. The search is
a program beside the judge (see benchmarks.harness.judging), `countersearch.py SCENARIO --seconds S --plan`. It exits
with 0 when it has found a plan, 1 when it has not, and 2 when it cannot tell what the goal means.
"""

import json
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from shapely import LineString
from shapely.geometry.base import BaseGeometry

from benchmarks.harness.judging import judge_path

MAX_SHOWN_CHARACTERS = 80  # characters of an expectation that a page can hold
ANSWERS = {0: "solvable", 1: "not found", 2: "unsupported"}


class Countersearch(NamedTuple):
    """The answer of a search that knows the true world: solvable, not found, unsupported or absent; and the plan."""

    answer: str
    way: str = ""


class Claims(NamedTuple):
    """Which claims of a run are false, and what refutes them."""

    false_done: bool
    false_impossible: bool
    refutation: str


def searched(folder: Path, seconds: int, pull: bool = True) -> Countersearch:
    """Search for a plan in the scenario of a folder with the true world known, for at most `seconds`.

    pull : whether a held object may be pulled.
    """
    judge = judge_path()
    program = judge and judge.with_name("countersearch.py")
    if program is None or not program.is_file():
        return Countersearch("absent")
    call = [sys.executable, str(program), str(folder), "--seconds", str(seconds), "--plan"]
    call += ["--no-pull"] * (not pull)
    try:
        done = subprocess.run(call, capture_output=True, text=True, timeout=10 * seconds + 60)
    except subprocess.TimeoutExpired:
        return Countersearch("not found")
    answer = ANSWERS.get(done.returncode, "unsupported")
    return Countersearch(answer, done.stdout.strip() if answer == "solvable" else "")


def trespassed(episode: Path, avoid: BaseGeometry) -> bool:
    """Return whether the robot was ever in the region `avoid` (table frame) by an episode.

    It moves straight from one place to the next.
    """
    if avoid.is_empty:
        return False
    lines = [json.loads(line) for line in episode.read_text().splitlines()]
    track = [line["utak"] for line in lines if "step" in line]
    return bool(LineString([*track, track[-1]]).intersects(avoid))


def refuted(
    verdict: str, believed: bool, achieved: bool, unmet: list[str], possible: str, search: Countersearch
) -> Claims:
    """Hold a run's claims against what is true at its end and against what can be done."""
    false_done = (believed or verdict == "done") and not achieved
    solvable = possible == "yes" or search.answer == "solvable"
    false_impossible = verdict == "impossible" and solvable
    said = []
    if false_done:
        said.append("not so at the end: " + ("; ".join(map(_short, unmet)) or "it cannot be done"))
    if false_impossible:
        said.append("it can be done " + (f"so: {search.way}" if search.way else "by construction"))
    return Claims(false_done, false_impossible, ". ".join(said))


def _short(fact: str) -> str:
    """Return a fact with no more than the first corners of its region."""
    return fact if len(fact) <= MAX_SHOWN_CHARACTERS else fact[:MAX_SHOWN_CHARACTERS] + " ..."
