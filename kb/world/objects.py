"""Objects of the world model: nodes made from regions of the map, and from objects that were held.

An object that never moved is a region of the map. One that was held has a place and an outline of its own
(kb.objects.held_object); it is laid upon the map as one more region.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Bools, Labels, Square
from utak.geometry.raster.components import bounding_boxes
from utak.kb.localisation.known.state import TrackerState
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, MapView, OccupancyMap
from utak.kb.mapping.patch import Patch, patch_of, patch_of_polygon
from utak.kb.objects.held_object import COMMAND_ROUNDING, HeldObject, initial_insets, initial_short, outline_tolerance
from utak.kb.objects.movability import MotionHistory, movabilities, square_ways
from utak.kb.objects.persistence import Persistence, persistences
from utak.kb.objects.proportions import corrected_shape
from utak.kb.objects.shape_fit import ShapeMeasurement, measure_seen, measure_whole
from utak.kb.objects.touches import Touches
from utak.kb.perception.frame import ADJACENT_OFFSETS, Frame
from utak.kb.perception.interpretation import (
    LONGEST_OBJECT,
    NO_KINDS,
    Kinds,
    classify_shapes,
    interpret_cut,
    with_taken,
)
from utak.kb.perception.protrusions import (
    VERGE_TOUCH_COLOUR,
    joined_through_walls,
    protrusions,
    separate_things,
    with_embedded_things,
)
from utak.kb.perception.regions import Percept, Region, label_of, region_of
from utak.kb.perception.seams import cornered_parts, part_by_colour
from utak.kb.world.facts import appearance_facts, colour_facts
from utak.kb.world.model import (
    Node,
    WorldModel,
    count_open_squares,
    free_squares,
    occupied_squares,
)

LAID_PROBABILITY = 0.4  # that a square is occupied which the tolerance of a held object's outline leaves open; tuned
# Likewise outside the believed outline: a motion there is hardly stopped, so below MAX_FREE_PROBABILITY
PLAY_PROBABILITY = 0.05
MIN_FELT_SHARE = 2 / 3  # of the length of a long thing at a wall: where less was felt, it may be wall; a convention


class MapRegions(NamedTuple):
    """The regions of the map and their interpretation."""

    percept: Percept  # The regions, and which of them touch or surround each other
    labels: Labels  # The number n of each square's region `part<n>`; 0 where nothing was seen
    kinds: Kinds  # What each region is taken for
    # Masks of squares on which it is to be felt where exactly one of two things that touch ends
    unsettled_seams: tuple[Bools, ...] = ()


def separate_felt_things(
    regions: MapRegions, view: MapView, felt: Mapping[Square, str], rules: tuple[Path, ...] = ()
) -> MapRegions:
    """Return the regions, with things that were felt and stand against the verge, or in it, as regions of their own."""
    percept, labels, kinds, seams = regions
    names = [f"part{n}" for n in range(int(labels.max()) + 1)]
    bounds = np.array([kinds.is_taken(name, "bounds") for name in names])[labels]
    occupied = occupied_squares(view) & bounds
    colours = {view.locate(x, y): colour for (x, y), colour in felt.items()}
    colours = {place: colour for place, colour in colours.items() if occupied[place]}
    if all(colour == VERGE_TOUCH_COLOUR for colour in colours.values()):
        return regions
    labels, cut = labels.copy(), []
    things, unsettled = _felt_things_at_walls(occupied, colours, view)
    for thing in things:
        label = int(labels.max()) + 1
        labels[thing] = label
        cut.append(region_of(thing, f"part{label}", (view.state == OCCUPIED) & view.sure, view.probability))
    touched = [(f"part{labels[place]}", colour) for place, colour in colours.items()]
    apart = {region.name for region in cut}
    found = interpret_cut(cut, (one for one in touched if one[0] in apart), rules) if cut else NO_KINDS
    left = set(np.unique(labels).tolist())
    there = tuple(region for region in (*percept.regions, *cut) if label_of(region.name) in left)
    kinds = kinds._replace(kind={**kinds.kind, **found.kind})
    everywhere = ((f"part{labels[view.locate(x, y)]}", colour) for (x, y), colour in felt.items())
    kinds = with_taken(kinds, there, everywhere, rules)
    return MapRegions(percept._replace(regions=there), labels, kinds, (*seams, *unsettled))


def _felt_things_at_walls(
    occupied: Bools, colours: Mapping[tuple[int, int], str], view: MapView
) -> tuple[list[Bools], list[Bools]]:
    """Return the masks of the things that were felt and stand against the verge, or in it; and of unsettled seams."""
    floor = free_squares(view)
    parts = protrusions(floor, occupied, view.seen)
    partings = [part_by_colour(part, colours) for part in parts if _is_mixed(part, colours)] if view.sure else []
    parts += [part for parting in partings for part in parting.parts]
    things = separate_things(sorted(parts, key=lambda mask: int(mask.sum())), colours)
    unsettled = [seam for parting in partings for seam in parting.unsettled]
    leaning: Callable[[], list[Bools]] = partial(cornered_parts, ~floor, colours)
    far: Callable[[], list[Bools]] = partial(protrusions, floor, occupied, view.seen, colours)
    for candidates in (leaning, far):
        left = [place for place in colours if not any(thing[place] for thing in things)]
        if all(colours[place] == VERGE_TOUCH_COLOUR for place in left):
            break
        parts = [part & occupied for part in candidates() if _is_felt_along(part, left)]
        things += separate_things([p for p in parts if not any((p & thing).any() for thing in things)], colours)
    things = with_embedded_things(things, colours, occupied)
    behind = protrusions(floor, occupied, view.seen, colours, LONGEST_OBJECT)
    return joined_through_walls(things, behind, colours, occupied), unsettled


def _is_mixed(part: Bools, felt: Mapping[tuple[int, int], str]) -> bool:
    """Return whether squares of a part were felt in two colours that are not the verge's."""
    return len({colour for place, colour in felt.items() if part[place]} - {VERGE_TOUCH_COLOUR}) > 1


