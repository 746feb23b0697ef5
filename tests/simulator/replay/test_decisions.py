"""What a page keeps of decisions."""

from typing import Any

import pytest

from simulator.replay.packed.decisions import AS_ROUTES, DETAILS, by_encoding, trimmed

MANY = [
    "accommodation",
    ["trust(o1)", *(f"explanation({n},slipped,{n},1)" for n in range(50))],
    ["chosen(40)"],
    [f"slipped {n}" for n in range(50)],
]


def test_the_first_candidates_and_the_chosen_one_are_kept() -> None:
    encoding, facts, answer, about, left = trimmed(MANY, (3, 60))
    assert encoding == "accommodation"
    assert facts == ["trust(o1)", *(f"explanation({n},slipped,{n},1)" for n in (0, 1, 2, 40))]
    assert answer == ["chosen(40)"]
    assert [(n, text) for n, text in enumerate(about) if text != 0] == [(n, f"slipped {n}") for n in (0, 1, 2, 40)]
    assert left == 46


def test_the_least_detail_keeps_the_answer_alone() -> None:
    assert trimmed(MANY, DETAILS[-1]) == ["accommodation", [], ["chosen(40)"], [], 51]


def test_small_decisions_are_kept_whole() -> None:
    small = ["rooms", ["room(r1)", "neck(0,200)"], ["door(0,100)"], []]
    assert trimmed(small) == small


@pytest.mark.parametrize(
    "entry", [None, 3, "x", [], ["a", [1, 2]], ["a", 1, 2, 3], ["a", [], 5, []], ["a", [], None, []]]
)
def test_entries_of_other_forms_stay_as_they_are(entry: Any) -> None:
    assert trimmed(entry, DETAILS[-1]) == entry


def test_an_encoding_that_is_not_asked_is_remembered() -> None:
    first = by_encoding([["rooms", ["a"], [], []], ["shapes", ["b"], [], []], ["rooms", ["c"], [], []]], None)
    assert [first["last"][key][1] for key in first["order"]] == [["a"], ["b"], ["c"]]
    second = by_encoding([["rooms", [1, 0]], ["shapes", ["d"], [], []], 7], first)
    assert second["order"] == [[["rooms", [1, 0]]], "shapes", [7]]
    assert second["last"]["rooms"] == ["rooms", ["a"], [], []]
    assert second["last"]["shapes"] == ["shapes", ["d"], [], []]


def test_routes_are_told_once() -> None:
    routes = [[[0, 0], [3, 4]], [[0, 0], [5, 0], [3, 4]]]
    entry = ["routes", ["route(0,5)"], ["choose(0)"], routes]
    assert by_encoding([entry], None, routes)["last"] == {"routes": [*entry[:3], AS_ROUTES]}
    assert by_encoding([entry], None, routes[:1])["last"] == {"routes": entry}
    assert by_encoding([entry], None)["last"] == {"routes": entry}
    assert by_encoding([["x", [], [], []]], None, [])["last"] == {"x": ["x", [], [], []]}


def test_an_entry_that_looks_like_told_by_routes_is_kept_whole() -> None:
    entry = ["routes", [], [], AS_ROUTES]
    assert by_encoding([entry], None, [[[0, 0]]]) == {"order": [[entry]], "last": {}}
