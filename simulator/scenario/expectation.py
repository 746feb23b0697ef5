"""expect.lp: what the truth at the end of an episode must be, and whether it is."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import shapely

from kb.language.diagnostics import BadInputError, Problem, did_you_mean
from kb.language.reader import parse_facts
from kb.language.source_text import Source, read_source
from kb.language.terms import Fact, Number, Text
from kb.language.vocabulary import EXPECT, check_facts
from kb.language.wkt import parse_wkt
from simulator.world.world import World, ring_of

SLACK = 1e-3  # squares
ONCE_ROUND = 330.0  # degrees of winding that count as a whole turn
NAMING = {"inside": 0, "near": 0, "visits": 0, "circles": 1, "unmoved": 0}  # which argument names a thing


class Snapshot(NamedTuple):
    """The truth at one step: Utak's place and the polygons of the movable things by name, table frame."""

    step: int
    utak: tuple[float, float]
    polygons: Mapping[str, Any]


def read_expectations(path: Path | str, world: World | None) -> tuple[Fact, ...]:
    """Read expect.lp; names are checked against the world, if there is one. Raises as `read_world` does."""
    source = read_source(path)
    facts = parse_facts(source)
    problems = check_facts(source, facts, EXPECT)
    if not facts:
        hint = "such as within(50). or fails.; without expected facts leave the file out"
        problems = [source.problem(source.start(), "nothing is expected: expect.lp is empty", hint)]
    if world is not None and not problems:
        problems = list(_unknown_names(source, facts, world))
    if problems:
        raise BadInputError(problems)
    return facts


def _unknown_names(source: Source, facts: Sequence[Fact], world: World) -> Iterator[Problem]:
    known = {thing.name for thing in (*world.movable, *world.fixed)}
    for fact in facts:
        if fact.name not in NAMING:
            continue
        term = fact.args[NAMING[fact.name]]
        walker = str(term) == "utak" and fact.name in ("inside", "near", "visits")
        if not walker and str(term) not in known:
            hint = did_you_mean(str(term), [*known, "utak"])
            yield source.problem(term.span, f"the world has no object {term}", hint)


def should_fail(expectations: Sequence[Fact]) -> bool:
    """Whether the task cannot be done, and Utak is expected to find out."""
    return any(fact.name == "fails" for fact in expectations)


def unmet(expectations: Sequence[Fact], world: World, track: Sequence[Snapshot]) -> list[Fact]:
    """Return the expectations that the truth does not meet; `track` has one snapshot a step, from step 0 on."""
    fixed = {thing.name: thing.polygon for thing in world.fixed}
    snapshots = [Snapshot(one.step, one.utak, {**fixed, **one.polygons}) for one in track]
    return [fact for fact in expectations if fact.name != "fails" and not _CHECKS[fact.name](fact, snapshots)]


def _shape(fact: Fact) -> Any:
    term = fact.args[1]
    assert isinstance(term, Text)
    return parse_wkt(term.value)


def _number(fact: Fact) -> int:
    term = fact.args[-1]
    assert isinstance(term, Number)
    return term.value


def _thing(fact: Fact, snapshot: Snapshot) -> Any:
    name = str(fact.args[0])
    return shapely.Point(snapshot.utak) if name == "utak" else snapshot.polygons[name]


def _inside(fact: Fact, track: Sequence[Snapshot]) -> bool:
    return bool(_shape(fact).buffer(SLACK).covers(_thing(fact, track[-1])))


def _near(fact: Fact, track: Sequence[Snapshot]) -> bool:
    return bool(_thing(fact, track[-1]).distance(_shape(fact)) <= _number(fact) + SLACK)


def _visits(fact: Fact, track: Sequence[Snapshot]) -> bool:
    region = _shape(fact)
    return any(region.covers(_thing(fact, snapshot).centroid) for snapshot in track)


def _circles(fact: Fact, track: Sequence[Snapshot]) -> bool:
    return abs(winding(track, str(fact.args[1]))) >= ONCE_ROUND


def winding(track: Sequence[Snapshot], name: str) -> float:
    """Return by how many degrees Utak's track winds about the centre of a thing, counter-clockwise positive."""
    total = 0.0
    for before, after in pairwise(track):
        centre = after.polygons[name].centroid
        start, end = (math.atan2(y - centre.y, x - centre.x) for x, y in (before.utak, after.utak))
        total += (math.degrees(end - start) + 180.0) % 360.0 - 180.0
    return total


def _unmoved(fact: Fact, track: Sequence[Snapshot]) -> bool:
    name = str(fact.args[0])
    return ring_of(track[0].polygons[name]) == ring_of(track[-1].polygons[name])


def _within(fact: Fact, track: Sequence[Snapshot]) -> bool:
    return track[-1].step <= _number(fact)


_CHECKS = {
    "inside": _inside,
    "near": _near,
    "visits": _visits,
    "circles": _circles,
    "unmoved": _unmoved,
    "within": _within,
}
