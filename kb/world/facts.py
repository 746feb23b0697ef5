"""The world model as facts, and as the `belief` of an episode's line (docs/reference/vocabulary.md).

Lengths are hundredths of squares in the robot frame, whose origin is where the robot woke. Confidences are percent.
"""

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools, Floats, Longs
from utak.geometry.raster.contours import Ring, outline
from utak.kb.language.atoms import atom_parts, short_form, signature_of
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.vocabulary import BELIEF_PREDICATES
from utak.kb.localisation.field_account import Accommodation
from utak.kb.mapping.occupancy import OPEN
from utak.kb.objects.parts import parts_of
from utak.kb.reasoning.interfaces import WORLD_FACTS_THERE
from utak.kb.reasoning.user_rules import predicates_read
from utak.kb.world.chances import Chances
from utak.kb.world.corners import Corner
from utak.kb.world.evidence import evidence
from utak.kb.world.model import FACT_UNITS_PER_SQUARE, FLOOR_NODE, ROOT_NODE, VERGE_NODE, Node, WorldModel, hundredths
from utak.kb.world.pathgraph import pathgraph_facts
from utak.kb.world.rooms import Door, Rooms

SEGMENT_SAMPLES = 8  # places along a segment at which the squares on both sides of it are looked up; convention
SETTLED_CONFIDENCE = 99  # percent: belief in a square that the counts settle, but not beyond doubt; convention
FELT_COLOUR_CONFIDENCE = 99  # percent: belief in a colour that was felt; convention
SHORTENED = frozenset(name for (name, _), declared in BELIEF_PREDICATES.items() if declared.short)
ROBOT_AS_NODE = re.compile(rf"\b{ROOT_NODE}\b")  # the robot where it is a node; plans call it utak


class Places(NamedTuple):
    """Parts of the world besides the tree of nodes."""

    rooms: Rooms  # The rooms of the floor and the doors between them
    # The corner of the known floor furthest towards each side of the robot frame: northeast, northwest, southeast,
    # southwest. Sides without a corner are missing.
    corners: Mapping[str, Corner]


def belief(
    model: WorldModel,
    places: Places,
    accommodated: Accommodation,
    bound: Mapping[str, str],
    parameters: Iterable[str] = (),
    others: Iterable[str] = (),
) -> dict[str, Any]:
    """Return the `belief` of an episode's line, ready for JSON; `others`: facts of alternatives and of the plan."""
    cells = Counter(str(status) for status in accommodated.fields.status)
    east, north = model.frame.place_to_utak(*model.place)
    stated = (*model_facts(model, places), *binding_facts(bound, parameters), *with_short_forms(others))
    facts = sorted(f"{fact}." for fact in stated)
    return {
        "place": [round(east, 6) + 0.0, round(north, 6) + 0.0],
        "lattice": model.frame.angle,
        "pose": accommodated.explanation.how,
        "cells": {status: cells[status] for status in sorted(cells)},
        "bound": dict(sorted(bound.items())),
        "facts": facts,
        **evidence(model, places.rooms, accommodated, _kind_facts(facts)),
    }


def _kind_facts(facts: Iterable[str]) -> dict[str, str]:
    """Return for each node the first fact of kind/3 about it among sorted facts: for objects that they are objects."""
    found: dict[str, str] = {}
    for fact in facts:
        if fact.startswith("kind(") and fact.count(",") == 2:
            node, kind, _ = atom_parts(fact)[1]
            if node not in found or kind == "object":
                found[node] = fact
    return found


def binding_facts(bound: Mapping[str, str], parameters: Iterable[str]) -> Iterator[str]:
    """Yield `parameter(X)` for each parameter of the task, then `bound(X,N)` for each that is bound; no full stops."""
    yield from (f"parameter({name})" for name in sorted({*parameters, *bound}))
    yield from (f"bound({name},{node})" for name, node in sorted(bound.items()))


def model_facts(model: WorldModel, places: Places) -> Iterator[str]:
    """Yield the world model, its rooms, doors and corners as facts without their full stops, with their short forms."""
    return with_short_forms(_long_facts(model, places))


