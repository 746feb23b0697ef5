"""The size of replay pages, and how fast a browser plays them.

    python -m benchmarks.episodes.replay [EP.jsonl ...] [--steps 500,5000] [--noise 0.05]

For each episode, and for long ones that are put together from runs of one example with noise, one line: the bytes of
the episode and of its page, the processor's seconds to make it, and in headless Chromium the processor's milliseconds
until the first picture (the best of three) and of a seek (median and worst of some steps in random order).
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
from pathlib import Path
from typing import Any

from benchmarks.harness.browser import CHROMIUM, Browser
from simulator.cli.main import main as utak
from simulator.episode.episode import Episode, EpisodeLine, encode, read_episode
from simulator.replay.page import replay_page

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "push_l_tight_door"  # with noise it takes many steps
RUNS = 3  # of the example, with different seeds, of which long episodes are made
SEEKS = 100  # steps that are looked at in random order
HEAD = f"{'episode':<32} steps   episode      page a step     s  first  seek worst"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.episodes.replay", description="Size and speed of replay pages."
    )
    parser.add_argument("episodes", nargs="*", type=Path, help="episodes to measure")
    parser.add_argument("--steps", default="500,5000", help="lengths of made episodes (default %(default)s)")
    parser.add_argument(
        "--noise", default="0.05", help="noise of the runs that they are made from (default %(default)s)"
    )
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        print(HEAD)
        for path in given.episodes:
            print(measured(path.stem, read_episode(path), Path(folder)), flush=True)
        lengths = [int(part) for part in given.steps.split(",") if part]
        if lengths:
            whole = long_episode(max(lengths), given.noise, Path(folder))
            for steps in lengths:
                name = f"{EXAMPLE.name}, noise {given.noise}"
                print(measured(name, Episode(whole.header, whole.steps[:steps], None), Path(folder)), flush=True)
    return 0


def measured(name: str, episode: Episode, folder: Path) -> str:
    """Return the line of one episode; `folder` is for the page."""
    before = time.process_time()
    page = replay_page(episode)
    seconds = time.process_time() - before
    path = folder / "page.html"
    path.write_text(page, encoding="utf-8")
    size, steps = len(page.encode()), len(episode.steps)
    raw = sum(len(encode(line)) for line in (episode.header, *episode.steps))
    first, middle, worst = timed(path, steps) if CHROMIUM else (math.nan, math.nan, math.nan)
    row = f"{name[:32]:<32} {steps:>5} {raw:>9} {size:>9} {size / steps:>6.0f} {seconds:>5.1f}"
    return f"{row} {first:>6.0f} {middle:>5.1f} {worst:>5.1f}"


def timed(page: Path, steps: int) -> tuple[float, float, float]:
    """Return the processor's milliseconds for the first picture of a page, and of a seek: median and worst."""
    chance = random.Random(0)
    first, seeks = [], []
    with Browser() as browser:
        for _ in range(3):
            browser.open(page)
            first.append(browser.busy())
        for _ in range(SEEKS):
            before = browser.busy()
            browser.run(f"utak.player.show({chance.randrange(steps)}); document.body.getBoundingClientRect(); 0")
            seeks.append(browser.busy() - before)
    return min(first), statistics.median(seeks), max(seeks)


def long_episode(steps: int, noise: str, folder: Path) -> Episode:
    """Return an episode of so many steps: runs of one example with other seeds, again and again."""
    runs = []
    for seed in range(RUNS):
        path = folder / f"{seed}.jsonl"
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            utak(["run", str(EXAMPLE), "--noise", noise, "--seed", str(seed), "--max-steps", "500", "--log", str(path)])
        runs.append(read_episode(path))
    found: list[EpisodeLine] = []
    while len(found) < steps:
        for run in runs:
            places = [line["belief"].get("place") for line in found]
            found += moved_back(run.steps, len(found), places)
    return Episode(runs[0].header, tuple(found[:steps]), None)


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
