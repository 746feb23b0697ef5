"""Where a thing may be that the task names and nobody saw, and which pieces are one thing: chances that are 100."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon

from tests.kb.drawings import known_model
from tests.kb.tracing.test_possible_worlds import chance_in, weighed
from utak.kb.reasoning.query import worlds_request
from utak.kb.reasoning.solver import solve
from utak.kb.task.alternatives import CHANCES, alternatives
from utak.kb.task.binding import reconcile
from utak.kb.task.pieces import touching_pieces
from utak.kb.task.task import task_from_texts
from utak.kb.tracing.possible_worlds import likeliest_worlds
from utak.kb.world.facts import Places
from utak.kb.world.rooms import rooms_of

ROUNDED = 0.0006  # of a chance: weights are whole thousandths of nats
CASES = (("likely", 100), ("other", 100), ("open", 90), ("closed", 90), ("door", 100), ("verge", 0))
placed = st.sampled_from(CASES).flatmap(lambda case: st.tuples(st.just(case[0]), st.integers(0, case[1])))
claims = st.lists(st.tuples(st.sampled_from(["r1", "r2", "next"]), st.integers(0, 99)), max_size=2)


def chances(facts: Sequence[str]) -> dict[tuple[str, ...], int]:
    """The chances of the places of things, and of pieces to be one."""
    answer = solve([CHANCES], facts) or []
    return {(atom.name, *map(str, atom.arguments[:2])): atom.arguments[2].number for atom in answer}


@given(st.lists(placed, min_size=1, max_size=9), claims)
@settings(max_examples=60, deadline=None)
def test_the_places_of_a_thing_are_100_together(places: list[tuple[str, int]], claimed: list[tuple[str, int]]) -> None:
    letter = {"likely": "o", "other": "o", "open": "r", "closed": "r", "door": "d", "verge": "o"}
    facts = [f"place(x,{letter[case]}{n},{case},{measure})" for n, (case, measure) in enumerate(places, 1)]
    facts += [f"claimed(x,{room},{percent})" for room, percent in claimed]
    found = chances(["unbound(x)", *facts])
    assert sum(found.values()) == 100
    assert len(found) == len(places)
    assert min(found.values()) >= 1


def test_the_order_of_places_is_nothing() -> None:
    facts = ["place(x,o1,likely,40)", "place(x,r1,open,20)", "place(x,d1,door,60)", "place(x,verge,verge,0)"]
    first = chances(["unbound(x)", *facts])
    assert all(chances([*order, "unbound(x)"]) == first for order in permutations(facts))


def test_names_of_places_are_nothing_but_names() -> None:
    one = chances(["unbound(x)", "place(x,o1,likely,90)", "place(x,o2,likely,0)", "place(x,r1,open,20)"])
    two = chances(["unbound(y)", "place(y,o2,likely,90)", "place(y,o1,likely,0)", "place(y,r1,open,20)"])
    assert sorted(one.values()) == sorted(two.values())
    assert one["may_be", "x", "o1"] == two["may_be", "y", "o2"]


@given(st.lists(placed, min_size=2, max_size=6))
@settings(max_examples=15, deadline=None)
def test_chances_of_places_are_those_of_all_worlds(places: list[tuple[str, int]]) -> None:
    facts = [f"place(x,o{n},{case},{measure})" for n, (case, measure) in enumerate(places, 1)]
    facts += ["touch(o1_1,o1_2,unfelt,80)"]
    stated = [f"{atom}." for atom in solve([CHANCES], ["unbound(x)", *facts]) or ()]
    asked = worlds_request(stated, (), 1)
    found = {fact: least for fact, least, _, _ in likeliest_worlds(**asked)["open"]}
    worlds = weighed(asked["program"])
    for fact, chance in found.items():
        atom = clingo.Function("true", [clingo.parse_term(fact)])
        assert chance == pytest.approx(chance_in(worlds, [atom]), abs=1e-9)
    for (name, *arguments), percent in chances(["unbound(x)", *facts]).items():
        if arguments != ["o1_2", "o1_1"]:  # it follows from the same the other way round
            assert found.get(f"{name}({','.join(arguments)})", 1.0) == pytest.approx(percent / 100, abs=ROUNDED)


ROWS = [
    "bbbbbbbbbbbbb",
    "b...........b",
    "b.ggg.......b",
    "b.ggg...hhh.b",
    "b.......h...b",
    "b....U......b",
    "bbbbbbbbbbbbb",
]


def stated(start: str, goal: str = "at(utak, x).", rows: Sequence[str] = ROWS) -> list[str]:
    model, task = known_model(list(rows)), task_from_texts(start, goal)
    reconciled = reconcile(task, model, {node.name: 3.0 for node in model.objects}, {})
    return list(alternatives(task, model, Places(rooms_of(model), {}), reconciled))


def test_what_is_bound_and_what_is_no_object_has_no_places() -> None:
    assert not [fact for fact in stated("object(x).") if fact.startswith("may_be(")]
    assert not [fact for fact in stated("room(r).", "in(utak, r).") if fact.startswith("may_be(")]


def test_a_thing_that_is_none_of_those_seen_may_be_one_of_them_or_taken_for_verge() -> None:
    facts = [fact for fact in stated("object(x). shape(x, disc). colour(x, r).") if fact.startswith("may_be(")]
    assert {fact.split(",")[1] for fact in facts} == {"o1", "o2", "verge"}
    assert sum(int(fact.removesuffix(")").split(",")[2]) for fact in facts) == 100


def test_a_claimed_room_is_where_the_thing_is() -> None:
    places = ["place(x,r1,open,40)", "place(x,r2,open,3)", "place(x,o1,likely,0)", "claimed(x,r2,100)"]
    found = chances(["unbound(x)", *places])
    assert set(found) == {("may_be", "x", "r2"), ("may_be", "x", "o1")}


def test_the_parts_of_an_outline_are_one_thing_as_often_as_was_counted() -> None:
    model = known_model(ROWS)
    bent = Polygon([(-3, 1), (0, 1), (0, 2), (-2, 2), (-2, 4), (-3, 4)])
    node = replace(model.objects[0], polygon=bent, shape={"l_shape": 90})
    felt = {(-3, 3): "g", (-1, 1): "g"}
    (pair,) = touching_pieces(replace(model, objects=(node,)))
    assert pair == ("o1_1", "o1_2", False, 90, False)
    assert next(touching_pieces(replace(model, objects=(node,), felt=felt))).felt
    assert not [*touching_pieces(replace(model, objects=(node,), felt={**felt, (-1, 1): "h"}))]
    whole = replace(model, objects=(replace(node, moved=True, whole=True),))
    assert next(touching_pieces(whole)).facts[1] == "whole(o1_1)"
