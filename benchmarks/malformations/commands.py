"""Malformed files given to commands, in this process and in processes of their own, as a user gives them."""

import io
import random
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from benchmarks.malformations.episodes import recorded_episodes, spoil_episode
from benchmarks.malformations.imports import write_malformed_file
from benchmarks.malformations.outcomes import came_out
from utak.launcher import PROJECT_FOLDER, isolated_command
from utak.simulator.cli.main import main
from utak.simulator.cli.parsing import build_parser

PROCESS_SECONDS = (
    60.0  # seconds until a process counts as hung: Python starts in one or two on a busy core; a convention
)
PLACED = re.compile(r"^[^\n]*:\d+:\d+-\d+: error: [^\n]+", re.MULTILINE)
OUTCOMES_BY_CODE = {0: "accepted", 1: "accepted", 65: "refused", 66: "cannot open", 75: "given up"}
# Commands that read an episode without a process of their own; those that this version does not have are left out.
EPISODE_COMMANDS = (
    ["replay", "EPISODE", "--text"], ["replay", "EPISODE", "--html", "PAGE", "--force"], ["explain", "EPISODE"],
    ["explain", "EPISODE", "node(o1)", "--at", "1"], ["explain", "EPISODE", "--cell", "40", "--json"],
    ["query", "EPISODE", "held(X)", "--at", "0", "--dump-asp", "FOLDER", "--force"], ["repl", "EPISODE"],
    ["plan", "EPISODE"],
)  # fmt: skip
PROMPT_INPUT = b"show\nstep\nfacts\nstep 3\nshow\n?- node(X).\nrun\n"


def given_to(command: list[str], stdin: bytes = b"") -> str:
    """Return what came of a command in a process of its own; a fault begins with an exclamation mark.

    command : the arguments of `utak`. stdin : what it reads.
    """
    words = isolated_command("utak.simulator.cli", *command)
    try:
        found = subprocess.run(
            words, input=stdin, capture_output=True, timeout=PROCESS_SECONDS, check=False, cwd=PROJECT_FOLDER
        )
    except subprocess.TimeoutExpired:
        return "! hung"
    return _outcome(found.returncode, (found.stdout + found.stderr).decode("utf-8", "replace"))


def _outcome(code: int, said: str) -> str:
    """Return what came of a command. code : its exit code. said : what it printed."""
    if "Traceback" in said or "bug of ours" in said:
        return f"! a bug of ours: {said[-300:]!r}"
    if code not in OUTCOMES_BY_CODE:
        return f"! exit code {code}: {said[-300:]!r}"
    if code == 65 and not PLACED.search(said):
        return f"! a refusal without place: {said[-300:]!r}"
    return OUTCOMES_BY_CODE[code]


def given_here(command: list[str]) -> str:
    """Return what came of a command in this process; a fault begins with an exclamation mark.

    command : the arguments of `utak`.
    """
    said, codes = io.StringIO(), list[int]()

    def run() -> None:
        with redirect_stdout(said), redirect_stderr(said):
            codes.append(main(command))

    before, sys.stdin = sys.stdin, io.TextIOWrapper(io.BytesIO(PROMPT_INPUT))
    try:
        result = came_out(run)
    finally:
        sys.stdin = before
    return _outcome(codes[0], said.getvalue()) if codes else result


def in_this_process(count: int, seed: int, keep: Path) -> Counter[str]:
    """Count the outcomes of `count` commands that read an episode, each of them on a malformed one.

    count, seed : how many, and the seed. keep : a folder for the files; faulty ones are kept.
    """
    known = set(_command_names())
    commands = [words for words in EPISODE_COMMANDS if words[0] in known]
    outcomes: Counter[str] = Counter()
    good = recorded_episodes()
    for number in range(count):
        draw = random.Random(f"command-{seed}-{number}")
        path = keep / f"command-{seed}-{number}.jsonl"
        path.write_bytes(spoil_episode(draw, draw.choice(good)))
        fill = {"EPISODE": str(path), "FOLDER": str(keep / "out"), "PAGE": str(keep / "page.html")}
        words = [fill.get(word, word) for word in commands[number % len(commands)]]
        result = given_here(words)
        outcomes[result] += 1
        if result.startswith("!"):
            print(f"{' '.join(words)}: {result}", file=sys.stderr)
        else:
            path.unlink()
    return outcomes


def _command_names() -> list[str]:
    """Return the names of the commands of `utak`."""
    return re.findall(r"^    (\w+) ", build_parser().format_help(), re.MULTILINE)


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
