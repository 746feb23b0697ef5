"""The verdict `impossible` is given where something proves it, and never else."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from utak.planner.decision import Decision, TaskVerdict, impossible

ROOT = Path(__file__).resolve().parents[2] / "planner"
OWNER = ROOT / "decision.py"


def uses_of(name: str) -> Iterator[tuple[Path, ast.Call]]:
    """Yield all calls of a function or class in the planner, each with its file."""
    for path in sorted(ROOT.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name:
                yield path, node


def test_impossible_without_a_proof_is_refused() -> None:
    with pytest.raises(ValueError, match="nothing proves"):
        Decision(None, "no way", TaskVerdict.IMPOSSIBLE)
    assert impossible("no way", "every route is shut").result == "impossible"
    assert impossible("no way", "every route is shut", unless=None).result == "settled"


def test_every_place_that_gives_impossible_names_what_proves_it() -> None:
    calls = [(path, call) for path, call in uses_of("impossible") if path != OWNER]
    assert len(calls) >= 8
    for path, call in calls:
        assert len(call.args) >= 2, f"{path.name}:{call.lineno} names no fact that proves it"


def test_no_place_makes_the_verdict_in_another_way() -> None:
    for path, call in uses_of("Decision"):
        if path != OWNER:
            assert "IMPOSSIBLE" not in ast.unparse(call), f"{path.name}:{call.lineno}"


def test_no_function_gives_impossible_by_default() -> None:
    for path in sorted(ROOT.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef):
                defaults = [*node.args.defaults, *(d for d in node.args.kw_defaults if d is not None)]
                assert not any("IMPOSSIBLE" in ast.unparse(d) for d in defaults), f"{path.name}: {node.name}"