def _is_felt_along(part: Bools, felt: Iterable[tuple[int, int]]) -> bool:
    """Return whether what was felt of a part stretches over MIN_FELT_SHARE of its longer side."""
    touched = np.zeros_like(part)
    for place in felt:
        touched[place] = part[place]
    if not touched.any():
        return False
    axis = int(np.ptp(np.flatnonzero(part.any(0))) > np.ptp(np.flatnonzero(part.any(1))))
    whole, known = (int(np.ptp(np.flatnonzero(mask.any(1 - axis)))) + 1 for mask in (part, touched))
    return known >= MIN_FELT_SHARE * whole


def seen_objects(
    model: WorldModel,
    assign_names: Callable[[list[Patch]], list[str]],
    touches: Touches,
    rules: tuple[Path, ...] = (),
) -> tuple[Node, ...]:
    """Return a node for each region of the map that is, or may be, an isolated object."""
    regions = [region for region in model.percept.regions if model.kinds.is_taken(region.name, "thing")]
    windows = _windows(model, [label_of(r.name) for r in regions])
    patches = [patch_of(window.mask, window.view) for window in windows]
    names = assign_names(patches)
    measured = {n: measure_seen(p, model.view) for n, p in zip(names, patches, strict=True)}
    colours = (colour_facts(name, touches.colour_of(patch)) for name, patch in zip(names, patches, strict=True))
    shapes, traced = classify_shapes(shape_facts(measured), rules, (fact for facts in colours for fact in facts))
    measured |= {n: m.traced(p) for (n, m), p in zip(measured.items(), patches, strict=True) if n in traced}
    return tuple(
        _seen_node(name, region, window, patch, measured[name], shapes.get(name, {}), model.kinds, touches)
        for name, region, window, patch in sorted(
            zip(names, regions, windows, patches, strict=True), key=lambda entry: int(entry[0][1:])
        )
    )


class _Window(NamedTuple):
    """The part of a map about one region."""

    view: MapView  # The region's containing rectangle, one square wider on each side where the map goes on
    mask: Bools  # The squares of the region, on the arrays of that part


def _windows(model: WorldModel, labels: list[int]) -> list[_Window]:
    """Return the parts of the map about the regions with these labels, in their order."""
    framing = bounding_boxes(model.labels, int(model.labels.max()))
    found = []
    for label in labels:
        south, west, north, east = framing[label].tolist()
        rows, columns = slice(max(south - 1, 0), north + 2), slice(max(west - 1, 0), east + 2)
        found.append(_Window(model.view.part(rows, columns), model.labels[rows, columns] == label))
    return found


