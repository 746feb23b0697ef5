"""The task: parameters and claims about them (start.lp), and goals (goal.lp)."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan, did_you_mean
from utak.kb.language.goal_words import CONSTRAINT_GOALS, GOAL_WORDS, TRACK_GOALS, WRAPPING_GOALS
from utak.kb.language.reader import facts_from_text, parse_facts
from utak.kb.language.source_text import Source, read_source, source_from_bytes
from utak.kb.language.terms import Fact, Number, Symbol, Term
from utak.kb.language.vocabulary import (
    CLAIM_WORDS,
    GOAL_VOCABULARY,
    RESERVED_PARAMETER_NAMES,
    START_VOCABULARY,
    Vocabulary,
    check_facts,
)

CERTAIN_CONFIDENCE = 100  # percent; the confidence of a claim that stands alone
PARAMETER_KINDS = ("object", "door", "room")  # the predicates that introduce parameters
# The shape classes that a shape class includes; everything is a polygon, too.
SHAPE_SUBCLASSES = {"rectangle": {"square", "brick"}}
APPEARANCES = ("shape", "colour")  # claims of what a thing looks like: kb.task.binding states them of every node


@dataclass(frozen=True)
class Parameter:
    """A thing that the task mentions."""

    name: str  # its name in the task, a word such as x
    kind: str  # "object", "door" or "room"
    span: SourceSpan = field(compare=False)  # the place in start.lp that introduces it: line and columns from 1.


@dataclass(frozen=True)
class Claim:
    """A claim about a thing, a door or a room, as it is at first."""

    fact: Fact  # the claim, such as `shape(x, square)` or `connects(d, r, s)`
    confidence: int = CERTAIN_CONFIDENCE  # the user's confidence in it, percent, 0 to 100; 100 when none is given

    @property
    def named(self) -> tuple[str, ...]:
        """The terms of the claim that may be parameters: a colour or a shape is none, whatever its name."""
        return tuple(map(str, self.fact.args[:1] if self.fact.name in APPEARANCES else self.fact.args))


@dataclass(frozen=True)
class Task:
    """The task of the robot."""

    parameters: Mapping[str, Parameter]  # the parameters by name, in the order of start.lp.
    claims: tuple[Claim, ...]  # what is claimed of the parameters, in the order of start.lp.
    # What shall hold, facts in the order of goal.lp; `first(G)` and `then(G)` are kept as they stand.
    goals: tuple[Fact, ...]

    def is_object(self, word: str) -> bool:
        """Return whether a word is a parameter of the task that stands for an object."""
        return word in self.parameters and self.parameters[word].kind == "object"

    @property
    def described(self) -> frozenset[str]:
        """The doors and rooms of which something is claimed; of the others nothing tells which ones they are."""
        words = {word for claim in self.claims for word in claim.named}
        return frozenset(x for x in words & set(self.parameters) if not self.is_object(x))

    @property
    def goal_parameters(self) -> frozenset[str]:
        """The names of the parameters that goals mention, also inside `first(G)`, `then(G)` and `prefer(G, N)`."""
        words = {str(term) for goal in self.goals for term in inner_goal(goal).args}
        return frozenset(words & set(self.parameters))


def read_task(start: Path | str, goal: Path | str) -> Task:
    """Return the task of a scenario."""
    problems: list[Problem] = []
    sources: list[Source | None] = []
    for path in (start, goal):
        try:
            sources.append(read_source(path))
        except BadInputError as bad:
            problems += bad.problems
            sources.append(None)
    return _task_from(sources, problems)


def task_from_texts(start: str, goal: str, name: str = "task") -> Task:
    """Return the task that the texts of start.lp and goal.lp state; errors in them name `name`."""
    sources = [source_from_bytes(f"{name}: {part}", text.encode()) for part, text in (("start", start), ("goal", goal))]
    return _task_from(sources, [])


def _task_from(sources: Sequence[Source | None], problems: list[Problem]) -> Task:
    """Return the task of two sources, start and goal; raise BadInputError for their problems, and for given ones."""
    start_facts, goal_facts = (
        _checked_facts(s, v, problems) for s, v in zip(sources, (START_VOCABULARY, GOAL_VOCABULARY), strict=True)
    )
    if problems or sources[0] is None or sources[1] is None:
        raise BadInputError(problems)
    return task_of(sources[0], start_facts, sources[1], goal_facts)


def read_start(path: Path | str) -> tuple[Fact, ...]:
    """Return the facts of start.lp, checked without goal.lp."""
    source = read_source(path)
    problems: list[Problem] = []
    start_facts = _checked_facts(source, START_VOCABULARY, problems)
    if not problems:
        problems = _start_problems(source, start_facts)[2]
    if problems:
        raise BadInputError(problems)
    return start_facts


def task_with_goals(task: Task, source: Source) -> Task:
    """Return a task with other goals."""
    facts = parse_facts(source)
    problems = check_facts(source, facts, {**START_VOCABULARY, **GOAL_VOCABULARY})
    if problems:
        raise BadInputError(problems)
    goals = tuple(fact for fact in facts if fact.name in GOAL_VOCABULARY)
    new = tuple(fact for fact in facts if fact.name not in GOAL_VOCABULARY)
    kept = facts_from_text("".join(f"{fact}.\n" for fact in start_facts_of(task)), "start.lp")
    return task_of(source, (*(fact for fact in kept if fact not in new), *new), source, goals)


def start_facts_of(task: Task) -> Iterator[str]:
    """Yield the facts of start.lp that introduce a task's parameters and claims, without full stops."""
    for name, parameter in task.parameters.items():
        yield f"{parameter.kind}({name})"
    for claim in task.claims:
        certain = claim.confidence == CERTAIN_CONFIDENCE
        yield str(claim.fact) if certain else f"confidence({claim.fact},{claim.confidence})"


