"""The file of results: resumed, never mixed with another sweep's, and in the same order whatever the order of runs."""

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.sweep.results import PassingResults, ResultRow, RowForm, encode_row, open_results

KEYS = [("x", n) for n in range(6)]
HEADER = {"utak": "sweep", "version": 1, "plan": {"seeds": "0:6"}}
FORM = RowForm(HEADER, ("name", "seed"), KEYS, lambda row: "" if "value" in row else "it has no value")


def row(number: int) -> ResultRow:
    return {"name": "x", "seed": number, "value": number * 0.1}


def write(path: Path, numbers: list[int], **more: Any) -> bytes:
    """Append rows to a file and finish it; return its bytes."""
    results = open_results(path, FORM, **more)
    for number in numbers:
        results.append(row(number))
    results.finish()
    return path.read_bytes()


def test_rows_are_there_as_soon_as_they_are_appended(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    results = open_results(path, FORM)
    assert [json.loads(line) for line in path.read_text().splitlines()] == [HEADER]
    results.append(row(4))
    assert json.loads(path.read_text().splitlines()[-1]) == row(4)
    results.append(row(2))
    results.finish()
    assert [json.loads(line)["seed"] for line in path.read_text().splitlines()[1:]] == [2, 4]
    assert [each.name for each in tmp_path.iterdir()] == ["r.jsonl"]


@given(st.permutations(range(6)), st.integers(0, 6), st.integers(0, 400))
def test_any_order_and_any_cut_give_the_same_bytes(
    tmp_path_factory: pytest.TempPathFactory, order: list[int], before: int, cut: int
) -> None:
    folder = tmp_path_factory.mktemp("results")
    whole = write(folder / "whole.jsonl", list(range(6)))
    path = folder / "cut.jsonl"
    results = open_results(path, FORM)
    for number in order[:before]:
        results.append(row(number))
    killed = path.read_bytes()[:cut]  # as a kill leaves it: not sorted, the last line perhaps not complete
    results.finish()
    path.write_bytes(killed)
    complete = max(0, killed.count(b"\n") - 1)
    resumed = open_results(path, FORM)
    assert [key[1] for key in resumed.known] == order[:complete]
    for number in order:
        if ("x", number) not in resumed.known:
            resumed.append(row(number))
    resumed.finish()
    assert path.read_bytes() == whole


def test_a_finished_file_is_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    whole = write(path, list(range(6)))
    inode = path.stat().st_ino
    assert write(path, []) == whole
    assert path.stat().st_ino == inode


def test_the_mode_and_a_link_survive_the_ordering(tmp_path: Path) -> None:
    real, link = tmp_path / "real.jsonl", tmp_path / "link.jsonl"
    real.touch(mode=0o600)
    link.symlink_to(real)
    write(link, [5, 0])
    assert link.is_symlink() and real.stat().st_mode & 0o777 == 0o600
    assert b'"seed":0' in real.read_bytes().splitlines()[1]


def refusal(path: Path, contents: bytes) -> str:
    """Return the message about a file with such contents, which must be left as it is."""
    path.write_bytes(contents)
    with pytest.raises((BadInputError, CannotOpenError)) as caught:
        open_results(path, FORM)
    assert path.read_bytes() == contents
    return str(caught.value)


def test_results_of_something_else_are_refused_with_a_reason(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    other = encode_row({**HEADER, "plan": {"seeds": "0:7"}})
    assert 'r.jsonl:1:1-1: error: these are results of another sweep: seeds is "0:7" there and "0:6" here' in refusal(
        path, other
    )
    assert "begin anew" in refusal(path, other)
    assert "added is true there and absent here" in refusal(path, encode_row({**HEADER, "added": True}))
    assert "no file of results" in refusal(path, b"my poem\n")
    assert "no file of results" in refusal(path, b'{"utak":"episode"}\n')
    assert write(path, [1], force=True).count(b"\n") == 2


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        (b"{nonsense}", "no JSON"),
        (b"\xff\xfe", "no JSON"),
        (b"[" * 100_000, "no JSON"),
        (b"[1]", "a JSON object"),
        (b'{"name":"x","seed":9,"value":1}', "no run of this sweep"),
        (b'{"name":["x"],"seed":1,"value":1}', "no run of this sweep"),
        (b'{"seed":1,"value":1}', "no run of this sweep"),
        (b'{"name":"x","seed":0,"value":1}', "occurs twice"),
        (b'{"name":"x","seed":1}', "it has no value"),
    ],
)
def test_a_damaged_line_is_reported_with_its_number(tmp_path: Path, line: bytes, reason: str) -> None:
    contents = encode_row(HEADER) + encode_row(row(0)) + line + b"\n"
    message = refusal(tmp_path / "r.jsonl", contents)
    assert "r.jsonl:3:1-1: error: " in message and reason in message


def test_two_processes_do_not_write_to_one_file(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    first = open_results(path, FORM)
    with pytest.raises(CannotOpenError, match="another process is writing to it"):
        open_results(path, FORM)
    first.finish()


def test_a_stream_gets_rows_in_order_as_soon_as_possible(capsys: pytest.CaptureFixture[str]) -> None:
    results = open_results("-", FORM)
    seen = []
    for number in (1, 0, 2, 5, 4):
        results.append(row(number))
        seen.append([json.loads(line).get("seed") for line in capsys.readouterr().out.splitlines()])
    assert seen == [[None], [0, 1], [2], [], []]
    results.finish()
    assert [json.loads(line)["seed"] for line in capsys.readouterr().out.splitlines()] == [4, 5]


def test_without_a_file_rows_are_kept_in_memory_alone() -> None:
    results = open_results(None, FORM)
    results.append(row(3))
    results.finish()
    assert isinstance(results, PassingResults) and results.known == {("x", 3): row(3)}


def test_a_file_without_header_is_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    path.write_text('{"old": 1}\n{"old": 2}\n')
    with pytest.raises(CannotOpenError):
        open_results(path, FORM._replace(header=None))
    path.write_text('{"name": "x", "seed": 7}\n')
    results = open_results(path, FORM._replace(header=None))
    results.append(row(1))
    results.append(row(0))
    results.finish()
    assert [json.loads(line) for line in path.read_text().splitlines()] == [row(0), row(1)]


@pytest.mark.parametrize("header", [{**HEADER, "plan": "secret"}, {**HEADER, "plan": {"seeds": "secret"}}])
def test_nothing_is_quoted_of_what_a_link_leads_to(tmp_path: Path, header: ResultRow) -> None:
    """A link within its folder is read like the file itself."""
    home = tmp_path / "home"
    home.mkdir()
    for place, is_told in ((tmp_path / "far.jsonl", False), (home / "near.jsonl", True)):
        place.write_bytes(encode_row(header))
        link = home / f"link-{place.name}"
        link.symlink_to(place)
        with pytest.raises(BadInputError) as caught:
            open_results(link, FORM)
        assert str(link) in str(caught.value)
        assert ("secret" in str(caught.value)) == is_told
        assert ("leads out of its folder" in str(caught.value)) != is_told
