"""Objects of the world model: nodes made from regions of the map, and from objects that were held.

An object that never moved is a region of the map. One that was held has a place and an outline of its own
(kb.objects.held_object); it is laid upon the map as one more region.
"""

from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import Bools, Labels, Square
from geometry.raster.components import bounding_boxes
from kb.mapping.occupancy import FREE, OCCUPIED, OPEN, MapView, OccupancyMap
from kb.mapping.patch import Patch, patch_of, patch_of_polygon
from kb.objects.held_object import COMMAND_ROUNDING, HeldObject, initial_insets, initial_short, outline_tolerance
from kb.objects.proportions import corrected_shape
from kb.objects.shape_fit import ShapeMeasurement, ShapeMeasurer
from kb.objects.touches import Touches
from kb.perception.frame import ADJACENT_OFFSETS, Frame
from kb.perception.interpretation import FELT_OBJECT_CONFIDENCE, LONGEST_OBJECT, Kinds, classify_shapes
from kb.perception.protrusions import (
    VERGE_TOUCH_COLOUR,
    joined_through_walls,
    protrusions,
    separate_things,
    with_embedded_things,
)
from kb.perception.regions import Percept, Region, label_of
from kb.perception.seams import cornered_parts, part_by_colour
from kb.world.facts import colour_facts
from kb.world.model import Node, WorldModel, count_open_squares, free_squares, occupied_squares

MIN_OBJECT_BELIEF = 5  # percent: a region less likely an object is no node: the least that interpretation.lp gives
LAID_PROBABILITY = 0.4  # that a square is occupied which the tolerance of a held object's outline leaves open; tuned
PLAY_PROBABILITY = (
    0.05  # likewise outside the believed outline: a motion there is hardly stopped, so below MAX_FREE_PROBABILITY
)
MIN_FELT_SHARE = 2 / 3  # of the length of a long thing at a wall: where less was felt, it may be wall; a convention
MIN_STUCK_MOTIONS = 3  # pushes or turns in a row that did not move an object: from then on it cannot be moved; tuned


class MapRegions(NamedTuple):
    """The regions of the map and their interpretation.

    Attributes
    ----------
    percept : Percept
        The regions, and which of them touch or surround each other.
    labels : (rows, columns) int32 on the arrays of the map view, row 0 in the south
        The number n of each square's region `part<n>`; 0 where nothing was seen.
    kinds : Kinds
        What each region is taken for.
    unsettled_seams : tuple of (rows, columns) bool
        Masks of squares on which it is to be felt where exactly one of two things that touch ends.
    """

    percept: Percept
    labels: Labels
    kinds: Kinds
    unsettled_seams: tuple[Bools, ...] = ()


def separate_felt_things(regions: MapRegions, view: MapView, felt: Mapping[Square, str]) -> MapRegions:
    """Return the regions, with things that were felt and stand against the verge, or in it, as regions of their own.

    Of a thing that fills a gap in the verge only the squares that were felt are known to belong to it.

    Parameters
    ----------
    regions : MapRegions
        The regions as they were seen: a thing that touches a wall is one region with it.
    view : MapView
        The occupancy of the squares.
    felt : mapping of (x, y) to str
        The colours of squares that were felt, map frame; VERGE_TOUCH_COLOUR where it was verge.

    Returns
    -------
    MapRegions
        `regions` itself where nothing but verge was felt. Else each thing has a label and a name `part<n>` beyond all
        others, and is an object with FELT_OBJECT_CONFIDENCE percent; regions of which no square is left are dropped.
        The numbers of the other regions stay. The result holds the regions, old ones first, the number of each square's
        region on the arrays of the map view, and what each region is taken for.
    """
    percept, labels, kinds, seams = regions
    bounds = np.array([kinds.of(f"part{n}", "object") == 0 for n in range(int(labels.max()) + 1)])[labels]
    occupied = occupied_squares(view) & bounds
    colours = {view.locate(x, y): colour for (x, y), colour in felt.items()}
    colours = {place: colour for place, colour in colours.items() if occupied[place]}
    if all(colour == VERGE_TOUCH_COLOUR for colour in colours.values()):
        return regions
    labels, separated, kind = labels.copy(), [*percept.regions], dict(kinds.kind)
    things, unsettled = _felt_things_at_walls(occupied, colours, view)
    for thing in things:
        label = int(labels.max()) + 1
        labels[thing] = label
        separated.append(_separated_region(thing, label, view))
        kind[f"part{label}"] = {"object": FELT_OBJECT_CONFIDENCE}
    left = set(np.unique(labels).tolist())
    there = tuple(region for region in separated if label_of(region.name) in left)
    return MapRegions(percept._replace(regions=there), labels, kinds._replace(kind=kind), (*seams, *unsettled))


