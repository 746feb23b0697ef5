"""The order in which the literals of a body are evaluated: each when its variables are bound, tests before binders."""

from collections.abc import Iterable, Sequence

from utak.kb.language.integers import MAX_INT32, MIN_INT32
from utak.kb.three_valued.clauses import (
    Aggregate,
    Atom,
    ClauseError,
    ClauseTerm,
    Comparison,
    Compound,
    ConditionalLiteral,
    Constant,
    Literal,
    Operation,
    Variable,
    global_variables,
    variables_of,
)
from utak.kb.three_valued.uncertain_values import MIRRORED_SIGNS


def order_literals(body: Sequence[Literal], given: Iterable[str]) -> tuple[Literal, ...]:
    """Return the literals of a body in an order in which they can be evaluated."""
    bound, left, order = set(given), list(body), []
    own = set(global_variables(body)) | {name for literal in body for name in _body_names(literal)}
    while left:
        ready = [literal for literal in left if (_needs(literal, own) - bound) == set()]
        ready = ready or [literal for literal in left if _can_bind(literal, bound, own)]
        if not ready and (interval := _bounding_interval(left, bound)):
            left.append(interval)
            continue
        if not ready:
            literal = left[0]
            missing = sorted(name for one in left for name in _needs(one, own) - bound)
            shown = next((name for name in missing if not name.startswith(("?", "."))), "?")
            raise unsafe_variable_error(shown, literal.at)
        chosen = max(ready, key=lambda literal: len(bound & set(_body_names(literal))))
        left.remove(chosen)
        order.append(chosen)
        bound |= _bound_by(chosen, bound)
    return tuple(order)


def unsafe_variable_error(name: str, at: tuple[int, int]) -> ClauseError:
    """Return the error that no literal binds a variable."""
    shown = "_" if name.startswith(("?", ".")) else name
    return ClauseError(f"nothing says what {shown} can be: it must be in an atom that holds", at)


def _body_names(literal: Literal) -> list[str]:
    """Return the names of the variables of a literal outside of elements and conditions, `_` included."""
    if isinstance(literal, Atom | Comparison):
        return list(variables_of(literal))
    if isinstance(literal, Aggregate):
        return list(variables_of(tuple(term for _, term in literal.guards)))
    return []


def _needs(literal: Literal, own: set[str]) -> set[str]:
    """Return the names of the variables that must be bound before a literal can be tested."""
    if isinstance(literal, Atom) and literal.negations:
        return {name for name in variables_of(literal) if not name.startswith("?")}
    if isinstance(literal, Aggregate | ConditionalLiteral):
        return set(variables_of(literal)) & own
    return set(variables_of(literal))


def _can_bind(literal: Literal, bound: set[str], own: set[str]) -> bool:
    """Return whether a literal can be evaluated now and binds variables by that."""
    if isinstance(literal, Atom):
        return literal.negations == 0 and all(_matchable(part, bound) for part in literal.parts)
    if isinstance(literal, Aggregate):
        variable = assigned_variable(literal.guards, bound)
        return not literal.negated and variable is not None and _needs(literal, own) - {variable.name} <= bound
    return isinstance(literal, Comparison) and assignment(literal, bound) is not None


def _matchable(term: ClauseTerm, bound: set[str]) -> bool:
    """Return whether a term can be matched with values, which inverts arithmetic with one unbound variable."""
    if isinstance(term, Constant | Variable):
        return True
    if isinstance(term, Compound):
        return all(_matchable(part, bound) for part in term.parts)
    return set(variables_of(term)) <= bound or _invertible(term, bound)


def _invertible(term: Operation, bound: set[str]) -> bool:
    """Return whether exactly one operand of `+`, `-` or `*` is unbound and can be computed from the result."""
    open_ = [part for part in term.parts if not set(variables_of(part)) <= bound]
    if term.sign not in ("+", "-", "*") or len(open_) != 1:
        return False
    (part,) = open_
    return isinstance(part, Variable) or (isinstance(part, Operation) and _invertible(part, bound))


def assignment(literal: Comparison, bound: set[str]) -> tuple[ClauseTerm, ClauseTerm] | None:
    """Return the pattern and the term that gives its value, for a comparison that binds variables; else None."""
    if literal.negated:
        return None
    terms = [literal.first, *(term for _, term in literal.rest)]
    for (sign, right), left in zip(literal.rest, terms, strict=False):
        for pattern, source in ((left, right), (right, left)):
            is_single_value = not isinstance(pattern, Operation) or pattern.sign != ".."
            if sign != "=" or not is_single_value or set(variables_of(pattern)) <= bound:
                continue
            if set(variables_of(source)) <= bound and _matchable(pattern, bound):
                return pattern, source
    return None


def assigned_variable(guards: Iterable[tuple[str, ClauseTerm]], bound: set[str]) -> Variable | None:
    """Return the variable to which an aggregate gives its value: that of the first guard `X = ...`, or None."""
    for sign, term in guards:
        if sign == "=" and isinstance(term, Variable) and term.name not in bound:
            return term
    return None


def _bounding_interval(literals: Iterable[Literal], bound: set[str]) -> Comparison | None:
    """Return `X = low..high` for a variable X that only comparisons with numbers bound; None when there is none."""
    lows: dict[str, int] = {}
    highs: dict[str, int] = {}
    for literal in literals:
        if not isinstance(literal, Comparison) or literal.negated:
            continue
        terms = [literal.first, *(term for _, term in literal.rest)]
        for (sign, right), left in zip(literal.rest, terms, strict=False):
            for one, way, other in ((left, sign, right), (right, MIRRORED_SIGNS[sign], left)):
                number = other.value if isinstance(other, Constant) else None
                if isinstance(one, Variable) and one.name not in bound and isinstance(number, int):
                    if way in (">", ">="):
                        lows[one.name] = max(lows.get(one.name, MIN_INT32), number + (way == ">"))
                    if way in ("<", "<="):
                        highs[one.name] = min(highs.get(one.name, MAX_INT32), number - (way == "<"))
    name = next((name for name in lows if name in highs), None)
    if name is None:
        return None
    ends = tuple(Constant(number, (1, 1)) for number in (lows[name], highs[name]))
    return Comparison(Variable(name, (1, 1)), (("=", Operation("..", ends, (1, 1))),), False, (1, 1))


def _bound_by(literal: Literal, bound: set[str]) -> set[str]:
    """Return the names of the variables to which a literal gives values; those of `bound` have one before."""
    if isinstance(literal, Atom):
        return set() if literal.negations else set(variables_of(literal))
    if isinstance(literal, Comparison):
        found = assignment(literal, bound)
        return set() if found is None else set(variables_of(found[0]))
    if isinstance(literal, Aggregate):
        variable = assigned_variable(literal.guards, bound)
        return set() if variable is None or literal.negated else {variable.name}
    return set()
