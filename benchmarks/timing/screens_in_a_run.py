"""Count the screens that a run makes, what they cost, and what changing the one before instead would save.

    python -m benchmarks.timing.screens_in_a_run [SCENARIO ...] [--steps N] [--seed N]

Utak runs each scenario once. One line a scenario: commands, the processor's milliseconds of a command, and of all
screens how many a command makes (`screens`), the share of the time that making them takes (`building`), and the share
that all questions to them take (`asking`: `passages`, `parts`, `narrows`, `routes` and the like).

Then the screens are made once more, those of each module in their order: anew, as in the run, and by ``Screen.changed``
from the one before wherever that has the same shape. `followed` is the share of screens for which that is so, `changed`
the median share of their squares that differ, `anew` and `by change` the milliseconds for all screens, and `saved` the
share of the run's time that changing would save. Every scenario runs once before anything is timed.
"""

import argparse
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from geometry import Screen
from geometry.kernels.arrays import Bools
from simulator.episode.episode import EpisodeLog
from simulator.run.robots import make_robot
from simulator.run.session import Session
from simulator.scenario.scenario import read_scenario
from simulator.scenario.settings import Settings

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SCENARIOS = ("go_northeast_rooms", "go_next_room_hidden_door", "push_square_three_rooms")
SCREEN_QUESTIONS = ("routes", "shortest", "tighten", "loops", "passages", "narrows", "parts")
HEADS = ("commands", "ms each", "screens", "building", "asking", "followed", "changed", "anew", "by change", "saved")
REPLAYS = 5  # of the screens of a run, each way; the quickest counts


class ScreensOfRun(NamedTuple):
    """Screens of a run: what was made of them, and the time it took.

    Attributes
    ----------
    commands : number of commands.
    total : the processor's seconds of the run.
    building, asking : seconds of these in which screens were made, and in which they were asked.
    made : (rows, columns) bool arrays of free squares, by the module that made a screen of them, in order.
    """

    commands: int
    total: float
    building: float
    asking: float
    made: dict[str, list[Bools]]


class ScreenReplay(NamedTuple):
    """The screens of a run made again.

    Attributes
    ----------
    anew, by_change : seconds for all screens, made anew or changed from the one before.
    shares : of the screens that follow one of the same shape, the share of squares that differ from it.
    """

    anew: float
    by_change: float
    shares: list[float]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line for each scenario."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenarios", nargs="*", type=Path, default=[EXAMPLES / name for name in SCENARIOS])
    parser.add_argument("--steps", type=int, default=200, help="commands at most (%(default)s)")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    print(f"{'scenario':28}" + "".join(f"{head:>10}" for head in HEADS))
    for folder in given.scenarios:
        settings = Settings(seed=given.seed, max_steps=given.steps)
        run_once(folder, settings)  # kernels, encodings and the memory of screens are warm then
        run = run_once(folder, settings)
        again = replay(run.made)
        count = sum(map(len, run.made.values()))
        row = (
            f"{run.commands:10} {1e3 * run.total / run.commands:9.1f} {count / run.commands:9.2f} "
            f"{run.building / run.total:9.2%} {run.asking / run.total:9.2%} {len(again.shares) / count:9.0%} "
            f"{float(np.median(again.shares or [0.0])):9.2%} {1e3 * again.anew:9.2f} {1e3 * again.by_change:9.2f} "
            f"{(again.anew - again.by_change) / run.total:9.3%}"
        )
        print(f"{folder.name:28}{row}", flush=True)
    return 0


def run_once(folder: Path, settings: Settings) -> ScreensOfRun:
    """Return what a run of the scenario in a folder did with screens."""
    session = Session(read_scenario(folder), settings, make_robot, EpisodeLog(None))
    with watched_screens() as (seconds, made):
        begun = time.process_time()
        result = session.run()
        total = time.process_time() - begun
    return ScreensOfRun(max(1, result.steps), total, seconds["building"], seconds["asking"], made)


@contextmanager
def watched_screens() -> Iterator[tuple[dict[str, float], dict[str, list[Bools]]]]:
    """Note all screens that are made, and the processor's seconds of building and asking them, while this lasts."""
    seconds: dict[str, float] = {"building": 0.0, "asking": 0.0}
    made: dict[str, list[Bools]] = defaultdict(list)
    whole: Any = Screen
    kept = {name: whole.__dict__[name] for name in ("__init__", *SCREEN_QUESTIONS)}

    def timed(name: str, kind: str) -> Callable[..., Any]:
        def call(screen: Screen, *args: Any, **kwargs: Any) -> Any:
            if name == "__init__":
                made[sys._getframe(1).f_globals["__name__"]].append(np.array(args[0]))
            begun = time.process_time()
            try:
                return kept[name](screen, *args, **kwargs)
            finally:
                seconds[kind] += time.process_time() - begun

        return call

    try:
        for name in kept:
            setattr(whole, name, timed(name, "building" if name == "__init__" else "asking"))
        yield seconds, made
    finally:
        for name, method in kept.items():
            setattr(whole, name, method)


def replay(made: dict[str, list[Bools]]) -> ScreenReplay:
    """Make the screens of a run again, anew and by change, each several times."""
    anew, by_change = [], []
    for _ in range(REPLAYS):
        begun = time.process_time()
        for grids in made.values():
            for free in grids:
                Screen(free)
        between = time.process_time()
        for grids in made.values():
            changed_in_turn(grids)
        anew.append(between - begun)
        by_change.append(time.process_time() - between)
    shares = [
        float((one != other).mean())
        for grids in made.values()
        for one, other in pairwise(grids)
        if one.shape == other.shape
    ]
    return ScreenReplay(min(anew), min(by_change), shares)


def changed_in_turn(grids: Sequence[Bools]) -> None:
    """Change one screen to each of some floors in turn; where the shape is another, make a new one."""
    screen, before = None, None
    for free in grids:
        if screen is None or before is None or before.shape != free.shape:
            screen = Screen(free)
        else:
            rows, columns = np.nonzero(before != free)
            screen.changed(rows, columns, free[rows, columns])
        before = free


if __name__ == "__main__":
    sys.exit(main())
