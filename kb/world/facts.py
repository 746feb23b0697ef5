"""The world model as facts, in the vocabulary that docs/vocabulary.md documents, and as an episode's `belief`.

Coordinates are hundredths of squares in Utak's own frame, whose origin is the point where he woke; confidences are
percent.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.raster.contours import Ring, outline
from kb.localisation.hypotheses.explanation import Accommodated
from kb.mapping.occupancy import OPEN
from kb.world.corners import Corner
from kb.world.model import FLOOR, ORG, VERGE, Node, WorldModel
from kb.world.rooms import Rooms

HUNDREDTHS = 100
SAMPLES = 8
Mask = NDArray[np.bool_]
Floats = NDArray[np.float64]


class Places(NamedTuple):
    """What is believed of the floor besides the tree: its rooms and doors, and its corners by side."""

    rooms: Rooms
    corners: Mapping[str, Corner]


def belief(model: WorldModel, places: Places, accommodated: Accommodated, bound: Mapping[str, str]) -> dict[str, Any]:
    """What an episode's line tells of Utak's belief.

    place, lattice: where he believes himself, and the angle of the lattice. pose: how the pose was explained. cells:
    how many cells of the impression
    were predicted, explained or noise. bound: what the parameters of the task mean. facts: the world model.
    """
    cells = Counter(str(status) for status in accommodated.cells)
    east, north = model.frame.place_to_utak(*model.place)
    return {
        "place": [round(east, 6) + 0.0, round(north, 6) + 0.0],
        "lattice": model.frame.angle,
        "pose": accommodated.explanation.how,
        "cells": {status: cells[status] for status in sorted(cells)},
        "bound": dict(sorted(bound.items())),
        "facts": sorted(f"{fact}." for fact in model_facts(model, places)),
    }


def model_facts(model: WorldModel, places: Places) -> Iterator[str]:
    """The tree of the world model, its rooms and doors, as facts without their full stops."""
    yield from _root(model)
    whole = ((name, _rings(mask, model)) for name, mask in ((FLOOR, model.floor), (VERGE, model.verge)) if mask.any())
    yield from _outlined([*whole, *((node.name, _object_rings(node)) for node in model.objects)], model)
    for node in model.objects:
        yield from _object(node, model, places.rooms)
    yield from _rooms(model, places.rooms)
    for side, corner in sorted(places.corners.items()):
        east, north = model.place_to_utak(*corner.point)
        yield f"corner({side},{_hundredths(east)},{_hundredths(north)})"


def _root(model: WorldModel) -> Iterator[str]:
    east, north = model.frame.place_to_utak(*model.place)
    yield f"node({ORG})"
    yield f"kind({ORG},utak,100)"
    yield f"offset({ORG},{_hundredths(east)},{_hundredths(north)})"
    for name, kind, parent in ((FLOOR, "floor", ORG), (VERGE, "verge", FLOOR)):
        yield f"node({name})"
        yield f"child({parent},{name})"
        yield f"kind({name},{kind},{_sureness(model, kind)})"
    yield f"offset({FLOOR},{_hundredths(-east)},{_hundredths(-north)})"
    yield f"offset({VERGE},0,0)"
    if model.held:
        yield f"held({model.held})"


def _sureness(model: WorldModel, kind: str) -> int:
    mask = model.floor if kind == "floor" else model.verge
    return int(_settled(model)[mask].sum()) // int(mask.sum()) if mask.any() else 0


def _settled(model: WorldModel) -> NDArray[np.int64]:
    """(rows, columns): the confidence in what the counts settle of each square, in percent; 0 where that is nothing."""
    return np.where(model.certain, 100, 99 * (model.view.state != OPEN))


def _object(node: Node, model: WorldModel, rooms: Rooms) -> Iterator[str]:
    name = node.name
    yield f"node({name})"
    yield f"child({FLOOR},{name})"
    yield f"kind({name},object,{node.confidence})"
    if node.confidence < 100:
        yield f"kind({name},verge,{model.kinds.of(node.region, 'verge')})"
    east, north = model.frame.place_to_utak(*node.patch.centre)
    yield f"offset({name},{_hundredths(east)},{_hundredths(north)})"
    for shape, confidence in sorted(node.shape.items()):
        yield f"shape({name},{shape},{confidence})"
    if node.colour is not None:
        yield f"colour({name},{node.colour},99)"
    yield f"movable({name},{node.movable if node.confidence >= 50 else 0})"
    row, column = model.view.locate(*node.patch.centre)
    room = rooms.labels[row, column]
    if room:
        yield f"in({name},r{room})"
    if _beside_utak(node, model):
        yield f"adjacent({ORG},{name})"


def _beside_utak(node: Node, model: WorldModel) -> bool:
    row, column = math.floor(model.place[1]) - node.patch.south, math.floor(model.place[0]) - node.patch.west
    return bool(node.patch.mask[max(row - 1, 0) : max(row + 2, 0), max(column - 1, 0) : max(column + 2, 0)].any())


def _object_rings(node: Node) -> list[Floats]:
    if node.polygon is not None:
        return [np.array(node.polygon.exterior.coords)[:-1]]
    corner = np.array([node.patch.west, node.patch.south])
    return [corner + ring for ring in _outline(node.patch.mask.tobytes(), node.patch.mask.shape)]


@lru_cache(maxsize=4096)
def _outline(squares: bytes, shape: tuple[int, int]) -> list[Ring]:
    """The outline of a small mask; most things look the same from one impression to the next."""
    return outline(np.frombuffer(squares, np.bool_).reshape(shape))


def _rings(mask: Mask, model: WorldModel) -> list[Floats]:
    corner = np.array([model.view.west, model.view.south])
    return [corner + ring for ring in outline(mask)]


def _outlined(shapes: Iterable[tuple[str, list[Floats]]], model: WorldModel) -> Iterator[str]:
    """The containing rectangles and the circular boundaries, ring after ring, of nodes by name.

    The rings' corners are (n, 2) points of the lattice.
    """
    names, rings = zip(*((name, ring) for name, parts in shapes for ring in parts), strict=True)
    starts = np.concatenate(rings)
    ends = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    sure = _sureness_along(starts, ends, model)
    corners = _in_hundredths(starts, model)
    count = Counter[str]()
    for name, ring in zip(names, rings, strict=True):
        count[name] += len(ring)
    lines = np.column_stack([corners, _in_hundredths(ends, model)]).tolist()
    first = 0
    for name, length in count.items():
        part = slice(first, first + length)
        (west, south), (east, north) = corners[part].min(0).tolist(), corners[part].max(0).tolist()
        yield f"rect({name},{west},{south},{east},{north})"
        for number, ((e, n, f, m), share) in enumerate(zip(lines[part], sure[part], strict=True)):
            yield f"segment({name},{number},{e},{n},{f},{m},{share})"
        first += length


def _in_hundredths(points: Floats, model: WorldModel) -> NDArray[np.int64]:
    """(n, 2): points of the lattice in hundredths of squares of Utak's frame."""
    placed: Floats = np.column_stack(model.frame.place_to_utak(*points.T))
    answer: NDArray[np.int64] = np.rint(HUNDREDTHS * placed).astype(np.int64)
    return answer


