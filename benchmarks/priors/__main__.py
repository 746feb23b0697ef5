"""Count priors in random worlds and write the files of priors in kb/asp, or one in planner/asp.

    python -m benchmarks.priors --worlds 250 --seed 5000 [--noise 0,0.05] [--samples FILE] [--to kb/asp]
    python -m benchmarks.priors --walls ...      (planner/asp/priors_of_walls.lp)
    python -m benchmarks.priors --looks ...      (planner/asp/priors_of_looks.lp)

Worlds are of all kinds, dealt as benchmarks.calibration deals them; give another seed than there. Every moment counts
alike: the first step, the last one, and those in between that part the run evenly. With --walls two of three worlds
have doorways that things fill, there is no noise, and the moments are all those at which walls are felt. With --looks
the worlds are those of tasks 3, 5, 6 and 9 of benchmarks.worlds.makers, and the moments all at which the robot chooses
where to look. Progress goes to stderr. --samples keeps what was measured, a JSON line a moment; with --recount it is
counted again, for other bins, without any run.
"""

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.calibration.dealt import dealt
from benchmarks.calibration.runs import LookedAt, numbers, watched
from benchmarks.claims.asked import Asked
from benchmarks.harness.judging import CHECKOUT
from benchmarks.priors.count import (
    Counted,
    counted_classes,
    counted_joints,
    counted_kinds,
    counted_looks,
    counted_movables,
    counted_pieces,
    counted_places,
    counted_squares,
    counted_stretches,
    counted_walls,
    counted_whereabouts,
)
from benchmarks.priors.looks import LookSeen, looks_seen, with_things
from benchmarks.priors.measures import (
    FitSeen,
    PlaceSeen,
    RegionSeen,
    TriedSeen,
    fits_seen,
    places_seen,
    regions_seen,
    tried_seen,
)
from benchmarks.priors.walls import WallSeen, walls_seen, with_plugs
from benchmarks.priors.whereabouts import (
    MeasuredSeen,
    PieceSeen,
    WhereaboutSeen,
    joints_seen,
    pieces_seen,
    squares_seen,
    stretches_seen,
    whereabouts_seen,
)
from benchmarks.priors.written import places_text, text
from utak.simulator.run.warming import warm_all

KB_FILES, PLANNER_FILES = CHECKOUT / "kb" / "asp", CHECKOUT / "planner" / "asp"


class CountedMoment(NamedTuple):
    """The things of one moment that are counted."""

    regions: tuple[RegionSeen, ...]
    fits: tuple[FitSeen, ...]
    tried: tuple[TriedSeen, ...]
    places: tuple[PlaceSeen, ...]
    whereabouts: tuple[WhereaboutSeen, ...]
    pieces: tuple[PieceSeen, ...]
    joints: tuple[MeasuredSeen, ...]
    stretches: tuple[MeasuredSeen, ...]
    squares: tuple[MeasuredSeen, ...]


MEASURES: Sequence[tuple[Callable[[LookedAt], Iterator[Any]], Callable[..., Any]]] = (  # in the order of CountedMoment
    (regions_seen, RegionSeen),
    (fits_seen, FitSeen),
    (tried_seen, TriedSeen),
    (places_seen, PlaceSeen),
    (whereabouts_seen, WhereaboutSeen),
    (pieces_seen, PieceSeen),
    (joints_seen, MeasuredSeen),
    (stretches_seen, MeasuredSeen),
    (squares_seen, MeasuredSeen),
)


