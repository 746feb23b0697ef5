"""Encodings are files or folders of files; numbers that an encoding states are read from it, and only from it."""

import re
from pathlib import Path

import pytest

from utak.kb.perception.interpretation import (
    LONGEST_OBJECT,
    interpret_regions,
    surest_kind,
)
from utak.kb.perception.regions import Percept, Region
from utak.kb.reasoning.encodings import (
    KB_ENCODINGS,
    SHARED_PARTS,
    all_encodings,
    encoding_constant,
    encoding_files,
    encoding_path,
    encoding_text,
)
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


def test_encodings_share_the_counted_priors_as_a_part_of_each() -> None:
    shared = [path.name for path in encoding_files(encoding_path("shapes"))]
    assert shared == ["shapes.lp", "priors.lp"]
    assert encoding_files(encoding_path("interpretation"))[1:] == encoding_files(encoding_path("shapes"))[1:]
    assert not {path.stem for path in all_encodings()} & SHARED_PARTS


def test_what_was_counted_is_never_certain() -> None:
    found = re.findall(r"^ +[^%]*, (\d+);?  % (\d+) / (\d+)$", (KB_ENCODINGS / "priors.lp").read_text(), re.MULTILINE)
    assert len(found) > 50
    for thousandths, true, of in (tuple(map(int, row)) for row in found):
        assert 0 < thousandths < 1000 and true <= of
        assert abs(thousandths - 1000 * (true + 1) / (of + 2)) <= 1


@pytest.mark.parametrize("mass", [0, 4, 5, 29, 30, 100, 10_000])
@pytest.mark.parametrize("extent", [1, 2, 3, 8, LONGEST_OBJECT, LONGEST_OBJECT + 1, 200])
@pytest.mark.parametrize("touched", [(), ("g",), ("b",), ("b", "g")])
@pytest.mark.parametrize("surrounds", [(), (("f", "r"),), (("r", "f"),)])
def test_the_kinds_of_a_region_are_100_percent_together(mass, extent, touched, surrounds) -> None:  # type: ignore[no-untyped-def]
    regions = Region("r", True, 100, True, extent, mass), Region("f", False, 100, True, 30, 0)
    kinds = interpret_regions(Percept(regions, frozenset(), frozenset(surrounds)), [("r", one) for one in touched])
    assert sum(kinds.kind["r"].values()) == 100 and max(kinds.kind["r"].values()) < 100


def test_the_surest_region_of_a_kind_is_one_that_was_felt() -> None:
    assert surest_kind("verge") >= 95 and surest_kind("object") > 90 and surest_kind("floor") == 100


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