def _felt_things_at_walls(
    occupied: Bools, colours: Mapping[tuple[int, int], str], view: MapView
) -> tuple[list[Bools], list[Bools]]:
    """Return the masks of the things that were felt and stand against the verge, or in it; and of unsettled seams.

    What sticks out a little is likeliest a thing; else what the lines between inner corners part from the wall, or what
    sticks out further, if most of its length was felt; else the felt squares alone. What sticks out and was felt in
    the colours of several things is parted where these touch.

    occupied : (rows, columns) bool on the view's arrays, squares of what bounds the floor. colours : the colour of each
    felt square (row, column) of these arrays.
    """
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
    """Return whether what was felt of a part stretches over MIN_FELT_SHARE of its longer side.

    part : (rows, columns) bool. felt : the squares (row, column) that were felt.
    """
    touched = np.zeros_like(part)
    for place in felt:
        touched[place] = part[place]
    if not touched.any():
        return False
    axis = int(np.ptp(np.flatnonzero(part.any(0))) > np.ptp(np.flatnonzero(part.any(1))))
    whole, known = (int(np.ptp(np.flatnonzero(mask.any(1 - axis)))) + 1 for mask in (part, touched))
    return known >= MIN_FELT_SHARE * whole


def _separated_region(thing: Bools, label: int, view: MapView) -> Region:
    """Return the region `part<label>` of a thing that stands against the verge.

    It holds the name, that it is occupied, the percent of its squares that are settled as occupied, that it touches
    nothing unseen, its longer side in squares, and its mass (expected occupied squares) in tenths of squares. `thing`
    is its (rows, columns) mask on the view's arrays, with at least one square.
    """
    rows, columns = np.nonzero(thing)
    settled = int(100 * (view.state[thing] == OCCUPIED).sum() // len(rows))
    extent = int(max(np.ptp(rows), np.ptp(columns))) + 1
    return Region(f"part{label}", True, settled, False, extent, round(10 * float(view.probability[thing].sum())))


def seen_objects(
    model: WorldModel,
    assign_names: Callable[[list[Patch]], list[str]],
    measurer: ShapeMeasurer,
    touches: Touches,
    rules: tuple[Path, ...] = (),
) -> tuple[Node, ...]:
    """Return a node for each region of the map that is, or may be, an isolated object.

    Parameters
    ----------
    model : WorldModel
        The world model without objects.
    assign_names : function
        Returns a name `o<n>` for each patch of squares, in the order of the patches (ObjectNames.assign).
    measurer : ShapeMeasurer
        Fits shapes to patches.
    touches : Touches
        What was felt, for the objects' colours.
    rules : tuple of Path
        Files with the user's own encodings, solved together with kb/asp/shapes.lp.

    Returns
    -------
    tuple of Node
        By the number in their names; () when there are none. A node holds the region's name, its squares as a patch and
        its believed outline (map frame, in squares; None when no shape fits), shape classes and the belief that it is
        an object in percent, its colour or None, and how many squares are not determined.

    Raises
    ------
    BadInputError
        The user's encodings are wrong.
    """
    felt = _felt_things(model)
    regions = [r for r in model.percept.regions if _may_be_object(r, model.kinds, felt)]
    windows = _windows(model, [label_of(r.name) for r in regions])
    patches = [patch_of(window.mask, window.view) for window in windows]
    names = assign_names(patches)
    measured = {n: measurer.measure(p, model.view) for n, p in zip(names, patches, strict=True)}
    colours = (colour_facts(name, touches.colour_of(patch)) for name, patch in zip(names, patches, strict=True))
    shapes = classify_shapes(shape_facts(measured), rules, (fact for facts in colours for fact in facts))
    return tuple(
        _seen_node(name, region, window, patch, measured[name], shapes.get(name, {}), model.kinds, touches)
        for name, region, window, patch in sorted(
            zip(names, regions, windows, patches, strict=True), key=lambda entry: int(entry[0][1:])
        )
    )


def _may_be_object(region: Region, kinds: Kinds, felt: Container[int]) -> bool:
    """Return whether a region is short enough for an object, and an object with at least MIN_OBJECT_BELIEF percent.

    Short enough is an extent of at most LONGEST_OBJECT squares; what was felt to be an object may be longer. `kinds`
    has the confidences in what each region is, `felt` the labels of regions that were felt to be no verge.
    """
    short = region.extent <= LONGEST_OBJECT or label_of(region.name) in felt
    return short and kinds.of(region.name, "object") >= MIN_OBJECT_BELIEF


def _felt_things(model: WorldModel) -> set[int]:
    """Return the labels of the regions on which a colour was felt, and nowhere that of the verge."""
    labels: dict[bool, set[int]] = {True: set(), False: set()}
    for (x, y), colour in model.felt.items():
        labels[colour == VERGE_TOUCH_COLOUR].add(int(model.labels[model.view.locate(x, y)]))
    return labels[False] - labels[True]


class _Window(NamedTuple):
    """The part of a map about one region.

    Attributes
    ----------
    view : MapView
        The region's containing rectangle, one square wider on each side where the map goes on.
    mask : (rows, columns) bool
        The squares of the region, on the arrays of that part.
    """

    view: MapView
    mask: Bools


def _windows(model: WorldModel, labels: list[int]) -> list[_Window]:
    """Return the parts of the map about the regions with these labels, in their order.

    A label n is that of the region `part<n>`. Each holds the view of the region's containing rectangle, one square
    wider on each side where the map goes on, and the (rows, columns) mask of the region on the arrays of that view.
    """
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
    """Return the node of a region of the map.

    It holds the squares and the outline (map frame, in squares; None when no shape fits), the belief in percent that it
    is an object, its shape classes and colour, the impressions that settled its squares, and by how much its sides may
    lie further in, as of an object that never moved.

    name : that of the node, `o<n>`.
    window : the map about the region.
    patch : the region's squares, map frame.
    measured : its fits and outline.
    shape : shape class -> confidence in percent.
    kinds : what each region is taken for.
    touches : felt colours.
    """
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
        colour=touches.colour_of(patch),
        support=_support(window.mask, window.view),
        short=initial_short(measured.polygon),
        insets=initial_insets(measured.polygon),
    )


