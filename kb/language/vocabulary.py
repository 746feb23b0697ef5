"""The declared vocabulary of each kind of fact file, and the check of facts against it (docs/files.md)."""

from collections.abc import Iterable, Mapping
from enum import StrEnum
from typing import NamedTuple

from kb.language.arguments import COLOUR, NAME, Complaint, Slot, named, shape_text, short, whole, word
from kb.language.diagnostics import Problem, did_you_mean
from kb.language.source_text import Source
from kb.language.terms import Fact, Symbol, Term

Vocabulary = Mapping[str, tuple[Slot, ...]]

SHAPES = ("square", "brick", "rectangle", "l_shape", "t_shape", "u_shape", "triangle", "disc", "polygon")
CORNERS = ("northeast", "northwest", "southeast", "southwest")
RESERVED = frozenset({"utak", "start", "next", "corner", "room", "verge", *CORNERS})
DEGREES = whole("an angle in degrees", -36000, 36000)
MOST_SQUARES = 4096  # along either side of a table

WORLD: Vocabulary = {
    "table": (whole("a table's width", 1, MOST_SQUARES), whole("a table's height", 1, MOST_SQUARES)),
    "verge": (shape_text("the verge", "POLYGON", "MULTIPOLYGON"),),
    "object": (NAME, COLOUR, shape_text("an object's shape", "POLYGON")),
    "fixed": (NAME, COLOUR, shape_text("a fixed object's shape", "POLYGON")),
    "utak": (shape_text("Utak's place", "POINT"), DEGREES),
}

ANYWHERE = shape_text("a place", "POINT", "LINESTRING", "POLYGON", "MULTIPOLYGON")
EXPECT: Vocabulary = {
    "inside": (NAME, shape_text("a region", "POLYGON", "MULTIPOLYGON")),
    "near": (NAME, ANYWHERE, whole("a distance in squares", 0, MOST_SQUARES)),
    "visits": (NAME, shape_text("a region", "POLYGON", "MULTIPOLYGON")),
    "circles": (word("walker", ["utak"]), NAME),
    "unmoved": (NAME,),
    "within": (whole("a number of steps", 0, 1_000_000),),
    "fails": (),
}


def _compound(name: str, argument: Slot, otherwise: str) -> Slot:
    """A plain name, or `name(argument)`: such as corner(northeast)."""

    def check(term: Term) -> Complaint | None:
        if not isinstance(term, Symbol) or not term.args:
            return NAME.check(term)
        if term.name != name:
            hint = did_you_mean(term.name, [name]) or f"such as {name}({otherwise})"
            return Complaint(term.span, f"unknown place {short(term)}", hint)
        if len(term.args) != 1:
            return Complaint(
                term.span, f"{name} takes 1 argument, not {len(term.args)}", f"such as {name}({otherwise})"
            )
        return argument.check(term.args[0])

    return Slot(f"{name} or name", check)


def _fact_of(name: str, vocabulary: Vocabulary) -> Slot:
    """A whole fact of a vocabulary, as an argument."""

    def check(term: Term) -> Complaint | None:
        if not isinstance(term, Symbol):
            return Complaint(term.span, f"{name} must be a fact, not {short(term)}")
        return next(iter(_complaints(term, vocabulary)), None)

    return Slot(name, check)


CLAIMS: Vocabulary = {"shape": (NAME, word("shape", SHAPES)), "colour": (NAME, COLOUR)}
START: Vocabulary = {
    "object": (NAME,),
    "door": (NAME,),
    "room": (NAME,),
    **CLAIMS,
    "confidence": (_fact_of("what is claimed", CLAIMS), whole("a confidence", 0, 100)),
}
ATTAINED: Vocabulary = {
    "at": (NAME, _compound("corner", word("corner", CORNERS), "northeast")),
    "in": (NAME, _compound("room", word("room", ["next"]), "next")),
    "through": (NAME, NAME),
    "around": (NAME, word("place", ["corner"])),
    "circled": (word("walker", ["utak"]), NAME),
    "beside": (NAME, NAME),
    "pose": (NAME, shape_text("a place", "POINT"), DEGREES),
    "not_through": (NAME, NAME),
}
GOAL: Vocabulary = {**ATTAINED, "first": (_fact_of("a goal", ATTAINED),), "then": (_fact_of("a goal", ATTAINED),)}


