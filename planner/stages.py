"""The stages of a task: which goals must hold together, in which order.

Goals without first(...) or then(...) hold together at the end. Within one step of the task, goals that only a track can
fulfil (`circled`) come first, each as a stage of its own. The goals that a place fulfils (at, in, beside, ...) follow
as one stage.
"""

from dataclasses import dataclass, replace

from utak.kb.language.goal_words import CONSTRAINT_GOALS, GOAL_WORDS, ROBOT, TRACK_GOALS
from utak.kb.language.terms import Fact, Number, Symbol, Term
from utak.kb.task.task import Task, inner_goal

# Goals that rest on a door of the room in which their subject was at first
DOOR_GOALS = tuple(name for name, word in GOAL_WORDS.items() if word.by_door)
# Goals whose meaning depends on where their subject was at first
ORIGIN_GOALS = tuple(name for name, word in GOAL_WORDS.items() if word.from_origin)
# Goals whose two arguments touch where they hold, so that either of two things may be moved
TOUCHING_GOALS = tuple(name for name, word in GOAL_WORDS.items() if word.touches)
# Goals of which the task says where they hold, whatever is found
FIXED_GOALS = tuple(name for name, word in GOAL_WORDS.items() if word.fixed)


@dataclass(frozen=True)
class Stage:
    """Goals that shall hold at one time; a goal that a track fulfils stands alone in its stage."""

    # The goals, at least one; the first argument of each is "utak" for the robot, or the parameter of an object
    goals: tuple[Fact, ...]
    followed: bool = False  # whether another stage comes after it
    # Goals that need not hold, each with the number of commands that it may cost; of the last stage alone
    wishes: tuple[tuple[Fact, int], ...] = ()
    # Goals about two things of which one must be brought elsewhere before: not yet among `goals`
    later: tuple[Fact, ...] = ()

    @property
    def own(self) -> tuple[Fact, ...]:
        """The goals for the robot itself, in order; () for none."""
        return tuple(goal for goal in self.goals if str(goal.args[0]) == ROBOT)

    @property
    def carried(self) -> tuple[Fact, ...]:
        """The goals for objects, which the robot must carry, in order; () for none."""
        return tuple(goal for goal in self.goals if str(goal.args[0]) != ROBOT)

    @property
    def goes_on(self) -> bool:
        """Whether the robot has more to do when all objects of the stage are where they shall be."""
        return self.followed or len(self.own) > 0 or len(self.later) > 0

    def __str__(self) -> str:
        """Return the goals as text, joined by "and"."""
        return " and ".join(str(goal) for goal in (*self.goals, *self.later))


def stages(task: Task) -> tuple[Stage, ...]:
    """Split the goals of a task into its stages, in the order in which they shall hold."""
    steps: list[list[Fact]] = [[]]
    for fact in task.goals:
        if fact.name == "then":
            steps.append([])
        if fact.name not in CONSTRAINT_GOALS and fact.name != "prefer":
            steps[-1].append(inner_goal(fact))
    found = [stage for goals in steps for stage in _ordered(goals)]
    wished = wishes(task)
    return tuple(
        replace(stage, followed=stage is not found[-1], wishes=wished if stage is found[-1] else ()) for stage in found
    )


def constraints(task: Task) -> tuple[Fact, ...]:
    """Return the constraints of a task, such as not_through(utak, d), in order; () for none."""
    return tuple(fact for fact in task.goals if fact.name in CONSTRAINT_GOALS)


def is_at_start(goal: Fact) -> bool:
    """Return whether a goal is that something is where the robot woke."""
    return goal.name == "at" and str(goal.args[1]) == "start"


def rests_on_waking(goal: Fact) -> bool:
    """Return whether the place where a goal holds is told from where the robot woke."""
    return goal.name in FIXED_GOALS or is_at_start(goal)


def parameters_that_keep_meaning(task: Task, attained: int = 0) -> frozenset[str]:
    """Return the parameters of a task that a plan must not give another meaning."""
    # These are parameters that the task names otherwise than as what is brought somewhere: in constraints, as the
    # second argument of a goal, or as what the robot goes round; and those of stages that are attained.
    found = {str(term) for fact in constraints(task) for term in fact.args}
    every = stages(task)
    for stage in every:
        goals = (*stage.goals, *(wish for wish, _ in stage.wishes))
        found |= {word for goal in goals for term in goal.args[1:] for word in _words(term)}
    found |= {str(goal.args[0]) for stage in every[:attained] for goal in stage.goals}
    return frozenset(found & set(task.parameters))


def _words(term: Term) -> set[str]:
    """Return the names in a term: its own, and those of its arguments."""
    if not isinstance(term, Symbol):
        return set()
    return {term.name}.union(*map(_words, term.args))


def wishes(task: Task) -> tuple[tuple[Fact, int], ...]:
    """Return the wishes prefer(G, N) of a task in order: each goal G with the number N of commands that it may cost."""
    found = []
    for fact in task.goals:
        if fact.name == "prefer":
            weight = fact.args[1]
            assert isinstance(weight, Number)
            found.append((inner_goal(fact), weight.value))
    return tuple(found)


def _ordered(goals: list[Fact]) -> list[Stage]:
    """Order the goals of one step: each goal of the track in a stage alone, then the others together in one stage."""
    of_track = [Stage((goal,)) for goal in goals if goal.name in TRACK_GOALS]
    of_place = tuple(goal for goal in goals if goal.name not in TRACK_GOALS)
    return of_track + ([Stage(of_place)] if of_place else [])
