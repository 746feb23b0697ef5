"""Worlds in which the task cannot be done, by kinds: what the robot says, and whether a certificate shows it."""

import json
import shutil
import subprocess
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.claims.asked import ASKED_KINDS, Asked, named, worlds_of, written
from benchmarks.claims.child import EPISODE_FILE, RESULT_FILE
from benchmarks.claims.refute import searched
from benchmarks.claims.run import Limits, run_child
from benchmarks.worlds.makers import seeds
from benchmarks.worlds.odd.tasks import NO
from utak.simulator.certificates.checker import verify
from utak.simulator.certificates.courses import RefusedError
from utak.simulator.certificates.search import NoCertificateError, certificate_of

SECONDS = 60  # of the processor, of a run
SEARCH_SECONDS = 10  # for a way, by a search that knows the world
VERDICTS_HELD = ("impossible", "possible_if")  # after which a certificate of `impossible` is looked for
OWN_TASKS = {"own_snug": (5, 6, 7, 8, 9), "own_wide": (1, 2, 3, 4)}
SECOND = Path(__file__).resolve().parents[2] / "simulator" / "replay" / "page_parts" / "certificate.js"


@dataclass(frozen=True)
class UnableRow:
    """The result of a world in which the task cannot be done.

    Attributes
    ----------
    why : why it cannot be done.
    certificate : accepted by both checkers, or why there is none.
    refuted : a search that knows the world found a way, so the world is no such world, or the verdict is false.
    """

    world: str
    why: str
    verdict: str
    reason: str
    certificate: str
    refuted: bool
    seconds: float


def unable_worlds(count: int, seed: int, folder: Path) -> Iterator[Asked]:
    """Yield so many worlds of each kind, those from a seed on in which the task cannot be done, kinds in turn."""
    own = [[Asked(k, s, task) for s in seeds(seed, count, unable=True)] for k in OWN_TASKS for task in OWN_TASKS[k]]
    kinds = [worlds_of([kind], seed, 12 * count) for kind in ASKED_KINDS]
    odd = [[one for one in kind if written(one, folder).possible == NO][:count] for kind in kinds]
    for number in range(count):
        yield from (kind[number] for kind in [*odd, *own] if len(kind) > number)


def unable_row(asked: Asked, folder: Path) -> UnableRow:
    """Run the robot in a world, look for a certificate that its task is impossible, and check it twice."""
    begun, place = time.perf_counter(), folder / asked.name.replace(":", "-")
    known = written(asked, place)
    ended = run_child(place, Limits(seconds=SECONDS))
    result = place / RESULT_FILE
    told = json.loads(result.read_text()) if result.exists() else {"verdict": ended, "reason": ""}
    found = _certificate(place) if told["verdict"] in VERDICTS_HELD else "none: the run did not come to an end"
    is_refuted = "accepted" in found or told["verdict"] == "impossible"
    is_refuted = is_refuted and searched(place, SEARCH_SECONDS).answer == "solvable"
    shutil.rmtree(place)
    seconds = round(time.perf_counter() - begun, 1)
    return UnableRow(asked.name, known.why.split(":")[0], told["verdict"], told["reason"], found, is_refuted, seconds)


def _certificate(place: Path) -> str:
    """Return that both checkers accept the certificate of an episode, or why there is none."""
    episode, certificate = place / EPISODE_FILE, place / "certificate.json"
    text = "".join(line for line in episode.read_text().splitlines(keepends=True) if line.endswith("}\n"))
    try:
        certificate.write_text(certificate_of(text.splitlines(keepends=True), "impossible"))
        told = verify(text, certificate.read_text())
    except (NoCertificateError, RefusedError, ValueError) as why:
        return f"none: {why}"
    episode.write_text(text)
    node = shutil.which("node") or shutil.which("nodejs")
    second = node and subprocess.run([node, SECOND, episode, certificate], capture_output=True, text=True).stdout
    return f"accepted: {told}" if second is None or second.startswith("accepted") else f"NOT BY BOTH: {told}"


def run_unable(count: int, seed: int, output: Path | None) -> int:
    """Print what comes of worlds in which the task cannot be done; with a file, those that it has are not run again."""
    lines = output.read_text().splitlines() if output and output.exists() else []
    rows = [UnableRow(**json.loads(line)) for line in lines if line.endswith("}")]
    had = {row.world for row in rows}
    with tempfile.TemporaryDirectory(prefix="utak-unable-") as name:
        for asked in [one for one in unable_worlds(count, seed, Path(name) / "asked") if one.name not in had]:
            row = unable_row(asked, Path(name))
            rows.append(row)
            print(row.world, row.verdict, row.certificate[:100], f"{row.seconds} s", flush=True)
            if output:
                with output.open("a") as file:
                    file.write(json.dumps(asdict(row)) + "\n")
    print(unable_table(rows), end="")
    return int(any(row.refuted or "NOT BY BOTH" in row.certificate for row in rows))


def unable_table(rows: list[UnableRow]) -> str:
    """Return a table by kinds: the verdicts, and of `impossible` and of all others the certificates."""
    lines = [f"{'kind':14}{'worlds':>8}{'impossible':>12}{'shown':>7}{'other':>7}{'shown':>7}{'refuted':>9}"]
    kinds = Counter(named(row.world).kind for row in rows)
    for kind in [*sorted(kinds), ""]:
        ours = [row for row in rows if named(row.world).kind == kind or not kind]
        impossible = [row for row in ours if row.verdict == "impossible"]
        other = [row for row in ours if row.verdict != "impossible"]
        shown = [sum(row.certificate.startswith("accepted") for row in some) for some in (impossible, other)]
        numbers = f"{len(ours):8}{len(impossible):12}{shown[0]:7}{len(other):7}{shown[1]:7}"
        lines.append(f"{kind or 'all':14}{numbers}{sum(row.refuted for row in ours):9}")
    return "\n".join(lines) + "\n"
