"""Completion: commands, predicates and names that can come next at the cursor."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from utak.kb.language.arguments import ArgumentType
from utak.kb.language.atoms import atom_parts
from utak.kb.language.vocabulary import (
    BELIEF_PREDICATES,
    CIRCUMSTANCES,
    CONSTRAINT_GOALS,
    CORNER_NAMES,
    GOAL_CONDITIONS,
    GOAL_VOCABULARY,
    SEARCH_ENDS,
    SHAPE_CLASSES,
    START_VOCABULARY,
    STATED_STEPS,
    Signature,
)
from utak.kb.reasoning.interfaces import USER_RULE_INTERFACES
from utak.simulator.repl.statements import FACT_COMMANDS, QUERY_SIGN, is_query

WORD = re.compile(r"[A-Za-z0-9_?-]*\Z")  # the word at the cursor
# The words of an argument type that has no others, by its name.
WORDS_OF_TYPE: Mapping[str, tuple[str, ...]] = {
    "shape": SHAPE_CLASSES,
    "corner": CORNER_NAMES,
    "kind": ("utak", "floor", "verge", "object"),
    "thing": ("utak", "floor", "verge"),
    "walker": ("utak",),
    "corner or name": ("corner(", "start", "utak"),
    "room or name": ("room(next)",),
    "a goal": tuple(f"{name}(" for name in GOAL_CONDITIONS if name not in CONSTRAINT_GOALS),
    "what is claimed": ("shape(", "colour("),
    "place": ("corner",),
    "a goal of the task": tuple(f"{name}(" for name in GOAL_CONDITIONS),
    "a step of a plan": tuple(f"{name}(" for name in STATED_STEPS),
    "a circumstance": tuple(f"{name}(" for name in CIRCUMSTANCES),
    "end of a search": SEARCH_ENDS,
}
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
        yield from (CompletionWord(name, "command") for name in commands)
        yield CompletionWord(QUERY_SIGN, "asks what is believed")
        yield from _predicates({name: () for name, _ in BELIEF_PREDICATES})
        return
    command = before.split(maxsplit=1)[0]
    atom = _open_atom(before)
    if atom is not None and not (is_query(before, commands) or command in FACT_COMMANDS):
        return
    if atom is not None:
        name, at = atom
        for slot in _slots(command, name, at):
            yield from (CompletionWord(one, slot.name) for one in _words(slot, facts, parameters))
        return
    if command == "help":
        yield from (CompletionWord(name, "command") for name in commands)
    elif command in WORD_COMMANDS:
        yield from (CompletionWord(name, "predicate") for name, _ in BELIEF_PREDICATES)
        yield from (CompletionWord(name, "in the facts") for name in _names(facts))
    elif command == "goal":
        yield from _predicates({**GOAL_VOCABULARY, **START_VOCABULARY})
    elif command in ("why", "whynot"):
        yield from (CompletionWord(one, "depth") for one in ("short", "mid", "long"))
        yield from (CompletionWord(one, "") for one in ("step.", "cell"))
        yield from _predicates({name: () for name, _ in BELIEF_PREDICATES})
    elif command in ("assume", "retract"):
        known = [name for interface in USER_RULE_INTERFACES.values() for name, _ in interface]
        yield from _predicates(dict.fromkeys([*(name for name, _ in BELIEF_PREDICATES), *known], ()))
    elif command == "since" or is_query(before, commands):
        yield from _predicates({name: () for name, _ in BELIEF_PREDICATES})
        yield CompletionWord("not", "what follows does not hold")


def _predicates(known: Mapping[str, object]) -> Iterable[CompletionWord]:
    """Yield predicates as candidates, each with its bracket."""
    yield from (CompletionWord(f"{name}(", "predicate") for name in known)


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
    goals = {**GOAL_VOCABULARY, **START_VOCABULARY}
    if command == "goal":
        yield from goals.get(name, ())[at : at + 1]
        if name in ("corner", "room"):
            yield from (slot for slot in (ArgumentType(name, _anything),) if at == 0)
        return
    known: list[tuple[Signature, tuple[ArgumentType, ...]]] = [
        (signature, declared.arguments) for signature, declared in BELIEF_PREDICATES.items()
    ]
    if command == "assume":
        known += [pair for interface in USER_RULE_INTERFACES.values() for pair in interface.items()]
    for (other, _), slots in known:
        if other == name:
            yield from slots[at : at + 1]


def _anything(term: object) -> None:
    """Return None: every term fits."""


def _words(slot: ArgumentType, facts: Sequence[str], parameters: Sequence[str]) -> Iterable[str]:
    """Yield the words that fit an argument: those of its type, and those that facts have in such arguments."""
    yield from WORDS_OF_TYPE.get(slot.name, ())
    if slot.name in ("name", "parameter of the task", "parameter", "corner or name", "room or name"):
        yield from parameters
    if slot.name == "name":
        yield "utak"
    if slot.name == "room":
        yield from ("next",) if not facts else ()
    for fact in facts:
        name, parts = atom_parts(fact)
        declared = BELIEF_PREDICATES.get((name, len(parts)))
        if declared is not None:
            for other, part in zip(declared.arguments, parts, strict=True):
                if other.limits is None and _alike(other.name, slot.name):
                    yield part


def _alike(one: str, other: str) -> bool:
    """Return whether names of one argument type fit another one."""
    things = {"thing", "object", "candidate"}
    return one == other or (one in things and other in things)


def _names(facts: Sequence[str]) -> set[str]:
    """Return all names in the arguments of facts."""
    return {name for fact in facts for name in re.findall(r"[a-z_]\w*", fact.partition("(")[2])}
