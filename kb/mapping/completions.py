"""Completions of what no count settles: drawn for one scene at a time, and gone on with from look to look.

The squares that are not settled fall into scenes that tell nothing of each other: no field looks at two of them, and
settled squares lie in between. What is drawn of a scene stays as it is until a look tells something new of it; then
each picture is drawn on as it was, for most of it holds still.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.counts.gibbs import DRAWN, FREE, FULL, UNSEEN, Counts, costs, pictures
from geometry.raster.components import Components, boxes, components
from kb.mapping.occupancy import OPEN, MapView
from kb.mapping.occupancy_odds import STRAY

PICTURES = 12
DRAWINGS = 2  # for each of them
RATHER = 0.3  # how much rather a drawing is kept that costs less by 1: by this power of e
SEED = 20031
BEGINNING = (60, 0.5)  # sweeps over a scene that was not drawn yet, and the inverse temperature of the first one
GOING_ON = (30, 1.0)  # likewise, over one that was
DEEP = 2  # squares: within what is full or empty so far from its edge nothing is pictured
SURELY = 0.93  # under a field that shows the last gray level and yet may miss a square
HALF = 0.5
Mask = NDArray[np.bool_]
Image = NDArray[np.int8]
Told = tuple[int | bytes, ...]


class CompletionTask(NamedTuple):
    """A part of the map to be pictured. ground, first: as for geometry.counts.gibbs.pictures, cut to the part.

    rows, columns : where it lies on the map. counts : of the squares to be drawn alone, with flat indices of the part.
    """

    rows: slice
    columns: slice
    ground: Image
    first: Image
    counts: Counts

    def told(self, view: MapView) -> Told:
        """All that is told of it, its place included: two scenes are the same where this is."""
        arrays = (self.ground, *self.counts)
        return view.west + self.columns.start, view.south + self.rows.start, *(array.tobytes() for array in arrays)


class Completions(NamedTuple):
    """Completions of a map.

    west, south : the lattice square at [0, 0]. ground : (rows, columns) int8, what is given. images : (PICTURES, rows,
    columns) int8, 1 where a square is occupied. scenes : the pictures of each, (PICTURES, n) int8.
    """

    west: int
    south: int
    ground: Image
    images: Image
    scenes: Mapping[Told, Image]

    def at(self, x: int, y: int) -> NDArray[np.bool_] | None:
        """(PICTURES,): which pictures show a square of the lattice occupied; None where it was never seen."""
        row, column = y - self.south, x - self.west
        inside = 0 <= row < self.ground.shape[0] and 0 <= column < self.ground.shape[1]
        if not inside or self.ground[row, column] == UNSEEN:
            return None
        shown: NDArray[np.bool_] = self.images[:, row, column] > 0
        return shown

    def over(self, scene: CompletionTask, view: MapView) -> "Completions":
        """The part that lies where a scene of another map is; unseen where there is none."""
        south, west = view.south + scene.rows.start - self.south, view.west + scene.columns.start - self.west
        ground: Image = np.full(scene.ground.shape, UNSEEN, np.int8)
        images = np.zeros((len(self.images), *ground.shape), np.int8)
        (high, wide), (rows, columns) = ground.shape, self.ground.shape
        top, right = max(min(high, rows - south), 0), max(min(wide, columns - west), 0)
        low, left = min(max(-south, 0), top), min(max(-west, 0), right)
        own = slice(low + south, top + south), slice(left + west, right + west)
        ground[low:top, left:right] = self.ground[own]
        images[:, low:top, left:right] = self.images[:, own[0], own[1]]
        return Completions(self.west + west, self.south + south, ground, images, {})


NO_PICTURES = Completions(0, 0, np.zeros((0, 0), np.int8), np.zeros((PICTURES, 0, 0), np.int8), {})


def ground_of(view: MapView) -> Image:
    """(rows, columns): what is given of the pictures, namely what is settled, and what lies amid its like."""
    ground = np.where(view.seen, np.where(view.state == OPEN, DRAWN, view.state), UNSEEN).astype(np.int8)
    drawn = ground == DRAWN
    ground[drawn & amid(view.probability > SURELY, DEEP)] = FULL
    ground[drawn & amid(~view.seen | (view.probability <= STRAY), DEEP)] = FREE
    return ground


def pictured(view: MapView, ground: Image, before: Completions) -> Completions:
    """Completions that agree with all counts. before : those of the last look, on the same lattice."""
    images = np.repeat((ground == FULL).astype(np.int8)[None], PICTURES, axis=0)
    drawn = {}
    for scene in scenes(view, ground):
        told = scene.told(view)
        now = before.scenes.get(told)
        drawn[told] = _drawn(scene, before.over(scene, view)) if now is None else now
        images[:, scene.rows, scene.columns][:, scene.ground == DRAWN] = drawn[told]
    return Completions(view.west, view.south, ground, images, drawn)


def _drawn(scene: CompletionTask, before: Completions) -> Image:
    """(PICTURES, n): the pictures of a scene, at the squares that are to be drawn."""
    open_ = scene.ground == DRAWN
    known = open_ & (before.ground != UNSEEN)
    sweeps, hot = GOING_ON if known.sum() > open_.sum() / 2 else BEGINNING
    first = np.repeat(np.where(known, before.images, scene.first), DRAWINGS, axis=0)
    drawn = pictures(scene.ground, scene.counts, first, sweeps, hot, SEED)
    return drawn[_kept(costs(drawn, scene.ground, scene.counts))][:, open_]


def _kept(costs: NDArray[np.float64]) -> NDArray[np.int64]:
    """Which of some drawings are kept as pictures: the plainer ones rather, and those more than once."""
    weight = np.cumsum(np.exp(-RATHER * (costs - costs.min())))
    marks = (np.arange(PICTURES) + 0.5) / PICTURES
    kept: NDArray[np.int64] = np.searchsorted(weight, marks * weight[-1])
    return kept


def scenes(view: MapView, ground: Image) -> Iterator[CompletionTask]:
    """The parts of a map that tell nothing of each other."""
    open_ = ground == DRAWN
    counts = _left(view.counts, ground)
    near = components(~amid(~open_, 1))
    labels = _joined(near, counts)
    labels[~open_] = 0
    owner = labels.ravel()[counts.where[np.arange(len(counts.where)), (counts.weight > 0).argmax(1)]]
    order = np.argsort(owner, kind="stable")
    first = (view.probability > HALF).astype(np.int8)
    for label, (south, west, north, east) in enumerate(boxes(labels, near.number).tolist()):
        if label == 0 or north < 0:
            continue
        rows, columns = slice(max(south - 1, 0), north + 2), slice(max(west - 1, 0), east + 2)
        own = labels[rows, columns] == label
        part = ground[rows, columns]
        part = np.where(own | (part != DRAWN), part, np.int8(UNSEEN))
        begin, end = np.searchsorted(owner[order], [label, label + 1])
        told = counts.of(order[begin:end])
        up, along = np.divmod(told.where, ground.shape[1])
        inside = (up - rows.start) * part.shape[1] + along - columns.start
        told = told._replace(where=np.where(told.weight > 0, inside, 0).astype(np.int32))
        yield CompletionTask(rows, columns, part, first[rows, columns], told)


def _left(counts: Counts, ground: Image) -> Counts:
    """What the fields that look at squares to be drawn say of these alone."""
    under = ground.ravel()[counts.where]
    weight = np.where(under == DRAWN, counts.weight, np.int16(0))
    full = np.where(under == FULL, counts.weight, np.int16(0)).sum(1, dtype=np.int16)
    left = counts._replace(weight=weight, low=counts.low - full, high=counts.high - full)
    return left.of(np.flatnonzero(weight.any(1)))


def _joined(near: Components, counts: Counts) -> NDArray[np.int32]:
    """The labels of parts, those with one number that a field looks at together."""
    under = near.labels.ravel()[counts.where]
    used = counts.weight > 0
    one = np.where(used, under, near.number + 1).min(1, initial=near.number + 1)
    root = np.arange(near.number + 1, dtype=np.int32)
    pairs = np.stack([np.repeat(one, used.sum(1)), under[used]], axis=1)
    for a, b in np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0).tolist():
        while root[a] != a:
            a = root[a]
        while root[b] != b:
            b = root[b]
        root[max(a, b)] = min(a, b)
    for label in range(near.number + 1):  # a root comes before all that hang on it
        root[label] = root[root[label]]
    joined: NDArray[np.int32] = root[near.labels]
    return joined


def amid(mask: Mask, deep: int) -> Mask:
    """The squares of a mask all of whose neighbours within so many rows or columns are of it."""
    for axis in (0, 1):
        framed = np.pad(mask, [(deep, deep) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
        parts = [np.take(framed, np.arange(k, k + mask.shape[axis]), axis) for k in range(2 * deep + 1)]
        mask = np.logical_and.reduce(parts)
    return mask
