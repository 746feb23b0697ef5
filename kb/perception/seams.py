"""Seams: where one thing ends and another begins within a region, as far as the colours felt on it tell.

Things that touch are one region to the eye. A region on which two colours were felt is more than one thing, or an
island of the verge with things that stand against it. It is cut along straight lines from rim to rim, along the grid,
until no part was felt in two colours. A line from inner corner to inner corner is preferred, for it leaves the simplest
outlines; then a short line, then the middle between the squares that were felt.

Masks are (rows, columns) bool on the arrays of the map view, row 0 in the south.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Bools, Labels
from utak.geometry.raster.components import components
from utak.geometry.raster.runs import runs_along_rows
from utak.kb.perception.protrusions import MAX_THING_LENGTH, RowColumn
from utak.kb.perception.regions import Percept, label_of, region_of

MAX_CUTS = 12  # cuts in one region; a bound on time
MAX_PAIRED_LINES = 40  # lines of which pairs are tried where no single one parts a region; a bound on time


class SeamLine(NamedTuple):
    """A straight line along the grid between squares of a region, from rim to rim."""

    upright: bool  # whether it runs along columns, between two columns; else between two rows
    at: int  # the column east of it, or the row north of it
    first: int  # the first and the last row that it runs along; columns for a level line
    last: int

    @property
    def length(self) -> int:
        """The length in squares."""
        return self.last - self.first + 1

    def sides(self, along: int) -> tuple[RowColumn, RowColumn]:
        """Return the squares (row, column) on both sides of the line: west and east, or south and north."""
        if self.upright:
            return (along, self.at - 1), (along, self.at)
        return (self.at - 1, along), (self.at, along)

    @property
    def ends(self) -> tuple[tuple[RowColumn, RowColumn], ...]:
        """The pairs of squares on both sides of its first and of its last square length."""
        return self.sides(self.first), self.sides(self.last)


class Parting(NamedTuple):
    """A region taken apart."""

    parts: tuple[Bools, ...]  # the mask of each part, in raster order of their first squares
    # Masks of squares on the rim beside seams of which it is not settled where exactly they run; what is felt on them
    # tells more
    unsettled: tuple[Bools, ...] = ()


def part_by_colour(region: Bools, felt: Mapping[RowColumn, str]) -> Parting:
    """Return a region cut into parts none of which was felt in two colours."""
    colours = {place: colour for place, colour in felt.items() if region[place]}
    if len(set(colours.values())) < 2:
        return Parting((region,))
    rows, columns = np.flatnonzero(region.any(1)), np.flatnonzero(region.any(0))
    south, west = int(rows[0]), int(columns[0])
    window = slice(south, int(rows[-1]) + 1), slice(west, int(columns[-1]) + 1)
    inside = _parted(region[window], {(row - south, column - west): c for (row, column), c in colours.items()})

    def whole(mask: Bools) -> Bools:
        """Return a mask of the window on the arrays of the map view."""
        full = np.zeros_like(region)
        full[window] = mask
        return full

    return Parting(tuple(map(whole, inside.parts)), tuple(map(whole, inside.unsettled)))


def _parted(region: Bools, colours: Mapping[RowColumn, str]) -> Parting:
    """Return a region cut into parts none of which was felt in two colours; one part where that cannot be."""
    lines = list(_lines(region))
    cuts: list[SeamLine] = []
    labels = _labels(region, cuts)
    mixed = _mixed(labels, colours)
    while mixed and len(cuts) < MAX_CUTS:
        best = _best(region, cuts, [(line,) for line in lines if line not in cuts], colours, labels, mixed)
        if best is None:
            near = sorted((line for line in lines if line not in cuts), key=lambda line: line.length)
            best = _best(region, cuts, combinations(near[:MAX_PAIRED_LINES], 2), colours, labels, mixed)
        if best is None:
            return Parting((region,))
        cuts += best
        labels = _labels(region, cuts)
        mixed = _mixed(labels, colours)
    if mixed:
        return Parting((region,))
    labels = _rejoined(labels, colours)
    parts = tuple(labels == n for n in np.unique(labels[labels > 0]).tolist())
    unsettled = [_unsettled(line, region, colours) for line in cuts]
    return Parting(parts, tuple(mask for mask in unsettled if mask.any()))


def _rejoined(labels: Labels, colours: Mapping[RowColumn, str]) -> Labels:
    """Return the parts with those made one that touch and were felt in the same colour: no cut was for them."""
    colour_of = {int(labels[place]): colour for place, colour in colours.items()}
    pairs = {
        (int(one), int(other))
        for across in (labels, labels.T)
        for one, other in np.unique(np.column_stack([across[:, 1:].ravel(), across[:, :-1].ravel()]), axis=0)
        if one and other and one != other
    }
    first = {number: number for number in colour_of}
    for one, other in sorted(pairs):
        if colour_of.get(one, "") == colour_of.get(other):
            low, high = sorted((first[one], first[other]))
            first = {number: low if part == high else part for number, part in first.items()}
    joined: Labels = np.array([first.get(n, n) for n in range(int(labels.max()) + 1)], labels.dtype)[labels]
    return joined


def cornered_parts(solid: Bools, felt: Mapping[RowColumn, str]) -> list[Bools]:
    """Return the parts with felt squares into which solids fall along lines from inner corner to inner corner."""
    cuts = [
        line
        for line in _lines(solid, max(solid.shape))
        if _is_inner_corner(0, line, solid) and _is_inner_corner(1, line, solid)
    ]
    labels = _labels(solid, cuts)
    numbers = sorted({int(labels[place]) for place in felt} - {0})
    return sorted((labels == n for n in numbers), key=lambda mask: int(mask.sum()))


def halves(region: Bools) -> Iterator[Bools]:
    """Yield the parts that arise when a region is cut in two along one straight line, the simplest outlines first."""
    lines = sorted(_lines(region, max(region.shape)), key=lambda line: (_loose_ends(line, region), line.length))
    for line in lines:
        labels = _labels(region, [line])
        if int(labels.max()) == 2:
            yield from (labels == 1, labels == 2)


def _loose_ends(line: SeamLine, region: Bools) -> int:
    """Return how many ends of a line are at no inner corner of a region."""
    return sum(not _is_inner_corner(end, line, region) for end in (0, 1))


def _lines(region: Bools, longest: int = MAX_THING_LENGTH) -> Iterator[SeamLine]:
    """Yield the lines from rim to rim that are at most `longest` squares long, upright ones first."""
    for upright, mask in ((True, region), (False, region.T)):
        for at, start, stop in runs_along_rows((mask[:, 1:] & mask[:, :-1]).T).each():
            if stop - start <= longest:
                yield SeamLine(upright, at + 1, start, stop - 1)


def _labels(region: Bools, cuts: list[SeamLine]) -> Labels:
    """Return the number of the part of each square of a region, when it is cut along some lines; 0 outside."""
    rows, columns = region.shape
    fine = np.zeros((2 * rows - 1, 2 * columns - 1), np.bool_)  # squares, and between them the edges that they share
    fine[::2, ::2] = region
    fine[::2, 1::2] = region[:, 1:] & region[:, :-1]
    fine[1::2, ::2] = region[1:] & region[:-1]
    for line in cuts:
        if line.upright:
            fine[2 * line.first : 2 * line.last + 1 : 2, 2 * line.at - 1] = False
        else:
            fine[2 * line.at - 1, 2 * line.first : 2 * line.last + 1 : 2] = False
    labels: Labels = np.ascontiguousarray(components(fine).labels[::2, ::2])
    return labels


def _mixed(labels: Labels, colours: Mapping[RowColumn, str]) -> int:
    """Return how many pairs of squares that were felt in different colours are in one part."""
    in_part: dict[int, dict[str, int]] = {}
    for place, colour in colours.items():
        counts = in_part.setdefault(int(labels[place]), {})
        counts[colour] = counts.get(colour, 0) + 1
    return sum(a * b for counts in in_part.values() for a, b in combinations(counts.values(), 2))


def _best(
    region: Bools,
    cuts: list[SeamLine],
    choices: Iterable[tuple[SeamLine, ...]],
    colours: Mapping[RowColumn, str],
    labels: Labels,
    mixed: int,
) -> tuple[SeamLine, ...] | None:
    """Return the lines along which a region is cut next; None when no choice parts squares of different colours."""
    parts = int(labels.max())
    best, least = None, (mixed, 0, 0, 0)
    for choice in choices:
        after = _labels(region, [*cuts, *choice])
        if int(after.max()) == parts:
            continue
        left = _mixed(after, colours)
        if left >= mixed:
            continue
        loose = sum(_loose_ends(line, region) for line in choice)
        cost = left, loose, sum(line.length for line in choice), sum(_lopsided(line, after, colours) for line in choice)
        if best is None or cost < least:
            best, least = choice, cost
    return best


def _is_inner_corner(end: int, line: SeamLine, region: Bools) -> bool:
    """Return whether a line ends at an inner corner of a region: just one of the two squares beyond belongs to it."""
    beyond = line.sides(line.last + 1 if end else line.first - 1)
    rows, columns = region.shape
    inside = [place for place in beyond if 0 <= place[0] < rows and 0 <= place[1] < columns]
    return sum(int(region[place]) for place in inside) == 1


def _lopsided(line: SeamLine, labels: Labels, colours: Mapping[RowColumn, str]) -> int:
    """Return by how many squares a line is nearer to what was felt on its one side than on the other."""
    low, high = (int(labels[place]) for place in line.ends[0])
    across = 1 if line.upright else 0
    below = [line.at - 1 - place[across] for place in colours if labels[place] == low and place[across] < line.at]
    above = [place[across] - line.at for place in colours if labels[place] == high and place[across] >= line.at]
    return abs(min(below, default=0) - min(above, default=0))


def _unsettled(line: SeamLine, region: Bools, colours: Mapping[RowColumn, str]) -> Bools:
    """Return the unfelt squares on the rim at the ends of a line, where nothing settles that it runs there."""
    # At an inner corner two things may meet, or one thing have its own.
    mask: Bools = np.zeros_like(region)
    if not any(all(place in colours for place in end) for end in line.ends):
        for place in (place for end in line.ends for place in end):
            mask[place] = place not in colours
    return mask


class PartedMap(NamedTuple):
    """The regions of the map after regions of two colours were parted."""

    percept: Percept  # the regions; new ones last
    labels: Labels  # (rows, columns) int32, the number n of each square's region `part<n>`; 0 where nothing was seen
    unsettled: tuple[Bools, ...] = ()  # masks of squares on which it is to be felt where exactly one part ends


def part_mixed_regions(
    percept: Percept,
    labels: Labels,
    felt: Mapping[RowColumn, str],
    certain: Bools,
    probability: NDArray[np.float32],
) -> PartedMap:
    """Return the regions of the map, with isolated regions on which two colours were felt parted."""
    colours: dict[int, dict[RowColumn, str]] = {}
    for place, colour in felt.items():
        colours.setdefault(int(labels[place]), {})[place] = colour
    isolated = {inner for _, inner in percept.surrounds}
    regions, surrounds = list(percept.regions), set(percept.surrounds)
    labels, unsettled = labels.copy(), list[Bools]()
    for index, region in enumerate(percept.regions):
        there = colours.get(label_of(region.name), {})
        if not region.occupied or region.name not in isolated or len(set(there.values())) < 2:
            continue
        parting = part_by_colour(labels == label_of(region.name), there)
        unsettled += parting.unsettled
        first, *others = sorted(parting.parts, key=lambda mask: -int(mask.sum()))
        regions[index] = region_of(first, region.name, certain, probability)
        for part in others:
            label = int(labels.max()) + 1
            labels[part] = label
            new = region_of(part, f"part{label}", certain, probability)
            regions.append(new)
            surrounds |= {(outer, new.name) for outer, inner in percept.surrounds if inner == region.name}
    changed = percept._replace(regions=tuple(regions), surrounds=frozenset(surrounds))
    return PartedMap(changed, labels, tuple(unsettled))
