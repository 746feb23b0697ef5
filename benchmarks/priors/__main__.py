"""Count priors in random worlds and write kb/asp/priors.lp and kb/asp/priors_of_places.lp.

    python -m benchmarks.priors --worlds 250 --seed 5000 [--noise 0,0.05] [--samples FILE] [-o kb/asp/priors.lp]
                                [--places kb/asp/priors_of_places.lp]
    python -m benchmarks.priors --whereabouts ... [-o kb/asp/priors_of_whereabouts.lp]
    python -m benchmarks.priors --walls ... [-o planner/asp/priors_of_walls.lp]
    python -m benchmarks.priors --looks ... [-o planner/asp/priors_of_looks.lp]

Worlds are of all kinds, dealt as benchmarks.calibration deals them; give another seed than there. Every moment counts
alike: the first step, the last one, and those in between that part the run evenly. With --walls two of
three worlds have doorways that things fill, there is no noise, and the moments are all those at which walls are felt.
With --looks the worlds are those of tasks 3, 5, 6 and 9 of benchmarks.worlds.makers, and the moments all at which the
robot chooses where to look.
Progress goes to stderr. --samples keeps what was measured, a JSON line a moment; with --recount it is counted again,
for other bins, without any run.
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
from benchmarks.calibration.statements import statements
from benchmarks.claims.asked import Asked
from benchmarks.harness.judging import CHECKOUT
from benchmarks.priors.count import (
    Counted,
    counted_classes,
    counted_joints,
    counted_kinds,
    counted_looks,
    counted_pieces,
    counted_places,
    counted_squares,
    counted_stretches,
    counted_walls,
    counted_whereabouts,
)
from benchmarks.priors.looks import LookSeen, looks_seen, with_things
from benchmarks.priors.measures import FitSeen, PlaceSeen, RegionSeen, fits_seen, places_seen, regions_seen
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

PRIORS_FILE = CHECKOUT / "kb" / "asp" / "priors.lp"
PLACES_FILE = PRIORS_FILE.with_name("priors_of_places.lp")
WHEREABOUTS_FILE = PRIORS_FILE.with_name("priors_of_whereabouts.lp")
PLANNER_FILES = CHECKOUT / "planner" / "asp"
WHOLE_OF_KINDS = "interpretation.lp and shapes.lp"


class CountedMoment(NamedTuple):
    """The things of one moment that are counted."""

    regions: tuple[RegionSeen, ...]
    fits: tuple[FitSeen, ...]
    places: tuple[PlaceSeen, ...]
    untried: tuple[bool, ...]  # of the objects never moved, which are objects in truth: whether each can be moved


class WhereaboutsMoment(NamedTuple):
    """The things of one moment that are counted of what may be besides what was seen."""

    places: tuple[WhereaboutSeen, ...]
    pieces: tuple[PieceSeen, ...]
    joints: tuple[MeasuredSeen, ...]
    stretches: tuple[MeasuredSeen, ...]
    squares: tuple[MeasuredSeen, ...]


def whereabouts_noted(look: LookedAt) -> WhereaboutsMoment:
    """Return what is counted of a moment of what may be besides what was seen."""
    return WhereaboutsMoment(
        *(tuple(seen(look)) for seen in (whereabouts_seen, pieces_seen, joints_seen, stretches_seen, squares_seen))
    )


def noted(look: LookedAt) -> CountedMoment:
    """Return what is counted of a moment."""
    nodes, tried = look.moment.nodes, {node.name for node in look.model.objects if node.moved or node.stuck}
    untried = (
        statement.true == 1
        for statement in statements(look.moment, ("movable",))
        if (node := statement.fact.partition("(")[2].partition(",")[0]) not in tried and nodes[node].kind == "object"
    )
    return CountedMoment(*(tuple(seen(look)) for seen in (regions_seen, fits_seen, places_seen)), tuple(untried))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the worlds, count, and write the file; return 0."""
    given = _parser().parse_args(arguments)
    samples, moments = given.samples, list[Any]()
    note, read = COUNTING[given.counting]
    if given.recount:
        moments = [read(line) for line in samples.read_text().splitlines()]
    else:
        warm_all()
    deciding = DECIDING.get(given.counting)
    dealing = deciding.dealt(given.worlds, given.seed) if deciding else dealt(given.worlds, given.seed, given.noise)
    parts = given.max_steps if deciding else given.parts
    for number, (asked, noise) in enumerate(() if given.recount else dealing, 1):
        ended = watched(asked, noise, given.max_steps, given.seconds, note, parts)
        moments += ended.looks
        if samples:
            with samples.open("a") as file:
                file.writelines(json.dumps(moment) + "\n" for moment in ended.looks)
        print(f"{number}/{given.worlds} {ended.line()}", file=sys.stderr, flush=True)
    command = (
        f"python -m benchmarks.priors{f' --{given.counting}' if given.counting else ''} --worlds {given.worlds} "
        f"--seed {given.seed} --max-steps {given.max_steps}"
    )
    if deciding:
        told = [f"{command} --seconds {given.seconds}", deciding.told(moments, given.worlds)]
        counted = deciding.counted(chain.from_iterable(moments))
        (given.output or deciding.file).write_text(text([*counted], None, told, deciding.whole))
        return 0
    command += f" --parts {given.parts} --noise {','.join(f'{noise:g}' for noise in given.noise)}"
    if given.counting == "whereabouts":
        written_to = given.output or WHEREABOUTS_FILE
        written_to.write_text(whereabouts_written(moments, f"{command} --seconds {given.seconds}", given.worlds))
        return 0
    (given.output or PRIORS_FILE).write_text(written(moments, command, given.worlds))
    given.places.write_text(places_written(moments, [command], given.worlds))
    return 0


