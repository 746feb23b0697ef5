"""start.lp and goal.lp: vocabulary, parameters, contradictions."""

from pathlib import Path

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.reader import facts_from_text
from utak.kb.task.task import Task, read_task


def task(folder: Path, start: str, goal: str) -> Task:
    (folder / "start.lp").write_text(start)
    (folder / "goal.lp").write_text(goal)
    return read_task(folder / "start.lp", folder / "goal.lp")


def refused(folder: Path, start: str, goal: str) -> str:
    with pytest.raises(BadInputError) as caught:
        task(folder, start, goal)
    return str(caught.value)


def test_a_task_is_parameters_claims_and_goals(tmp_path: Path) -> None:
    start = "object(x). door(d). room(r). shape(x, brick). confidence(colour(x, g), 80). shape(x, rectangle)."
    found = task(tmp_path, start, "first(through(x, d)). then(in(utak, r)). not_through(utak, d).")
    assert {name: p.kind for name, p in found.parameters.items()} == {"x": "object", "d": "door", "r": "room"}
    assert [(str(c.fact), c.confidence) for c in found.claims] == [
        ("shape(x,brick)", 100),
        ("colour(x,g)", 80),
        ("shape(x,rectangle)", 100),
    ]
    assert [str(g) for g in found.goals] == ["first(through(x,d))", "then(in(utak,r))", "not_through(utak,d)"]


START = "object(x). object(y). door(d). room(r).\n"
GOALS = [
    "at(utak, corner(northeast)).",
    "at(x, corner(southwest)).",
    "at(x, y).",
    "at(utak, start).",
    "in(utak, room(next)).",
    "in(x, r).",
    "through(x, d).",
    "around(x, corner).",
    "circled(utak, x).",
    "beside(x, y).",
    'pose(x, "POINT (3 -4.5)", -90).',
]


@pytest.mark.parametrize("goal", GOALS)
def test_every_goal_of_the_design_is_read(goal: str, tmp_path: Path) -> None:
    assert len(task(tmp_path, START, goal).goals) == 1


def test_a_step_may_be_repeated(tmp_path: Path) -> None:
    found = task(tmp_path, "", "first(at(utak, start)). then(at(utak, corner(northeast))). then(at(utak, start)).")
    assert [str(g) for g in found.goals][0::2] == ["first(at(utak,start))", "then(at(utak,start))"]
    again = "first(at(utak, start)). then(at(utak, corner(northeast))). then(at(utak, start)). then(at(utak, start))."
    assert len(task(tmp_path, "", again).goals) == 4


def test_goals_name_parameters(tmp_path: Path) -> None:
    wished = "at(utak, x). prefer(at(y, start), 3). carry_nothing_through(d)."
    assert task(tmp_path, START, wished).goal_parameters == {"x", "y", "d"}
    assert task(tmp_path, START, "first(at(utak, x)). then(through(y, d)).").goal_parameters == {"x", "y", "d"}


