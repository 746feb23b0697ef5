"""Remapping: all observations and all held objects in another frame.

In Utak's own frame commands are exact: where a motion ended, and how a held object moved with it, do not depend on the
grid. Where an object lay when it was first held does, for that was seen in squares. So for another frame an object is
fitted anew where it was first held, and moved from there as before.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.motion.se2 import Rotate, Translate
from utak.geometry.raster.components import components, with_edge_neighbours
from utak.geometry.shapes.fit import fit_shapes
from utak.kb.localisation.hypotheses.frames import ObjectPose, Observation, Position, observation_squares
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap
from utak.kb.mapping.patch import Patch, patch_of_polygon
from utak.kb.objects.held_object import HeldObject, is_grid_aligned, snap_to_grid, subtract_held_objects
from utak.kb.objects.subcell_extent import SubcellExtent
from utak.kb.perception.frame import Frame

MAX_FRAME_SKEW = 8.0  # degrees between two frames up to which an outline measured in one serves in the other; tuned
MAX_OPEN_SHARE = 0.25  # open squares of an outline, as a share of its full ones, up to which it is fitted anew; tuned
FITTED_OUTLINE_MARGIN = 6  # squares by which an outline fitted anew may reach beyond the old one; tuned
REPLAY_INTERVAL = 16  # observations after which a replay is kept, to go on from there: time against memory; tuned
CORNER_STEPS = sorted(((x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)), key=lambda step: (math.hypot(*step), step))


class RemappedMap(NamedTuple):
    """The occupancy map and the held objects in a frame, by all observations."""

    occupancy: OccupancyMap  # the map
    # All held objects as they lie after the last observation, by name, map frame
    held_objects: Mapping[str, HeldObject]
    # Number of fields that contradict the frame, over all observations; where the replay stopped at the first of them
    # `held_objects` is empty
    residual: int


def object_pose(held: HeldObject, frame: Frame) -> ObjectPose:
    """Return where an object lies, and where it lay when it was first held, in Utak's own frame."""
    # Both as the centroid of its outline, (east, north) in squares, with the degrees by which it was turned since it
    # was first held (counter-clockwise positive), and its tolerance `slack` in squares.
    return ObjectPose(held.name, _centroid(held.polygon, frame), held.turned, held.slack, _centroid(held.first, frame))


class MapReplay:
    """Observations integrated one after the other into a new map, in a frame."""

    def __init__(self, new: Frame, old: Frame) -> None:
        """Begin with an empty map. new : the frame of the new map. old : the frame in which held objects are given."""
        self.new, self.old, self.number = new, old, 0
        self._occupancy, self._residual = OccupancyMap(), 0
        self._taken: dict[str, HeldObject] = {}  # as they lay when they were first held, in the new frame

    def copy(self) -> "MapReplay":
        """Return an independent copy to go on with, the same observations integrated; neither changes the other."""
        other = copy(self)
        other._occupancy, other._taken = self._occupancy.copy(), dict(self._taken)
        return other

    def advance(
        self,
        observations: Sequence[Observation],
        held_objects: Mapping[str, HeldObject],
        stop: int,
        only_whether: bool = False,
    ) -> "MapReplay":
        """Integrate the observations before number `stop` not integrated yet, and return this replay itself."""
        for number in range(self.number, stop):
            if only_whether and self._residual:
                break
            self._take([held for held in held_objects.values() if held.since == number], number)
            observation = observations[number]
            moved = [(self._taken[pose.name], pose) for pose in observation.moved if pose.name in self._taken]
            there = [_moved_to(taken, held_objects[pose.name], pose, self.new) for taken, pose in moved]
            x, y = (math.floor(v) for v in self.new.place_from_utak(*observation.place))
            for (taken, _), now in zip(moved, there, strict=True):
                if taken.touching:
                    self._occupancy.uncover(taken.possible, now.possible, taken.since - 1)
            freed = subtract_held_objects(self.new.samples(), observation.ranges, x, y, there)
            self._residual += self._occupancy.clashes(*freed, x, y)
            self._occupancy.observe(*freed, x, y, number)
            if number == 0:
                self._occupancy.stand(x, y, 0)
            self.number = number + 1
        return self

    @property
    def contradicted(self) -> bool:
        """Return whether any observation integrated so far contradicts the map of those before it in this frame."""
        return self._residual > 0

    def finish(
        self, observations: Sequence[Observation], held_objects: Mapping[str, HeldObject], only_whether: bool = False
    ) -> RemappedMap:
        """Integrate the rest of the observations and return the map. The replay cannot go on afterwards."""
        self.advance(observations, held_objects, len(observations), only_whether)
        if only_whether and self._residual:
            return RemappedMap(self._occupancy, {}, self._residual)
        self._take([held for held in held_objects.values() if held.since >= len(observations)], len(observations))
        now = {
            name: _moved_to(self._taken[name], held, object_pose(held, self.old), self.new)
            for name, held in held_objects.items()
        }
        return RemappedMap(self._occupancy, now, self._residual)

    def _take(self, taken: Iterable[HeldObject], number: int) -> None:
        """Declare floor in the map where objects lay that were first held just before observation `number`."""
        for held in taken:
            lay = self._taken[held.name] = _first_held(held, self.new, self.old, self._occupancy)
            patch = lay.possible
            self._occupancy.make_room(patch.west, patch.south)
            self._occupancy.declare_patch(patch, FREE, number - 1)


