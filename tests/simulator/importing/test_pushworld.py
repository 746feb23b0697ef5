"""PushWorld puzzles: the world has walls, objects and the robot where the puzzle says, by a reading of its own here."""

import re
from fractions import Fraction
from pathlib import Path

import pytest
import shapely
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError
from utak.simulator.cli.main import main
from utak.simulator.importing.imported import ImportOptions
from utak.simulator.importing.pushworld import read
from utak.simulator.scenario.scenario import Scenario, read_scenario

SHARED = Path("/work/shared/data")
CONVERTED = {
    "Horizontal Separation",
    "Single Obstacle",
    "Small Wins",
    "Walk Past",
}  # puzzles that stand in both folders


def imported(text: str, folder: Path, *options: str) -> Scenario:
    """Return the scenario that `utak import` makes of a puzzle."""
    folder.mkdir(exist_ok=True)
    (folder / "puzzle.pwp").write_bytes(text.encode())
    assert main(["import", str(folder / "puzzle.pwp"), str(folder / "s"), *options, "--force"]) == 0
    assert main(["check", str(folder / "s")]) == 0
    return read_scenario(folder / "s")


def cells_of(text: str) -> dict[str, set[tuple[int, int]]]:
    """Return the cells of each part, (column, row) from the north-west."""
    found: dict[str, set[tuple[int, int]]] = {}
    for row, line in enumerate(text.split("\n")):
        for column, cell in enumerate(line.split()):
            for part in cell.upper().split("+"):
                found.setdefault(part, set()).add((column, row))
    return found


def squares(cells: set[tuple[int, int]], rows: int, scale: int) -> shapely.Geometry:
    """Return the squares of cells on the table: one square of verge lies about the puzzle."""
    boxes = [
        shapely.box(1 + i * scale, 1 + (rows - 1 - j) * scale, 1 + (i + 1) * scale, 1 + (rows - j) * scale)
        for i, j in cells
    ]
    return shapely.union_all(boxes)


def check_against(text: str, scenario: Scenario, scale: int = 3) -> None:
    """Compare a scenario with the puzzle it was made of, cell by cell."""
    cells = cells_of(text)
    lines = [line for line in text.split("\n") if line.strip()]
    rows, columns = len(lines), len(lines[0].split())
    world = scenario.world
    assert (world.width, world.height) == (columns * scale + 2, rows * scale + 2)
    inner = shapely.box(1, 1, world.width - 1, world.height - 1)
    walls = squares(cells.get("W", set()), rows, scale).union(
        shapely.box(0, 0, world.width, world.height).difference(inner)
    )
    assert world.verge.equals(walls)
    movable = {part: squares(where, rows, scale) for part, where in cells.items() if part[0] == "M"}
    assert len(world.movable) == len(movable)
    assert not world.fixed
    for shape in movable.values():
        assert sum(thing.polygon.equals(shape) for thing in world.movable) == 1
    robot = squares(cells["A"], rows, scale)
    assert robot.contains(shapely.Point(world.utak))
    assert shapely.Point(world.utak).distance(robot.centroid) <= 0.71
    check_goals(cells, movable, scenario, rows, scale)


def check_goals(
    cells: dict[str, set[tuple[int, int]]],
    movable: dict[str, shapely.Geometry],
    scenario: Scenario,
    rows: int,
    scale: int,
) -> None:
    """Compare the goals: the north-west corners of the object and of its goal must meet, in the robot's frame."""
    goals = sorted(part for part in cells if part[0] == "G")
    wanted = {}
    for part in goals:
        object_, goal = cells["M" + part[1:]], cells[part]
        shift = [min(cell[axis] for cell in goal) - min(cell[axis] for cell in object_) for axis in (0, 1)]
        middle = movable["M" + part[1:]].centroid
        wanted["x" + part[1:].lower()] = (
            middle.x + shift[0] * scale - scenario.world.utak[0],
            middle.y - shift[1] * scale - scenario.world.utak[1],
        )
    found = {}
    for goal in scenario.task.goals:
        name, x, y = re.fullmatch(r'pose\((\w+),"POINT \((\S+) (\S+)\)",0\)', str(goal)).groups()
        found[name] = (float(x), float(y))
    assert found.keys() == wanted.keys()
    for name, place in wanted.items():
        assert found[name] == pytest.approx(place, abs=1e-4)
    assert scenario.expectations is not None
    assert len(scenario.expectations) == len(goals)


PUZZLES = {
    "one goal": " .  W  .  W  W  .\n A  M0 M1 G0  W  .\n .  .  .  .  .  .\n",
    "a tee under a goal": "G2 . . .\n. M2 M2+G1 M2\nA . M2 .\nM1 . . .",
    "lower case and CRLF": "a . m0\r\n. w g0\r\n",
    "blank lines at the end": "A M0 G0\n\n  \n",
    "the robot on a goal": "A+G0 . M0\n",
}


@pytest.mark.parametrize("name", PUZZLES)
@pytest.mark.parametrize("scale", [1, 2, 3, 5])
def test_a_puzzle_is_imported_cell_by_cell(name: str, scale: int, tmp_path: Path) -> None:
    text = PUZZLES[name].replace("\r", "")
    check_against(text.strip("\n "), imported(PUZZLES[name], tmp_path, "--scale", str(scale)), scale)


def test_objects_that_touch_have_different_colours(tmp_path: Path) -> None:
    row = "A " + " ".join(f"M{n}" for n in range(60))
    scenario = imported(f"{row} G3\n", tmp_path, "--scale", "1")
    things = scenario.world.movable
    assert len(things) == 60
    for thing in things:
        for other in things:
            touching = thing is not other and thing.polygon.intersection(other.polygon).length > 0
            assert not (touching and thing.colour == other.colour)
    assert scenario.expectations is None  # 60 objects share 25 colours: nothing tells M3 from others