def _seen_node(
    name: str,
    region: Region,
    window: _Window,
    patch: Patch,
    measured: ShapeMeasurement,
    shape: Mapping[str, int],
    kinds: Kinds,
    touches: Touches,
) -> Node:
    """Return the node of a region of the map."""
    open_, doubtful = count_open_squares(window.mask, window.view)
    return Node(
        name=name,
        kind="object",
        confidence=kinds.of(region.name, "object"),
        region=region.name,
        patch=patch,
        open=open_,
        vague=doubtful,
        shape=shape,
        polygon=measured.polygon,
        rivals=measured.others,
        colour=touches.colour_of(patch),
        support=_support(window.mask, window.view),
        short=initial_short(measured.polygon),
        insets=initial_insets(measured.polygon),
    )


def _support(mask: Bools, view: MapView) -> tuple[int, ...]:
    """Return the numbers of the impressions that settled the squares of a mask, ascending."""
    # () when nothing is settled.
    numbers = np.unique(view.settled_by[mask & ((view.state == OCCUPIED) | (view.state == FREE))])
    return tuple(int(n) for n in numbers if n >= 0)


def shape_facts(measured: Mapping[str, ShapeMeasurement]) -> list[str]:
    """Return the facts for kb/asp/shapes.lp from the measurements of objects by name, without full stops."""
    facts = []
    for name, result in measured.items():
        facts += [f"open_squares({name},{result.open})", f"full_squares({name},{result.full})"]
        facts += [f"fit({name},{shape},{misfit},{i})" for i, (shape, misfit) in enumerate(result.fits, 1)]
    return facts


def classified(load: HeldObject, rules: tuple[Path, ...] = ()) -> HeldObject:
    """Return an object that was held, classified anew if its shape is open, since it was found to be larger."""
    if load.shape:
        return load
    measured = measure_whole(patch_of_polygon(load.first))
    shapes, _ = classify_shapes(shape_facts({load.name: measured}), rules, colour_facts(load.name, load.colour))
    return replace(load, shape=shapes.get(load.name, {}))


def grasped(node: Node) -> HeldObject:
    """Return an object as it is when it is held for the first time."""
    return HeldObject(
        name=node.name,
        polygon=node.polygon,
        first=node.polygon,
        slack=outline_tolerance(node.polygon),
        insets=initial_insets(node.polygon),
        seen_on=node.patch,
        shape=node.shape,
        colour=node.colour,
        support=node.support,
    )


def within_reach(
    objects: Iterable[Node], touches: Touches, frame: Frame, occupancy: OccupancyMap, square: Square, direction: str
) -> list[Node]:
    """Return the objects of which one may be on the adjacent square in a direction."""
    x, y = square
    adjacent = frame.beside(direction)
    named = None if adjacent is None else (x + adjacent[0], y + adjacent[1])
    there = [n for n in objects if named in n.patch.squares()]
    return there or _felt_objects(objects, touches, frame, occupancy, square, direction)


def _felt_objects(
    objects: Iterable[Node], touches: Touches, frame: Frame, occupancy: OccupancyMap, square: Square, direction: str
) -> list[Node]:
    """Return the objects near the adjacent square in a direction that may have the colour felt there."""
    colour = touches.felt_in(direction)
    x, y = square
    named = [(x + i, y + j) for i, j in frame.adjacent_squares(direction)]
    known = [occupancy.state[occupancy.index(*square)] for square in named]
    if colour is None or all(state == OCCUPIED for state in known):
        return []
    about = {(i + dx, j + dy) for i, j in named for dx, dy in (*ADJACENT_OFFSETS, (0, 0))}
    return [node for node in objects if node.colour in (None, colour) and about & node.patch.squares()]


