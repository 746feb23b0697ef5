"""Utak's body: all that his mind can do to the world, and all that it learns from it.

One command goes in, one impression comes out. Everything is in Utak's frame: his north is the way he faces when he
wakes. Lengths are in squares, angles in degrees, counter-clockwise positive.
"""

from dataclasses import dataclass
from typing import Protocol

DIRECTIONS = ("north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest")


@dataclass(frozen=True, slots=True)
class Move:
    """Walk straight; nothing happens while something is held."""

    east: float
    north: float


@dataclass(frozen=True, slots=True)
class Grasp:
    """Take what lies on the adjacent square in one of the eight DIRECTIONS, when it can be moved."""

    direction: str

    def __post_init__(self) -> None:
        if self.direction not in DIRECTIONS:
            raise ValueError(f"no such direction: {self.direction!r}")


@dataclass(frozen=True, slots=True)
class Push:
    """Walk straight together with what is held."""

    east: float
    north: float


@dataclass(frozen=True, slots=True)
class Turn:
    """Turn what is held about Utak."""

    degrees: float


@dataclass(frozen=True, slots=True)
class Release:
    """Let go."""


Command = Move | Grasp | Push | Turn | Release


@dataclass(frozen=True, slots=True)
class Impression:
    """What Utak senses where he has come to a halt.

    Attributes
    ----------
    retina : 160 gray levels, 0 to 7: fovea, middle and outer zone, each from its north row south, west to east.
    touch : the colours of the 8 adjacent squares, clockwise from north; None for floor.
    """

    retina: tuple[int, ...]
    touch: tuple[str | None, ...]


class Body(Protocol):
    """The only way from the mind to the world."""

    def wake(self) -> Impression:
        """Return the first impression."""

    def act(self, command: Command) -> Impression:
        """Carry out one command as far as the world allows, and return the impression there.

        Whether it succeeded is not told: it must be seen.
        """
