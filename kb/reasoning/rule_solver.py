"""Users' rules read and encodings solved with them, in the process of kb.reasoning.query_worker."""

from collections.abc import Sequence
from typing import Any

import clingo

from utak.kb.reasoning.encodings import CORE_GUIDED
from utak.kb.reasoning.rule_reader import RuleSyntaxError, read_statements
from utak.kb.three_valued.arithmetic import ClauseError
from utak.kb.three_valued.functions import Functions

Response = dict[str, Any]  # JSON values for the parent process
MAX_RULES_TRIED = 200  # rules left out in turn, one solving each, to find those that contradict; a convention


def read_rule_text(text: str, renamed: Sequence[Sequence[Any]] = ()) -> Response:
    """Return the statements of a rule file: {"statements": [...]}, dictionaries as of `read_statements`."""
    try:
        return {"statements": read_statements(text, {(str(name), int(count)) for name, count in renamed})}
    except RuleSyntaxError as error:
        return {"message": str(error)}
    except ClauseError as error:
        return {"error": error.what, "at": error.at, "hint": error.hint}
    except RecursionError:
        return {"error": "a term is nested too deep", "at": (1, 1), "hint": ""}


def solve_with_rules(
    program: str,
    rules: Sequence[str],
    heads: Sequence[Sequence[Any]],
    conflicts: int,
    conditions: Sequence[str] = (),
) -> Response:
    """Return the best answer set of an encoding together with users' rules."""
    rules = [" ".join(rule.split("\n")) for rule in rules]
    for options in (CORE_GUIDED, ()):  # the same search as without users' rules
        control, failed = _grounded(program, rules, options)
        if failed is not None or conflicts == 0:
            return failed or {}
        best: list[tuple[list[str], list[tuple[int, int]]]] = []

        def keep(model: clingo.Model, best: list[tuple[list[str], list[tuple[int, int]]]] = best) -> None:
            """Keep the shown atoms of a model, as text, and its cost: pairs of level and amount."""
            cost = list(zip(model.priority, model.cost, strict=True))
            best.append(([str(atom) for atom in model.symbols(shown=True)], cost))

        settings: Any = control.configuration.solve
        settings.solve_limit = f"{conflicts},umax"
        result = control.solve(on_model=keep)
        if result.exhausted:
            break
    if not best:
        observed = _grounded(program, [*rules, *_observers(conditions)])[0]
        applied = _instances(observed)
        end = {"against": _conflicting_rules(program, rules)} if result.exhausted else {"cut": conflicts}
        return {**end, "applied": applied}
    control.add("observed", [], "\n".join(_observers(conditions)))
    control.ground([("observed", [])], context=Functions())  # after the search, which stays as it was
    applied = _instances(control)
    derived = [
        str(atom.symbol) for name, arity in heads for atom in control.symbolic_atoms.by_signature(str(name), int(arity))
    ]
    atoms, cost = best[-1]
    return {"atoms": atoms, "derived": derived, "cost": cost, "proved": result.exhausted, "applied": applied}


def _observers(conditions: Sequence[str]) -> list[str]:
    """Return rules that derive `applied__(N)` where the body of rule N holds, for those that have one."""
    return [f"applied__({number}) :- {' '.join(text.split())}." for number, text in enumerate(conditions) if text]


def _instances(control: clingo.Control) -> list[int]:
    """Return the numbers, from 0, of the rules whose observers have an instance in a grounded program."""
    return sorted(atom.symbol.arguments[0].number for atom in control.symbolic_atoms.by_signature("applied__", 1))


def _grounded(
    program: str, rules: Sequence[str], options: Sequence[str] = ()
) -> tuple[clingo.Control, Response | None]:
    """Return the grounded program, and the response to an error or None when there is none."""
    messages: list[str] = []
    calculator = Functions()
    control = clingo.Control([*options], logger=lambda _code, text: messages.append(text), message_limit=20)
    control.enable_cleanup = False  # what a search finds never to hold is observed all the same
    try:
        control.add("base", [], "\n".join(rules))
        control.add("base", [], program)
        control.ground([("base", [])], context=calculator)
    except RuntimeError as error:
        messages.append(str(error))
    if calculator.error is not None:
        at = calculator.error.at
        number = next((n for n, rule in enumerate(rules) if f"@calculate(({at[0]},{at[1]})," in rule), 0)
        return control, {"error": calculator.error.what, "at": at, "rule": number}
    telling = [message for message in messages if "does not occur in any rule head" not in message]
    return control, {"message": telling[0]} if telling else None


def _conflicting_rules(program: str, rules: Sequence[str]) -> list[int]:
    """Return the numbers, from 0, of rules that together leave no answer."""
    # Without any one of them there is an answer.
    left = list(range(len(rules)))
    for number in range(min(len(rules), MAX_RULES_TRIED) - 1, -1, -1):
        fewer = [other for other in left if other != number]
        if not _satisfiable(program, [rules[other] for other in fewer]):
            left = fewer
    return left or [0]


def _satisfiable(program: str, rules: Sequence[str]) -> bool:
    """Return whether the program with these rules has an answer set; False also when an error occurs."""
    control, failed = _grounded(program, rules)
    return failed is None and bool(control.solve().satisfiable)