class Open(StrEnum):
    """Of what more of a predicate may hold than is believed."""

    NEVER = "never"
    """Of nothing: the robot knows all of it."""
    UNSEEN = "unseen"
    """Of what was not seen yet, as long as a part of the table is unseen."""
    UNTOLD = "untold"
    """Of that, and of things of which nothing is believed that this predicate says."""


class Declared(NamedTuple):
    """A predicate of the world model.

    slots : its arguments. open : of what more of it may hold. subject : which argument it speaks of, from 0.
    confident : its last argument is a confidence; one between 0 and 100 may turn out to be any other.
    settled : subjects of which all is believed that ever will be.
    """

    slots: tuple[Slot, ...]
    open: Open
    subject: int = 0
    confident: bool = False
    settled: frozenset[str] = frozenset()


THING = named("thing", "org|floor|verge|o[0-9]+", "o1, floor, verge, or org, which is Utak")
ROOM = named("room", "r[0-9]+", "r1")
DOOR = named("door", "d[0-9]+", "d1")
CONFIDENCE = whole("a confidence", 0, 100)
LENGTH = whole("a length in hundredths of squares", -(2**31), 2**31 - 1)
COUNT = whole("a count", 0, 2**31 - 1)
KIND = word("kind", ("utak", "floor", "verge", "object"))
NO_THINGS = frozenset({"org", "floor", "verge"})
# The predicates of kb/asp/belief.lp, and object/1.
BELIEF: Mapping[tuple[str, int], Declared] = {
    ("node", 1): Declared((THING,), Open.UNSEEN),
    ("object", 1): Declared((THING,), Open.UNSEEN),
    ("kind", 3): Declared((THING, KIND, CONFIDENCE), Open.UNSEEN, confident=True),
    ("child", 2): Declared((THING, THING), Open.UNSEEN, subject=1),
    ("offset", 3): Declared((THING, LENGTH, LENGTH), Open.UNSEEN),
    ("held", 1): Declared((THING,), Open.NEVER),
    ("rect", 5): Declared((THING, LENGTH, LENGTH, LENGTH, LENGTH), Open.UNSEEN),
    ("segment", 7): Declared((THING, COUNT, LENGTH, LENGTH, LENGTH, LENGTH, CONFIDENCE), Open.UNSEEN, confident=True),
    ("shape", 3): Declared((THING, word("shape", SHAPES), CONFIDENCE), Open.UNTOLD, 0, True, NO_THINGS),
    ("colour", 3): Declared((THING, COLOUR, CONFIDENCE), Open.UNTOLD, 0, True, NO_THINGS),
    ("movable", 2): Declared((THING, CONFIDENCE), Open.UNTOLD, 0, True, NO_THINGS),
    ("adjacent", 2): Declared((THING, THING), Open.UNTOLD, settled=frozenset({"org"})),
    ("room", 1): Declared((ROOM,), Open.UNSEEN),
    ("door", 1): Declared((DOOR,), Open.UNSEEN),
    ("connects", 3): Declared((DOOR, ROOM, ROOM), Open.UNSEEN),
    ("width", 2): Declared((DOOR, LENGTH), Open.UNSEEN),
    ("in", 2): Declared((THING, ROOM), Open.UNSEEN),
    ("corner", 3): Declared((word("corner", CORNERS), LENGTH, LENGTH), Open.NEVER),
    ("unseen", 2): Declared((ROOM, COUNT), Open.NEVER),
}


def check_facts(source: Source, facts: Iterable[Fact], vocabulary: Vocabulary) -> list[Problem]:
    """Return what is wrong with facts against a vocabulary: unknown names, numbers and kinds of arguments."""
    return [source.problem(*complaint) for fact in facts for complaint in _complaints(fact, vocabulary)]


def _complaints(fact: Fact, vocabulary: Vocabulary) -> list[Complaint]:
    slots = vocabulary.get(fact.name)
    if slots is None:
        hint = did_you_mean(fact.name, vocabulary) or f"known here: {', '.join(sorted(vocabulary))}"
        return [Complaint(fact.span, f"unknown predicate {fact.name}/{len(fact.args)}", hint)]
    if len(slots) != len(fact.args):
        form = f"{fact.name}({', '.join(slot.name for slot in slots)})" if slots else fact.name
        what = f"{fact.name} takes {len(slots)} argument{'s' * (len(slots) != 1)}, not {len(fact.args)}"
        return [Complaint(fact.span, what, f"write {form}")]
    found = (slot.check(term) for slot, term in zip(slots, fact.args, strict=True))
    return [complaint for complaint in found if complaint is not None]