def _support(mask: Bools, view: MapView) -> tuple[int, ...]:
    """Return the numbers of the impressions that settled the squares of a mask, ascending; () when nothing is settled.

    The mask is (rows, columns) bool on the view's arrays.
    """
    numbers = np.unique(view.settled_by[mask & ((view.state == OCCUPIED) | (view.state == FREE))])
    return tuple(int(n) for n in numbers if n >= 0)


def shape_facts(measured: Mapping[str, ShapeMeasurement]) -> list[str]:
    """Return the facts for kb/asp/shapes.lp from the measurements of objects by name, without full stops.

    For each object N: `open_squares(N,Count)`, `full_squares(N,Count)`, and for each shape class that fits
    `fit(N,Class,Misfit,Rank)`: the number of squares that it leaves wrong, and its rank from 1, the likeliest.
    """
    facts = []
    for name, result in measured.items():
        facts += [f"open_squares({name},{result.open})", f"full_squares({name},{result.full})"]
        facts += [f"fit({name},{shape},{misfit},{i})" for i, (shape, misfit) in enumerate(result.fits, 1)]
    return facts


def classified(load: HeldObject, measurer: ShapeMeasurer, rules: tuple[Path, ...] = ()) -> HeldObject:
    """Return an object that was held, classified anew if its shape is open, since it was found to be larger.

    Its shape is then measured from where it lay when it was first held. The result is a new object that differs in
    `shape` alone (shape class -> confidence in percent; {} when nothing fits), with its outline in the map frame.

    Parameters
    ----------
    load : HeldObject
        The object; it is returned as it is when its shape is not {}.
    measurer : ShapeMeasurer
        Fits shapes to the squares of its outline.
    rules : tuple of Path
        Files with the user's own encodings, solved together with kb/asp/shapes.lp.

    Raises
    ------
    BadInputError
        The user's encodings are wrong.
    """
    if load.shape:
        return load
    measured = measurer.measure_whole(patch_of_polygon(load.first))
    shapes = classify_shapes(shape_facts({load.name: measured}), rules, colour_facts(load.name, load.colour))
    return replace(load, shape=shapes.get(load.name, {}))


def grasped(node: Node) -> HeldObject:
    """Return an object as it is when it is held for the first time.

    The outline of the node must be known. The object lies where the node's outline lies, map frame, in squares, and was
    not turned, nor seen to move; name, shape, colour and the impressions that support it are the node's. Its outline is
    exact where its corners are on the grid; then its sides may lie less than 1 square further in.
    """
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
    """Return the objects of which one may be on the adjacent square in a direction.

    These are the objects that may cover that square; they are returned as their nodes. Without any: the objects near
    it, if the colour felt there may be theirs, and if the squares that the direction may name are not all settled as
    occupied, as a wall is.

    Parameters
    ----------
    objects : iterable of Node
        The objects believed in.
    touches : Touches
        What is felt now.
    frame : Frame
        The believed frame.
    occupancy : OccupancyMap
        The map.
    square : (x, y)
        The robot's square, map frame.
    direction : str
        One of the eight DIRECTIONS of the robot frame.

    Returns
    -------
    list of Node
        In the order of `objects`; [] when there is none.
    """
    x, y = square
    adjacent = frame.beside(direction)
    named = None if adjacent is None else (x + adjacent[0], y + adjacent[1])
    there = [n for n in objects if named in n.patch.squares()]
    return there or _felt_objects(objects, touches, frame, occupancy, square, direction)


