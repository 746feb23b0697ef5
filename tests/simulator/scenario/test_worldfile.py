"""world.lp and world.txt: the worlds that they state, and the errors that are refused."""

import random
import tempfile
from pathlib import Path

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.scenario.picture import draw, read_picture
from utak.simulator.scenario.scenario import read_any_world
from utak.simulator.scenario.worldfile import read_world
from utak.simulator.world.placing import touches_floor
from utak.simulator.world.world import World

TABLE = "table(10, 8).\n"
VERGE = 'verge("POLYGON ((0 0, 10 0, 10 8, 0 8, 0 0), (1 1, 9 1, 9 7, 1 7, 1 1))").\n'
UTAK = 'utak("POINT (2.5 2.5)", -90).\n'


def box(name: str, x: float, y: float, kind: str = "object", colour: str = "g", size: float = 2) -> str:
    return f'{kind}({name}, {colour}, "{shapely.box(x, y, x + size, y + size).wkt}").\n'


def world(folder: Path, *facts: str) -> World:
    (folder / "world.lp").write_text("".join(facts))
    return read_world(folder / "world.lp")


def test_a_world_has_the_contents_of_its_facts(tmp_path: Path) -> None:
    got = world(tmp_path, TABLE, VERGE, UTAK, box("t2", 4, 4), box("t1", 6, 4), box("p", 7, 1, "fixed", "h"))
    assert (got.width, got.height, got.utak, got.heading) == (10, 8, (2.5, 2.5), 270)
    assert [thing.name for thing in got.movable] == ["t1", "t2"]
    assert [(thing.name, thing.colour, thing.polygon.area) for thing in got.fixed] == [("p", "h", 4.0)]
    assert got.verge.area == 80 - 48


def test_touching_is_no_overlap(tmp_path: Path) -> None:
    assert len(world(tmp_path, TABLE, VERGE, UTAK, box("a", 4, 4), box("c", 6, 4), box("d", 7, 1)).movable) == 3
    assert world(tmp_path, TABLE, VERGE, 'utak("POINT (1 1)", 0).').utak == (1.0, 1.0)


SEAM = box("a", 4, 4) + box("c", 6, 4)
STANDS = {
    "in the open": ("", 2.5, 2.5, True),
    "in a corner of the floor": ("", 1, 1, True),
    "on the verge's edge": ("", 1, 3, True),
    "where two things meet the floor": (SEAM, 6, 4, True),
    "where two things meet at their corners": (box("a", 4, 4) + box("c", 6, 2), 6, 4, True),
    "in a gap that is wide enough to tell": (box("a", 4, 4) + box("c", 6.00001, 4), 6, 5, True),
    "on the table's rim": ("", 0, 3, False),
    "on the table's corner": ("", 10, 8, False),
    "on a seam": (SEAM, 6, 5, False),
    "on a seam with the verge": (box("a", 1, 4), 1, 5, False),
    "in a slit of no width": (box("a", 4, 4) + box("c", 6.0000000001, 4), 6, 5, False),
    "between four things": (SEAM + box("d", 4, 2) + box("e", 6, 2), 6, 4, False),
}


@pytest.mark.parametrize("case", STANDS)
def test_utak_stands_on_floor_or_on_its_edge(case: str, tmp_path: Path) -> None:
    things, x, y, stands = STANDS[case]
    facts = (TABLE, VERGE, f'utak("POINT ({x} {y})", 0).\n', things)
    if stands:
        assert world(tmp_path, *facts).utak == (x, y)
        return
    with pytest.raises(BadInputError, match="Utak stands where no floor is"):
        world(tmp_path, *facts)


squares = st.lists(st.integers(0, 5), min_size=36, max_size=36)


