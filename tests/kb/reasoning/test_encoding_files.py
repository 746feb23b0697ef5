"""Encodings are files or folders of files; numbers that an encoding states are read from it, and only from it."""

from pathlib import Path

import pytest

from utak.kb.perception.interpretation import (
    FELT_OBJECT_CONFIDENCE,
    LONGEST_OBJECT,
    SHORTEST_WALL,
    SURELY_VERGE,
    interpret_regions,
)
from utak.kb.perception.regions import Percept, Region
from utak.kb.reasoning.encodings import all_encodings, encoding_constant, encoding_files, encoding_path, encoding_text
from utak.kb.reasoning.solver import solve, solve_within


def test_a_folder_of_files_is_one_encoding(tmp_path: Path) -> None:
    folder = tmp_path / "steps"
    folder.mkdir()
    (folder / "b.lp").write_text("q(X) :- p(X).\n#show q/1.")
    (folder / "a.lp").write_text("#const most = 3.\n#defined p/1.\n")
    (folder / "notes.txt").write_text("no rules")
    assert [path.name for path in encoding_files(folder)] == ["a.lp", "b.lp"]
    assert encoding_text(folder) == "#const most = 3.\n#defined p/1.\n\nq(X) :- p(X).\n#show q/1."
    assert encoding_constant(folder, "most") == 3


def test_the_encoding_of_task_plans_is_solved_as_a_folder_and_known_by_its_name() -> None:
    path = encoding_path("task")
    assert path.is_dir() and path.stem == "task" and len(encoding_files(path)) > 4
    facts = ["horizon(1)", "thing(o1)", "place(o1,here)", "place(o1,p)", "goal(g1)", "fulfils(o1,p,g1)"]
    assert list(map(str, solve([path], facts) or ())) == ["occurs(carry(o1,p),0)"]


@pytest.mark.parametrize("name", ["", ".", "..", "task.lp", "tas", "task/carry", "/etc", "a\0b", "n" * 5000])
def test_what_is_no_encoding_is_not_found(name: str) -> None:
    with pytest.raises(FileNotFoundError, match="there is no encoding"):
        encoding_path(name)


def test_no_two_encodings_have_one_name() -> None:
    names = [path.stem for path in all_encodings()]
    assert sorted(set(names)) == names
    assert all(encoding_path(path.stem) == path for path in all_encodings())
    assert not encoding_files(Path(__file__)) and not encoding_files(Path(__file__).parent)


def test_a_constant_is_read_from_its_encoding(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("#const longest = 7.\np(longest).\n")
    assert encoding_constant(rules, "longest") == 7


def test_an_unknown_constant_is_refused(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("p(1).\n")
    with pytest.raises(KeyError, match=r"rules\.lp defines no constant longest"):
        encoding_constant(rules, "longest")


@pytest.mark.parametrize(
    ("extent", "verge"), [(SHORTEST_WALL, SURELY_VERGE), (LONGEST_OBJECT, 92), (LONGEST_OBJECT + 1, 95)]
)
def test_constants_agree_with_the_answers_of_the_interpretation(extent: int, verge: int) -> None:
    region = Region("r", True, 100, True, extent, 60)
    kinds = interpret_regions(Percept((region,), frozenset(), frozenset()))
    assert kinds.of("r", "verge") == verge
    felt = interpret_regions(Percept((region,), frozenset(), frozenset()), [("r", "g")])
    # What is longer than any object is verge, and a thing is in it.
    assert felt.of("r", "object") == (FELT_OBJECT_CONFIDENCE if extent <= LONGEST_OBJECT else 0)


def test_a_bounded_search_tells_the_best_so_far_where_it_does_not_end() -> None:
    things = [f"o{number}" for number in range(1, 6)]
    facts = ["horizon(7)", "place(utak,here)"]
    for number, thing in enumerate(things):
        facts += [f"thing({thing})", f"place({thing},here)", f"place({thing},p)", f"fulfils({thing},p,g{number})"]
        facts += [f"goal(g{number})", f"rank({thing},{number})", f"estimate({thing},here,p,{5 + number})"]
        facts += [f"refuted({number},{thing},here,p)", f"given({number},{things[number - 1]},here)"] * (number > 0)
    cut, whole = (solve_within([encoding_path("task")], facts, conflicts) for conflicts in (1, 100_000))
    assert not cut.proved and cut.atoms is not None
    assert whole.proved and [str(atom) for atom in whole.atoms or ()] == [
        f"occurs(carry({thing},p),{number})" for number, thing in enumerate(things)
    ]
