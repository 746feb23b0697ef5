"""In whole runs it is stated where a thing may be until it is found, and what may be one thing until it has moved."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pytest

import utak
from utak.kb.language.atoms import atom_parts
from utak.kb.reasoning.interfaces import MADE_LAST, WORLD_FACTS_THERE
from utak.kb.reasoning.query import QueryEngine
from utak.simulator.explaining.questions import Questions

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


@cache
def episode(name: str) -> utak.Episode:
    return utak.Run(utak.Scenario.read(EXAMPLES / name), seed=1).finish()


def stated(name: str, predicate: str) -> list[dict[tuple[str, ...], int]]:
    """By step: what a run states with a predicate, and with how many percent."""
    found = []
    for step in episode(name):
        facts = [atom_parts(fact.removesuffix(".")) for fact in step.world.facts if fact.startswith(f"{predicate}(")]
        found.append({arguments[:2]: int(arguments[2]) for _, arguments in facts if len(arguments) == 3})
    return found


def asked(name: str) -> Questions:
    return episode(name)._questions


def test_a_thing_has_places_until_it_is_found() -> None:
    places = stated("go_to_square_unseen", "may_be")
    bound = ["bound(x,o4)." in step.world.facts for step in episode("go_to_square_unseen")]
    assert [not there for there in places] == bound
    assert bound[-1] and not bound[0]
    assert all(sum(there.values()) == 100 for there in places if there)


def test_the_places_of_a_thing_are_asked_for() -> None:
    first, last = episode("go_to_square_unseen")[0].world, episode("go_to_square_unseen")[-1].world
    places = stated("go_to_square_unseen", "may_be")[0]
    rows = {(row["P"], row["C"]) for row in first.query("may_be(x, P, C)")}
    assert rows == {(place, percent) for (_, place), percent in places.items()}
    assert {row["C"] for row in first.query("chance(may_be(x, r1), C)")} == {places["x", "r1"]}
    assert str(first.query("may_be(x, r1)")) == "don't know"
    assert str(first.query("may_be(x, r7, C)")) == str(last.query("may_be(x, o4, C)")) == "no"


def test_one_place_holds_in_each_possible_world() -> None:
    with QueryEngine() as engine:
        found = engine.worlds(episode("go_to_square_unseen")[0].world.facts, 50)
    assert all(sum(fact.startswith("may_be(x,") for fact in world.facts) == 1 for world in found.worlds)
    acts = {fact: acts for fact, _, _, acts in found.open}
    assert acts["may_be(x,r1)"] == ("look(r1)",)


@contextmanager
def engine_with(folder: Path, text: str) -> Iterator[QueryEngine]:
    """Return an engine for queries with rules of users."""
    rules = folder / "rules.lp"
    rules.write_text(text)
    with QueryEngine() as engine:
        engine.use_rules([str(rules)])
        yield engine


def test_rules_of_users_are_evidence_of_places(tmp_path: Path) -> None:
    facts = episode("go_to_square_unseen")[0].world.facts
    with engine_with(tmp_path, ":- true(may_be(X, verge)).     % nothing is taken for a wall\n") as engine:
        found = {fact: least for fact, least, _, _ in engine.worlds(facts, 1).open}
    places = stated("go_to_square_unseen", "may_be")[0]
    rest = 100 - places["x", "verge"]
    assert "may_be(x,verge)" not in found
    assert found["may_be(x,r1)"] == pytest.approx(places["x", "r1"] / rest, abs=0.002)


def test_rules_of_users_read_them_in_queries_alone(tmp_path: Path) -> None:
    facts = episode("go_to_square_unseen")[0].world.facts
    with engine_with(tmp_path, "hidden_thing(X, R) :- may_be(X, R, C), room(R), C > 5.\n") as engine:
        assert str(engine.ask(facts, "hidden_thing(x, r1)")) == "yes"
    assert not MADE_LAST & WORLD_FACTS_THERE["task"]


def test_why_a_thing_may_be_somewhere_is_told_and_why_not() -> None:
    questions, name = asked("go_to_square_unseen"), "go_to_square_unseen"
    percent = stated(name, "may_be")[0]["x", "r1"]
    reason = questions.why(f"may_be(x,r1,{percent})", 0)
    assert reason.because == f"the task's x may be at r1 with {percent} percent"
    assert "chances.lp" in str(reason)
    assert questions.why_not("may_be(x,r9,C)", 0).because.startswith("no room r9 is believed to be there")
    assert "means nothing that was seen" in questions.why_not(f"may_be(x,r1,{percent + 1})", 0).because
    assert "means something" in questions.why_not("may_be(x,r1,C)", len(episode(name)) - 1).because
    assert "names no object" in questions.why_not("may_be(y,r1,C)", 0).because


def test_the_robot_stands_in_one_square() -> None:
    places = stated("go_to_square_unseen", "loc")
    assert all(sum(there.values()) <= 100 for there in places)
    assert places[0] == {("0", "0"): 100}
    first = episode("go_to_square_unseen")[0].world
    assert str(first.query("loc(0, 0)")) == "yes"
    assert str(first.query("possible(loc(0, 100))")) == "no"
    reason = asked("go_to_square_unseen").why("loc(0,0,100)", 0)
    assert "chances.lp" in str(reason)
    assert "nothing speaks for that square" in asked("go_to_square_unseen").why_not("loc(0,100,C)", 0).because


def test_what_joins_floors_and_what_is_a_thing_in_a_wall_is_asked_and_told() -> None:
    name, step = "go_next_room_askew", 2
    there, world = stated(name, "hidden")[step], episode(name)[step].world
    assert {apart for apart, _ in there} == {"part2", "part3"}
    assert all(sum(c for (apart, _), c in there.items() if apart == one) < 100 for one in ("part2", "part3"))
    assert str(world.query("possible(hidden(part2, part1))")) == "yes"
    plugs = {row["W"]: row["C"] for row in world.query("plug(W, C), stretch(W, A, B, D, E)")}
    assert plugs and all(0 < percent < 100 for percent in plugs.values())
    with QueryEngine() as engine:
        acts = {fact: acts for fact, _, _, acts in engine.worlds(world.facts, 1).open}
    assert acts["hidden(part2,part1)"] == ("look(floor)",) and acts["plug(w1)"] == ("feel(w1)",)
    for fact in (f"hidden(part2,part1,{there['part2', 'part1']})", f"plug(w1,{plugs['w1']})"):
        assert "chances.lp" in str(asked(name).why(fact, step))
    assert "no seen floor joins" in asked(name).why_not("hidden(part9,part1,C)", step).because
    assert "left unfelt" in asked(name).why_not("plug(w9,C)", step).because


@pytest.mark.long
def test_the_legs_of_an_l_are_one_thing_for_certain_once_they_moved_together() -> None:
    joined = stated("push_l_next_room", "joined")
    chances = [there["o1_1", "o1_2"] for there in joined if ("o1_1", "o1_2") in there]
    assert 0 < chances[0] < 100
    assert chances[-1] == 100
    assert chances == sorted(chances)
    assert "joined(o1_1,o1_2)." in episode("push_l_next_room")[-1].world.facts
    assert all(there["o1_2", "o1_1"] == there["o1_1", "o1_2"] for there in joined if there)
