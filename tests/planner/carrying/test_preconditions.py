"""What is seen or felt before a grasp, with rules of users and without, in whole runs."""

from pathlib import Path

import pytest

import utak
from benchmarks.episodes.planned import planned
from tests.tables import few
from utak.kb.language.atoms import atom_parts

ROOT = Path(__file__).resolve().parents[3]
RULES = ROOT / "docs" / "sense_rules"
OUTLINE, WAY = "it is not clear what", "it is not clear whether the way for"
# By the name of a rule: the example in which it is tried, for what the robot walks, and whether more often with it.
CASES = {
    "01_look_at_all": ("push_brick_through_door", OUTLINE, True),
    "02_trust_long_ways": ("push_l_tight_door", WAY, False),
    "03_way_first": ("push_brick_regrasp", WAY, True),
    "05_walk_alone": ("push_brick_through_door", "o1 is fetched", False),
    "06_see_the_end_first": ("push_square_and_back", "the floor goes on", True),
}
REFLEX = "04_not_drawn_back"  # tests/planner/deciding/test_taking.py tries it


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


def test_a_look_that_a_plan_needs_stands_before_its_grasp() -> None:
    """The plan that is recorded goes on with the grasp for which the look is, and why tells what was open."""
    episode = run("push_l_tight_door")
    looks = [step for step in episode if step.why.startswith(WAY)]
    assert looks
    for step in looks:
        names = [atom_parts(one)[0] for one in planned(episode[step.number - 1].line)[1]]
        assert names.index("look") < names.index("grasp") < names.index("push")
