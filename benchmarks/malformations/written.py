"""Malformed files that we wrote, and read again or overwrite: pages, results of sweeps, compiled kernels."""

import json
import random
import shutil
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmarks.malformations.episodes import HOSTILE_VALUES
from benchmarks.malformations.mutate import spoil_bytes
from benchmarks.malformations.outcomes import came_out
from utak.geometry.kernels.cache import SEAL, SealedFile
from utak.simulator.episode.output_files import is_episode, is_gif, is_junit, is_svg, write_whole
from utak.simulator.replay.page import is_page
from utak.simulator.sweep.results import Results

PAGES = (
    b"<!-- a run -->\n<!DOCTYPE html>\n<html><head><title>x</title></head></html>\n",
    b'<?xml version="1.0"?>\n<!-- a -->\n<!DOCTYPE svg>\n<svg xmlns="http://www.w3.org/2000/svg"></svg>\n',
    b'<?xml version="1.0"?><testsuites><testsuite/></testsuites>\n',
    b'{"utak":"episode","version":1}\n',
)
HOSTILE_STARTS = tuple(start * 20_000 for start in (b"<!--", b"<!-- a -->\n", b"<?xml ", b" ", b"<!DOCTYPE "))
ROWS = [{"seed": n, "noise": 0.0, "steps": 9} for n in range(4)]
RESULTS = b"".join(json.dumps(row).encode() + b"\n" for row in ROWS[:3])
STAMP = (1.0, 2)  # of a kernel's sources


class _Place:
    """Numba's own object for the files of one kernel, as far as ours reads it."""

    def __init__(self, folder: Path) -> None:
        self._cache_path, self._index_name, self._source_stamp = str(folder), "kernel.nbi", None


def _page(path: Path, draw: random.Random) -> None:
    """Write a malformed page or picture, and overwrite it as a command does."""
    raw = spoil_bytes(draw, draw.choice(PAGES))
    path.write_bytes(draw.choice(HOSTILE_STARTS) + raw if draw.random() < 0.1 else raw)
    write_whole(path, b"new", draw.choice([is_page, is_svg, is_junit, is_gif, is_episode]), "file")


def _results(path: Path, draw: random.Random) -> None:
    """Write malformed results of a sweep, and go on with them."""
    raw = spoil_bytes(draw, RESULTS)
    if draw.random() < 0.5:
        lines = RESULTS.splitlines()
        row = json.loads(lines[number := draw.randrange(len(lines))])
        row[draw.choice(sorted(row))] = "\x00"
        lines[number] = json.dumps(row).replace('"\\u0000"', draw.choice(HOSTILE_VALUES)).encode()
        raw = b"\n".join(lines) + b"\n"
    path.write_bytes(raw)
    results = Results(path, ("seed", "noise"))
    for row in ROWS:
        if (row["seed"], row["noise"]) not in results.known:
            results.append(row)
    results.close()
    again = Results(path, ("seed", "noise"))
    again.close()
    if again.known != results.known or len(again.known) < len(ROWS):
        raise AssertionError("results that are not whole")


def _kernel(path: Path, draw: random.Random) -> None:
    """Spoil the cache of a kernel; what is read from it is what was saved, or nothing."""
    path.mkdir()
    files = SealedFile(_Place(path), None, STAMP)
    good = {"code": list(range(50))}
    files.save("key", good)
    for name in draw.sample(sorted(path.iterdir()), draw.choice([1, 1, 2])):
        raw = name.read_bytes()
        spoilt = raw[: draw.randrange(len(raw))] if draw.random() < 0.3 else spoil_bytes(draw, raw)
        if SEAL in spoilt or draw.random() < 0.5:
            name.write_bytes(spoilt)
        else:
            name.write_bytes(raw.partition(SEAL)[0][: draw.randrange(20)])
    try:
        found: Any = files.load("key")
    except OSError:
        found = None
    if found not in (None, good):
        raise AssertionError(f"a kernel that was not saved: {found!r}")
    files.save("key", good)
    if files.load("key") != good:
        raise AssertionError("a cache that is not made anew")


WRITTEN_KINDS: tuple[Callable[[Path, random.Random], None], ...] = (_page, _results, _kernel)


def written(count: int, seed: int, keep: Path) -> Counter[str]:
    """Count the outcomes of `count` malformed files that we wrote; faulty ones are kept in `keep`."""
    outcomes: Counter[str] = Counter()
    for number in range(count):
        draw, path = random.Random(f"{seed}-{number}"), keep / f"written-{seed}-{number}"
        use = draw.choice(WRITTEN_KINDS)
        result = came_out(lambda use=use, path=path, draw=draw: use(path, draw))  # type: ignore[misc]
        outcomes[f"{result} ({use.__name__[1:]})" if result.startswith("!") else result] += 1
        if result.startswith("!"):
            print(f"{path}: {result}", file=sys.stderr)
        elif path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)
    return outcomes
