"""expect.lp: what must be true at the end of an episode, and whether it is."""

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
from kb.language.vocabulary import EXPECTATION_VOCABULARY, check_facts
from kb.language.wkt import parse_wkt
from simulator.world.world import World, outer_ring

EXPECTATION_TOLERANCE = 1e-3  # squares; `inside` and `near` hold within it; a convention
MIN_CIRCLING_DEGREES = 330.0  # degrees of winding that count as once around (docs/files.md)
# By the name of an expectation: the index of the argument that names a thing.
THING_ARGUMENT_INDEX = {"inside": 0, "near": 0, "visits": 0, "circles": 1, "unmoved": 0}


class Snapshot(NamedTuple):
    """The true state at one step.

    Attributes
    ----------
    step : the number of commands so far.
    utak : Utak's place (x, y), squares, table frame.
    polygons : the outlines of the movable things by name, squares, table frame.
    """

    step: int
    utak: tuple[float, float]
    polygons: Mapping[str, Any]


def read_expectations(path: Path | str, world: World | None) -> tuple[Fact, ...]:
    """Return the facts of expect.lp, checked.

    Parameters
    ----------
    path : the file.
    world : the world whose things the facts may name; None to leave names unchecked.

    Returns
    -------
    The expected facts.

    Raises
    ------
    CannotOpenError : the file cannot be read.
    BadInputError : the file has errors, or expects nothing.
    """
    source = read_source(path)
    facts = parse_facts(source)
    problems = check_facts(source, facts, EXPECTATION_VOCABULARY)
    if not facts:
        hint = "such as within(50). or fails.; without expected facts leave the file out"
        problems = [source.problem(source.start(), "nothing is expected: expect.lp is empty", hint)]
    if world is not None and not problems:
        problems = list(_unknown_names(source, facts, world))
    if problems:
        raise BadInputError(problems)
    return facts


def _unknown_names(source: Source, facts: Sequence[Fact], world: World) -> Iterator[Problem]:
    """Yield a problem for each name of a thing that the world does not have."""
    known = {thing.name for thing in (*world.movable, *world.fixed)}
    for fact in facts:
        if fact.name not in THING_ARGUMENT_INDEX:
            continue
        term = fact.args[THING_ARGUMENT_INDEX[fact.name]]
        walker = str(term) == "utak" and fact.name in ("inside", "near", "visits")
        if not walker and str(term) not in known:
            hint = did_you_mean(str(term), [*known, "utak"])
            yield source.problem(term.span, f"the world has no object {term}", hint)


def should_fail(expectations: Sequence[Fact]) -> bool:
    """Return whether the task is expected to be impossible (`fails`), so that Utak must not believe it done."""
    return any(fact.name == "fails" for fact in expectations)


def unmet(expectations: Sequence[Fact], world: World, track: Sequence[Snapshot]) -> list[Fact]:
    """Return the expectations that the truth does not meet.

    Parameters
    ----------
    expectations : the facts of expect.lp; `fails` is not tested here.
    world : the world at the start.
    track : one snapshot a step, from step 0 on.

    Returns
    -------
    The unmet facts in their order; [] when all are met.
    """
    fixed = {thing.name: thing.polygon for thing in world.fixed}
    snapshots = [Snapshot(one.step, one.utak, {**fixed, **one.polygons}) for one in track]
    return [fact for fact in expectations if fact.name != "fails" and not _CHECKS[fact.name](fact, snapshots)]


def _shape(fact: Fact) -> Any:
    """Return the shape in a fact's second argument."""
    term = fact.args[1]
    assert isinstance(term, Text)
    return parse_wkt(term.value)


def _number(fact: Fact) -> int:
    """Return the number in a fact's last argument."""
    term = fact.args[-1]
    assert isinstance(term, Number)
    return term.value


def _thing(fact: Fact, snapshot: Snapshot) -> Any:
    """Return the outline of the named thing, or Utak's point."""
    name = str(fact.args[0])
    return shapely.Point(snapshot.utak) if name == "utak" else snapshot.polygons[name]


def _inside(fact: Fact, track: Sequence[Snapshot]) -> bool:
    """Return whether all of the thing is in the region at the end."""
    return bool(_shape(fact).buffer(EXPECTATION_TOLERANCE).covers(_thing(fact, track[-1])))


def _near(fact: Fact, track: Sequence[Snapshot]) -> bool:
    """Return whether the thing is near enough to the shape at the end."""
    return bool(_thing(fact, track[-1]).distance(_shape(fact)) <= _number(fact) + EXPECTATION_TOLERANCE)


def _visits(fact: Fact, track: Sequence[Snapshot]) -> bool:
    """Return whether the thing's centre was in the region at some step."""
    region = _shape(fact)
    return any(region.covers(_thing(fact, snapshot).centroid) for snapshot in track)


def _circles(fact: Fact, track: Sequence[Snapshot]) -> bool:
    """Return whether Utak's track winds around the thing."""
    return abs(winding(track, str(fact.args[1]))) >= MIN_CIRCLING_DEGREES


def winding(track: Sequence[Snapshot], name: str) -> float:
    """Return by how many degrees Utak's track winds around the centre of a thing, counter-clockwise positive."""
    total = 0.0
    for before, after in pairwise(track):
        centre = after.polygons[name].centroid
        start, end = (math.atan2(y - centre.y, x - centre.x) for x, y in (before.utak, after.utak))
        total += (math.degrees(end - start) + 180.0) % 360.0 - 180.0
    return total


def _unmoved(fact: Fact, track: Sequence[Snapshot]) -> bool:
    """Return whether the thing is exactly where it was."""
    name = str(fact.args[0])
    return outer_ring(track[0].polygons[name]) == outer_ring(track[-1].polygons[name])


def _within(fact: Fact, track: Sequence[Snapshot]) -> bool:
    """Return whether no more commands were given than allowed."""
    return track[-1].step <= _number(fact)


_CHECKS = {
    "inside": _inside,
    "near": _near,
    "visits": _visits,
    "circles": _circles,
    "unmoved": _unmoved,
    "within": _within,
}
