"""The robot's body: all that its mind can do to the world, and all that it learns from the world.

One command goes in, one impression comes out. Directions are in the robot frame: its origin is where the robot woke,
and its north is the way the robot faced then. Lengths are squares; angles are degrees, counter-clockwise positive.
"""

from dataclasses import dataclass
from typing import Protocol

DIRECTIONS = ("north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest")  # clockwise


@dataclass(frozen=True, slots=True)
class Move:
    """The command to walk straight. Nothing happens while an object is held.

    The robot stops early where something blocks its way.

    Attributes
    ----------
    east, north : float
        The way from where the robot stands, in squares, robot frame; negative for west and south.
    """

    east: float
    north: float


@dataclass(frozen=True, slots=True)
class Grasp:
    """The command to take the movable object, if any, that covers the adjacent square in a direction.

    Nothing happens where no movable object covers that square, or while another object is held.

    Attributes
    ----------
    direction : str
        One of the eight DIRECTIONS of the robot frame; anything else raises ValueError.
    """

    direction: str

    def __post_init__(self) -> None:
        """Raise ValueError unless the direction is one of DIRECTIONS."""
        if self.direction not in DIRECTIONS:
            raise ValueError(f"no such direction: {self.direction!r}; one of {', '.join(DIRECTIONS)} is meant")


@dataclass(frozen=True, slots=True)
class Push:
    """The command to walk straight together with the held object. Nothing happens with empty hands.

    Both stop early where something blocks either.

    Attributes
    ----------
    east, north : float
        The way from where the robot stands, in squares, robot frame; negative for west and south.
    """

    east: float
    north: float


@dataclass(frozen=True, slots=True)
class Turn:
    """The command to rotate the held object about the robot, which stays where it is. Nothing happens with empty hands.

    Attributes
    ----------
    degrees : float
        The angle, counter-clockwise positive.
    """

    degrees: float


@dataclass(frozen=True, slots=True)
class Release:
    """The command to let go of the held object. Nothing happens with empty hands."""


Command = Move | Grasp | Push | Turn | Release
COMMANDS = (Move, Push, Turn, Grasp, Release)  # each is named as what carries it out: `Tabletop.move`, ...


@dataclass(frozen=True, slots=True)
class Impression:
    """An impression: all that the robot senses when it comes to a halt.

    Attributes
    ----------
    retina : tuple of int
        160 gray levels of fields (squares of 1, 2 or 4 squares a side about the robot, in the robot frame), from 0 for
        all free to 7 for all occupied. First the fields of the fovea, then those of the middle and of the outer zone;
        each zone row by row from its north row to its south row, each row from west to east.
    touch : tuple of str or None
        The colours of the 8 adjacent squares, in the order of DIRECTIONS (clockwise from north, robot frame): one
        lower-case letter each, None for floor.
    """

    retina: tuple[int, ...]
    touch: tuple[str | None, ...]


class Body(Protocol):
    """The only way from the mind to the world: what moves the robot, and senses for it, has these two methods."""

    def wake(self) -> Impression:
        """Return the first impression, at the point where the robot woke: the origin of the robot frame."""

    def act(self, command: Command) -> Impression:
        """Carry out one command as far as the world allows, and return the impression at its end."""
