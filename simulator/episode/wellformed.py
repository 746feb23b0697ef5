"""The forms of an episode's lines: every value that simulator.episode.record and the robot write (docs/files.md)."""

from kb.body import DIRECTIONS
from kb.language.vocabulary import MAX_TABLE_SIDE, VERDICT_WORDS
from simulator.episode.forms import (
    AnyOf,
    Anything,
    ByKind,
    Characters,
    Form,
    IfKey,
    KeyPath,
    Keys,
    ListOf,
    NamesTo,
    Noted,
    Numeric,
    OneOf,
    OrNull,
    Row,
    Whole,
)
from simulator.scenario.settings import PATH_CHOICES

EPISODE_VERSION = 1  # of the form of episodes; docs/files.md
MAX_COMMAND_VALUE = 1e9  # squares or degrees in commands and motions, in absolute value; a convention
TABLE_MARGIN = 1.0  # squares beyond the table in which points may lie; a convention
MAX_STEP_NUMBER = 1_000_000  # the greatest --max-steps
MAX_RUN_SECONDS = 1_000_000  # of a limit of time, as `utak run --seconds` takes; a convention
RETINA_FIELDS = 160  # fields of the retina (docs/files.md)
FACT_PATTERN = r"-?_*[a-z][A-Za-z0-9_']*(\([ -~]*\))?\."  # a fact of `belief.facts`, by its form only

