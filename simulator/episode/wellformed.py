"""The check of episodes: whether every value in a line is as simulator.episode.record writes it (docs/files.md).

A check takes a value and the keys that lead to it, and yields complaints. The functions below return such checks.
"""

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any

from kb.body import DIRECTIONS
from kb.language.vocabulary import MAX_TABLE_SIDE
from simulator.scenario.settings import PATH_CHOICES

KeyPath = tuple[str, ...]  # the keys that lead to a value
LineComplaint = tuple[KeyPath, str]  # the place of a value, and what is wrong with it
ValueCheck = Callable[[Any, KeyPath], Iterator[LineComplaint]]  # yields the complaints about a value

MAX_TEXT_CHARACTERS = 100_000  # characters of a string; a convention
MAX_COMMAND_VALUE = 1e9  # squares or degrees in commands and motions, in absolute value; a convention
TABLE_MARGIN = 1.0  # squares beyond the table in which points may lie; a convention
FACT_PATTERN = re.compile(r"-?_*[a-z][A-Za-z0-9_']*(\([ -~]*\))?\.")  # a fact of `belief.facts`, by its form only


def number(low: float, high: float) -> ValueCheck:
    """Return the check for a number from `low` to `high`."""

    def check(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
        if isinstance(value, bool) or not isinstance(value, int | float):
            yield at, "a number is wanted"
        elif not low <= value <= high:  # false for NaN and infinity, too
            yield at, f"a number from {low:g} to {high:g} is wanted"

    return check


def whole_number(low: int, high: int) -> ValueCheck:
    """Return the check for an integer from `low` to `high`."""

    def check(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            yield at, f"a whole number from {low} to {high} is wanted"

    return check


def text(form: re.Pattern[str] | None = None, name: str = "a text") -> ValueCheck:
    """Return the check for a string; form : a pattern that must match all of it. name : what messages call it."""

    def check(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
        if not isinstance(value, str) or len(value) > MAX_TEXT_CHARACTERS or (form and not form.fullmatch(value)):
            yield at, f"{name} is wanted"

    return check


def one_of(*known: Any) -> ValueCheck:
    """Return the check for one of some values, of the same type."""

    def check(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
        if not any(type(value) is type(one) and value == one for one in known):
            yield at, f"one of {', '.join(map(str, known))} is wanted"

    return check


def or_null(inner: ValueCheck) -> ValueCheck:
    """Return the check for null, or what another check accepts."""

    def check(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
        if value is not None:
            yield from inner(value, at)

    return check


def list_of(inner: ValueCheck, least: int = 0, most: int = 10_000_000) -> ValueCheck:
    """Return the check for a list of `least` to `most` values that another check accepts."""

    def check(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
        if not isinstance(value, list) or not least <= len(value) <= most:
            yield at, f"a list of {least} values is wanted" if least == most else "a list of values is wanted"
            return
        for one in value:
            yield from inner(one, at)

    return check


def names_to(inner: ValueCheck) -> ValueCheck:
    """Return the check for an object with any keys, whose values another check accepts."""

    def check(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
        if not isinstance(value, dict):
            yield at, "an object is wanted"
            return
        for key, one in value.items():
            yield from inner(one, (*at, key))

    return check


def keys(checks: Mapping[str, ValueCheck], optional: Collection[str] = ()) -> ValueCheck:
    """Return the check for an object with these keys, each with its own check; further keys are accepted."""

    def check(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
        if not isinstance(value, dict):
            yield at, "an object is wanted"
            return
        for key, inner in checks.items():
            if key in value:
                yield from inner(value[key], (*at, key))
            elif key not in optional:
                yield at, f"the key {key} is missing"

    return check


def action(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    """Check a command: yield complaints about it."""
    yield from keys({"do": one_of(*ACTION_KEYS)})(value, at)
    if isinstance(value, dict) and value.get("do") in ACTION_KEYS:
        yield from keys(ACTION_KEYS[value["do"]])(value, at)


def motion(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    """Check a true motion: yield complaints about it."""
    turned = isinstance(value, dict) and "rotate" in value
    pair = list_of(number(-MAX_COMMAND_VALUE, MAX_COMMAND_VALUE), 2, 2)
    yield from keys(
        {"rotate": number(-MAX_COMMAND_VALUE, MAX_COMMAND_VALUE), "about": pair} if turned else {"translate": pair}
    )(value, at)


# The keys of a straight motion, in squares of Utak's frame.
STRAIGHT_KEYS = {
    "east": number(-MAX_COMMAND_VALUE, MAX_COMMAND_VALUE),
    "north": number(-MAX_COMMAND_VALUE, MAX_COMMAND_VALUE),
}
# The keys of a command besides `do`, by its kind.
ACTION_KEYS: dict[str, dict[str, ValueCheck]] = {
    "move": STRAIGHT_KEYS,
    "push": STRAIGHT_KEYS,
    "turn": {"degrees": number(-MAX_COMMAND_VALUE, MAX_COMMAND_VALUE)},
    "grasp": {"direction": one_of(*DIRECTIONS)},
    "release": {},
}
POINT_CHECK = list_of(number(-TABLE_MARGIN, MAX_TABLE_SIDE + TABLE_MARGIN), 2, 2)  # (x, y) in squares, table frame
RING_CHECK = list_of(POINT_CHECK, 3)  # a closed boundary
RINGS_CHECK = list_of(RING_CHECK, 1)  # the outer ring and the holes of a polygon
THING_CHECK = keys({"colour": text(), "rings": RINGS_CHECK})  # a thing in the header
# The options of a run.
OPTIONS_CHECK = keys(
    {
        "seed": whole_number(0, 2**63 - 1),
        "noise": number(0, 1),
        "paths": one_of(*PATH_CHOICES),
        "max_steps": whole_number(0, 1_000_000),
        "pull": one_of(True, False),
        "kb": list_of(text()),
    },
    optional=("pull",),
)
# The task of a run.
TASK_CHECK = keys(
    {
        "parameters": names_to(text()),
        "claims": list_of(lambda value, at: iter(())),
        "goals": list_of(text()),
        "expect": or_null(list_of(text())),
    }
)


def stages(value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    """Check the stages before a fork: yield complaints about them."""
    stage = keys({"until": whole_number(0, 1_000_000), "options": OPTIONS_CHECK, "task": TASK_CHECK})
    complaints = list(list_of(stage, 1)(value, at))
    yield from complaints
    if not complaints:
        ends = [one["until"] for one in value]
        if ends != sorted(ends):
            yield at, "stages in the order of their steps are wanted"


# The first line of an episode.
HEADER_CHECK = keys(
    {
        "options": OPTIONS_CHECK,
        "world": keys(
            {
                "table": list_of(whole_number(1, MAX_TABLE_SIDE), 2, 2),
                "heading": whole_number(0, 359),
                "verge": list_of(RINGS_CHECK),
                "fixed": names_to(THING_CHECK),
                "movable": names_to(THING_CHECK),
            }
        ),
        "task": TASK_CHECK,
        "forked": stages,
    },
    optional=("forked",),
)
# The line of a step.
STEP_CHECK = keys(
    {
        "action": or_null(action),
        "motion": or_null(motion),
        "utak": POINT_CHECK,
        "held": or_null(text()),
        "objects": names_to(RING_CHECK),
        "retina": list_of(whole_number(0, 7), 160, 160),
        "touch": list_of(or_null(text()), 8, 8),
        "belief": keys({"facts": list_of(text(FACT_PATTERN, "a fact"))}),
        "why": text(),
    }
)
# The last line of an episode.
RESULT_CHECK = keys(
    {
        "result": keys(
            {
                "believed": one_of(True, False),
                "achieved": or_null(one_of(True, False)),
                "verdict": one_of("done", "impossible", "possible_if", "limit"),
                "reason": text(),
                "steps": whole_number(0, 1_000_000),
            }
        )
    }
)


def column(row: str, where: KeyPath) -> int:
    """Return the column, from 1, of the last of some nested keys in a line; 1 for no keys."""
    at = 0
    for key in where:
        found = row.find(f'"{key}"', at)
        at = found if found >= 0 else at
    return at + 1
