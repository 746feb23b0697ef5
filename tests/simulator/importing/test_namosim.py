"""NAMOSIM scenarios: outlines lie where a reading of their own here puts them; hostile XML is refused."""

import math
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from utak.simulator.cli.main import main
from utak.simulator.scenario.scenario import Scenario, read_scenario

pytest.importorskip("svg.path")

from utak.simulator.importing.svg_outlines import SvgError, parse_transform, rings_of

MAX_SECONDS = 30.0  # seconds of processor time: many times what linear reading takes, far less than quadratic one
SHARED = Path("/work/shared/data/namosim")
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 120 90">\n'
CONFIG = '<namo_config cell_size_cm="5"><agent agent_id="r"><goal goal_id="g"/></agent></namo_config>\n'
WALL = '<path id="w" type="wall" d="M 0,0 H 120 V 5 H 0 Z"/>\n'
BOX = '<path id="box" type="movable" d="m 60,30 h 15 v 15 h -15 z"/>\n'
ROBOT = '<path id="r" type="shape" d="m 30,40 h 10 v 10 h -10 z"/>\n'
GOAL = '<path id="g" type="shape" d="m 100,70 h 10 v 10 h -10 z"/>\n'
WHOLE = HEAD + CONFIG + WALL + BOX + ROBOT + GOAL + "</svg>\n"


def imported(text: str | bytes, folder: Path, *options: str) -> Scenario:
    """Return the scenario that `utak import` makes of a file."""
    path = folder / "a.svg"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert main(["import", str(path), str(folder / "s"), "--force", *options]) == 0
    assert main(["check", str(folder / "s")]) == 0
    return read_scenario(folder / "s")


@pytest.mark.parametrize("scale", [1, 2])
def test_walls_obstacles_robot_and_goal_lie_in_their_places(scale: int, tmp_path: Path) -> None:
    scenario = imported(WHOLE, tmp_path, "--scale", str(scale))
    world = scenario.world
    cells = 24 * scale, 18 * scale
    assert (world.width, world.height) == (cells[0] + 2, cells[1] + 2)
    floor = shapely.box(1, 1, 1 + cells[0], 1 + 17 * scale)
    assert world.verge.symmetric_difference(shapely.box(0, 0, world.width, world.height).difference(floor)).area < 1e-9
    box = shapely.box(1 + 12 * scale, 1 + 9 * scale, 1 + 15 * scale, 1 + 12 * scale)
    assert world.movable[0].polygon.symmetric_difference(box).area < 1e-9
    assert world.utak == (1 + 7 * scale, 1 + 9 * scale)
    marker = world.fixed[0].polygon
    assert marker.equals(shapely.box(1 + 21 * scale, 1 + 3 * scale, 2 + 21 * scale, 2 + 3 * scale))
    assert [str(goal) for goal in scenario.task.goals] == ["at(utak,x)"]
    assert scenario.expectations is not None
    assert str(scenario.expectations[0]).startswith("near(utak,")


@pytest.mark.parametrize("place", ["101.3,68.2", "97,71", "104.9,60.01"])
def test_the_marker_of_a_goal_lies_on_the_grid(place: str, tmp_path: Path) -> None:
    scenario = imported(WHOLE.replace("m 100,70", f"m {place}"), tmp_path)
    x, y = (float(part) for part in place.split(","))
    marker = scenario.world.fixed[0].polygon
    assert all(float(side).is_integer() for side in marker.bounds)
    assert marker.covers(shapely.Point(1 + (x + 5) / 5, 1 + (90 - y - 5) / 5))


