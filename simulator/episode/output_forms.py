"""The forms of what commands print under `--json`, and all forms by the names that `utak schema` gives them."""

from kb.evidence.reason import ReasonKind
from kb.language.vocabulary import VERDICT_WORDS
from simulator.episode.forms import (
    AnyOf,
    Anything,
    Form,
    Keys,
    ListOf,
    NamesTo,
    NestedKeys,
    Noted,
    Numeric,
    OneOf,
    OrNull,
    Whole,
)
from simulator.episode.wellformed import (
    END,
    FLAG,
    HEADER,
    OPTIONS,
    RESULT_FORMS,
    RESULT_OPTIONAL,
    STEP,
    STEP_NUMBER,
    TEXT,
)

MAX_LENGTH = 1e12  # squares of a route; above every route on a table that can be read
MAX_COUNT = 2**53  # of what is counted; JSON readers keep whole numbers exactly up to it
OUTCOME_CODES = (0, 1, 65, 66, 70)  # exit codes of a scenario that was tested
# `utak run --json`.
RUN_OUTPUT = Keys(
    {**RESULT_FORMS, "unmet": Noted("the facts of expect.lp that the truth does not meet", ListOf(TEXT))},
    RESULT_OPTIONAL,
)
CELL = AnyOf((TEXT, Whole(-(2**31), 2**31 - 1)), "a text or a whole number of 32 bits")
# `utak query --json`.
QUERY_OUTPUT = Keys(
    {
        "step": STEP_NUMBER,
        "answer": OneOf(("bindings", "yes", "no", "don't know")),
        "variables": ListOf(TEXT),
        "rows": Noted("values of the variables: whole numbers, or terms as text", ListOf(ListOf(CELL))),
        "more": Noted("whether rows were left out", FLAG),
    }
)
# `utak plan --json`.
PLAN_OUTPUT = Keys(
    {
        "step": STEP_NUMBER,
        "plan": OrNull(
            Keys(
                {
                    "found": Noted("whether there is a plan; else goals and refuted say why not", FLAG),
                    "goals": ListOf(
                        Keys(
                            {
                                "name": TEXT,
                                "means": Noted("what the task states, as facts", ListOf(TEXT)),
                                "attained": Noted("whether the plan attains it", FLAG),
                            }
                        )
                    ),
                    "steps": Noted(
                        "the steps that are left, in order; 0 is the present one",
                        ListOf(
                            Keys(
                                {
                                    "number": Whole(0, 2**31 - 1),
                                    "step": TEXT,
                                    "words": TEXT,
                                    "serves": Noted("names of goals", ListOf(TEXT)),
                                    "doors": ListOf(TEXT),
                                    "commands": OrNull(Whole(0, 2**31 - 1)),
                                    "certainty": OneOf(("verified", "hoped", "not asked")),
                                }
                            )
                        ),
                    ),
                    "cost": Noted("commands of the whole plan, with steps that are done", OrNull(Whole(0, 2**31 - 1))),
                    "least": Noted("commands: a lower bound by the search's estimates", OrNull(Whole(0, 2**31 - 1))),
                    "gap": Noted("cost less lower bound", OrNull(Whole(-(2**31), 2**31 - 1))),
                    "proved": Noted("whether the search ended with it", FLAG),
                    "refuted": ListOf(Keys({"step": TEXT, "given": ListOf(TEXT), "words": TEXT})),
                }
            )
        ),
    }
)
# `utak routes --json`.
ROUTES_OUTPUT = Keys(
    {
        "routes": ListOf(
            Keys(
                {
                    "length": Numeric(0, MAX_LENGTH),
                    "clearance": Numeric(0, MAX_LENGTH),
                    "signature": ListOf(Whole(-MAX_COUNT, MAX_COUNT)),
                    "points": ListOf(ListOf(Numeric(-MAX_LENGTH, MAX_LENGTH), 2, 2), 1),
                }
            )
        )
    }
)
SCORE = Keys({"earned": Numeric(0, MAX_COUNT), "possible": Numeric(0, MAX_COUNT)})
# The options of a scenario that was tested.
TRIAL_OPTIONS = Keys({**OPTIONS.forms, "kb": Noted("the names of the files of rules", ListOf(TEXT))})
# One expectation of a scenario: `came` says what came instead, and is empty where it is met.
EXPECTATION = Keys({"expected": TEXT, "met": FLAG, "came": TEXT, "points": Whole(0, MAX_COUNT)})
# One scenario of `utak test --json`.
TRIAL = Keys(
    {
        "scenario": TEXT,
        "outcome": OneOf(("passed", "failed", "bad", "absent", "bug")),
        "exit_code": OneOf(OUTCOME_CODES),
        "error": TEXT,
        "verdict": OrNull(OneOf(VERDICT_WORDS)),
        "believed": OrNull(FLAG),
        "achieved": OrNull(FLAG),
        "steps": OrNull(STEP_NUMBER),
        "reason": OrNull(TEXT),
        "options": OrNull(TRIAL_OPTIONS),
        "faults": ListOf(TEXT),
        "points": OrNull(SCORE),
        "weighed": Noted("whether the scenario's author weighed its expectations", FLAG),
        "expectations": ListOf(EXPECTATION),
        "last_steps": ListOf(Keys({"step": STEP_NUMBER, "action": TEXT, "why": TEXT})),
        "command": Noted("the command that tries it again", TEXT),
        "seconds": Numeric(0, MAX_LENGTH),
    },
    frozenset({"seconds"}),
)
# `utak test --json`.
TEST_OUTPUT = Keys(
    {
        "scenarios": ListOf(TRIAL),
        "counts": NamesTo(Whole(0, MAX_COUNT)),
        "points": SCORE,
        "exit_code": OneOf(OUTCOME_CODES),
    }
)
# `utak explain --json`.
EXPLAIN_OUTPUT = NestedKeys(
    "explain",
    Keys(
        {
            "claim": Noted("a fact or an atom as text, or a statement in words", TEXT),
            "kind": OneOf(tuple(map(str, ReasonKind))),
            "because": Noted("why it holds, in words", TEXT),
            "source": Noted("where it comes from: a step, the task, or file and line of a rule", TEXT),
            "data": Noted("more about it, by name", NamesTo(Anything())),
            "cut": Noted("whether more levels follow, which are left out", FLAG),
        },
        frozenset({"because", "source", "data", "cut"}),
    ),
    "rests_on",
)
# How a run ended that was made again with changes.
CHANGED_END: dict[str, Form] = {
    "verdict": OrNull(OneOf(VERDICT_WORDS)),
    "steps": OrNull(STEP_NUMBER),
    "achieved": OrNull(FLAG),
    "reason": OrNull(TEXT),
    "refuted": Noted("why the changes make no run", OrNull(TEXT)),
}
CHANGES = Noted("each with `change`, which says what further keys it has", ListOf(Keys({"change": TEXT})))
# `utak explain --fix --json`.
FIX_OUTPUT = Keys(
    {
        "before": Noted(
            "the end of the run without changes; null when it was not made", OrNull(Keys(RESULT_FORMS, RESULT_OPTIONAL))
        ),
        "repeated": Noted("whether that is the recorded end", OrNull(FLAG)),
        "needless": Noted("whether the run works without changes", FLAG),
        "fixes": ListOf(
            Keys(
                {
                    "changes": CHANGES,
                    "words": TEXT,
                    **CHANGED_END,
                    "smallest": Noted("whether no part of the changes suffices", FLAG),
                    "least": Noted("whether less of each change does not suffice", FLAG),
                }
            )
        ),
        "failed": ListOf(Keys({"changes": CHANGES, **CHANGED_END})),
        "width_step": Numeric(0, MAX_LENGTH),
        "runs": Whole(0, MAX_COUNT),
        "commands": Whole(0, MAX_COUNT),
        "ended": Noted("what ended the search before everything was tried; empty for nothing", TEXT),
    }
)
# Counts of runs of a sweep.
SWEEP_COUNT = Keys(
    {
        "scenario": TEXT,
        "noise": OrNull(Numeric(0, 1)),
        "runs": Whole(0, MAX_COUNT),
        "done": Whole(0, MAX_COUNT),
        "false_claims": Whole(0, MAX_COUNT),
        "judged": Whole(0, MAX_COUNT),
        "passed": Whole(0, MAX_COUNT),
        "achieved": OrNull(Whole(0, MAX_COUNT)),
        "failed": NamesTo(Whole(0, MAX_COUNT)),
        "success_rate": OrNull(Numeric(0, 1)),
        "success_interval": OrNull(ListOf(Numeric(0, 1), 2, 2)),
        "verdicts": NamesTo(Whole(0, MAX_COUNT)),
        "steps_median": OrNull(Numeric(0, MAX_COUNT)),
        "steps_95_percentile": OrNull(Numeric(0, MAX_COUNT)),
    }
)
SWEPT_RUN: dict[str, Form] = {"scenario": TEXT, "noise": Numeric(0, 1), "seed": Whole(0, 2**63 - 1)}
# `utak sweep --json`.
SWEEP_OUTPUT = Keys(
    {
        "planned": Whole(0, MAX_COUNT),
        "groups": ListOf(SWEEP_COUNT),
        "all": SWEEP_COUNT,
        "false_claims": ListOf(Keys(SWEPT_RUN)),
        "failed": ListOf(Keys({**SWEPT_RUN, "how": TEXT, "reason": TEXT})),
    }
)
# A line of the results of `utak sweep -o`, but for the first one.
SWEEP_ROW = Keys(
    {
        **SWEPT_RUN,
        "result": OrNull(RUN_OUTPUT),
        "passed": OrNull(FLAG),
        "failed": OrNull(Keys({"how": TEXT, "reason": TEXT})),
    }
)
# All forms by the names that `utak schema` gives them.
NAMED_FORMS: dict[str, Form] = {
    "header": Noted("the first line of an episode", HEADER),
    "step": Noted("the line of a step of an episode", STEP),
    "end": Noted("the last line of an episode", END),
    "run": Noted("what `utak run --json` prints", RUN_OUTPUT),
    "query": Noted("what `utak query --json` prints", QUERY_OUTPUT),
    "plan": Noted("what `utak plan --json` prints", PLAN_OUTPUT),
    "routes": Noted("what `utak routes --json` prints", ROUTES_OUTPUT),
    "test": Noted("what `utak test --json` prints", TEST_OUTPUT),
    "explain": Noted("what `utak explain --json` prints", EXPLAIN_OUTPUT),
    "fix": Noted("what `utak explain --fix --json` prints", FIX_OUTPUT),
    "sweep": Noted("what `utak sweep --json` prints", SWEEP_OUTPUT),
    "sweep_row": Noted("a line of the results of a sweep, after the first", SWEEP_ROW),
}
EPISODE_LINES = ("header", "step", "end")  # the names of the lines of an episode
