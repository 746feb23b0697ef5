"""Regions: maximal edge-connected sets of free or of occupied squares of the map, and which region surrounds which.

They become facts for the interpretation (kb/asp/interpretation.lp); nothing here decides what a region is.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Bools, Labels, Longs
from utak.geometry.raster.components import bounding_boxes, components


class Region(NamedTuple):
    """One region: a maximal edge-connected set of free, or of occupied, squares of the map."""

    name: str  # `part<n>`, n from 1
    occupied: bool  # Whether it is a region of occupied squares rather than of free ones
    certain: int  # Percent of its squares that are so, by the chance of each; 100 only where all of them surely are
    rim: bool  # Whether it touches what was not seen
    extent: int  # The longer side of its containing rectangle, in squares
    mass: int  # The expected number of its occupied squares, in tenths of squares


class Percept(NamedTuple):
    """The regions of the map."""

    regions: tuple[Region, ...]  # The regions, free ones first
    adjacent: frozenset[tuple[str, str]]  # Pairs of names of regions that share an edge, both ways round
    # Pairs of names (outer, inner): no way leads from inner to what was not seen, except across outer
    surrounds: frozenset[tuple[str, str]]


def map_regions(
    occupied: Bools, seen: Bools, certain: Bools, probability: NDArray[np.float32] | None = None
) -> tuple[Percept, Labels]:
    """Return the regions of the map."""
    zero, full = components(seen & ~occupied), components(seen & occupied)
    labels = np.where(full.labels > 0, full.labels + zero.number, zero.labels).astype(np.int32)
    count = zero.number + full.number
    touching, open_ = _touching(labels, count)
    size = np.bincount(labels.ravel(), minlength=count + 1)
    sure = np.bincount(labels.ravel(), certain.ravel(), minlength=count + 1)
    weight = occupied if probability is None else probability
    as_said = certain if probability is None else np.where(certain, 1, np.where(occupied, weight, 1 - weight))
    likely = np.bincount(labels.ravel(), as_said.ravel(), minlength=count + 1)
    mass = np.bincount(labels.ravel(), weight.ravel(), minlength=count + 1)
    longest = extents(labels, count)
    regions = tuple(
        Region(
            f"part{n}",
            n > zero.number,
            _percent(likely[n], int(sure[n]), int(size[n])),
            n in open_,
            int(longest[n]),
            round(10 * mass[n]),
        )
        for n in range(1, count + 1)
    )
    return _percept(regions, touching), labels


def region_of(mask: Bools, name: str, sure: Bools, probability: NDArray[np.float32]) -> Region:
    """Return the region of some occupied squares that lies within what was seen."""
    rows, columns = np.nonzero(mask)
    extent = int(max(np.ptp(rows), np.ptp(columns))) + 1
    mass = round(10 * float(probability[mask].sum()))
    likely = float(np.where(sure, 1, probability)[mask].sum())
    return Region(name, True, _percent(likely, int(sure[mask].sum()), len(rows)), False, extent, mass)


def _percent(likely: float, sure: int, size: int) -> int:
    """Return how many of some squares are likely so, in percent; 100 only where all are sure, and at least 1."""
    return 100 if sure == size else min(max(int(100 * likely / size), 1), 99)


def label_of(name: str) -> int:
    """Return the label of a region of the map: n for the name `part<n>`; ValueError for a name of another form."""
    return int(name.removeprefix("part"))


def extents(labels: Labels, count: int) -> Longs:
    """Return the longer side of each label's containing rectangle, in squares: (count + 1,) int64, [n] for label n."""
    south, west, north, east = bounding_boxes(labels, count).T
    longer: Longs = np.maximum(np.maximum(north - south, east - west) + 1, 0)
    return longer


def _touching(labels: Labels, count: int) -> tuple[set[tuple[str, str]], set[int]]:
    """Return the regions that share an edge, and those that touch unseen squares or the edge of the array."""
    framed = np.pad(labels, 1).astype(np.int64)
    pairs = [np.zeros(0, np.int64)]
    for a, b in ((framed[:, :-1], framed[:, 1:]), (framed[:-1], framed[1:])):
        differ = a != b
        pairs.append(np.unique(a[differ] * (count + 1) + b[differ]))
    touching, open_ = set(), set()
    for p, q in (divmod(pair, count + 1) for pair in np.concatenate(pairs).tolist()):
        touching |= {(f"part{p}", f"part{q}"), (f"part{q}", f"part{p}")} if p and q else set()
        open_ |= set() if p and q else {max(p, q)}
    return touching, open_


def _percept(regions: tuple[Region, ...], touching: set[tuple[str, str]]) -> Percept:
    """Return regions together with the pairs that touch and those that surround each other."""
    beside: dict[str, set[str]] = {region.name: set() for region in regions}
    for a, b in touching:
        beside[a].add(b)
    outside = [region.name for region in regions if region.rim]
    return Percept(regions, frozenset(touching), frozenset(_surrounding(beside, outside)))


def _surrounding(beside: Mapping[str, set[str]], outside: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the pairs (outer, inner) such that no way leads from inner to the outside, except across outer."""
    open_, order = set(outside), dict[str, int]()
    back = dict[str, int]()  # the earliest region reached from the subtree
    for start in sorted(open_):
        path = [(start, iter(sorted(beside[start])))] if start not in order else []
        order.setdefault(start, len(order))
        back.setdefault(start, -1)
        while path:
            here, others = path[-1]
            other = next(others, None)
            if other is None:
                path.pop()
                above = path[-1][0] if path else here
                back[above] = min(back[above], back[here])
                if back[here] >= order[above]:
                    yield from ((above, inner) for inner in list(order)[order[here] :])
            elif other in order:
                back[here] = min(back[here], order[other])
            else:
                order[other] = len(order)
                back[other] = -1 if other in open_ else order[other]
                path.append((other, iter(sorted(beside[other]))))
