"""The forms of actions: as a dictionary, as a box of numbers, or as one number."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from gymnasium import spaces

from utak.kb.body import COMMANDS, DIRECTIONS, Command, Grasp, Move, Push, Release, Turn

HALF_TURN = 180.0  # degrees: the greatest turn in one action; a convention
STEP_TURNS = (90.0, -90.0, 15.0, -15.0)  # degrees: the turns of discrete actions; a convention
# The squares of a discrete move in each direction, (east, north), clockwise from north.
STEP_VECTORS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))


# The commands of discrete actions: steps and pushes of one square, four turns, grasps, and the release.
STEP_COMMANDS: tuple[Command, ...] = (
    *(Move(float(east), float(north)) for east, north in STEP_VECTORS),
    *(Push(float(east), float(north)) for east, north in STEP_VECTORS),
    *(Turn(degrees) for degrees in STEP_TURNS),
    *(Grasp(direction) for direction in DIRECTIONS),
    Release(),
)


class ActionForm(NamedTuple):
    """A way to write actions."""

    space: spaces.Space[Any]  # the space of one action
    command: Callable[[Any], Command]  # returns the command that an action stands for


def action_form(name: str, stride: float) -> ActionForm:
    """Return a way to write actions by its name."""
    if not 0.0 < stride < math.inf:
        raise ValueError(f"stride must be above 0 and finite, not {stride}")
    kinds = len(COMMANDS)
    ways, turn = spaces.Box(-1.0, 1.0, (2,), np.float32), spaces.Box(-1.0, 1.0, (1,), np.float32)
    parts = {"do": spaces.Discrete(kinds), "way": ways, "turn": turn, "direction": spaces.Discrete(len(DIRECTIONS))}
    forms = {
        "dict": ActionForm(spaces.Dict(parts), partial(_of_dictionary, stride)),
        "box": ActionForm(spaces.Box(-1.0, 1.0, (kinds + 3,), np.float32), partial(_of_box, stride)),
        "discrete": ActionForm(spaces.Discrete(len(STEP_COMMANDS)), _of_number),
    }
    if name not in forms:
        raise ValueError(f"no such form of actions: {name!r}; one of {', '.join(forms)} is meant")
    return forms[name]


def _of_dictionary(stride: float, action: Any) -> Command:
    try:
        way, turn = np.asarray(action["way"]).tolist(), np.asarray(action["turn"]).tolist()
        do, direction = int(action["do"]), int(action["direction"])
        return _command(do, stride * way[0], stride * way[1], HALF_TURN * turn[0], direction)
    except (LookupError, TypeError):
        what = "`do`, `way` (2 numbers), `turn` (1 number) and `direction`"
        raise ValueError(f"an action is a dictionary with {what}, not {action!r:.200}") from None


def _of_box(stride: float, action: Any) -> Command:
    numbers = np.asarray(action).tolist()
    if np.shape(numbers) != (len(COMMANDS) + 3,):
        raise ValueError(f"an action is {len(COMMANDS) + 3} numbers, not {numbers!r:.200}")
    kinds, (east, north, turn) = numbers[: len(COMMANDS)], numbers[len(COMMANDS) :]
    do = max(range(len(COMMANDS)), key=lambda kind: kinds[kind])
    direction = round(math.degrees(math.atan2(east, north)) / 45.0) % len(DIRECTIONS) if do == 3 else 0
    return _command(do, stride * east, stride * north, HALF_TURN * turn, direction)


def _of_number(action: Any) -> Command:
    number = np.asarray(action)
    if number.size != 1 or not np.issubdtype(number.dtype, np.number) or not 0 <= number.item() < len(STEP_COMMANDS):
        raise ValueError(f"an action is a number from 0 to {len(STEP_COMMANDS) - 1}, not {action!r:.200}")
    return STEP_COMMANDS[int(number.item())]


def _command(do: int, east: float, north: float, degrees: float, direction: int) -> Command:
    """Return the command of a kind, by its number in COMMANDS."""
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
    raise ValueError(f"`do` is a number from 0 to {len(COMMANDS) - 1}, not {do}")
