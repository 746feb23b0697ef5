"""What explanations say of things that were in hand, of plans and of doors is so, in runs of small worlds."""

from pathlib import Path

import pytest

from utak.kb.language.atoms import atom_parts
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.explaining.questions import Questions, questions_of_episode

THING = ["b" * 24, *["b......................b"] * 6, *["b.....ggg......U.......b"], *["b.....ggg..............b"] * 2]
ROOM = [*THING, *["b......................b"] * 4, "b" * 24]
FLOOR, STEM, BAR = ROOM[1], "b...........gg.........b", "b.........gggggg.......b"
CROSS = [
    ROOM[0],
    *[FLOOR] * 2,
    *[STEM] * 2,
    *[BAR] * 2,
    *[STEM] * 2,
    *[FLOOR] * 3,
    "b.....U................b",
    FLOOR,
    ROOM[0],
]
WALL, GAP = "b...................b..................bb", "b......................................bb"
WOKEN = WALL[:36] + "U" + WALL[37:]  # the doors are seen from afar, and one of them wider than it is
ROWS = [*[WALL] * 4, *[GAP] * 5, WOKEN, *[WALL] * 2, *[GAP] * 5, *[WALL] * 5]
SOUTH = ":- brought(X, _, _, T), offset(X, _, N), N < -2000.\n"  # with it doors are circumstances of refutations
TWO_DOORS = ["b" * 41, "b" * 41, *ROWS, "b" * 41]


def asked(folder: Path, world: list[str], start: str, goal: str, rule: str = "") -> Questions:
    """Run a scenario for at most 20 steps, with a user's rule, and return the questions about it."""
    for name, text in {"world.txt": "\n".join(world) + "\n", "start.lp": start, "goal.lp": goal}.items():
        (folder / name).write_text(text)
    log = folder / "ep.jsonl"
    (folder / "rule.lp").write_text(rule)
    rules = ["--kb", str(folder / "rule.lp")] if rule else []
    assert main(["run", str(folder), "--max-steps", "20", "--log", str(log), *rules]) in (0, 1, 75)
    return questions_of_episode(read_episode(log), rules[1:])


@pytest.fixture(scope="module")
def carried(tmp_path_factory: pytest.TempPathFactory) -> Questions:
    """A square is brought into the southwest corner, and let go of on the way to where the robot shall be."""
    goal = "at(x, corner(southwest)). at(utak, start).\n"
    return asked(tmp_path_factory.mktemp("carried"), ROOM, "object(x). shape(x, square).\n", goal)


def test_what_was_in_hand_is_said_to_have_been(carried: Questions) -> None:
    steps = carried.beliefs.record.steps
    held = {fact: step.number for step in steps for fact in step.facts if fact.startswith("held(")}
    ((fact, last),) = held.items()
    assert last < carried.last_step
    assert carried.why_not(fact).because == f"it was in hand up to step {last} and is no longer"
    assert carried.why_not(fact, 0).because.endswith("nothing that was seen, felt or done says this of it")


def test_another_class_of_shapes_would_be_believed_if_it_came_first(carried: Questions) -> None:
    """Nothing else would have to be so: neither more squares settled nor another fit of a third class."""
    absence = carried.why_not("shape(o1,t_shape,C)").data
    changed = [*absence["missing"], *absence["in_way"]]
    assert absence["missing"][0].startswith("fit(o1,t_shape,") and absence["missing"][0].endswith(",1)")
    assert len(changed) == 3 and all(fact.startswith(("fit(o1,t_shape,", "fit(o1,square,")) for fact in changed)


def test_where_a_thing_is_of_no_class_one_is_asked_for_as_surely_as_any_can_be(tmp_path: Path) -> None:
    """A cross: no class fits, and each has a few percent at most."""
    questions = asked(tmp_path, CROSS, "object(x).\n", "at(utak, x).\n")
    shapes = [fact for fact in questions.beliefs.record.steps[-1].facts if fact.startswith("shape(o1,")]
    percents = {name: int(percent) for _, name, percent in (atom_parts(fact.rstrip("."))[1] for fact in shapes)}
    assert percents.pop("polygon") >= 90 and percents.pop("rectangle") < 50
    last, first = (chosen(percents, key=lambda name: percents[name]) for chosen in (min, max))
    assert percents[last] < percents[first] < 50
    absence = questions.why_not(f"shape(o1,{last},C)")
    assert absence.data["atom"] == f"shape(o1,{last},{percents[first]})"


def test_a_step_of_the_plan_to_nowhere_was_not_offered(carried: Questions) -> None:
    plans = [(s.number, f) for s in carried.beliefs.record.steps for f in s.facts if f.startswith("plan(0,carry(")]
    step, fact = plans[0]
    nowhere = f"plan(0,carry({fact[len('plan(0,carry(') :].partition(',')[0]},nowhere))"
    assert carried.why_not(nowhere, step).because == "no such step was offered when the plan was made; it states this"


def test_a_felt_colour_rests_on_a_touch_of_that_thing(carried: Questions) -> None:
    """Also after the thing was moved to other squares than those where it was felt."""
    facts = carried.beliefs.record.steps[carried.last_step].facts
    (colour,) = [fact for fact in facts if fact.startswith("colour(")]
    (touch,) = carried.why(colour).rests_on
    because = carried.why_not(colour.replace(",g,", ",r,")).because
    assert because == "it would have to be felt so; this is believed instead"
    direction = touch.because.removeprefix("colour g was felt in the ")
    felt = carried.beliefs.record.steps[touch.data["impression"]].touch
    assert (
        felt[["north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest"].index(direction)]
        == "g"
    )


@pytest.mark.long
def test_no_walk_names_objects_where_none_is_asked_for_and_the_floor_is_no_belief(tmp_path: Path) -> None:
    """A task about the robot alone; r1 is where it woke; a refutation names the doors that were shut besides."""
    goal = "in(utak, room(next)). not_through(utak, d).\n"
    questions = asked(tmp_path, TWO_DOORS, "door(d).\n", goal, SOUTH)
    steps = questions.beliefs.record.steps
    text = questions.why_step(1).text()
    assert "No goal for an object is open" in text
    assert "All objects" not in text
    assert questions.why("kind(floor, floor, C)", 0).because.startswith("the squares of the floor are such with ")
    assert any(fact.startswith("in(org,r1") for fact in steps[0].facts)
    assert any(fact.startswith("in(org,r2") for fact in steps[-1].facts)
    refuted = [(s.number, f) for s in steps for f in s.facts if f.startswith("refuted(")]
    assert refuted
    for step, fact in refuted:
        assert "forbids shut: d" in " ".join(reason.claim for reason in questions.why(fact, step).walk())
