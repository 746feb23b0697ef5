"""The file of --disturb: errors in it, and the world that it states."""

from pathlib import Path

import pytest
import shapely

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.source_text import source_from_bytes
from utak.simulator.scenario.disturbances import disturbed_world, read_disturbed, stated_disturbances, undisturbed
from utak.simulator.world.world import Thing, World

VERGE = shapely.box(0, 0, 24, 20).difference(shapely.box(2, 2, 22, 18))
WORLD = World(
    24,
    20,
    VERGE,
    (Thing("g1", "g", shapely.box(4, 4, 7, 5)),),
    (Thing("p1", "h", shapely.box(12, 12, 14, 14)),),
    (10.5, 10.5),
    0,
)


def stated(text: str) -> World:
    return disturbed_world(WORLD, source_from_bytes("file.lp", text.encode()))


def test_disturbances_come_in_the_order_of_their_steps() -> None:
    text = 'vanish(g1, 9). lift(utak, "POINT (5.5 9.5)", 2). move(g1, "POINT (8 8)", 2).'
    world = stated(text)
    assert [(act.step, act.name) for act in world.disturbances] == [(2, "utak"), (2, "g1"), (9, "g1")]
    facts = "".join(f"{act.fact}." for act in world.disturbances)
    assert stated_disturbances(facts) == world.disturbances
    assert undisturbed(world) == WORLD


def test_what_appears_lies_beside_the_table_before() -> None:
    world = stated('appear(a1, r, "POLYGON ((8 4, 10 4, 10 6, 8 4))", 3). move(a1, "POINT (8 8)", 4).')
    assert [thing.name for thing in world.movable] == ["a1", "g1"]
    assert world.movable[0].polygon.bounds == (26.0, 4.0, 28.0, 6.0)
    assert undisturbed(world) == WORLD


def test_a_thing_is_put_with_its_centroid_at_the_point() -> None:
    (act,) = stated('move(g1, "POINT (8 8)", 2).').disturbances
    assert act.outline(shapely.box(0, 0, 1, 3), 24).bounds == (7.5, 6.5, 8.5, 9.5)


BAD = {
    'mvoe(g1, "POINT (8 8)", 2).': "1:1-26: error: unknown predicate mvoe/3",
    'move(g1, "POINT (8 8)").': "move takes 3 arguments, not 2",
    'move(g1, "POINT (8 8)", 0).': "1:25-25: error: a step must be from 1",
    'move(g1, "POLYGON ((8 8, 9 8, 9 9, 8 8))", 2).': "a place",
    'lift(g1, "POINT (8 8)", 2).': "unknown robot g1",
    'move(g2, "POINT (8 8)", 2).': "hint: known here: g1",
    'move(p1, "POINT (8 8)", 2).': "p1 is fixed: nobody can move it",
    'move(utak, "POINT (8 8)", 2).': "hint: write lift(utak, ...)",
    'move(g1, "POINT (2.5 8)", 1).': "g1 would overlap the verge",
    'move(g1, "POINT (2.1 8)", 9).': "g1 would overlap the verge",
    'move(g1, "POINT (0 8)", 9).': "g1 would reach beyond the table",
    'move(g1, "POINT (13 13)", 9).': "g1 would overlap p1",
    'lift(utak, "POINT (1 1)", 2).': "1:12-24: error: Utak would stand inside the verge, at (1, 1)",
    'lift(utak, "POINT (30 1)", 2).': "Utak would stand off the table",
    'appear(g1, r, "POLYGON ((8 4, 10 4, 10 6, 8 4))", 3).': "the world has an object g1 already",
    'appear(verge, r, "POLYGON ((8 4, 10 4, 10 6, 8 4))", 3).': "verge is a reserved word",
    'appear(a1, b, "POLYGON ((8 4, 10 4, 10 6, 8 4))", 3).': "colour b is the verge's",
    'appear(a1, r, "POLYGON ((8 4, 40 4, 10 6, 8 4))", 3).': "a1 would reach beyond the table",
    'appear(a1, r, "POLYGON ((8 4, 10 4, 10 6, 8 4))", 3). vanish(a1, 2).': "a1 appears only before command 3",
    'appear(a1, r, "POLYGON ((8 4, 8.001 4, 8 4.001, 8 4))", 3).': "a shape of no size",
    'appear(a1, r, "POLYGON ((3 3, 9 3, 9 9, 3 3), (6 4, 8 4, 8 5, 6 4))", 3).': "has no holes",
    "vanish(g1, 2). p :- q.": "file.lp:1:18",
}


@pytest.mark.parametrize("text", BAD)
def test_errors_are_reported_with_their_place(text: str) -> None:
    with pytest.raises(BadInputError) as caught:
        stated(text)
    assert BAD[text] in str(caught.value)


def test_a_thing_that_may_have_been_turned_is_refused_only_where_it_cannot_lie() -> None:
    assert stated('move(g1, "POINT (2.6 8)", 9).').disturbances  # turned by a right angle it fits
    with pytest.raises(BadInputError):
        stated('move(g1, "POINT (2.6 8)", 2).')  # nothing can be turned yet


def test_a_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "d.lp").write_text("% at once\nvanish(g1, 1).\n")
    assert read_disturbed(WORLD, tmp_path / "d.lp").disturbances[0].fact == "vanish(g1,1)"
