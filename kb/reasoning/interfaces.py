"""The predicates of the encodings that users' rules may use, with the types of their arguments.

An argument type whose name is in `DEFINING_FACTS` accepts only what a given fact of that kind names. So rules cannot
invent a region, a neck or an object.
"""

from collections.abc import Mapping

from utak.kb.body import DIRECTIONS
from utak.kb.language.arguments import (
    COLOUR_ARGUMENT,
    NAME_ARGUMENT,
    ArgumentType,
    Forms,
    compound_argument,
    integer_argument,
    pattern_argument,
    word_argument,
)
from utak.kb.language.goal_words import CORNER_NAMES
from utak.kb.language.vocabulary import (
    BELIEF_PREDICATES,
    CONFIDENCE_ARGUMENT,
    JUNCTION_ARGUMENT,
    KIND_ARGUMENT,
    LENGTH_ARGUMENT,
    LINK_ARGUMENT,
    MAP_REGION_ARGUMENT,
    PLAN_PREDICATES,
    RESUMED_STEPS,
    ROBOT_STEP_ARGUMENT,
    ROBOT_STEP_FORMS,
    SETTLING_STEPS,
    SHAPE_CLASSES,
    TASK_PARAMETER_ARGUMENT,
    THING_ARGUMENT,
    WHEREABOUTS_ARGUMENT,
    Signature,
)

Interface = Mapping[Signature, tuple[ArgumentType, ...]]  # argument types by predicate