def noted(look: LookedAt) -> CountedMoment:
    """Return what is counted of a moment."""
    return CountedMoment(*(tuple(seen(look)) for seen, _ in MEASURES))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the worlds, count, and write the files; return 0."""
    given = _parser().parse_args(arguments)
    deciding, moments = DECIDING.get(given.counting), list[Any]()
    note, read = (deciding.noted, deciding.read) if deciding else (noted, _read)
    if given.recount:
        moments = [read(line) for line in given.samples.read_text().splitlines()]
    else:
        warm_all()
    dealing = deciding.dealt(given.worlds, given.seed) if deciding else dealt(given.worlds, given.seed, given.noise)
    parts = given.max_steps if deciding else given.parts
    for number, (asked, noise) in enumerate(() if given.recount else dealing, 1):
        ended = watched(asked, noise, given.max_steps, given.seconds, note, parts)
        moments += ended.looks
        if given.samples:
            with given.samples.open("a") as file:
                file.writelines(json.dumps(moment) + "\n" for moment in ended.looks)
        print(f"{number}/{given.worlds} {ended.line()}", file=sys.stderr, flush=True)
    command = (
        f"python -m benchmarks.priors{f' --{given.counting}' if deciding else ''} --worlds {given.worlds} "
        f"--seed {given.seed} --max-steps {given.max_steps} --seconds {given.seconds}"
    )
    if deciding:
        files = deciding.written(moments, command, given.worlds)
    else:
        command += f" --parts {given.parts} --noise {','.join(f'{noise:g}' for noise in given.noise)}"
        files = written(moments, [command, f"{given.worlds} worlds of all kinds"])
    for name, lines in files.items():
        ((given.to or (PLANNER_FILES if deciding else KB_FILES)) / name).write_text(lines)
    return 0


def written(moments: Sequence[CountedMoment], told: Sequence[str]) -> Mapping[str, str]:
    """Return the texts of the files of priors that some moments give, by name. told : how they were made."""
    regions, fits, tried, places, whereabouts, pieces, joints, stretches, squares = (
        list(chain.from_iterable(seen)) for seen in zip(*moments, strict=True)
    )
    *command, worlds = told
    what = f"{worlds}, {len(moments)} moments"
    kinds = f"{what}, {len(regions)} regions, {len(fits)} things with fits"
    there = f"{what}, {len(whereabouts)} places, {len(pieces)} pairs of pieces, {len(joints)} parts of floors"
    there += f", {len(stretches)} stretches, {len(squares)} squares"
    things = [*counted_kinds(regions), *counted_classes(fits), *counted_movables(tried)]
    may_be = [
        *(*counted_whereabouts(whereabouts), *counted_pieces(pieces)),
        *(*counted_joints(joints), *counted_stretches(stretches), *counted_squares(squares)),
    ]
    return {
        "priors.lp": text(things, [*command, kinds], "interpretation.lp, shapes.lp and movable.lp"),
        "priors_of_whereabouts.lp": text(may_be, [*command, there], "chances.lp"),
        "priors_of_places.lp": places_text(
            [*counted_places(places)], [*command, f"{what}, {len(places)} facts about places"]
        ),
    }


def _read(line: str) -> CountedMoment:
    """Return a moment from its line of JSON."""
    found = zip(MEASURES, json.loads(line), strict=True)
    moment = CountedMoment(*(tuple(kind(*one) for one in seen) for (_, kind), seen in found))
    return moment._replace(fits=tuple(fit._replace(fits=tuple(map(tuple, fit.fits))) for fit in moment.fits))


class Deciding(NamedTuple):
    """A count of what the robot chooses among: in which worlds, of what, and into which file."""

    file: str
    dealt: Callable[[int, int], Iterator[tuple[Asked, float]]]  # worlds, by their number and a seed
    seen: Callable[[LookedAt], Iterator[Any]]
    row: type[Any]  # of what was seen, a named tuple
    counted: Callable[[Iterable[Any]], Iterator[Counted]]
    whole: str  # the encoding of which the file is a part
    worlds: str  # which worlds, in words

    def written(self, moments: Sequence[Sequence[Any]], command: str, worlds: int) -> Mapping[str, str]:
        """Return the text of the file, by its name."""
        seen = f"{sum(map(bool, moments))} decisions, {sum(map(len, moments))} choices"
        counted = [*self.counted(chain.from_iterable(moments))]
        return {self.file: text(counted, [command, f"{worlds} worlds, {self.worlds}; {seen}"], self.whole)}

    def noted(self, look: LookedAt) -> tuple[Any, ...]:
        """Return what is counted of a moment."""
        return tuple(self.seen(look))

    def read(self, line: str) -> tuple[Any, ...]:
        """Return a moment from its line of JSON."""
        return tuple(self.row(*one) for one in json.loads(line))


DECIDING = {
    "walls": Deciding(
        file="priors_of_walls.lp",
        dealt=with_plugs,
        seen=walls_seen,
        row=WallSeen,
        counted=counted_walls,
        whole="deciding",
        worlds="two of three of benchmarks.plugs, the others of all kinds",
    ),
    "looks": Deciding(
        file="priors_of_looks.lp",
        dealt=with_things,
        seen=looks_seen,
        row=LookSeen,
        counted=counted_looks,
        whole="the search for things",
        worlds="of tasks 3, 5, 6 and 9",
    ),
}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.priors", description="Count priors in random worlds.")
    parser.add_argument("--worlds", type=int, default=250, help="how many (%(default)s)")
    parser.add_argument("--seed", type=int, default=5000, help="of the worlds (%(default)s)")
    parser.add_argument("--noise", type=numbers, default=[0.0, 0.05], help="with commas, in turn")
    parser.add_argument("--max-steps", type=int, default=60, help="most commands (%(default)s)")
    parser.add_argument("--seconds", type=int, default=600, help="most seconds a world, 0 for no limit (%(default)s)")
    parser.add_argument("--parts", type=int, default=6, help="into how many parts moments part a run (%(default)s)")
    parser.add_argument("--samples", type=Path, help="what was measured, a JSON line a moment; added to")
    parser.add_argument("--recount", action="store_true", help="count again what --samples holds; the rest as it was")
    parser.add_argument("--to", type=Path, help="the folder of the files (kb/asp, or planner/asp)")
    instead = parser.add_mutually_exclusive_group()
    for name, what in (("walls", "walls that are felt"), ("looks", "looks for things")):
        instead.add_argument(
            f"--{name}", dest="counting", action="store_const", const=name, default="", help=f"count {what}, instead"
        )
    return parser


if __name__ == "__main__":
    sys.exit(main())
