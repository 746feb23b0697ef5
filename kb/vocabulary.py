"""The declared vocabulary of each kind of fact file, and the check of facts against it (docs/files.md)."""

from collections.abc import Iterable, Mapping

from kb.facts import Fact, Symbol, Term
from kb.problems import Problem, did_you_mean
from kb.slots import COLOUR, NAME, Complaint, Slot, shape_text, short, whole, word
from kb.source import Source

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
