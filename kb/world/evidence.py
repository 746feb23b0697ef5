"""The evidence of a world model, ready for JSON: which fact explains each field, and the regions of nodes.

It goes with the facts of the world model into an episode's line, so that explanations need nothing but the episode.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from utak.geometry.kernels.arrays import XY, Longs
from utak.geometry.raster.contours import outline
from utak.kb.localisation.field_account import Accommodation, CellStatus, FieldAccount
from utak.kb.perception.regions import label_of
from utak.kb.world.model import FLOOR_NODE, VERGE_NODE, Node, WorldModel, free_squares
from utak.kb.world.rooms import Rooms

MIN_DRAWN_SHARE = 5  # percent: how likely a class must be for its outline to be stated: 1 of 20, a convention
STATUS_LETTERS = {CellStatus.PREDICTED: "p", CellStatus.EXPLAINED: "e", CellStatus.NOISE: "n"}


def evidence(
    model: WorldModel, rooms: Rooms, accommodated: Accommodation, kind_facts: Mapping[str, str]
) -> dict[str, Any]:
    """Return what a world model rests on, as further keys of the `belief` of an episode's line."""
    fields = accommodated.fields
    return {
        "status": "".join(STATUS_LETTERS[status] for status in fields.status),
        "least": "".join(map(str, fields.least)),
        "most": "".join(map(str, fields.most)),
        "explained": _explaining_facts(model, fields, kind_facts),
        "origin": [round(x, 6) for x in model.frame.origin],
        "regions": {node.name: node.region for node in model.objects if not node.moved},
        "moved": [node.name for node in model.objects if node.moved],
        "necks": {
            door.name: [[round(v, 3) for v in model.place_to_utak(*end)] for end in (door.a, door.b)]
            for door in rooms.doors
        },
        **_alternatives(model),
    }


def _alternatives(model: WorldModel) -> dict[str, Any]:
    """Return what may be otherwise, as far as it has a place: shapes, parts of the verge, where the robot is."""
    west, south, east, north = model.place_box
    corners = [] if model.lost else [(west, south), (east, south), (east, north), (west, north)]
    unfelt = np.any(model.unfelt_pieces, axis=0) if model.unfelt_pieces else None
    return {
        "outlines": {node.name: found for node in model.objects if (found := _other_outline(node, model))},
        "unfelt": [] if unfelt is None else [_placed(ring, model) for ring in outline(unfelt)],
        "place_within": _placed(corners, model),
    }


def _other_outline(node: Node, model: WorldModel) -> dict[str, list[list[float]]]:
    """Return class -> outline of the likeliest class besides that of the segment facts; {} for none."""
    likeliest = max(node.rivals, key=lambda shape: node.shape.get(shape, 0), default="")
    if node.shape.get(likeliest, 0) < MIN_DRAWN_SHARE:
        return {}
    corner = np.array([node.patch.west - model.view.west, node.patch.south - model.view.south])
    return {likeliest: _placed(np.array(node.rivals[likeliest].exterior.coords)[:-1] + corner, model)}


def _placed(points: Iterable[XY], model: WorldModel) -> list[list[float]]:
    """Return points on the view's arrays as (east, north), robot frame."""
    return [[round(float(v), 2) + 0.0 for v in model.place_to_utak(x, y)] for x, y in points]


def _explaining_facts(model: WorldModel, fields: FieldAccount, kind_facts: Mapping[str, str]) -> dict[str, list[int]]:
    """Return for each fact that explains fields the numbers of these fields; each explained field is named once."""
    found: dict[str, list[int]] = {}
    names = {label_of(node.region): node.name for node in model.objects}
    for field, label in _main_regions(model, fields):
        bounds = model.kinds.of(f"part{label}", "verge") > 0
        name = names.get(label) or (VERGE_NODE if bounds else FLOOR_NODE)
        found.setdefault(kind_facts[name], []).append(field)
    return dict(sorted(found.items()))


def _main_regions(model: WorldModel, fields: FieldAccount) -> Iterator[tuple[int, int]]:
    """Yield each explained field with the label of the region to which most of what it shows belongs."""
    rows, columns = _squares_under(model, fields)
    labels, free = model.labels, free_squares(model.view)
    for field, status in enumerate(fields.status):
        if status != CellStatus.EXPLAINED:
            continue
        under = fields.samples.weight[field] > 0
        there = rows[field, under], columns[field, under]
        shown = np.where(free[there] ^ fields.occupied[field], 1.0, 0.0)
        weights = shown if shown.any() else np.ones(len(shown))
        totals = np.bincount(labels[there], weights=weights)
        yield field, int(totals.argmax())


def _squares_under(model: WorldModel, fields: FieldAccount) -> tuple[Longs, Longs]:
    """Return rows and columns on the view's arrays of the squares under each field, (160, 16) each."""
    row, column = model.view.locate(*fields.square)
    height, width = model.labels.shape
    rows = np.clip(fields.samples.rows + row, 0, height - 1).astype(np.int64)
    columns = np.clip(fields.samples.columns + column, 0, width - 1).astype(np.int64)
    return rows, columns
