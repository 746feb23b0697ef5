"""Results: appended at once, gone on with after a kill, and never written into a file of another kind."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.sweep.results import ResultRow, Results

NAMES = ("name", "seed")


def row(number: int) -> ResultRow:
    return {"name": "x", "seed": number, "value": number * 0.1}


def opened(path: Path | str | None, force: bool = False) -> Results:
    return Results(path, NAMES, force, lambda row: "" if "value" in row else "it has no value")


def seeds(path: Path) -> list[int]:
    return [json.loads(line)["seed"] for line in path.read_text().splitlines()]


def test_rows_are_there_as_soon_as_they_are_appended(tmp_path: Path) -> None:
    results = opened(tmp_path / "r.jsonl")
    for number in (4, 2):
        results.append(row(number))
        assert seeds(tmp_path / "r.jsonl")[-1] == number
    results.close()
    assert results.known == {("x", number): row(number) for number in (2, 4)}


@given(st.permutations(range(6)), st.integers(0, 6), st.integers(0, 400))
def test_after_any_cut_what_is_missing_is_appended(
    tmp_path_factory: pytest.TempPathFactory, order: list[int], before: int, cut: int
) -> None:
    path = tmp_path_factory.mktemp("results") / "cut.jsonl"
    results = opened(path)
    for number in order[:before]:
        results.append(row(number))
    results.close()
    path.write_bytes(path.read_bytes()[:cut])  # as a kill leaves it: the last line is perhaps not complete
    complete = path.read_bytes().count(b"\n")
    resumed = opened(path)
    assert [seed for _, seed in resumed.known] == order[:complete]
    for number in order:
        if ("x", number) not in resumed.known:
            resumed.append(row(number))
    resumed.close()
    assert seeds(path) == order


def test_files_that_are_put_one_after_the_other_are_results(tmp_path: Path) -> None:
    for shard in (0, 1):
        results = opened(tmp_path / f"{shard}.jsonl")
        for number in range(shard, 6, 2):
            results.append(row(number))
        results.close()
    (tmp_path / "all.jsonl").write_bytes(b"".join((tmp_path / f"{n}.jsonl").read_bytes() for n in (1, 0, 1)))
    whole = opened(tmp_path / "all.jsonl")
    whole.close()
    assert sorted(seed for _, seed in whole.known) == list(range(6))


@pytest.mark.parametrize("contents", ["my poem\n", '{"utak":"episode"}\n', '{"name": "x"}\n', "{ my notes"])
def test_files_of_other_kinds_are_left_as_they_are(contents: str, tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    path.write_text(contents)
    with pytest.raises(CannotOpenError, match="no file of results"):
        opened(path)
    assert path.read_text() == contents
    anew = opened(path, force=True)
    anew.append(row(1))
    anew.close()
    assert seeds(path) == [1]


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        (b"{nonsense}", "no JSON"),
        (b"\xff\xfe", "no JSON"),
        (b"[" * 100_000, "no JSON"),
        (b"[1]", "no JSON object"),
        (b'{"name":["x"],"seed":1,"value":1}', "key"),
        (b'{"seed":1,"value":1}', "no JSON object of a run"),
        (b'{"name":"x","seed":1}', "it has no value"),
    ],
)
def test_a_damaged_line_is_reported_with_its_number(tmp_path: Path, line: bytes, reason: str) -> None:
    path = tmp_path / "r.jsonl"
    contents = json.dumps(row(0)).encode() + b"\n" + line + b"\n"
    path.write_bytes(contents)
    with pytest.raises(BadInputError, match=r"r\.jsonl:2:1-1: error: ") as caught:
        opened(path)
    assert reason in str(caught.value)
    assert path.read_bytes() == contents


def test_two_processes_do_not_write_to_one_file(tmp_path: Path) -> None:
    first = opened(tmp_path / "r.jsonl")
    with pytest.raises(CannotOpenError, match="another process is writing to it"):
        opened(tmp_path / "r.jsonl")
    first.close()


def test_nothing_is_quoted_of_what_a_link_leads_to(tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "far.jsonl").write_text(json.dumps(row(1)) + "\n" + '{"name": "secret"}\n')
    (tmp_path / "home" / "link.jsonl").symlink_to(tmp_path / "far.jsonl")
    with pytest.raises(BadInputError) as caught:
        opened(tmp_path / "home" / "link.jsonl")
    assert "link.jsonl:2" in str(caught.value)
    assert "secret" not in str(caught.value)