def with_short_forms(facts: Iterable[str]) -> Iterator[str]:
    """Yield facts, and behind each that is known its short form, if it has one."""
    for fact in facts:
        yield fact
        if fact.endswith(",100)") and fact.partition("(")[0] in SHORTENED and (short := short_form(fact)):
            yield short


def _long_facts(model: WorldModel, places: Places) -> Iterator[str]:
    """Yield the facts of the world model without the short forms of those that are known."""
    yield from _root_facts(model)
    parts = ((FLOOR_NODE, model.floor), (VERGE_NODE, model.verge))
    whole = ((name, _mask_rings(mask, model)) for name, mask in parts if mask.any())
    yield from _outline_facts([*whole, *((node.name, _object_rings(node)) for node in model.objects)], model)
    for node in model.objects:
        yield from _object_facts(node, model)
        yield from _part_facts(node, model)
    yield from _region_facts(model)
    yield from place_facts(model, places, Chances(model, places.rooms))
    yield from pathgraph_facts(model, places.rooms)


def facts_for_rules(encoding: str, rules: Sequence[Path], model: WorldModel, places: Places) -> tuple[str, ...]:
    """Return the facts of the world model that users' rules name in an encoding which works without them."""
    # Others would have plans made anew whenever they change.
    named = predicates_read(encoding, rules) & WORLD_FACTS_THERE[encoding]
    if not named:
        return ()
    facts = [fact for fact in model_facts(model, places) if signature_of(fact) in named]
    facts += [f"object({node.name})" for node in model.objects if ("object", 1) in named]
    facts += [ROBOT_AS_NODE.sub(ROBOT, fact) for fact in facts if ROBOT_AS_NODE.search(fact)]
    return tuple(dict.fromkeys(facts))


def _root_facts(model: WorldModel) -> Iterator[str]:
    """Yield the facts of the robot, the floor and the verge, without full stops."""
    east, north = model.frame.place_to_utak(*model.place)
    yield f"node({ROOT_NODE})"
    yield f"kind({ROOT_NODE},utak,100)"
    yield f"offset({ROOT_NODE},{hundredths(east)},{hundredths(north)})"
    for name, kind, parent in ((FLOOR_NODE, "floor", ROOT_NODE), (VERGE_NODE, "verge", FLOOR_NODE)):
        yield f"node({name})"
        yield f"child({parent},{name})"
        yield f"kind({name},{kind},{_share(model, kind)})"
    yield f"offset({FLOOR_NODE},{hundredths(-east)},{hundredths(-north)})"
    yield f"offset({VERGE_NODE},0,0)"
    if model.held:
        yield f"held({model.held})"


def _share(model: WorldModel, kind: str) -> int:
    """Return how many squares of the floor or the verge are such, by the chance of each, in percent; 0 for none."""
    mask = model.floor if kind == "floor" else model.verge
    if not mask.any():
        return 0
    occupied = model.view.probability[mask]
    chance = 1 - occupied if kind == "floor" else occupied
    likely = np.where(model.certain[mask], 1, np.minimum(chance, SETTLED_CONFIDENCE / 100))
    return int(100 * float(likely.mean()) + 1e-6)


def _square_confidence(model: WorldModel) -> Longs:
    """Return the confidence in what the counts settle of each square, in percent: (rows, columns) int64."""
    # 100 beyond doubt, SETTLED_CONFIDENCE when settled otherwise, 0 when not settled; on the view's arrays.
    return np.where(model.certain, 100, SETTLED_CONFIDENCE * (model.view.state != OPEN))


def appearance_facts(node: Node) -> Iterator[str]:
    """Yield shape/3 for each class that an object may have, and colour/3 where it was felt; without full stops."""
    yield from (f"shape({node.name},{shape},{confidence})" for shape, confidence in sorted(node.shape.items()))
    yield from colour_facts(node.name, node.colour)


