"""Arithmetic of rules as functions of the values of their variables, and where such a function turns."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import clingo
from clingo.ast import AST, ASTType, BinaryOperator, ComparisonOperator, UnaryOperator

GREATEST_NUMBER = 1_000_000  # the greatest number that is looked for, as in kb.reasoning.interfaces
Calculation = Callable[[Mapping[str, int]], int | None]  # from the values of variables to a number; None without one


class Relation(NamedTuple):
    """Two terms that are held against each other."""

    left: Calculation  # the terms as functions of the values of variables
    right: Calculation
    names: tuple[str, ...]  # the names of these variables
    sign: int  # how clingo compares the terms
    fixed: frozenset[str] = frozenset()  # the names whose values are not looked for


def calculation(term: AST, constants: Mapping[str, clingo.Symbol]) -> Calculation:
    """Return a term as a function of the values of its variables, which returns None where the term is no number."""
    if term.ast_type == ASTType.SymbolicTerm:
        symbol = constants.get(str(term.symbol), term.symbol)
        number = symbol.number if symbol.type == clingo.SymbolType.Number else None
        return lambda _values: number
    if term.ast_type == ASTType.Variable:
        name = term.name
        return lambda values: values.get(name)
    if term.ast_type == ASTType.UnaryOperation:
        return _unary(term.operator_type, calculation(term.argument, constants))
    if term.ast_type == ASTType.BinaryOperation:
        left, right = (calculation(part, constants) for part in (term.left, term.right))
        return _binary(term.operator_type, left, right)
    return lambda _values: None


def turning_numbers(one: Relation, target: str, values: Mapping[str, int]) -> list[int]:
    """Return the values of one variable on both sides of where a relation turns, given those of the others."""

    def difference(value: int) -> int | None:
        """Return by how much the left side exceeds the right one."""
        whole = {**values, target: value}
        left, right = one.left(whole), one.right(whole)
        return None if left is None or right is None else left - right

    is_beyond = one.sign in (ComparisonOperator.LessEqual, ComparisonOperator.GreaterThan)
    edge = _edge(difference, 1 if is_beyond else 0)
    if edge is None:
        return []
    near = [edge - 1, edge]
    if one.sign == ComparisonOperator.Equal:
        return [value for value in near if difference(value) == 0][:1]
    return near


def _edge(difference: Callable[[int], int | None], least: int) -> int | None:
    """Return the least number from which on a monotone function is at least `least`, or no longer at least that."""
    # None when there is none up to GREATEST_NUMBER, or when the function has no value.
    low, high = -GREATEST_NUMBER, GREATEST_NUMBER
    first, last = difference(low), difference(high)
    if first is None or last is None:
        return None
    if (first >= least) == (last >= least):  # a quotient turns at 0 besides
        low, first = 1, difference(1)
        if first is None or (first >= least) == (last >= least):
            return None
    slope, rest = divmod(last - first, high - low)
    if slope and not rest and difference(low + 1) == first + slope:  # likely a straight line
        guess = low - (first - least) // slope
        for edge in (guess - 1, guess, guess + 1):
            before, after = difference(edge - 1), difference(edge)
            if before is not None and after is not None and (before >= least) != (after >= least):
                return edge
    rising = last >= least
    while high - low > 1:
        middle = (low + high) // 2
        found = difference(middle)
        if found is None:
            return None
        low, high = (low, middle) if (found >= least) == rising else (middle, high)
    return high


def _unary(operator: int, inner: Calculation) -> Calculation:
    """Return the function of an operation on one term."""

    def calculate(values: Mapping[str, int]) -> int | None:
        """Return the result of the operation; None where it has none."""
        value = inner(values)
        if value is None or operator not in (UnaryOperator.Minus, UnaryOperator.Absolute):
            return None
        return -value if operator == UnaryOperator.Minus else abs(value)

    return calculate


def _binary(operator: int, left: Calculation, right: Calculation) -> Calculation:
    """Return the function of an operation on two terms; clingo rounds quotients towards 0."""

    def calculate(values: Mapping[str, int]) -> int | None:
        """Return the result of the operation; None where it has none."""
        a, b = left(values), right(values)
        if a is None or b is None:
            return None
        if operator == BinaryOperator.Plus:
            return a + b
        if operator == BinaryOperator.Minus:
            return a - b
        if operator == BinaryOperator.Multiplication:
            return a * b
        if b == 0 or operator not in (BinaryOperator.Division, BinaryOperator.Modulo):
            return None
        quotient = abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)
        return quotient if operator == BinaryOperator.Division else a - quotient * b

    return calculate
