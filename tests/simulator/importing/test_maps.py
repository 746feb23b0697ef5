"""Moving AI maps and ROS maps: floor and walls are where readings of their own here find them."""

import io
import math
import os
import tracemalloc
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from utak.geometry.raster.contours import outline
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.source_text import Source
from utak.simulator.cli.main import main
from utak.simulator.importing.imported import ImportOptions
from utak.simulator.importing.raster import count_corners
from utak.simulator.scenario.scenario import Scenario, read_scenario
from utak.simulator.world.world import World

pytest.importorskip("yaml")
Image = pytest.importorskip("PIL.Image")

from utak.simulator.importing.ros_head import parse_head  # noqa: E402
from utak.simulator.importing.ros_map import cell_of, default_scale, grey_image  # noqa: E402
from utak.simulator.importing.ros_map import read as read_ros  # noqa: E402

MOVINGAI = Path("/work/shared/data/movingai")
YAML = (
    "image: map.pgm\nresolution: 0.1\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
)


def imported(path: Path, folder: Path, *options: str) -> Scenario:
    """Return the scenario that `utak import` makes of a map."""
    assert main(["import", str(path), str(folder), "--force", *options]) == 0
    assert main(["check", str(folder)]) == 0
    return read_scenario(folder)


def floor_of(world: World) -> np.ndarray:
    """Return the squares of a table whose middle no verge covers, (rows, columns) bool, row 0 in the NORTH."""
    y, x = np.mgrid[0 : world.height, 0 : world.width] + 0.5
    shapely.prepare(world.verge)
    return ~shapely.contains_xy(world.verge, x.ravel(), y.ravel()).reshape(y.shape)[::-1]


def drawn(text: str) -> np.ndarray:
    """Return where a drawing has floor, (rows, columns) bool, row 0 in the north."""
    return np.array([[mark in ".GS" for mark in row] for row in text.split("\n") if row])


def map_text(rows: str) -> str:
    """Return a Moving AI map with some rows."""
    lines = rows.split("\n")
    return f"type octile\nheight {len(lines)}\nwidth {len(lines[0])}\nmap\n{rows}\n"


ROWS = "@@@@@@@\n@....T@\n@.SW..@\n@@.G..@\n..@@@@."


@pytest.mark.parametrize("scale", [1, 3])
def test_a_map_is_imported_cell_by_cell(scale: int, tmp_path: Path) -> None:
    (tmp_path / "a.map").write_text(map_text(ROWS))
    world = imported(tmp_path / "a.map", tmp_path / "s", "--scale", str(scale)).world
    assert np.array_equal(floor_of(world), np.kron(drawn(ROWS), np.ones((scale, scale), bool)))


def test_smaller_squares_are_wall_where_a_cell_is(tmp_path: Path) -> None:
    rows = "....@\n....@\n....@\n....@\n@@@@@"
    (tmp_path / "a.map").write_text(map_text(rows))
    world = imported(tmp_path / "a.map", tmp_path / "s", "--scale", "1/2").world
    assert floor_of(world).astype(int).tolist() == [[0, 0, 0], [1, 1, 0], [0, 0, 0]]


