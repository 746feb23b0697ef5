"""`utak show`: the table with axes and names, of scenarios and of steps of episodes, as text and as a picture."""

from pathlib import Path
from xml.etree import ElementTree

import pytest

from utak.simulator.cli.main import main
from utak.simulator.scenario.picture import read_picture

WORLD = """\
bbbbbbbbbbbbbb
b............b
b.gg.........b
b.gg.....ddd.b
b........d.d.b
b...U....ddd.b
b............b
bbbbbbbbbbbbbb
"""


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    """Return a scenario with a movable thing and a fixed one."""
    folder = tmp_path / "scenario"
    folder.mkdir()
    (folder / "world.txt").write_text(WORLD)
    (folder / "start.lp").write_text("object(x). shape(x, square).")
    (folder / "goal.lp").write_text("at(x, corner(southeast)).")
    return folder


def test_a_world_is_shown_with_axes_names_and_places(scenario: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(scenario)]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert rows[:9] == [
        *("       " + row for row in WORLD.splitlines()[:2]),
        "     5 b.gg.........b",
        *("       " + row for row in WORLD.splitlines()[3:7]),
        "     0 bbbbbbbbbbbbbb",
        "       |0        |10",
    ]
    assert rows[9:] == [
        "U utak: POINT (4.5 2.5)",
        "g g1: x 2 to 4, y 4 to 6",
        "d d1: x 9 to 12, y 2 to 5, fixed",
    ]


def test_the_plain_form_is_that_of_a_world_file(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", str(scenario), "--plain"]) == 0
    (tmp_path / "world.txt").write_text(capsys.readouterr().out)
    assert read_picture(tmp_path / "world.txt") == read_picture(scenario / "world.txt")


@pytest.mark.long
def test_a_step_is_shown_with_what_is_believed_upon_it(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    episode, picture = tmp_path / "ep.jsonl", tmp_path / "step.svg"
    main(["run", str(scenario), "--log", str(episode), "--max-steps", "3"])
    capsys.readouterr()
    assert main(["show", str(episode)]) == 0
    last = capsys.readouterr().out
    assert main(["show", str(episode), "--at", "0"]) == 0
    first = capsys.readouterr().out
    assert first != last
    assert "g g1: x 2 to 4, y 4 to 6" in first
    assert main(["show", str(episode), "--at", "0", "--svg", str(picture)]) == 0
    drawn = picture.read_text()
    ElementTree.fromstring(drawn)
    assert ">g1</text>" in drawn
    assert 'style="fill:none;stroke:#c8322b' in drawn  # the believed boundary of a thing
    assert main(["show", str(scenario), "--svg", str(picture)]) == 0  # its own kind of file is overwritten
    assert "stroke:#c8322b" not in picture.read_text()
    assert main(["show", str(episode), "--at", "99"]) == 65
    assert main(["show", str(scenario), "--at", "0"]) == 2
    assert main(["show", str(scenario), "--svg", str(scenario / "goal.lp")]) == 66
