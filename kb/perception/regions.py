"""Regions of space and of things, and which surrounds which: of one impression's cells, or of the squares of the
whole map.

A region is a maximal edge-connected set of zero cells, or of non-zero ones. These are facts for the interpretation
(kb/asp); nothing here says what a region is.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import boxes, components
from kb.perception.retina import FIELDS, OWN, count_ranges, neighbours, rim

Mask = NDArray[np.bool_]


class Region(NamedTuple):
    """One region. certain: percent of its squares that are as its cells say, whatever counts the gray levels stand for.

    rim: does it touch what is not seen? extent: the longer side of its containing rectangle, in squares.
    mass: tenths of squares that are expected to be occupied.
    """

    name: str
    occupied: bool
    certain: int
    rim: bool
    extent: int
    mass: int
    own: bool = False


class Percept(NamedTuple):
    """The regions of one impression or map, with the pairs that touch, and the pairs (outer, inner) that surround."""

    regions: tuple[Region, ...]
    adjacent: frozenset[tuple[str, str]]
    surrounds: frozenset[tuple[str, str]]


def impression_regions(levels: tuple[int, ...]) -> tuple[Percept, dict[str, frozenset[int]]]:
    """The regions of one retinal impression of 160 gray levels, and the cells of each.

    Utak's own cell is a region by itself.
    """
    cells: dict[str, frozenset[int]] = {"own": frozenset({OWN})}
    unseen = set(range(len(FIELDS))) - {OWN}
    while unseen:
        grown = _grow(min(unseen), unseen, levels)
        cells[f"cells{len(cells)}"] = frozenset(grown)
        unseen -= grown
    owner = {cell: name for name, members in cells.items() for cell in members}
    touching = {(owner[a], owner[b]) for a in range(len(FIELDS)) for b in neighbours()[a] if owner[a] != owner[b]}
    ranges = count_ranges(levels)
    regions = tuple(_cell_region(name, members, levels, ranges) for name, members in cells.items())
    return _percept(regions, touching), cells


def map_regions(
    occupied: Mask, seen: Mask, certain: Mask, probability: NDArray[np.float32] | None = None
) -> tuple[Percept, NDArray[np.int32]]:
    """The regions of the map, and a label array (rows, columns): 0 unseen, n for the region named `part<n>`.

    occupied: where something may be; certain: where the counts settle it; probability: that it is (1 where occupied,
    when left out). Arrays are (rows, columns) of the same shape.
    """
    zero, full = components(seen & ~occupied), components(seen & occupied)
    labels = np.where(full.labels > 0, full.labels + zero.number, zero.labels).astype(np.int32)
    count = zero.number + full.number
    touching, open_ = _touching(labels, count)
    size = np.bincount(labels.ravel(), minlength=count + 1)
    sure = np.bincount(labels.ravel(), certain.ravel(), minlength=count + 1)
    weight = occupied if probability is None else probability
    mass = np.bincount(labels.ravel(), weight.ravel(), minlength=count + 1)
    longest = extents(labels, count)
    regions = tuple(
        Region(
            f"part{n}", n > zero.number, int(100 * sure[n] // size[n]), n in open_, int(longest[n]), round(10 * mass[n])
        )
        for n in range(1, count + 1)
    )
    return _percept(regions, touching), labels


def label_of(name: str) -> int:
    """The label of a region of the map."""
    return int(name.removeprefix("part"))


def _grow(first: int, among: set[int], levels: tuple[int, ...]) -> set[int]:
    region, edge = {first}, [first]
    while edge:
        for cell in neighbours()[edge.pop()]:
            if cell in among and cell not in region and (levels[cell] > 0) == (levels[first] > 0):
                region.add(cell)
                edge.append(cell)
    return region


def _cell_region(name: str, members: Iterable[int], levels: tuple[int, ...], ranges: NDArray[np.int16]) -> Region:
    cells = sorted(members)
    occupied = levels[cells[0]] > 0
    area = sum(FIELDS[c].side ** 2 for c in cells)
    right = sum(int(ranges[c, 0]) if occupied else FIELDS[c].side ** 2 - int(ranges[c, 1]) for c in cells)
    east = [FIELDS[c].east for c in cells] + [FIELDS[c].east + FIELDS[c].side for c in cells]
    north = [FIELDS[c].north for c in cells] + [FIELDS[c].north + FIELDS[c].side for c in cells]
    extent = max(max(east) - min(east), max(north) - min(north))
    if name == "own":
        return Region(name, True, 100, False, 1, 10, True)
    mass = round(5 * float(ranges[cells].sum()))
    return Region(name, occupied, 100 * right // area, bool(rim() & set(cells)), extent, mass)


def extents(labels: NDArray[np.int32], count: int) -> NDArray[np.int64]:
    """The longer side of each label's containing rectangle, for labels 0 to count of a (rows, columns) array."""
    south, west, north, east = boxes(labels, count).T
    longer: NDArray[np.int64] = np.maximum(np.maximum(north - south, east - west) + 1, 0)
    return longer


def _touching(labels: NDArray[np.int32], count: int) -> tuple[set[tuple[str, str]], set[int]]:
    """The pairs of regions that touch, both ways round, and the labels of those that touch what is not seen."""
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
    beside: dict[str, set[str]] = {region.name: set() for region in regions}
    for a, b in touching:
        beside[a].add(b)
    outside = [region.name for region in regions if region.rim]
    return Percept(regions, frozenset(touching), frozenset(_surrounding(beside, outside)))


def _surrounding(beside: Mapping[str, set[str]], outside: Iterable[str]) -> Iterator[tuple[str, str]]:
    """The pairs (outer, inner) such that no way leads from inner to the outside, save across outer.

    # Strategy: one depth-first search from the outside. Where no edge leads from what hangs below a child back past its
    parent, the parent surrounds all that.
    Source: Hopcroft and Tarjan (1973), articulation points.
    """
    open_, order, back = set(outside), dict[str, int](), dict[str, int]()  # back: the earliest that is met from below
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
