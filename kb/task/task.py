"""The task: two parameterised world models, what is claimed at the start (start.lp) and what shall hold (goal.lp)."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kb.language.diagnostics import BadInputError, Problem, Span, did_you_mean
from kb.language.reader import parse_facts
from kb.language.source_text import Source, read_source
from kb.language.terms import Fact, Number, Symbol, Term
from kb.language.vocabulary import GOAL, RESERVED_PARAMETER_NAMES, START, Vocabulary, check_facts

CERTAIN = 100
KINDS = ("object", "door", "room")
# The shapes that one thing can have at once: a square and a brick are rectangles, and everything is a polygon.
ALSO = {"rectangle": {"square", "brick"}}
# Which kinds of parameters a goal wants, argument by argument; None stands for an argument that names no parameter.
WANTED: Mapping[str, tuple[tuple[str, ...] | None, ...]] = {
    "at": (("object", "utak"), ("object", "start")),
    "in": (("object", "utak"), ("room",)),
    "through": (("object", "utak"), ("door",)),
    "around": (("object", "utak"), None),
    "circled": (None, ("object",)),
    "beside": (("object", "utak"), ("object",)),
    "pose": (("object",), None, None),
    "not_through": (("object", "utak"), ("door",)),
}


@dataclass(frozen=True)
class Parameter:
    """A thing that the task speaks of: its name, and whether it is an object, a door or a room."""

    name: str
    kind: str
    span: Span = field(compare=False)


@dataclass(frozen=True)
class Claim:
    """What start.lp says of a parameter, such as `shape(x, square)`, and the confidence in it (0 to 100)."""

    fact: Fact
    confidence: int = CERTAIN


@dataclass(frozen=True)
class Task:
    """What Utak is told.

    Attributes
    ----------
    parameters : by name, in the order in which start.lp introduces them.
    claims : what is claimed of the parameters, in order.
    goals : what shall hold, in order; `first(G)` and `then(G)` are kept as they stand.
    """

    parameters: Mapping[str, Parameter]
    claims: tuple[Claim, ...]
    goals: tuple[Fact, ...]

    @property
    def named(self) -> frozenset[str]:
        """The parameters that the goals name."""
        words = {str(term) for goal in self.goals for term in _plain(goal).args}
        return frozenset(words & set(self.parameters))

    def claims_of(self, name: str) -> tuple[Claim, ...]:
        """Return what is claimed of one parameter."""
        return tuple(claim for claim in self.claims if claim.fact.args[0] == Symbol(name, (), Span(0, 0, 0)))


def read_task(start: Path | str, goal: Path | str) -> Task:
    """Read a task from its two files; raises CannotOpenError, or BadInputError with the problems of both."""
    problems: list[Problem] = []
    sources: list[Source | None] = []
    for path in (start, goal):
        try:
            sources.append(read_source(path))
        except BadInputError as bad:
            problems += bad.problems
            sources.append(None)
    begin, end = (_checked(s, v, problems) for s, v in zip(sources, (START, GOAL), strict=True))
    if problems or sources[0] is None or sources[1] is None:
        raise BadInputError(problems)
    return task_of(sources[0], begin, sources[1], end)


def read_start(path: Path | str) -> tuple[Fact, ...]:
    """Read start.lp alone and check it; raises as `read_task` does."""
    source = read_source(path)
    problems: list[Problem] = []
    begin = _checked(source, START, problems)
    if not problems:
        problems = _start_problems(source, begin)[2]
    if problems:
        raise BadInputError(problems)
    return begin


def task_of(start: Source, begin: tuple[Fact, ...], goal: Source, end: tuple[Fact, ...]) -> Task:
    """Return the task that checked facts of start.lp and goal.lp state; raises BadInputError."""
    parameters, claims, problems = _start_problems(start, begin)
    problems += _repeated(goal, end)
    problems += _goal_problems(goal, end, parameters)
    if problems:
        raise BadInputError(problems)
    return Task(parameters, tuple(claims), end)


def _start_problems(source: Source, begin: tuple[Fact, ...]) -> tuple[dict[str, Parameter], list[Claim], list[Problem]]:
    """What start.lp introduces and claims, and what is wrong with it."""
    problems = _repeated(source, begin)
    parameters = _parameters(source, begin, problems)
    claims = _claims(source, begin, parameters, problems)
    problems += _contradictions(source, claims)
    return parameters, claims, problems


def _checked(source: Source | None, vocabulary: Vocabulary, problems: list[Problem]) -> tuple[Fact, ...]:
    """The facts of a source; what is wrong with them is appended to `problems`."""
    if source is None:
        return ()
    try:
        facts = parse_facts(source)
    except BadInputError as bad:
        problems += bad.problems
        return ()
    problems += check_facts(source, facts, vocabulary)
    return facts


def _repeated(source: Source, facts: tuple[Fact, ...]) -> list[Problem]:
    """Facts that are stated twice; a step of a sequence may come again, for it is another step."""
    seen: dict[Fact, int] = {}
    problems = []
    for fact in facts:
        if fact.name == "then":
            continue
        if fact in seen:
            problems.append(source.problem(fact.span, f"stated twice: {fact}", f"first on line {seen[fact]}"))
        seen.setdefault(fact, fact.span.line)
    return problems


def _parameters(source: Source, facts: tuple[Fact, ...], problems: list[Problem]) -> dict[str, Parameter]:
    found: dict[str, Parameter] = {}
    for fact in facts:
        if fact.name not in KINDS:
            continue
        name, span = str(fact.args[0]), fact.args[0].span
        if name in RESERVED_PARAMETER_NAMES:
            problems.append(source.problem(span, f"{name} is a reserved word and cannot name a parameter"))
        elif name in found and found[name].kind != fact.name:
            what = f"{name} is already a{'n' * (found[name].kind == 'object')} {found[name].kind}"
            problems.append(source.problem(span, what, f"see line {found[name].span.line}"))
        else:
            found.setdefault(name, Parameter(name, fact.name, span))
    return found


def _claims(
    source: Source, facts: tuple[Fact, ...], parameters: Mapping[str, Parameter], problems: list[Problem]
) -> list[Claim]:
    claims: list[Claim] = []
    said: dict[Fact, int] = {}
    for fact in facts:
        if fact.name in KINDS:
            continue
        claim = _claim(fact)
        name = claim.fact.args[0]
        if str(name) not in parameters:
            problems.append(source.problem(name.span, *_unknown(str(name), parameters)))
        elif parameters[str(name)].kind != "object":
            what = f"{name} is a {parameters[str(name)].kind}; only objects have a {claim.fact.name}"
            problems.append(source.problem(name.span, what))
        if claim.fact in said and said[claim.fact] != claim.confidence:
            what = f"{claim.fact} is claimed with confidence {said[claim.fact]} and {claim.confidence}"
            problems.append(source.problem(fact.span, what))
        said[claim.fact] = claim.confidence
        claims.append(claim)
    return claims


def _claim(fact: Fact) -> Claim:
    if fact.name != "confidence":
        return Claim(fact)
    inner, degree = fact.args
    assert isinstance(inner, Symbol)
    assert isinstance(degree, Number)
    return Claim(inner, degree.value)


def _contradictions(source: Source, claims: list[Claim]) -> Iterator[Problem]:
    """Two certain claims of one thing that cannot both be."""
    certain: dict[tuple[str, Term], Fact] = {}
    for claim in claims:
        if claim.confidence < CERTAIN:
            continue
        key = (claim.fact.name, claim.fact.args[0])
        before = certain.setdefault(key, claim.fact)
        if not _compatible(claim.fact, before):
            what = f"{claim.fact} contradicts {before}"
            hint = f"see line {before.span.line}; say how sure it is: confidence({claim.fact}, 50)."
            yield source.problem(claim.fact.span, what, hint)


def _compatible(one: Fact, other: Fact) -> bool:
    first, second = str(one.args[1]), str(other.args[1])
    if first == second:
        return True
    if one.name != "shape":
        return False
    return "polygon" in (first, second) or first in ALSO.get(second, ()) or second in ALSO.get(first, ())


def _goal_problems(source: Source, goals: tuple[Fact, ...], parameters: Mapping[str, Parameter]) -> Iterator[Problem]:
    begun = False
    for fact in goals:
        goal = _plain(fact)
        if fact.name == "first" and begun:
            yield source.problem(fact.span, "first(...) must come before every other step", "write then(...)")
        if fact.name == "then" and not begun:
            yield source.problem(fact.span, "then(...) without anything before it", "begin with first(...)")
        if goal.name == "not_through" and fact.name in ("first", "then"):
            yield source.problem(goal.span, f"{fact.name}(...) needs something to attain, not a constraint")
        begun = begun or goal.name != "not_through"
        for term, kinds in zip(goal.args, WANTED[goal.name], strict=True):
            if kinds is not None and isinstance(term, Symbol) and not term.args:
                yield from _misused(source, goal, term, kinds, parameters)
        if len(goal.args) == 2 and goal.args[0] == goal.args[1]:
            yield source.problem(goal.span, f"{goal.name} relates {goal.args[0]} to itself")
    if not begun:
        yield source.problem(
            source.start(), "the goal is empty: nothing shall hold", "such as at(utak, corner(northeast))."
        )


def _plain(fact: Fact) -> Fact:
    """The goal inside first(...) and then(...)."""
    inner = fact.args[0] if fact.name in ("first", "then") else fact
    assert isinstance(inner, Symbol)
    return inner


def _misused(
    source: Source, goal: Fact, term: Symbol, kinds: tuple[str, ...], parameters: Mapping[str, Parameter]
) -> Iterator[Problem]:
    if term.name in kinds:
        return
    wanted = " or ".join(f"a{'n' * (kind == 'object')} {kind}" if kind in KINDS else kind for kind in kinds)
    if term.name in parameters:
        kind = parameters[term.name].kind
        if kind not in kinds:
            yield source.problem(
                term.span, f"{term} is a{'n' * (kind == 'object')} {kind}; {goal.name} wants {wanted} here"
            )
    elif term.name in RESERVED_PARAMETER_NAMES:
        yield source.problem(term.span, f"{goal.name} wants {wanted} here, not {term}")
    else:
        yield source.problem(term.span, *_unknown(term.name, parameters))


def _unknown(name: str, parameters: Mapping[str, Parameter]) -> tuple[str, str]:
    hint = did_you_mean(name, [*parameters, "utak", "start"])
    return f"{name} is not introduced in start.lp", hint or f"write object({name}). in start.lp (or door, room)"
