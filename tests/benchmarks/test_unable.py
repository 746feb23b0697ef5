"""Worlds in which the task cannot be done, and the table of what certificates show of them."""

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from benchmarks.certificates.unable import UnableRow, run_unable, unable_table, unable_worlds
from benchmarks.claims.asked import Asked, written

ROWS = [
    UnableRow("wide:1", "no door", "impossible", "", "accepted: impossible", False, 1.0),
    UnableRow("own_snug:6:11", "too narrow", "possible_if", "", "none: nothing shows it", False, 2.0),
]


@pytest.fixture(scope="module")
def worlds(tmp_path_factory: pytest.TempPathFactory) -> list[Asked]:
    return list(unable_worlds(1, 0, tmp_path_factory.mktemp("asked")))


def test_the_task_can_be_done_in_none_of_them(worlds: list[Asked], tmp_path: Path) -> None:
    assert len({world.kind for world in worlds}) >= 8
    assert {written(world, tmp_path).possible for world in worlds} == {"no"}


def test_the_table_tells_what_is_shown_by_kinds() -> None:
    lines = [line.split() for line in unable_table(ROWS).splitlines()]
    assert lines[1] == ["own_snug", "1", "0", "0", "1", "0", "0"]
    assert lines[2] == ["wide", "1", "1", "1", "0", "0", "0"]
    assert lines[3] == ["all", "2", "1", "1", "1", "0", "0"]


def test_worlds_that_a_file_has_are_not_run_again(
    worlds: list[Asked], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "rows.jsonl"
    output.write_text("".join(json.dumps(asdict(ROWS[0]) | {"world": world.name}) + "\n" for world in worlds))
    assert run_unable(1, 0, output) == 0
    assert len(output.read_text().splitlines()) == len(worlds)
    assert capsys.readouterr().out.splitlines()[-1].split()[1] == str(len(worlds))
