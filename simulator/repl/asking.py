"""Queries and their rows, a page at a time; `facts`, and `since` when a fact holds."""

import re
from collections.abc import Iterator, Sequence
from itertools import groupby

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.vocabulary import BELIEF_PREDICATES
from utak.kb.reasoning.assumptions import canonical_facts
from utak.kb.reasoning.query import MAX_ANSWER_ROWS, QueryAnswer
from utak.simulator.repl.dialogue import Dialogue
from utak.simulator.repl.printer import units_of

ROBOT_NAMES = frozenset({"utak", "org"})  # the robot in questions and in facts
DEFAULT_WORLDS, MAX_WORLDS = 5, 1000  # possible worlds that `worlds` prints; conventions
MAX_ROWS_ASKED = 1_000_000  # rows of an answer that `;` can reach; a convention


def ask(dialogue: Dialogue, rest: str) -> None:
    """Print the answer to a query: the first page of its rows, or yes, no, don't know."""
    answer = dialogue.ask(rest, MAX_ANSWER_ROWS)
    if answer.kind == "bindings":
        _turn(dialogue, _row_pages(dialogue, rest, answer))
    else:
        dialogue.printer.styled(answer.kind, {"yes": "bold green", "no": "bold red"}.get(answer.kind, "bold yellow"))
        if answer.kind == "don't know" and (longer := _forms_with_confidence(rest)):
            dialogue.printer.note(f"{', '.join(longer)} also tell what is not known, with its confidence")


def _forms_with_confidence(query: str) -> list[str]:
    """Return the predicates with a confidence whose short forms a query names, such as door/2.

    >>> _forms_with_confidence("door(D), connects(D, r1, R, C), not held(D)")
    ['door/2']
    """
    found = re.findall(r"\b([a-z]\w*)\(((?:[^()]|\([^()]*\))*)\)", query)
    named = {(name, len(re.sub(r"\([^()]*\)", "", inner).split(","))) for name, inner in found}
    forms = (BELIEF_PREDICATES[one].long for one in sorted(named) if one in BELIEF_PREDICATES)
    return [f"{name}/{arity}" for name, arity in filter(None, forms)]


def facts(dialogue: Dialogue, rest: str) -> None:
    """Print the facts at this step; with a word, only those that name it."""
    word = rest.removesuffix(".").strip()
    found = [fact for fact in dialogue.known_facts() if not word or names_word(fact, word)]
    if found:
        _turn(dialogue, _fact_pages(dialogue, found))
    else:
        dialogue.printer.say("none")


def more(dialogue: Dialogue, rest: str) -> None:
    """Print the next page of the last answer."""
    pages, dialogue.rest = dialogue.rest, None
    if pages is None:
        dialogue.printer.tell("there are no more rows")
    else:
        _turn(dialogue, pages)


def _turn(dialogue: Dialogue, pages: Iterator[bool]) -> None:
    """Print the next page, and keep those that follow it."""
    dialogue.rest = pages if next(pages, False) else None


def _row_pages(dialogue: Dialogue, query: str, answer: QueryAnswer) -> Iterator[bool]:
    """Print the rows of an answer; yield after each page that others follow."""
    printer, shown = dialogue.printer, 0
    while True:
        if shown >= len(answer.rows):
            answer = dialogue.ask(query, min(MAX_ROWS_ASKED, 4 * len(answer.rows)))
        rows, units = answer.rows, units_of(answer.variables, answer.types)
        end = len(rows) if printer.page_rows is None else min(shown + printer.page_rows, len(rows))
        printer.table(answer.variables, rows[shown:end])
        shown = end
        if shown < len(rows):
            printer.note(f"rows 1 to {shown} of {len(rows)}: type ; for more. {units}".rstrip())
        elif answer.more:
            printer.say(f"... and more than these {len(rows)} rows")
        else:
            printer.note(units or f"{len(rows)} rows")
        if shown == len(rows) and not (answer.more and len(rows) < MAX_ROWS_ASKED):
            return
        yield True


