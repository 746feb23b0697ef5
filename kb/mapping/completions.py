"""Completions: sampled maps that agree with all counts, drawn scene by scene and kept from impression to impression.

The squares that no count settles fall into independent scenes: no field covers squares of two scenes, and settled
squares lie in between. The samples of a scene stay as they are until an impression says something new of it; then each
sample is drawn on from what it was, since most of it is still right. Samples are drawn by geometry.counts.gibbs (a
Gibbs sampler on an Ising prior, Geman and Geman 1984), and resampled by their costs.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.gibbs import DRAWN, FREE, OCCUPIED, UNSEEN_SQUARE, Counts, costs, pictures
from utak.geometry.kernels.arrays import Bools, Floats, Labels, Longs
from utak.geometry.raster.components import Components, bounding_boxes, components
from utak.kb.mapping.occupancy import OPEN, MapView
from utak.kb.mapping.occupancy_odds import STRAY_COUNT

MAX_COMPLETIONS = 12  # completions of a map; tuned on random worlds (benchmarks.campaign)
DRAWS_PER_COMPLETION = 2  # samples drawn for each completion that is kept; tuned
COST_WEIGHT = 0.3  # a sample that costs less by 1 is kept more often, by this power of e; tuned
COMPLETION_SEED = 20031  # of the random numbers; convention
FIRST_SCHEDULE = (60, 0.5)  # sweeps over a scene that was not drawn yet, and the first inverse temperature; tuned
NEXT_SCHEDULE = (30, 1.0)  # likewise over a scene most of which was drawn before; tuned
INTERIOR_DEPTH = 2  # squares: what is probably occupied, or free, so far from its edge is not drawn; tuned
# From which it is probably occupied: under a field of the last level that may miss a square
INTERIOR_PROBABILITY = 0.93
START_PROBABILITY = 0.5  # from which a square is occupied in the first sample: more likely than not
OccupancyImage = NDArray[np.int8]
SceneKey = tuple[int | bytes, ...]  # all that determines the samples of a scene


class CompletionTask(NamedTuple):
    """A scene to be drawn: a part of the map that is independent of all others."""

    rows: slice  # Where it lies on the arrays of the map view
    columns: slice
    # What is given of each square: FREE, OCCUPIED, DRAWN (to be drawn) or UNSEEN_SQUARE (also: squares of other scenes)
    ground: OccupancyImage
    # Where a sample begins that was not drawn before: 1 where a square is more likely occupied than not
    first: OccupancyImage
    counts: Counts  # The counts of the squares to be drawn alone, with flat indices of the part: row * w + column

    def __eq__(self, other: object) -> bool:
        """Return whether the same is given of a scene, wherever it lies."""
        return isinstance(other, CompletionTask) and self._given == other._given

    def __hash__(self) -> int:
        """Return a hash of what is given of it."""
        return hash(self._given)

    @property
    def _given(self) -> tuple[tuple[int, ...] | bytes, ...]:
        """Return all that determines its samples but its place and what was drawn before."""
        return self.ground.shape, *(array.tobytes() for array in (self.ground, self.first, *self.counts))

    def told(self, view: MapView) -> SceneKey:
        """Return a key of all that determines its samples, its place included: equal keys mean equal scenes."""
        arrays = (self.ground, *self.counts)
        return view.west + self.columns.start, view.south + self.rows.start, *(array.tobytes() for array in arrays)


class Completions(NamedTuple):
    """Completions of a map: sampled maps that agree with all counts."""

    west: int  # The square at [0, 0], map frame
    south: int
    ground: OccupancyImage  # What was given of each square: FREE, OCCUPIED, DRAWN or UNSEEN_SQUARE
    images: OccupancyImage  # The completions: 1 where a square is occupied, 0 where it is free or was never seen
    # Key of a scene -> its samples at the n squares drawn, (MAX_COMPLETIONS, n) int8, in raster order
    scenes: Mapping[SceneKey, OccupancyImage]

    def at(self, x: int, y: int) -> Bools | None:
        """Return which completions show a square (x, y) of the map frame occupied, (MAX_COMPLETIONS,) bool."""
        # None where the square was never seen, or lies beyond the arrays.
        row, column = y - self.south, x - self.west
        inside = 0 <= row < self.ground.shape[0] and 0 <= column < self.ground.shape[1]
        if not inside or self.ground[row, column] == UNSEEN_SQUARE:
            return None
        shown: Bools = self.images[:, row, column] > 0
        return shown

    def over(self, scene: CompletionTask, view: MapView) -> "Completions":
        """Return the part that lies where a scene of another map view lies, without samples of scenes."""
        south, west = view.south + scene.rows.start - self.south, view.west + scene.columns.start - self.west
        ground: OccupancyImage = np.full(scene.ground.shape, UNSEEN_SQUARE, np.int8)
        images = np.zeros((len(self.images), *ground.shape), np.int8)
        (high, wide), (rows, columns) = ground.shape, self.ground.shape
        top, right = max(min(high, rows - south), 0), max(min(wide, columns - west), 0)
        low, left = min(max(-south, 0), top), min(max(-west, 0), right)
        own = slice(low + south, top + south), slice(left + west, right + west)
        ground[low:top, left:right] = self.ground[own]
        images[:, low:top, left:right] = self.images[:, own[0], own[1]]
        return Completions(self.west + west, self.south + south, ground, images, {})


NO_COMPLETIONS = Completions(0, 0, np.zeros((0, 0), np.int8), np.zeros((MAX_COMPLETIONS, 0, 0), np.int8), {})


def given_squares(view: MapView) -> OccupancyImage:
    """Return what is given when completions are drawn: settled squares, and the interior of what is surely alike."""
    ground = np.where(view.seen, np.where(view.state == OPEN, DRAWN, view.state), UNSEEN_SQUARE).astype(np.int8)
    drawn = ground == DRAWN
    ground[drawn & _interior(view.probability > INTERIOR_PROBABILITY, INTERIOR_DEPTH)] = OCCUPIED
    ground[drawn & _interior(~view.seen | (view.probability <= STRAY_COUNT), INTERIOR_DEPTH)] = FREE
    return ground


def draw_completions(view: MapView, ground: OccupancyImage, before: Completions) -> Completions:
    """Draw MAX_COMPLETIONS (12) completions that agree with the counts, and return them on the arrays of the view."""
    images = np.repeat((ground == OCCUPIED).astype(np.int8)[None], MAX_COMPLETIONS, axis=0)
    drawn = {}
    for scene in scenes(view, ground):
        key = scene.told(view)
        known = before.scenes.get(key)
        drawn[key] = _draw_scene(scene, before.over(scene, view)) if known is None else known
        images[:, scene.rows, scene.columns][:, scene.ground == DRAWN] = drawn[key]
    return Completions(view.west, view.south, ground, images, drawn)


def _draw_scene(scene: CompletionTask, before: Completions) -> OccupancyImage:
    """Return samples of a scene at the n squares that are to be drawn, (MAX_COMPLETIONS, n) int8, 1 where occupied."""
    open_ = scene.ground == DRAWN
    known = open_ & (before.ground != UNSEEN_SQUARE)
    sweeps, hot = NEXT_SCHEDULE if known.sum() > open_.sum() / 2 else FIRST_SCHEDULE
    first = np.repeat(np.where(known, before.images, scene.first), DRAWS_PER_COMPLETION, axis=0)
    drawn = pictures(scene.ground, scene.counts, first, sweeps, hot, COMPLETION_SEED)
    return drawn[_resample(costs(drawn, scene.ground, scene.counts))][:, open_]


def _resample(costs: Floats) -> Longs:
    """Return which samples are kept, (MAX_COMPLETIONS,) indices, in ascending order and with repetitions."""
    weight = np.cumsum(np.exp(-COST_WEIGHT * (costs - costs.min())))
    marks = (np.arange(MAX_COMPLETIONS) + 0.5) / MAX_COMPLETIONS
    kept: Longs = np.searchsorted(weight, marks * weight[-1])
    return kept


def scenes(view: MapView, ground: OccupancyImage) -> Iterator[CompletionTask]:
    """Yield the independent scenes of a map; none where no square is to be drawn."""
    open_ = ground == DRAWN
    counts = _counts_of_drawn(view.counts, ground)
    near = components(~_interior(~open_, 1))
    labels = _joined_labels(near, counts)
    labels[~open_] = 0
    owner = labels.ravel()[counts.where[np.arange(len(counts.where)), (counts.weight > 0).argmax(1)]]
    order = np.argsort(owner, kind="stable")
    first = (view.probability > START_PROBABILITY).astype(np.int8)
    for label, (south, west, north, east) in enumerate(bounding_boxes(labels, near.number).tolist()):
        if label == 0 or north < 0:
            continue
        rows, columns = slice(max(south - 1, 0), north + 2), slice(max(west - 1, 0), east + 2)
        own = labels[rows, columns] == label
        part = ground[rows, columns]
        part = np.where(own | (part != DRAWN), part, np.int8(UNSEEN_SQUARE))
        begin, end = np.searchsorted(owner[order], [label, label + 1])
        under = counts.of(order[begin:end])
        up, along = np.divmod(under.where, ground.shape[1])
        inside = (up - rows.start) * part.shape[1] + along - columns.start
        under = under._replace(where=np.where(under.weight > 0, inside, 0).astype(np.int32))
        yield CompletionTask(rows, columns, part, first[rows, columns], under)


def _counts_of_drawn(counts: Counts, ground: OccupancyImage) -> Counts:
    """Return what the fields that cover squares to be drawn say of these squares alone; other fields are left out."""
    under = ground.ravel()[counts.where]
    weight = np.where(under == DRAWN, counts.weight, np.int16(0))
    full = np.where(under == OCCUPIED, counts.weight, np.int16(0)).sum(1, dtype=np.int16)
    left = counts._replace(weight=weight, low=counts.low - full, high=counts.high - full)
    return left.of(np.flatnonzero(weight.any(1)))


def _joined_labels(near: Components, counts: Counts) -> Labels:
    """Return the labels of parts, (rows, columns) int32; parts that one field covers together have one label."""
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
    for label in range(near.number + 1):  # a root has a smaller number than all below it
        root[label] = root[root[label]]
    joined: Labels = root[near.labels]
    return joined


def _interior(mask: Bools, depth: int) -> Bools:
    """Return the squares of a mask whose neighbours within `depth` rows and columns all belong to it."""
    for axis in (0, 1):
        framed = np.pad(mask, [(depth, depth) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
        parts = [np.take(framed, np.arange(k, k + mask.shape[axis]), axis) for k in range(2 * depth + 1)]
        mask = np.logical_and.reduce(parts)
    return mask
