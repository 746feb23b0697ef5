"""The predicates between the robot and the encodings that rules of users reach: what stands in each of their arguments.

A slot whose name is one of `DOMAINS` holds what a given fact of that kind names: rules cannot invent a region, a neck
or a thing.
"""

from collections.abc import Mapping

from kb.language.arguments import COLOUR, NAME, Slot, named, whole, word
from kb.language.vocabulary import CONFIDENCE, CORNERS, KIND, LENGTH, SHAPES

Signature = tuple[str, int]
Interface = Mapping[Signature, tuple[Slot, ...]]

LARGE = 1_000_000  # no count, price or length in these facts is greater
AMOUNT = whole("an amount", 0, LARGE)
NUMBER = whole("a number", 0, LARGE)


def _named(name: str) -> Slot:
    return Slot(name, NAME.check)


def _numbered(name: str) -> Slot:
    return Slot(name, NUMBER.check, NUMBER.limits)


REGION, THING, PARAMETER = (_named(name) for name in ("region", "candidate", "parameter"))
NODE = named("thing", "o[0-9]+", "o1")
NECK, CONVEX = _numbered("neck"), _numbered("convex corner")
PROPERTY = word("property", ("shape", "colour"))
SHAPE = word("shape", SHAPES)
# By the name of a slot, the facts that name such things, and in which argument.
DOMAINS: Mapping[str, tuple[tuple[Signature, int], ...]] = {
    "region": ((("region", 3), 0),),
    "candidate": ((("candidate", 2), 0),),
    "parameter": ((("wanted", 1), 0),),
    "neck": ((("neck", 5), 0),),
    "convex corner": ((("convex", 3), 0),),
}
# Numbers that mean something else from one impression to the next: no rule states one as a constant.
PASSING = frozenset({"neck", "convex corner"})
REACHED: Mapping[str, Interface] = {
    "interpretation": {
        ("region", 3): (REGION, word("state", ("zero", "nonzero")), CONFIDENCE),
        ("rim", 1): (REGION,),
        ("own", 1): (REGION,),
        ("surrounds", 2): (REGION, REGION),
        ("extent", 2): (REGION, AMOUNT),
        ("mass", 2): (REGION, AMOUNT),
        ("touched", 2): (REGION, COLOUR),
        ("kind", 3): (REGION, KIND, CONFIDENCE),
        ("hidden_passage", 2): (REGION, REGION),
    },
    "shapes": {
        ("fit", 4): (NODE, SHAPE, AMOUNT, whole("a rank", 1, len(SHAPES))),
        ("open_squares", 2): (NODE, AMOUNT),
        ("full_squares", 2): (NODE, AMOUNT),
        ("shape", 3): (NODE, SHAPE, CONFIDENCE),
    },
    "rooms": {
        ("neck", 5): (NECK, AMOUNT, AMOUNT, AMOUNT, CONFIDENCE),
        ("door", 2): (NECK, CONFIDENCE),
        ("opening", 1): (NECK,),
    },
    "corners": {
        ("convex", 3): (CONVEX, LENGTH, LENGTH),
        ("furthest", 2): (word("corner", CORNERS), CONVEX),
    },
    "reconciliation": {
        ("wanted", 1): (PARAMETER,),
        ("named", 1): (PARAMETER,),
        ("claim", 4): (PARAMETER, PROPERTY, NAME, CONFIDENCE),
        ("candidate", 2): (THING, CONFIDENCE),
        ("has", 4): (THING, PROPERTY, NAME, CONFIDENCE),
        ("settled", 2): (THING, PROPERTY),
        ("distance", 2): (THING, AMOUNT),
        ("bound_before", 2): (PARAMETER, THING),
        ("carried", 1): (PARAMETER,),
        ("fixed", 1): (THING,),
        ("moved", 1): (THING,),
        ("may_be", 3): (THING, PROPERTY, NAME),
        ("bind", 2): (PARAMETER, THING),
        ("hypothesised", 1): (PARAMETER,),
        ("doubtful", 2): (PARAMETER, THING),
        ("contradicted", 3): (PARAMETER, THING, PROPERTY),
        ("unmovable", 2): (PARAMETER, THING),
        ("measurable", 2): (PARAMETER, THING),
    },
}
# What says which things there are, and how they are numbered: rules of users read it and add nothing to it.
READ_ONLY: frozenset[Signature] = frozenset(
    {("region", 3), ("own", 1), ("neck", 5), ("convex", 3), ("wanted", 1), ("candidate", 2), ("fit", 4)}
)
