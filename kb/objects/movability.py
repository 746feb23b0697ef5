"""Whether things can be moved, which way, and are felt before: kb/asp/movable.lp decides by what is known of each."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from utak.geometry.kernels.arrays import Square
from utak.kb.body import DIRECTIONS, Push, Turn
from utak.kb.language.atoms import signature_of
from utak.kb.perception.frame import ADJACENT_OFFSETS, Frame
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import predicates_read

MOVABLE = KB_ENCODINGS / "movable.lp"


class MotionHistory(NamedTuple):
    """A thing, and what motions with it came to."""

    name: str
    confidence: int  # percent of belief that it is an object
    length: int  # its longer side in squares, rounded up
    moved: bool = False  # whether the robot has moved it
    resisted: tuple[str, ...] = ()  # the ways of the last motions in a row, none of which moved it
    room_on: tuple[str, ...] = ()  # the ways in which nothing known stands right beside it


class Movability(NamedTuple):
    """Whether a thing can be moved."""

    percent: int  # of belief that it can be moved, if it is one
    felt_first: bool  # whether it is felt before it is moved, for it may be a piece of wall
    untried: tuple[str, ...]  # the ways in which it is tried next, as it did not move otherwise


def way_of(command: Push | Turn) -> str:
    """Return the way of a motion of a thing: the nearest of DIRECTIONS (robot frame), or left or right for a turn."""
    if isinstance(command, Turn):
        return "left" if command.degrees > 0 else "right"
    eighths = math.atan2(command.east, command.north) / math.radians(360 / len(DIRECTIONS))
    return DIRECTIONS[round(eighths) % len(DIRECTIONS)]


def square_ways(frame: Frame) -> Mapping[str, Square]:
    """Return the steps (columns, rows) to the four squares beside one, map frame, by the ways of pushes by them."""
    return {way_of(Push(*frame.to_utak(*step))): step for step in ADJACENT_OFFSETS[::2]}


def movabilities(
    things: Iterable[MotionHistory], rules: tuple[Path, ...] = (), world: Iterable[str] = ()
) -> Mapping[str, Movability]:
    """Return by name whether things can be moved; world: facts that rules may read besides."""
    facts = [fact for thing in things for fact in _facts_of(thing)]
    if not facts:
        return {}
    percents, marks = decided_of_things(MOVABLE, facts, rules, world, ("tried", "movable"))
    return {
        name: Movability(
            percent, f"felt_first({name})" in marks, tuple(w for w in DIRECTIONS if f"untried({name},{w})" in marks)
        )
        for name, percent in percents.items()
    }


def decided_of_things(
    encoding: Path, facts: Iterable[str], rules: tuple[Path, ...], world: Iterable[str], names: tuple[str, str]
) -> tuple[Mapping[str, int], frozenset[str]]:
    """Return the percent that an encoding states of each thing, and the other atoms that it shows.

    names : of the predicates of what was counted, and of what rules state in place of it.
    """
    counted, stated = names
    named = predicates_read(encoding.stem, rules)
    given = [*facts, *(fact for fact in world if signature_of(fact) in named)]
    found: dict[str, dict[str, list[int]]] = {counted: {}, stated: {}}
    marks = set()
    for atom in solve([encoding, *rules], given) or ():
        if atom.name in found:
            found[atom.name].setdefault(str(atom.arguments[0]), []).append(atom.arguments[1].number)
        else:
            marks.add(str(atom))
    percents = found[counted] | found[stated]
    return {name: max(those) for name, those in percents.items()}, frozenset(marks)


def _facts_of(thing: MotionHistory) -> Iterable[str]:
    """Yield what is known of a thing as facts, without full stops."""
    yield from (f"thing({thing.name})", f"kind({thing.name},object,{thing.confidence})")
    yield f"length({thing.name},{thing.length})"
    yield from [f"moved({thing.name})"] * thing.moved
    yield from (f"resisted({thing.name},{way},{many})" for way, many in sorted(Counter(thing.resisted).items()))
    yield from (f"room_on({thing.name},{way})" for way in thing.room_on)
