"""The size of replay pages, and how fast a browser plays them.

    python -m benchmarks.episodes.replay [EP.jsonl ...] [--examples NAME,...] [--steps 500,5000] [--noise 0.05]
        [--runs FOLDER]

For each episode, and for long ones that are put together from runs of an example with noise, one line: the bytes of
the episode and of its page, and the processor's seconds to make it; then milliseconds of the page's main thread in
headless Chromium: until the first picture (the best of three), and of a seek (median and worst). Each seek is made in
three rounds, of which the best one counts. The page of the first example is made with all lengths, those of the others
with the first length alone.

Runs differ by their seeds. They are repeated only when they have MIN_STEPS_OF_RUNS steps together.
"""

import argparse
import contextlib
import io
import math
import random
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.harness.browser import CHROMIUM, Browser
from utak.simulator.cli.main import main as utak
from utak.simulator.episode.episode import Episode, EpisodeLine, encode, read_episode
from utak.simulator.replay.page import replay_page

FOLDER = Path(__file__).resolve().parents[2] / "examples"
# With noise these take many steps, and their steps need the most bytes; the first one is the one measured at length.
LONG_EXAMPLES = ("push_l_tight_door", "push_square_blocked_door", "push_l_next_room")
MAX_RUN_STEPS = 150  # of one run; a convention
MIN_STEPS_OF_RUNS = 500
SEEKS = 100  # steps that are looked at in random order
ROUNDS = 3  # in which the same is done; the best time of each seek counts, as other work on the machine disturbs
HEAD = f"{'episode':<36} steps   episode      page a step    s  first  seek worst"


class SeekTimes(NamedTuple):
    """Milliseconds of the page's main thread."""

    first: float = math.nan  # until the first picture
    seek: float = math.nan  # of a seek, median and worst
    worst: float = math.nan


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.episodes.replay", description="Size and speed of replay pages."
    )
    parser.add_argument("episodes", nargs="*", type=Path, help="episodes to measure")
    parser.add_argument("--examples", default=",".join(LONG_EXAMPLES), help="of which episodes are made")
    parser.add_argument("--steps", default="500,5000", help="lengths of made episodes (default %(default)s)")
    parser.add_argument(
        "--noise", default="0.05", help="noise of the runs that they are made from (default %(default)s)"
    )
    parser.add_argument("--runs", type=Path, help="a folder in which runs are kept, and looked for (default: none)")
    given = parser.parse_args(arguments)
    lengths = [int(part) for part in given.steps.split(",") if part]
    examples = [name for name in given.examples.split(",") if name] if lengths else []
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.html"
        print(HEAD)
        for path in given.episodes:
            show(path.stem, read_episode(path), page)
        for name in examples:
            some = lengths if name == examples[0] else lengths[:1]
            whole = long_episode(name, max(some), given.noise, given.runs or Path(folder))
            for steps in some:
                made = Episode(whole.header, whole.steps[:steps], None)
                show(f"{name}, noise {given.noise}", made, page)
    return 0


def show(name: str, episode: Episode, page: Path) -> None:
    """Print the line of an episode; `page` is where its page is written."""
    before = time.process_time()
    text = replay_page(episode)
    seconds = time.process_time() - before
    page.write_text(text, encoding="utf-8")
    size, steps = len(text.encode()), len(episode.steps)
    raw = sum(len(encode(line)) for line in (episode.header, *episode.steps))
    t = timed(page, steps) if CHROMIUM else SeekTimes()
    row = f"{name[:36]:<36} {steps:>5} {raw:>9} {size:>9} {size / steps:>6.0f} {seconds:>4.1f}"
    print(f"{row} {t.first:>6.0f} {t.seek:>5.1f} {t.worst:>5.1f}", flush=True)


def timed(page: Path, steps: int) -> SeekTimes:
    """Return what the processor does for a page: see the docstring of this module."""
    chance = random.Random(0)
    wanted = [chance.randrange(steps) for _ in range(SEEKS)]
    first = []
    with Browser() as browser:
        for _ in range(ROUNDS):
            browser.open(page)
            first.append(browser.busy())
        rounds = [[seek(browser, step) for step in wanted] for _ in range(ROUNDS)]
    best = list(map(min, zip(*rounds, strict=True)))
    return SeekTimes(min(first), statistics.median(best), max(best))


def seek(browser: Browser, step: int) -> float:
    """Return the processor's milliseconds to show a step, with its styles and its layout."""
    before = browser.busy()
    browser.run(f"utak.player.show({step}); document.body.getBoundingClientRect(); 0")
    return browser.busy() - before


def long_episode(example: str, steps: int, noise: str, folder: Path) -> Episode:
    """Return an episode of so many steps: runs of an example with different seeds, which are kept in a folder."""
    runs: list[Episode] = []
    enough = min(steps, MIN_STEPS_OF_RUNS)
    for seed in count():
        if sum(len(run.steps) for run in runs) >= enough:
            break
        runs.append(one_run(example, noise, seed, folder))
    found: list[EpisodeLine] = []
    while len(found) < steps:
        for run in runs:
            places = [line["belief"].get("place") for line in found]
            found += moved_back(run.steps, len(found), places)
    return Episode(runs[0].header, tuple(found[:steps]), None)


def one_run(example: str, noise: str, seed: int, folder: Path) -> Episode:
    """Return a run of an example; it is looked for in a folder, and kept there."""
    path = folder / f"{example}-{noise}-{seed}.jsonl"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        options = ["--noise", noise, "--seed", str(seed), "--max-steps", str(MAX_RUN_STEPS), "--log", str(path)]
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            utak(["run", str(FOLDER / example), *options])
    return read_episode(path)


def moved_back(lines: Sequence[EpisodeLine], by: int, places: list[Any]) -> Iterator[EpisodeLine]:
    """Yield the lines of an episode as if `by` steps, at these believed places, came before."""
    for line in lines:
        belief = dict(line["belief"])
        if "seen_from" in belief:
            belief["seen_from"] = places + belief["seen_from"]
        if "map_from" in belief:
            belief["map_from"] += by
        if "solved" in belief:
            belief["solved"] = [
                [entry[0], [entry[1][0] + by, entry[1][1]]] if len(entry) == 2 else entry for entry in belief["solved"]
            ]
        yield line | {"step": line["step"] + by, "belief": belief}


if __name__ == "__main__":
    sys.exit(main())
