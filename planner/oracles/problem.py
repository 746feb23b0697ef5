"""The problem of a task plan: things, places and goals of one stage, and states of the table that plans lead to.

All geometry is in squares, in the view frame: that of the arrays of the view, (0, 0) the south-west corner of square
[0, 0].
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.goals import At, End
from utak.geometry.motion.se2 import Pose
from utak.kb.world.model import Node

HERE = "here"  # the place of a thing where it lay at first, and of the robot where it is now
ANYWHERE = "anywhere"  # in place of an origin: a way that was refuted from two places counts as refuted from all


@dataclass(frozen=True)
class Lying:
    """The pose of an object in a state, and the place that it is at."""

    outline: Any  # shapely Polygon, in squares, view frame
    pose: Pose  # how it was moved since now: turned about its centroid, then translated
    place: str = HERE  # the name of its place

    def reach(self, end: End) -> End:
        """Return an end that is meant for the object as it lies now, for the object as it lies in this state."""
        if not isinstance(end, At):
            return end
        x, y, degrees = end.pose
        return At(Pose(x - self.pose.x, y - self.pose.y, degrees - self.pose.degrees))


@dataclass(frozen=True)
class TableState:
    """A predicted state of the table: all things of a problem, and the robot."""

    things: Mapping[str, Lying]  # how each object lies, by its name
    robot: XY  # the place (x, y) of the robot, in squares, view frame
    held: str | None = None  # the name of the object in the robot's hand; None for none
    last: str = "start"  # the name of the object that was put down last; "start" while none was

    def after(self, name: str, lying: Lying, robot: XY) -> "TableState":
        """Return the state after an object was brought somewhere and released, and where the robot stands then."""
        return replace(self, things={**self.things, name: lying}, robot=robot, held=None, last=name)

    def without(self, names: frozenset[str]) -> "TableState":
        """Return the state without some objects."""
        return replace(self, things={name: lying for name, lying in self.things.items() if name not in names})


@dataclass(frozen=True)
class PlacedGoal:
    """A goal of the stage, and the places where it holds."""

    name: str  # g1, g2, ... in the order of the task; w1, w2, ... for wishes.
    words: str  # the goal as the task states it; those of the robot joined by "and"
    subject: str  # the object that it is about as the parameters are bound, or ROBOT
    holds: bool  # whether it holds now
    weight: int | None = None  # about how many commands it may cost, for a wish; None for a goal that must hold
    # The parameter of the task that it is about, whose meaning is part of the plan; "" where `subject` is what it is
    # about, whatever else may be meant
    parameter: str = ""

    @property
    def conditions(self) -> tuple[str, ...]:
        """The goals that the task states, each as a fact without full stop; more than one only for the robot itself."""
        return tuple(self.words.split(" and "))


@dataclass(frozen=True)
class TaskProblem:
    """The things, places and goals for which a task plan is made."""

    # The objects that may be carried, by name, in the order of the model; their outlines are known
    nodes: Mapping[str, Node]
    goals: tuple[PlacedGoal, ...]  # the goals of the stage, in the order of the task, and then its wishes
    # By object and name of a place: the end there, meant for the object as it lies now. ROBOT has none here.
    places: Mapping[tuple[str, str], End]
    # By object (or ROBOT) and name of a place: the names of the goals that hold there, if they are about that object
    fulfils: Mapping[tuple[str, str], tuple[str, ...]]
    # By the name of a place of the robot: flat indices of squares (row * columns + column) on the arrays of the view
    stands: Mapping[str, Any]
    state: TableState  # how everything is now
    open: bool = False  # whether it is open where exactly some goal holds, so that it may hold elsewhere, too
    # By parameter of the task, where a plan may choose: the objects that it may mean, the one that it is bound to first
    meanings: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    # The names of the goals of which it is not known what they are about, or where they hold: they have no places
    waiting: tuple[str, ...] = ()
    past: tuple[str, ...] = ()  # what was done before, as facts of planner/asp/task/history.lp

    def here(self, name: str) -> str:
        """Return the name of the place at which an object lies now, or the robot is."""
        return self.state.things[name].place if name in self.state.things else HERE

    @property
    def begins(self) -> int:
        """The time at which a plan begins: the number of errands that were done before."""
        return sum(fact.startswith(("done(carry(", "done(clear(")) for fact in self.past)

    def places_meant(self, meanings: Mapping[str, str]) -> frozenset[tuple[str, str]]:
        """Return the places of goals, by object and name, of what the goals are about."""
        about = {goal.name: meanings.get(goal.parameter, goal.subject) for goal in self.goals}
        return frozenset(key for key in self.places if key[0] in {about[goal] for goal in self.fulfils.get(key, ())})
