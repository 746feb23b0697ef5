"""The values of terms whose variables are bound, and the numbers of intervals."""

from collections.abc import Iterable, Mapping, Sequence

import clingo

from utak.kb.language.integers import MAX_INT32, MIN_INT32
from utak.kb.three_valued.arithmetic import CalculationError
from utak.kb.three_valued.clauses import ClauseError, ClauseTerm, Compound, Constant, Operation, Variable
from utak.kb.three_valued.join_order import unsafe_variable_error
from utak.kb.three_valued.uncertain_values import Unknown, Value, as_clingo, bounds, calculate_uncertain

Bindings = Mapping[str, Value]  # the values of variables, by name


def value_of(term: ClauseTerm, given: Bindings) -> Value:
    """Return the value of a term whose variables are all bound."""
    if isinstance(term, Constant):
        return term.value
    if isinstance(term, Variable):
        if term.name not in given:
            raise unsafe_variable_error(term.name, term.at)
        return given[term.name]
    if isinstance(term, Compound):
        parts = [value_of(part, given) for part in term.parts]
        if any(isinstance(part, Unknown) for part in parts):
            return Unknown()
        return clingo.Function(term.name, [as_clingo(part) for part in parts])
    numbers = [number_of(part, given) for part in term.parts]
    try:
        return calculate_uncertain(term.sign, *numbers)
    except CalculationError as error:
        raise ClauseError(f"{error}, in {_calculation_text(term.sign, numbers)}", term.at) from None


def number_of(term: ClauseTerm, given: Bindings) -> Value:
    """Return the value of a term that must be a number: an integer, or an `Unknown`."""
    # Raises ClauseError for other values, and for an unbound variable.
    value = value_of(term, given)
    if isinstance(value, int | Unknown):
        return value
    raise ClauseError(f"operation undefined: {value} is no number", term.at)


def values_of(term: ClauseTerm, given: Bindings) -> Iterable[Value]:
    """Return the values of a term: all numbers of an interval, a range; or one value, in a list."""
    # Raises ClauseError for an unbound variable and for arithmetic without a result.
    if isinstance(term, Operation) and is_interval(term):
        low, high = (number_of(part, given) for part in term.parts)
        if isinstance(low, Unknown) or isinstance(high, Unknown):
            least, greatest = (bounds(end) or (MIN_INT32, MAX_INT32) for end in (low, high))
            return [Unknown(least[0], greatest[1])]
        return range(low, high + 1)
    return [value_of(term, given)]


def is_interval(term: ClauseTerm) -> bool:
    """Return whether a term is an interval, `low..high`."""
    return isinstance(term, Operation) and term.sign == ".."


def deciding_numbers(values: Iterable[Value], others: Iterable[Value]) -> Iterable[Value]:
    """Return those numbers of an interval that decide how it compares with other values."""
    if not isinstance(values, range) or not values:
        return values
    if isinstance(others, range):
        ends: list[int] = [others[0], others[-1]] if others else []
    else:
        ends = [end for other in others for end in _ends(other)]
    return sorted({values[0], values[-1], *(end for end in ends if end in values)})


def from_clingo(value: clingo.Symbol) -> Value:
    """Return a clingo symbol as a value: numbers become Python integers, all else stays."""
    return value.number if value.type == clingo.SymbolType.Number else value


def _ends(value: Value) -> list[int]:
    """Return a number, or the bounds (least, greatest) of a number that is not known, in a list; [] for all else."""
    if isinstance(value, Unknown):
        return [end for end in (value.low, value.high) if end is not None]
    return [value] if isinstance(value, int) else []


def _calculation_text(sign: str, numbers: Sequence[Value]) -> str:
    """Return a calculation with one or two operands as messages show it, such as `3 / 0`; `?` for what is not known."""
    shown = ["?" if isinstance(number, Unknown) else str(number) for number in numbers]
    return f" {sign} ".join(shown) if len(shown) == 2 else f"|{shown[0]}|" if sign == "|" else f"{sign}{shown[0]}"
