"""`utak routes`: the origin of points, and pictures of routes."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from benchmarks.engine.movingai import read_trips
from tests.tables import few
from utak.geometry import Screen
from utak.geometry.io.svg import draw, route_line_width
from utak.simulator.cli.main import main

MAP = "type octile\nheight 5\nwidth 8\nmap\n........\n.@@@@@@.\n....@...\n.@..@...\n.@......\n"
TRIPS = """\
version 1
0\tm.map\t8\t5\t0\t0\t7\t0\t7.00000000
0\tm.map\t8\t5\t0\t4\t0\t0\t4.00000000
0\tm.map\t8\t5\t2\t2\t3\t3\t1.41421356
0\tm.map\t8\t5\t3\t2\t5\t2\t6.00000000
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a map that differs from its mirror image, and with problems on it."""
    (tmp_path / "m.map").write_text(MAP)
    (tmp_path / "m.map.scen").write_text(TRIPS)
    return tmp_path


def routes(folder: Path, capsys: pytest.CaptureFixture[str], *more: str) -> tuple[int, list[dict[str, object]]]:
    code = main(["routes", str(folder / "m.map"), "-k", "1", "--json", *more])
    out = capsys.readouterr().out
    return code, json.loads(out)["routes"] if out else []


def test_origin_top_reads_points_as_scen_files_do(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    trips = read_trips(folder / "m.map.scen")
    lines = [line.split() for line in TRIPS.splitlines()[1:]]
    assert len(trips) == len(lines) == 4
    for trip, words in zip(trips, lines, strict=True):
        a, b, c, d = (int(word) + 0.5 for word in words[4:8])
        code, [top] = routes(folder, capsys, "--origin", "top", "--from", f"{a},{b}", "--to", f"{c},{d}")
        (ax, ay), (bx, by) = trip.start, trip.goal
        assert code == 0
        _, [bottom] = routes(folder, capsys, "--from", f"{ax},{ay}", "--to", f"{bx},{by}")
        assert top["length"] == bottom["length"]
        octile, length = float(words[8]), float(str(top["length"]))
        assert length <= octile + 1e-6  # the benchmark's routes turn by 45 degrees only, and keep away from corners
        if octile < 6.0 or octile > 6.5:  # the other routes are straight lines, equal in both
            assert length == pytest.approx(octile, abs=1e-6)
        points = np.array(top["points"])
        assert points[[0, -1]].tolist() == [[a, b], [c, d]]
        assert np.allclose(points[:, 1] + np.array(bottom["points"])[:, 1], 5.0)


def test_the_help_explains_the_origin_of_points(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["routes", "--help"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    for words in ("south-west corner, x goes east and y north", "x goes east and y SOUTH", ".scen"):
        assert words in said


def test_a_picture_has_a_legend(folder: Path) -> None:
    path = folder / "out.svg"
    ends = ["--origin", "top", "--from", "2.5,2.5", "--to", "6.5,3.5"]
    assert main(["routes", str(folder / "m.map"), "-k", "3", *ends, "--svg", str(path)]) == 0
    tree = ElementTree.fromstring(path.read_text())
    assert float(tree.get("width", "0")) >= 600
    words = [element.text or "" for element in tree.iter() if element.tag.endswith("text")]
    classes = [element.get("class") for element in tree.iter()]
    assert {"from (2.5, 2.5)", "to (6.5, 3.5)", "blocked", "skeleton", "pathgraph"} <= set(words)
    assert [word for word in words if re.fullmatch(r"1: length \d+\.\d{3}, clearance \S+", word)]
    assert [word for word in words if re.fullmatch(r"\d+ squares?; north is up", word)]
    assert classes.count("start") == classes.count("goal") == 2  # in the picture and in the legend
    assert classes.count("route") == sum(word[0].isdigit() and "length" in word for word in words)


def test_a_picture_without_a_way_shows_the_ends(tmp_path: Path) -> None:
    (tmp_path / "m.map").write_text("type octile\nheight 1\nwidth 3\nmap\n.@.\n")
    ends = ["--from", "0.5,0.5", "--to", "2.5,0.5", "--svg", str(tmp_path / "out.svg")]
    assert main(["routes", str(tmp_path / "m.map"), *ends]) == 1
    assert 'class="start"' in (tmp_path / "out.svg").read_text()


@pytest.mark.parametrize("side", few([3, 12, 64, 512], [3, 12]))
def test_lines_and_sizes_are_in_proportion(side: int) -> None:
    screen = Screen(np.ones((side, side), np.bool_))
    ends = (0.5, 0.5), (side - 0.5, side - 0.5)
    tree = ElementTree.fromstring(draw(screen, screen.routes(*ends, k=1), ends))
    assert 144 <= float(tree.get("height", "0")) <= 1100
    scale = min(48.0, 960 / side)
    for number in range(8):
        wide = route_line_width(number, 8, scale)
        assert wide * scale >= 1.5
        assert wide <= 0.25 or wide * scale <= 3.0


@pytest.mark.parametrize("secret", ["password: hunter2", "type octile\nheight 1\nwidth 8\nmap\nhunter2!\n"])
def test_a_link_out_of_the_folder_is_told_and_not_quoted(
    secret: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "elsewhere").mkdir()
    (folder / "elsewhere" / "secret").write_text(secret)
    (folder / "here").mkdir()
    (folder / "here" / "l.map").symlink_to(folder / "elsewhere" / "secret")
    assert main(["routes", str(folder / "here" / "l.map"), "--from", "1,1", "--to", "2,2"]) == 65
    said = capsys.readouterr().err
    assert "leads out of its folder" in said
    assert not any(word in said for word in ("password", "hunter", "'h'", "'p'"))