@settings(deadline=None, max_examples=60)
@given(squares, st.integers(0, 12), st.integers(0, 12))
def test_on_half_squares_utak_needs_a_square_of_floor(kinds: list[int], x: int, y: int) -> None:
    free = {(n % 6, n // 6) for n, kind in enumerate(kinds) if kind}
    shapes = [shapely.box(i, j, i + 1, j + 1) for i in range(6) for j in range(6) if (i, j) not in free]
    near = {(i, j) for i in ((x - 1) // 2, x // 2) for j in ((y - 1) // 2, y // 2)}
    assert touches_floor(shapely.Point(x / 2, y / 2), shapes, 6, 6) == bool(near & free)


BAD = {
    "no table": ((VERGE, UTAK), "the world has no table"),
    "no verge": ((TABLE, UTAK), "the world has no verge"),
    "no utak": ((TABLE, VERGE), "the world has no utak"),
    "two utaks": ((TABLE, VERGE, UTAK, UTAK), ":4:1-28: error: a second utak"),
    "size 0": (("table(0, 5).", VERGE, UTAK), "a table's width must be from 1 to 4096, not 0"),
    "size": (("table(5000, 5).", VERGE, UTAK), "from 1 to 4096, not 5000"),
    "overlap": ((TABLE, VERGE, UTAK, box("a", 4, 4), box("c", 5, 5)), ":5:14-50: error: c overlaps a by 1 squares"),
    "in verge": ((TABLE, VERGE, UTAK, box("a", 8, 4)), "a overlaps the verge by 2 squares"),
    "off table": ((TABLE, VERGE, UTAK, box("a", 9, 4)), "a reaches beyond the table: (9, 4) to (11, 6)"),
    "utak in object": ((TABLE, VERGE, UTAK, box("a", 2, 2)), ":3:6-22: error: Utak stands inside a"),
    "utak in verge": ((TABLE, VERGE, 'utak("POINT (0.5 3)", 0).'), "Utak stands inside the verge"),
    "utak off": ((TABLE, VERGE, 'utak("POINT (20 3)", 0).'), "Utak stands off the table"),
    "twice": ((TABLE, VERGE, UTAK, box("a", 4, 4), box("a", 6, 1)), "a second object a"),
    "reserved": ((TABLE, VERGE, UTAK, box("utak", 4, 4)), "utak is a reserved word"),
    "colour": ((TABLE, VERGE, UTAK, box("a", 4, 4, colour="b")), "colour b is the verge's"),
    "colour name": ((TABLE, VERGE, UTAK, box("a", 4, 4, colour="red")), "a single lower-case letter, not red"),
    "no floor": ((TABLE, 'verge("POLYGON ((0 0, 10 0, 10 8, 0 8, 0 0))").', UTAK), "there is no floor"),
    "bow tie": (
        (TABLE, VERGE, UTAK, 'object(a, g, "POLYGON ((4 4, 6 6, 6 4, 4 6, 4 4))").'),
        "crosses or touches itself",
    ),
    "line": ((TABLE, VERGE, UTAK, 'object(a, g, "LINESTRING (4 4, 6 6)").'), "a shape here is a POLYGON"),
    "number": ((TABLE, VERGE, UTAK, 'object(a, g, "POLYGON ((4 4, 6 x, 6 4, 4 4))").'), ":4:32-32: error"),
    "tiny": ((TABLE, VERGE, UTAK, box("a", 4, 4, size=0.001)), "a shape of no size"),
    "heading": ((TABLE, VERGE, 'utak("POINT (2 2)", north).'), "an angle in degrees must be an integer, not north"),
    "hole": (
        (TABLE, VERGE, UTAK, 'object(a, g, "POLYGON ((4 4, 7 4, 7 6, 4 6, 4 4), (5 5, 5.5 5, 5.5 5.5, 5 5))").'),
        "an object that can be moved has no holes",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_errors_of_a_world_are_reported(case: str, tmp_path: Path) -> None:
    facts, what = BAD[case]
    with pytest.raises(BadInputError) as caught:
        world(tmp_path, *facts)
    assert what in str(caught.value)


PICTURE = """\
bbbbbbbbb
b.......b
b.ggg.g.b
b.g.g...b
b.ggg.c.b
b..U..c.b
bbbbbbbbb
"""


def picture(folder: Path, text: str) -> World:
    (folder / "world.txt").write_text(text)
    return read_picture(folder / "world.txt")


def test_a_picture_is_a_world(tmp_path: Path) -> None:
    got = picture(tmp_path, PICTURE)
    assert (got.width, got.height, got.utak, got.heading) == (9, 7, (3.5, 1.5), 0)
    assert [(t.name, t.polygon.area, t.polygon.bounds) for t in got.movable] == [
        ("c1", 2.0, (6.0, 1.0, 7.0, 3.0)),
        ("g2", 1.0, (6.0, 4.0, 7.0, 5.0)),
    ]
    assert [(t.name, t.polygon.area, len(t.polygon.interiors)) for t in got.fixed] == [("g1", 8.0, 1)]
    assert len(got.movable[0].polygon.exterior.coords) == 5


def test_a_drawn_world_is_read_back_equal(tmp_path: Path) -> None:
    assert draw(picture(tmp_path, PICTURE)) == PICTURE


rows = st.integers(1, 7).flatmap(
    lambda width: st.lists(st.text("....bbgc", min_size=width, max_size=width), min_size=1, max_size=7)
)


@settings(deadline=None)
@given(rows, st.randoms(use_true_random=False))
def test_a_picture_is_drawn_as_it_was_read(rows: list[str], draw_from: random.Random) -> None:
    j, i = draw_from.randrange(len(rows)), draw_from.randrange(len(rows[0]))
    rows[j] = rows[j][:i] + "U" + rows[j][i + 1 :]
    text = "".join(f"{row}\n" for row in rows)
    with tempfile.TemporaryDirectory() as folder:
        got = picture(Path(folder), text)
    assert draw(got) == text
    assert all(thing.polygon.is_valid for thing in (*got.movable, *got.fixed))
    assert got.verge.area == text.count("b")


def test_a_picture_needs_no_verge(tmp_path: Path) -> None:
    assert picture(tmp_path, "...\n.U.\n...").verge.is_empty


BAD_PICTURES = {
    "": "the picture is empty",
    "bbb\nb.b\nbbb\n": "no Utak",
    "U.\n.U\n": ":2:2-2: error: a second Utak",
    "..\n...\n.U\n": ":2:1-3: error: 3 squares in this row, 2 in the first",
    "...\n\n.U.\n": ":2:1-1: error: 0 squares in this row",
    "..X\n.U.\n": ":1:3-3: error: 'X' is nothing that a picture knows",
    "..\t\n.U.\n": "3 squares in this row, 2 in the first",
}


@pytest.mark.parametrize("text", BAD_PICTURES)
def test_errors_of_a_picture_are_reported(text: str, tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as caught:
        picture(tmp_path, text)
    assert BAD_PICTURES[text] in str(caught.value)


def test_one_world_in_a_scenario(tmp_path: Path) -> None:
    with pytest.raises(CannotOpenError, match="neither"):
        read_any_world(tmp_path)
    world(tmp_path, TABLE, VERGE, UTAK)
    picture(tmp_path, PICTURE)
    with pytest.raises(BadInputError, match="two worlds"):
        read_any_world(tmp_path)
    with pytest.raises(CannotOpenError, match="no such folder"):
        read_any_world(tmp_path / "none")
    with pytest.raises(CannotOpenError, match="a scenario is a folder"):
        read_any_world(tmp_path / "world.lp")