def written(moments: Sequence[CountedMoment], command: str, worlds: int) -> str:
    """Return the file of priors that some moments give."""
    regions = [region for moment in moments for region in moment.regions]
    fits = [fit for moment in moments for fit in moment.fits]
    untried = list(chain.from_iterable(moment.untried for moment in moments))
    movable = Counted("movable", (), sum(untried), len(untried))
    counts = (
        f"{worlds} worlds of all kinds, {len(moments)} moments, {len(regions)} regions, {len(fits)} things with fits"
    )
    return text([*counted_kinds(regions), *counted_classes(fits)], movable, [command, counts], WHOLE_OF_KINDS)


def whereabouts_written(moments: Sequence[WhereaboutsMoment], command: str, worlds: int) -> str:
    """Return the file of priors of what may be besides what was seen that some moments give."""
    places, pieces, joints, stretches, squares = (
        list(chain.from_iterable(seen)) for seen in zip(*moments, strict=True)
    )
    counts = (
        f"{worlds} worlds of all kinds, {len(moments)} moments, {len(places)} places, {len(pieces)} pairs of pieces, "
        f"{len(joints)} parts of floors, {len(stretches)} stretches, {len(squares)} squares"
    )
    counted = [
        *(*counted_whereabouts(places), *counted_pieces(pieces)),
        *(*counted_joints(joints), *counted_stretches(stretches), *counted_squares(squares)),
    ]
    return text(counted, None, [command, counts], "chances.lp")


def _read_whereabouts(line: str) -> WhereaboutsMoment:
    """Return a moment of what may be besides what was seen from its line of JSON."""
    kinds = (WhereaboutSeen, PieceSeen, *(MeasuredSeen,) * 3)
    found = zip(kinds, json.loads(line), strict=True)
    return WhereaboutsMoment(*(tuple(kind(*one) for one in seen) for kind, seen in found))


def places_written(moments: Sequence[CountedMoment], commands: Sequence[str], worlds: int) -> str:
    """Return the file of what some moments give of places."""
    places = [place for moment in moments for place in moment.places]
    counts = f"{worlds} worlds of all kinds, {len(moments)} moments, {len(places)} facts about places"
    return places_text(list(counted_places(places)), [*commands, counts])


def _read(line: str) -> CountedMoment:
    """Return a moment from its line of JSON."""
    regions, fits, places, untried = json.loads(line)
    return CountedMoment(
        tuple(RegionSeen(*region) for region in regions),
        tuple(FitSeen(node, tuple(map(tuple, found)), *rest) for node, found, *rest in fits),
        tuple(PlaceSeen(*place) for place in places),
        tuple(untried),
    )


class Deciding(NamedTuple):
    """A count of what the robot chooses among: in which worlds, of what, and into which file."""

    file: Path
    dealt: Callable[[int, int], Iterator[tuple[Asked, float]]]  # worlds, by their number and a seed
    seen: Callable[[LookedAt], Iterator[Any]]
    row: type[Any]  # of what was seen, a named tuple
    counted: Callable[[Iterable[Any]], Iterator[Counted]]
    whole: str  # the encoding of which the file is a part
    worlds: str  # which worlds, in words

    def told(self, moments: Sequence[Sequence[Any]], worlds: int) -> str:
        """Return in words what was counted."""
        return f"{worlds} worlds, {self.worlds}; {sum(map(bool, moments))} decisions, {sum(map(len, moments))} choices"

    def noted(self, look: LookedAt) -> tuple[Any, ...]:
        """Return what is counted of a moment."""
        return tuple(self.seen(look))

    def read(self, line: str) -> tuple[Any, ...]:
        """Return a moment from its line of JSON."""
        return tuple(self.row(*one) for one in json.loads(line))


DECIDING = {
    "walls": Deciding(
        file=PLANNER_FILES / "priors_of_walls.lp",
        dealt=with_plugs,
        seen=walls_seen,
        row=WallSeen,
        counted=counted_walls,
        whole="feel.lp",
        worlds="two of three of benchmarks.plugs, the others of all kinds",
    ),
    "looks": Deciding(
        file=PLANNER_FILES / "priors_of_looks.lp",
        dealt=with_things,
        seen=looks_seen,
        row=LookSeen,
        counted=counted_looks,
        whole="the search for things",
        worlds="of tasks 3, 5, 6 and 9",
    ),
}
COUNTING: Mapping[str, tuple[Callable[[LookedAt], Any], Callable[[str], Any]]] = {  # what is noted, and read again
    "": (noted, _read),
    "whereabouts": (whereabouts_noted, _read_whereabouts),
    **{name: (deciding.noted, deciding.read) for name, deciding in DECIDING.items()},
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
    parser.add_argument("-o", "--output", type=Path, help="the file (default that of kb/asp)")
    parser.add_argument("--places", type=Path, default=PLACES_FILE, help="that of places (%(default)s)")
    instead = parser.add_mutually_exclusive_group()
    for name, what in (
        ("whereabouts", "what may be besides what was seen"),
        ("walls", "walls that are felt"),
        ("looks", "looks for things"),
    ):
        instead.add_argument(
            f"--{name}", dest="counting", action="store_const", const=name, default="", help=f"count {what}, instead"
        )
    return parser


if __name__ == "__main__":
    sys.exit(main())
