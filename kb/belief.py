"""The world model as facts, in the vocabulary that docs/vocabulary.md documents, and as an episode's `belief`."""

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from kb.accommodation import Accommodated
from kb.worldmodel import FLOOR, ORG, Node, WorldModel

HUNDREDTHS = 100  # coordinates in facts are in hundredths of squares, in Utak's frame


def belief(model: WorldModel, accommodated: Accommodated, bound: Mapping[str, str]) -> dict[str, Any]:
    """What an episode's line tells of Utak's belief: the facts, how the impression was accounted for, and what the parameters mean."""
    east, north = model.lattice.place_to_utak(*model.place)
    cells = Counter(str(status) for status in accommodated.cells)
    return {
        "place": [round(east, 6), round(north, 6)],
        "lattice": model.lattice.angle,
        "pose": accommodated.explanation.how,
        "cells": {status: cells[status] for status in sorted(cells)},
        "bound": dict(sorted(bound.items())),
        "facts": sorted(f"{fact}." for fact in model_facts(model)),
    }


def model_facts(model: WorldModel) -> Iterator[str]:
    """The tree as facts. Coordinates are hundredths of squares in Utak's frame, confidences percent."""
    yield f"node({ORG})"
    yield f"kind({ORG},utak,100)"
    yield f"node({FLOOR})"
    yield f"kind({FLOOR},floor,100)"
    yield f"child({ORG},{FLOOR})"
    for node in model.objects:
        yield from _node(node, model)


def _node(node: Node, model: WorldModel) -> Iterator[str]:
    yield f"node({node.name})"
    yield f"child({FLOOR},{node.name})"
    yield f"kind({node.name},{node.kind},{node.confidence})"
    east, north = model.lattice.place_to_utak(*node.patch.centre)
    yield f"offset({node.name},{round(east * HUNDREDTHS)},{round(north * HUNDREDTHS)})"
    for shape, confidence in sorted(node.shape.items()):
        yield f"shape({node.name},{shape},{confidence})"
    if node.colour:
        yield f"colour({node.name},{node.colour},99)"


