"""The predicates between the robot and the encodings that rules of users reach: what stands in each of their arguments.

A slot whose name is one of `DOMAINS` holds what a given fact of that kind names: rules cannot invent a region, a neck
or a thing.
"""

from collections.abc import Mapping

from kb.language.arguments import (
    COLOUR_ARGUMENT,
    NAME_ARGUMENT,
    ArgumentType,
    integer_argument,
    pattern_argument,
    word_argument,
)
from kb.language.vocabulary import CONFIDENCE_ARGUMENT, CORNER_NAMES, KIND_ARGUMENT, LENGTH_ARGUMENT, SHAPE_CLASSES

Signature = tuple[str, int]
Interface = Mapping[Signature, tuple[ArgumentType, ...]]

LARGE = 1_000_000  # no count, price or length in these facts is greater
AMOUNT = integer_argument("an amount", 0, LARGE)
NUMBER = integer_argument("a number", 0, LARGE)


def _named(name: str) -> ArgumentType:
    return ArgumentType(name, NAME_ARGUMENT.check)


def _numbered(name: str) -> ArgumentType:
    return ArgumentType(name, NUMBER.check, NUMBER.limits)


REGION, THING, PARAMETER = (_named(name) for name in ("region", "candidate", "parameter"))
NODE = pattern_argument("thing", "o[0-9]+", "o1")
NECK, CONVEX = _numbered("neck"), _numbered("convex corner")
PROPERTY = word_argument("property", ("shape", "colour"))
SHAPE = word_argument("shape", SHAPE_CLASSES)
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
        ("region", 3): (REGION, word_argument("state", ("zero", "nonzero")), CONFIDENCE_ARGUMENT),
        ("rim", 1): (REGION,),
        ("own", 1): (REGION,),
        ("surrounds", 2): (REGION, REGION),
        ("extent", 2): (REGION, AMOUNT),
        ("mass", 2): (REGION, AMOUNT),
        ("touched", 2): (REGION, COLOUR_ARGUMENT),
        ("kind", 3): (REGION, KIND_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("hidden_passage", 2): (REGION, REGION),
    },
    "shapes": {
        ("fit", 4): (NODE, SHAPE, AMOUNT, integer_argument("a rank", 1, len(SHAPE_CLASSES))),
        ("open_squares", 2): (NODE, AMOUNT),
        ("full_squares", 2): (NODE, AMOUNT),
        ("shape", 3): (NODE, SHAPE, CONFIDENCE_ARGUMENT),
    },
    "rooms": {
        ("neck", 5): (NECK, AMOUNT, AMOUNT, AMOUNT, CONFIDENCE_ARGUMENT),
        ("door", 2): (NECK, CONFIDENCE_ARGUMENT),
        ("opening", 1): (NECK,),
    },
    "corners": {
        ("convex", 3): (CONVEX, LENGTH_ARGUMENT, LENGTH_ARGUMENT),
        ("furthest", 2): (word_argument("corner", CORNER_NAMES), CONVEX),
    },
    "reconciliation": {
        ("wanted", 1): (PARAMETER,),
        ("named", 1): (PARAMETER,),
        ("claim", 4): (PARAMETER, PROPERTY, NAME_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("candidate", 2): (THING, CONFIDENCE_ARGUMENT),
        ("has", 4): (THING, PROPERTY, NAME_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("settled", 2): (THING, PROPERTY),
        ("distance", 2): (THING, AMOUNT),
        ("bound_before", 2): (PARAMETER, THING),
        ("carried", 1): (PARAMETER,),
        ("fixed", 1): (THING,),
        ("moved", 1): (THING,),
        ("may_be", 3): (THING, PROPERTY, NAME_ARGUMENT),
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
