"""The rules of docs/belief_rules.md: each in a whole run, without it and with it."""

from pathlib import Path

import pytest

import utak
from utak.kb.reasoning.query import QueryEngine

ROOT = Path(__file__).resolve().parents[2]
ROOM = 'verge("POLYGON ((0 0, 0 20, 26 20, 26 0, 0 0), (2 2, 24 2, 24 18, 2 18, 2 2))").'
WIDE_OPENING = (
    """table(44, 22).
verge("POLYGON ((0 0, 0 22, 44 22, 44 0, 0 0), """
    """(2 2, 20 2, 20 5, 22 5, 22 2, 42 2, 42 20, 22 20, 22 17, 20 17, 20 20, 2 20, 2 2))").
utak("POINT (9.5 10.5)", 0)."""
)
ALCOVE = """table(34, 26).
verge("POLYGON ((0 0, 0 26, 34 26, 34 0, 0 0), (2 2, 32 2, 32 16, 14 16, 14 24, 2 24, 2 2))").
utak("POINT (9.5 9.5)", 0)."""
CLOSET = (
    """table(45, 24).
verge("POLYGON ((0 0, 0 24, 45 24, 45 0, 0 0), """
    """(2 2, 14 2, 14 8, 16 8, 16 2, 34 2, 34 8, 36 8, 36 7, 43 7, 43 14, 36 14, 36 13, 34 13, 34 22, """
    """16 22, 16 13, 14 13, 14 22, 2 22, 2 2))").
utak("POINT (32.5 10.5)", 0)."""
)
TWO_SQUARES = """table(40, 20). verge("POLYGON ((0 0, 0 20, 40 20, 40 0, 0 0), (2 2, 38 2, 38 18, 2 18, 2 2))").
object(a, c, "POLYGON ((9 5, 12 5, 12 8, 9 8, 9 5))"). object(b, d, "POLYGON ((19 10, 22 10, 22 13, 19 13, 19 10))").
utak("POINT (16.5 9.5)", 0)."""


def pair(number: int, scenario: utak.Scenario, max_steps: int) -> tuple[utak.Episode, utak.Episode]:
    """Return the episodes of a scenario without and with a rule of the documentation, by its number."""
    (rule,) = (ROOT / "docs" / "belief_rules").glob(f"{number:02d}_*.lp")
    without, with_it = (utak.Run(scenario, rules=rules, max_steps=max_steps).finish() for rules in ((), (str(rule),)))
    assert not with_it.idle_rules
    return without, with_it


def example(name: str) -> utak.Scenario:
    """Return a scenario of the examples."""
    return utak.Scenario.read(ROOT / "examples" / name)


def room_with(thing: str, place: str, start: str) -> utak.Scenario:
    """Return a room with one thing and the robot beside it, which shall go to x."""
    world = f"table(26, 20). {ROOM} {thing} {place}"
    return utak.Scenario.from_text(world=world, start=start, goal="at(utak, x).")


def facts(episode: utak.Episode, step: int = -1) -> frozenset[str]:
    """Return what is believed at a step."""
    return frozenset(episode[step].world.facts)


def test_red_things_are_squares() -> None:
    """A red brick is what the task calls a square."""
    brick = 'object(a, r, "POLYGON ((10 9, 14 9, 14 11, 10 11, 10 9))").'
    scenario = room_with(brick, 'utak("POINT (9.5 9.5)", 0).', "object(x). shape(x, square).")
    without, with_it = pair(1, scenario, 2)
    assert {"shape(o1,brick,94).", "shape(o1,square,0)."} <= facts(without, 0)
    assert {"shape(o1,brick,0).", "shape(o1,square,90).", "bound(x,o1)."} <= facts(with_it, 0)
    assert (without.verdict, with_it.verdict) == ("limit", "done")


def test_small_regions_at_the_edge_of_what_is_seen_are_things() -> None:
    without, with_it = pair(2, example("go_to_square"), 1)
    assert {"kind(o1,object,46).", "kind(o1,verge,54)."} <= facts(without, 0)
    assert {"kind(o1,object,99).", "kind(o1,verge,1)."} <= facts(with_it, 0)


def test_what_leans_on_a_wall_is_wall() -> None:
    """A thing that was felt against a wall is a thing, and what is asked for; with the rule there is none."""
    brick = 'object(a, c, "POLYGON ((10 2, 14 2, 14 5, 10 5, 10 2))").'
    scenario = room_with(brick, 'utak("POINT (9.5 3.5)", 0).', "object(x). colour(x, c).")
    without, with_it = pair(3, scenario, 2)
    assert "bound(x,o1)." in facts(without)
    assert not any(fact.startswith("kind(o") and ",object," in fact for fact in facts(with_it))
    assert (without.verdict, with_it.verdict) == ("done", "limit")


def test_a_narrow_door_is_none() -> None:
    """Then there is one room, and no next one is attained."""
    without, with_it = pair(4, example("go_next_room"), 8)
    assert any(fact.startswith("door(") for fact in facts(without))
    assert not any(fact.startswith(("door(", "room(r2)")) for fact in facts(with_it))
    assert (without.verdict, with_it.verdict) == ("done", "limit")


def test_a_wide_opening_is_a_door() -> None:
    scenario = utak.Scenario.from_text(world=WIDE_OPENING, start="", goal="in(utak, room(next)).")
    without, with_it = pair(5, scenario, 12)
    assert not any(fact.startswith("door(") for fact in facts(without))
    assert any(fact.startswith("door(d1,") for fact in facts(with_it))
    assert (without.verdict, with_it.verdict) == ("limit", "done")