def remap(
    new: Frame,
    old: Frame,
    observations: Sequence[Observation],
    held_objects: Iterable[HeldObject],
    begun: MapReplay | None = None,
    only_whether: bool = False,
) -> RemappedMap:
    """Return the map and the held objects in another frame; the arguments are not changed."""
    replay = MapReplay(new, old) if begun is None else begun.copy()
    return replay.finish(observations, {held.name: held for held in held_objects}, only_whether)


class RemapCache:
    """The maps of all frames that were asked for; each ends at its first contradiction, if it has any."""

    def __init__(
        self,
        frame: Frame,
        occupancy: OccupancyMap,
        observations: Sequence[Observation],
        held_objects: Mapping[str, HeldObject],
    ) -> None:
        """Begin with the map of the believed frame, which is taken to be free of contradictions."""
        self._frame, self._observations, self._held_objects = frame, observations, held_objects
        believed = RemappedMap(occupancy, held_objects, 0)
        self._known = {_map_key(frame, observations): (frame, believed)}
        self._by_frame: dict[Frame, RemappedMap] = {}

    def remapped(self, frame: Frame) -> RemappedMap:
        """Return the map and the held objects in a frame; the map must not be changed, for it is kept."""
        if frame not in self._by_frame:
            self._by_frame[frame] = self._found(frame)
        return self._by_frame[frame]

    def _found(self, frame: Frame) -> RemappedMap:
        """Return the map of a frame, and the held objects in it, replayed or shifted from one of the same squares."""
        key, held_objects = _map_key(frame, self._observations), self._held_objects.values()
        if key not in self._known:
            under = remap(frame, self._frame, self._observations, held_objects, only_whether=True)
            self._known[key] = frame, under
            return under
        first, under = self._known[key]
        # The objects were first held where they were believed to lie, but every turn since was about another point
        there = {name: object_at(held, object_pose(held, first), frame) for name, held in under.held_objects.items()}
        return under._replace(held_objects=there)


def _map_key(frame: Frame, observations: Sequence[Observation]) -> tuple[int, bytes]:
    """Return what frames of the same map share: (angle in degrees, the squares of all observations as bytes)."""
    return frame.angle, observation_squares(frame, observations).tobytes()


class ReplayPrefixes:
    """Replays of the first observations in one frame, for any number of them; each observation is integrated once."""

    def __init__(
        self,
        frame: Frame,
        observations: Sequence[Observation],
        held_objects: Mapping[str, HeldObject],
        alike: dict[tuple[int, bytes], MapReplay] | None = None,
    ) -> None:
        """Begin with no observation. alike : replays that frames share, without held objects, by angle and squares."""
        self._observations, self._held_objects = observations, held_objects
        self._known, self._frame, self._alike = {0: MapReplay(frame, frame)}, frame, {} if alike is None else alike

    def first(self, number: int) -> MapReplay:
        """Return the replay of the first `number` observations; it is kept, so copy it before going on with it."""
        if number in self._known:
            return self._known[number]
        key = _map_key(self._frame, self._observations[:number])
        if key in self._alike:  # every observation fell on the same square
            self._known[number] = replay = self._alike[key].copy()
            replay.new = replay.old = self._frame
            return replay
        nearest = max(n for n in self._known if n < number)
        replay = self._known[nearest].copy()
        begin = nearest + 1 + REPLAY_INTERVAL - (nearest + 1) % REPLAY_INTERVAL
        for stop in (*range(begin, number, REPLAY_INTERVAL), number):
            self._known[stop] = replay.advance(self._observations, self._held_objects, stop).copy()
        self._alike[key] = self._known[number]
        return self._known[number]


def object_at(held: HeldObject, pose: ObjectPose, frame: Frame) -> HeldObject:
    """Return a held object where it lay at another time, map frame: its outline turned and shifted to that pose."""
    return _moved_to(held, held, pose, frame)


