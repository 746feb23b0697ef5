"""Facts with a confidence: their short forms, what excludes each other, and what is symmetric, in drawn worlds."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon, affinity

from benchmarks.priors.bins import PLACES
from tests.kb.drawings import known_model
from utak.kb.language.atoms import atom_parts, long_form, short_form
from utak.kb.language.vocabulary import BELIEF_PREDICATES
from utak.kb.localisation.standing import Standing
from utak.kb.mapping.occupancy import OPEN
from utak.kb.perception.interpretation import counted_percent
from utak.kb.world.chances import Chances, measured
from utak.kb.world.corners import corners
from utak.kb.world.facts import Places, model_facts
from utak.kb.world.model import WorldModel
from utak.kb.world.rooms import rooms_of

LEFT, RIGHT, WALL = "b" + "." * 14 + "bb", "." * 14 + "b", "b" * 32
ROWS = [WALL, *[LEFT + "b" + RIGHT[1:]] * 4, *["b" + "." * 30 + "b"] * 4, *["b...ggg" + LEFT[7:] + RIGHT] * 2]
ROWS += ["b.hh..U" + LEFT[7:] + RIGHT, *["b.hh..." + LEFT[7:] + RIGHT] * 2, LEFT + RIGHT, WALL]


def stated(model: WorldModel) -> list[str]:
    """The facts of a model."""
    return list(model_facts(model, Places(rooms_of(model), corners(model))))


def doubted(model: WorldModel, squares: Sequence[tuple[int, int]], chance: float) -> WorldModel:
    """The same model with some squares open, each occupied with a chance."""
    state, probability = model.view.state.copy(), model.view.probability.copy()
    for row, column in squares:
        state[row, column], probability[row, column] = OPEN, chance
    return replace(model, view=model.view._replace(state=state, probability=probability))


def check(facts: Sequence[str]) -> None:
    """Check what holds of the facts of every step."""
    known = set(facts)
    assert len(known) == len(facts)
    inside: dict[str, int] = defaultdict(int)
    for fact in facts:
        name, arguments = atom_parts(fact)
        declared = BELIEF_PREDICATES[name, len(arguments)]
        if declared.short:
            assert 0 <= int(arguments[-1]) <= 100
            assert (f"{name}({','.join(arguments[:-1])})" in known) == (arguments[-1] == "100")
        if declared.long is not None:
            assert long_form(fact) in known and short_form(long_form(fact)) == fact
        if declared.symmetric:
            assert f"{name}({','.join([arguments[1], arguments[0], *arguments[2:]])})" in known
        if (name, len(arguments)) == ("in", 3):
            inside[arguments[0]] += int(arguments[2])
    assert all(share <= 100 for share in inside.values())
    widths = {row[0]: int(row[1]) for one, row in map(atom_parts, facts) if one == "width" and len(row) == 2}
    for one, row in map(atom_parts, facts):
        if one == "width" and len(row) == 3:
            assert int(row[1]) <= widths[row[0]] <= int(row[2])


def test_what_is_known_completely_is_known() -> None:
    facts = stated(known_model(ROWS))
    check(facts)
    assert {"adjacent(o1,o2)", "adjacent(o2,o1,100)", "adjacent(org,o2)", "adjacent(o2,org,100)"} <= {*facts}
    assert {"region(part1,zero)", "part_of(part1,floor)"} <= {*facts}
    assert not any(fact.startswith("in(") and fact.endswith(",100)") for fact in facts)  # o1 may be a piece of wall
    free = stated(known_model([row.replace("g", ".").replace("h", ".") for row in ROWS]))
    assert "in(org,r1)" in free
    apart = ("adjacent(org,verge", "adjacent(org,o1", "adjacent(verge,o")
    near = [int(atom_parts(fact)[1][-1]) for fact in facts if fact.startswith(apart)]
    assert all(share < 10 for share in near)  # a thing that stands free is hardly a part of the verge
    assert any(fact.startswith("width(d1,") for fact in facts)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 13), st.integers(0, 31)), max_size=30), st.floats(0.02, 0.98))
def test_open_squares_make_facts_uncertain_and_never_contradict(squares: list[tuple[int, int]], chance: float) -> None:
    model = known_model(ROWS)
    doubtful, sure = stated(doubted(model, squares, chance)), set(stated(model))
    check(doubtful)
    for fact in doubtful:  # what is known in spite of doubt is so
        if fact.startswith(("adjacent(", "in(")) and fact.endswith(",100)"):
            assert fact in sure
    for fact in sure:  # what is so is never excluded
        if fact.startswith("adjacent(") and fact.endswith(",100)"):
            assert any(other.startswith(fact[: -len("100)")]) for other in doubtful)


def test_what_one_open_square_decides() -> None:
    """An open square between two things is measured by its probability, and has what was counted for that."""
    rows = [WALL, *["b" + "." * 30 + "b"] * 2, *["b..gg.hh" + "." * 23 + "b"] * 3, "b....U" + "." * 25 + "b", WALL]
    model = known_model(rows)
    touching = f"adjacent(o1,o2,{counted_percent('adjacent_things', 30)})"
    assert touching not in stated(model)
    between = doubted(model, [(2, 5)], 0.3)
    assert touching in stated(between) and "adjacent(o1,o2)" not in stated(between)
    assert "adjacent(o1,org)" in stated(between)


def test_a_robot_that_is_lost_may_be_in_any_room() -> None:
    lost = replace(known_model(ROWS), lost=True)
    shares = [row for name, row in map(atom_parts, stated(lost)) if name == "in" and row[0] == "org"]
    assert len(shares) > 1 and all(len(row) == 3 for row in shares)


def test_a_door_behind_which_nothing_was_seen_connects_no_rooms() -> None:
    rows = [row[:14] + "?" * (len(row) - 14) for row in ROWS]
    doors = rooms_of(known_model(rows)).doors
    facts = stated(known_model(rows))
    assert all(any(fact.startswith(f"connects({door.name},") for fact in facts) == door.joins for door in doors)
    assert any(fact.startswith("connects(d1,r") for fact in stated(known_model(ROWS)))


def test_no_square_is_certain_while_the_robot_may_stand_elsewhere() -> None:
    model = known_model(ROWS)
    elsewhere = replace(model, standing=Standing("unsure", model.frame, {(0, 0): 0.99, (1, 0): 0.01}))
    assert any(fact.startswith("region(") and fact.endswith(",100)") for fact in stated(model))
    assert not any(fact.startswith(("region(", "segment(")) and fact.endswith(",100)") for fact in stated(elsewhere))


def test_the_rooms_of_the_robot_are_those_of_the_squares_in_which_it_may_stand() -> None:
    model = known_model(ROWS)
    rooms = rooms_of(model)
    squares = {n: np.argwhere((rooms.labels == n) & ~rooms.doorways)[0].tolist() for n in (1, 2)}
    places = {n: (column + model.view.west, row + model.view.south) for n, (row, column) in squares.items()}
    standing = Standing("unsure", model.frame, {places[1]: 0.75, places[2]: 0.25})
    measured_shares: list[tuple[str, int]] = []
    found = Chances(
        replace(model, standing=standing), rooms, lambda *noted: measured_shares.append(noted) or 60
    ).rooms_of(None)
    assert measured_shares == [("in_robot", 75)] and found == [(1, 60), (2, 40)]
    certain = replace(model, objects=(), standing=Standing("sure", model.frame, {places[2]: 1.0}))
    assert Chances(certain, rooms).rooms_of(None) == [(2, 100)]
    unsure = replace(certain, standing=standing._replace(shares={places[2]: 1.0}))
    assert Chances(unsure, rooms).rooms_of(None) == [(2, counted_percent("in_robot", 99))]


def test_nothing_is_known_of_a_map_in_doubt() -> None:
    model = known_model(ROWS)
    doubtful = stated(replace(model, view=model.view._replace(sure=False)))
    check(doubtful)
    places = ("adjacent", "in", "corner", "door", "connects")
    assert not any(fact.endswith(",100)") for fact in doubtful if fact.partition("(")[0] in places)


@pytest.mark.parametrize(("chance", "share"), [(1e-9, 1), (0.5, 50), (1.0, 99)])
def test_what_is_measured_is_neither_excluded_nor_certain(chance: float, share: int) -> None:
    assert measured(chance) == share


@pytest.mark.parametrize("case", PLACES)
def test_every_measure_of_a_place_has_a_counted_confidence(case: str) -> None:
    found = [counted_percent(case, measure) for measure in range(1, 100)]
    assert all(1 <= share <= 99 for share in found)


def test_the_likeliest_room_has_what_was_counted_and_the_others_share_the_rest() -> None:
    model = known_model(ROWS)
    cases: list[tuple[str, int]] = []

    def noted(case: str, measure: int) -> int:
        cases.append((case, measure))
        return 60

    doubted_map = replace(model, view=model.view._replace(sure=False))
    found = Chances(doubted_map, rooms_of(model), noted).rooms_of(model.objects[0])
    assert [case for case, _ in cases] == ["in_thing"]
    assert sum(share for _, share in found) in (60, 100) and max(share for _, share in found) == 60


def test_the_middle_of_a_thing_is_where_its_open_squares_leave_it() -> None:
    """A thing beside a door may lie in either room while squares of it are open."""
    model = known_model(ROWS)
    rooms = rooms_of(model)
    chances = Chances(doubted(model, [(3, c) for c in range(3, 6)], 0.4), rooms)
    found = dict(chances.rooms_of(model.objects[0]))
    assert sum(found.values()) <= 100 and found
    assert all(room > 0 for room in found)


@pytest.mark.parametrize("degrees", [0, 90, 33])
def test_the_legs_of_an_object_are_its_parts(degrees: float) -> None:
    model = known_model(ROWS)
    outline = affinity.rotate(Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 5), (0, 5)]), degrees, (2, 2))
    first, *others = model.objects
    facts = stated(replace(model, objects=(replace(first, polygon=outline), *others)))
    parts = [fact for fact in facts if fact.startswith("part_of(") and f"({first.name}_" in fact]
    assert parts == [f"part_of({first.name}_{n},{first.name})" for n in (1, 2)]
    assert {f"child({first.name},{first.name}_1)", f"node({first.name}_2)"} <= {*facts}
    numbers = {
        (name, row[0]): np.array([int(value) for value in row[1:]])
        for name, row in map(atom_parts, facts)
        if name in ("offset", "rect")
    }
    whole = numbers["rect", first.name]
    for n in (1, 2):
        west, south, east, north = numbers["rect", f"{first.name}_{n}"]
        middle = numbers["offset", first.name] + numbers["offset", f"{first.name}_{n}"]
        assert west <= middle[0] <= east and south <= middle[1] <= north
        assert np.all(whole[:2] <= [west + 1, south + 1]) and np.all(whole[2:] >= [east - 1, north - 1])
