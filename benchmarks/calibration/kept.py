"""Runs with their statements as JSON lines, so that a table grows over many programs."""

import json
from collections.abc import Sequence
from pathlib import Path

from benchmarks.calibration.runs import Ended
from benchmarks.calibration.statements import HeldStatement
from benchmarks.calibration.table import Held


def run_line(ended: Ended, held: Sequence[Held]) -> str:
    """Return a run as a line of JSON: its name, how it ended, and its statements."""
    told = json.loads(ended.line()) | {"name": ended.name}
    return json.dumps(told | {"statements": [[step, *statement] for _, step, statement in held]})


def read_runs(path: Path) -> dict[str, list[Held]]:
    """Return the statements of the runs in a file by the names of their worlds."""
    found = map(json.loads, path.read_text().splitlines())
    return {
        run["name"]: [Held(run["name"], step, HeldStatement(*statement)) for step, *statement in run["statements"]]
        for run in found
    }
