"""Of goals that name two things, or a thing and a place, whichever may be moved is moved."""

import pytest

import utak
from tests.planner.goals.test_object_goals import facts_from_text
from tests.planner.situations import known_situation, situation_of
from tests.tables import few
from utak.kb.language.diagnostics import SourceSpan
from utak.kb.task.task import Parameter, Task
from utak.planner.goals.references import as_meant, is_moved_for_others_only
from utak.planner.stages import Stage

NOWHERE = SourceSpan(0, 0, 0)
TASK = Task({name: Parameter(name, "object", NOWHERE) for name in "xyz"}, (), ())


def meant(text: str, holding: tuple[str, ...] = (), other_way: bool = False) -> tuple[list[str], list[str]]:
    """Return the goals of a stage as they are met, and those that come later. holding : those that hold."""
    situation = situation_of(known_situation(["bbb", "bUb", "bbb"]).model, task=TASK)
    stage = as_meant(Stage(facts_from_text(text)), situation, lambda goal: str(goal) in holding, other_way)
    return list(map(str, stage.goals)), list(map(str, stage.later))


@pytest.mark.parametrize(
    ("text", "goals"),
    [
        ("beside(x, y).", ["beside(x,y)"]),
        ("beside(x, y). at(x, corner(northeast)).", ["at(x,corner(northeast))", "beside(y,x)"]),
        ("at(x, corner(northeast)). beside(y, x).", ["at(x,corner(northeast))", "beside(y,x)"]),
        ("at(x, y). in(x, room(next)).", ["in(x,room(next))", "at(y,x)"]),
        ("beside(x, y). beside(y, z).", ["beside(x,y)", "beside(z,y)"]),
        ("at(x, start).", ["at(x,start)"]),
    ],
)
def test_the_thing_that_no_other_goal_puts_in_a_place_is_moved_after_the_other(text: str, goals: list[str]) -> None:
    found, later = meant(text)
    assert found + later == goals


def test_a_goal_about_what_is_still_to_be_brought_elsewhere_comes_later() -> None:
    text = "beside(x, y). at(x, corner(northeast))."
    assert meant(text) == (["at(x,corner(northeast))"], ["beside(y,x)"])
    assert meant(text, ("at(x,corner(northeast))",))[1] == []


def test_the_other_of_two_things_is_moved_where_that_is_asked() -> None:
    assert meant("beside(x, y).", other_way=True)[0] == ["beside(y,x)"]


def test_a_thing_that_only_stands_to_others_need_not_be_moved() -> None:
    beside, corner = facts_from_text("beside(x, y). at(x, corner(northeast)).")
    assert is_moved_for_others_only("x", [beside], "xy")
    assert not is_moved_for_others_only("x", [beside, corner], "xy")


TWO_THINGS = "object(x). shape(x, square). object(y). shape(y, brick)."
HALL = """\
bbbbbbbbbbbbbbbbbbbbbbbbbb
b........................b
b........................b
b........................b
b....cccc.........dd.....b
b....cccc.........dd.....b
b....cccc.........dd.....b
b....cccc.........dd.....b
b........................b
b...........U............b
b........................b
bbbbbbbbbbbbbbbbbbbbbbbbbb
"""


@pytest.mark.parametrize(
    "goal",
    few(
        [
            "at(utak, x). at(utak, start).",
            "at(utak, x). at(utak, y).",
            "at(utak, y). at(utak, corner(northwest)).",  # longer than the room beside the corner on either side of it
            "beside(x, y). at(x, corner(southwest)).",
            "circled(utak, x).",
        ],
        1,
    ),
)
def test_the_thing_that_a_goal_refers_to_is_brought(goal: str) -> None:
    start, world = TWO_THINGS, HALL
    if goal.startswith("circled"):  # off the wall at which it stands
        start = "object(x). shape(x, square)."
        world = HALL.replace("b....cccc", "bcccc....").replace("dd", "..")
    episode = utak.Run(utak.Scenario.from_text(world=world, start=start, goal=goal), seed=1).finish()
    assert episode.verdict == "done"


@pytest.mark.long
def test_the_whole_track_winds_about_what_was_drawn_off_a_wall_also_after_the_way_back() -> None:
    world = """table(21, 24).
verge("POLYGON ((0 0, 0 24, 21 24, 21 0, 0 0), (20 2, 20 23, 2 23, 2 2, 20 2))").
utak("POINT (11.5 7.5)", 180).
object(t1, l, "POLYGON ((2 2, 2 6, 6 6, 6 2, 2 2))").
"""
    start, goal = "object(x). shape(x, square).", "circled(utak, x). at(utak, start)."
    scenario = utak.Scenario.from_text(world=world, start=start, goal=goal, expect="circles(utak, t1).")
    episode = utak.Run(scenario).finish()
    assert (episode.verdict, episode.achieved) == ("done", True)
