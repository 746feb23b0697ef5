"""What is shown below a goal is what makes it hold: the wall that hides a thing, the way round it, the rooms' doors."""

from pathlib import Path

import pytest

from utak.kb.evidence.reason import Depth, ReasonKind
from utak.kb.language.atoms import atom_parts
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.explaining.questions import Questions, questions_of_episode

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


def questions_about(name: str, folder: Path) -> Questions:
    """Return the questions about a run of an example."""
    log = folder / f"{name}.jsonl"
    assert main(["run", str(EXAMPLES / name), "--log", str(log)]) == 0
    return questions_of_episode(read_episode(log))


@pytest.fixture(scope="module")
def blocked(tmp_path_factory: pytest.TempPathFactory) -> Questions:
    """The questions about a run through a door."""
    return questions_about("push_square_blocked_door", tmp_path_factory.mktemp("run"))


def test_of_a_goal_out_of_sight_the_wall_that_hides_it_is_shown(tmp_path: Path) -> None:
    questions = questions_about("push_brick_around_corner", tmp_path)
    (goal,) = (one for one in questions.why("verdict(done)").rests_on if one.claim.startswith("around("))
    (wall,) = (one for one in goal.rests_on if one.claim.startswith("the wall between"))
    assert wall.kind is ReasonKind.CELLS and "level 7" in wall.because


def test_of_a_way_round_a_thing_the_way_is_shown(tmp_path: Path) -> None:
    questions = questions_about("go_round_square", tmp_path)
    (goal,) = (one for one in questions.why("verdict(done)").rests_on if one.claim.startswith("circled("))
    (way,) = (one for one in goal.rests_on if one.claim.startswith("the robot went "))
    assert way.claim.count("(") == len(questions.beliefs.record.steps)


def test_where_a_thing_was_at_first_is_said_of_what_was_seen_of_it(blocked: Questions) -> None:
    (began,) = (one for one in blocked.why("in(x,room(next))").rests_on if "was at first" in one.because)
    assert "the middle of what was seen of it" in began.because


def test_widths_are_of_doors_that_lead_somewhere_and_rest_on_the_belief_in_the_door(blocked: Questions) -> None:
    for step in blocked.beliefs.record.steps:
        leading = {fact.partition("(")[2].partition(",")[0] for fact in step.facts if fact.startswith("connects(")}
        for below in blocked.why("in(x,room(next))", step.number).rests_on:
            if below.claim.startswith("width("):
                door = below.claim.partition("(")[2].partition(",")[0]
                assert door in leading and f"door({door}," in " ".join(one.claim for one in below.rests_on)
                assert "579262" not in below.because and "5792" not in below.because
                assert "so it is a door" not in below.text(Depth.LONG)


def test_what_is_looked_at_is_said_with_where_it_is(blocked: Questions) -> None:
    told = [step.why for step in blocked.beliefs.record.steps if "felt whether something stands" in step.why]
    assert told and all("near POINT (" in why for why in told)


def test_a_word_of_the_task_in_a_question_stands_for_what_it_means(blocked: Questions) -> None:
    assert blocked.why_not("in(x, r99)", 0).claim == "not in(o1,r99)"


def test_what_the_robot_touches_is_shown_by_what_it_feels(blocked: Questions) -> None:
    touching = [
        (fact, step.number)
        for step in blocked.beliefs.record.steps
        for fact in step.long_facts
        if fact.startswith("adjacent(org,o") and fact.endswith((",99)", ",100)"))
    ]
    assert touching
    for fact, step in touching:
        assert ReasonKind.TOUCH in [one.kind for one in blocked.why(fact, step).rests_on]


def test_the_cells_that_are_shown_of_a_stretch_of_wall_are_of_its_own_squares(blocked: Questions) -> None:
    stretches = [
        (step, fact) for step in blocked.beliefs.record.steps for fact in step.facts if fact.startswith("stretch(")
    ]
    assert stretches
    for step, fact in stretches:
        (shown,) = blocked.why(fact, step.number).rests_on
        west, south, east, north = map(int, atom_parts(fact)[1][1:])
        for column, row in shown.data["squares"]:
            x, y = (100 * value for value in step.frame.place_to_utak(column + 0.5, row + 0.5))
            assert west <= x <= east and south <= y <= north
        assert shown.data["squares"]
        unfelt = blocked.why(f"plug({atom_parts(fact)[1][0]}, C)", step.number)
        assert fact in [one.claim for one in unfelt.rests_on]


def test_of_a_neck_seen_on_one_side_alone_the_floor_between_its_walls_is_shown(blocked: Questions) -> None:
    for step in blocked.beliefs.record.steps:
        for fact in step.long_facts:
            if fact.startswith("door("):
                told = blocked.why(fact, step.number).text(Depth.LONG)
                assert "the floor between the walls: free: nothing was seen" not in told
