"""The steps of the robot itself, as kb/asp/belief.lp declares step/2; each command is one.

A decision names the steps with which the plan goes on: first that of its command, then what the robot means to do after
it, such as to look where it goes, or what is left of a plan that carries a thing. The rules of planner/asp/deciding
tell, with those of users, whether they may be done one after the other.
"""

from collections.abc import Sequence

from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.plan_carrying import Leg
from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.kb.body import Command, Grasp, Move, Push, Turn
from utak.kb.language.vocabulary import ANY_SIDE
from utak.kb.world.model import WorldModel, hundredths
from utak.planner.decision import Decision, RobotStep
from utak.planner.question import Atoms, Question
from utak.planner.situation import Situation
from utak.planner.subgoal_kind import SubgoalKind

# The predicates of planner/asp/deciding about the steps of the robot alone.
STEP_PREDICATES = (("offered", 2), ("step", 2), ("begun", 0), ("in_hand", 2), ("there", 3), ("holds", 1))


def step_of_command(command: Command, model: WorldModel) -> RobotStep:
    """Return the step of a command alone, for what is in hand."""
    if model.held is None and not isinstance(command, Move | Grasp):  # an empty hand does nothing: the robot stays
        return go_to(model.place, model)
    match command:
        case Move(east, north):
            x, y = model.frame.place_to_utak(*model.place)
            return _step("go", hundredths(x + east), hundredths(y + north))
        case Push(east, north):
            return _step("push", str(model.held), hundredths(east), hundredths(north))
        case Turn(degrees):
            return _step("turn", str(model.held), hundredths(degrees))
        case Grasp(direction):
            raise ValueError(f"what is grasped to the {direction} is known to who decides it only")
    return release(str(model.held))


def steps_of(decision: Decision, model: WorldModel) -> tuple[RobotStep, ...]:
    """Return the steps with which a decision goes on, that of its command first; () where it has no command."""
    return decision.steps or (() if decision.command is None else (step_of_command(decision.command, model),))


def release(thing: str) -> RobotStep:
    """Return the step that a thing is let go."""
    return _step("release", thing)


def grasp(thing: str, direction: str) -> RobotStep:
    """Return the step that a thing is grasped which lies in a direction."""
    return _step("grasp", thing, direction)


def press(thing: str, push: Translate, model: WorldModel) -> RobotStep:
    """Return the step that a thing in hand is pressed against a wall by a push, map frame."""
    return _step("press", thing, *map(hundredths, model.frame.to_utak(push.dx, push.dy)))


def motion_of(thing: str, motion: Motion, model: WorldModel) -> RobotStep:
    """Return the step of a motion, map frame, with a thing in hand."""
    if isinstance(motion, Rotate):
        return _step("turn", thing, hundredths(motion.degrees))
    return _step("push", thing, *map(hundredths, model.frame.to_utak(motion.dx, motion.dy)))


def go_to(place: XY, model: WorldModel) -> RobotStep:
    """Return the step to a point (x, y) in squares, map frame."""
    return _step("go", *map(hundredths, model.frame.place_to_utak(*place)))


def of_legs(thing: str, legs: Sequence[Leg], grasped: bool, model: WorldModel) -> tuple[RobotStep, ...]:
    """Return the steps of some legs, map frame, with a thing, which may be grasped already for the first one."""
    steps: list[RobotStep] = []
    for number, leg in enumerate(legs):
        if number or not grasped:
            direction = model.frame.directions().get(leg.direction_square, ANY_SIDE)
            steps += [go_to(leg.place, model), grasp(thing, direction)]
        steps += [*(motion_of(thing, motion, model) for motion in leg.motions), release(thing)]
    return tuple(steps)


def towards(kind: str, place: XY, model: WorldModel) -> tuple[RobotStep, ...]:
    """Return the steps towards a subgoal of a kind at a point (x, y) in squares, map frame."""
    there = tuple(map(hundredths, model.frame.place_to_utak(*place)))
    then = () if kind == SubgoalKind.ATTAIN else (_step("feel" if kind == SubgoalKind.FEEL else "look", *there),)
    return (_step("go", *there), *then)


def are_ruled(situation: Situation) -> bool:
    """Return whether users' rules speak of the steps of the robot."""
    return situation.question.speaks_of(STEP_PREDICATES)


def refusal(
    steps: Sequence[RobotStep], situation: Situation, question: Question | None = None, last: bool = False
) -> str:
    """Return why some steps, first the next one, may not be done, in words; "" where they may."""
    # question : where what was chosen before has one of its own. last : whether the answer is to be recorded.
    given = (question or situation.question).adding(f"offered({number},{step})" for number, step in enumerate(steps))
    answer = given.recorded() if last else given.answer("senses", "steps")
    if _are_begun(answer or ()):
        return ""
    blamed = given.blamed(lambda atoms: not _are_begun(atoms))
    if not blamed:
        return f"{', '.join(map(str, steps))} cannot be done one after the other"
    return forbidden_by(blamed, ", ".join(map(str, steps)))


def forbidden_by(rules: Sequence[str], what: str) -> str:
    """Return in words that users' rules, such as `rules.lp:3`, forbid something."""
    return (
        f"the rule at {rules[0]} forbids {what}"
        if len(rules) == 1
        else f"the rules at {' and '.join(rules)} forbid {what}"
    )


def _are_begun(answer: Atoms) -> bool:
    """Return whether steps are begun, by an answer."""
    return any(atom.name == "begun" for atom in answer)


def _step(name: str, *args: str | int) -> RobotStep:
    """Return a step with its arguments."""
    return RobotStep(name, args)
