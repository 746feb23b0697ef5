"""The task plan: errands in order, with what geometry said of each; a value that can be printed, logged and asked."""

from dataclasses import dataclass

from geometry.kernels.arrays import XY
from planner.oracles.carry import Certainty


@dataclass(frozen=True)
class Errand:
    """One step of a task plan: something is brought to a place, or the robot goes there itself.

    Attributes
    ----------
    action : carry (to a place where a goal holds), clear (out of the way) or arrive (the robot itself).
    subject : the object, or `utak`.
    place : the name of the place.
    doors : the doors that are passed on the way, sorted.
    certainty : what geometry said: the way is sure, or hoped to be free; None when it was not asked.
    commands : about how many commands it takes.
    avoid : grasps, as (x, y) of the robot from the middle of the object as it lies before, with which it would shut the
        robot in at its place.
    """

    action: str
    subject: str
    place: str
    doors: tuple[str, ...] = ()
    certainty: Certainty | None = None
    commands: int = 0
    avoid: tuple[XY, ...] = ()

    def __str__(self) -> str:
        """Return the step as the encoding writes it, such as carry(o1,g1_r2)."""
        return f"arrive({self.place})" if self.action == "arrive" else f"{self.action}({self.subject},{self.place})"


@dataclass(frozen=True)
class RefutedStep:
    """A refuted step, with the least circumstances in which geometry refutes it.

    Attributes
    ----------
    subject, origin, place : what was to be brought from where to where.
    given : the places of other objects on which the refutation rests: (object, place), sorted.
    stood : the object beside which the robot stood ("start" for where it is now); None when that does not matter.
    shut : the doors that were not passed, on which it rests; sorted.
    """

    subject: str
    origin: str
    place: str
    given: tuple[tuple[str, str], ...] = ()
    stood: str | None = None
    shut: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Return the refutation in words, without full stop."""
        circumstances = [f"{name} is at {place}" for name, place in self.given]
        if self.stood is not None:
            circumstances.append(
                "the robot stands where it is" if self.stood == "start" else f"it comes from {self.stood}"
            )
        circumstances += [f"door {door} is not passed" for door in self.shut]
        while_ = f" while {' and '.join(circumstances)}" if circumstances else ""
        return f"{self.subject} cannot be brought to {self.place}{while_}"


@dataclass(frozen=True)
class TaskPlan:
    """A plan for all goals of a stage.

    Attributes
    ----------
    errands : the steps, in order.
    unmet : the goals that do not hold at its end; empty for a whole plan.
    cost : about how many commands it takes.
    least : a number of commands below which no plan is known to stay, by the estimates of the search.
    proved : whether the search ended with it; False when its bound on rounds was reached: then it is the best plan that
        was found.
    refutations : the steps that geometry refuted on the way to it.
    rounds : how many plans were made.
    missed : the wishes that do not hold at its end.
    """

    errands: tuple[Errand, ...]
    unmet: tuple[str, ...] = ()
    cost: int = 0
    least: int = 0
    proved: bool = True
    refutations: tuple[RefutedStep, ...] = ()
    rounds: int = 0
    missed: tuple[str, ...] = ()

    @property
    def verified(self) -> bool:
        """Whether geometry found a way for each step."""
        return all(errand.certainty is not None for errand in self.errands)

    @property
    def facts(self) -> tuple[str, ...]:
        """The plan as facts without full stops: plan(I, Step), verified(I) and refuted(Step, Given)."""
        found = [f"plan({number},{errand})" for number, errand in enumerate(self.errands)]
        found += [f"verified({n})" for n, errand in enumerate(self.errands) if errand.certainty == Certainty.SURE]
        return tuple(found)
