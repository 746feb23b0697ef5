"""`utak import`: folders, goals, formats and misuse."""

from codecs import BOM_UTF8
from pathlib import Path

import pytest

from benchmarks.malformations.imports import imports
from benchmarks.malformations.samples import SAMPLES
from utak.simulator.cli.main import main

for library in ("svg.path", "yaml", "PIL"):  # of the extra `import`
    pytest.importorskip(library)

PUZZLE = "A M0 G0\n. .  .\n"


@pytest.fixture
def puzzle(tmp_path: Path) -> Path:
    (tmp_path / "p.pwp").write_text(PUZZLE)
    return tmp_path / "p.pwp"


def test_a_folder_that_is_not_empty_is_left_alone_without_force(puzzle: Path, tmp_path: Path) -> None:
    folder = tmp_path / "s"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    assert main(["import", str(puzzle), str(folder)]) == 66
    assert [path.name for path in folder.iterdir()] == ["notes.txt"]
    assert main(["import", str(puzzle), str(folder), "--force"]) == 0
    assert (folder / "notes.txt").read_text() == "mine"


def test_force_replaces_another_scenario_whole(puzzle: Path, tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "s"
    (tmp_path / "a.map").write_bytes(SAMPLES[".map"])
    assert main(["import", str(puzzle), str(folder)]) == 0
    assert (folder / "expect.lp").exists()
    assert main(["import", str(tmp_path / "a.map"), str(folder), "--force"]) == 0
    assert not (folder / "expect.lp").exists()
    assert main(["check", str(folder)]) == 0


def test_force_follows_no_link(puzzle: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.lp").write_text("mine")
    (tmp_path / "s").mkdir()
    (tmp_path / "s" / "goal.lp").symlink_to(tmp_path / "mine.lp")
    assert main(["import", str(puzzle), str(tmp_path / "s"), "--force"]) == 0
    assert (tmp_path / "mine.lp").read_text() == "mine"


def test_a_file_in_the_place_of_the_folder_cannot_be_written(puzzle: Path) -> None:
    assert main(["import", str(puzzle), str(puzzle)]) == 66
    assert main(["import", str(puzzle.parent / "none.pwp"), str(puzzle.parent / "s")]) == 66
    assert main(["import", str(puzzle.parent), str(puzzle.parent / "s")]) == 2


def test_another_goal_replaces_that_of_the_file(puzzle: Path, tmp_path: Path) -> None:
    goal = "in(utak, room(next)). at(x0, corner(southwest))."
    assert main(["import", str(puzzle), str(tmp_path / "s"), "--goal", goal]) == 0
    assert (tmp_path / "s" / "goal.lp").read_text() == goal + "\n"
    assert not (tmp_path / "s" / "expect.lp").exists()


@pytest.mark.parametrize(
    ("goal", "place"),
    [
        ("at(utak, cornr(northeast)).", "1:10-25"),
        ("at(utak, nothing).", "1:10-16"),
        ("", "1:1-1"),
        ("at(utak", "1:7-7"),
        ("größe", "1:3-3"),
    ],
)
def test_a_wrong_goal_is_refused_at_its_place(
    goal: str, place: str, puzzle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["import", str(puzzle), str(tmp_path / "s"), "--goal", goal]) == 65
    assert capsys.readouterr().err.startswith(f"--goal:{place}: error: ")
    assert not (tmp_path / "s").exists()


@pytest.mark.parametrize(
    "options",
    ["--level 2", "--start 1,1", "--origin top", "--unknown floor", "--scale 1/2", "--scale 0", "--start x"],
)  # fmt: skip
def test_options_that_say_nothing_are_misuse(options: str, puzzle: Path, tmp_path: Path) -> None:
    assert main(["import", str(puzzle), str(tmp_path / "s"), *options.split()]) == 2
    assert not (tmp_path / "s").exists()


def test_an_unknown_format_is_misuse(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.jpg").write_bytes(b"")
    assert main(["import", str(tmp_path / "a.jpg"), str(tmp_path / "s")]) == 2
    assert ".pwp" in capsys.readouterr().err


@pytest.mark.parametrize("end", sorted(SAMPLES))
def test_links_out_of_the_folder_are_refused_when_untrusted(end: str, tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / f"file{end}").write_bytes(SAMPLES[end])
    (tmp_path / "in" / f"file{end}").symlink_to(tmp_path / f"file{end}")
    assert main(["import", str(tmp_path / "in" / f"file{end}"), str(tmp_path / "s"), "--untrusted"]) == 66


@pytest.mark.parametrize("end", sorted(SAMPLES))
def test_text_behind_a_link_is_not_shown(end: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "secret").write_text("root:secret:0\n")
    (tmp_path / "in" / f"file{end}").symlink_to(tmp_path / "secret")
    assert main(["import", str(tmp_path / "in" / f"file{end}"), str(tmp_path / "s")]) == 65
    assert "secret" not in capsys.readouterr().err.partition("error:")[2]


@pytest.mark.parametrize("end", sorted(set(SAMPLES) - {".pgm", ".yaml", ".yml"}))
def test_a_byte_order_mark_changes_nothing_and_utf_16_is_named(
    end: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A Sokoban level with such a mark lost its first row, because the row was taken for a comment."""
    (tmp_path / "a").mkdir()
    texts = []
    for mark in (b"", BOM_UTF8):
        (tmp_path / "a" / f"file{end}").write_bytes(mark + SAMPLES[end])
        assert main(["import", str(tmp_path / "a" / f"file{end}"), str(tmp_path / "s"), "--force"]) == 0
        texts.append([path.read_text() for path in sorted((tmp_path / "s").iterdir())])
    assert texts[0] == texts[1]
    (tmp_path / "a" / f"file{end}").write_text(SAMPLES[end].decode("latin-1"), encoding="utf-16")
    capsys.readouterr()
    assert main(["import", str(tmp_path / "a" / f"file{end}"), str(tmp_path / "s"), "--force"]) == 65
    assert "UTF-16" in capsys.readouterr().err


def test_text_of_an_image_beyond_the_folder_of_its_head_is_not_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "secret").write_text("root:secret:0\n")
    (tmp_path / "in" / "map.yaml").write_bytes(SAMPLES[".yaml"].replace(b"image: map.pgm", b"image: ../secret"))
    assert main(["import", str(tmp_path / "in" / "map.yaml"), str(tmp_path / "s")]) == 65
    error = capsys.readouterr().err
    assert "cannot be read" in error and "secret:" not in error.partition("error:")[2]


@pytest.mark.long
def test_malformed_files_are_imported_or_refused_with_a_place(tmp_path: Path) -> None:
    outcomes = imports(250, 11, tmp_path)
    assert [result for result in outcomes if result.startswith("!")] == []
    assert outcomes["accepted"] > 20
    assert outcomes["refused"] > 100


def test_what_was_imported_can_be_run(puzzle: Path, tmp_path: Path) -> None:
    assert main(["import", str(puzzle), str(tmp_path / "s")]) == 0
    assert main(["run", str(tmp_path / "s"), "--max-steps", "1"]) in (0, 1, 75)