def task_of(start: Source, start_facts: tuple[Fact, ...], goal: Source, goal_facts: tuple[Fact, ...]) -> Task:
    """Return the task that the facts of two sources state."""
    parameters, claims, problems = _start_problems(start, start_facts)
    problems += _duplicates(goal, goal_facts)
    problems += _goal_problems(goal, goal_facts, parameters)
    if problems:
        raise BadInputError(problems)
    return Task(parameters, tuple(claims), goal_facts)


def _start_problems(
    source: Source, start_facts: tuple[Fact, ...]
) -> tuple[dict[str, Parameter], list[Claim], list[Problem]]:
    """Return the parameters of start.lp by name, its claims in order, and the problems in it; [] for none."""
    problems = _duplicates(source, start_facts)
    parameters = _parameters(source, start_facts, problems)
    claims = _claims(source, start_facts, parameters, problems)
    problems += _contradictions(source, claims)
    return parameters, claims, problems


def _checked_facts(source: Source | None, vocabulary: Vocabulary, problems: list[Problem]) -> tuple[Fact, ...]:
    """Return the facts of a source, in order; append its problems to `problems`."""
    if source is None:
        return ()
    try:
        facts = parse_facts(source)
    except BadInputError as bad:
        problems += bad.problems
        return ()
    problems += check_facts(source, facts, vocabulary)
    return facts


def _duplicates(source: Source, facts: tuple[Fact, ...]) -> list[Problem]:
    """Return a problem for each fact that is stated twice, except `then(G)`, which is another step each time."""
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
    """Return the parameters that start.lp introduces, by name in the order of the facts."""
    found: dict[str, Parameter] = {}
    for fact in facts:
        if fact.name not in PARAMETER_KINDS:
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
    """Return the claims of start.lp in order; append problems to `problems`."""
    claims: list[Claim] = []
    confidences: dict[Fact, int] = {}
    for fact in facts:
        if fact.name in PARAMETER_KINDS:
            continue
        claim = _claim(fact)
        problems += _wrong_arguments(source, claim.fact, CLAIM_WORDS[claim.fact.name].parameters, parameters)
        if claim.fact in confidences and confidences[claim.fact] != claim.confidence:
            what = f"{claim.fact} is claimed with confidence {confidences[claim.fact]} and {claim.confidence}"
            problems.append(source.problem(fact.span, what))
        confidences[claim.fact] = claim.confidence
        claims.append(claim)
    return claims


def _claim(fact: Fact) -> Claim:
    """Return the claim that a fact states: `confidence(Fact, Percent)`, or a bare fact, which is certain."""
    if fact.name != "confidence":
        return Claim(fact)
    inner, degree = fact.args
    assert isinstance(inner, Symbol)
    assert isinstance(degree, Number)
    return Claim(inner, degree.value)


def _contradictions(source: Source, claims: list[Claim]) -> Iterator[Problem]:
    """Yield a problem for each certain claim that cannot hold with the first one of its kind on that thing or door."""
    certain: dict[tuple[str, Term], Fact] = {}
    for claim in claims:
        if claim.confidence < CERTAIN_CONFIDENCE or not CLAIM_WORDS[claim.fact.name].one:
            continue
        key = (claim.fact.name, claim.fact.args[0])
        before = certain.setdefault(key, claim.fact)
        if not _compatible(claim.fact, before):
            what = f"{claim.fact} contradicts {before}"
            hint = f"see line {before.span.line}; say how sure it is: confidence({claim.fact}, 50)."
            yield source.problem(claim.fact.span, what, hint)


