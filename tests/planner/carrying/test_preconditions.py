"""What is seen or felt before a grasp, with rules of users and without, in whole runs."""

from pathlib import Path

import pytest

import utak
from benchmarks.episodes.planned import planned
from tests.tables import few
from utak.kb.language.atoms import atom_parts

ROOT = Path(__file__).resolve().parents[3]
RULES = ROOT / "docs" / "sense_rules"
OUTLINE, COLOUR, WAY = "it is not clear what", "the colour of", "it is not clear whether the way for"
# By the name of a rule: the example in which it is tried, for what the robot walks, and whether more often with it.
CASES = {
    "01_look_at_all": ("push_brick_through_door", OUTLINE, True),
    "02_trust_outlines": ("push_two_corners", OUTLINE, False),
    "03_trust_colours": ("push_row_away", COLOUR, False),
    "05_walk_alone": ("push_brick_through_door", "o1 is fetched", False),
    "06_see_the_end_first": ("push_square_and_back", "the floor goes on", True),
}
REFLEX = "04_not_drawn_back"  # tests/planner/deciding/test_taking.py tries it


HALF_SEEN = {  # a thing before a door, the way to which is seen only in part
    "world": """table(51, 41). utak("POINT (39.5 33.5)", 142).
    object(t, i, "POLYGON ((34 28, 39 28, 39 30, 34 30, 34 28))").
    verge("POLYGON ((0 0, 0 41, 51 41, 51 0, 0 0), (49 20, 37 20, 37 22, 49 22, 49 39, 26 39, 26 33, 24 33, 24 36, 2 36,
    2 22, 24 22, 24 29, 26 29, 26 22, 33 22, 33 20, 26 20, 26 2, 49 2, 49 20))").""".replace("\n    ", " "),
    "start": "object(x). shape(x, brick). door(d).",
    "goal": "through(x, d).",
}


def run(example: str, *rules: str) -> utak.Episode:
    files = tuple(str(RULES / f"{rule}.lp") for rule in rules)
    return utak.Run(str(ROOT / "examples" / example), rules=files, max_steps=40).finish()


def walks_for(why: str, episode: utak.Episode) -> int:
    return sum(step.why.startswith(why) for step in episode)


def test_each_rule_is_tried() -> None:
    assert sorted(path.stem for path in RULES.glob("*.lp")) == sorted([*CASES, REFLEX])


@pytest.mark.parametrize("rule", few(list(CASES), ["01_look_at_all"]))
def test_a_rule_about_what_is_told_first_changes_what_its_sentence_says(rule: str) -> None:
    example, why, more = CASES[rule]
    before, after = run(example), run(example, rule)
    assert before.verdict == after.verdict == "done"
    assert not after.idle_rules
    if more:
        assert walks_for(why, after) > walks_for(why, before)
    else:
        assert walks_for(why, before) > walks_for(why, after) == 0


@pytest.mark.parametrize("example", few(["go_through_door", "push_square_next_room"], ["go_through_door"]))
def test_what_goals_rest_on_is_not_believed_where_a_rule_forbids_to_tell_it(example: str, tmp_path: Path) -> None:
    rule = tmp_path / "untold.lp"
    rule.write_text(":- sense(bounds(_)).\n", encoding="utf-8")
    episode = utak.Run(str(ROOT / "examples" / example), rules=(str(rule),), max_steps=40).finish()
    assert episode.verdict == "limit"
    assert f"cannot be said to hold: the rule at {rule}:1 forbids to make sure of that" in episode.reason


def test_a_look_that_a_plan_needs_stands_before_its_grasp(tmp_path: Path) -> None:
    """The plan that is recorded goes on with the grasp for which the look is, and why tells what was open."""
    for name, text in HALF_SEEN.items():
        (tmp_path / f"{name}.lp").write_text(text, encoding="utf-8")
    episode = utak.Run(str(tmp_path), max_steps=40).finish()
    looks = [step for step in episode if step.why.startswith(WAY)]
    assert looks
    for step in looks:
        names = [atom_parts(one)[0] for one in planned(episode[step.number - 1].line)[1]]
        assert names.index("look") < names.index("grasp") < names.index("push")
