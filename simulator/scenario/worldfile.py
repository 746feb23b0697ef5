"""world.lp: the true world of a scenario, read and checked."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import shapely

from utak.kb.language.arguments import decimal_value, text_value
from utak.kb.language.diagnostics import BadInputError, Problem
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import Source, read_source
from utak.kb.language.terms import Fact
from utak.kb.language.vocabulary import WORLD_VOCABULARY, check_facts
from utak.kb.language.wkt import parse_wkt
from utak.simulator.world.placing import MAX_TOUCHING_AREA, touches_floor
from utak.simulator.world.world import VERGE_COLOUR, Thing, World

MIN_THING_AREA = 1e-4  # square squares; a smaller thing is taken for a mistake; a convention
RESERVED_THING_NAMES = ("utak", "verge")  # names that objects cannot have


class _Stated(NamedTuple):
    """A fact of the world and the shape that it states."""

    fact: Fact
    shape: Any


def read_world(path: Path | str) -> World:
    """Return the world that world.lp states."""
    source = read_source(path)
    facts = parse_facts(source)
    problems = check_facts(source, facts, WORLD_VOCABULARY) or list(_counts(source, facts))
    if problems:
        raise BadInputError(problems)
    return _world(source, facts)


def _counts(source: Source, facts: Sequence[Fact]) -> Iterator[Problem]:
    """Yield a problem unless there are exactly one table, one verge and one Utak."""
    stated = defaultdict(list)
    for fact in facts:
        stated[fact.name].append(fact)
    for name in ("table", "verge", "utak"):
        if not stated[name]:
            yield source.problem(source.start(), f"the world has no {name}: a fact {name}(...) is missing")
        for again in stated[name][1:]:
            yield source.problem(again.span, f"a second {name}", f"the first is on line {stated[name][0].span.line}")


def _world(source: Source, facts: Sequence[Fact]) -> World:
    """Return the world that facts of valid vocabulary state; raise BadInputError for errors of geometry."""
    table, utak = _only_fact(facts, "table"), _only_fact(facts, "utak")
    width, height = _number(table, 0), _number(table, 1)
    verge = _Stated(_only_fact(facts, "verge"), _shape(_only_fact(facts, "verge"), 0))
    things = [_Stated(fact, _shape(fact, 2)) for fact in facts if fact.name in ("object", "fixed")]
    here = _shape(utak, 0)
    problems = [
        *_bad_names(source, things),
        *_bad_shapes(source, things),
        *_off_the_table(source, [verge, *things], shapely.box(0, 0, width, height)),
        *_overlaps(source, verge, things),
        *_bad_place(source, utak, here, [verge, *things], width, height),
    ]
    if problems:
        raise BadInputError(problems)
    return World(
        width,
        height,
        verge.shape,
        tuple(_things(things, "object")),
        tuple(_things(things, "fixed")),
        (float(here.x), float(here.y)),
        _number(utak, 1) % 360,
    )


def _only_fact(facts: Sequence[Fact], name: str) -> Fact:
    return next(fact for fact in facts if fact.name == name)


def _number(fact: Fact, index: int) -> int:
    return int(decimal_value(fact.args[index]))


def _shape(fact: Fact, index: int) -> Any:
    return parse_wkt(text_value(fact.args[index]))


def _things(stated: Sequence[_Stated], kind: str) -> list[Thing]:
    """Return the things of one kind, "object" or "fixed", in the order of their names."""
    found = [
        Thing(str(one.fact.args[0]), str(one.fact.args[1]), shapely.remove_repeated_points(one.shape))
        for one in stated
        if one.fact.name == kind
    ]
    return sorted(found, key=lambda thing: thing.name)


def _bad_names(source: Source, things: Sequence[_Stated]) -> Iterator[Problem]:
    """Yield the problems of names and colours."""
    lines: dict[str, int] = {}
    for thing in things:
        name, colour = thing.fact.args[0], thing.fact.args[1]
        if str(name) in RESERVED_THING_NAMES:
            yield source.problem(name.span, f"{name} is a reserved word and cannot name an object")
        elif str(name) in lines:
            yield source.problem(name.span, f"a second object {name}", f"the first is on line {lines[str(name)]}")
        lines.setdefault(str(name), name.span.line)
        if str(colour) == VERGE_COLOUR:
            yield source.problem(colour.span, "colour b is the verge's", "take another letter")


def _bad_shapes(source: Source, things: Sequence[_Stated]) -> Iterator[Problem]:
    """Yield the problems of holes in movable objects and of shapes that are too small."""
    for thing in things:
        span = thing.fact.args[2].span
        if thing.fact.name == "object" and thing.shape.interiors:
            yield source.problem(span, "an object that can be moved has no holes", "write fixed(...), or fill the hole")
        if thing.shape.area < MIN_THING_AREA:
            yield source.problem(span, f"a shape of no size: {thing.shape.area:.2g} squares")


def _off_the_table(source: Source, stated: Sequence[_Stated], table: Any) -> Iterator[Problem]:
    """Yield a problem for each shape that reaches beyond the table."""
    for one in stated:
        if one.shape.difference(table).area > MAX_TOUCHING_AREA:
            name = "the verge" if one.fact.name == "verge" else str(one.fact.args[0])
            x0, y0, x1, y1 = (f"{value:g}" for value in one.shape.bounds)
            yield source.problem(
                one.fact.args[-1].span, f"{name} reaches beyond the table: ({x0}, {y0}) to ({x1}, {y1})"
            )


def _overlaps(source: Source, verge: _Stated, things: Sequence[_Stated]) -> Iterator[Problem]:
    """Yield a problem for each pair of shapes that share more than `MAX_TOUCHING_AREA`."""
    shapely.prepare(verge.shape)
    pairs = [(verge, thing) for thing in things if verge.shape.intersects(thing.shape)]
    tree = shapely.STRtree([thing.shape for thing in things])
    for i, thing in enumerate(things):
        pairs += [(things[j], thing) for j in sorted(tree.query(thing.shape, "intersects")) if j < i]
    for first, second in pairs:
        common = first.shape.intersection(second.shape).area
        if common > MAX_TOUCHING_AREA:
            name = "the verge" if first is verge else str(first.fact.args[0])
            what = f"{second.fact.args[0]} overlaps {name} by {common:.3g} squares"
            yield source.problem(second.fact.args[2].span, what)


def _bad_place(
    source: Source, utak: Fact, here: Any, stated: Sequence[_Stated], width: int, height: int
) -> Iterator[Problem]:
    """Yield the problems of the floor, the verge stated first, and of Utak's place: off the table, or not on floor."""
    if stated[0].shape.area >= width * height - MAX_TOUCHING_AREA:
        what = "the verge covers the whole table: there is no floor"
        yield source.problem(stated[0].fact.args[0].span, what)
    span = utak.args[0].span
    if not (0 <= here.x <= width and 0 <= here.y <= height):
        yield source.problem(span, f"Utak stands off the table, at ({here.x:g}, {here.y:g})")
        return
    inside = [one for one in stated if one.shape.contains(here)]
    for one in inside:
        name = "the verge" if one.fact.name == "verge" else str(one.fact.args[0])
        yield source.problem(span, f"Utak stands inside {name}, at ({here.x:g}, {here.y:g})")
    if not inside and not touches_floor(here, [one.shape for one in stated], width, height):
        what = f"Utak stands where no floor is, at ({here.x:g}, {here.y:g})"
        yield source.problem(span, what, "the robot stands on floor, or on its edge")