@pytest.mark.long
def test_outlines_of_a_file_have_a_bounded_number_of_points(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arcs = "<path d='M 0 0 " + "a 1e5 1e5 0 1 1 0 .1 " * 300 + "z'/>"
    (tmp_path / "a.svg").write_text(WHOLE.replace(WALL, WALL + arcs * 15))
    assert main(["import", str(tmp_path / "a.svg"), str(tmp_path / "s")]) == 65
    assert "more than 1000000 points" in capsys.readouterr().err


def test_a_goal_under_something_is_a_corner(tmp_path: Path) -> None:
    scenario = imported(WHOLE.replace("m 100,70", "m 62,32"), tmp_path)
    assert [str(goal) for goal in scenario.task.goals] == ["at(utak,corner(northeast))"]
    assert not scenario.world.fixed
    assert scenario.expectations is None


def test_groups_may_be_moved_and_turned(tmp_path: Path) -> None:
    shape = ROBOT.replace('id="r"', 'id="inner"')
    group = f'<g id="r" transform="translate(60 20) rotate(90, 5, 5)">{shape}</g>'
    scenario = imported(WHOLE.replace(ROBOT, group), tmp_path)
    x, y = 60 + 5 - (45 - 5), 20 + 5 + (35 - 5)  # (35, 45) turned by 90 degrees about (5, 5), then moved
    assert scenario.world.utak == pytest.approx((1 + x / 5, 1 + (90 - y) / 5))


def test_other_shapes_are_outlines_too(tmp_path: Path) -> None:
    shapes = '<rect type="movable" x="60" y="30" width="15" height="15"/><circle id="g" cx="105" cy="75" r="5"/>'
    shapes += '<polygon type="wall" points="10,80 20,80 20,85"/><ellipse id="r" cx="35" cy="45" rx="3" ry="4"/>'
    scenario = imported(HEAD + CONFIG + WALL + shapes + "</svg>", tmp_path)
    whole = imported(WHOLE, tmp_path)
    assert scenario.world.movable[0].polygon.symmetric_difference(whole.world.movable[0].polygon).area < 1e-9
    assert scenario.world.utak == pytest.approx(whole.world.utak, abs=1e-3)
    assert scenario.world.verge.area == pytest.approx(whole.world.verge.area + 1)


def test_a_wall_with_a_hole_has_floor_in_it(tmp_path: Path) -> None:
    ring = "M 80,10 h 30 v 30 h -30 z M 85,15 v 20 h 20 v -20 z"
    scenario = imported(WHOLE.replace("</svg>", f'<path type="wall" d="{ring}"/></svg>'), tmp_path)
    assert not scenario.world.verge.contains(shapely.Point(20, 14))
    assert scenario.world.verge.area == pytest.approx(imported(WHOLE, tmp_path).world.verge.area + (900 - 400) / 25)


@pytest.mark.skipif(not SHARED.exists(), reason="the public scenarios are not here")
@pytest.mark.parametrize("path", sorted(SHARED.glob("*.svg")), ids=lambda path: path.stem)
def test_public_scenarios_are_imported(path: Path, tmp_path: Path) -> None:
    scenario = imported(path.read_bytes(), tmp_path)
    root = ET.parse(path).getroot()
    cell = float(root.find(".//{*}namo_config").get("cell_size_cm"))
    left, top, width, height = (float(word) for word in root.get("viewBox").split())
    paths = {one.get("id"): one for one in root.iter() if one.tag.endswith("path")}
    movable = [one for one in paths.values() if one.get("type") == "movable"]
    assert len(scenario.world.movable) == len(movable)
    assert scenario.world.width == math.ceil(width / cell) + 2
    for one, thing in zip(movable, scenario.world.movable, strict=True):
        corners = [(1 + (x - left) / cell, 1 + (top + height - y) / cell) for x, y in corners_of(one.get("d"))]
        assert thing.polygon.symmetric_difference(shapely.Polygon(corners)).area < 1e-6
    assert not scenario.world.verge.contains(shapely.Point(scenario.world.utak))
    wall = [one for one in paths.values() if one.get("type") == "wall"]
    for one in wall:
        corners = [(1 + (x - left) / cell, 1 + (top + height - y) / cell) for x, y in corners_of(one.get("d"))]
        assert shapely.Polygon(corners).difference(scenario.world.verge).area < 0.06  # obstacles are cut out


def corners_of(data: str) -> list[tuple[float, float]]:
    """Return the corners of a path of straight lines, read with complex numbers."""
    here, found, letter = 0j, [], ""
    words = re.findall(r"[A-Za-z]|-?[\d.]+(?:e-?\d+)?", data)
    while words:
        letter = words.pop(0) if words[0].isalpha() else letter
        if letter in "zZ":
            continue
        first = float(words.pop(0))
        if letter in "hH":
            here = first + 1j * here.imag if letter == "H" else here + first
        elif letter in "vV":
            here = here.real + 1j * first if letter == "V" else here + 1j * first
        else:
            point = first + 1j * float(words.pop(0))
            here = point if letter in "ML" else here + point
        found.append((here.real, here.imag))
    return found


WRONG = {  # a file, the text at the place of the message (the begin of the file for ''), and a word of it
    "nothing": ("", "", "no XML"),
    "a text": ("hello", "", "no XML"),
    "another picture": ('<svg viewBox="0 0 1 1"/>', "", "namo_config"),
    "no view box": (WHOLE.replace("viewBox", "viewbox"), "", "viewBox"),
    "a view box of three": (WHOLE.replace("0 0 120 90", "0 120 90"), "0 120 90", "viewBox"),
    "a view box of nothing": (WHOLE.replace("0 0 120 90", "0 0 0 90"), "0 0 0 90", "viewBox"),
    "a cell of 0": (WHOLE.replace('cm="5"', 'cm="0"'), '0"><agent', "cell_size_cm"),
    "cells too small": (WHOLE.replace('cm="5"', 'cm="0.01"'), "0.01", "4096"),
    "no robot": (WHOLE.replace('agent_id="r"', 'agent_id="q"'), 'q"><goal', "'q'"),
    "no agent": (WHOLE.replace("agent", "tenant"), "<namo_config", "no agent"),
    "half a path": (WHOLE.replace("h 15 v", "h v"), "m 60,30 h v", "wrong numbers"),
    "a path of letters": (WHOLE.replace("h 15 v", "k 15 v"), "m 60,30 k", "'k'"),
    "an outline that crosses itself": (WHOLE.replace("h 15 v 15 h -15", "h 15 l -15,15 h 15"), "m 60,30 h", "crosses"),
    "an outline of a line": (WHOLE.replace("h 15 v 15 h -15", "h 15"), "m 60,30 h", "three points"),
    "an obstacle in a wall": (WHOLE.replace("m 60,30", "m 60,0"), "m 60,0", "overlaps a wall"),
    "an obstacle beyond": (WHOLE.replace("m 60,30", "m 117,30"), "m 117,30", "beyond"),
    "two obstacles in one place": (WHOLE.replace(BOX, BOX + BOX.replace("60", "61")), "m 61,30", "overlaps another"),
    "an obstacle with a hole": (WHOLE.replace("h -15 z", "h -15 z m 5,5 v 5 h 5 v -5 z"), "m 60,30", "without holes"),
    "a robot beyond": (WHOLE.replace("m 30,40", "m 300,40"), "m 300,40", "beyond"),
    "a robot in a wall": (WHOLE.replace("m 30,40", "m 30,-4"), "", "inside the verge"),
    "a transform of words": (WHOLE.replace('="wall"', '="wall" transform="turn(1)"'), "turn(1)", "turn"),
    "an endless number": (WHOLE.replace("M 0,0", "M 1e999,0"), "M 1e999", "numbers"),
    "an endless view box": (WHOLE.replace("0 0 120 90", "0 0 1e999 10"), "0 0 1e999 10", "viewBox"),
    "an endless cell": (WHOLE.replace('cm="5"', 'cm="1e-320"'), "1e-320", "cell_size_cm"),
    "a skew of a quarter turn": (WHOLE.replace('="wall"', '="wall" transform="skewX(90)"'), "skewX", "stretches"),
    "stretched and stretched": (
        WHOLE.replace(WALL, '<g transform="scale(1e9)"><g transform="scale(1e8)">' * 20 + WALL + "</g>" * 40),
        "scale(1e8)",
        "stretches",
    ),
    "stretched in one": (WHOLE.replace('="wall"', '="wall" transform="scale(1e9) scale(1e9)"'), "scale", "stretches"),
    "moved far away": (WHOLE.replace('="wall"', '="wall" transform="translate(1e9)"'), "M 0,0", "squares away"),
    "a pin of an arc": (WHOLE.replace("h 15 v 15 h -15", "A1e9 1e-9 0 0 1 9 9"), "m 60,30", "numbers"),
    "an entity": (f'<!DOCTYPE svg [<!ENTITY a "x">]>\n{WHOLE}', "[", "entities"),
    "an entity from outside": (f'<!DOCTYPE svg [<!ENTITY a SYSTEM "file:///etc/passwd">]>\n{WHOLE}', "[", "entities"),
    "an unknown entity": (WHOLE.replace('"box"', '"&boxes;"'), '<path id="&', "no XML"),
    "elements too deep": (HEAD + "<g>" * 63 + "<a/>" + "</g>" * 63 + "</svg>", "<a/>", "within each other"),
    "another encoding": (f'<?xml version="1.0" encoding="latin-1"?>\n{WHOLE}', "", "encoding"),
    "an element that is not closed": (WHOLE.replace("</svg>\n", ""), None, "no XML"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_scenario_is_refused_at_its_place(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, there, word = WRONG[name]
    path = tmp_path / "a.svg"
    path.write_text(text)
    assert main(["import", str(path), str(tmp_path / "s")]) == 65
    said = capsys.readouterr().err
    assert word in said
    before = text if there is None else text[: text.index(there)]
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    assert said.startswith(f"{path}:{line}:{column}-")


def test_a_document_type_from_outside_is_not_fetched(tmp_path: Path) -> None:
    doctype = '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">\n'
    assert imported(doctype + WHOLE, tmp_path).world == imported(WHOLE, tmp_path).world


NUMBERS = st.floats(-50, 50).map(lambda value: round(value, 3))
POINTS = st.tuples(NUMBERS, NUMBERS)


@settings(max_examples=60, deadline=None)
@given(begin=POINTS, control=st.lists(POINTS, min_size=3, max_size=3), cubic=st.booleans())
def test_chords_stay_near_a_bezier_curve(
    begin: tuple[float, float], control: list[tuple[float, float]], cubic: bool
) -> None:
    points = control if cubic else control[:2]
    data = f"M {begin[0]},{begin[1]} {'C' if cubic else 'Q'} " + " ".join(f"{x},{y}" for x, y in points) + " L 99 99"
    rings = rings_of(data, 0.05)
    assume(rings and len(rings[0]) > 2)
    chords = shapely.LineString(rings[0][:-1])
    for step in range(41):
        t, here = step / 40, [complex(*begin), *(complex(*point) for point in points)]
        while len(here) > 1:  # de Casteljau
            here = [a + (b - a) * t for a, b in pairwise(here)]
        assert chords.distance(shapely.Point(here[0].real, here[0].imag)) <= 0.05 + 1e-6


@settings(max_examples=60, deadline=None)
@given(
    middle=POINTS, rx=st.floats(1, 40), ry=st.floats(1, 40), tilt=st.floats(0, 180), first=st.floats(0, 6.28),
    turn=st.floats(0.1, 6.1), back=st.booleans(),
)  # fmt: skip
def test_chords_stay_near_an_arc(
    middle: tuple[float, float], rx: float, ry: float, tilt: float, first: float, turn: float, back: bool
) -> None:
    def at(angle: float) -> complex:
        point = complex(rx * math.cos(angle), ry * math.sin(angle))
        return point * complex(math.cos(math.radians(tilt)), math.sin(math.radians(tilt))) + complex(*middle)

    signed = -turn if back else turn
    begin, end = at(first), at(first + signed)
    flags = f"{int(turn > math.pi)}{int(not back)}"
    data = f"M {begin.real!r} {begin.imag!r} A {rx!r} {ry!r} {tilt!r} {flags} {end.real!r} {end.imag!r} L 999 999"
    chords = shapely.LineString(rings_of(data, 0.05)[0][:-1])
    for step in range(51):
        point = at(first + signed * step / 50)
        assert chords.distance(shapely.Point(point.real, point.imag)) <= 0.06


@pytest.mark.parametrize(
    ("text", "rings"),
    [
        ("M0,0L4,0 4,2z", [[(0, 0), (4, 0), (4, 2)]]),
        ("m1 1 2 0 0 2zm1,1h3v1z", [[(1, 1), (3, 1), (3, 3)], [(2, 2), (5, 2), (5, 3)]]),
        ("M.5.5-1-1 1e1,0", [[(0.5, 0.5), (-1, -1), (10, 0)]]),
        ("M0 0H1V1H0ZL5 5 6 0Z", [[(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 0), (5, 5), (6, 0)]]),
        ("M 0 0 H 1", []),
        ("", []),
    ],
)
def test_path_data_is_read_as_svg_says(text: str, rings: list[list[tuple[float, float]]]) -> None:
    assert [ring.tolist() for ring in rings_of(text, 0.1)] == [[list(point) for point in ring] for ring in rings]


@pytest.mark.parametrize("text", ["L 0 0 z", "M 0", "M 0 0 z 1", "M 0 0 A 1 1 0 2 0 1 1", "M 0 0 L", "M 0 0 k 1", "z"])
def test_path_data_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(SvgError):
        rings_of(text, 0.1)


@settings(max_examples=60, deadline=None)
@given(
    point=POINTS,
    parts=st.lists(
        st.sampled_from(
            [
                "translate(3,-2)",
                "rotate(30)",
                "rotate(90 1 2)",
                "scale(2)",
                "scale(1,-1)",
                "matrix(1 2 3 4 5 6)",
                "skewX(20)",
                "skewY(-10)",
            ]
        ),
        max_size=4,
    ),
)
def test_transforms_are_carried_out_from_the_last_to_the_first(point: tuple[float, float], parts: list[str]) -> None:
    def after(text: str, at: tuple[float, float]) -> tuple[float, float]:
        x, y, _ = parse_transform(text) @ [*at, 1]
        return x, y

    wanted = point
    for part in reversed(parts):
        wanted = after(part, wanted)
    assert after(" ".join(parts), point) == pytest.approx(wanted, rel=1e-9, abs=1e-6)
    assert after("rotate(90 1 2)", (2, 2)) == pytest.approx((1, 3))
    assert after("skewX(45)", (0, 1)) == pytest.approx((1, 1))


HOLE = "M 85,15 v 20 h 20 v -20 z"
OUTER = "M 80,10 h 30 v 30 h -30 z"
SAME_WAY = "M 85,15 h 20 v 20 h -20 z"
RULES = {  # what draws a frame 6 squares wide with a hole 4 wide, or without it
    "inner ring first": (f'<path type="wall" d="{HOLE} {OUTER}"/>', True),
    "rings that turn one way": (f'<path type="wall" d="{OUTER} {SAME_WAY}"/>', False),
    "rings that turn one way, inner first": (f'<path type="wall" d="{SAME_WAY} {OUTER}"/>', False),
    "even-odd": (f'<path type="wall" fill-rule="evenodd" d="{OUTER} {SAME_WAY}"/>', True),
    "even-odd in a style": (f'<path type="wall" style="fill:red; fill-rule: evenodd" d="{SAME_WAY} {OUTER}"/>', True),
    "even-odd on a group": (f'<g fill-rule="evenodd"><path type="wall" d="{OUTER} {SAME_WAY}"/></g>', True),
    "even-odd taken back": (
        f'<g fill-rule="evenodd"><path type="wall" fill-rule="nonzero" d="{OUTER} {SAME_WAY}"/></g>',
        False,
    ),
    "type on a group": (f'<g type="wall"><path d="{OUTER} {HOLE}"/></g>', True),
    "a transform in a style": (
        '<path type="wall" style="transform: translate(-5px, 3px) scale(.5)" transform="scale(9)" '
        'd="M 170,14 h 60 v 60 h -60 z M 180,24 v 40 h 40 v -40 z"/>',
        True,
    ),
    "an inner svg": (
        '<svg x="80" y="10" width="30" height="60" viewBox="0 0 6 6" preserveAspectRatio="xMidYMid">'
        '<path type="wall" transform="translate(0 -3)" d="M 0,0 h 6 v 6 h -6 z M 1,1 v 4 h 4 v -4 z"/></svg>',
        True,
    ),
    "use": (f'<defs><g id="f"><path d="{OUTER} {HOLE}"/></g></defs><use type="wall" xlink:href="#f" x="0"/>', True),
    "use of a symbol": (
        '<symbol id="f" viewBox="0 0 6 6"><path d="M 0,0 h 6 v 6 h -6 z M 1,1 v 4 h 4 v -4 z"/></symbol>'
        '<use type="wall" href="#f" x="80" y="10" width="30" height="30"/>',
        True,
    ),
    "units": ('<g type="wall"><rect x="60pt" y="10px" width="22.5pt" height="30"/></g>', False),
    "not displayed": (
        f'<g type="wall"><path d="{OUTER} {HOLE}"/><rect style="display:none" width="9" height="9"/></g>',
        True,
    ),
}


@pytest.mark.parametrize("name", RULES)
def test_what_is_filled_is_as_svg_says(name: str, tmp_path: Path) -> None:
    drawn, has_hole = RULES[name]
    verge = imported(WHOLE.replace("</svg>", f"{drawn}</svg>"), tmp_path).world.verge
    without = imported(WHOLE, tmp_path).world.verge
    frame = shapely.box(17, 11, 23, 17).difference(shapely.box(18, 12, 22, 16) if has_hole else shapely.Polygon())
    assert verge.symmetric_difference(without.union(frame)).area < 1e-9


NOTES = {
    "<style>path {fill-rule: evenodd}</style>": "Style sheets",
    '<g clip-path="url(#a)"/>': "clipped",
    '<svg width="3"/>': "inner svg",
}


@pytest.mark.parametrize("drawn", NOTES)
def test_what_is_not_heeded_is_told(drawn: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    imported(WHOLE.replace("</svg>", f"{drawn}</svg>"), tmp_path)
    assert NOTES[drawn] in capsys.readouterr().err


MANY = '<g id="a">' + '<use href="#b"/>' * 150 + '</g><g id="b">' + '<use href="#c"/>' * 150 + '</g><g id="c"/>'
UNBOUNDED = {  # small files that draw much, and what is said of them
    "draws itself": ('<g id="a"><use href="#a"/><use href="#a"/></g>', "elements are drawn within each other"),
    "a long chain": (
        "".join(f'<g id="a{n}"><use href="#a{n + 1}"/></g>' for n in range(99)) + '<g id="a99"/>',
        "elements are drawn within each other",
    ),
    "used again and again": (MANY, "elements are drawn"),
    "a long style that is used again": (
        f'<g id="a" style="{"x:y;" * 100_000}"/>' + '<use href="#a"/>' * 20,
        "characters of attributes are drawn",
    ),
    "a long word": (f'<g transform="{"a" * 400_000}"/>', "is no transform"),
}


@pytest.mark.parametrize("name", UNBOUNDED)
def test_a_file_takes_no_more_time_than_its_size_lets_expect(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawn, said = UNBOUNDED[name]
    (tmp_path / "a.svg").write_text(WHOLE.replace(WALL, f"{WALL}{drawn}"))
    began = time.process_time()
    assert main(["import", str(tmp_path / "a.svg"), str(tmp_path / "s")]) == 65
    assert time.process_time() - began < MAX_SECONDS
    assert said in capsys.readouterr().err


def test_a_missing_library_is_named(tmp_path: Path) -> None:
    """It is hidden from a process of its own."""
    (tmp_path / "a.svg").write_text(WHOLE)
    program = (
        "import sys; sys.modules['svg'] = None; sys.path.insert(0, sys.argv[1])\n"
        "from utak.simulator.cli.main import main; sys.exit(main(sys.argv[2:]))"
    )
    root = str(Path(__file__).parents[3])
    command = [sys.executable, "-c", program, root, "import", str(tmp_path / "a.svg"), str(tmp_path / "s")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert (done.returncode, done.stdout) == (66, "")
    assert "pip install" in done.stderr
    assert "svg.path" in done.stderr
