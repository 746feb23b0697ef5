"""The predicates of fact files and of the world model, with the types of their arguments (docs/files.md)."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from enum import StrEnum
from typing import NamedTuple

from utak.kb.body import DIRECTIONS
from utak.kb.language.arguments import (
    COLOUR_ARGUMENT,
    NAME_ARGUMENT,
    ArgumentType,
    Complaint,
    abbreviated,
    decimal_argument,
    integer_argument,
    pattern_argument,
    wkt_argument,
    word_argument,
)
from utak.kb.language.diagnostics import Problem, did_you_mean
from utak.kb.language.goal_words import CORNER_ARGUMENT, CORNER_NAMES, DEGREES_ARGUMENT, GOAL_WORDS, ROBOT
from utak.kb.language.source_text import Source
from utak.kb.language.terms import Fact, Symbol, Term

Signature = tuple[str, int]  # the name of a predicate and its number of arguments
Vocabulary = Mapping[str, tuple[ArgumentType, ...]]  # argument types by predicate

# The shape classes of objects (docs/files.md): those of geometry/shapes/classes.py, and unions of them.
OUTLINE_CLASSES = ("square", "brick", "l_shape", "t_shape", "u_shape", "triangle", "disc")
SHAPE_CLASSES = (*OUTLINE_CLASSES, "rectangle", "polygon")
# Words of goals that cannot name parameters.
RESERVED_PARAMETER_NAMES = frozenset({ROBOT, "start", "next", "corner", "room", "verge", *CORNER_NAMES})
MAX_TABLE_SIDE = 4096  # squares along each side of a table (docs/files.md)
MAX_SIZE = 10_000  # squares that a thing may be said to cover; a convention

# The predicates of world.lp.
WORLD_VOCABULARY: Vocabulary = {
    "table": (
        integer_argument("a table's width", 1, MAX_TABLE_SIDE),
        integer_argument("a table's height", 1, MAX_TABLE_SIDE),
    ),
    "verge": (wkt_argument("the verge", "POLYGON", "MULTIPOLYGON"),),
    "object": (NAME_ARGUMENT, COLOUR_ARGUMENT, wkt_argument("an object's shape", "POLYGON")),
    "fixed": (NAME_ARGUMENT, COLOUR_ARGUMENT, wkt_argument("a fixed object's shape", "POLYGON")),
    "utak": (wkt_argument("Utak's place", "POINT"), DEGREES_ARGUMENT),
}


def fact_argument(name: str, vocabulary: Vocabulary) -> ArgumentType:
    """Return the type of an argument that is a whole fact of a vocabulary, such as G in first(G)."""

    def check(term: Term) -> Complaint | None:
        """Return the first complaint about a term, or None when it is a valid fact of the vocabulary."""
        if not isinstance(term, Symbol):
            return Complaint(term.span, f"{name} must be a fact, not {abbreviated(term)}")
        return next(iter(_complaints(term, vocabulary)), None)

    return ArgumentType(name, check, words=tuple(f"{predicate}(" for predicate in vocabulary))


WKT_ANY_SHAPE = wkt_argument("a place", "POINT", "LINESTRING", "POLYGON", "MULTIPOLYGON")  # a shape of any kind
VERDICT_WORDS = ("done", "impossible", "possible_if", "limit")  # the ends of a run (docs/files.md)
MAX_WEIGHT_POINTS = 1_000_000  # points of one expectation; a convention
# What the order of a run's visits is stated about.
VISITS: Vocabulary = {"visits": (NAME_ARGUMENT, wkt_argument("a region", "POLYGON", "MULTIPOLYGON"))}
# What expect.lp expects of a run.
EXPECTATIONS: Vocabulary = {
    "inside": (NAME_ARGUMENT, wkt_argument("a region", "POLYGON", "MULTIPOLYGON")),
    "near": (NAME_ARGUMENT, WKT_ANY_SHAPE, decimal_argument("a distance in squares", 0, MAX_TABLE_SIDE)),
    **VISITS,
    "before": (fact_argument("what comes first", VISITS), fact_argument("what comes after it", VISITS)),
    "avoids": (NAME_ARGUMENT, wkt_argument("a region", "POLYGON", "MULTIPOLYGON")),
    "circles": (word_argument("walker", ["utak"]), NAME_ARGUMENT),
    "unmoved": (NAME_ARGUMENT,),
    "pose": (
        NAME_ARGUMENT,
        wkt_argument("a place", "POINT"),
        decimal_argument("an angle in degrees", -36000, 36000),
        decimal_argument("a tolerance in squares", 0, MAX_TABLE_SIDE),
    ),
    "within": (integer_argument("a number of steps", 0, 1_000_000),),
    "verdict": (word_argument("verdict", VERDICT_WORDS),),
    "fails": (),
}
# The predicates of expect.lp.
EXPECTATION_VOCABULARY: Vocabulary = {
    **EXPECTATIONS,
    "weight": (fact_argument("what is weighed", EXPECTATIONS), integer_argument("a weight", 0, MAX_WEIGHT_POINTS)),
}


class ClaimWord(NamedTuple):
    """A property or relation that start.lp may claim of what the task speaks of."""

    arguments: tuple[ArgumentType, ...]
    parameters: tuple[tuple[str, ...] | None, ...]  # the kinds of parameters each argument takes; None for no parameter
    one: bool = True  # whether a thing has one value of it at most


_OBJECT, _DOOR, _ROOM = ("object",), ("door",), ("room",)
# The claims of start.lp: how things, doors and rooms are said to be at first.
CLAIM_WORDS: Mapping[str, ClaimWord] = {
    "shape": ClaimWord((NAME_ARGUMENT, word_argument("shape", SHAPE_CLASSES)), (_OBJECT, None)),
    "colour": ClaimWord((NAME_ARGUMENT, COLOUR_ARGUMENT), (_OBJECT, None)),
    "size": ClaimWord((NAME_ARGUMENT, integer_argument("a size in squares", 1, MAX_SIZE)), (_OBJECT, None)),
    "in": ClaimWord(GOAL_WORDS["in"].arguments, (_OBJECT, _ROOM), one=False),
    "at": ClaimWord((NAME_ARGUMENT, CORNER_ARGUMENT), (_OBJECT, ("corner(northeast)",)), one=False),
    "beside": ClaimWord((NAME_ARGUMENT, NAME_ARGUMENT), (_OBJECT, _OBJECT), one=False),
    "against": ClaimWord((NAME_ARGUMENT,), (_OBJECT,), one=False),
    "width": ClaimWord((NAME_ARGUMENT, decimal_argument("a width in squares", 0, MAX_TABLE_SIDE)), (_DOOR, None)),
    "connects": ClaimWord((NAME_ARGUMENT,) * 3, (_DOOR, _ROOM, _ROOM), one=False),
}
CLAIMS: Vocabulary = {name: word.arguments for name, word in CLAIM_WORDS.items()}
# The predicates of start.lp.
START_VOCABULARY: Vocabulary = {
    "object": (NAME_ARGUMENT,),
    "door": (NAME_ARGUMENT,),
    "room": (NAME_ARGUMENT,),
    **CLAIMS,
    "confidence": (fact_argument("what is claimed", CLAIMS), integer_argument("a confidence", 0, 100)),
}
# The conditions that goals state.
GOAL_CONDITIONS: Vocabulary = {name: word.arguments for name, word in GOAL_WORDS.items()}
MAX_WISH_COMMANDS = 1_000_000  # commands that a wish may cost; a convention
# The predicates of goal.lp.
GOAL_VOCABULARY: Vocabulary = {
    **GOAL_CONDITIONS,
    "first": (fact_argument("a goal", GOAL_CONDITIONS),),
    "then": (fact_argument("a goal", GOAL_CONDITIONS),),
    "prefer": (
        fact_argument("a goal", GOAL_CONDITIONS),
        integer_argument("a number of commands", 0, MAX_WISH_COMMANDS),
    ),
}
# By the name of a file of a scenario: the names of its predicates.
PREDICATES_BY_FILE: Mapping[str, Collection[str]] = {
    "world.lp": WORLD_VOCABULARY.keys(),
    "start.lp": START_VOCABULARY.keys(),
    "goal.lp": GOAL_VOCABULARY.keys(),
    "expect.lp": EXPECTATION_VOCABULARY.keys(),
    "trial.lp": ("seed", "noise", "paths", "max_steps", "no_pull", "rules", "asks", "weight"),
}


def hint_for(name: str, known: Collection[Signature]) -> str:
    """Return the hint what may be meant by a predicate that is not known here; "" for nothing."""
    # It has another number of arguments, belongs in another file of a scenario, or is misspelt.
    forms = sorted(f"{other}/{arity}" for other, arity in known if other == name)
    if forms:
        return f"there is {', '.join(forms)}"
    names = {other for other, _ in known}
    files = [file for file, here in PREDICATES_BY_FILE.items() if name in here and not names <= set(here)]
    return f"{name} belongs in {' or '.join(files)}" if files else did_you_mean(name, names)


class Openness(StrEnum):
    """The extent to which a predicate may hold beyond what is believed."""

    NEVER = "never"
    """All facts of this predicate are known."""
    UNSEEN = "unseen"
    """It may hold for things not seen yet, as long as a part of the table is unseen."""
    UNTOLD = "untold"
    """As UNSEEN; and it may hold for known things of which no fact of this predicate is believed."""
    UNBOUND = "unbound"
    """It may hold for the parameters of the task of which no fact of this predicate is believed, and for no others."""


class BeliefPredicate(NamedTuple):
    """A predicate of the world model."""

    arguments: tuple[ArgumentType, ...]  # the types of its arguments
    open: Openness  # the extent to which it may hold beyond what is believed
    subject: int = 0  # the index, from 0, of the argument that the fact is about
    # Whether the last argument is a confidence in percent. A fact with a confidence between 0 and 100 may have any
    # other in truth.
    confident: bool = False
    # The names of the subjects of which the world model states all facts of this predicate that will ever hold
    settled: frozenset[str] = frozenset()
    short: bool = False  # whether it has a short form without the confidence, which holds where that is 100
    long: Signature | None = None  # of a short form: the predicate with the confidence
    symmetric: bool = False  # whether its first two arguments can be exchanged
    exclusive: bool = False  # whether a subject has one value of it, so that what is left of 100 percent is for others


# A node of the world model.
THING_ARGUMENT = pattern_argument(
    "thing", "org|floor|verge|o[0-9]+(_[0-9]+)?", "o1, its part o1_1, floor, verge, or org, which is Utak"
)
# An object of the world model.
OBJECT_ARGUMENT = pattern_argument("object", "o[0-9]+", "o1")
MEANT_ARGUMENT = pattern_argument("object, door or room", "[odr][0-9]+", "o1")
TASK_PARAMETER_ARGUMENT = ArgumentType("parameter of the task", NAME_ARGUMENT.check)  # a name that start.lp introduces
ROOM_ARGUMENT = pattern_argument("room", "r[0-9]+", "r1")  # a room of the world model
DOOR_ARGUMENT = pattern_argument("door", "d[0-9]+", "d1")  # a door of the world model
MAP_REGION_ARGUMENT = pattern_argument("region of the map", "part[0-9]+", "part1")  # a region that perception names
# A region of the map, or a part of an object, such as a leg of an L.
MAP_PART_ARGUMENT = pattern_argument("region or part", "part[0-9]+|o[0-9]+_[0-9]+", "part1 or o1_1")
# Where a thing may be that the task names: an object, a room, a door, or the verge.
WHEREABOUTS_ARGUMENT = pattern_argument("place of a thing", "[odr][0-9]+|verge", "r1")
STRETCH_ARGUMENT = pattern_argument("stretch of the bounds", "w[0-9]+", "w1")  # that was never felt
JUNCTION_ARGUMENT = pattern_argument("junction", "j[0-9]+|here|there", "j1")  # of the pathgraph, or an end of a walk
LINK_ARGUMENT = pattern_argument("link", "l[0-9]+(_[0-9]+)?", "l1")  # a link of the pathgraph, or a part of one
CONFIDENCE_ARGUMENT = integer_argument("a confidence", 0, 100)  # percent
LENGTH_ARGUMENT = integer_argument("a length in hundredths of squares", -(2**31), 2**31 - 1)  # Utak's frame
COUNT_ARGUMENT = integer_argument("a count", 0, 2**31 - 1)  # any 32-bit count
KIND_ARGUMENT = word_argument("kind", ("utak", "floor", "verge", "object"))  # the kinds of nodes
SEARCH_ENDS = ("proved", "found")  # whether the search for a plan ended with it, or at its bound on rounds
NEVER_OBJECTS = frozenset({"org", "floor", "verge"})  # nodes without a shape class, colour and movability
# A goal of the task plan, as a name: g1, g2, ... in the order of the task; users' rules may add others.
GOAL_NAME_ARGUMENT = ArgumentType("name of a goal", NAME_ARGUMENT.check)
# A goal of the task plan as the task states it.
TASK_GOAL_ARGUMENT = fact_argument("a goal of the task", GOAL_CONDITIONS)
# A place of the task plan: `here`, a place where a goal holds (g1_...), or a spot that the planner chose.
PLANNED_PLACE_ARGUMENT = ArgumentType("place of a plan", NAME_ARGUMENT.check)
# What a step of the task plan may settle: the name of a goal, or all, robot, plan.
PLAN_SUBJECT_ARGUMENT = ArgumentType("what a step settles", NAME_ARGUMENT.check)
# The steps of the task plan that settle what is open (planner/asp/task/settling.lp).
SETTLING_STEPS = {  # with what each does, in words; {} is what it settles
    "find": "what {} is about is looked for",
    "pursue": "the robot sees how {} can hold",
    "touch": "what may stand against a wall, or be a part of it, is touched, for {}",
    "recheck": "the passage that is too narrow is looked at again from close by, for {}",
    "measure": "the object is pushed by parts of a square to know its size, for {}",
    "probe": "the object is pushed where the passage may be wide enough, for {}",
    "gauge": "the robot walks against the sides of the passage to know its width, for {}",
    "pull": "a thing that may go on in a wall is drawn out of it, for {}",
    "make_way": "what blocks the robot's way is moved aside, for {}",
    "try": "things that may be several are felt all round, and pushed each way where they did not move, for {}",
    "feel": "walls are felt that may be things, for {}",
    "bare": "what stands before walls that were never felt is moved away, for {}",
}
# Those of the agenda besides (planner/asp/deciding/activities.lp), where no task plan can be made or none is left.
AGENDA_STEPS = {
    "confirm": "it is made sure that what seems to hold does",
    "recover": "what is held is put down, for the robot does not know where it is",
}
SETTLING_WORDS = {**SETTLING_STEPS, **AGENDA_STEPS}
# Those that are gone on with in later decisions, before anything else.
RESUMED_STEPS = ("make_way", "try", "feel", "measure", "gauge")
# The steps of the task plan (planner/asp/task).
STATED_STEPS: Vocabulary = {
    "carry": (OBJECT_ARGUMENT, PLANNED_PLACE_ARGUMENT),
    "clear": (OBJECT_ARGUMENT, PLANNED_PLACE_ARGUMENT),
    "arrive": (PLANNED_PLACE_ARGUMENT,),
    **dict.fromkeys(SETTLING_WORDS, (PLAN_SUBJECT_ARGUMENT,)),
}
# The steps of the robot itself, of which each command is one (planner.steps), with each in words.
ANY_SIDE = "any"  # the side from which a thing is grasped where no direction surely names it yet
ROBOT_STEPS: Mapping[str, tuple[tuple[ArgumentType, ...], str]] = {
    "go": ((LENGTH_ARGUMENT, LENGTH_ARGUMENT), "the robot goes to POINT ({} {})"),
    "look": ((LENGTH_ARGUMENT, LENGTH_ARGUMENT), "it looks from POINT ({} {})"),
    "feel": ((LENGTH_ARGUMENT, LENGTH_ARGUMENT), "it feels what is beside POINT ({} {})"),
    "grasp": ((OBJECT_ARGUMENT, word_argument("direction", (*DIRECTIONS, ANY_SIDE))), "{} is grasped, to the {}"),
    "push": ((OBJECT_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT), "{} is pushed by ({} {})"),
    "press": ((OBJECT_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT), "{} is pressed against a wall, by ({} {})"),
    "turn": ((OBJECT_ARGUMENT, LENGTH_ARGUMENT), "{} is turned by {} degrees"),
    "release": ((OBJECT_ARGUMENT,), "{} is released"),
}
ROBOT_STEP_FORMS: Vocabulary = {name: types for name, (types, _) in ROBOT_STEPS.items()}
ROBOT_STEP_ARGUMENT = fact_argument("a step of the robot", ROBOT_STEP_FORMS)
PLAN_STEP_ARGUMENT = fact_argument("a step of a plan", STATED_STEPS)
# The circumstances on which a refutation rests.
CIRCUMSTANCES: Vocabulary = {
    "at": (NAME_ARGUMENT, PLANNED_PLACE_ARGUMENT),
    "stood": (NAME_ARGUMENT,),
    "shut": (DOOR_ARGUMENT,),
}
CIRCUMSTANCE_ARGUMENT = fact_argument("a circumstance", CIRCUMSTANCES)
# The predicates of the task plan (planner.tasking.task_plan); they are stated as long as there is a plan.
PLAN_PREDICATES: Mapping[tuple[str, int], BeliefPredicate] = {
    ("goal", 1): BeliefPredicate((GOAL_NAME_ARGUMENT,), Openness.NEVER),
    ("means", 2): BeliefPredicate((GOAL_NAME_ARGUMENT, TASK_GOAL_ARGUMENT), Openness.NEVER),
    ("unmet", 1): BeliefPredicate((GOAL_NAME_ARGUMENT,), Openness.NEVER),
    ("plan", 2): BeliefPredicate((COUNT_ARGUMENT, PLAN_STEP_ARGUMENT), Openness.NEVER),
    ("step", 2): BeliefPredicate((COUNT_ARGUMENT, ROBOT_STEP_ARGUMENT), Openness.NEVER),
    ("serves", 2): BeliefPredicate((COUNT_ARGUMENT, GOAL_NAME_ARGUMENT), Openness.NEVER),
    ("passes", 2): BeliefPredicate((COUNT_ARGUMENT, DOOR_ARGUMENT), Openness.NEVER),
    ("takes", 2): BeliefPredicate((COUNT_ARGUMENT, COUNT_ARGUMENT), Openness.NEVER),
    ("verified", 1): BeliefPredicate((COUNT_ARGUMENT,), Openness.NEVER),
    ("price", 3): BeliefPredicate(
        (COUNT_ARGUMENT, COUNT_ARGUMENT, word_argument("end of a search", SEARCH_ENDS)), Openness.NEVER
    ),
    ("refuted", 2): BeliefPredicate((PLAN_STEP_ARGUMENT, COUNT_ARGUMENT), Openness.NEVER),
    ("given", 2): BeliefPredicate((COUNT_ARGUMENT, CIRCUMSTANCE_ARGUMENT), Openness.NEVER),
}
STATEMENT_ARGUMENT = ArgumentType("fact without its confidence", lambda _: None)
TWO_POINTS = (LENGTH_ARGUMENT,) * 4  # (east, north) of one point, then of another


def _property(*value: ArgumentType) -> BeliefPredicate:
    """Return the predicate of a property of objects, with its value and its confidence."""
    return _uncertain(THING_ARGUMENT, *value, open=Openness.UNTOLD)._replace(settled=NEVER_OBJECTS)


def _uncertain(*types: ArgumentType, open: Openness = Openness.UNSEEN) -> BeliefPredicate:
    """Return a predicate with a confidence behind arguments of some types, and with a short form without it."""
    return BeliefPredicate((*types, CONFIDENCE_ARGUMENT), open, confident=True, short=True)


def _with_short_forms(declared: Mapping[Signature, BeliefPredicate]) -> Iterator[tuple[Signature, BeliefPredicate]]:
    """Yield predicates, and behind each its short form, if it has one."""
    for (name, arity), one in declared.items():
        yield (name, arity), one
        if one.short:
            kept = one._replace(arguments=one.arguments[:-1], confident=False, short=False, long=(name, arity))
            yield (name, arity - 1), kept


# The predicates of the world model (kb/asp/belief.lp), and object/1; by name and number of arguments.
_DECLARED: Mapping[Signature, BeliefPredicate] = {
    ("node", 1): BeliefPredicate((THING_ARGUMENT,), Openness.UNSEEN),
    ("object", 1): BeliefPredicate((THING_ARGUMENT,), Openness.UNSEEN),
    ("kind", 3): _uncertain(THING_ARGUMENT, KIND_ARGUMENT),
    ("child", 2): BeliefPredicate((THING_ARGUMENT, THING_ARGUMENT), Openness.UNSEEN, subject=1),
    ("offset", 3): BeliefPredicate((THING_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT), Openness.UNSEEN),
    ("held", 1): BeliefPredicate((THING_ARGUMENT,), Openness.NEVER),
    ("rect", 5): BeliefPredicate((THING_ARGUMENT, *TWO_POINTS), Openness.UNSEEN),
    ("segment", 7): BeliefPredicate(
        (THING_ARGUMENT, COUNT_ARGUMENT, *TWO_POINTS, CONFIDENCE_ARGUMENT), Openness.UNSEEN, confident=True
    ),
    ("shape", 3): _property(word_argument("shape", SHAPE_CLASSES)),
    ("colour", 3): _property(COLOUR_ARGUMENT),
    ("movable", 2): _property(),
    ("persists", 2): _uncertain(THING_ARGUMENT, open=Openness.NEVER),
    ("adjacent", 3): _uncertain(THING_ARGUMENT, THING_ARGUMENT)._replace(settled=frozenset({"org"}), symmetric=True),
    ("joined", 3): _uncertain(THING_ARGUMENT, THING_ARGUMENT)._replace(symmetric=True),
    ("loc", 3): _uncertain(LENGTH_ARGUMENT, LENGTH_ARGUMENT, open=Openness.NEVER),
    ("plug", 2): _uncertain(STRETCH_ARGUMENT, open=Openness.NEVER),
    ("stretch", 5): BeliefPredicate((STRETCH_ARGUMENT, *TWO_POINTS), Openness.NEVER),
    ("room", 1): BeliefPredicate((ROOM_ARGUMENT,), Openness.UNSEEN),
    ("door", 2): _uncertain(DOOR_ARGUMENT),
    ("connects", 4): _uncertain(DOOR_ARGUMENT, ROOM_ARGUMENT, ROOM_ARGUMENT),
    ("width", 2): BeliefPredicate((DOOR_ARGUMENT, LENGTH_ARGUMENT), Openness.UNSEEN),
    ("width", 3): BeliefPredicate((DOOR_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT), Openness.UNSEEN),
    ("threshold", 5): BeliefPredicate((DOOR_ARGUMENT, *TWO_POINTS), Openness.UNSEEN),
    ("in", 3): _uncertain(THING_ARGUMENT, ROOM_ARGUMENT)._replace(exclusive=True),
    ("corner", 4): _uncertain(
        word_argument("corner", CORNER_NAMES), LENGTH_ARGUMENT, LENGTH_ARGUMENT, open=Openness.NEVER
    ),
    ("region", 3): _uncertain(MAP_REGION_ARGUMENT, word_argument("state", ("zero", "nonzero"))),
    ("hidden", 3): _uncertain(MAP_REGION_ARGUMENT, MAP_REGION_ARGUMENT, open=Openness.NEVER),
    ("part_of", 2): BeliefPredicate((MAP_PART_ARGUMENT, THING_ARGUMENT), Openness.UNSEEN),
    ("unseen", 2): BeliefPredicate((ROOM_ARGUMENT, COUNT_ARGUMENT), Openness.NEVER),
    ("junction", 4): BeliefPredicate(
        (JUNCTION_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT), Openness.UNSEEN
    ),
    ("link", 5): BeliefPredicate(
        (LINK_ARGUMENT, JUNCTION_ARGUMENT, JUNCTION_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT), Openness.UNSEEN
    ),
    ("crosses", 2): BeliefPredicate((LINK_ARGUMENT, DOOR_ARGUMENT), Openness.UNSEEN),
    ("borders", 2): BeliefPredicate((LINK_ARGUMENT, THING_ARGUMENT), Openness.UNSEEN),
    ("parameter", 1): BeliefPredicate((TASK_PARAMETER_ARGUMENT,), Openness.NEVER),
    ("bound", 2): BeliefPredicate((TASK_PARAMETER_ARGUMENT, MEANT_ARGUMENT), Openness.UNBOUND),
    ("may_be", 3): _uncertain(TASK_PARAMETER_ARGUMENT, WHEREABOUTS_ARGUMENT, open=Openness.NEVER),
    ("chance", 2): BeliefPredicate((STATEMENT_ARGUMENT, CONFIDENCE_ARGUMENT), Openness.NEVER),
    ("open", 2): BeliefPredicate((STATEMENT_ARGUMENT, CONFIDENCE_ARGUMENT), Openness.NEVER),
    ("known", 1): BeliefPredicate((STATEMENT_ARGUMENT,), Openness.NEVER),
    ("possible", 1): BeliefPredicate((STATEMENT_ARGUMENT,), Openness.NEVER),
    **PLAN_PREDICATES,
}
BELIEF_PREDICATES: Mapping[Signature, BeliefPredicate] = dict(_with_short_forms(_DECLARED))


def may_be_otherwise(name: str, subject: object) -> bool:
    """Return whether the confidence of a fact about a subject is the chance that it holds."""
    # For outlines, regions, the floor and the verge it is the share of their squares that is settled.
    return name not in ("segment", "region") and not (name == "kind" and str(subject) in NEVER_OBJECTS)


def thing_positions(signature: Signature) -> frozenset[int]:
    """Return the indices, from 0, of the arguments of a predicate of the world model that name nodes of any kind."""
    declared = BELIEF_PREDICATES.get(signature)
    types = declared.arguments if declared is not None else ()
    return frozenset(at for at, type_ in enumerate(types) if type_ is THING_ARGUMENT)


def check_facts(source: Source, facts: Iterable[Fact], vocabulary: Vocabulary) -> list[Problem]:
    """Return what is wrong with facts against a vocabulary."""
    return [source.problem(*complaint) for fact in facts for complaint in _complaints(fact, vocabulary)]


def _complaints(fact: Fact, vocabulary: Vocabulary) -> list[Complaint]:
    """Return the complaints about one fact; [] when it is valid."""
    # One for an unknown predicate or a wrong number of arguments; else one for each argument that does not fit, in
    # order.
    types = vocabulary.get(fact.name)
    if types is None:
        hint = hint_for(fact.name, {(name, 0) for name in vocabulary}) or f"known here: {', '.join(sorted(vocabulary))}"
        return [Complaint(fact.span, f"unknown predicate {fact.name}/{len(fact.args)}", hint)]
    if len(types) != len(fact.args):
        form = f"{fact.name}({', '.join(type_.name for type_ in types)})" if types else fact.name
        what = f"{fact.name} takes {len(types)} argument{'s' * (len(types) != 1)}, not {len(fact.args)}"
        return [Complaint(fact.span, what, f"write {form}")]
    found = (type_.check(term) for type_, term in zip(types, fact.args, strict=True))
    return [complaint for complaint in found if complaint is not None]