def _fact_pages(dialogue: Dialogue, found: Sequence[str]) -> Iterator[bool]:
    """Print facts; yield after each page that others follow."""
    size = dialogue.printer.page_rows or len(found)
    for first in range(0, len(found), size):
        dialogue.printer.say("\n".join(found[first : first + size]))
        if first + size < len(found):
            dialogue.printer.note(f"facts 1 to {first + size} of {len(found)}: type ; for more, or a word: facts o1")
            yield True


def names_word(fact: str, word: str) -> bool:
    """Return whether a fact names a word; `utak` and `org` both name the robot.

    >>> names_word("in(org,r1).", "utak")
    True
    """
    words = set(re.findall(r"\w+", fact))
    return bool(words & ROBOT_NAMES) if word in ROBOT_NAMES else word in words


def worlds(dialogue: Dialogue, rest: str) -> None:
    """Print the likeliest possible worlds, and what would decide between them."""
    asked = rest.removesuffix(".").strip()
    if asked and not (asked.isascii() and asked.isdecimal() and 0 < int(asked[:9]) <= MAX_WORLDS):
        raise BadInputError.about("worlds", asked, f"this is no number from 1 to {MAX_WORLDS}", "such as worlds 3")
    dialogue.engine.use_rules(dialogue.story.rule_files)
    found = dialogue.engine.worlds(dialogue.known_facts(), int(asked or DEFAULT_WORLDS))
    if not found.open:
        dialogue.printer.say("one world: nothing that is believed may be otherwise")
        return
    first = set(found.worlds[0].facts)
    for number, world in enumerate(found.worlds):
        there = set(world.facts)
        changes = [*(f"not {fact}" for fact in sorted(first - there)), *sorted(there - first)]
        told = ", ".join(changes if number else world.facts) or "none of what is open holds"
        dialogue.printer.say(f"{_percent(world.chance, world.chance)}  {'but ' if number else ''}{told}")
    rows = [(fact, _percent(least, greatest), ", ".join(acts)) for fact, least, greatest, acts in found.open]
    dialogue.printer.table(("open", "chance", "what would decide it"), rows)


def _percent(least: float, greatest: float) -> str:
    """Return a chance in percent, or the two between which it lies.

    >>> _percent(0.305, 0.305), _percent(0, 1)
    ('30.5 %', '0.0 to 100.0 %')
    """
    low, high = f"{100 * least:.1f}", f"{100 * greatest:.1f}"
    return f"{low} %" if low == high else f"{low} to {high} %"


def since(dialogue: Dialogue, rest: str) -> None:
    """Print since which step a fact holds without interruption, and when it held before."""
    story, query = dialogue.story, " ".join(rest.strip().removesuffix(".").split())
    if not re.search(r"\b_|\b[A-Z]|\bnot\b|[=<>#]", query):  # one fact, to be read and located as facts are
        query = ", ".join(fact.removesuffix(".") for fact in canonical_facts(query, "since"))
    held = []
    here = story.at
    dialogue.engine.use_rules(story.rule_files)
    for step in range(here + 1):
        known = dialogue.known_facts() if step == here else story.facts_at(step)
        held.append(dialogue.engine.ask(known, query, 1).kind)
    dialogue.printer.say(told_since(["yes" if kind == "bindings" else kind for kind in held]))


def told_since(answers: list[str]) -> str:
    """Return the sentence about the steps at which something held, from the answer at each step.

    Examples
    --------
    >>> told_since(["no", "yes", "no", "yes", "yes"])
    'it holds since step 3; before at step 1'
    >>> told_since(["yes", "yes", "don't know"])
    "don't know; it held at steps 0 to 1"
    """
    stretches: list[tuple[int, int]] = []
    for is_yes, group in groupby(range(len(answers)), key=lambda step: answers[step] == "yes"):
        steps = list(group)
        if is_yes:
            stretches.append((steps[0], steps[-1]))
    now = answers[-1] == "yes"
    before = stretches[:-1] if now else stretches
    told = ", ".join(f"step {a}" if a == b else f"steps {a} to {b}" for a, b in before)
    if now:
        return f"it holds since step {stretches[-1][0]}" + (f"; before at {told}" if told else "")
    words = {"no": "it does not hold"}.get(answers[-1], answers[-1])
    return f"{words}; it held at {told}" if told else f"{words}, and it never held"
