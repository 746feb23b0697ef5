"""Binding of the task's parameters to objects of the world model: laws over random claims and nodes."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.drawings import known_model
from utak.kb.language.diagnostics import SourceSpan
from utak.kb.language.terms import Symbol
from utak.kb.task.binding import reconcile, rules_on_what_fits, rules_that_deny
from utak.kb.task.task import Claim, Parameter, Task
from utak.kb.world.model import Node

NOWHERE = SourceSpan(0, 0, 0)
MODEL = known_model(["bbbbbbbbb", "b.......b", "b.ggg.h.b", "b.ggg...b", "b....U..b", "bbbbbbbbb"])
SHAPES, COLOURS = ("square", "brick", "disc"), ("g", "h")


def symbol(name: str, *args: str) -> Symbol:
    return Symbol(name, tuple(Symbol(arg, (), NOWHERE) for arg in args), NOWHERE)


def task(claims: dict[str, list[tuple[str, str, int]]], named: str | None = None) -> Task:
    """Return a task with object parameters.

    claims : of each parameter its claims (property, value, confidence). named : the parameters of goals; None for all.
    """
    parameters = {x: Parameter(x, "object", NOWHERE) for x in claims}
    claims_made = tuple(Claim(symbol(p, x, v), c) for x, said in claims.items() for p, v, c in said)
    return Task(parameters, claims_made, tuple(symbol("at", "utak", x) for x in (claims if named is None else named)))


def node(name: str, shape: dict[str, int], colour: str | None = None, open_: int = 0, confidence: int = 95) -> Node:
    return replace(MODEL.objects[0], name=name, shape=shape, colour=colour, open=open_, confidence=confidence)


claim = st.tuples(st.just("shape"), st.sampled_from(SHAPES), st.integers(50, 100)) | st.tuples(
    st.just("colour"), st.sampled_from(COLOURS), st.integers(50, 100)
)
tasks = st.dictionaries(st.sampled_from(["x", "y", "z"]), st.lists(claim, max_size=2), min_size=1, max_size=3).map(task)
nodes = st.lists(
    st.builds(
        node,
        st.just("o"),
        st.dictionaries(st.sampled_from(SHAPES), st.integers(0, 99), max_size=3),
        st.sampled_from([None, *COLOURS]),
        st.sampled_from([0, 0, 5]),
        st.sampled_from([95, 70, 30]),
    ),
    max_size=3,
).map(lambda found: tuple(replace(n, name=f"o{i}") for i, n in enumerate(found, 1)))


@pytest.mark.long
@settings(max_examples=120, deadline=None)
@given(tasks, nodes, st.data())
def test_laws_of_binding(wanted: Task, things: tuple[Node, ...], data: st.DataObject) -> None:
    model = replace(MODEL, objects=things)
    names = [thing.name for thing in things]
    far = {name: float(data.draw(st.integers(0, 40))) for name in names}
    found = reconcile(wanted, model, far, {})
    assert set(found.binding) | set(found.hypothesised) == set(wanted.parameters)
    assert not set(found.binding) & set(found.hypothesised)
    assert len(set(found.binding.values())) == len(found.binding)
    assert set(found.binding.values()) <= set(names)
    again = reconcile(wanted, model, far, found.binding)
    assert set(again.binding) == set(found.binding)
    assert sum(far[n] for n in again.binding.values()) <= sum(far[n] for n in found.binding.values())
    for x, name in found.binding.items():
        thing = model.object(name)
        assert thing is not None
        for said in (claim for claim in wanted.claims if str(claim.fact.args[0]) == x):
            value = str(said.fact.args[1])
            has = thing.shape.get(value, 0) if said.fact.name == "shape" else 99 * (thing.colour == value)
            assert max(has, 100 - said.confidence) >= 50


@settings(max_examples=60, deadline=None)
@given(tasks, tasks, nodes, st.data())
def test_parameters_without_a_goal_take_no_object_from_others(
    wanted: Task, more: Task, things: tuple[Node, ...], data: st.DataObject
) -> None:
    model = replace(MODEL, objects=things)
    far = {thing.name: float(data.draw(st.integers(0, 40))) for thing in things}
    besides = {f"{x}0": replace(parameter, name=f"{x}0") for x, parameter in more.parameters.items()}
    claims = [Claim(symbol(c.fact.name, f"{c.fact.args[0]}0", str(c.fact.args[1])), c.confidence) for c in more.claims]
    larger = Task({**wanted.parameters, **besides}, (*wanted.claims, *claims), wanted.goals)
    alone, beside = (reconcile(t, model, far, {}) for t in (wanted, larger))
    assert beside.hypothesised == alone.hypothesised
    assert {x for x in beside.binding if x in wanted.parameters} == set(alone.binding)
    one, other = (sum(far[r.binding[x]] for x in wanted.parameters if x in r.binding) for r in (alone, beside))
    assert one == other


@settings(max_examples=60, deadline=None)
@given(tasks, nodes)
def test_a_settled_contradiction_is_never_bound(wanted: Task, things: tuple[Node, ...]) -> None:
    found = reconcile(wanted, replace(MODEL, objects=things), {}, {})
    assert not {(x, name) for x, name, _ in found.contradicted} & set(found.binding.items())


def test_the_best_match_is_bound() -> None:
    things = (node("o1", {"brick": 90}), node("o2", {"square": 95}), node("o3", {"square": 65}))
    found = reconcile(task({"x": [("shape", "square", 100)]}), replace(MODEL, objects=things), {"o1": 1, "o2": 30}, {})
    assert found.binding == {"x": "o2"}
    assert ("x", "o1", "shape") in found.contradicted


@pytest.mark.parametrize("parameter", ["x", "h"])  # a parameter may have the name of a colour, its own or another's
def test_a_colour_claim_counts(parameter: str) -> None:
    things = (node("o1", {"square": 95}, "g"), node("o2", {"square": 95}, "h"))
    claims = {parameter: [("shape", "square", 100), ("colour", "h", 100)]}
    found = reconcile(task(claims), replace(MODEL, objects=things), {"o1": 1, "o2": 30}, {})
    assert found.binding == {parameter: "o2"}
    assert (parameter, "o1", "colour") in found.contradicted


@pytest.mark.parametrize(
    ("moved", "better", "chosen"), [(True, 0, "o1"), (True, 15, "o1"), (True, 31, "o2"), (False, 0, "o2")]
)
@pytest.mark.parametrize("alike", [50, 60, 62, 68])
def test_an_object_moved_for_a_goal_stays_bound(alike: int, moved: bool, better: int, chosen: str) -> None:
    things = (replace(node("o1", {"square": alike}), moved=moved), node("o2", {"square": alike + better}))
    wanted, far = task({"x": [("shape", "square", 100)]}), {"o1": 30.0, "o2": 1.0}
    found = reconcile(wanted, replace(MODEL, objects=things), far, {"x": "o1"}, carried=["x"])
    assert found.binding == {"x": chosen}


def test_an_object_of_unknown_colour_is_doubtful() -> None:
    claims = {"x": [("shape", "square", 100), ("colour", "h", 100)]}
    found = reconcile(task(claims), replace(MODEL, objects=(node("o1", {"square": 95}),)), {}, {})
    assert found.hypothesised == ("x",)
    assert found.doubtful == (("x", "o1"),)


def test_two_parameters_get_different_objects() -> None:
    things = (node("o1", {"square": 95, "brick": 70}), node("o2", {"square": 95}))
    claims = {"x": [("shape", "square", 100)], "y": [("shape", "brick", 100)]}
    found = reconcile(task(claims), replace(MODEL, objects=things), {"o1": 1, "o2": 9}, {})
    assert found.binding == {"x": "o2", "y": "o1"}


def test_doors_and_rooms_are_not_bound_to_objects() -> None:
    wanted = Task({"d": Parameter("d", "door", NOWHERE)}, (), ())
    found = reconcile(wanted, MODEL, {}, {})
    assert not any(found[:-1])


def test_the_rule_is_named_without_which_a_parameter_would_mean_something(tmp_path: Path) -> None:
    rules, wanted = (tmp_path / "mine.lp",), task({"x": [("shape", "square", 100)]})
    rules[0].write_text(
        ":- bind(x, N), has(N, shape, square, C), C < 99.\n:- bind(x, N), has(N, shape, disc, C), C > 5.\n"
    )
    for objects, denying in (((node("o1", {"square": 95}),), f"{rules[0]}:1"), ((), "")):
        found = reconcile(wanted, replace(MODEL, objects=objects), {"o1": 1}, {}, rules, ["x"])
        assert (found.binding, rules_that_deny("x", found, rules)) == ({}, denying)
        assert rules_that_deny("x", found, ()) == ""


def test_rules_that_say_what_things_are_are_named_where_that_decides_what_fits(tmp_path: Path) -> None:
    rules, wanted = (tmp_path / "mine.lp",), task({"x": [("shape", "square", 100)], "y": [("shape", "disc", 100)]})
    rules[0].write_text(
        "shape(N, square, 1) :- fit(N, square, _, _).\n"
        "shape(N, brick, 99) :- fit(N, brick, _, _).\n"
        "kind(P, verge, 99) :- extent(P, E), E > 30.\n"
        ":- brought(X, _, _, _), shape(X, disc, C), C > 5.\n"
        "has(N, shape, disc, 1) :- has(N, colour, r, _).\n"
    )
    assert rules_on_what_fits("x", wanted, rules) == f"{rules[0]}:1 and {rules[0]}:3"
    assert rules_on_what_fits("y", wanted, rules) == f"{rules[0]}:3 and {rules[0]}:5"
    assert rules_on_what_fits("x", wanted, ()) == ""