def colour_facts(name: str, colour: str | None) -> tuple[str, ...]:
    """Return colour/3 of an object by name, without a full stop; () where no colour was felt."""
    return () if colour is None else (f"colour({name},{colour},{FELT_COLOUR_CONFIDENCE})",)


def _object_facts(node: Node, model: WorldModel) -> Iterator[str]:
    """Yield the facts of one object, its outline apart, without full stops."""
    name = node.name
    yield f"node({name})"
    yield f"child({FLOOR_NODE},{name})"
    yield f"kind({name},object,{node.confidence})"
    others = ((kind, model.kinds.of(node.region, kind)) for kind in ("floor", "verge"))
    yield from (f"kind({name},{kind},{percent})" for kind, percent in others if percent > 0)
    east, north = model.frame.place_to_utak(*node.patch.centre)
    yield f"offset({name},{hundredths(east)},{hundredths(north)})"
    yield from appearance_facts(node)
    yield f"movable({name},{round(node.movable * node.confidence / 100)})"
    yield from [f"persists({name},{node.persists})"] * (node.persists < 100)


def _part_facts(node: Node, model: WorldModel) -> Iterator[str]:
    """Yield the parts of an object's outline, such as the legs of an L, without full stops."""
    if node.polygon is None:
        return
    middle = np.array(model.frame.place_to_utak(*node.patch.centre))
    for number, part in enumerate(parts_of(node.polygon), 1):
        name = f"{node.name}_{number}"
        ring = np.column_stack(model.frame.place_to_utak(*np.array(part.exterior.coords).T))
        east, north = model.frame.place_to_utak(part.centroid.x, part.centroid.y) - middle
        yield f"node({name})"
        yield f"child({node.name},{name})"
        yield f"part_of({name},{node.name})"
        yield f"offset({name},{hundredths(east)},{hundredths(north)})"
        yield f"rect({name},{','.join(str(hundredths(value)) for value in (*ring.min(0), *ring.max(0)))})"


def _region_facts(model: WorldModel) -> Iterator[str]:
    """Yield the regions of the map, and the node of which each is a part, without full stops."""
    nodes = {node.region: node.name for node in model.objects}
    for region in model.percept.regions:
        share = min(region.certain, 100 if model.beyond_doubt else SETTLED_CONFIDENCE)
        yield f"region({region.name},{'nonzero' if region.occupied else 'zero'},{share})"
        whole = VERGE_NODE if model.kinds.of(region.name, "verge") else FLOOR_NODE
        yield f"part_of({region.name},{nodes.get(region.name, whole)})"


def _object_rings(node: Node) -> list[Floats]:
    """Return the boundary of an object as rings of (n, 2) points (x, y), in squares, map frame."""
    if node.polygon is not None:
        return [np.array(node.polygon.exterior.coords)[:-1]]
    corner = np.array([node.patch.west, node.patch.south])
    return [corner + ring for ring in _patch_outline(node.patch.mask.tobytes(), node.patch.mask.shape)]


@lru_cache(maxsize=4096)
def _patch_outline(squares: bytes, shape: tuple[int, int]) -> list[Ring]:
    """Return the outline of a small mask as rings of corners (x, y), the first corner not repeated."""
    return outline(np.frombuffer(squares, np.bool_).reshape(shape))


def _mask_rings(mask: Bools, model: WorldModel) -> list[Floats]:
    """Return the outline of a mask on the view's arrays as rings of (n, 2) points (x, y), in squares, map frame."""
    corner = np.array([model.view.west, model.view.south])
    return [corner + ring for ring in outline(mask)]


def _outline_facts(shapes: Iterable[tuple[str, list[Floats]]], model: WorldModel) -> Iterator[str]:
    """Yield the containing rectangles and the boundaries of nodes, ring after ring, without full stops."""
    # Nodes come in the order of `shapes`: of each its rectangle, then its segments, one for each point of its rings in
    # order.
    names, rings = zip(*((name, ring) for name, parts in shapes for ring in parts), strict=True)
    starts = np.concatenate(rings)
    ends = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    sure = _segment_confidence(starts, ends, model)
    corners = _points_inhundredths(starts, model)
    count = Counter[str]()
    for name, ring in zip(names, rings, strict=True):
        count[name] += len(ring)
    lines = np.column_stack([corners, _points_inhundredths(ends, model)]).tolist()
    first = 0
    for name, length in count.items():
        part = slice(first, first + length)
        (west, south), (east, north) = corners[part].min(0).tolist(), corners[part].max(0).tolist()
        yield f"rect({name},{west},{south},{east},{north})"
        for number, ((e, n, f, m), share) in enumerate(zip(lines[part], sure[part], strict=True)):
            yield f"segment({name},{number},{e},{n},{f},{m},{share})"
        first += length


