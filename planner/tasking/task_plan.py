"""The task plan: errands in order, with what geometry said of each; a value that can be printed, logged and asked."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from utak.geometry.kernels.arrays import XY
from utak.kb.language.goal_words import ROBOT
from utak.planner.oracles.carry import Certainty
from utak.planner.oracles.problem import ANYWHERE, PlacedGoal

GOAL_PLACE = re.compile(r"(g[0-9]+)_")  # the beginning of the name of a place where a goal holds


@dataclass(frozen=True)
class Errand:
    """One step of a task plan: something is brought to a place, the robot goes there itself, or settles something."""

    # Carry (to a place where a goal holds), clear (out of the way) or arrive (the robot itself); or a step that settles
    # something, such as find (planner/asp/task/settling.lp).
    action: str
    # The object, or `utak`; what is settled, such as the name of a goal, for a step that settles something
    subject: str
    place: str = ""  # the name of the place; "" for a step that settles something
    doors: tuple[str, ...] = ()  # the doors that are passed on the way, sorted
    # What geometry said: the way is sure, or hoped to be free; None when it was not asked
    certainty: Certainty | None = None
    commands: int = 0  # about how many commands it takes
    # Grasps, as (x, y) of the robot from the middle of the object as it lies before, with which it would shut the robot
    # in at its place
    avoid: tuple[XY, ...] = ()

    @property
    def goal(self) -> str:
        """The name of the goal that it serves: that holds at its place, or that it may settle; "" for none."""
        return goal_at(f"{self.subject}_" if self.settles else self.place)

    @property
    def settles(self) -> bool:
        """Whether it settles something, and brings nothing anywhere."""
        return not self.place

    def __str__(self) -> str:
        """Return the step as the encoding writes it, such as carry(o1,g1_r2) or find(g1)."""
        if self.settles:
            return f"{self.action}({self.subject})"
        return f"arrive({self.place})" if self.action == "arrive" else f"{self.action}({self.subject},{self.place})"


RECOVERY = Errand("recover", "robot")  # a robot that is lost puts down what it holds


@dataclass(frozen=True)
class RefutedStep:
    """A refuted step, with the least circumstances in which geometry refutes it."""

    subject: str  # what was to be brought from where to where
    origin: str
    place: str
    # The places of other objects on which the refutation rests: (object, place), sorted
    given: tuple[tuple[str, str], ...] = ()
    # The object beside which the robot stood ("start" for where it is now); None when that does not matter
    stood: str | None = None
    shut: tuple[str, ...] = ()  # the doors that were not passed, on which it rests; sorted
    found: str = field(default="", compare=False)  # what geometry found, in words; "" where it was not asked

    @property
    def step(self) -> str:
        """The refuted step as the encoding writes it, such as carry(o1,g1_r2)."""
        action = "arrive" if self.subject == ROBOT else "carry" if goal_at(self.place) else "clear"
        return str(Errand(action, self.subject, self.place))

    @property
    def _places(self) -> set[tuple[str, str]]:
        """The places of all things on which it rests: that of the subject too, unless it counts from anywhere."""
        own = set() if self.origin == ANYWHERE else {(self.subject, self.origin)}
        return own | set(self.given)

    @property
    def circumstances(self) -> tuple[str, ...]:
        """On what it rests, as the facts say it: at(N,P) for the subject and other objects, stood(N), shut(D)."""
        found = [f"at({name},{place})" for name, place in sorted(self._places)]
        found += [] if self.stood is None else [f"stood({self.stood})"]
        return (*found, *(f"shut({door})" for door in self.shut))

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
    """A plan for all goals of a stage."""

    errands: tuple[Errand, ...]  # the steps, in order
    unmet: tuple[str, ...] = ()  # the goals that do not hold at its end; empty for a whole plan
    cost: int = 0  # about how many commands it takes
    least: int = 0  # a number of commands below which no plan is known to stay, by the estimates of the search
    # Whether the search ended with it; False when its bound on rounds was reached: then it is the best plan that was
    # found
    proved: bool = True
    refutations: tuple[RefutedStep, ...] = ()  # the steps that geometry refuted on the way to it
    rounds: int = 0  # how many plans were made; 0 where none was sought, and the one step is what is done next
    # The goals of the stage, in the order of the task, as they were when it was made
    goals: tuple[PlacedGoal, ...] = ()
    missed: tuple[str, ...] = ()  # the wishes that do not hold at its end
    # The objects that parameters of the task mean in it: (parameter, object), sorted
    meanings: tuple[tuple[str, str], ...] = ()

    @property
    def verified(self) -> bool:
        """Whether geometry found a way for each step."""
        return all(errand.certainty is not None for errand in self.errands)

    @property
    def facts(self) -> tuple[str, ...]:
        """The plan as facts without full stops, as kb/asp/belief.lp declares them."""
        if not self.goals and not self.errands and not self.unmet:
            return ()
        return (*self._goal_facts(), *self._step_facts(), *self._search_facts())

    @property
    def failure_facts(self) -> tuple[str, ...]:
        """The goals, those that are unmet, and what was refuted, as facts: of a plan that is not followed."""
        return (*self._goal_facts(), *self._refutation_facts())

    def _goal_facts(self) -> Iterator[str]:
        """Yield the names of the goals, and what the task states for each."""
        for goal in self.goals:
            yield f"goal({goal.name})"
            yield from (f"means({goal.name},{condition})" for condition in goal.conditions)
        yield from (f"unmet({name})" for name in self.unmet)

    def _step_facts(self) -> Iterator[str]:
        """Yield the steps by their number, and what is known of each."""
        for number, errand in enumerate(self.errands):
            yield f"plan({number},{errand})"
            if errand.goal:
                yield f"serves({number},{errand.goal})"
            yield from (f"passes({number},{door})" for door in errand.doors)
            if errand.certainty is not None:
                yield f"takes({number},{errand.commands})"
            if errand.certainty == Certainty.SURE:
                yield f"verified({number})"

    def _search_facts(self) -> Iterator[str]:
        """Yield what the plan costs if it attains all goals, how the search ended, and what was refuted on its way."""
        if self.rounds and not self.unmet:
            yield f"price({self.cost},{self.least},{'proved' if self.proved else 'found'})"
        yield from self._refutation_facts()

    def _refutation_facts(self) -> Iterator[str]:
        """Yield what was refuted, by number, and the circumstances of each refutation."""
        for number, refutation in enumerate(self.refutations):
            yield f"refuted({refutation.step},{number})"
            yield from (f"given({number},{circumstance})" for circumstance in refutation.circumstances)


def goal_at(place: str) -> str:
    """Return the name of the goal that holds at a place of the plan; "" for none."""
    found = GOAL_PLACE.match(place)
    return found[1] if found else ""