def _first_held(held: HeldObject, new: Frame, old: Frame, occupancy: OccupancyMap) -> HeldObject:
    """Return an object as it lay when it was first held, in the new frame."""
    skew = new.angle - old.angle
    askew = 90 * round(skew / 90) - skew
    middle = new.place_from_utak(*_centroid(held.first, old))
    first, skewed = _placed(held.first, skew, middle), held.skewed or abs(askew) > MAX_FRAME_SKEW
    straight = is_grid_aligned(held.first)
    seen = None if straight and abs(askew) <= MAX_FRAME_SKEW else _fitted_outline(patch_of_polygon(first), occupancy)
    if seen is not None:
        first, skewed = seen, False
    elif straight:
        first = _straightened(Rotate(askew, middle).carry(first), occupancy)
    lying = held.lying(first)
    insets = (
        held.insets if skew == 0.0 and seen is None else SubcellExtent() if is_grid_aligned(lying.polygon) else None
    )
    return replace(lying, first=lying.polygon, skewed=skewed, insets=insets, seen_on=None)


def _straightened(polygon: Any, occupancy: OccupancyMap) -> Any:
    """Return an outline with its corners on grid corners, shifted to where the map contradicts it least."""
    x0, y0 = polygon.bounds[:2]
    nearest = Translate(round(x0) - x0, round(y0) - y0).carry(polygon)
    lying = [
        snap_to_grid(shapely.transform(nearest, lambda points, s=step: points + np.array(s))) for step in CORNER_STEPS
    ]
    return min(lying, key=lambda other: _count_disagreements(other, occupancy))


def _fitted_outline(patch: Patch, occupancy: OccupancyMap) -> Any:
    """Return the outline fitted to what was seen about a patch, shapely Polygon, map frame."""
    # None when too much of it is open, when it goes on beyond the surroundings of the patch, or when no shape fits
    # exactly.
    own = np.pad(patch.mask, FITTED_OUTLINE_MARGIN)
    state = occupancy.window(patch.west - FITTED_OUTLINE_MARGIN, patch.south - FITTED_OUTLINE_MARGIN, own.shape)
    labels = components(state != FREE).labels
    met = np.bincount(labels[own & (labels > 0)], minlength=1)
    part = labels == met.argmax()
    full, possible = part & (state == OCCUPIED), part & (state == OPEN)
    inside = part[1:-1, 1:-1].sum() == part.sum()
    if not met.any() or not inside or possible.sum() > MAX_OPEN_SHARE * full.sum():
        return None
    best = fit_shapes(full, possible)[0]
    if best.misfit:
        return None
    corner = np.array([patch.west - FITTED_OUTLINE_MARGIN, patch.south - FITTED_OUTLINE_MARGIN])
    return shapely.transform(best.polygon, lambda points: points + corner)


def _count_disagreements(polygon: Any, occupancy: OccupancyMap) -> int:
    """Return how many squares disagree with an outline: free ones under it, occupied ones right beside it."""
    patch = patch_of_polygon(polygon)
    own = np.pad(patch.mask, 1)
    about = with_edge_neighbours(own)
    state = occupancy.window(patch.west - 1, patch.south - 1, own.shape)
    return int(((state == FREE) & own).sum() + ((state == OCCUPIED) & about & ~own).sum())


def _moved_to(taken: HeldObject, held: HeldObject, pose: ObjectPose, new: Frame) -> HeldObject:
    """Return an object at a pose, map frame of `new`."""
    began = np.array([_centroid(taken.first, new)]) - pose.taken
    aside = Rotate(pose.degrees, (0.0, 0.0)).points(began)[0]
    middle = new.place_from_utak(pose.middle[0] + float(aside[0]), pose.middle[1] + float(aside[1]))
    lying = held.lying(_placed(taken.first, pose.degrees, middle), pose.slack)
    return replace(lying, first=taken.first, skewed=taken.skewed, insets=taken.insets, seen_on=None)


def _placed(polygon: Any, degrees: float, middle: Position) -> Any:
    """Return a shapely polygon turned by `degrees` (counter-clockwise positive), with its centroid at `middle`."""
    centre = polygon.centroid
    turned = Rotate(degrees, (centre.x, centre.y)).carry(polygon)
    return Translate(middle[0] - centre.x, middle[1] - centre.y).carry(turned)


def _centroid(polygon: Any, frame: Frame) -> Position:
    """Return the centroid of a shapely polygon of the map frame as (east, north) in squares, Utak's own frame."""
    centre = polygon.centroid
    return frame.place_to_utak(centre.x, centre.y)
