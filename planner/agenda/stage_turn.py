"""The basis of a decision: a stage of the task, and what is believed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from geometry.kernels.arrays import XY
from kb.language.terms import Fact
from kb.task.binding import Reconciliation
from planner.situation import Situation
from planner.stages import Stage

ALL_OBJECTS, ROBOT_ITSELF, CONSTRAINTS = "all", "robot", "task"  # what planner/asp/agenda.lp calls them


@dataclass(frozen=True)
class StageTurn:
    """A stage of the task, and what is believed while it is decided.

    Attributes
    ----------
    stage : the goals that shall hold now; none when all stages are attained.
    situation : what is believed: world model, rooms, doors, corners and track.
    reconciled : what the parameters of the task mean, and which objects may match those that nothing matches yet.
    track : where the robot has been, (x, y) in squares, map frame.
    """

    stage: Stage
    situation: Situation
    reconciled: Reconciliation
    track: Sequence[XY]

    @cached_property
    def goals(self) -> Mapping[str, Fact]:
        """The goals for objects by name: g1, g2, ... in the order of the task."""
        return {f"g{number}": goal for number, goal in enumerate(self.stage.carried, 1)}

    def goals_of(self, subject: str) -> tuple[Fact, ...]:
        """Return the goals that the robot is stuck with.

        subject : the name of a goal, or one of ALL_OBJECTS, ROBOT_ITSELF and CONSTRAINTS.
        """
        if subject in self.goals:
            return (self.goals[subject],)
        return {ALL_OBJECTS: self.stage.carried, ROBOT_ITSELF: self.stage.own}.get(subject, ())
