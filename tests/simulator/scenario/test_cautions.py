"""`utak check` warns of what is no error and can hardly be meant, and of nothing else."""

from pathlib import Path

import pytest

from utak.simulator.cli.main import main

ROOT = Path(__file__).resolve().parents[3]
OFF = "POLYGON ((90 90, 99 90, 99 99, 90 90))"
L_WIDE = "POLYGON ((1 1, 5 1, 5 20, 1 20, 1 1))"


def warned(folder: Path, capsys: pytest.CaptureFixture[str], **files: str) -> list[str]:
    """Return the warnings about a scenario with some other files, each without its place and its source line."""
    scene = folder / "scene"
    scene.mkdir()
    for path in (ROOT / "examples" / "go_to_square_unseen").iterdir():
        (scene / path.name).write_text(path.read_text())
    for name, text in files.items():
        (scene / f"{name}.lp").write_text(text)
    assert main(["check", str(scene)]) == 0
    out, err = capsys.readouterr()
    assert out == f"{scene}: ok\n"
    return [line.split(" warning: ")[1] for line in err.splitlines() if " warning: " in line]


@pytest.mark.parametrize(
    ("expectation", "what"),
    [
        (f'inside(s1, "{OFF}").', ["the region lies off the table"]),
        (f'inside(utak, "{OFF}").', ["the region lies off the table"]),
        (f'visits(utak, "{OFF}").', ["the region lies off the table"]),
        ('near(s1, "POINT (46 9)", "1.9").', ["the region lies off the table"]),
        ('near(s1, "POINT (46 9)", 2).', []),
        ('inside(s1, "POLYGON ((1 1, 3 1, 3 20, 1 20, 1 1))").', ["the region is smaller than s1"]),
        ('inside(s1, "POLYGON ((43 1, 59 1, 59 20, 43 20, 43 1))").', ["the region is smaller than s1"]),
        (f'inside(s1, "{L_WIDE}").', []),
        ('inside(utak, "POLYGON ((1 1, 1.5 1, 1 1.5, 1 1))").', []),
    ],
)
def test_regions_where_nothing_can_be(
    expectation: str, what: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert warned(tmp_path, capsys, expect=expectation) == what


@pytest.mark.parametrize(("rest", "count"), [("", 1), (" then(at(utak, x)).", 0)])
def test_a_first_step_without_a_next_one(
    rest: str, count: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = warned(tmp_path, capsys, goal=f"first(in(utak, room(next))).{rest} at(utak, x).")
    assert found == ["a first step without a next one"] * count


def test_questions_that_nothing_answers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With the rules that trial.lp names the predicate is known."""
    asks = 'asks("large(X)", rows(2)). asks("object(X), not shape(X, square, 3)", yes). asks("shape(X, sqare, C)", no).'
    known = asks + ' rules("large.lp").'
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    unknown = "nothing answers this: unknown predicate large/1"
    found = warned(tmp_path / "one", capsys, trial=asks)
    assert found[0] == unknown and len(found) == 2 and "sqare" in found[1]
    assert warned(tmp_path / "two", capsys, trial=known, large="large(X) :- object(X).") == found[1:]
