"""Outlines in the facts of a world model, written so that little changes from one step to the next.

`segment/7` numbers the edges of a node: one more corner renumbers all edges that follow. Here an outline is a list of
its corners as text: `@E,N` where a ring begins, then the way from the corner before, such as `100,-200`; the last
corner of a ring ends in a semicolon. There is one confidence an edge, in the order of the corners where edges begin; it
is -1 where the same edge, run through the other way, had it in an earlier outline: what bounds the floor also bounds
something else. `rect/5` is left out where an outline tells it.

`page_parts/decode.js` turns outlines into facts again.
"""

import re
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

# An edge; numbers of at most nine digits, which are exact in every browser.
SEGMENT = re.compile(r"segment\(([a-z]\w*),(\d{1,9})((?:,-?\d{1,9}){4}),(\d{1,9})\)\.", re.ASCII)
AS_THE_OTHER_WAY = -1  # in the place of a confidence: as the same edge had it in an earlier outline

OutlinePoint = tuple[int, int]  # east and north, hundredths of squares, robot frame
Edge = tuple[OutlinePoint, OutlinePoint]


class SplitFacts(NamedTuple):
    """The facts of a step, with their outlines apart."""

    others: list[str]  # the facts that no outline tells, as they stand, sorted
    corners: dict[str, list[str]]  # the corners of the outlines as text, by node
    confidences: dict[str, list[int]]  # the percent of each edge, by node; or AS_THE_OTHER_WAY


def split_facts(facts: Sequence[str]) -> SplitFacts | None:
    """Return the facts with their outlines apart; None when `joined_facts` would not give back just these facts."""
    found: dict[str, dict[int, tuple[Edge, int]]] = {}
    others = []
    for fact in facts:
        match = SEGMENT.fullmatch(fact)
        if match is None:
            others.append(fact)
        else:
            east, north, to_east, to_north = map(int, match[3][1:].split(","))
            found.setdefault(match[1], {})[int(match[2])] = ((east, north), (to_east, to_north)), int(match[4])
    corners: dict[str, list[str]] = {}
    confidences: dict[str, list[int]] = {}
    known: dict[Edge, int] = {}
    for name in sorted(found):
        edges = [edge for _, edge in sorted(found[name].items())]
        corners[name], confidences[name] = _written(edge for edge, _ in edges), []
        for (start, end), confidence in edges:
            as_before = known.get((end, start)) == confidence
            confidences[name].append(AS_THE_OTHER_WAY if as_before else confidence)
            known.setdefault((start, end), confidence)
    rectangles = {rectangle_fact(name, [start for (start, _), _ in edges.values()]) for name, edges in found.items()}
    split = SplitFacts([fact for fact in others if fact not in rectangles], corners, confidences)
    return split if joined_facts(split) == list(facts) else None


def joined_facts(split: SplitFacts) -> list[str]:
    """Return the facts from which `split_facts` made this value."""
    facts = list(split.others)
    known: dict[Edge, int] = {}
    for name in sorted(split.corners):
        edges = _edges(split.corners[name])
        for number, ((start, end), stated) in enumerate(zip(edges, split.confidences[name], strict=False)):
            confidence = known.get((end, start), 0) if stated == AS_THE_OTHER_WAY else stated
            known.setdefault((start, end), confidence)
            facts.append(f"segment({name},{number},{start[0]},{start[1]},{end[0]},{end[1]},{confidence}).")
        if edges:
            facts.append(rectangle_fact(name, [start for start, _ in edges]))
    return sorted(facts)


def rectangle_fact(name: str, corners: Sequence[OutlinePoint]) -> str:
    """Return the `rect/5` fact of a node whose outline has these corners."""
    easts, norths = zip(*corners, strict=True)
    return f"rect({name},{min(easts)},{min(norths)},{max(easts)},{max(norths)})."


def _written(edges: Iterable[Edge]) -> list[str]:
    """Return the corners of edges as text. What they begin with is lost where they form no rings."""
    written = []
    first: OutlinePoint | None = None
    before = (0, 0)
    for start, end in edges:
        text = f"@{start[0]},{start[1]}" if first is None else f"{start[0] - before[0]},{start[1] - before[1]}"
        first, before = first or start, start
        if end == first:
            text, first = text + ";", None
        written.append(text)
    return written


def _edges(corners: Sequence[str]) -> list[Edge]:
    """Return the edges between corners that `_written` wrote."""
    edges: list[Edge] = []
    ring: list[OutlinePoint] = []
    for text in corners:
        east, north = map(int, text.strip("@;").split(","))
        ring.append((ring[-1][0] + east, ring[-1][1] + north) if ring else (east, north))
        if text.endswith(";"):
            edges += zip(ring, [*ring[1:], ring[0]], strict=True)
            ring = []
    return edges + list(pairwise(ring))