@pytest.mark.parametrize(
    ("options", "place"),
    [
        ((), (1.5, 3.5)),
        (("--start", "2.5,1.5"), (2.5, 1.5)),
        (("--start", "5.2,2.9"), (5.5, 2.5)),
        (("--start", "0.5,4.5", "--origin", "top"), (0.5, 0.5)),
        (("--start", "1.1,1.4", "--origin", "top", "--scale", "2"), (2.5, 7.5)),
    ],
)
def test_the_robot_wakes_where_it_is_told(options: tuple[str, ...], place: tuple[float, float], tmp_path: Path) -> None:
    (tmp_path / "a.map").write_text(map_text(ROWS))
    scenario = imported(tmp_path / "a.map", tmp_path / "s", *options)
    assert scenario.world.utak == (place if options else scenario.world.utak)
    assert [str(goal) for goal in scenario.task.goals] == ["at(utak,corner(northeast))"]
    assert scenario.expectations is None
    assert floor_of(scenario.world)[::-1][int(scenario.world.utak[1]), int(scenario.world.utak[0])]


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    free=hnp.arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9))),
    scale=st.sampled_from(["1", "2", "1/2", "1/3"]),
)
def test_drawn_maps_are_imported_cell_by_cell(free: np.ndarray, scale: str, tmp_path: Path) -> None:
    (tmp_path / "a.map").write_text(map_text("\n".join("".join(".@"[not one] for one in row) for row in free)))
    count = Fraction(scale).denominator
    rows, columns = (-(-side // count) for side in free.shape)
    wanted = np.array(  # row 0 in the south
        [
            [
                all(
                    y < free.shape[0] and x < free.shape[1] and free[::-1][y, x]
                    for y in range(j * count, (j + 1) * count)
                    for x in range(i * count, (i + 1) * count)
                )
                for i in range(columns)
            ]
            for j in range(rows)
        ]
    )
    wanted = np.kron(wanted, np.ones((Fraction(scale).numerator,) * 2, bool))
    if not wanted.any():
        assert main(["import", str(tmp_path / "a.map"), str(tmp_path / "s"), "--force", "--scale", scale]) == 65
        return
    world = imported(tmp_path / "a.map", tmp_path / "s", "--scale", scale).world
    assert np.array_equal(floor_of(world)[::-1], wanted)
    assert wanted[int(world.utak[1]), int(world.utak[0])]


def test_a_large_map_becomes_facts(tmp_path: Path) -> None:
    rows = [["."] * 600 for _ in range(40)]
    for i in range(0, 600, 7):
        for j in range(i % 5, 40, 5):
            rows[j][i] = "@"
    text = "\n".join(map("".join, rows))
    (tmp_path / "a.map").write_text(map_text(text))
    world = imported(tmp_path / "a.map", tmp_path / "s").world
    assert (tmp_path / "s" / "world.lp").exists()
    assert np.array_equal(floor_of(world), drawn(text))


def test_a_large_map_without_walls_gets_a_border(tmp_path: Path) -> None:
    (tmp_path / "a.map").write_text(map_text("\n".join(["." * 600] * 3)))
    world = imported(tmp_path / "a.map", tmp_path / "s").world
    assert (world.width, world.height) == (602, 5)
    assert floor_of(world)[1:-1, 1:-1].all()


def test_a_large_map_of_countless_corners_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.map").write_text(map_text("\n".join(["@." * 300, ".@" * 300] * 100)))
    assert main(["import", str(tmp_path / "a.map"), str(tmp_path / "s")]) == 65
    assert "corners" in capsys.readouterr().err


@settings(max_examples=60, deadline=None)
@given(mask=hnp.arrays(bool, st.tuples(st.integers(1, 7), st.integers(1, 7))))
def test_corners_are_counted_as_rings_have_them(mask: np.ndarray) -> None:
    assert count_corners(mask) == sum(map(len, outline(mask)))


WRONG_STARTS = {"99,1": "not on the map", "0.5,3.5": "no floor", "-1,2": "not on the map"}


@pytest.mark.parametrize("start", WRONG_STARTS)
def test_a_start_on_no_floor_is_refused(start: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.map").write_text(map_text(ROWS))
    assert main(["import", str(tmp_path / "a.map"), str(tmp_path / "s"), f"--start={start}"]) == 65
    said = capsys.readouterr().err
    assert said.startswith(f"{tmp_path / 'a.map'}:1:1-1: error: ")
    assert WRONG_STARTS[start] in said


def test_a_table_too_large_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.map").write_text(map_text("." * 4097))
    assert main(["import", str(tmp_path / "a.map"), str(tmp_path / "s")]) == 65
    assert "4097 squares a side" in capsys.readouterr().err
    assert (
        main(["import", str(tmp_path / "a.map"), str(tmp_path / "s"), "--scale", "1/2"]) == 65
    )  # one row is half a square
    assert "no floor" in capsys.readouterr().err


@pytest.mark.long
@pytest.mark.skipif(not MOVINGAI.exists(), reason="the public maps are not here")
@pytest.mark.parametrize(
    "name", ["room-64-64-8", "random-64-64-10", "maze-128-128-2", "Paris_1_256", "warehouse-20-40-10-2-2"]
)
def test_public_maps_are_imported(name: str, tmp_path: Path) -> None:
    text = (MOVINGAI / f"{name}.map").read_text()
    world = imported(MOVINGAI / f"{name}.map", tmp_path / "s").world
    assert np.array_equal(floor_of(world), drawn(text.partition("map\n")[2]))


def pgm(values: np.ndarray, greatest: int, kind: str, comment: str = "") -> bytes:
    """Return a grey image as bytes. values : (rows, columns), row 0 in the north."""
    head = f"{kind}\n{comment}{values.shape[1]} {values.shape[0]}\n{greatest}\n".encode()
    if kind == "P2":
        return head + "\n".join(" ".join(map(str, row)) for row in values).encode() + b"\n"
    return head + values.astype(">u1" if greatest < 256 else ">u2").tobytes()


@st.composite
def images(draw: st.DrawFn) -> tuple[np.ndarray, int]:
    """Draw the values of an image and their greatest possible value."""
    greatest = draw(st.sampled_from([1, 15, 255, 256, 1000, 65535]))
    shape = draw(st.tuples(st.integers(1, 8), st.integers(1, 8)))
    return draw(hnp.arrays(np.int64, shape, elements=st.integers(0, greatest))), greatest


@settings(max_examples=60, deadline=None)
@given(image=images(), kind=st.sampled_from(["P2", "P5"]), comment=st.sampled_from(["", "# by hand\n", "#\n# 7 7\n"]))
def test_images_are_read_back(image: tuple[np.ndarray, int], kind: str, comment: str) -> None:
    values, greatest = image
    found = grey_image(Source("x.pgm", ""), pgm(values, greatest, kind, comment))
    assert np.allclose(found.values[::-1] / found.greatest, values / greatest, rtol=0, atol=0.5 / 255 + 1e-9)
    if greatest in (255, 65535):
        assert np.array_equal(found.values[::-1].astype(np.int64) * greatest, values * found.greatest)


@pytest.mark.parametrize("mode", ["L", "1", "P", "RGB", "RGBA", "LA"])
@pytest.mark.parametrize("form", ["PNG", "BMP"])
def test_other_images_are_the_same_map(mode: str, form: str) -> None:
    if form == "BMP" and mode in ("LA", "RGBA"):
        pytest.skip("no such image")
    raw, values = io.BytesIO(), np.array([[0, 255, 255], [255, 0, 0]], np.uint8)
    Image.fromarray(values).convert(mode).save(raw, form)
    found = grey_image(Source("x", ""), raw.getvalue())
    assert np.array_equal(found.values[::-1], values.astype(int) * 3)


def png(mode: str, size: tuple[int, int], colour: object) -> bytes:
    """Return a PNG image of one colour."""
    raw = io.BytesIO()
    Image.new(mode, size, colour).save(raw, "PNG")
    return raw.getvalue()


WRONG_IMAGES = {
    "another kind": png("L", (3, 3), 0).replace(b"IHDR", b"IHDX"),
    "nothing": b"",
    "no size": b"P5\n# end",
    "a size of words": b"P5\nten 4 255\n",
    "a width of 0": b"P5 0 4 255\n",
    "a value of 70000": b"P5 1 1 70000\n",
    "too few bytes": b"P5 2 2 255\n\x00\x00\x00",
    "too few numbers": b"P2 2 2 9\n1 2 3\n",
    "a number too great": b"P2 2 1 9\n1 10\n",
    "a negative number": b"P2 2 1 9\n-1 1\n",
    "an image too large": b"P5 90000 90000 255\n",
    "a bomb": png("1", (6000, 6000), 0),
    "20 MB behind a head of 1 x 1": b"P2 1 1 9\n" + b"# long\n" * 3_000_000,
    "half of a picture": png("L", (300, 300), 7)[:-40],
    "transparent": png("LA", (3, 3), (0, 9)),
    "PostScript": b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n",
}


@pytest.mark.parametrize("name", WRONG_IMAGES)
def test_what_is_no_image_is_refused(name: str) -> None:
    with pytest.raises(BadInputError, match=r"^x\.pgm:1:1-1: error: "):
        grey_image(Source("x.pgm", ""), WRONG_IMAGES[name])


WALL, FLOOR, UNKNOWN = 0, 254, 205
GREY = np.array(
    [
        [205, 205, 205, 205, 205, 205, 205, 205],
        [205, 0, 0, 0, 0, 0, 205, 205],
        [205, 0, 254, 254, 254, 0, 205, 205],
        [205, 0, 254, 0, 254, 205, 205, 205],
        [205, 0, 254, 254, 254, 0, 205, 205],
        [205, 0, 0, 0, 0, 0, 205, 205],
        [205, 205, 205, 205, 205, 205, 205, 205],
    ]
)


def ros_map(folder: Path, values: np.ndarray = GREY, yaml: str = YAML, greatest: int = 255, kind: str = "P5") -> Path:
    """Write a ROS map into a folder and return the path of its head."""
    (folder / "map.pgm").write_bytes(pgm(values, greatest, kind))
    (folder / "map.yaml").write_text(yaml)
    return folder / "map.yaml"


@pytest.mark.parametrize("kind", ["P2", "P5"])
def test_a_ros_map_is_imported_without_its_margin(kind: str, tmp_path: Path) -> None:
    world = imported(ros_map(tmp_path, kind=kind), tmp_path / "s").world
    assert floor_of(world).astype(int).tolist() == [
        [0, 0, 0, 0, 0],
        [0, 1, 1, 1, 0],
        [0, 1, 0, 1, 0],
        [0, 1, 1, 1, 0],
        [0, 0, 0, 0, 0],
    ]


def test_unknown_pixels_are_what_is_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = ros_map(tmp_path)
    imported(path, tmp_path / "s")
    assert "32 pixels are neither occupied nor free; they are verge" in capsys.readouterr().err
    world = imported(path, tmp_path / "t", "--unknown", "floor").world
    assert floor_of(world).tolist() == (GREY > 0).tolist()


MODES = [  # value of a pixel, lines of the head, and whether it is floor; with the thresholds 0.65 and 0.196
    (254, "", True), (0, "", False), (205, "", False), (206, "", True), (100, "", False),
    (254, "negate: 1\n", False), (0, "negate: 1\n", True), (0, "negate: true\n", True),
    (0, "mode: raw\n", True), (19, "mode: raw\n", True), (20, "mode: raw\n", False), (255, "mode: raw\n", False),
    (254, "mode: scale\n", True), (128, "mode: scale\n", False),
]  # fmt: skip


@pytest.mark.parametrize(("value", "lines", "free"), MODES)
def test_thresholds_and_modes_are_those_of_ros(value: int, lines: str, free: bool, tmp_path: Path) -> None:
    sure = 0 if "raw" in lines or "negate" in lines else 254  # a pixel that is floor in this mode
    values = np.array([[sure, sure, value]])
    path = ros_map(tmp_path, values, YAML.replace("negate: 0\n", "") + lines)
    assert floor_of(imported(path, tmp_path / "s").world)[-1].tolist() == [True, True, *[free]]


def test_sixteen_bits_count_by_their_greatest_value(tmp_path: Path) -> None:
    values = np.array([[65535, 0, 52685, 53000]])  # 52685 is 205 of 255
    found = read_ros(ros_map(tmp_path, values, greatest=65535), ImportOptions())
    assert found.world_text == "Ubb.\n"


@settings(max_examples=60, deadline=None)
@given(
    x=st.floats(-50, 50), y=st.floats(-50, 50), yaw=st.floats(-4, 4), i=st.floats(0, 100), j=st.floats(0, 100),
    resolution=st.floats(0.01, 1),
)  # fmt: skip
def test_places_of_the_map_frame_are_turned_and_moved(
    x: float, y: float, yaw: float, i: float, j: float, resolution: float
) -> None:
    head = parse_head(Source("m.yaml", f"image: a\nresolution: {resolution!r}\norigin: [{x!r}, {y!r}, {yaw!r}]\n"))
    turned = complex(i, j) * resolution * complex(math.cos(yaw), math.sin(yaw)) + complex(x, y)
    assert cell_of((turned.real, turned.imag), head) == pytest.approx((i, j), abs=1e-6 / resolution)


def test_the_start_is_in_metres_of_the_map_frame(tmp_path: Path) -> None:
    path = ros_map(tmp_path)
    world = imported(path, tmp_path / "s", "--start=-0.55,-1.75").world  # pixel (4, 2) from the south-west
    assert world.utak == (3.5, 1.5)  # one column and one row of margin are cut off
    turned = ros_map(tmp_path, yaml=YAML.replace("0.0]", f"{math.pi / 2}]"))
    world = imported(turned, tmp_path / "t", "--start", "-1.25,-1.55").world
    assert world.utak == (3.5, 1.5)


@pytest.mark.parametrize(("resolution", "scale"), [(0.05, "1/2"), (0.1, "1"), (0.02, "1/5"), (0.3, "3"), (0.11, "1")])
def test_a_square_has_about_a_tenth_of_a_metre(resolution: float, scale: str) -> None:
    assert default_scale(resolution) == Fraction(scale)


def test_the_image_may_be_named_instead_of_the_head(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = ros_map(tmp_path)
    beside = imported(tmp_path / "map.pgm", tmp_path / "s").world
    assert beside == imported(path, tmp_path / "t").world
    path.unlink()
    capsys.readouterr()
    (tmp_path / "map.pgm").write_bytes(pgm(np.full((6, 8), FLOOR), 255, "P5"))
    alone = imported(tmp_path / "map.pgm", tmp_path / "u").world
    assert "Without a .yaml" in capsys.readouterr().err
    assert (alone.width, alone.height) == (4, 3)  # 0.05 metres a pixel: two pixels are a square


HEADS = {
    "block list": YAML.replace("[-1.0, -2.0, 0.0]", "\n- -1.0\n- -2.0\n- 0.0"),
    "quotes and comments": "---\n# a map\n" + YAML.replace("map.pgm", '"map.pgm"  # the image') + "...\n",
    "single quotes, other keys, CRLF": ("extra: 1\n" + YAML.replace("map.pgm", "'map.pgm'")).replace("\n", "\r\n"),
    "an anchor, a tag, a list over lines": YAML.replace("[-1.0,", "[&x -1.0,\n ").replace("0.1\n", '!!str "0.1"\n'),
    "defaults": "image: map.pgm\nresolution: 1e-1\norigin: [-1, -2, 0]\n",
}


@pytest.mark.parametrize("name", HEADS)
def test_forms_of_a_head_are_the_same_map(name: str, tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    assert (
        imported(ros_map(tmp_path / "a", yaml=HEADS[name]), tmp_path / "s").world
        == imported(ros_map(tmp_path / "b"), tmp_path / "t").world
    )


WRONG_HEADS = {
    "no image": (YAML.replace("image", "imgae"), "1:1-1", "image"),
    "no resolution": (YAML.replace("resolution: 0.1\n", ""), "1:1-1", "resolution"),
    "a resolution of 0": (YAML.replace("0.1\n", "0\n"), "2:13-13", "resolution"),
    "a resolution of words": (YAML.replace("0.1\n", "fine\n"), "2:13-16", "resolution"),
    "an endless resolution": (YAML.replace("0.1\n", "1e999\n"), "2:13-17", "resolution"),
    "an origin of two numbers": (YAML.replace(", 0.0]", "]"), "3:9-20", "origin"),
    "an open list": (YAML.replace(", 0.0]", ""), "4:7-7", "expected ',' or ']'"),
    "a threshold of 7": (YAML.replace("0.65", "7"), "5:18-18", "occupied_thresh"),
    "thresholds that cross": (YAML.replace("0.196", "0.9"), "6:14-16", "above"),
    "an unknown mode": (YAML + "mode: trinery\n", "7:7-13", "mode"),
    "a key twice": (YAML + "negate: 1\n", "7:1-6", "twice"),
    "a list of itself": (YAML.replace("[-1.0", "&a [*a"), "3:9-26", "origin"),
    "a nested mapping": (YAML.replace("map.pgm", "{file: map.pgm}"), "1:8-22", "image"),
    "a mapping for a key": (YAML + "{a: 1}: 2\n", "7:1-6", "no key"),
    "a list": ("- 1\n", "1:1-1", "no head"),
    "nested too deeply": ("[" * 30_000, "1:1-1", "nested too deeply"),
    "a line that is none": (YAML + "hello\n", "8:1-1", "could not find expected ':'"),
    "bytes": ("\x00\x01\x02", "1:1-1", "not allowed"),
}


@pytest.mark.long
@pytest.mark.parametrize("name", WRONG_HEADS)
def test_what_is_no_head_is_refused_at_its_place(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    yaml, place, word = WRONG_HEADS[name]
    path = ros_map(tmp_path, yaml=yaml)
    assert main(["import", str(path), str(tmp_path / "s")]) == 65
    said = capsys.readouterr().err
    assert said.startswith(f"{path}:{place}: error: ")
    assert word in said


def test_images_beyond_the_folder_are_refused_when_untrusted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in").mkdir()
    ros_map(tmp_path)
    for named in ("../map.pgm", str(tmp_path / "map.pgm")):
        (tmp_path / "in" / "map.yaml").write_text(YAML.replace("map.pgm", named))
        path = tmp_path / "in" / "map.yaml"
        assert main(["import", str(path), str(tmp_path / "s"), "--force"]) == 0
        assert main(["import", str(path), str(tmp_path / "t"), "--untrusted"]) == 66
    (tmp_path / "in" / "map.yaml").write_text(YAML)
    (tmp_path / "in" / "map.pgm").symlink_to(tmp_path / "map.pgm")
    assert main(["import", str(tmp_path / "in" / "map.yaml"), str(tmp_path / "t"), "--untrusted"]) == 66
    assert "--untrusted refuses" in capsys.readouterr().err


def test_an_image_that_is_not_there_cannot_be_opened(tmp_path: Path) -> None:
    (tmp_path / "map.yaml").write_text(YAML)
    assert main(["import", str(tmp_path / "map.yaml"), str(tmp_path / "s")]) == 66
    os.mkfifo(tmp_path / "map.pgm")
    assert main(["import", str(tmp_path / "map.yaml"), str(tmp_path / "s")]) == 66


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    values=hnp.arrays(
        np.uint8, st.tuples(st.integers(1, 7), st.integers(1, 7)), elements=st.sampled_from([0, 205, 254])
    )
)
def test_drawn_ros_maps_are_imported_pixel_by_pixel(values: np.ndarray, tmp_path: Path) -> None:
    free = values == FLOOR
    assume(free.any())
    rows, columns = free.any(axis=1).nonzero()[0], free.any(axis=0).nonzero()[0]
    wanted = free[max(0, rows[0] - 1) : rows[-1] + 2, max(0, columns[0] - 1) : columns[-1] + 2]
    assert np.array_equal(floor_of(imported(ros_map(tmp_path, values), tmp_path / "s").world), wanted)


@pytest.mark.parametrize("resolution", ["0.000001", "0.0000152", "1e-6"])
def test_a_pixel_of_a_tiny_part_of_a_square_is_refused(
    resolution: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "m.yaml").write_text(YAML.replace("0.1\n", f"{resolution}\n"))
    (tmp_path / "map.pgm").write_bytes(b"P5 3 3 255\n" + b"\xfe" * 9)
    tracemalloc.start()
    code = main(["import", str(tmp_path / "m.yaml"), str(tmp_path / "s")])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert code == 65
    assert "1/64" in capsys.readouterr().err
    assert peak < 50_000_000


@pytest.mark.parametrize("image", ["a\0b.pgm", '"a\0b.pgm"', "a\x01.pgm"])
def test_control_characters_in_the_name_of_an_image_are_refused(
    image: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "m.yaml").write_text(YAML.replace("map.pgm", image))
    for more in ([], ["--untrusted"]):
        assert main(["import", str(tmp_path / "m.yaml"), str(tmp_path / "s"), *more]) == 65
        assert "m.yaml:1:" in capsys.readouterr().err
