"""trial.lp: how `utak test` runs a scenario, and what it asks the robot at the end. The file may be left out.

seed(3). noise("0.05"). paths(grid). max_steps(60). no_pull.    the options of the run; those of a command line win
rules("rules.lp").                                              a file of rules in the same folder, as with --kb
asks("large(X)", rows(2)). asks("large(X)", row(o2)).           a question, and what its answer must be
weight(asks("large(X)", rows(2)), 3).                           the points of an answer
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from utak.kb.language.arguments import (
    ArgumentType,
    Complaint,
    abbreviated,
    decimal_argument,
    decimal_value,
    integer_argument,
    text_value,
    word_argument,
)
from utak.kb.language.diagnostics import BadInputError, Problem, did_you_mean
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import Source, read_source
from utak.kb.language.terms import Fact, Number, Symbol, Term, Text
from utak.kb.language.vocabulary import MAX_WEIGHT_POINTS, Vocabulary, check_facts, fact_argument
from utak.simulator.scenario.settings import MAX_NOISE, MAX_STEPS, PATH_CHOICES

TRIAL_FILE = "trial.lp"  # its name in a scenario folder (docs/testing.md)
PLAIN_ANSWERS = ("yes", "no", "dont_know")  # answers without rows
ANSWER_HINT = f"one of {', '.join(PLAIN_ANSWERS)}, rows(N) or row(VALUE, ...)"


class TrialPlan(NamedTuple):
    """The plan of a trial, as trial.lp states it."""

    options: Mapping[str, Any]  # fields of `Settings` by name, as far as the file states them, without `kb_files`
    rules: tuple[str, ...]  # the paths of the files of rules
    asks: Mapping[Fact, int]  # the facts asks(QUERY, ANSWER), each with its points, in the order of the file


def _check_answer(term: Term) -> Complaint | None:
    """Return the complaint about an expected answer; None when it is one."""
    if isinstance(term, Symbol) and not term.args and term.name in PLAIN_ANSWERS:
        return None
    if isinstance(term, Symbol) and term.name == "row" and term.args:
        return None
    if isinstance(term, Symbol) and term.name == "rows" and len(term.args) == 1:
        return integer_argument("a number of rows", 0, MAX_WEIGHT_POINTS).check(term.args[0])
    hint = did_you_mean(str(term), [*PLAIN_ANSWERS, "row", "rows"]) or ANSWER_HINT
    return Complaint(term.span, f"unknown answer {abbreviated(term)}", hint)


def _check_query(term: Term) -> Complaint | None:
    """Return the complaint about a term that is no quoted text; None when it is one with something in it."""
    if isinstance(term, Text) and term.value.strip():
        return None
    return Complaint(term.span, f"a query must be a quoted text, not {abbreviated(term)}", 'such as "object(X)"')


def _check_file_name(term: Term) -> Complaint | None:
    """Return the complaint about a term that names no file of rules in the scenario's folder; None when it does."""
    name = term.value if isinstance(term, Text) else ""
    if name.endswith(".lp") and Path(name).name == name and "\\" not in name:
        return None
    return Complaint(term.span, f"a file in this folder was expected, not {abbreviated(term)}", 'such as "rules.lp"')


# The questions of a trial.
TRIAL_QUESTIONS: Vocabulary = {
    "asks": (ArgumentType("a query", _check_query), ArgumentType("an answer", _check_answer))
}
# The predicates of trial.lp.
TRIAL_VOCABULARY: Vocabulary = {
    "seed": (integer_argument("a seed", 0, 2**31 - 1),),
    "noise": (decimal_argument("a noise", 0, MAX_NOISE),),
    "paths": (word_argument("path-finder", PATH_CHOICES),),
    "max_steps": (integer_argument("a number of steps", 0, MAX_STEPS),),
    "no_pull": (),
    "rules": (ArgumentType("a file of rules", _check_file_name),),
    **TRIAL_QUESTIONS,
    "weight": (fact_argument("what is weighed", TRIAL_QUESTIONS), integer_argument("a weight", 0, MAX_WEIGHT_POINTS)),
}
OPTION_PREDICATES = ("seed", "noise", "paths", "max_steps", "no_pull")  # each may be stated once


def read_trial_plan(path: Path | str) -> TrialPlan:
    """Return what trial.lp says, checked."""
    source = read_source(path)
    facts = parse_facts(source)
    problems = check_facts(source, facts, TRIAL_VOCABULARY) or list(_contradictions(source, facts))
    if problems:
        raise BadInputError(problems)
    weights = {fact.args[0]: int(decimal_value(fact.args[1])) for fact in facts if fact.name == "weight"}
    rules = tuple(str(Path(path).parent / text_value(fact.args[0])) for fact in facts if fact.name == "rules")
    asks = {fact: weights.get(fact, 1) for fact in facts if fact.name == "asks"}
    return TrialPlan(dict(_options(facts)), rules, asks)


def _contradictions(source: Source, facts: Sequence[Fact]) -> Iterator[Problem]:
    """Yield a problem for each option stated twice, each repeated fact, and each weight of what is not asked."""
    seen: dict[object, int] = {}
    asked = [fact for fact in facts if fact.name == "asks"]
    for fact in facts:
        key: object = fact.name if fact.name in OPTION_PREDICATES else fact
        if fact.name == "weight":
            key = ("weight", fact.args[0])
            if fact.args[0] not in asked:
                what = f"{abbreviated(fact.args[0])} is weighed, but not asked"
                yield source.problem(fact.args[0].span, what, "state it as a fact of its own, too")
        if key in seen:
            yield source.problem(fact.span, f"stated twice: {abbreviated(fact)}", f"the first is on line {seen[key]}")
        seen.setdefault(key, fact.span.line)


def _options(facts: Sequence[Fact]) -> Iterator[tuple[str, Any]]:
    """Yield the fields of `Settings` that the facts state: name and value."""
    for fact in facts:
        if fact.name in ("seed", "max_steps"):
            yield fact.name, int(decimal_value(fact.args[0]))
        elif fact.name == "noise":
            yield "noise", decimal_value(fact.args[0])
        elif fact.name == "paths":
            yield "paths", str(fact.args[0])
        elif fact.name == "no_pull":
            yield "pull", False


def query_of(asked: Fact) -> str:
    """Return the query of asks(QUERY, ANSWER)."""
    return text_value(asked.args[0])


def answers_as_wanted(asked: Fact, kind: str, rows: Sequence[Sequence[int | str]], more: bool) -> str:
    """Return '' when an answer is the one that asks(QUERY, ANSWER) wants, else the answer in words."""
    wanted = asked.args[1]
    assert isinstance(wanted, Symbol)
    if wanted.name == "rows":
        met = not more and len(rows) == int(decimal_value(wanted.args[0]))
    elif wanted.name == "row":
        met = [term.value if isinstance(term, Number) else str(term) for term in wanted.args] in map(list, rows)
    else:
        met = wanted.name == ("yes" if kind == "bindings" else kind.replace("don't know", "dont_know"))
    if met:
        return ""
    return f"the answer is {kind}" if kind != "bindings" else f"the answer has {_rows_in_words(rows, more)}"


def _rows_in_words(rows: Sequence[Sequence[int | str]], more: bool) -> str:
    """Return the number of rows of an answer, and the first of them, in words."""
    shown = "; ".join(", ".join(map(str, row)) for row in rows[:5])
    return f"{len(rows)} row{'s' * (len(rows) != 1)}{' or more' * more}: {shown}{' ...' * (len(rows) > 5)}"
