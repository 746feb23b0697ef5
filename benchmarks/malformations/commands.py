"""Malformed files given to commands in processes of their own, as a user gives them."""

import random
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from benchmarks.malformations.episodes import PROJECT_FOLDER, recorded_episodes, spoil_episode
from benchmarks.malformations.imports import write_malformed_file

PROCESS_SECONDS = (
    60.0  # seconds until a process counts as hung: Python starts in one or two on a busy core; a convention
)
PLACED = re.compile(r"^[^\n]*:\d+:\d+-\d+: error: [^\n]+", re.MULTILINE)
OUTCOMES_BY_CODE = {0: "accepted", 1: "accepted", 65: "refused", 66: "cannot open", 75: "given up"}
PROMPT_INPUT = b"show\nstep\nfacts\nstep 3\nshow\n?- node(X).\nrun\n"


def given_to(command: list[str], stdin: bytes = b"") -> str:
    """Return what came of a command in a process of its own; a fault begins with an exclamation mark.

    command : the arguments of `utak`. stdin : what it reads.
    """
    words = [sys.executable, "-m", "simulator.cli", *command]
    try:
        found = subprocess.run(
            words, input=stdin, capture_output=True, timeout=PROCESS_SECONDS, check=False, cwd=PROJECT_FOLDER
        )
    except subprocess.TimeoutExpired:
        return "! hung"
    said = (found.stdout + found.stderr).decode("utf-8", "replace")
    if "Traceback" in said or "bug of ours" in said:
        return f"! a bug of ours: {said[-300:]!r}"
    if found.returncode not in OUTCOMES_BY_CODE:
        return f"! exit code {found.returncode}: {said[-300:]!r}"
    if found.returncode == 65 and not PLACED.search(said):
        return f"! a refusal without place: {said[-300:]!r}"
    return OUTCOMES_BY_CODE[found.returncode]


def in_processes(
    count: int, seed: int, keep: Path, write_scenario: Callable[[Path, random.Random], None]
) -> Counter[str]:
    """Count the outcomes of `count` commands, in turn check, query, repl and import, each on a malformed file.

    count, seed : how many, and the seed. keep : a folder for the files. write_scenario : writes a malformed scenario.
    """
    outcomes: Counter[str] = Counter()
    good = recorded_episodes()
    for number in range(count):
        draw = random.Random(f"process-{seed}-{number}")
        place = keep / f"process-{seed}-{number}"
        command = ("check", "query", "repl", "import")[number % 4]
        if command == "check":
            write_scenario(place, draw)
            result = given_to(["check", str(place)])
        elif command == "import":
            path = write_malformed_file(place, draw)
            result = given_to(["import", str(path), str(place / "scenario")])
        else:
            place.mkdir()
            path = place / "ep.jsonl"
            path.write_bytes(spoil_episode(draw, draw.choice(good)))
            arguments = [str(path), "node(X)", "--at", "1"] if command == "query" else [str(path)]
            result = given_to([command, *arguments], PROMPT_INPUT)
        outcomes[result] += 1
        if result.startswith("!"):
            print(f"{place}: utak {command}: {result}", file=sys.stderr)
    return outcomes
