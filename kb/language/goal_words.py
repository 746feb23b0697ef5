"""The goal words: one row for each condition that goal.lp may state, from which all that lists them is made."""

from enum import Enum
from typing import NamedTuple

from utak.kb.language.arguments import (
    NAME_ARGUMENT,
    ArgumentType,
    Complaint,
    abbreviated,
    integer_argument,
    wkt_argument,
    word_argument,
)
from utak.kb.language.diagnostics import did_you_mean
from utak.kb.language.terms import Symbol, Term

ROBOT = "utak"  # the robot in tasks, in plans and in questions
CORNER_NAMES = ("northeast", "northwest", "southeast", "southwest")  # in Utak's frame (docs/files.md)
DEGREES_ARGUMENT = integer_argument("an angle in degrees", -36000, 36000)  # counter-clockwise positive


class Holds(Enum):
    """The time at which a goal holds."""

    AT_A_PLACE = "at a place"  # where its subject is at the end
    ALONG_A_TRACK = "along a track"  # once the robot went so
    ALL_THE_TIME = "all the time"  # a constraint


class GoalWord(NamedTuple):
    """A goal word."""

    arguments: tuple[ArgumentType, ...]
    parameters: tuple[tuple[str, ...] | None, ...]  # the kinds of parameters each argument takes; None for no parameter
    # The facts that decide it, by how they begin; {0} stands for the node or the corner that its first argument means,
    # {1} and {2} for those of the next ones
    facts: tuple[str, ...]
    holds: Holds = Holds.AT_A_PLACE
    by_door: bool = False  # whether it rests on a door of the room in which its subject was at first
    from_origin: bool = False  # whether its meaning depends on where its subject was at first
    touches: bool = False  # whether its two arguments touch where it holds, so that either of two things may be moved
    fixed: bool = False  # whether the task says where it holds, whatever is found
    out_of_sight: bool = False  # whether it holds where walls hide its subject from where that was at first


def _compound(name: str, argument: ArgumentType, otherwise: str) -> ArgumentType:
    """Return the type of a name or of `name(argument)`, such as corner(northeast)."""
    such = f"such as {name}({otherwise})"

    def check(term: Term) -> Complaint | None:
        """Return the complaint about a term, or None when it fits."""
        if not isinstance(term, Symbol) or not term.args:
            return NAME_ARGUMENT.check(term)
        if term.name != name:
            return Complaint(term.span, f"unknown place {abbreviated(term)}", did_you_mean(term.name, [name]) or such)
        if len(term.args) != 1:
            return Complaint(term.span, f"{name} takes 1 argument, not {len(term.args)}", such)
        return argument.check(term.args[0])

    return ArgumentType(f"{name} or name", check)


_MOVER, _THING, _DOOR = ("object", ROBOT), ("object",), ("door",)  # kinds of parameters
PLACE_FACTS = ("offset({0},", "rect({0},")  # the facts that say where a node is
_AT_FACTS = (*PLACE_FACTS, "rect({1},", "corner({1},")
_ROOMS = ("in({0},", "connects(", "width(")  # the facts that say in which room a node is, and how rooms hang together
CORNER_ARGUMENT = _compound("corner", word_argument("corner", CORNER_NAMES), "northeast")
_NEXT_ROOM = _compound("room", word_argument("room", ["next"]), "next")
_REGION = wkt_argument("a region", "POLYGON", "MULTIPOLYGON")
GOAL_WORDS = {
    "at": GoalWord((NAME_ARGUMENT, CORNER_ARGUMENT), (_MOVER, ("object", "start")), _AT_FACTS, touches=True),
    "in": GoalWord((NAME_ARGUMENT, _NEXT_ROOM), (_MOVER, ("room",)), _ROOMS, by_door=True, from_origin=True),
    "through": GoalWord((NAME_ARGUMENT, NAME_ARGUMENT), (_MOVER, _DOOR), _ROOMS, by_door=True, from_origin=True),
    "around": GoalWord(
        (NAME_ARGUMENT, word_argument("place", ["corner"])),
        (_MOVER, None),
        PLACE_FACTS,
        from_origin=True,
        out_of_sight=True,
    ),
    "circled": GoalWord(
        (word_argument("walker", [ROBOT]), NAME_ARGUMENT),
        (None, _THING),
        ("offset({0},", "rect({1},"),
        Holds.ALONG_A_TRACK,
    ),
    "beside": GoalWord((NAME_ARGUMENT,) * 2, (_MOVER, _THING), ("rect({0},", "rect({1},"), touches=True),
    "pose": GoalWord(
        (NAME_ARGUMENT, wkt_argument("a place", "POINT"), DEGREES_ARGUMENT),
        (_THING, None, None),
        PLACE_FACTS,
        fixed=True,
    ),
    "not_through": GoalWord((NAME_ARGUMENT, NAME_ARGUMENT), (_MOVER, _DOOR), _ROOMS, Holds.ALL_THE_TIME),
    "avoid": GoalWord((NAME_ARGUMENT, _REGION), (_MOVER, None), PLACE_FACTS, Holds.ALL_THE_TIME),
    "carry_nothing_through": GoalWord((NAME_ARGUMENT,), (_DOOR,), ("connects(", "width("), Holds.ALL_THE_TIME),
}
CONSTRAINT_GOALS = tuple(name for name, word in GOAL_WORDS.items() if word.holds is Holds.ALL_THE_TIME)
TRACK_GOALS = tuple(name for name, word in GOAL_WORDS.items() if word.holds is Holds.ALONG_A_TRACK)
WRAPPING_GOALS = ("first", "then", "prefer")  # words of goal.lp whose first argument is a goal
