"""Claims of start.lp about where and what things, doors and rooms are at first: whole runs in three rooms in a row."""

import re

import pytest

from tests.tables import few
from utak import Episode, Run, Scenario
from utak.kb.language.diagnostics import BadInputError

WIDTH, HEIGHT = 70, 26
WEST, MIDDLE, EAST = (2, 22), (24, 45), (47, 68)  # columns of the rooms
ROBOT_WEST, ROBOT_MIDDLE = (12, 16), (30, 16)
Thing = tuple[int, int, int, int, str]  # column and row from the north, width, height, colour


def world(things: list[Thing], robot: tuple[int, int]) -> str:
    """Return three rooms in a row as a picture: the west door is 4 squares wide, the east door 7."""
    rows = [
        ["b" if x < 2 or x >= WIDTH - 2 or y < 2 or y >= HEIGHT - 2 else "." for x in range(WIDTH)]
        for y in range(HEIGHT)
    ]
    for y in range(HEIGHT):
        for wall, door in (((22, 23), range(10, 14)), ((45, 46), range(9, 16))):
            for x in wall:
                rows[y][x] = "." if y in door else "b"
    for x, y, width, height, colour in things:
        for row in rows[y : y + height]:
            row[x : x + width] = [colour] * width
    rows[robot[1]][robot[0]] = "U"
    return "\n".join("".join(row) for row in rows) + "\n"


SQUARE_WEST, SQUARE_MIDDLE, SQUARE_EAST = (8, 5, 3, 3, "g"), (30, 5, 3, 3, "h"), (55, 5, 3, 3, "k")
# By what is claimed: start, goal, things, where the robot wakes, and in which columns the goal's subject ends.
CASES = {
    "a thing in the next room": (
        "object(x). shape(x, square). in(x, room(next)).",
        "at(utak, x).",
        [SQUARE_WEST, SQUARE_MIDDLE],
        ROBOT_WEST,
        MIDDLE,
    ),
    "a thing beside another": (
        "object(x). shape(x, square). object(y). shape(y, brick). beside(x, y).",
        "at(utak, x).",
        [SQUARE_WEST, SQUARE_MIDDLE, (33, 5, 3, 6, "k")],
        ROBOT_WEST,
        MIDDLE,
    ),
    "a wide door": ("door(d). width(d, 7).", "through(utak, d).", [], ROBOT_MIDDLE, EAST),
    "a narrow door": ('door(d). width(d, "4.0").', "through(utak, d).", [], ROBOT_MIDDLE, WEST),
    "a door between two rooms": (
        "object(x). shape(x, square). in(x, r). door(d). room(r). room(s). connects(d, r, s). width(d, 7).",
        "at(utak, x).",
        [SQUARE_WEST, SQUARE_EAST],
        ROBOT_WEST,
        EAST,
    ),
    "the room of a thing": (
        "object(x). shape(x, brick). room(r). in(x, r).",
        "in(utak, r).",
        [SQUARE_WEST, (60, 10, 3, 6, "k")],
        ROBOT_WEST,
        EAST,
    ),
    "a thing at a corner": (
        "object(x). shape(x, square). at(x, corner(northeast)).",
        "at(utak, x).",
        [SQUARE_WEST, (64, 3, 3, 3, "h")],
        ROBOT_WEST,
        EAST,
    ),
    "a constraint about a door that is known by its width": (
        "object(x). shape(x, square). door(d). width(d, 7).",
        "at(utak, x). not_through(utak, d).",
        [SQUARE_WEST, SQUARE_EAST],
        ROBOT_MIDDLE,
        WEST,
    ),
}


def finished(start: str, goal: str, things: list[Thing], robot: tuple[int, int]) -> Episode:
    """Return the episode of a run."""
    return Run(Scenario.from_text(world=world(things, robot), start=start, goal=goal)).finish()


@pytest.mark.parametrize("what", few(CASES, ["a thing in the next room", "a narrow door"]))
def test_what_is_claimed_decides_what_is_meant(what: str) -> None:
    start, goal, things, robot, (first, last) = CASES[what]
    episode = finished(start, goal, things, robot)
    assert episode.verdict == "done"
    assert first <= episode[-1].utak[0] <= last


@pytest.mark.long
def test_a_thing_that_is_brought_elsewhere_is_still_the_one_that_was_in_the_next_room() -> None:
    claims = "object(x). shape(x, square). in(x, room(next))."
    episode = finished(claims, "at(x, start).", [SQUARE_WEST, SQUARE_MIDDLE], ROBOT_WEST)
    assert episode.verdict == "done"
    began, ended = (step.line["objects"] for step in (episode[0], episode[-1]))
    assert began["g1"] == ended["g1"]
    assert began["h1"] != ended["h1"]


@pytest.mark.long
def test_a_claim_that_what_is_seen_contradicts_is_reported() -> None:
    episode = finished("object(x). shape(x, square). size(x, 30).", "at(utak, x).", [SQUARE_WEST], ROBOT_WEST)
    assert episode.verdict != "done"
    assert "o1 is not: its size is not as claimed" in episode.reason


@pytest.mark.parametrize(
    ("start", "told"),
    [
        ("object(x). width(x, 4).", "x is an object; width wants a door here"),
        ("object(x). in(x, r).", "r is not introduced in start.lp"),
        ("object(x). beside(x, x).", "beside relates x to itself"),
        ("object(x). at(x, northeast).", "at wants corner(northeast) here, not northeast"),
        ("object(x). size(x, 9). size(x, 8).", "size(x,8) contradicts size(x,9)"),
        ("door(d). room(r). connects(d, r, r).", "connects relates r to itself"),
        ("object(x). in(x, room(last)).", "unknown"),
        ("door(d). width(d, wide).", "a width in squares must be a number, not wide"),
    ],
)
def test_claims_that_say_nothing_are_refused(start: str, told: str) -> None:
    with pytest.raises(BadInputError, match=re.escape(told)):
        Scenario.from_text(world=world([], ROBOT_WEST), start=start, goal="at(utak, start).")


def test_a_colour_may_have_the_name_of_a_parameter() -> None:
    start = "object(x). object(g). colour(x, x). colour(g, g)."
    scenario = Scenario.from_text(world=world([], ROBOT_WEST), start=start, goal="at(x, g).")
    assert [str(goal) for goal in scenario.goals] == ["at(x,g)"]
