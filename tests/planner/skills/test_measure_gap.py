"""Passages that the robot measures: what is surely too wide for one is told so, and what is not is never."""

from dataclasses import replace

import pytest

import utak
from tests.kb.drawings import known_model
from utak.geometry.cspace.bottleneck import Bottleneck
from utak.planner.skills.measure_gap import STEP_BACK, GapMeasurer


def rooms(south: str, north: str) -> utak.Scenario:
    """Return two rooms with a door from one height to another, and a square of 4 in the western one."""
    inside = f"(2 2, 21 2, 21 {south}, 23 {south}, 23 2, 42 2, 42 20, 23 20, 23 {north}, 21 {north}, 21 20, 2 20, 2 2)"
    return utak.Scenario.from_text(
        world=f"""table(44, 22). verge("POLYGON ((0 0, 0 22, 44 22, 44 0, 0 0), {inside})").
        utak("POINT (10.5 14.5)", 0). object(g1, g, "POLYGON ((6 5, 6 9, 10 9, 10 5, 6 5))").""",
        start="object(x).",
        goal="in(x, room(next)).",
    )


@pytest.mark.long
@pytest.mark.parametrize(("south", "north"), [("9", "12"), ("9", "12.03"), ("8.5", "12.55"), ("9", "13.1")])
def test_what_is_measured_too_narrow_is_impossible_and_what_fits_is_not(south: str, north: str) -> None:
    """Doors between the squares look as narrow as others; 4.05 and 4.1 squares are wide enough."""
    episode = utak.Run(rooms(south, north), max_steps=120).finish()
    if float(north) - float(south) < 4:
        assert episode.verdict == "impossible" and "too narrow" in episode.reason
        measured = [step for step in episode if "how wide a passage" in step.line["why"]]
        assert len(measured) <= 5  # to the door, against each side and back from it
    else:
        assert episode.verdict not in ("impossible",)


DOOR = [
    "bbbbbbbbbbbbbb",
    "b.....bb.....b",
    "b.....bb.....b",
    "b.....bb.....b",
    "b............b",
    "b..U.........b",
    "b.....bb.....b",
    "b.....bb.....b",
    "bbbbbbbbbbbbbb",
]


def test_the_step_back_from_a_wall_comes_next_and_another_row_is_measured_where_it_does_not() -> None:
    model = known_model(DOOR)
    row, column = model.view.locate(*model.place)
    wall = column + 3
    sides = (float(wall), float(row)), (float(wall), float(row + 2))
    passage, gaps = Bottleneck((float(wall), row + 1.0), sides, 2.0), GapMeasurer()
    first = gaps.gap_of(passage, model)
    assert first is not None and len(first.squares) == 2 and not gaps.is_at_wall(1)
    inside = replace(model, touch=(None,) * 8, place=(first.squares[0][0] + 0.5, first.squares[0][1] + 0.5))
    end = gaps.end_of_walk(first, 1, inside)
    assert end is not None and end[1] < first.squares[0][1]
    assert gaps.is_at_wall(2) and not gaps.is_at_wall(3)
    assert gaps.step_back(2, inside) == pytest.approx((inside.place[0], inside.place[1] + STEP_BACK))
    assert not gaps.is_at_wall(3)
    gaps.note(4, inside)  # something else was done between
    assert gaps.is_exact(first) is False
    other = gaps.gap_of(passage, model)
    assert other is not None and other != first and gaps.is_exact(other) is None


@pytest.mark.long
@pytest.mark.parametrize(("wide", "verdict"), [(2, "impossible"), (3, "done")])
def test_a_goal_behind_a_measured_passage_is_impossible_where_too_little_room_is_before_it(
    wide: int, verdict: str
) -> None:
    """What is around a corner begins before the passage: its first squares have no room for a brick."""
    floor = f"(2 14, 2 24, 18 24, 18 14, {2 + wide} 14, {2 + wide} 2, 2 2, 2 14)"
    scenario = utak.Scenario.from_text(
        world=f"""table(20, 26). verge("POLYGON ((0 0, 0 26, 20 26, 20 0, 0 0), {floor})").
        utak("POINT (4.5 15.5)", 0). object(g1, g, "POLYGON ((9 18, 9 21, 14 21, 14 18, 9 18))").""",
        start="object(x).",
        goal="around(x, corner).",
    )
    episode = utak.Run(scenario, max_steps=120).finish()
    assert episode.verdict == verdict, episode.reason
