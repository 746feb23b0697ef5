"""Each goal word has what the table of goal words promises."""

from utak.kb.language.goal_words import GOAL_WORDS, ROBOT, Holds
from utak.planner.goals.object_goals import PLACEMENTS
from utak.planner.goals.references import READY_GOAL
from utak.planner.goals.robot_goals import DESTINATIONS


def test_each_argument_has_its_kinds_of_parameters() -> None:
    for name, word in GOAL_WORDS.items():
        assert len(word.parameters) == len(word.arguments), name


def test_each_goal_has_a_meaning_for_each_subject() -> None:
    lasting = {name: word for name, word in GOAL_WORDS.items() if word.holds is not Holds.ALL_THE_TIME}
    for_robot = {name for name, word in lasting.items() if ROBOT in (word.parameters[0] or (ROBOT,))}
    for_things = {name for name, word in lasting.items() if "object" in (word.parameters[0] or ())}
    assert for_robot == set(DESTINATIONS)
    assert for_things | {READY_GOAL} == set(PLACEMENTS)