TEXT = Characters()
FLAG = OneOf((True, False))
FACT = Characters(FACT_PATTERN, "a fact")
STEP_NUMBER = Whole(0, MAX_STEP_NUMBER)
COMMAND_NUMBER = Numeric(-MAX_COMMAND_VALUE, MAX_COMMAND_VALUE)
PAIR = ListOf(COMMAND_NUMBER, 2, 2)  # (x, y) or (east, north) in squares
# The keys of a straight motion, in squares of Utak's frame.
STRAIGHT = Keys({"east": COMMAND_NUMBER, "north": COMMAND_NUMBER})
ACTION = Noted(
    "a command, in Utak's frame",
    ByKind(
        "do",
        {
            "move": STRAIGHT,
            "push": STRAIGHT,
            "turn": Keys({"degrees": COMMAND_NUMBER}),
            "grasp": Keys({"direction": OneOf(tuple(DIRECTIONS))}),
            "release": Keys({}),
        },
    ),
)
MOTION = Noted(
    "what really happened, table frame",
    IfKey("rotate", Keys({"rotate": COMMAND_NUMBER, "about": PAIR}), Keys({"translate": PAIR})),
)
POINT = ListOf(Numeric(-TABLE_MARGIN, MAX_TABLE_SIDE + TABLE_MARGIN), 2, 2)  # (x, y) in squares, table frame
RING = ListOf(POINT, 3)  # a closed boundary
RINGS = Noted("the outer ring and the holes of a polygon, squares, table frame", ListOf(RING, 1))
THING = Keys({"colour": TEXT, "rings": RINGS})  # a thing in the header
OPTIONS = Keys(
    {
        "seed": Whole(0, 2**63 - 1),
        "noise": Numeric(0, 1),
        "paths": OneOf(tuple(PATH_CHOICES)),
        "max_steps": STEP_NUMBER,
        "pull": FLAG,
        "kb": Noted("the SHA-256 sum of every rule file", ListOf(TEXT)),
    },
    frozenset({"pull"}),
)
WORLD = Keys(
    {
        "table": Noted("width and height in squares", ListOf(Whole(1, MAX_TABLE_SIDE), 2, 2)),
        "heading": Noted("degrees from the table's north, counter-clockwise", Whole(0, 359)),
        "verge": ListOf(RINGS),
        "fixed": NamesTo(THING),
        "movable": NamesTo(THING),
    }
)
TASK = Keys(
    {
        "parameters": Noted("kinds by name", NamesTo(TEXT)),
        "claims": Noted("each a fact and a confidence in percent", ListOf(Anything())),
        "goals": ListOf(TEXT),
        "expect": Noted("the facts of expect.lp; null without it", OrNull(ListOf(TEXT))),
    }
)
# The part of a run before a fork: until which step, with which options and task.
RUN_STAGE = Keys({"until": STEP_NUMBER, "options": OPTIONS, "task": TASK})
# The first line of an episode.
HEADER = Keys(
    {
        "utak": OneOf(("episode",)),
        "version": OneOf((EPISODE_VERSION,)),
        "options": OPTIONS,
        "world": WORLD,
        "task": TASK,
        "changes": Noted("what was assumed, retracted or wanted at the prompt, by step", Anything()),
        "forked": Noted("the stages before, of a run that goes on otherwise, in order", ListOf(RUN_STAGE, 1)),
    },
    frozenset({"changes", "forked"}),
)
DIGITS = Characters(f"[0-7]{{{RETINA_FIELDS}}}", f"a text of {RETINA_FIELDS} digits from 0 to 7")
FIELD_NUMBER = Whole(0, RETINA_FIELDS - 1)
# A decision of an encoding: written in full, or as a reference to an earlier step.
SOLVED_FORM = AnyOf(
    (
        Row((TEXT, ListOf(TEXT), OrNull(ListOf(TEXT)), ListOf(Anything()))),
        Row((TEXT, ListOf(TEXT), OrNull(ListOf(TEXT)))),
        Row((TEXT, Row((STEP_NUMBER, Whole(0, MAX_STEP_NUMBER))))),
    ),
    "a decision, [encoding, facts, answer, about] or [encoding, [step, index]],",
)
# The keys of `belief`; all but `facts` may be missing.
BELIEF_FORMS: dict[str, Form] = {
    "facts": Noted("the world model as facts", ListOf(FACT)),
    "place": Noted("where Utak believes to be [east, north], squares, robot frame", PAIR),
    "lattice": Noted("degrees of the robot frame against the grid", Whole(-360, 360)),
    "origin": Noted("offset of the robot frame in its square [east, north], squares", PAIR),
    "pose": Noted("how the impression was explained", TEXT),
    "cells": Noted("fields by status", NamesTo(Whole(0, RETINA_FIELDS))),
    "bound": Noted("node of each parameter of the task", NamesTo(TEXT)),
    "status": Noted(
        "of each field: p predicted, e explained, n noise",
        Characters(f"[pen]{{{RETINA_FIELDS}}}", f"a text of {RETINA_FIELDS} letters p, e, n"),
    ),
    "least": Noted("the least gray level that the map allows each field", DIGITS),
    "most": Noted("the greatest gray level that the map allows each field", DIGITS),
    "explained": Noted("fields by the fact that explains them", NamesTo(ListOf(FIELD_NUMBER))),
    "seen_from": Noted("where the impressions were received, as believed now, squares, robot frame", ListOf(PAIR)),
    "map_from": Noted("the first impression on which the map rests", STEP_NUMBER),
    "solved": Noted("the decisions of encodings since the line before", ListOf(SOLVED_FORM)),
    "regions": Noted("region of each object node", NamesTo(TEXT)),
    "moved": Noted("nodes whose place is known from having been moved", ListOf(TEXT)),
    "necks": Noted("both ends of the line across each door, squares, robot frame", NamesTo(ListOf(PAIR, 2, 2))),
    "routes": Noted(
        "routes that were weighed for the next command, squares, robot frame",
        ListOf(Keys({"points": ListOf(PAIR), "chosen": FLAG})),
    ),
}
BELIEF_FORM = Keys(BELIEF_FORMS, frozenset(BELIEF_FORMS) - {"facts"})
# The line of a step.
STEP = Keys(
    {
        "step": STEP_NUMBER,
        "action": OrNull(ACTION),
        "motion": OrNull(MOTION),
        "utak": Noted("where Utak is, table frame", POINT),
        "held": Noted("the name of what Utak holds", OrNull(TEXT)),
        "objects": Noted("outlines of movable things by name, table frame", NamesTo(RING)),
        "retina": Noted("gray levels", ListOf(Whole(0, 7), RETINA_FIELDS, RETINA_FIELDS)),
        "touch": Noted("colours, clockwise from north", ListOf(OrNull(TEXT), 8, 8)),
        "belief": BELIEF_FORM,
        "why": Noted("why the command was given", TEXT),
    }
)
RESULT_FORMS: dict[str, Form] = {
    "believed": Noted("whether Utak believes that the task is done", FLAG),
    "achieved": Noted("whether it is by expect.lp; null without it", OrNull(FLAG)),
    "verdict": OneOf(VERDICT_WORDS),
    "reason": TEXT,
    "steps": STEP_NUMBER,
    "seconds": Noted("the limit of time that ended the run; there alone", Numeric(0, MAX_RUN_SECONDS)),
    "idle_rules": Noted("the users' rules that never applied, with file and line; where there are any", ListOf(TEXT)),
}
RESULT_OPTIONAL = frozenset({"seconds", "idle_rules"})
# The last line of an episode.
END = Keys({"result": Keys(RESULT_FORMS, RESULT_OPTIONAL)})


def column(row: str, where: KeyPath) -> int:
    """Return the column, from 1, of the last of some nested keys in a line; 1 for no keys."""
    at = 0
    for key in where:
        found = row.find(f'"{key}"', at)
        at = found if found >= 0 else at
    return at + 1