def _compatible(one: Fact, other: Fact) -> bool:
    """Return whether two claims of the same kind, such as shape, about one thing can both hold."""
    first, second = str(one.args[1]), str(other.args[1])
    if first == second:
        return True
    if one.name != "shape":
        return False
    return (
        "polygon" in (first, second)
        or first in SHAPE_SUBCLASSES.get(second, ())
        or second in SHAPE_SUBCLASSES.get(first, ())
    )


def _goal_problems(source: Source, goals: tuple[Fact, ...], parameters: Mapping[str, Parameter]) -> Iterator[Problem]:
    """Yield the problems of goals: their order, their arguments, and an empty goal."""
    has_goal = False
    for fact in goals:
        goal = inner_goal(fact)
        if fact.name == "first" and has_goal:
            yield source.problem(fact.span, "first(...) must come before every other step", "write then(...)")
        if fact.name == "then" and not has_goal:
            yield source.problem(fact.span, "then(...) without anything before it", "begin with first(...)")
        if goal.name in CONSTRAINT_GOALS and fact is not goal:
            yield source.problem(goal.span, f"{fact.name}(...) needs something to attain, not a constraint")
        if goal.name in TRACK_GOALS and fact.name == "prefer":
            what = f"prefer(...) needs a goal that a place fulfils; {goal.name} is one of the whole way"
            yield source.problem(goal.span, what, f"state {goal} as a goal, or leave it out")
        has_goal = has_goal or (goal.name not in CONSTRAINT_GOALS and fact.name != "prefer")
        yield from _wrong_arguments(source, goal, GOAL_WORDS[goal.name].parameters, parameters)
        if fact.name == "prefer" and goal in goals:
            yield source.problem(fact.span, f"{goal} is a goal already, and no wish", "leave out one of the two")
    if not has_goal:
        yield source.problem(
            source.start(), "the goal is empty: nothing shall hold", "such as at(utak, corner(northeast))."
        )


def inner_goal(fact: Fact) -> Fact:
    """Return the goal inside `first(G)`, `then(G)` or `prefer(G, N)`; any other goal as it is."""
    inner = fact.args[0] if fact.name in WRAPPING_GOALS else fact
    assert isinstance(inner, Symbol)
    return inner


def _wrong_arguments(
    source: Source, fact: Fact, taken: Sequence[tuple[str, ...] | None], parameters: Mapping[str, Parameter]
) -> Iterator[Problem]:
    """Yield the problems of the parameters of a goal or a claim; `taken`: the kinds that each argument takes."""
    for term, kinds in zip(fact.args, taken, strict=True):
        if kinds is not None and isinstance(term, Symbol) and not term.args:
            yield from _wrong_kind(source, fact, term, kinds, parameters)
    named = [term for term, kinds in zip(fact.args, taken, strict=True) if kinds is not None]  # x may be a colour, too
    twice = [term for term, after in pairwise(named) if term == after]
    yield from (source.problem(fact.span, f"{fact.name} relates {term} to itself") for term in twice)


def _wrong_kind(
    source: Source, goal: Fact, term: Symbol, kinds: tuple[str, ...], parameters: Mapping[str, Parameter]
) -> Iterator[Problem]:
    """Yield the problem of an argument that is no parameter of an accepted kind; nothing when it is one."""
    if term.name in kinds:
        return
    wanted = " or ".join(f"a{'n' * (kind == 'object')} {kind}" if kind in PARAMETER_KINDS else kind for kind in kinds)
    if term.name in parameters:
        kind = parameters[term.name].kind
        if kind not in kinds:
            yield source.problem(
                term.span, f"{term} is a{'n' * (kind == 'object')} {kind}; {goal.name} wants {wanted} here"
            )
    elif term.name in RESERVED_PARAMETER_NAMES:
        yield source.problem(term.span, f"{goal.name} wants {wanted} here, not {term}")
    else:
        fitting = [name for name, parameter in parameters.items() if parameter.kind in kinds]
        yield source.problem(term.span, *_not_introduced(term.name, fitting, kinds))


def _not_introduced(name: str, known: Iterable[str], kinds: Sequence[str]) -> tuple[str, str]:
    """Return message and hint for a parameter that start.lp does not introduce."""
    introduced = " or ".join(f"{kind}({name})." for kind in kinds if kind in PARAMETER_KINDS)
    words = [kind for kind in kinds if kind not in PARAMETER_KINDS]
    hint = did_you_mean(name, [*known, *words]) or (f"write {introduced} in start.lp" if introduced else "")
    return f"{name} is not introduced in start.lp", hint
