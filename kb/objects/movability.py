"""Whether things can be moved, and are felt before: what is known of each goes in, and kb/asp/movable.lp decides."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from utak.kb.language.atoms import signature_of
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
    unmoved: int = 0  # how many of the last motions in a row did not move it


class Movability(NamedTuple):
    """Whether a thing can be moved."""

    percent: int  # of belief that it can be moved, if it is one
    felt_first: bool  # whether it is felt before it is moved, for it may be a piece of wall


def movabilities(
    things: Iterable[MotionHistory], rules: tuple[Path, ...] = (), world: Iterable[str] = ()
) -> Mapping[str, Movability]:
    """Return by name whether things can be moved; world: facts that rules may read besides."""
    facts = [fact for thing in things for fact in _facts_of(thing)]
    decided = decided_of_things(MOVABLE, facts, rules, world, ("tried", "movable", "felt_first")) if facts else {}
    return {name: Movability(*one) for name, one in decided.items()}


def decided_of_things(
    encoding: Path, facts: Iterable[str], rules: tuple[Path, ...], world: Iterable[str], names: tuple[str, str, str]
) -> Mapping[str, tuple[int, bool]]:
    """Return by thing the percent that an encoding states of it, and whether it has a mark.

    names : of the predicates of what was counted, of what rules state in place of it, and of the mark.
    """
    counted, stated, mark = names
    named = predicates_read(encoding.stem, rules)
    given = [*facts, *(fact for fact in world if signature_of(fact) in named)]
    found: dict[str, dict[str, list[int]]] = {counted: {}, stated: {}}
    marked = set()
    for atom in solve([encoding, *rules], given) or ():
        if atom.name in found:
            found[atom.name].setdefault(str(atom.arguments[0]), []).append(atom.arguments[1].number)
        elif atom.match(mark, 1):
            marked.add(str(atom.arguments[0]))
    percents = found[counted] | found[stated]
    return {name: (max(those), name in marked) for name, those in percents.items()}


def _facts_of(thing: MotionHistory) -> Iterable[str]:
    """Yield what is known of a thing as facts, without full stops."""
    yield from (f"thing({thing.name})", f"kind({thing.name},object,{thing.confidence})")
    yield f"length({thing.name},{thing.length})"
    yield from [f"moved({thing.name})"] * thing.moved
    yield from [f"unmoved({thing.name},{thing.unmoved})"] * (thing.unmoved > 0)