def _points_inhundredths(points: Floats, model: WorldModel) -> Longs:
    """Return (n, 2) points (x, y) of the map frame, in squares, as (n, 2) int64 (east, north) of the robot frame."""
    placed: Floats = np.column_stack(model.frame.place_to_utak(*points.T))
    answer: Longs = np.rint(FACT_UNITS_PER_SQUARE * placed).astype(np.int64)
    return answer


def _segment_confidence(starts: Floats, ends: Floats, model: WorldModel) -> list[int]:
    """Return for each segment the mean confidence in the squares on both sides of it, in percent, rounded down."""
    parts = (np.arange(SEGMENT_SAMPLES) + 0.5) / SEGMENT_SAMPLES
    step = ends - starts
    along = starts[:, None] + parts[:, None] * step[:, None]
    length = np.hypot(*step.T)[:, None, None]
    across = np.stack([-step[:, 1], step[:, 0]], axis=1)[:, None] / (2 * np.maximum(length, 1e-9))
    points = np.concatenate([along + across, along - across], axis=1) - (model.view.west, model.view.south)
    columns, rows = np.floor(points).astype(int).transpose(2, 0, 1)
    framed = np.pad(_square_confidence(model), 1)
    settled = framed[np.clip(rows + 1, 0, framed.shape[0] - 1), np.clip(columns + 1, 0, framed.shape[1] - 1)]
    return [int(share) for share in settled.mean(axis=1)]


def place_facts(model: WorldModel, places: Places, chances: Chances) -> Iterator[str]:
    """Yield the facts of rooms, doors and corners, of what lies in which room and what touches what."""
    # Rooms r1, r2, ... come first, in order, then the doors in the order of `rooms`.
    rooms = places.rooms
    unseen = np.bincount(rooms.labels[model.view.state == OPEN], minlength=int(rooms.labels.max(initial=0)) + 1)
    for room in range(1, len(unseen)):
        yield f"room(r{room})"
        yield f"unseen(r{room},{unseen[room]})"
    for node in (None, *model.objects):
        name = ROOT_NODE if node is None else node.name
        yield from (f"in({name},r{room},{share})" for room, share in chances.rooms_of(node))
    for door in rooms.doors:
        yield from _door_facts(door, model, chances)
    for one, other, share in chances.adjacencies():
        yield f"adjacent({one},{other},{share})"
        yield f"adjacent({other},{one},{share})"
    for side, corner in sorted(places.corners.items()):
        east, north = model.place_to_utak(*corner.point)
        yield f"corner({side},{hundredths(east)},{hundredths(north)},{chances.of_corner(corner)})"


def _door_facts(door: Door, model: WorldModel, chances: Chances) -> Iterator[str]:
    """Yield the facts of a door, without full stops."""
    widths = chances.widths(door)
    share = chances.of_door(door, widths)
    yield f"door({door.name},{share})"
    yield f"width({door.name},{hundredths(door.width)})"
    least, most = math.floor(FACT_UNITS_PER_SQUARE * widths.least), math.ceil(FACT_UNITS_PER_SQUARE * widths.most)
    yield f"width({door.name},{least},{most})"
    ends = [hundredths(value) for end in (door.a, door.b) for value in model.place_to_utak(*end)]
    yield f"threshold({door.name},{','.join(map(str, ends))})"
    if door.joins:
        yield from (f"connects({door.name},r{a},r{b},{share})" for a, b in (door.sides, door.sides[::-1]))
