"""Sokoban levels: walls, boxes and the robot lie where a reading of its own here finds them; boxes have storages."""

import itertools
import re
from pathlib import Path

import pytest
import shapely
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from utak.simulator.cli.main import main
from utak.simulator.importing.sokoban import _cheapest_owners
from utak.simulator.scenario.scenario import Scenario, read_scenario

BOXOBAN = Path("/work/shared/data/sokoban/boxoban_hard_000.txt")
LEVEL = """\
    #####
    #   #
    #$  #
  ###  $##
  #  $ $ #
### # ## #   ######
#   # ## #####  ..#
# $  $          ..#
##### ### #@##  ..#
    #     #########
    #######
"""


def imported(raw: str | bytes, folder: Path, *options: str, name: str = "level.xsb") -> Scenario:
    """Return the scenario that `utak import` makes of a level."""
    folder.mkdir(exist_ok=True)
    (folder / name).write_bytes(raw if isinstance(raw, bytes) else raw.encode())
    assert main(["import", str(folder / name), str(folder / "s"), "--force", *options]) == 0
    assert main(["check", str(folder / "s")]) == 0
    return read_scenario(folder / "s")


def marks_of(text: str) -> dict[tuple[int, int], str]:
    """Return the marks of a level, (column, row) from the south-west."""
    rows = [row for row in text.split("\n") if row.strip()]
    width = max(map(len, rows))
    return {(i, len(rows) - 1 - j): mark for j, row in enumerate(rows) for i, mark in enumerate(row.ljust(width))}


def check_against(text: str, scenario: Scenario, scale: int = 3) -> None:
    """Compare a scenario with a level, cell by cell, where the robot can get to; beyond it may be wall or floor."""
    marks = marks_of(text)
    world = scenario.world
    boxes = {thing.polygon.bounds for thing in world.movable}
    wanted = set()
    robot = next(cell for cell, mark in marks.items() if mark in "@+")
    inside, waiting = {robot}, [robot]
    while waiting:
        i, j = waiting.pop()
        for cell in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if marks.get(cell, "#") != "#" and cell not in inside:
                inside.add(cell)
                waiting.append(cell)
    for (i, j), mark in marks.items():
        square = shapely.box(i * scale, j * scale, (i + 1) * scale, (j + 1) * scale)
        covered = square.intersection(world.verge).area
        if mark == "#":
            assert covered == scale**2
        if (i, j) in inside or mark in "$*.@+":
            assert covered == 0
        if mark in "$*":
            wanted.add(square.bounds)
        if mark in "@+":
            assert square.contains(shapely.Point(world.utak))
    assert boxes == wanted
    assert not world.fixed
    check_goals(marks, scenario, scale)


def check_goals(marks: dict[tuple[int, int], str], scenario: Scenario, scale: int) -> None:
    """Each goal leads to the middle of another storage, and as many boxes have goals as can."""
    x, y = scenario.world.utak
    ends = [
        tuple(
            float(n) + here
            for n, here in zip(re.search(r"POINT \((\S+) ([^)]+)\)", str(goal)).groups(), (x, y), strict=True)
        )
        for goal in scenario.task.goals
    ]
    storages = {((i + 0.5) * scale, (j + 0.5) * scale) for (i, j), mark in marks.items() if mark in ".*+"}
    assert len(set(ends)) == len(ends) == min(len(storages), len(scenario.world.movable))
    assert {(round(a, 3), round(b, 3)) for a, b in ends} <= {(round(a, 3), round(b, 3)) for a, b in storages}
    colours = re.findall(r"colour\(x\d+,(\w)\)", " ".join(str(claim.fact) for claim in scenario.task.claims))
    assert len(set(colours)) == len(ends) or len(ends) > 25


@pytest.mark.parametrize("scale", [1, 3, 4])
def test_a_level_is_imported_cell_by_cell(scale: int, tmp_path: Path) -> None:
    check_against(LEVEL, imported(LEVEL, tmp_path, "--scale", str(scale)), scale)


def run_lengths(text: str) -> str:
    """Return a level run-length encoded, in one line."""
    rows = [row for row in text.split("\n") if row.strip()]
    return "|".join(
        "".join(
            f"{count if count > 1 else ''}{mark}"
            for mark, count in ((m, len(list(g))) for m, g in itertools.groupby(row))
        )
        for row in rows
    )


FORMS = {
    "with comments": f"; Level 1\n:: by nobody\n\n{LEVEL}Author: somebody\n",
    "CRLF": LEVEL.replace("\n", "\r\n"),
    "no line end": LEVEL.rstrip("\n"),
    "dashes for floor": LEVEL.replace(" ", "-"),
    "underscores for floor": LEVEL.replace(" ", "_"),
    "run-length encoded": run_lengths(LEVEL),
    "run-length encoded, an end of row at the end": run_lengths(LEVEL).replace(" ", "-") + "|\n",
    "a title beyond ASCII": "Größe 3\n\n" + LEVEL,
}


@pytest.mark.parametrize("name", FORMS)
def test_forms_of_a_level_are_the_same_world(name: str, tmp_path: Path) -> None:
    assert imported(FORMS[name], tmp_path / "b").world == imported(LEVEL, tmp_path / "a").world


def test_groups_in_brackets_are_repeated(tmp_path: Path) -> None:
    text = "8#|#2( $)@.+#|#6-#|8#".replace("+", ".")
    plain = "########\n# $ $@..#\n#------#\n########".replace("..#", "..#")
    assert imported(text, tmp_path / "a").world == imported(plain, tmp_path / "b").world


