"""Completion: commands, predicates and names that can come next at the cursor."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from utak.kb.language.arguments import ArgumentType, word_argument
from utak.kb.language.atoms import atom_parts
from utak.kb.language.goal_words import CONSTRAINT_GOALS, CORNER_NAMES
from utak.kb.language.vocabulary import (
    BELIEF_PREDICATES,
    GOAL_CONDITIONS,
    GOAL_VOCABULARY,
    START_VOCABULARY,
    Signature,
)
from utak.kb.reasoning.interfaces import USER_RULE_INTERFACES
from utak.simulator.repl.statements import FACT_COMMANDS, QUERY_SIGN, is_query

WORD = re.compile(r"[A-Za-z0-9_?-]*\Z")  # the word at the cursor
# The words that are offered for an argument type in place of its own, by its name.
WORDS_OF_TYPE: Mapping[str, tuple[str, ...]] = {
    "name": ("utak",),
    "thing": ("utak", "floor", "verge"),
    "corner or name": ("corner(", "start", "utak"),
    "room or name": ("room(next)",),
    "a goal": tuple(f"{name}(" for name in GOAL_CONDITIONS if name not in CONSTRAINT_GOALS),
}
THING_TYPES = {"thing", "object", "object, door or room", "candidate"}  # types of arguments whose names fit each other
BELIEF_NAMES = tuple(name for name, _ in BELIEF_PREDICATES)
GOAL_SLOTS = {**GOAL_VOCABULARY, **START_VOCABULARY}
PLACE_WORDS = {
    "corner": CORNER_NAMES,
    "room": ("next",),
}  # what may stand in a place of a goal, such as corner(northeast)
NAME = re.compile(r"[a-z_]\w*")
WORD_COMMANDS = ("facts", "diff")  # commands that take a word of the facts


class CompletionWord(NamedTuple):
    """A word that can come next."""

    text: str  # the word; a predicate ends in its bracket
    meaning: str  # what it is, in a few words


def completions(
    text: str, commands: Sequence[str], facts: Iterable[str] = (), parameters: Sequence[str] = ()
) -> tuple[str, list[CompletionWord]]:
    """Return the word at the end of a text, and the candidates that complete it, sorted."""
    found = WORD.search(text)
    word = found[0] if found is not None else ""
    before = text[: len(text) - len(word)]
    candidates = _candidates(before, commands, list(facts), parameters)
    fitting = {one.text: one for one in candidates if one.text.startswith(word) and one.text != word}
    return word, [fitting[key] for key in sorted(fitting)]


def _candidates(
    before: str, commands: Sequence[str], facts: Sequence[str], parameters: Sequence[str]
) -> Iterable[CompletionWord]:
    """Yield what can stand behind a text."""
    if not before.strip():
        yield from _all(commands, "command")
        yield CompletionWord(QUERY_SIGN, "asks what is believed")
        yield from _predicates(BELIEF_NAMES)
        return
    command = before.split(maxsplit=1)[0]
    asks = is_query(before, commands)
    if (atom := _open_atom(before)) is not None:
        for slot in _slots(command, *atom) if asks or command in FACT_COMMANDS else ():
            yield from _all(_words(slot, facts, parameters), slot.name)
    elif command == "help":
        yield from _all(commands, "command")
    elif command in WORD_COMMANDS:
        yield from _all(BELIEF_NAMES, "predicate")
        yield from _all({name for fact in facts for name in NAME.findall(fact.partition("(")[2])}, "in the facts")
    elif command == "goal":
        yield from _predicates(GOAL_SLOTS)
    elif command in ("why", "whynot"):
        yield from _all(("short", "mid", "long"), "depth")
        yield from _all(("step.", "cell"), "")
        yield from _predicates(BELIEF_NAMES)
    elif command in ("assume", "retract"):
        known = [name for interface in USER_RULE_INTERFACES.values() for name, _ in interface]
        yield from _predicates([*BELIEF_NAMES, *known])
    elif command == "since" or asks:
        yield from _predicates(BELIEF_NAMES)
        yield CompletionWord("not", "what follows does not hold")


def _all(words: Iterable[str], meaning: str) -> Iterable[CompletionWord]:
    """Return words as candidates of one meaning."""
    return (CompletionWord(word, meaning) for word in words)


def _predicates(names: Iterable[str]) -> Iterable[CompletionWord]:
    """Return predicates as candidates, each with its bracket."""
    return _all((f"{name}(" for name in names), "predicate")


def _open_atom(before: str) -> tuple[str, int] | None:
    """Return the name of the atom whose bracket is open at the end of a text, and the index of its argument."""
    depth, commas = 0, 0
    for at in range(len(before) - 1, -1, -1):
        char = before[at]
        if char == ")":
            depth += 1
        elif char == "(" and depth > 0:
            depth -= 1
        elif char == "(":
            name = re.search(r"[a-z_]\w*\s*\Z", before[:at])
            return (name[0].strip(), commas) if name is not None else None
        elif char == "," and depth == 0:
            commas += 1
        elif char == "." and depth == 0 and before[at - 1 : at] != ".":
            return None
    return None


def _slots(command: str, name: str, at: int) -> Iterable[ArgumentType]:
    """Yield the types that the argument of a predicate can have."""
    if command == "goal":
        yield from GOAL_SLOTS.get(name, ())[at : at + 1]
        if name in PLACE_WORDS and at == 0:
            yield word_argument("place", PLACE_WORDS[name])
        return
    known: list[tuple[Signature, tuple[ArgumentType, ...]]] = [
        (signature, declared.arguments) for signature, declared in BELIEF_PREDICATES.items()
    ]
    if command == "assume":
        known += [pair for interface in USER_RULE_INTERFACES.values() for pair in interface.items()]
    for (other, _), slots in known:
        if other == name:
            yield from slots[at : at + 1]


def _words(slot: ArgumentType, facts: Sequence[str], parameters: Sequence[str]) -> Iterable[str]:
    """Yield the words that fit an argument: those of its type, and those that facts have in such arguments."""
    yield from WORDS_OF_TYPE.get(slot.name, slot.words)
    if slot.name in ("name", "parameter of the task", "parameter", "corner or name", "room or name"):
        yield from parameters
    for fact in facts:
        name, parts = atom_parts(fact)
        declared = BELIEF_PREDICATES.get((name, len(parts)))
        if declared is not None:
            for other, part in zip(declared.arguments, parts, strict=True):
                same = other.name == slot.name or {other.name, slot.name} <= THING_TYPES
                if other.limits is None and same:
                    yield part
