"""The notebooks run, cell by cell, and what a cell ends with shows itself as it would in Jupyter."""

import ast
import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
MAX_NOTEBOOK_BYTES = 50_000  # a notebook without outputs is small


def read(path: Path) -> dict[str, Any]:
    """Return a notebook."""
    return json.loads(path.read_text())


def run_cell(program: str, names: dict[str, Any]) -> Any:
    """Execute the program of a cell, and return the value of its last line when that is an expression, else None."""
    tree = ast.parse(program)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return None if last is None else eval(compile(ast.Expression(last.value), "cell", "eval"), names)


def shown(value: Any) -> str:
    """Return what Jupyter shows of a value: HTML where the value offers it, else its text."""
    markup = getattr(value, "_repr_html_", None)
    if markup is None:
        return repr(value)
    ElementTree.fromstring(f"<div>{markup()}</div>")
    return markup()


def test_there_are_notebooks() -> None:
    assert [path.name for path in NOTEBOOKS] == ["first_steps.ipynb"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_small_and_holds_no_outputs(path: Path) -> None:
    notebook = read(path)
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    assert path.stat().st_size < MAX_NOTEBOOK_BYTES
    identities = [cell["id"] for cell in notebook["cells"]]
    assert len(set(identities)) == len(identities)
    for cell in notebook["cells"]:
        assert cell["cell_type"] in ("markdown", "code")
        if cell["cell_type"] == "code":
            assert (cell["outputs"], cell["execution_count"]) == ([], None)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_has_the_form_of_jupyter(path: Path) -> None:
    nbformat = pytest.importorskip("nbformat")
    nbformat.validate(nbformat.read(path, as_version=4))


@pytest.mark.long
def test_the_first_steps_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(FOLDER)
    names: dict[str, Any] = {"__name__": "__main__"}
    cells = [cell for cell in read(FOLDER / "first_steps.ipynb")["cells"] if cell["cell_type"] == "code"]
    outputs = {"".join(cell["source"]): shown(run_cell("".join(cell["source"]), names)) for cell in cells}
    assert (names["episode"].verdict, names["episode"].achieved) == ("done", True)
    assert (names["home"].verdict, names["judged"].achieved) == ("done", False)
    assert sum(text.startswith("<figure") for text in outputs.values()) >= 5
    assert "<details open=" in outputs['episode.why("verdict(done)")']
    assert "o1" in outputs['episode.world.query("shape(X, square, C)")']


def test_the_test_sees_a_cell_that_fails() -> None:
    with pytest.raises(NameError):
        run_cell("x = 1\nunknown", {})
    assert run_cell("x = 1\nx + 1", {}) == 2
    assert run_cell("x = 1", {}) is None
