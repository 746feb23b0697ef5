"""Disturbances: changes of the table by others while the robot acts, the facts of `--disturb FILE` (docs/files.md).

move(t1, "POINT (20 12)", 7).                       a thing is put elsewhere before command 7
lift(utak, "POINT (8.5 9.5)", 12).                  the robot is put elsewhere; it lets go of what it holds
appear(t9, r, "POLYGON ((3 3, 6 3, 6 5, 3 3))", 4). a new thing is put on the table: name, colour, shape
vanish(t1, 9).                                      a thing is taken from the table
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import shapely

from utak.kb.language.arguments import (
    COLOUR_ARGUMENT,
    NAME_ARGUMENT,
    decimal_value,
    integer_argument,
    text_value,
    wkt_argument,
    word_argument,
)
from utak.kb.language.diagnostics import BadInputError, Problem, did_you_mean
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import Source, read_source, source_from_bytes
from utak.kb.language.terms import Fact
from utak.kb.language.vocabulary import Vocabulary, check_facts
from utak.kb.language.wkt import parse_wkt
from utak.simulator.scenario.settings import MAX_STEPS
from utak.simulator.scenario.worldfile import MIN_THING_AREA, RESERVED_THING_NAMES
from utak.simulator.world.placing import robot_misplaced, standing, thing_misplaced
from utak.simulator.world.world import VERGE_COLOUR, Disturbance, Thing, World, beside_table

COMMAND_NUMBER_ARGUMENT = integer_argument("a step", 1, MAX_STEPS)  # the number of a command
# The predicates of the file.
DISTURBANCE_VOCABULARY: Vocabulary = {
    "move": (NAME_ARGUMENT, wkt_argument("a place", "POINT"), COMMAND_NUMBER_ARGUMENT),
    "lift": (word_argument("robot", ["utak"]), wkt_argument("a place", "POINT"), COMMAND_NUMBER_ARGUMENT),
    "appear": (NAME_ARGUMENT, COLOUR_ARGUMENT, wkt_argument("a thing's shape", "POLYGON"), COMMAND_NUMBER_ARGUMENT),
    "vanish": (NAME_ARGUMENT, COMMAND_NUMBER_ARGUMENT),
}
# Before this command nothing can have been turned by the robot: the first command may grasp, the second turn.
FIRST_TURNED_STEP = 3


def read_disturbed(world: World, path: Path | str) -> World:
    """Return a world in which others do what a file states."""
    return disturbed_world(world, read_source(path))


def disturbed_world(world: World, source: Source) -> World:
    """Return a world in which others do what facts state; raise BadInputError where they are wrong."""
    facts = parse_facts(source)
    if problems := check_facts(source, facts, DISTURBANCE_VOCABULARY) or list(_problems(source, facts, world)):
        raise BadInputError(problems)
    new = [_appearing(world, fact) for fact in facts if fact.name == "appear"]
    things = sorted((*world.movable, *new), key=lambda thing: thing.name)
    acts = sorted((_disturbance(fact) for fact in facts), key=lambda act: act.step)
    return replace(world, movable=tuple(things), disturbances=tuple(acts))


def stated_disturbances(text: str) -> tuple[Disturbance, ...]:
    """Return what others do by facts of an episode; raise BadInputError where they are no such facts."""
    source = source_from_bytes("disturbances", text.encode())
    facts = parse_facts(source)
    if problems := check_facts(source, facts, DISTURBANCE_VOCABULARY):
        raise BadInputError(problems)
    return tuple(_disturbance(fact) for fact in facts)


def undisturbed(world: World) -> World:
    """Return a world as it is without disturbances."""
    appearing = {act.name for act in world.disturbances if isinstance(act.place, shapely.Polygon)}
    things = tuple(thing for thing in world.movable if thing.name not in appearing)
    return replace(world, movable=things, disturbances=())


def _disturbance(fact: Fact) -> Disturbance:
    place = None if fact.name == "vanish" else _shape(fact)
    return Disturbance(_step(fact), str(fact.args[0]), place, str(fact))


def _appearing(world: World, fact: Fact) -> Thing:
    """Return a thing that appears later: until then it lies beside the table."""
    return Thing(str(fact.args[0]), str(fact.args[1]), beside_table(_shape(fact), world.width))


def _step(fact: Fact) -> int:
    return int(decimal_value(fact.args[-1]))


def _shape(fact: Fact) -> Any:
    """Return the place or the outline that a fact states."""
    return shapely.remove_repeated_points(parse_wkt(text_value(fact.args[-2])))


def _problems(source: Source, facts: Sequence[Fact], world: World) -> Iterator[Problem]:
    """Yield what is wrong with facts of valid vocabulary, as far as it is known before the run."""
    appear = {str(fact.args[0]): fact for fact in reversed(facts) if fact.name == "appear"}
    for fact in facts:
        if fact.name == "appear":
            yield from _bad_thing(source, fact, world, appear)
        elif fact.name != "lift":
            yield from _bad_name(source, fact, world, appear)
        if hindrance := _hindrance(fact, world, appear):
            yield source.problem(fact.args[-2].span, hindrance)


def _bad_thing(source: Source, fact: Fact, world: World, appear: dict[str, Fact]) -> Iterator[Problem]:
    """Yield what is wrong with the name, the colour and the shape of a thing that appears."""
    name, colour, shape = fact.args[0], fact.args[1], _shape(fact)
    if str(name) in RESERVED_THING_NAMES:
        yield source.problem(name.span, f"{name} is a reserved word and cannot name an object")
    elif any(thing.name == str(name) for thing in (*world.movable, *world.fixed)):
        yield source.problem(name.span, f"the world has an object {name} already", "move(...) puts it elsewhere")
    elif appear[str(name)] is not fact:
        yield source.problem(
            name.span, f"a second object {name}", f"the first is on line {appear[str(name)].span.line}"
        )
    if str(colour) == VERGE_COLOUR:
        yield source.problem(colour.span, "colour b is the verge's", "take another letter")
    if shape.interiors:
        yield source.problem(fact.args[2].span, "an object that can be moved has no holes", "fill the hole")
    if shape.area < MIN_THING_AREA:
        yield source.problem(fact.args[2].span, f"a shape of no size: {shape.area:.2g} squares")


def _bad_name(source: Source, fact: Fact, world: World, appear: dict[str, Fact]) -> Iterator[Problem]:
    """Yield a problem unless a fact names a thing that can be moved and is there by then."""
    name = str(fact.args[0])
    span, movable = fact.args[0].span, {thing.name for thing in world.movable}
    if name in movable:
        return
    if name in appear:
        if _step(fact) < _step(appear[name]):
            yield source.problem(span, f"{name} appears only before command {_step(appear[name])}")
    elif name == "utak":
        yield source.problem(span, "the robot is no object", "write lift(utak, ...)")
    elif any(thing.name == name for thing in world.fixed):
        yield source.problem(span, f"{name} is fixed: nobody can move it")
    else:
        known = {*movable, *appear}
        hint = did_you_mean(name, known) or f"known here: {', '.join(sorted(known)) or 'none'}"
        yield source.problem(span, f"the world has no object {name}", hint)


def _hindrance(fact: Fact, world: World, appear: dict[str, Fact]) -> str:
    """Return what never moves and certainly is in the way where a fact puts something, in words; "" for nothing."""
    if fact.name == "vanish":
        return ""
    name, place = str(fact.args[0]), _shape(fact)
    if fact.name == "lift":
        return robot_misplaced(world, place, standing(world))
    if fact.name == "appear":
        return thing_misplaced(world, name, place, standing(world))
    polygon = next((thing.polygon for thing in world.movable if thing.name == name), None)
    if polygon is None and name in appear:
        polygon = _shape(appear[name])
    if polygon is None:
        return ""
    if _step(fact) >= FIRST_TURNED_STEP:  # the robot may have turned it: the part that it covers however it lies
        middle = polygon.centroid
        if not polygon.contains(middle):
            return ""
        polygon = middle.buffer(middle.distance(polygon.exterior))
    return thing_misplaced(world, name, Disturbance(1, name, place, "").outline(polygon, world.width), standing(world))
