"""Kills `utak run` and `utak sweep` at random moments, and checks what is left: python -m benchmarks.episodes.killing.

    python -m benchmarks.episodes.killing [--count 200] [--seed N] [--what run,sweep,worker] [--scenario FOLDER]
        [--keep FOLDER]

`run` and `sweep` kill the command itself; `worker` kills one of the worker processes of a sweep. Each time:

- the file is readable: all lines that are complete are well-formed
- at most the step (of a sweep: the runs) under way is lost: what the command had reported as done is in the file
- no process of the command is left over
- the same command, with --resume for `run`, ends with the same exit code and leaves the same lines as a command that
  was not killed, and a sweep repeats no run that the file has (a killed worker: the sweep itself ends so)

The table goes to stdout, progress and faults to stderr. The exit code is 1 when there was a fault.
"""

import argparse
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.launcher import isolated_command
from utak.simulator.episode.episode import read_episode
from utak.simulator.sweep.results import complete_result_lines
from utak.simulator.terminal import exits

SCENARIO_FOLDER = Path(__file__).resolve().parents[2] / "examples" / "go_next_room"
RUN_OPTIONS = ("--noise", "0.05", "--seed", "3")
SWEEP_OPTIONS = ("--noise", "0,0.05", "--seeds", "0:3", "--jobs", "2")
LATEST_MOMENT = 1.1  # times the duration of a command that is not killed: the last moments are after its end
MAX_COMMAND_SECONDS = 300.0  # after which a command hangs; a convention
MAX_ORPHAN_SECONDS = 5.0  # until processes that a killed command had started have ended; a convention
KILL_SIGNAL = getattr(signal, "SIGKILL", signal.SIGTERM)  # Windows has none; its SIGTERM cannot be handled either


class Reference(NamedTuple):
    """A command that was not killed: its exit code, the bytes of its file, and how many seconds it took."""

    code: int
    contents: bytes
    seconds: float


class Killed(NamedTuple):
    """A command after a kill: its exit code, whether it was still running, what it printed, and whom it left over."""

    code: int
    running: bool
    errors: str
    orphans: list[int]


def run_command(scenario: Path, file: Path, *more: str) -> list[str]:
    """Return the command line of a run."""
    return isolated_command(
        "utak.simulator.cli", "run", str(scenario), *RUN_OPTIONS, "--log", str(file), "--watch", *more
    )


def sweep_command(scenario: Path, file: Path) -> list[str]:
    """Return the command line of a sweep."""
    return isolated_command("utak.simulator.cli", "sweep", str(scenario), *SWEEP_OPTIONS, "-o", str(file))


def finish(command: Sequence[str], file: Path) -> Reference:
    """Run a command to its end. Raises RuntimeError when it breaks."""
    begun = time.monotonic()
    ended = subprocess.run(command, capture_output=True, text=True, timeout=MAX_COMMAND_SECONDS, check=False)
    if ended.returncode not in (exits.SUCCESS, exits.NOT_REACHED, exits.LIMIT):
        raise RuntimeError(f"exit code {ended.returncode}: {ended.stderr[-500:]}")
    return Reference(ended.returncode, file.read_bytes() if file.exists() else b"", time.monotonic() - begun)


def kill_after(
    command: Sequence[str],
    seconds: float,
    draw: random.Random,
    a_worker: bool = False,
    max_orphan_seconds: float = MAX_ORPHAN_SECONDS,
) -> Killed:
    """Start a command, kill it or one of its worker processes after some seconds, and wait for its end."""
    with (
        tempfile.TemporaryFile("w+") as errors,  # no pipe: that would be open as long as a process that is left over
        subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors) as process,
    ):
        time.sleep(seconds)
        running = process.poll() is None
        descendants = sorted(descendants_of(process.pid))
        with suppress(ProcessLookupError):
            if not a_worker:
                process.kill()
            elif descendants:
                os.kill(draw.choice(descendants), KILL_SIGNAL)
        process.wait(timeout=MAX_COMMAND_SECONDS)
        errors.seek(0)
        printed = errors.read()
    return Killed(process.returncode, running, printed, still_there(descendants, max_orphan_seconds))


def descendants_of(pid: int) -> Iterator[int]:
    """Yield the processes that a process has started, and those that they have started."""
    found = subprocess.run(["ps", "-A", "-o", "pid=,ppid="], capture_output=True, text=True, check=True)
    children: dict[int, list[int]] = {}
    for line in found.stdout.splitlines():
        child, parent = map(int, line.split())
        children.setdefault(parent, []).append(child)
    waiting = list(children.get(pid, []))
    while waiting:
        one = waiting.pop()
        yield one
        waiting += children.get(one, [])


def still_there(pids: Sequence[int], seconds: float = MAX_ORPHAN_SECONDS) -> list[int]:
    """Return those processes that are still there after some seconds."""
    end = time.monotonic() + seconds
    while True:
        left = [pid for pid in pids if _is_alive(pid)]
        if not left or time.monotonic() > end:
            return left
        time.sleep(0.02)


def _is_alive(pid: int) -> bool:
    """Return whether a process runs; one that has ended, but was not waited for, does not."""
    found = subprocess.run(["ps", "-p", str(pid), "-o", "stat="], capture_output=True, text=True, check=False)
    return found.stdout.strip() not in ("",) and not found.stdout.strip().startswith("Z")


