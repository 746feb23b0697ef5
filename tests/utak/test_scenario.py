"""Scenarios from folders and texts, and how errors in texts are named."""

import copy
from pathlib import Path
from xml.etree import ElementTree

import pytest

import utak

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
WORLD = """
    bbbbbbbbbb
    b........b
    b..gg....b
    b.U......b
    bbbbbbbbbb
"""


def test_a_scenario_from_texts_is_that_from_files(tmp_path: Path) -> None:
    texts = {
        "world.txt": "bbbbbbbbbb\nb........b\nb..gg....b\nb.U......b\nbbbbbbbbbb\n",
        "start.lp": "object(x). confidence(colour(x, g), 80).",
        "goal.lp": "at(utak, x).",
        "expect.lp": "within(9).",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    read = utak.Scenario.read(tmp_path)
    made = utak.Scenario.from_text(WORLD, texts["goal.lp"], texts["start.lp"], texts["expect.lp"])
    assert made.content == read.content
    assert (made.name, read.name) == ("", tmp_path.name)
    assert made.picture == texts["world.txt"]
    assert made.goals == ("at(utak,x)",)
    assert made.expectations == ("within(9)",)


def test_a_world_of_facts_may_be_a_text_too() -> None:
    text = (EXAMPLES / "go_next_room" / "world.lp").read_text()
    made = utak.Scenario.from_text(text, "in(utak, room(next)).")
    assert made.content.world == utak.Scenario.read(EXAMPLES / "go_next_room").content.world
    assert made.expectations is None


@pytest.mark.parametrize(
    ("texts", "place"),
    [
        ({"goal": "at(utak, cornr(northeast))."}, "goal.lp:1:10-25: error: unknown place"),
        ({"world": "bbb\nbU?b\nbbb"}, "world.txt:2:1-4: error"),
        ({"start": "object(x)"}, "start.lp:1:"),
        ({"goal": "at(utak, x)."}, "goal.lp:1:10-10: error"),
        ({"expect": "inside(q, 3)."}, "expect.lp:1:"),
        ({"goal": "at(utak, größe)."}, "goal.lp:1:"),
        ({"world": ""}, "world.txt:1:1-1: error"),
    ],
)
def test_errors_in_texts_are_named_as_if_they_were_files(texts: dict[str, str], place: str) -> None:
    with pytest.raises(utak.BadInputError) as caught:
        utak.Scenario.from_text(**{"world": WORLD, "goal": "at(utak, corner(northeast)).", **texts})
    assert str(caught.value).startswith(place)


def test_a_folder_that_is_not_there_cannot_be_opened() -> None:
    with pytest.raises(utak.CannotOpenError, match="no such folder"):
        utak.Scenario.read("nowhere")


def test_another_task_keeps_the_world_and_the_parameters() -> None:
    start = "object(x). shape(x, square). confidence(colour(x, g), 80)."
    scenario = utak.Scenario.from_text(WORLD, "at(utak, x).", start, "within(3).")
    other = scenario.with_task("beside(utak, x).")
    assert other.content.world is scenario.content.world
    assert other.content.task.claims == scenario.content.task.claims
    assert other.content.task.parameters == scenario.content.task.parameters
    assert (other.goals, other.expectations) == (("beside(utak,x)",), None)
    assert scenario.with_task("at(utak, y).", start="object(y).", expect="within(2).").expectations == ("within(2)",)
    with pytest.raises(utak.BadInputError, match=r"goal\.lp:1"):
        scenario.with_task("at(utak, z).")


def test_a_scenario_shows_itself() -> None:
    scenario = utak.Scenario.from_text(WORLD, "at(utak, corner(northeast)).")
    assert repr(scenario) == "<Scenario: 10 x 5 squares, 1 thing; at(utak,corner(northeast))>"
    picture = ElementTree.fromstring(scenario._repr_svg_())
    assert (picture.get("width"), picture.get("height")) == ("100", "50")
    assert "g1" in [title.text for title in picture.iter("{http://www.w3.org/2000/svg}title")]
    assert scenario._repr_svg_() in scenario._repr_html_()
    assert copy.deepcopy(scenario) is scenario
