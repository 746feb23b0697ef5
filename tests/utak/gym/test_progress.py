"""The progress halt after halt, compared with the judgement of whole tracks."""

from typing import Any

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.gym.progress import ExpectationProgress, time_limit
from utak.kb.language.reader import facts_from_text
from utak.kb.language.terms import Fact
from utak.simulator.scenario.expectation import Snapshot, unmet
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.senses import NEIGHBOUR_OFFSETS
from utak.simulator.world.world import Thing, World

VERGE = shapely.box(0, 0, 16, 14).difference(shapely.box(1, 1, 15, 13))
THINGS = (Thing("a", "g", shapely.box(7, 6, 9, 8)), Thing("d", "d", shapely.Polygon([(3, 3), (5, 3), (3, 5)])))
POST = (Thing("p", "h", shapely.box(11, 9, 12, 10)),)
WORLD = World(16, 14, VERGE, THINGS, POST, (6.5, 6.5), 0)
EXPECTED = """
    inside(utak, "POLYGON ((1 1, 9 1, 9 13, 1 13, 1 1))"). inside(a, "POLYGON ((8 1, 15 1, 15 13, 8 13, 8 1))").
    near(utak, "POINT (12 7)", 3). near(a, "POINT (9 9)", 1). near(p, "POINT (12 9)", 1). near(d, "POINT (9 9)", "2.5").
    visits(utak, "POLYGON ((10 1, 15 1, 15 13, 10 13, 10 1))"). visits(a, "POLYGON ((9 1, 15 1, 15 13, 9 13, 9 1))").
    avoids(utak, "POLYGON ((1 1, 3 1, 3 13, 1 13, 1 1))"). avoids(a, "POLYGON ((1 1, 6 1, 6 13, 1 13, 1 1))").
    circles(utak, a). circles(utak, p). unmoved(a). unmoved(d). unmoved(p). within(6).
    pose(a, "POINT (9 7)", 90, "1.5").
    before(visits(utak, "POLYGON ((10 1, 15 1, 15 13, 10 13, 10 1))"),
           visits(a, "POLYGON ((9 1, 15 1, 15 13, 9 13, 9 1))")).
"""
FACTS = facts_from_text(EXPECTED, "expect.lp")
amount = st.integers(-6, 6).map(float)
command = st.one_of(
    st.tuples(st.just("move"), amount, amount),
    st.tuples(st.just("push"), amount, amount),
    st.tuples(st.just("turn"), st.sampled_from([90.0, -45.0])),
    st.tuples(st.just("grasp"), st.sampled_from(sorted(NEIGHBOUR_OFFSETS))),
    st.tuples(st.just("release")),
)
ROUND = [("move", x, y) for x, y in ((0, 3), (4, 0), (0, -6), (-6, 0), (0, 4), (2, 3))]


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(st.lists(command, max_size=10) | st.just(ROUND))
def test_each_expectation_is_met_when_the_whole_track_meets_it(commands: list[Any]) -> None:
    table = Tabletop(WORLD)
    progress = {fact: ExpectationProgress([fact], WORLD) for fact in FACTS}
    together = ExpectationProgress(FACTS, WORLD)
    track: list[Snapshot] = []
    for number, (name, *values) in enumerate([("grasp", "east"), *commands]):
        getattr(table, name)(*values)
        track.append(Snapshot(number, table.utak, dict(table.polygons)))
        missed = unmet(FACTS, WORLD, track)
        for fact, one in progress.items():
            one.see(number, table.utak, table.polygons)
            assert one.achieved == (fact not in missed), str(fact)
        together.see(number, table.utak, table.polygons)
        points = [fact for fact in FACTS if fact.name != "within"]
        assert together.share == pytest.approx(sum(fact not in missed for fact in points) / len(points))
        assert together.achieved == (not missed)


def facts(text: str) -> tuple[Fact, ...]:
    return tuple(facts_from_text(text, "expect.lp"))


def test_weights_are_points() -> None:
    stated = 'near(utak, "POINT (6 6)", 2). unmoved(a). weight(unmoved(a), 3). circles(utak, a). verdict(done).'
    progress = ExpectationProgress(facts(stated), WORLD)
    progress.see(0, WORLD.utak, {thing.name: thing.polygon for thing in THINGS})
    assert progress.share == pytest.approx(4 / 5)
    assert not progress.achieved


def test_what_is_to_fail_is_never_achieved() -> None:
    progress = ExpectationProgress(facts("fails. weight(unmoved(a), 1). unmoved(a)."), WORLD)
    progress.see(0, WORLD.utak, {thing.name: thing.polygon for thing in THINGS})
    assert not progress.achieved


def test_the_time_limit_is_the_least_one() -> None:
    assert time_limit(facts("within(9). within(4). unmoved(a).")) == 4
    assert time_limit(()) is None
