"""What a task calls its parameters changes nothing: not the names of colours, shapes, things or places, either."""

import re

import pytest

import utak

WORLD = "\n".join(
    [
        "b" * 26,
        *["b" + "." * 11 + "bb" + "." * 11 + "b"] * 3,
        "b" + "." * 11 + "bb" + "....ggg....b",
        *["b" + "." * 17 + "ggg" + "." * 4 + "b"] * 2,
        *["b" + "." * 24 + "b"] * 2,
        *["b" + "." * 11 + "bb" + "." * 11 + "b"] * 3,
        "b..U" + "." * 8 + "bb" + "." * 11 + "b",
        "b" * 26,
    ]
)
START = "object(x). shape(x, square). colour(x, g). room(r). in(x, r)."
GOAL = "in(utak, r). at(utak, x)."


def renamed(text: str, x: str, r: str) -> str:
    """Return facts with other names for x and r, where these stand for parameters."""
    return re.sub(r"\b[xr]\b", lambda found: {"x": x, "r": r}[found[0]], text)


def commands_with(x: str, r: str) -> list[str]:
    """Return the commands of the run, and its verdict, with other names for x and r."""
    scenario = utak.Scenario.from_text(world=WORLD, start=renamed(START, x, r), goal=renamed(GOAL, x, r))
    episode = utak.Run(scenario).finish()
    return [*(step.action for step in episode), str(episode.verdict)]


@pytest.fixture(scope="module")
def commands() -> list[str]:
    return commands_with("x", "r")


@pytest.mark.parametrize(("x", "r"), [("g", "square"), ("square", "g"), ("o1", "r1"), ("here", "all")])
def test_the_names_of_parameters_change_no_command(x: str, r: str, commands: list[str]) -> None:
    assert commands[-1] == "done"
    assert commands_with(x, r) == commands
