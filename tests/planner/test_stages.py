"""The stages of a task: its steps in order, each as often as it is stated."""

from utak.kb.language.reader import facts_from_text
from utak.kb.task.task import Task
from utak.planner.stages import stages


def test_a_repeated_step_is_a_stage_of_its_own() -> None:
    goals = facts_from_text("first(at(utak, start)). then(at(utak, corner(northeast))). then(at(utak, start)).")
    found = stages(Task({}, (), goals))
    assert [str(stage) for stage in found] == ["at(utak,start)", "at(utak,corner(northeast))", "at(utak,start)"]
    assert [stage.followed for stage in found] == [True, True, False]
