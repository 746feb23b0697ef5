"""The work on users' rules in the process of kb.reasoning.query_worker: reading them, and solving our encodings
with them.
"""

from collections.abc import Sequence
from typing import Any

import clingo

from kb.reasoning.rule_reader import Calculator, CannotReadError, statements_of
from kb.three_valued.clauses import ClauseError

Answer = dict[str, Any]
MOST_TRIED = 200  # rules that are left out in turn to find those that contradict


def read(text: str) -> Answer:
    """Return {"statements": [...]} of a rule file, {"message": clingo's} or {"error", "at", "hint"}."""
    try:
        return {"statements": statements_of(text)}
    except CannotReadError as error:
        return {"message": str(error)}
    except ClauseError as error:
        return {"error": error.what, "at": error.at, "hint": error.hint}
    except RecursionError:
        return {"error": "a term is nested too deep", "at": (1, 1), "hint": ""}


def solved(program: str, rules: Sequence[str], heads: Sequence[Sequence[Any]], conflicts: int) -> Answer:
    """Return the best answer set of a program of ours with rules of a user.

    conflicts : of the search, after which it is cut off; 0 when nothing is searched, only made sure that all can be.
    {"atoms": those shown, "derived": those of `heads`}; {"message": clingo's, whose lines are those of the rules};
    {"error", "at", "rule"} for arithmetic; {"cut": why} when the search was cut off after so many conflicts; or
    {"against": numbers of rules} that leave no answer together.
    """
    rules = [" ".join(rule.split("\n")) for rule in rules]
    control, failed = _grounded(program, rules)
    if failed is not None or conflicts == 0:
        return failed or {}
    derived = [
        str(atom.symbol) for name, arity in heads for atom in control.symbolic_atoms.by_signature(str(name), int(arity))
    ]
    settings: Any = control.configuration.solve
    settings.solve_limit = f"{conflicts},umax"
    best: list[list[str] | None] = [None]
    priced = [False]

    def keep(model: clingo.Model) -> None:
        best[0], priced[0] = [str(atom) for atom in model.symbols(shown=True)], bool(model.cost)

    result = control.solve(on_model=keep)
    if result.unknown or (priced[0] and not result.exhausted):
        return {"cut": f"after {conflicts} conflicts"}
    if best[0] is None:
        return {"against": _against(program, rules)}
    return {"atoms": best[0], "derived": derived}


def _grounded(program: str, rules: Sequence[str]) -> tuple[clingo.Control, Answer | None]:
    messages: list[str] = []
    calculator = Calculator()
    control = clingo.Control([], logger=lambda _code, text: messages.append(text), message_limit=20)
    try:
        control.add("base", [], "\n".join(rules))
        control.add("base", [], program)
        control.ground([("base", [])], context=calculator)
    except RuntimeError as error:
        messages.append(str(error))
    if calculator.error is not None:
        at = calculator.error.at
        number = next((n for n, rule in enumerate(rules) if f",({at[0]},{at[1]})," in rule), 0)
        return control, {"error": calculator.error.what, "at": at, "rule": number}
    telling = [message for message in messages if "does not occur in any rule head" not in message]
    return control, {"message": telling[0]} if telling else None


def _against(program: str, rules: Sequence[str]) -> list[int]:
    """The numbers of rules that leave no answer together: without any one of them there is one."""
    left = list(range(len(rules)))
    for number in range(min(len(rules), MOST_TRIED) - 1, -1, -1):
        fewer = [other for other in left if other != number]
        if not _satisfiable(program, [rules[other] for other in fewer]):
            left = fewer
    return left or [0]


def _satisfiable(program: str, rules: Sequence[str]) -> bool:
    control, failed = _grounded(program, rules)
    return failed is None and bool(control.solve().satisfiable)
