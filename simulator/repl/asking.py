"""Queries and their rows, a page at a time; `facts`, and `since` when a fact holds."""

import re
from collections.abc import Sequence
from itertools import groupby

from utak.kb.reasoning.assumptions import canonical_facts
from utak.kb.reasoning.query import MAX_ANSWER_ROWS, QueryAnswer
from utak.simulator.repl.dialogue import Dialogue
from utak.simulator.repl.printer import units_of

ROBOT_NAMES = frozenset({"utak", "org"})  # the robot in questions and in facts
MAX_ROWS_ASKED = 1_000_000  # rows of an answer that `;` can reach; a convention


class Pages:
    """The rest of an answer, of which a page was printed."""

    def __init__(self, query: str, answer: QueryAnswer) -> None:
        self._query, self._answer = query, answer
        self._shown = 0

    def print_next(self, dialogue: Dialogue) -> bool:
        """Print the next page. Return whether there is more."""
        rows = self._answer.rows
        if self._shown >= len(rows) and self._answer.more and len(rows) < MAX_ROWS_ASKED:
            self._answer = dialogue.ask(self._query, min(MAX_ROWS_ASKED, 4 * len(rows)))
            rows = self._answer.rows
        end = len(rows) if dialogue.printer.page_rows is None else self._shown + dialogue.printer.page_rows
        dialogue.printer.table(self._answer.variables, rows[self._shown : end])
        self._shown = min(end, len(rows))
        if self._shown < len(rows):
            units = units_of(self._answer.variables, self._answer.types)
            dialogue.printer.note(f"rows 1 to {self._shown} of {len(rows)}: type ; for more. {units}".rstrip())
            return True
        if self._answer.more:
            dialogue.printer.say(f"... and more than these {len(rows)} rows")
            return len(rows) < MAX_ROWS_ASKED
        dialogue.printer.note(units_of(self._answer.variables, self._answer.types) or f"{len(rows)} rows")
        return False


class FactPages:
    """The rest of a list of facts, of which a page was printed."""

    def __init__(self, facts: Sequence[str]) -> None:
        self._left, self._count = list(facts), len(facts)

    def print_next(self, dialogue: Dialogue) -> bool:
        """Print the next page. Return whether there is more."""
        rows = dialogue.printer.page_rows or self._count
        page, self._left = self._left[:rows], self._left[rows:]
        dialogue.printer.say("\n".join(page))
        if self._left:
            done = self._count - len(self._left)
            dialogue.printer.note(f"facts 1 to {done} of {self._count}: type ; for more, or a word: facts o1")
        return bool(self._left)


def ask(dialogue: Dialogue, rest: str) -> None:
    """Print the answer to a query: the first page of its rows, or yes, no, don't know."""
    answer = dialogue.ask(rest, MAX_ANSWER_ROWS)
    if answer.kind != "bindings":
        style = {"yes": "bold green", "no": "bold red"}.get(answer.kind, "bold yellow")
        dialogue.printer.strong(answer.kind, style)
        return
    pages = Pages(rest, answer)
    dialogue.rest = pages if pages.print_next(dialogue) else None


def more(dialogue: Dialogue, rest: str) -> None:
    """Print the next page of the last answer."""
    pages, dialogue.rest = dialogue.rest, None
    if pages is None:
        dialogue.printer.tell("there are no more rows")
    elif pages.print_next(dialogue):
        dialogue.rest = pages


def facts(dialogue: Dialogue, rest: str) -> None:
    """Print the facts at this step; with a word, only those that name it."""
    word = rest.removesuffix(".").strip()
    known = dialogue.known_facts()
    found = [fact for fact in known if not word or names_word(fact, word)]
    if not found:
        dialogue.printer.say("none")
        return
    lines = FactPages(found)
    dialogue.rest = lines if lines.print_next(dialogue) else None


def names_word(fact: str, word: str) -> bool:
    """Return whether a fact names a word; `utak` and `org` both name the robot.

    >>> names_word("in(org,r1).", "utak")
    True
    """
    words = set(re.findall(r"\w+", fact))
    return bool(words & ROBOT_NAMES) if word in ROBOT_NAMES else word in words


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
