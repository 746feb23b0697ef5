"""Counts: how often each alternative was true, given the measures that confidences are conditioned on."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import NamedTuple

from benchmarks.calibration.figures import NO_CLASS, RECTANGLE
from benchmarks.priors.bins import (
    BEHIND,
    CASES,
    EXTENT,
    JOINED,
    LEAD,
    LOOK,
    MASS,
    MISFIT,
    NONE_MISFIT,
    OBJECT_MASS,
    OPENNESS,
    PASSAGE,
    PLACES,
    PLUG,
    STANDING,
    UNMOVED,
    WHEREABOUT_MEASURE,
    WHOLE,
    Bin,
    bin_of,
)
from benchmarks.priors.looks import LookSeen
from benchmarks.priors.measures import FitSeen, PlaceSeen, RegionSeen, TriedSeen
from benchmarks.priors.walls import WIDTHS, WallSeen
from benchmarks.priors.whereabouts import MeasuredSeen, PieceSeen, WhereaboutSeen
from utak.planner.sights.walls import WallKind

THOUSAND = 1000
MAX_LEAD = 3  # squares: kb/asp/shapes.lp tells no greater lead
NO_SURE_SQUARE = 1000  # openness where no square is sure, as in kb/asp/shapes.lp


class Counted(NamedTuple):
    """One row of the priors: of `of` things with such measures, `true` were so."""

    predicate: str
    given: tuple[str | Bin, ...]
    true: int
    of: int

    @property
    def thousandths(self) -> int:
        """The chance by Laplace's rule, in thousandths: neither 0 nor 1000, however many were counted."""
        return min(THOUSAND - 1, max(1, round(THOUSAND * (self.true + 1) / (self.of + 2))))


def counted_kinds(regions: Iterable[RegionSeen]) -> Iterator[Counted]:
    """Yield how many regions of each case are no floor, and how many of those are objects."""
    seen = list(regions)
    for case in CASES:
        own = [region for region in seen if region.situation == case]
        for mass in MASS.get(case, WHOLE):
            there = [region for region in own if mass.holds(region.mass)]
            yield Counted("counted_solid", (case, mass), sum(one.truth != "floor" for one in there), len(there))
    for case in CASES:
        own = [region for region in seen if region.situation == case and region.truth != "floor"]
        for extent, mass in product(EXTENT.get(case, WHOLE), OBJECT_MASS.get(case, WHOLE)):
            there = [region for region in own if extent.holds(region.extent) and mass.holds(region.mass)]
            objects = sum(one.truth == "object" for one in there)
            yield Counted("counted_object", (case, extent, mass), objects, len(there))


def lead(fit: FitSeen) -> int:
    """Return by how many squares of misfit the first class is ahead of the next one, MAX_LEAD at most."""
    first = fit.fits[0][1]
    return min([MAX_LEAD, *(misfit - first for _, misfit in fit.fits[1:])])


def openness(fit: FitSeen) -> int:
    """Return the open squares for each 100 sure ones."""
    return 100 * fit.open // fit.full if fit.full else NO_SURE_SQUARE


def first_is_true(fit: FitSeen) -> bool:
    """Return whether the first class is the true one; a RECTANGLE counts as either of square and brick."""
    first = fit.fits[0][0]
    return first == fit.shape or (fit.shape == RECTANGLE and first in ("square", "brick"))


def counted_classes(fits: Iterable[FitSeen]) -> Iterator[Counted]:
    """Yield how often the first class was the true one, and which else was where it was not."""
    seen = [fit for fit in fits if fit.shape is not None]
    for misfit in MISFIT:
        for ahead in LEAD[misfit]:
            for share in OPENNESS[misfit]:
                there = [
                    fit
                    for fit in seen
                    if misfit.holds(fit.fits[0][1]) and ahead.holds(lead(fit)) and share.holds(openness(fit))
                ]
                true = sum(map(first_is_true, there))
                yield Counted("counted_first", (misfit, ahead, share), true, len(there))
    wrong = [fit for fit in seen if not first_is_true(fit)]
    true, offered = Counter[Bin](), Counter[Bin]()
    for fit in wrong:
        for shape, misfit in fit.fits[1:]:
            behind = bin_of(misfit - fit.fits[0][1], BEHIND)
            offered[behind] += 1
            true[behind] += shape == fit.shape
    for behind in BEHIND:
        yield Counted("counted_other", (behind,), true[behind], offered[behind])
    for misfit in NONE_MISFIT:
        there = [fit for fit in wrong if misfit.holds(fit.fits[0][1])]
        yield Counted("counted_none", (misfit,), sum(fit.shape == NO_CLASS for fit in there), len(there))


def counted_movables(tried: Iterable[TriedSeen]) -> Iterator[Counted]:
    """Yield how many objects that no motion had moved could be moved, by how many ways they were tried."""
    seen = list(tried)
    for unmoved in UNMOVED:
        there = [one.movable for one in seen if unmoved.holds(one.unmoved)]
        yield Counted("counted_movable", (unmoved,), sum(there), len(there))


def counted_whereabouts(places: Iterable[WhereaboutSeen]) -> Iterator[Counted]:
    """Yield how many places of each case were where the thing was; those that a claim is against are left out."""
    seen = ((place.case, place.measure, place.true) for place in places if not place.against)
    return _counted_by_case("counted_place", WHEREABOUT_MEASURE, seen)


def counted_joints(joints: Iterable[MeasuredSeen]) -> Iterator[Counted]:
    """Yield how many parts of the floor were those to which unseen floor led first from another one, by case."""
    return _counted_by_case("counted_passage", PASSAGE, joints)


def counted_stretches(stretches: Iterable[MeasuredSeen]) -> Iterator[Counted]:
    """Yield how many stretches of what bounds the floor were things, by case and thickness."""
    return _counted_by_case("counted_plug", PLUG, stretches)


def counted_squares(squares: Iterable[MeasuredSeen]) -> Iterator[Counted]:
    """Yield how many likeliest squares were those in which the robot stood, by case and share of the likelihood."""
    return _counted_by_case("counted_square", STANDING, squares)


def counted_looks(looks: Iterable[LookSeen]) -> Iterator[Counted]:
    """Yield how many looks of each kind would have shown a thing never seen, by the squares that they show."""
    return _counted_by_case("counted_look", LOOK, looks)


def counted_walls(walls: Iterable[WallSeen]) -> Iterator[Counted]:
    """Yield in how many places of walls of each kind things of each width began."""
    found = Counter((wall.kind, wall.width, wall.begins) for wall in walls)
    for kind, width in product(WallKind, WIDTHS):
        true = found[kind, width, True]
        yield Counted("counted_wall", (kind, width), true, true + found[kind, width, False])


def counted_pieces(pieces: Iterable[PieceSeen]) -> Iterator[Counted]:
    """Yield how many pairs of pieces that touch were one thing, by what was felt and the class of their outline."""
    return _counted_by_case("counted_joined", JOINED, pieces)


def counted_places(places: Iterable[PlaceSeen]) -> Iterator[Counted]:
    """Yield how often facts about places were true, by their case and by what was measured."""
    return _counted_by_case("counted_chance", PLACES, places)


def _counted_by_case(
    predicate: str, bins: Mapping[str, Sequence[Bin]], seen: Iterable[tuple[str, int, bool]]
) -> Iterator[Counted]:
    """Yield how many of what was seen, each a case, a measure and whether it was true, were true in each bin."""
    found = list(seen)
    for case, measures in bins.items():
        for measure in measures:
            there = [true for one, value, true in found if one == case and measure.holds(value)]
            yield Counted(predicate, (case, measure), sum(there), len(there))