@st.composite
def drawn_puzzles(draw: st.DrawFn) -> str:
    """Draw a puzzle with walls, rectangles as objects, some with goals, and an agent."""
    columns, rows = draw(st.integers(3, 8)), draw(st.integers(3, 8))
    cells = {(i, j): draw(st.sampled_from([".", ".", ".", "W"])) for j in range(rows) for i in range(columns)}
    for number in range(draw(st.integers(1, 4))):
        i, j = draw(st.integers(0, columns - 1)), draw(st.integers(0, rows - 1))
        w, h = draw(st.integers(1, min(3, columns - i))), draw(st.integers(1, min(2, rows - j)))
        part = {(i + a, j + b) for a in range(w) for b in range(h)}
        if all(cells[cell] in (".", "W") for cell in part):
            cells |= dict.fromkeys(part, f"M{number}")
    free = sorted(cell for cell, what in cells.items() if what == ".")
    objects = sorted({what for what in cells.values() if what[0] == "M"})
    assume(free and objects)
    cells[draw(st.sampled_from(free))] = "A"
    for name in draw(st.sets(st.sampled_from(objects), min_size=1)):
        form = sorted(cell for cell, what in cells.items() if what.partition("+")[0] == name)
        i, j = draw(st.integers(0, columns - 1)), draw(st.integers(0, rows - 1))
        for a, b in form:
            there = (a - min(x for x, _ in form) + i, b - min(y for _, y in form) + j)
            assume(there in cells)
            cells[there] = f"{cells[there]}+G{name[1:]}".removeprefix(".+")
    return "\n".join(" ".join(cells[i, j] for i in range(columns)) for j in range(rows))


@pytest.mark.long
@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(text=drawn_puzzles(), scale=st.sampled_from([1, 3]))
def test_drawn_puzzles_are_imported_cell_by_cell(text: str, scale: int, tmp_path: Path) -> None:
    check_against(text, imported(text, tmp_path / "p", "--scale", str(scale)), scale)


WRONG = {  # a puzzle, the place of the message, and a word of it
    "empty": ("\n\n", "1:1-1", "empty"),
    "a row too short": ("A M0 G0\n. .\n", "2:1-3", "2 cells"),
    "an unknown part": ("A M0 G0\n. Q .\n", "2:3-3", "'q'"),
    "half a part": ("A M0+ G0\n", "1:6-6", "''"),
    "no agent": ("M0 G0\n", "1:1-1", "no agent"),
    "an agent of two cells": ("A A M0 G0\n", "1:3-3", "2 cells"),
    "a wall for the agent": ("A AW M0 G0\n", "1:3-4", "AW"),
    "a goal of nothing": ("A M0 G7\n", "1:6-7", "M7"),
    "no goal": ("A M0 .\n", "1:1-1", "no goal"),
    "two things in a cell": ("A M0+M1 G0\n", "1:6-7", "same cell"),
    "an object in a wall": ("A M0+W G0\n", "1:6-6", "same cell"),
    "an object in two parts": ("A M0 . M0 G0\n", "1:3-4", "parts"),
    "an object by a corner": ("A M0 .\n. . M0\nG0 . .\n", "1:3-4", "parts"),
    "an object about a cell": ("M0 M0 M0\nM0 . M0\nM0 M0 M0\nA G0 .\n", "1:1-2", "encloses"),
    "bytes that are no text": ("A M0 G0\n\xe9 . .\n", "2:1-2", "no part"),
    "a table too large": (". " * 2000 + "A M0 G0\n", "1:1-1", "4096"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_puzzle_is_refused_at_its_place(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, place, word = WRONG[name]
    path = tmp_path / "p.pwp"
    path.write_bytes(text.encode())
    assert main(["import", str(path), str(tmp_path / "s")]) == 65
    said = capsys.readouterr().err
    assert said.startswith(f"{path}:{place}: error: ")
    assert word in said
    assert not (tmp_path / "s").exists()


def test_problems_of_a_puzzle_are_named_together(tmp_path: Path) -> None:
    path = tmp_path / "p.pwp"
    path.write_text("A Q M0\n7 . G0\n")
    with pytest.raises(BadInputError) as caught:
        read(path, ImportOptions())
    assert [problem.span.line for problem in caught.value.problems] == [1, 2]


@pytest.mark.skipif(not (SHARED / "pwp").exists(), reason="the public puzzles are not here")
@pytest.mark.parametrize("path", sorted((SHARED / "pwp").glob("*.pwp")), ids=lambda path: path.stem)
def test_public_puzzles_are_imported(path: Path, tmp_path: Path) -> None:
    text = path.read_text()
    scenario = imported(text, tmp_path)
    check_against(text.strip("\n"), scenario)
    if path.stem in CONVERTED:
        other = read_scenario(next(SHARED.glob(f"pushworld/*_{path.stem.lower().replace(' ', '_')}")))
        assert scenario.world == other.world
        assert [
            float(number) for goal in scenario.task.goals for number in re.findall(r"-?[\d.]+(?=[ )])", str(goal))
        ] == [float(number) for goal in other.task.goals for number in re.findall(r"-?[\d.]+(?=[ )])", str(goal))]


def test_the_scale_is_a_whole_number(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "p.pwp").write_text("A M0 G0\n")
    for scale in ("1/2", "0", "65", "x", "2.5"):
        assert main(["import", str(tmp_path / "p.pwp"), str(tmp_path / "s"), "--scale", scale]) == 2
    assert read(tmp_path / "p.pwp", ImportOptions(scale=Fraction(4))).world_text.count("\n") == 6
    assert "Traceback" not in capsys.readouterr().err