BAD = {
    ("object(not). shape(not, square).", "at(utak, not)."): "not is a word of the language and cannot name anything",
    ("", "at(utak, start). at(utak, start)."): "stated twice",
    ("door(d).", "at(utak, start). not_through(utak, d). not_through(utak, d)."): "stated twice",
    ("", "first(at(utak, start)). first(at(utak, start))."): "must come before",
    ("", "at(utak, x)."): "x is not introduced in start.lp",
    ("object(box).", "at(utak, bok)."): "did you mean box?",
    ("object(x). shape(x, sqare).", "at(utak, x)."): "did you mean square?",
    ("object(x). shpe(x, square).", "at(utak, x)."): "did you mean shape?",
    ("object(x, y).", "at(utak, start)."): "object takes 1 argument, not 2",
    ("object(x). shape(y, square).", "at(utak, x)."): "y is not introduced",
    ("object(x). shape(x, square). shape(x, disc).", "at(utak, x)."): "contradicts shape(x,square)",
    ("object(x). colour(x, g). colour(x, c).", "at(utak, x)."): "contradicts colour(x,g)",
    ("object(x). colour(x, green).", "at(utak, x)."): "a single lower-case letter",
    ("object(x). object(x).", "at(utak, x)."): "stated twice",
    ("object(x). door(x).", "at(utak, x)."): "x is already an object",
    ("object(utak).", "at(utak, start)."): "reserved word",
    ("object(x). confidence(shape(x, square), 101).", "at(utak, x)."): "from 0 to 100, not 101",
    ("object(x). confidence(shape(x, blob), 50).", "at(utak, x)."): "unknown shape blob",
    ("object(x). shape(x, square). confidence(shape(x, square), 80).", "at(utak, x)."): "with confidence 100 and 80",
    ("door(d). shape(d, square).", "at(utak, start)."): "d is a door; shape wants an object here",
    ("", ""): "the goal is empty",
    ("door(d).", "not_through(utak, d)."): "the goal is empty",
    ("", "at(utak, corner(north))."): "unknown corner north",
    ("", "at(utak, corner)."): "wants an object or start here, not corner",
    ("", "at(utak, edge(northeast))."): "unknown place edge(northeast)",
    ("door(d).", "at(utak, d)."): "d is a door; at wants an object or start here",
    ("object(x).", "in(utak, x)."): "x is an object; in wants a room here",
    ("", "in(utak, room(other))."): "unknown room other",
    ("object(x).", 'pose(x, "POLYGON ((0 0, 1 0, 1 1, 0 0))", 0).'): "a shape here is a POINT",
    ("object(x).", "pose(x, 3, 0)."): "must be a quoted text",
    ("object(x).", "circled(x, x)."): "unknown walker x",
    ("object(x).", "at(x, x)."): "relates x to itself",
    ("", "then(at(utak, start))."): "without anything before it",
    ("", "at(utak, start). first(at(utak, corner(northeast)))."): "must come before",
    ("", "first(first(at(utak, start)))."): "unknown predicate first/1",
    ("", 'avoid(utak, "POLYGON ((0 0, 1 0, 1 1, 0 0))").'): "the goal is empty",
    ("", 'at(utak, start). avoid(utak, "POINT (1 1)").'): "a shape here is a POLYGON or MULTIPOLYGON",
    ("", 'at(utak, start). avoid(utak, "POLYGON ((0 0, 1 0, 1 1))").'): "goal.lp:1:",
    ("door(d).", 'at(utak, start). avoid(d, "POLYGON ((0 0, 1 0, 1 1, 0 0))").'): "avoid wants an object or utak here",
    ("", 'first(avoid(utak, "POLYGON ((0 0, 1 0, 1 1, 0 0))")).'): "needs something to attain, not a constraint",
    ("object(x).", "at(utak, x). carry_nothing_through(x)."): "x is an object; carry_nothing_through wants a door here",
    ("door(d).", "at(utak, start). carry_nothing_trough(d)."): "did you mean carry_nothing_through?",
    ("door(d).", "carry_nothing_through(d)."): "the goal is empty",
    ("object(x).", "prefer(at(x, start), 3)."): "the goal is empty",
    ("object(x).", "at(utak, x). prefer(at(x, start), -1)."): "must be from 0 to 1000000, not -1",
    ("object(x).", "at(utak, x). prefer(at(y, start), 1)."): "y is not introduced",
    ("object(x).", "at(utak, x). prefer(at(utak, x), 1)."): "is a goal already, and no wish",
    ("object(x).", "at(utak, x). prefer(circled(utak, x), 1)."): "needs a goal that a place fulfils",
    (
        "object(x). door(d).",
        "at(utak, x). prefer(not_through(x, d), 1).",
    ): "needs something to attain, not a constraint",
    ("object(x).", "at(utak, x). prefer(prefer(at(x, start), 1), 1)."): "unknown predicate prefer/2",
}


@pytest.mark.parametrize(("start", "goal"), BAD)
def test_errors_of_a_task_are_reported(start: str, goal: str, tmp_path: Path) -> None:
    assert BAD[start, goal] in refused(tmp_path, start, goal)


def test_the_problems_of_both_files_are_reported_together(tmp_path: Path) -> None:
    text = refused(tmp_path, "objekt(x).", "att(utak, start).")
    assert "start.lp:1:1-9: error: unknown predicate objekt/1" in text
    assert "goal.lp:1:1-16: error: unknown predicate att/2" in text


@settings(deadline=None)
@given(st.from_regex(r"\A(_{0,2}[a-z][A-Za-z0-9_']{0,4}|not)\Z"))
def test_clingo_accepts_every_parameter_name(name: str) -> None:
    try:
        facts_from_text(f"object({name}).")
    except BadInputError:
        return
    assert str(clingo.parse_term(f"wanted({name})")) == f"wanted({name})"


def test_hints_name_what_may_stand_there(tmp_path: Path) -> None:
    for goal, hint in (
        ("in(x, d).", "write room(d). in start.lp"),
        ("through(utak, d).", "write door(d). in start.lp"),
        ("beside(x, d).", "write object(d). in start.lp"),
        ("at(x, 2.5).", 'quoted where one may stand: "2.5"'),
    ):
        (tmp_path / "start.lp").write_text("object(x).\n")
        (tmp_path / "goal.lp").write_text(goal)
        with pytest.raises(BadInputError) as caught:
            read_task(tmp_path / "start.lp", tmp_path / "goal.lp")
        assert hint in str(caught.value), goal