def test_levels_of_a_file_are_counted_from_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    two = f"{LEVEL}\n; 2\n#####\n#@$.#\n#####\n"
    assert len(imported(two, tmp_path / "a").world.movable) == 6
    assert "level 1 of 2" in capsys.readouterr().err
    assert len(imported(two, tmp_path / "b", "--level", "2").world.movable) == 1
    path = tmp_path / "a" / "level.xsb"
    assert main(["import", str(path), str(tmp_path / "c"), "--level", "3"]) == 65
    assert "no level 3: the file has 2" in capsys.readouterr().err


def test_boxes_on_storages_stay_and_the_ways_are_short(tmp_path: Path) -> None:
    scenario = imported("#########\n#* $ . @#\n#   #   #\n# $   . #\n#########\n", tmp_path)
    moved = []
    for goal, thing in zip(scenario.task.goals, sorted(scenario.world.movable, key=lambda one: one.name), strict=True):
        x, y = (float(n) for n in re.search(r"POINT \((\S+) ([^)]+)\)", str(goal)).groups())
        east, north = (
            x + scenario.world.utak[0] - thing.polygon.centroid.x,
            y + scenario.world.utak[1] - thing.polygon.centroid.y,
        )
        moved.append((round(east / 3), round(north / 3)))
    assert sorted(moved) == [(0, 0), (2, 0), (4, 0)]


@settings(max_examples=150, deadline=None)
@given(
    st.integers(1, 5).flatmap(
        lambda n: st.lists(st.lists(st.integers(0, 9), min_size=n, max_size=6), min_size=1, max_size=n)
    )
)
def test_the_assignment_is_the_cheapest_of_all(cost: list[list[int]]) -> None:
    width = min(map(len, cost))
    rows = [row[:width] for row in cost][:width]
    owner = _cheapest_owners(rows)
    assert sorted(owner.values()) == list(range(len(rows)))
    least = min(
        sum(rows[n][column] for n, column in enumerate(columns))
        for columns in itertools.permutations(range(width), len(rows))
    )
    assert sum(rows[row][column] for column, row in owner.items()) == least


LEVELS = ["#####\n#@$.#\n#####\n", "######\n#@ $.#\n######\n", "#######\n#@  $.#\n#######\n"]


@pytest.mark.long
@pytest.mark.parametrize("line", ["7", "#7", "*****", "-----", "# Level one", "## a heading, easy", "; 7", "Level 7"])
def test_what_stands_between_levels_is_no_row(line: str, tmp_path: Path) -> None:
    text = f"{line}\n" + "".join(f"{level}{line}\n" for level in LEVELS)
    for number, level in enumerate(LEVELS, 1):
        plain = imported(level, tmp_path / "a", "--force").world
        assert imported(text, tmp_path / "b", "--force", "--level", str(number)).world == plain


@st.composite
def drawn_levels(draw: st.DrawFn) -> str:
    """Draw a level within walls."""
    columns, rows = draw(st.integers(2, 7)), draw(st.integers(2, 6))
    cells = [[draw(st.sampled_from("   #$.*")) for _ in range(columns)] for _ in range(rows)]
    cells[draw(st.integers(0, rows - 1))][draw(st.integers(0, columns - 1))] = draw(st.sampled_from("@+"))
    flat = "".join(map("".join, cells))
    assume(any(mark in flat for mark in "$*") and any(mark in flat for mark in ".*+"))
    wall = "#" * (columns + 2)
    return "\n".join([wall, *(f"#{''.join(row)}#" for row in cells), wall]) + "\n"


@pytest.mark.long
@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(text=drawn_levels(), coded=st.booleans())
def test_drawn_levels_are_imported_cell_by_cell(text: str, coded: bool, tmp_path: Path) -> None:
    check_against(text, imported(run_lengths(text) if coded else text, tmp_path / "l", "--scale", "1"), 1)


WRONG = {
    "nothing": ("", "1:1-1", "no Sokoban level"),
    "a text": ("hello\nworld\n", "1:1-1", "no Sokoban level"),
    "no robot": ("#####\n# $.#\n#####\n", "1:1-1", "no robot"),
    "two robots": ("#####\n#@$.#\n#@  #\n#####\n", "3:2-2", "second robot"),
    "no box": ("#####\n#@ .#\n#####\n", "1:1-1", "no box"),
    "no storage": ("#####\n#@$ #\n#####\n", "1:1-1", "no storage"),
    "another letter": ("#####\n#@$x#\n#####\n", "2:4-4", "'x'"),
    "a bracket that nothing closes": ("5#|#@2($.#|5#\n", "1:13-13", "closes"),
    "a bracket that nothing opens": ("5#|#@$.)#|5#\n", "1:8-8", "opens"),
    "a number before nothing": ("5#|#@$.#|5#3\n", "1:12-12", "before nothing"),
    "a run too long": ("99999#\n", "1:5-5", "too long"),
    "runs of runs": ("9999(9999(#))\n", "1:12-12", "more than 4096"),
    "brackets too deep": ("(" * 9 + "#" + ")" * 9 + "\n", "1:9-9", "brackets"),
    "a tab": ("#####\n#@\t$.#\n#####\n", "2:3-3", "no square"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_level_is_refused_at_its_place(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, place, word = WRONG[name]
    path = tmp_path / "level.xsb"
    path.write_text(text)
    assert main(["import", str(path), str(tmp_path / "s")]) == 65
    said = capsys.readouterr().err
    assert said.startswith(f"{path}:{place}: error: ")
    assert word in said


@pytest.mark.skipif(not BOXOBAN.exists(), reason="the public levels are not here")
@pytest.mark.parametrize("number", [1, 2, 17, 500, 1000])
def test_public_levels_are_imported(number: int, tmp_path: Path) -> None:
    raw = BOXOBAN.read_bytes()
    text = raw.decode().split("\n; ")[number - 1].partition("\n")[2]
    check_against(text, imported(raw, tmp_path, "--level", str(number), name="levels.txt"))