def with_movability(objects: Iterable[Node], model: WorldModel, rules: tuple[Path, ...] = ()) -> tuple[Node, ...]:
    """Return the objects with what kb/asp/movable.lp and users' rules say of moving them."""
    nodes = tuple(objects)
    tried = [
        MotionHistory(n.name, n.confidence, max(n.patch.mask.shape), n.moved, n.resisted, _room_on(n, model))
        for n in nodes
    ]
    found = movabilities(tried, rules, (fact for node in nodes for fact in appearance_facts(node)))
    now = ((node, found[node.name]) for node in nodes)
    return tuple(replace(n, movable=m.percent, felt_first=m.felt_first, untried=m.untried) for n, m in now)


def _room_on(node: Node, model: WorldModel) -> tuple[str, ...]:
    """Return the ways in which nothing known stands right beside an object; () for one that did not resist."""
    if not node.resisted:
        return ()
    own, occupied = node.patch.squares(), model.view.state == OCCUPIED
    beside = {way: {(x + dx, y + dy) for x, y in own} - own for way, (dx, dy) in square_ways(model.frame).items()}
    return tuple(way for way, there in beside.items() if not occupied[model.squares(there)].any())


def with_persistence(objects: Iterable[Node], memory: TrackerState, rules: tuple[Path, ...] = ()) -> tuple[Node, ...]:
    """Return the objects with what kb/asp/persistence.lp and users' rules say of where they are now."""
    nodes = tuple(objects)
    found = persistences(
        {node.name: memory.frame.place_to_utak(*node.patch.centre) for node in nodes},
        (observation.place for observation in memory.observations),
        memory.changes,
        rules,
        (fact for node in nodes for fact in appearance_facts(node)),
    )
    now = (found.get(node.name, Persistence()) for node in nodes)
    return tuple(
        replace(node, persists=one.percent, looked_at_again=one.again) for node, one in zip(nodes, now, strict=True)
    )


def lay_upon(model: WorldModel, load: HeldObject) -> tuple[WorldModel, Patch]:
    """Lay an object that was held upon the map of a model, as a region of its own."""
    # The robot's own square stays its own, since the robot is a point; but if the object may cover a part of that
    # square, the square is no longer settled. Walls that the object would enter only by the tolerance of its outline
    # stay walls.
    view, labels = model.view, model.labels.copy()
    lies, sure, possible = (
        model.squares(p.squares()) for p in (patch_of_polygon(load.polygon), load.sure, load.possible)
    )
    patch = patch_of(possible & ((view.state != OCCUPIED) | lies), view)
    here = view.locate(*model.place)
    shared = view.state[here] == FREE and possible[here]
    sure[here] = possible[here] = False
    label = int(labels.max()) + 1
    open_ = possible & (view.state != OCCUPIED)
    labels[open_] = label
    state = np.where(sure, np.int8(OCCUPIED), np.where(possible & (view.state == FREE), np.int8(OPEN), view.state))
    outside = open_ & ~lies

    def with_object(chance: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (rows, columns) probabilities, 0 to 1, of squares to be occupied, changed for the object."""
        may = np.where(outside, np.maximum(chance, np.float32(PLAY_PROBABILITY)), np.float32(LAID_PROBABILITY))
        return np.where(sure, np.float32(1), np.where(open_, may, chance))

    probability = with_object(view.probability)
    by_counts = None if view.by_counts is None else with_object(view.by_counts)
    if shared:
        state[here] = OPEN
    seen = view.seen | possible
    kinds = model.kinds._replace(kind={**model.kinds.kind, f"part{label}": {"object": 100}})
    laid = view._replace(state=state.astype(np.int8), probability=probability, by_counts=by_counts, seen=seen)
    return replace(model, view=laid, labels=labels, kinds=kinds), patch


def held_node(load: HeldObject, patch: Patch, label: int) -> Node:
    """Return the node of an object that was held."""
    return Node(
        name=load.name,
        kind="object",
        confidence=100,
        region=f"part{label}",
        patch=patch,
        open=0,
        shape=corrected_shape(load.shape, load.polygon, load.lying_insets),
        polygon=load.polygon,
        colour=load.colour,
        support=load.support,
        moved=load.proven,
        whole=load.whole,
        turned=load.turned,
        resisted=load.resisted,
        dubious=load.dubious,
        inexact=load.inexact,
        astray=load.astray > COMMAND_ROUNDING,
        short=load.short,
        insets=load.lying_insets,
    )
