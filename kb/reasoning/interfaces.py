"""The predicates of the encodings that users' rules may use, with the types of their arguments.

An argument type whose name is in `DEFINING_FACTS` accepts only what a given fact of that kind names. So rules cannot
invent a region, a neck or an object.
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
from kb.language.vocabulary import (
    CONFIDENCE_ARGUMENT,
    CORNER_NAMES,
    KIND_ARGUMENT,
    LENGTH_ARGUMENT,
    SHAPE_CLASSES,
    Signature,
)

Interface = Mapping[Signature, tuple[ArgumentType, ...]]  # argument types by predicate

MAX_AMOUNT = 1_000_000  # the greatest count, price or length that users' rules may derive; a convention
AMOUNT_ARGUMENT = integer_argument("an amount", 0, MAX_AMOUNT)  # a count, a length or a price
NUMBER_ARGUMENT = integer_argument("a number", 0, MAX_AMOUNT)  # the number of a thing


def _name_argument(name: str) -> ArgumentType:
    """Return the type of plain names (no arguments, no quotes), with its own name for messages.

    The type holds that name, and a check that returns the complaint about a term, or None when the term fits.
    """
    return ArgumentType(name, NAME_ARGUMENT.check)


def _number_argument(name: str) -> ArgumentType:
    """Return the type of numbers from 0 to `MAX_AMOUNT`, with its own name for messages.

    The type holds that name, a check that returns the complaint about a term, or None when it fits, and the limits.
    """
    return ArgumentType(name, NUMBER_ARGUMENT.check, NUMBER_ARGUMENT.limits)


REGION_ARGUMENT, CANDIDATE_ARGUMENT, PARAMETER_ARGUMENT = (
    _name_argument(name) for name in ("region", "candidate", "parameter")
)
NODE_ARGUMENT = pattern_argument("thing", "o[0-9]+", "o1")  # an object of the world model
NECK_ARGUMENT, CONVEX_CORNER_ARGUMENT = _number_argument("neck"), _number_argument("convex corner")
PROPERTY_ARGUMENT = word_argument("property", ("shape", "colour"))  # what claims are about
SHAPE_ARGUMENT = word_argument("shape", SHAPE_CLASSES)  # a shape class
# By the name of an argument type: the predicates whose facts name all such things, and the index of that argument.
DEFINING_FACTS: Mapping[str, tuple[tuple[Signature, int], ...]] = {
    "region": ((("region", 3), 0),),
    "candidate": ((("candidate", 2), 0),),
    "parameter": ((("wanted", 1), 0),),
    "neck": ((("neck", 5), 0),),
    "convex corner": ((("convex", 3), 0),),
}
# Argument types whose numbers mean other things after the next impression. No rule may state one as a constant.
TRANSIENT_NUMBERS = frozenset({"neck", "convex corner"})
# By the name of an encoding: the predicates that users' rules may use there, with their argument types.
USER_RULE_INTERFACES: Mapping[str, Interface] = {
    "interpretation": {
        ("region", 3): (REGION_ARGUMENT, word_argument("state", ("zero", "nonzero")), CONFIDENCE_ARGUMENT),
        ("rim", 1): (REGION_ARGUMENT,),
        ("own", 1): (REGION_ARGUMENT,),
        ("surrounds", 2): (REGION_ARGUMENT, REGION_ARGUMENT),
        ("extent", 2): (REGION_ARGUMENT, AMOUNT_ARGUMENT),
        ("mass", 2): (REGION_ARGUMENT, AMOUNT_ARGUMENT),
        ("touched", 2): (REGION_ARGUMENT, COLOUR_ARGUMENT),
        ("kind", 3): (REGION_ARGUMENT, KIND_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("hidden_passage", 2): (REGION_ARGUMENT, REGION_ARGUMENT),
    },
    "shapes": {
        ("fit", 4): (NODE_ARGUMENT, SHAPE_ARGUMENT, AMOUNT_ARGUMENT, integer_argument("a rank", 1, len(SHAPE_CLASSES))),
        ("open_squares", 2): (NODE_ARGUMENT, AMOUNT_ARGUMENT),
        ("full_squares", 2): (NODE_ARGUMENT, AMOUNT_ARGUMENT),
        ("shape", 3): (NODE_ARGUMENT, SHAPE_ARGUMENT, CONFIDENCE_ARGUMENT),
    },
    "rooms": {
        ("neck", 5): (NECK_ARGUMENT, AMOUNT_ARGUMENT, AMOUNT_ARGUMENT, AMOUNT_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("door", 2): (NECK_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("opening", 1): (NECK_ARGUMENT,),
    },
    "corners": {
        ("convex", 3): (CONVEX_CORNER_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT),
        ("furthest", 2): (word_argument("corner", CORNER_NAMES), CONVEX_CORNER_ARGUMENT),
    },
    "reconciliation": {
        ("wanted", 1): (PARAMETER_ARGUMENT,),
        ("named", 1): (PARAMETER_ARGUMENT,),
        ("claim", 4): (PARAMETER_ARGUMENT, PROPERTY_ARGUMENT, NAME_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("candidate", 2): (CANDIDATE_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("has", 4): (CANDIDATE_ARGUMENT, PROPERTY_ARGUMENT, NAME_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("settled", 2): (CANDIDATE_ARGUMENT, PROPERTY_ARGUMENT),
        ("distance", 2): (CANDIDATE_ARGUMENT, AMOUNT_ARGUMENT),
        ("bound_before", 2): (PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT),
        ("carried", 1): (PARAMETER_ARGUMENT,),
        ("fixed", 1): (CANDIDATE_ARGUMENT,),
        ("moved", 1): (CANDIDATE_ARGUMENT,),
        ("may_be", 3): (CANDIDATE_ARGUMENT, PROPERTY_ARGUMENT, NAME_ARGUMENT),
        ("bind", 2): (PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT),
        ("hypothesised", 1): (PARAMETER_ARGUMENT,),
        ("doubtful", 2): (PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT),
        ("contradicted", 3): (PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT, PROPERTY_ARGUMENT),
        ("unmovable", 2): (PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT),
        ("measurable", 2): (PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT),
    },
}
# Predicates that state which things exist and how they are numbered. Users' rules may read, but not derive them.
READ_ONLY_PREDICATES: frozenset[Signature] = frozenset(
    {("region", 3), ("own", 1), ("neck", 5), ("convex", 3), ("wanted", 1), ("candidate", 2), ("fit", 4)}
)