def test_the_northeast_corner_is_the_one_furthest_north() -> None:
    scenario = utak.Scenario.from_text(world=ALCOVE, start="", goal="at(utak, corner(northeast)).")
    without, with_it = pair(6, scenario, 12)
    assert (without.verdict, with_it.verdict) == ("done", "done")
    assert [tuple(map(round, episode[-1].line["utak"])) for episode in (without, with_it)] == [(32, 16), (14, 24)]


def test_of_two_squares_the_western_one_is_meant() -> None:
    scenario = utak.Scenario.from_text(world=TWO_SQUARES, start="object(x). shape(x, square).", goal="at(utak, x).")
    without, with_it = pair(7, scenario, 12)
    assert "bound(x,o2)." in facts(without, 0)
    assert "bound(x,o1)." in facts(with_it, 0)
    assert without[1].line["action"] != with_it[1].line["action"]
    assert (without.verdict, with_it.verdict) == ("done", "done")


def test_a_hunch_is_enough() -> None:
    """What is a thing with 41 percent is meant already, and not only looked at."""
    without, with_it = pair(8, example("go_to_square_two"), 3)
    assert "kind(o3,object,41)." in facts(with_it, 1)
    assert ["bound(x,o3)." in facts(episode, 1) for episode in (without, with_it)] == [False, True]


def test_long_things_cannot_be_moved() -> None:
    without, with_it = pair(9, example("push_brick_through_door"), 10)
    assert "movable(o1,99)." in facts(without)
    assert "movable(o1,0)." in facts(with_it)
    assert (without.verdict, with_it.verdict) == ("done", "limit")
    assert all((step.line["action"] or {}).get("do") != "grasp" for step in with_it)


def test_there_is_one_square_at_most(tmp_path: Path) -> None:
    """Two likely squares are one likely square: each of them is less likely than without the rule."""
    scenario = utak.Scenario.from_text(world=TWO_SQUARES, start="object(x). shape(x, square).", goal="at(utak, x).")
    without, with_it = pair(10, scenario, 12)
    chances = []
    for rules, episode in (((), without), (tuple(with_it[-1].world.rules), with_it)):
        with QueryEngine() as engine:
            engine.use_rules(list(rules))
            worlds = engine.worlds(episode[-1].world.facts, 3)
        chances.append({fact: least for fact, least, _, _ in worlds.open})
        assert worlds.worlds
    squares = "shape(o1,square)", "shape(o2,square)"
    assert all(chances[0][square] == pytest.approx(0.92, abs=0.03) for square in squares)
    assert sum(chances[1][square] for square in squares) <= 1.0
    assert all(chances[1][square] < 0.6 for square in squares)


def test_what_is_hardly_a_thing_is_none() -> None:
    without, with_it = pair(11, example("go_to_square"), 3)
    assert "kind(o1,object,46)." in facts(without, 0)
    assert "node(o1)." not in facts(with_it, 0)
    assert "node(o1)." in facts(with_it)
    for step in with_it:
        shares = [int(fact.rpartition(",")[2][:-2]) for fact in step.world.facts if ",object," in fact]
        assert all(share >= 50 for share in shares)


def test_things_are_felt_before_they_are_planned_to_be_moved() -> None:
    without, with_it = pair(12, example("push_square_next_room"), 12)
    planned = [
        ["plan(0,carry(o1,g1_r2))." in facts(episode, step) for step in (1, 2)] for episode in (without, with_it)
    ]
    assert planned == [[True, True], [False, True]]
    assert not any(fact.startswith("colour(o1,") for fact in facts(with_it, 1))
    assert any(fact.startswith("colour(o1,") for fact in facts(with_it, 2))
    assert (without.verdict, with_it.verdict) == ("done", "done")


def test_what_is_near_is_not_looked_at_first() -> None:
    """What may be the square, but stands in the first room, is looked at after what was never seen."""
    without, with_it = pair(13, example("go_to_square"), 10)
    assert "it is not clear what o1 is" in without[1].line["why"]
    assert "the floor goes on unseen" in with_it[1].line["why"]
    chances = [
        {fact.rpartition(",")[0]: int(fact.rpartition(",")[2][:-2]) for fact in facts(episode, 0) if "may_be(" in fact}
        for episode in (without, with_it)
    ]
    assert chances[0]["may_be(x,o1"] > 10 * chances[1]["may_be(x,o1"]
    assert [sum(there.values()) for there in chances] == [100, 100]
    assert (without.verdict, with_it.verdict) == ("done", "done")


def test_every_rule_of_the_page_has_a_test() -> None:
    rules = sorted(path.name for path in (ROOT / "docs" / "belief_rules").iterdir())
    text = (ROOT / "docs" / "belief_rules.md").read_text(encoding="utf-8")
    assert [name for name in rules if f"belief_rules/{name}" not in text] == []
    tested = Path(__file__).read_text(encoding="utf-8")
    assert [name for name in rules if f"pair({int(name[:2])}, " not in tested] == []


def test_what_is_as_wide_as_a_door_is_one() -> None:
    """The closet beside the robot is a room of its own; without the rule it belongs to the room before it."""
    scenario = utak.Scenario.from_text(world=CLOSET, start="", goal="in(utak, room(next)).")
    without, with_it = pair(14, scenario, 2)
    doors = [
        sorted(fact.partition(",")[0] for fact in facts(one) if fact.startswith("door(")) for one in (without, with_it)
    ]
    assert doors == [["door(d1"], ["door(d1", "door(d2"]]
    assert ["room(r3)." in facts(episode) for episode in (without, with_it)] == [False, True]