MAX_AMOUNT = 1_000_000  # the greatest count, price or length that users' rules may derive; a convention
AMOUNT_ARGUMENT = integer_argument("an amount", 0, MAX_AMOUNT)  # a count, a length or a price
THOUSANDTHS_ARGUMENT = integer_argument("thousandths", 0, 1000)
NUMBER_ARGUMENT = integer_argument("a number", 0, MAX_AMOUNT)  # the number of a thing
REGION_ARGUMENT, CANDIDATE_ARGUMENT, PARAMETER_ARGUMENT, PLACE_ARGUMENT, GOAL_ARGUMENT, OPEN_FACT_ARGUMENT = (
    NAME_ARGUMENT._replace(name=name) for name in ("region", "candidate", "parameter", "place", "goal", "open fact")
)
PLAN_ROOM_ARGUMENT, PLAN_DOOR_ARGUMENT, SUBJECT_ARGUMENT, ANSWER_ARGUMENT = (  # a subject: a goal, all, robot, ...
    NAME_ARGUMENT._replace(name=name) for name in ("room", "door", "subject", "answer")
)
OPEN_KIND_ARGUMENT = word_argument("kind of open fact", ("stated", "gone", "wall", "unseen", "passage", "parts"))
NECK_ARGUMENT, CONVEX_CORNER_ARGUMENT, REFUTATION_ARGUMENT, TIME_ARGUMENT = (
    NUMBER_ARGUMENT._replace(name=name) for name in ("neck", "convex corner", "refutation", "time")
)
NODE_ARGUMENT = pattern_argument("thing", "o[0-9]+", "o1")  # an object of the world model
SUBGOAL_KINDS = ("attain", "inspect", "explore", "pass", "settle", "feel")
PROPERTIES = ("shape", "colour", "size", "width", "in", "at", "against")  # what claims are about
# What reconciliation.lp says of a parameter and a node.
MATCHES = ["bound_before", "planned", "given_up", "denied", "as_well", "bind", "doubtful", "unmovable", "measurable"]
CLAIMED_RELATIONS = ("in", "beside", "joins")  # what claims relate two parameters by
CHANCES_OF = ("may_be", "joined", "hidden", "loc")  # what chances.lp states of three arguments
PLACE_CASE = word_argument("case", ("likely", "other", "open", "closed", "door", "verge"))  # where a thing may be
PROPERTY_ARGUMENT = word_argument("property", PROPERTIES)
SEEN_ARGUMENTS = (PROPERTY_ARGUMENT, NAME_ARGUMENT, CONFIDENCE_ARGUMENT)  # a property, its value, how likely
CLAIM_ARGUMENT = word_argument("claim", (*PROPERTIES, *CLAIMED_RELATIONS))
RELATION_ARGUMENT = word_argument("relation", CLAIMED_RELATIONS)
SHAPE_ARGUMENT = word_argument("shape", SHAPE_CLASSES)  # a shape class
MOVER_ARGUMENT = pattern_argument("thing or utak", "o[0-9]+|utak|start", "o1")  # a thing of the task plan, or the robot
# The steps of a task plan.
PLAN_STEPS: Forms = {
    **dict.fromkeys(("carry", "clear"), (NODE_ARGUMENT, PLACE_ARGUMENT)),
    "arrive": (PLACE_ARGUMENT,),
    "go": (PLAN_DOOR_ARGUMENT,),
    **dict.fromkeys(SETTLING_STEPS, (SUBJECT_ARGUMENT,)),
}
STEP_ARGUMENT = compound_argument("step", "steps", PLAN_STEPS)
# The facts of the world model that may hold or not, without their confidence.
STATED_FACTS: Forms = {
    name: declared.arguments[:-1] for (name, _), declared in BELIEF_PREDICATES.items() if declared.confident
}
FACT_ARGUMENT = compound_argument("fact", "facts", STATED_FACTS)
EXCLUSIVE_QUESTIONS: Forms = {  # whose answers exclude each other
    **dict.fromkeys(("kind", "shape", "room"), (THING_ARGUMENT,)),
    "place": (TASK_PARAMETER_ARGUMENT,),
    "passage": (MAP_REGION_ARGUMENT,),
    "loc": (),
}
QUESTION_ARGUMENT = compound_argument("question", "questions", EXCLUSIVE_QUESTIONS)
ACTS: Forms = dict.fromkeys(("feel", "look", "push"), (THING_ARGUMENT,))  # that decide whether such a fact holds
BEGUN_ARGUMENT = word_argument("begun activity", RESUMED_STEPS)
ACTIVITIES: Forms = {  # of the agenda, first those about nothing in particular
    **dict.fromkeys(("release", "keep", "agree", "errand", "settle", "go", "wish", "look", "suppose"), ()),
    **dict.fromkeys(("blame", "clash", "doubt", *SETTLING_STEPS), (SUBJECT_ARGUMENT,)),
    "resume": (BEGUN_ARGUMENT,),
}
ACTIVITY_ARGUMENT = compound_argument("activity", "activities", ACTIVITIES)
DOUBTS: Forms = {  # what steps rest on
    **dict.fromkeys(("kind", "outline", "extent", "way", "surroundings", "again"), (NODE_ARGUMENT,)),
    "bounds": (PARAMETER_ARGUMENT,),
    **dict.fromkeys(("frame", "differs"), ()),
}
DOUBT_ARGUMENT = compound_argument("doubt", "doubts", DOUBTS)
REFLEX_NAMES = ("draw_back", "let_go", "regrasp", "take_along", "fetch", "lead_out", "detour")
REFLEX_ARGUMENT = word_argument("reflex", REFLEX_NAMES)
# What may be done for a thing that a goal is about.
WAYS_TO_CARRY = ("carry", "carry_on", "carry_near", "carry_loosely")
ATTEMPTS = ("examine", "leave_open", "press", "believe", *WAYS_TO_CARRY, "settle_for", "probe", "search")
ATTEMPT_ARGUMENT = word_argument("attempt", ATTEMPTS)
CHOSEN = {
    "do": ACTIVITY_ARGUMENT,
    "choose": NUMBER_ARGUMENT,
    "sense": DOUBT_ARGUMENT,
    "react": REFLEX_ARGUMENT,
    "bring": ATTEMPT_ARGUMENT,
}
KEPT_CHOICES: Forms = {name: (argument,) for name, argument in CHOSEN.items()}  # made in one decision
# By the name of an argument type of compound terms: these terms.
COMPOUND_FORMS: Mapping[str, Forms] = {
    "step": PLAN_STEPS,
    ROBOT_STEP_ARGUMENT.name: ROBOT_STEP_FORMS,
    "activity": ACTIVITIES,
    "choice": KEPT_CHOICES,
    "fact": STATED_FACTS,
    "act": ACTS,
    "question": EXCLUSIVE_QUESTIONS,
    "doubt": DOUBTS,
}
RESULT_ARGUMENT = word_argument("result", ("idle", "done", "limit", "impossible", "possible_if", "settled"))
OUTCOME = {("came_to", 2): (ACTIVITY_ARGUMENT, RESULT_ARGUMENT), ("stuck", 2): (SUBJECT_ARGUMENT, RESULT_ARGUMENT)}
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
ROLE_ARGUMENT = word_argument("role", ("bounds", "wall", "thing"))  # that a region is taken for
WAY_ARGUMENT = word_argument("way", (*DIRECTIONS, "left", "right"))  # of a motion of a thing
CASE_ARGUMENT = word_argument(
    "case",
    ("bounding", "island", "own_colour", "isolated", "felt_verge", "felt_long", "undecided"),
)
WALL_ARGUMENTS = (  # of walls that are felt
    word_argument("kind of wall", ("thing", "niche", "rim", "thin", "unseen", "parting", "plain")),
    word_argument("width", ("doorway", "square")),
)
# By the name of an encoding: the predicates that users' rules may use there, with their argument types.
USER_RULE_INTERFACES: Mapping[str, Interface] = {
    "interpretation": {
        ("region", 3): (REGION_ARGUMENT, word_argument("state", ("zero", "nonzero")), CONFIDENCE_ARGUMENT),
        ("rim", 1): (REGION_ARGUMENT,),
        ("surrounds", 2): (REGION_ARGUMENT, REGION_ARGUMENT),
        ("extent", 2): (REGION_ARGUMENT, AMOUNT_ARGUMENT),
        ("mass", 2): (REGION_ARGUMENT, AMOUNT_ARGUMENT),
        ("touched", 2): (REGION_ARGUMENT, COLOUR_ARGUMENT),
        ("cut", 1): (REGION_ARGUMENT,),
        ("kind", 3): (REGION_ARGUMENT, KIND_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("counted_solid", 4): (CASE_ARGUMENT, AMOUNT_ARGUMENT, AMOUNT_ARGUMENT, AMOUNT_ARGUMENT),
        ("counted_object", 6): (CASE_ARGUMENT, *(AMOUNT_ARGUMENT,) * 5),
    },
    "shapes": {
        ("fit", 4): (NODE_ARGUMENT, SHAPE_ARGUMENT, AMOUNT_ARGUMENT, integer_argument("a rank", 1, len(SHAPE_CLASSES))),
        **dict.fromkeys([("open_squares", 2), ("full_squares", 2)], (NODE_ARGUMENT, AMOUNT_ARGUMENT)),
        ("shape", 3): (NODE_ARGUMENT, SHAPE_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("traced", 1): (NODE_ARGUMENT,),
        ("counted_first", 7): (AMOUNT_ARGUMENT,) * 7,
        **dict.fromkeys([("counted_other", 3), ("counted_none", 3)], (AMOUNT_ARGUMENT,) * 3),
    },
    "taken": {
        ("region", 3): (REGION_ARGUMENT, word_argument("state", ("zero", "nonzero")), CONFIDENCE_ARGUMENT),
        ("kind", 3): (REGION_ARGUMENT, KIND_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("extent", 2): (REGION_ARGUMENT, AMOUNT_ARGUMENT),
        ("touched", 2): (REGION_ARGUMENT, COLOUR_ARGUMENT),
        ("longest", 1): (AMOUNT_ARGUMENT,),
        ("taken", 2): (REGION_ARGUMENT, ROLE_ARGUMENT),
        ("not_taken", 2): (REGION_ARGUMENT, ROLE_ARGUMENT),
    },
    "movable": {
        ("kind", 3): (NODE_ARGUMENT, KIND_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("resisted", 3): (NODE_ARGUMENT, WAY_ARGUMENT, AMOUNT_ARGUMENT),
        **{(name, 1): (NODE_ARGUMENT,) for name in ("thing", "trusted", "felt_first", "moved")},
        **{(name, 2): (NODE_ARGUMENT, WAY_ARGUMENT) for name in ("room_on", "untried")},
        **{(name, 2): (NODE_ARGUMENT, AMOUNT_ARGUMENT) for name in ("length", "unmoved")},
        **{(name, 2): (NODE_ARGUMENT, CONFIDENCE_ARGUMENT) for name in ("tried", "movable")},
    },
    "persistence": {
        **{(name, 1): (NODE_ARGUMENT,) for name in ("thing", "watched", "looked_at_again")},
        **{(name, 1): (AMOUNT_ARGUMENT,) for name in ("removed", "checked", "since_change")},
        ("out_of_sight", 2): (NODE_ARGUMENT, AMOUNT_ARGUMENT),
        **{(name, 2): (NODE_ARGUMENT, CONFIDENCE_ARGUMENT) for name in ("by_count", "persists")},
    },
    "rooms": {
        ("neck", 5): (NECK_ARGUMENT, AMOUNT_ARGUMENT, AMOUNT_ARGUMENT, AMOUNT_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("door", 2): (NECK_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("opening", 1): (NECK_ARGUMENT,),
        ("no_door", 1): (NECK_ARGUMENT,),
    },
    "corners": {
        ("convex", 3): (CONVEX_CORNER_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT),
        ("furthest", 2): (word_argument("corner", CORNER_NAMES), CONVEX_CORNER_ARGUMENT),
        ("excluded", 2): (word_argument("corner", CORNER_NAMES), CONVEX_CORNER_ARGUMENT),
    },
    "chances": {
        ("unbound", 1): (TASK_PARAMETER_ARGUMENT,),
        ("place", 4): (TASK_PARAMETER_ARGUMENT, WHEREABOUTS_ARGUMENT, PLACE_CASE, AMOUNT_ARGUMENT),
        ("claimed", 3): (TASK_PARAMETER_ARGUMENT, NAME_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("next", 1): (WHEREABOUTS_ARGUMENT,),
        ("touch", 4): (THING_ARGUMENT, THING_ARGUMENT, word_argument("felt", ("same", "unfelt")), CONFIDENCE_ARGUMENT),
        ("whole", 1): (THING_ARGUMENT,),
        ("supports", 3): (TASK_PARAMETER_ARGUMENT, WHEREABOUTS_ARGUMENT, AMOUNT_ARGUMENT),
        ("between", 4): (MAP_REGION_ARGUMENT, NAME_ARGUMENT, NAME_ARGUMENT, AMOUNT_ARGUMENT),
        ("unfelt", 3): (NAME_ARGUMENT, word_argument("breadth", ("slim", "broad")), AMOUNT_ARGUMENT),
        ("stands", 4): (LENGTH_ARGUMENT, LENGTH_ARGUMENT, NAME_ARGUMENT, AMOUNT_ARGUMENT),
        **{one: BELIEF_PREDICATES[one].arguments for one in [(name, 3) for name in CHANCES_OF] + [("plug", 2)]},
    },
    "alternatives": {
        ("stated", 2): (FACT_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("weight", 2): (CONFIDENCE_ARGUMENT, AMOUNT_ARGUMENT),
        ("choice", 2): (QUESTION_ARGUMENT, FACT_ARGUMENT),
        ("rest", 2): (QUESTION_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("alone", 1): (FACT_ARGUMENT,),
        ("none", 1): (QUESTION_ARGUMENT,),
        ("true", 1): (FACT_ARGUMENT,),
        ("decides", 2): (compound_argument("act", "acts", ACTS), FACT_ARGUMENT),
    },
    "reconciliation": {
        **{(name, 1): (PARAMETER_ARGUMENT,) for name in ("wanted", "named", "carried", "kept", "hypothesised")},
        ("claim", 4): (PARAMETER_ARGUMENT, *SEEN_ARGUMENTS),
        ("described", 2): (PARAMETER_ARGUMENT, word_argument("kind", ("door", "room"))),
        ("related", 4): (RELATION_ARGUMENT, PARAMETER_ARGUMENT, PARAMETER_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("place", 3): (CANDIDATE_ARGUMENT, word_argument("kind", ("door", "room")), CONFIDENCE_ARGUMENT),
        ("holds", 3): (RELATION_ARGUMENT, CANDIDATE_ARGUMENT, CANDIDATE_ARGUMENT),
        ("measure", 5): (CANDIDATE_ARGUMENT, PROPERTY_ARGUMENT, *[LENGTH_ARGUMENT] * 2, CONFIDENCE_ARGUMENT),
        ("candidate", 2): (CANDIDATE_ARGUMENT, CONFIDENCE_ARGUMENT),
        **{(name, 4): (CANDIDATE_ARGUMENT, *SEEN_ARGUMENTS) for name in ("has", "seen")},
        ("settled", 2): (CANDIDATE_ARGUMENT, PROPERTY_ARGUMENT),
        ("distance", 2): (CANDIDATE_ARGUMENT, AMOUNT_ARGUMENT),
        **{(name, 1): (CANDIDATE_ARGUMENT,) for name in ("fixed", "moved")},
        ("may_have", 3): (CANDIDATE_ARGUMENT, PROPERTY_ARGUMENT, NAME_ARGUMENT),
        ("enough", 2): (PARAMETER_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("refused", 3): (NUMBER_ARGUMENT._replace(name="refusal"), PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT),
        ("contradicted", 3): (PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT, PROPERTY_ARGUMENT),
        ("near_miss", 3): (PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT, CLAIM_ARGUMENT),
        **{(name, 2): (PARAMETER_ARGUMENT, CANDIDATE_ARGUMENT) for name in MATCHES},
    },
    "task": {
        ("horizon", 1): (AMOUNT_ARGUMENT,),
        ("place", 2): (MOVER_ARGUMENT, PLACE_ARGUMENT),
        ("aside", 2): (NODE_ARGUMENT, PLACE_ARGUMENT),
        **{
            (name, 1): (GOAL_ARGUMENT,)
            for name in ("goal", "missing", "unclear", "waits", "infeasible", "narrow", "met", "unmet")
        },
        **{(name, 2): (GOAL_ARGUMENT, AMOUNT_ARGUMENT) for name in ("wish", "missed")},
        ("fulfils", 3): (MOVER_ARGUMENT, PLACE_ARGUMENT, GOAL_ARGUMENT),
        ("rank", 2): (MOVER_ARGUMENT, AMOUNT_ARGUMENT),
        ("estimate", 4): (MOVER_ARGUMENT, PLACE_ARGUMENT, PLACE_ARGUMENT, AMOUNT_ARGUMENT),
        ("hoped", 3): (MOVER_ARGUMENT, PLACE_ARGUMENT, PLACE_ARGUMENT),
        ("lies", 3): (MOVER_ARGUMENT, PLACE_ARGUMENT, PLAN_ROOM_ARGUMENT),
        ("connects", 3): (PLAN_DOOR_ARGUMENT, PLAN_ROOM_ARGUMENT, PLAN_ROOM_ARGUMENT),
        **{(name, 2): (PLAN_DOOR_ARGUMENT, AMOUNT_ARGUMENT) for name in ("width", "relief")},
        ("door", 2): (PLAN_DOOR_ARGUMENT, CONFIDENCE_ARGUMENT),
        **{(name, 2): (PARAMETER_ARGUMENT, NODE_ARGUMENT) for name in ("bound", "may_mean", "meant_before", "meaning")},
        ("about", 2): (GOAL_ARGUMENT, PARAMETER_ARGUMENT),
        ("order", 2): (PARAMETER_ARGUMENT, AMOUNT_ARGUMENT),
        ("not_meant", 2): (MOVER_ARGUMENT, GOAL_ARGUMENT),
        ("asked_for", 2): (MOVER_ARGUMENT, PLACE_ARGUMENT),
        ("size", 2): (NODE_ARGUMENT, AMOUNT_ARGUMENT),
        ("shape", 3): (NODE_ARGUMENT, SHAPE_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("colour", 3): (NODE_ARGUMENT, COLOUR_ARGUMENT, CONFIDENCE_ARGUMENT),
        ("overlap", 4): (MOVER_ARGUMENT, PLACE_ARGUMENT, MOVER_ARGUMENT, PLACE_ARGUMENT),
        ("within", 3): (MOVER_ARGUMENT, PLACE_ARGUMENT, PLACE_ARGUMENT),
        ("refuted", 4): (REFUTATION_ARGUMENT, MOVER_ARGUMENT, PLACE_ARGUMENT, PLACE_ARGUMENT),
        ("given", 3): (REFUTATION_ARGUMENT, MOVER_ARGUMENT, PLACE_ARGUMENT),
        ("stood", 2): (REFUTATION_ARGUMENT, MOVER_ARGUMENT),
        ("shut", 2): (REFUTATION_ARGUMENT, PLAN_DOOR_ARGUMENT),
        **{(name, 1): (TIME_ARGUMENT,) for name in ("time", "begins", "busy", "acts", "settling")},
        ("done", 2): (STEP_ARGUMENT, TIME_ARGUMENT),
        ("lay", 3): (MOVER_ARGUMENT, PLACE_ARGUMENT, TIME_ARGUMENT),
        **{(name, 0): () for name in ("any_way", "shaken", "untouched")},
        ("doors_lead", 2): (PLAN_ROOM_ARGUMENT, PLAN_ROOM_ARGUMENT),
        ("at", 3): (MOVER_ARGUMENT, PLACE_ARGUMENT, TIME_ARGUMENT),
        ("last", 2): (MOVER_ARGUMENT, TIME_ARGUMENT),
        ("occurs", 2): (STEP_ARGUMENT, TIME_ARGUMENT),
        ("brought", 4): (MOVER_ARGUMENT, PLACE_ARGUMENT, PLACE_ARGUMENT, TIME_ARGUMENT),
        **dict.fromkeys([("thing", 1), ("holds", 1)], (NODE_ARGUMENT,)),
        **OUTCOME,
        ("settles", 2): (STEP_ARGUMENT, SUBJECT_ARGUMENT),
        **{(name, 1): (SUBJECT_ARGUMENT,) for name in ("measurable", "unmeasured")},
        **{(name, 2): (STEP_ARGUMENT, AMOUNT_ARGUMENT) for name in ("default_price", "price")},
        ("left", 1): (STEP_ARGUMENT,),
        ("settled", 2): (SUBJECT_ARGUMENT, TIME_ARGUMENT),
        ("moved", 2): (MOVER_ARGUMENT, TIME_ARGUMENT),
        **{(name, 2): (PLAN_ROOM_ARGUMENT, TIME_ARGUMENT) for name in ("robot_in", "room_before", "needed", "reached")},
        ("otherwise", 2): (REFUTATION_ARGUMENT, TIME_ARGUMENT),
        **{(name, 1): (PLAN_DOOR_ARGUMENT,) for name in ("asked", "closed")},
    },
    "deciding": {
        ("stage_goal", 2): (GOAL_ARGUMENT, AMOUNT_ARGUMENT),
        **{(name, 1): (GOAL_ARGUMENT,) for name in ("missing", "unclear")},
        **{(name, 0): () for name in ("own_goals", "regions_forbidden", "stages_attained", "constraints_doubtful")},
        **{(name, 0): () for name in ("hand_unsure", "robot_lost", "unplanned", "map_contradicted")},
        **{(name, 0): () for name in ("stage_attained", "rules_close_all_doors", "begun", "untold")},
        ("begun", 1): (BEGUN_ARGUMENT,),
        ("undid", 2): (GOAL_ARGUMENT, GOAL_ARGUMENT),
        ("planned", 1): (STEP_ARGUMENT,),
        **OUTCOME,
        **{(name, 1): (argument,) for name, argument in CHOSEN.items()},
        ("kept", 1): (compound_argument("choice", "choices", KEPT_CHOICES),),
        ("open_fact", 3): (OPEN_FACT_ARGUMENT, OPEN_KIND_ARGUMENT, AMOUNT_ARGUMENT),
        **{(name, 1): (OPEN_FACT_ARGUMENT,) for name in ("plan_with", "suppose", "depends")},
        ("refutes", 1): (ANSWER_ARGUMENT,),
        ("left_out", 2): (ANSWER_ARGUMENT, OPEN_FACT_ARGUMENT),
        ("verdict", 1): (word_argument("verdict", ("done", "limit", "impossible", "possible_if")),),
        ("aim", 3): (NUMBER_ARGUMENT, word_argument("kind", SUBGOAL_KINDS), LENGTH_ARGUMENT),
        ("besides", 2): (NUMBER_ARGUMENT, LENGTH_ARGUMENT),
        ("chance", 2): (NUMBER_ARGUMENT, CONFIDENCE_ARGUMENT),
        **{(name, 1): (NUMBER_ARGUMENT,) for name in ("last", "walked", "in_vain")},
        ("goes_to", 2): (NUMBER_ARGUMENT, PLAN_ROOM_ARGUMENT),
        ("in_room", 2): (LINK_ARGUMENT, PLAN_ROOM_ARGUMENT),
        ("point", 3): (NUMBER_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT),
        ("beside", 2): (NUMBER_ARGUMENT, NODE_ARGUMENT),
        ("aim_price", 2): (NUMBER_ARGUMENT, AMOUNT_ARGUMENT),
        ("halt", 3): (NUMBER_ARGUMENT, LENGTH_ARGUMENT, AMOUNT_ARGUMENT),
        ("tells", 4): (NUMBER_ARGUMENT, *WALL_ARGUMENTS, AMOUNT_ARGUMENT),
        **{(name, 3): (*WALL_ARGUMENTS, THOUSANDTHS_ARGUMENT) for name in ("counted_wall", "supposed")},
        **{one: BELIEF_PREDICATES[one].arguments for one in (("link", 5), ("crosses", 2), ("borders", 2))},
        **{(name, 1): (JUNCTION_ARGUMENT,) for name in ("begins", "ends")},
        **{(name, 1): (LINK_ARGUMENT,) for name in ("on", "avoid_link")},
        **dict.fromkeys([("risk", 2), ("trodden", 2), ("link_price", 2)], (LINK_ARGUMENT, AMOUNT_ARGUMENT)),
        ("middle", 3): (LINK_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT),
        ("step", 3): (LINK_ARGUMENT, JUNCTION_ARGUMENT, JUNCTION_ARGUMENT),
        ("tight", 4): (NUMBER_ARGUMENT, LENGTH_ARGUMENT, LENGTH_ARGUMENT, AMOUNT_ARGUMENT),
        **{(way, 2): (NUMBER_ARGUMENT, it) for way, it in (("part", LINK_ARGUMENT), ("through", PLAN_DOOR_ARGUMENT))},
        ("not_through", 1): (PLAN_DOOR_ARGUMENT,),
        ("door_price", 2): (PLAN_DOOR_ARGUMENT, LENGTH_ARGUMENT),
        **dict.fromkeys([("offered", 2), ("step", 2)], (NUMBER_ARGUMENT, ROBOT_STEP_ARGUMENT)),
        ("in_hand", 2): (NODE_ARGUMENT, NUMBER_ARGUMENT),
        ("there", 3): (LENGTH_ARGUMENT, LENGTH_ARGUMENT, NUMBER_ARGUMENT),
        ("unsure", 2): (DOUBT_ARGUMENT, NUMBER_ARGUMENT),
        **{(name, 1): (DOUBT_ARGUMENT,) for name in ("telling", "needed", "claimed")},
        **{
            (name, 1): (NODE_ARGUMENT,)
            for names in (
                "due vague in_way bars goes_on turned_next drawable other_way misgrasped unmoving looks_away",
                "in_place end_known minds_doors shuts_in taken_before lets_go pushed_on stays circles",
                "to_bring formless pressed pressable attained tolerable origin_lost has_end near_end loose_end",
                "end_open going_to_see probes see_first pressing firm holds",
            )
            for name in names.split()
        },
        **{(name, 2): (NODE_ARGUMENT, AMOUNT_ARGUMENT) for name in ("commands", "resists", "contacts", "misses")},
        ("looked", 2): (DOUBT_ARGUMENT, AMOUNT_ARGUMENT),
        ("reflex", 2): (REFLEX_ARGUMENT, NODE_ARGUMENT),
        ("attempt", 2): (ATTEMPT_ARGUMENT, NODE_ARGUMENT),
        ("comes", 2): (ATTEMPT_ARGUMENT, AMOUNT_ARGUMENT),
        ("vain", 1): (word_argument("choice", (*REFLEX_NAMES, *ATTEMPTS)),),
    },
}
# Encodings that answer questions and decide nothing in a run.
ASKED_ENCODINGS = frozenset({"alternatives"})
NAMED_IN_TASK = frozenset({("shape", 3), ("colour", 3), ("width", 2), ("door", 2), ("bound", 2)})  # of the world model
RULED_IN_TASK = frozenset({("goal", 1), ("wish", 2), ("met", 1), ("moved", 2), ("settles", 2), ("price", 2)})
# By the name of an encoding: predicates that users' rules may read there, but not derive.
READ_ONLY_THERE: Mapping[str, frozenset[Signature]] = {
    "movable": frozenset({("moved", 1), ("kind", 3)}),
    "taken": frozenset({("kind", 3), ("extent", 2), ("touched", 2), ("longest", 1)}),
    "chances": frozenset(USER_RULE_INTERFACES["chances"]) - {("supports", 3)},
    "persistence": frozenset(USER_RULE_INTERFACES["persistence"])
    - {("persists", 2), ("watched", 1), ("looked_at_again", 1)},
    "task": NAMED_IN_TASK,
    "deciding": frozenset(USER_RULE_INTERFACES["deciding"])
    - {("aim_price", 2), ("avoid_link", 1), ("link_price", 2), ("supposed", 3), ("needed", 1), ("see_first", 1)},
}
# What chances.lp makes of a decision that was made: queries and possible worlds alone know it.
MADE_LAST = frozenset(
    {(name, arity) for name in CHANCES_OF for arity in (2, 3)} | {("plug", 1), ("plug", 2), ("stretch", 5)}
)
# By the name of an encoding: the predicates of the world model that rules may read there besides its own. Rules about
# nothing but the world model bind the task plan; elsewhere they would leave no answer.
WORLD_PREDICATES = frozenset(BELIEF_PREDICATES) - frozenset(PLAN_PREDICATES) - MADE_LAST
WORLD_FACTS_THERE: Mapping[str, frozenset[Signature]] = {
    name: known - frozenset(USER_RULE_INTERFACES[name])
    for name, known in {
        **dict.fromkeys(("movable", "persistence"), frozenset({("shape", 3), ("colour", 3)})),
        "shapes": frozenset({("colour", 3)}),  # all that is known of objects before their shapes are
        **dict.fromkeys(("reconciliation", "chances", "task", "deciding"), WORLD_PREDICATES),
    }.items()
}
# Predicates that state which things exist and how they are numbered. Users' rules may read, but not derive them.
READ_ONLY_PREDICATES: frozenset[Signature] = frozenset(
    {
        ("region", 3), ("stated", 2), ("weight", 2), ("choice", 2), ("rest", 2), ("alone", 1), ("neck", 5),
        ("convex", 3), ("wanted", 1), ("candidate", 2), ("seen", 4), ("fit", 4), ("cut", 1), ("length", 2),
        ("unmoved", 2), ("resisted", 3), ("room_on", 2), ("untried", 2), ("tried", 2), ("described", 2), ("place", 3),
        ("counted_solid", 4), ("counted_object", 6), ("counted_first", 7), ("counted_other", 3), ("counted_none", 3),
    }
    | (frozenset(USER_RULE_INTERFACES["task"]) - NAMED_IN_TASK - RULED_IN_TASK)  # which the planner alone states
)  # fmt: skip
