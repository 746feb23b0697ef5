"""Passages that fill no whole square: walks against the wall, each line once, and the way on behind it."""

import math
from dataclasses import replace

import numpy as np
import pytest

import utak
from tests.planner.situations import all_felt, known_situation, situation_of, tools_with, turn_of
from utak.kb.body import Move
from utak.kb.language.reader import facts_from_text
from utak.kb.localisation.hypotheses.walk_outcomes import squares_passed
from utak.planner.deciding.feeling import Passages
from utak.planner.screen.moves import EDGE_OFFSET
from utak.planner.sights.passages import SAME_LINE
from utak.planner.situation import Situation
from utak.planner.stages import Stage

TWO = ["b" * 16, *["b" + "." * 6 + "bb" + "." * 6 + "b"] * 4, "b...U..bb......b", "b" * 16]
WALK = Stage(facts_from_text("in(utak, room(next))."))
BEYOND = 'inside(utak, "POLYGON ((8 1, 13 1, 13 6, 8 6, 8 1))").'
OUTER = "(0 0, 0 7, 14 7, 14 0, 0 0)"


def two_rooms(low: float, high: float, heading: int) -> str:
    """Return two rooms with an opening in the wall between them, from y = low to y = high."""
    west, east = f"6 1, 6 {low}, 8 {low}, 8 1", f"8 6, 8 {high}, 6 {high}, 6 6"
    verge = f"POLYGON ({OUTER}, (1 1, {west}, 13 1, 13 6, {east}, 1 6, 1 1))"
    return f'table(14, 7). verge("{verge}"). utak("POINT (3.5 4.5)", {heading}).'


def test_each_line_through_the_wall_is_walked_once() -> None:
    model, passages, tools, ends = all_felt(known_situation(TWO).model), Passages(), tools_with(), list[float]()
    for _ in range(80):
        turn = turn_of(WALK, situation_of(model), tools)
        decision = passages.next(turn)
        if not decision:
            break
        assert isinstance(decision.command, Move)
        east, north = decision.command.east, decision.command.north
        x, y = model.place
        if x > 2 and east > 2:  # a walk at the wall, which lets nothing through
            assert north == 0
            assert math.floor(x + east) == 5  # behind the wall
            ends.append(y)
            x = 3 - 1e-6
        else:
            x, y = x + east, y + north
        model = replace(model, place=(x, y))
    rows = {math.floor(y) for y in ends}
    assert rows == {0, 1, 2, 3, 4}
    gaps = np.diff(sorted(ends))
    assert gaps.min() > SAME_LINE
    assert gaps.max() < 2 * EDGE_OFFSET


def test_no_walk_where_no_floor_is_seen_beyond() -> None:
    one = [*TWO[:3], "b" + "." * 14 + "b", *TWO[4:]]
    assert not Passages().next(turn_of(WALK, all_felt_situation(one)))


def all_felt_situation(rows: list[str]) -> Situation:
    """Return the situation in a drawing of which all walls were felt."""
    return situation_of(all_felt(known_situation(rows).model))


@pytest.mark.long
@pytest.mark.parametrize(("low", "high", "heading"), [(2.05, 3.95, 0), (3.6, 4.3, 180)])
def test_the_robot_goes_on_through_an_opening_that_fills_no_square(low: float, high: float, heading: int) -> None:
    scenario = utak.Scenario.from_text(two_rooms(low, high, heading), "in(utak, room(next)).", expect=BEYOND)
    episode = utak.Run(scenario).finish()
    assert (episode.verdict, episode.achieved) == ("done", True)


def test_squares_that_a_way_leads_through() -> None:
    assert set(squares_passed((0.5, 0.5), (3.5, 0.5))) == {(0, 0), (1, 0), (2, 0), (3, 0)}
    assert set(squares_passed((0.5, 0.5), (2.5, 2.5))) == {(0, 0), (1, 1), (2, 2)}  # not those beside a corner
    assert squares_passed((0.5, 1.0), (3.5, 1.0)) == ()  # along a grid line
    assert set(squares_passed((0.5, 0.5), (1.05, 0.5))) == {(0, 0)}  # hardly entered
    assert squares_passed((0.5, 0.5), (0.5, 0.5)) == ()