def _felt_objects(
    objects: Iterable[Node], touches: Touches, frame: Frame, occupancy: OccupancyMap, square: Square, direction: str
) -> list[Node]:
    """Return the objects near the adjacent square in a direction that may have the colour felt there.

    Near are those that may cover one of the squares that the direction may name, or one of the 8 squares about these.
    An object whose colour is not known may have any. [] when floor is felt, or when the squares that the direction may
    name are all settled as occupied. The nodes come in the order of `objects`.

    touches : what is felt now in each direction.
    frame : the believed frame, which tells the squares that a direction may name.
    occupancy : the map, with what the counts settle of each square.
    square : the robot's own square (x, y), map frame.
    direction : one of the eight DIRECTIONS of the robot frame.
    """
    colour = touches.felt_in(direction)
    x, y = square
    named = [(x + i, y + j) for i, j in frame.adjacent_squares(direction)]
    known = [occupancy.state[occupancy.index(*square)] for square in named]
    if colour is None or all(state == OCCUPIED for state in known):
        return []
    about = {(i + dx, j + dy) for i, j in named for dx, dy in (*ADJACENT_OFFSETS, (0, 0))}
    return [node for node in objects if node.colour in (None, colour) and about & node.patch.squares()]


def lay_upon(model: WorldModel, load: HeldObject) -> tuple[WorldModel, Patch]:
    """Lay an object that was held upon the map of a model, as a region of its own.

    The robot's own square stays its own, since the robot is a point; but if the object may cover a part of that square,
    the square is no longer settled. Walls that the object would enter only by the tolerance of its outline stay walls.

    The squares that it surely covers become occupied. Those that it may cover become unsettled where they were free;
    they are occupied with LAID_PROBABILITY within its believed outline, and with PLAY_PROBABILITY at least outside of
    it.

    Parameters
    ----------
    model : WorldModel
        The world model without the object.
    load : HeldObject
        The object.

    Returns
    -------
    model : WorldModel
        A new model with one more region, the last one: its number is the greatest in `labels`, and it is an object with
        100 percent. View (states, probabilities, seen squares), labels and kinds are changed; `percept` and `objects`
        are not. Where the object may cover no square but settled walls, no square has the new number.
    patch : Patch
        The squares that the object covers, or may cover; map frame.
    """
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
        """Return (rows, columns) probabilities, 0 to 1, of squares to be occupied, changed for the object.

        `chance` are those without it, on the view's arrays; a new array is returned.
        """
        may = np.where(outside, np.maximum(chance, np.float32(PLAY_PROBABILITY)), np.float32(LAID_PROBABILITY))
        return np.where(sure, np.float32(1), np.where(open_, may, chance))

    probability = with_object(view.probability)
    by_counts = None if view.by_counts is None else with_object(view.by_counts)
    if shared:
        state[here] = OPEN
    seen = view.seen | possible
    kinds = Kinds({**model.kinds.kind, f"part{label}": {"object": 100}}, model.kinds.hidden_passages)
    laid = view._replace(state=state.astype(np.int8), probability=probability, by_counts=by_counts, seen=seen)
    return replace(model, view=laid, labels=labels, kinds=kinds), patch


def held_node(load: HeldObject, patch: Patch, label: int) -> Node:
    """Return the node of an object that was held.

    It can be moved with 99 percent belief when it was seen to move, with 0 after MIN_STUCK_MOTIONS motions in a row
    that did not move it, else with 50. The node holds the squares and the believed outline (map frame, in squares), the
    region's name, shape and colour as before the grasp, the degrees by which it was turned (counter-clockwise
    positive), and that it is an object with 100 percent.

    Parameters
    ----------
    load : HeldObject
        The object that was held, where it is believed to lie now; map frame.
    patch : Patch
        The squares that it covers, or may cover; map frame.
    label : int
        The number n of its region `part<n>`.
    """
    movable = 99 if load.proven else 0 if load.stuck >= MIN_STUCK_MOTIONS else 50
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
        movable=movable,
        moved=load.proven,
        whole=load.whole,
        turned=load.turned,
        stuck=load.stuck,
        dubious=load.dubious,
        inexact=load.inexact,
        astray=load.astray > COMMAND_ROUNDING,
        short=load.short,
        insets=load.lying_insets,
    )