def run_faults(scenario: Path, file: Path, reference: Reference, moment: float, draw: random.Random) -> Iterator[str]:
    """Kill a run, and yield what is wrong with what is left."""
    killed = kill_after(run_command(scenario, file), moment, draw)
    yield from lost_steps(killed, file)
    again = finish(run_command(scenario, file, *(["--resume"] if file.exists() else [])), file)
    yield from _differences(again, reference, killed)


def lost_steps(killed: Killed, file: Path) -> Iterator[str]:
    """Yield that steps were lost which a killed run had reported as done. Raises BadInputError for a damaged file."""
    reported = len(re.findall(r"^step \d+: ", killed.errors, re.MULTILINE))
    recorded = len(read_episode(file).steps) if file.exists() and b"\n" in file.read_bytes() else 0
    if recorded < reported:
        yield f"{reported} steps were reported, {recorded} are in the file"


def sweep_faults(scenario: Path, file: Path, reference: Reference, moment: float, draw: random.Random) -> Iterator[str]:
    """Kill a sweep, and yield what is wrong with what is left."""
    killed = kill_after(sweep_command(scenario, file), moment, draw)
    recorded = complete_result_lines(file) if file.exists() else []
    again = finish(sweep_command(scenario, file), file)
    if not again.contents.startswith(b"".join(recorded)):
        yield "runs that were recorded are not kept"
    yield from _differences(again, reference, killed)


def worker_faults(
    scenario: Path, file: Path, reference: Reference, moment: float, draw: random.Random
) -> Iterator[str]:
    """Kill a worker process of a sweep, and yield what is wrong with the end of the sweep."""
    killed = kill_after(sweep_command(scenario, file), moment, draw, a_worker=True)
    contents = file.read_bytes() if file.exists() else b""
    yield from _differences(Reference(killed.code, contents, 0.0), reference, killed)


def _differences(found: Reference, wanted: Reference, killed: Killed) -> Iterator[str]:
    """Yield what differs from a command that was not killed."""
    if found.code != wanted.code:
        yield f"the exit code is {found.code}, not {wanted.code}"
    if _comparable(found.contents) != _comparable(wanted.contents):
        yield "the file has other contents"
    if killed.orphans:
        yield f"the processes {killed.orphans} are left over"


def _comparable(contents: bytes) -> list[bytes]:
    """Return lines without the seconds of runs; those of a sweep stand in the order in which runs ended."""
    lines = [re.sub(rb',"seconds":[0-9.]+', b"", line) for line in contents.splitlines()]
    return sorted(lines) if contents.startswith(b'{"run"') else lines


Faults = Callable[[Path, Path, Reference, float, random.Random], Iterator[str]]
KILL_KINDS: dict[str, tuple[Faults, Callable[[Path, Path], list[str]]]] = {
    "run": (run_faults, run_command),
    "sweep": (sweep_faults, sweep_command),
    "worker": (worker_faults, sweep_command),
}


def campaign(kind: str, count: int, seed: int, scenario: Path, folder: Path) -> int:
    """Kill commands of a kind at random moments, print a line for each fault, and return the number of faulty kills."""
    faults, command = KILL_KINDS[kind]
    warming_up = folder / f"{kind}-warming-up.jsonl"
    finish(command(scenario, warming_up), warming_up)
    reference = finish(command(scenario, folder / f"{kind}.jsonl"), folder / f"{kind}.jsonl")
    draw = random.Random(f"{kind} {seed}")
    faulty = 0
    for number in range(count):
        moment = draw.uniform(0.0, LATEST_MOMENT * reference.seconds)
        file = folder / f"{kind}-{number}.jsonl"
        try:
            found = list(faults(scenario, file, reference, moment, draw))
        except (BadInputError, CannotOpenError, RuntimeError, subprocess.TimeoutExpired) as error:
            found = [f"{type(error).__name__}: {error}"]
        faulty += bool(found)
        for fault in found:
            print(f"{kind} {number}, killed after {moment:.3f} s: {fault}", file=sys.stderr, flush=True)
        if not found:
            file.unlink(missing_ok=True)
        if number % 20 == 19:
            print(f"{kind}: {number + 1} of {count}, {faulty} with faults", file=sys.stderr, flush=True)
    print(f"{kind:8}{count:7} kills from 0 to {LATEST_MOMENT * reference.seconds:.1f} s, {faulty} with faults")
    return faulty


def main(arguments: Sequence[str] | None = None) -> int:
    """Kill commands of each kind; return 0 when nothing was wrong, else 1."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.episodes.killing", description="Kill runs and sweeps.")
    parser.add_argument("--count", type=int, default=200, help="kills of each kind (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of the moments (%(default)s)")
    parser.add_argument("--what", default="run,sweep,worker", help="kinds, with commas between (%(default)s)")
    parser.add_argument("--scenario", type=Path, default=SCENARIO_FOLDER, help="a short scenario (%(default)s)")
    parser.add_argument("--keep", type=Path, help="folder in which the files of faulty kills stay")
    given = parser.parse_args(arguments)
    unknown = sorted(set(given.what.split(",")) - set(KILL_KINDS))
    if unknown:
        parser.error(f"no kind {', '.join(unknown)}: kinds are {', '.join(KILL_KINDS)}")
    with tempfile.TemporaryDirectory(prefix="utak-killing-") as made:
        folder = given.keep or Path(made)
        folder.mkdir(parents=True, exist_ok=True)
        kinds = given.what.split(",")
        faulty = [campaign(kind, given.count, given.seed, given.scenario, folder) for kind in kinds]
    return int(any(faulty))


if __name__ == "__main__":
    sys.exit(main())