def _sureness_along(starts: Floats, ends: Floats, model: WorldModel) -> list[int]:
    """For each segment, percent of the squares on both sides of it that are settled, sampled at SAMPLES places."""
    parts = (np.arange(SAMPLES) + 0.5) / SAMPLES
    step = ends - starts
    along = starts[:, None] + parts[:, None] * step[:, None]
    length = np.hypot(*step.T)[:, None, None]
    across = np.stack([-step[:, 1], step[:, 0]], axis=1)[:, None] / (2 * np.maximum(length, 1e-9))
    points = np.concatenate([along + across, along - across], axis=1) - (model.view.west, model.view.south)
    columns, rows = np.floor(points).astype(int).transpose(2, 0, 1)
    framed = np.pad(_settled(model), 1)
    settled = framed[np.clip(rows + 1, 0, framed.shape[0] - 1), np.clip(columns + 1, 0, framed.shape[1] - 1)]
    return [int(share) for share in settled.mean(axis=1)]


def _rooms(model: WorldModel, rooms: Rooms) -> Iterator[str]:
    unseen = np.bincount(rooms.labels[model.view.state == OPEN], minlength=int(rooms.labels.max(initial=0)) + 1)
    for room in range(1, len(unseen)):
        yield f"room(r{room})"
        yield f"unseen(r{room},{unseen[room]})"
    row, column = model.view.locate(*model.place)
    if rooms.labels[row, column]:
        yield f"in({ORG},r{rooms.labels[row, column]})"
    for door in rooms.sure:
        yield f"door({door.name})"
        yield f"width({door.name},{_hundredths(door.width)})"
        yield from (f"connects({door.name},r{a},r{b})" for a, b in ((door.sides), (door.sides[1], door.sides[0])))


def _hundredths(length: float) -> int:
    return round(HUNDREDTHS * length)
