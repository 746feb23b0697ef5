"""The forms of actions: as a dictionary, as a box of numbers, or as one number."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from gymnasium import spaces

from utak.kb.body import DIRECTIONS, Command, Grasp, Move, Push, Release, Turn

ACTION_KINDS = ("move", "push", "turn", "grasp", "release")  # by the number of `do`
HALF_TURN = 180.0  # degrees: the greatest turn in one action; a convention
STEP_TURNS = (90.0, -90.0, 15.0, -15.0)  # degrees: the turns of discrete actions; a convention
# The squares of a discrete move in each direction, (east, north), clockwise from north.
STEP_VECTORS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))


class ActionForm(NamedTuple):
    """A way to write actions."""

    space: spaces.Space[Any]  # the space of one action
    command: Callable[[Any], Command]  # returns the command that an action stands for
    # Returns the commands of a batch of actions, as `gymnasium.vector.utils.batch_space` lays them out.
    commands: Callable[[Any], list[Command]]


def action_form(name: str, stride: float) -> ActionForm:
    """Return a way to write actions by its name."""
    if not 0.0 < stride < math.inf:
        raise ValueError(f"stride must be above 0 and finite, not {stride}")
    forms = {"dict": _dictionaries, "box": _boxes, "discrete": _numbers}
    if name not in forms:
        raise ValueError(f"no such form of actions: {name!r}; one of {', '.join(forms)} is meant")
    return forms[name](stride)


def _dictionaries(stride: float) -> ActionForm:
    """Return the form of actions as dictionaries: `do`, and the parameters of all commands."""
    space = spaces.Dict(
        {
            "do": spaces.Discrete(len(ACTION_KINDS)),
            "way": spaces.Box(-1.0, 1.0, (2,), np.float32),
            "turn": spaces.Box(-1.0, 1.0, (1,), np.float32),
            "direction": spaces.Discrete(len(DIRECTIONS)),
        }
    )

    return ActionForm(space, partial(_of_dictionary, stride), partial(_of_dictionaries, stride))


def _of_dictionary(stride: float, action: Any) -> Command:
    """Return the command that a dictionary stands for."""
    try:
        way, turn = np.asarray(action["way"]).tolist(), np.asarray(action["turn"]).tolist()
        return _of_values(stride, int(action["do"]), way, turn, int(action["direction"]))
    except (LookupError, TypeError):
        what = "`do`, `way` (2 numbers), `turn` (1 number) and `direction`"
        raise ValueError(f"an action is a dictionary with {what}, not {action!r:.200}") from None


def _of_dictionaries(stride: float, actions: Any) -> list[Command]:
    """Return the commands of a batch of dictionaries."""
    columns = [np.asarray(actions[key]).tolist() for key in ("do", "way", "turn", "direction")]
    return [_of_values(stride, *values) for values in zip(*columns, strict=True)]


def _of_values(stride: float, do: int, way: Sequence[float], turn: Sequence[float], direction: int) -> Command:
    """Return the command of the values of a dictionary."""
    return _command(do, stride * way[0], stride * way[1], HALF_TURN * turn[0], direction)


def _boxes(stride: float) -> ActionForm:
    """Return the form of actions as 8 numbers from -1 to 1: five preferences, east, north and a turn."""
    space = spaces.Box(-1.0, 1.0, (len(ACTION_KINDS) + 3,), np.float32)

    return ActionForm(space, partial(_of_box, stride), partial(_of_boxes, stride))


def _of_box(stride: float, action: Any) -> Command:
    """Return the command that numbers stand for."""
    numbers = np.asarray(action).tolist()
    if np.shape(numbers) != (len(ACTION_KINDS) + 3,):
        raise ValueError(f"an action is {len(ACTION_KINDS) + 3} numbers, not {numbers!r:.200}")
    kinds, (east, north, turn) = numbers[: len(ACTION_KINDS)], numbers[len(ACTION_KINDS) :]
    do = max(range(len(ACTION_KINDS)), key=lambda kind: kinds[kind])
    direction = round(math.degrees(math.atan2(east, north)) / 45.0) % len(DIRECTIONS) if do == 3 else 0
    return _command(do, stride * east, stride * north, HALF_TURN * turn, direction)


def _of_boxes(stride: float, actions: Any) -> list[Command]:
    """Return the commands of a batch of numbers."""
    return [_of_box(stride, numbers) for numbers in actions]


def _numbers(stride: float) -> ActionForm:
    """Return the form of actions as one number: steps and pushes of one square, four turns, grasps, and the release."""
    known: list[Command] = [
        *(Move(float(east), float(north)) for east, north in STEP_VECTORS),
        *(Push(float(east), float(north)) for east, north in STEP_VECTORS),
        *(Turn(degrees) for degrees in STEP_TURNS),
        *(Grasp(direction) for direction in DIRECTIONS),
        Release(),
    ]

    return ActionForm(spaces.Discrete(len(known)), partial(_of_number, known), partial(_of_numbers, known))


def _of_number(known: Sequence[Command], action: Any) -> Command:
    """Return the command that a number stands for."""
    number = np.asarray(action)
    if number.size != 1 or not np.issubdtype(number.dtype, np.number) or not 0 <= number.item() < len(known):
        raise ValueError(f"an action is a number from 0 to {len(known) - 1}, not {action!r:.200}")
    return known[int(number.item())]


def _of_numbers(known: Sequence[Command], actions: Any) -> list[Command]:
    """Return the commands of a batch of numbers."""
    return [_of_number(known, action) for action in actions]


def _command(do: int, east: float, north: float, degrees: float, direction: int) -> Command:
    """Return the command of a kind, by its number in ACTION_KINDS."""
    if do == 0:
        return Move(east, north)
    if do == 1:
        return Push(east, north)
    if do == 2:
        return Turn(degrees)
    if do == 3:
        return Grasp(DIRECTIONS[direction])
    if do == 4:
        return Release()
    raise ValueError(f"`do` is a number from 0 to {len(ACTION_KINDS) - 1}, not {do}")
