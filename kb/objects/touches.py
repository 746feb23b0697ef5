"""Touches: the colours that the robot feels now, and the colour of each square that it ever felt.

State that lasts from one impression to the next.
"""

from collections.abc import Container, Iterable

from utak.geometry.kernels.arrays import Square
from utak.kb.body import DIRECTIONS
from utak.kb.mapping.patch import Patch
from utak.kb.perception.frame import Frame


class Touches:
    """The colours that were felt, now and before."""

    def __init__(self) -> None:
        self.current: tuple[str | None, ...] = ()
        self.colours: dict[Square, str] = {}

    def forget_squares(self) -> None:
        """Forget the colours of all squares: they are squares of a frame that is no longer believed."""
        self.colours.clear()

    def forget(self, squares: Iterable[Square]) -> None:
        """Forget the colours of some squares: others changed what is there."""
        for square in squares:
            self.colours.pop(square, None)

    def feel(self, touch: tuple[str | None, ...], frame: Frame, square: Square, held: Container[Square]) -> None:
        """Take in the touches of an impression: `current` becomes them, and `colours` is kept up to date."""
        self.current = touch
        x, y = square
        for direction, colour in zip(DIRECTIONS, touch, strict=True):
            adjacent = frame.beside(direction)
            if adjacent is None:
                continue
            there = x + adjacent[0], y + adjacent[1]
            if colour is None or there in held:
                self.colours.pop(there, None)
            else:
                self.colours[there] = colour

    def felt_in(self, direction: str) -> str | None:
        """Return the colour felt now in one of the eight DIRECTIONS of the robot frame."""
        # None for floor, and before the first impression. Another direction raises ValueError.
        return self.current[DIRECTIONS.index(direction)] if self.current else None

    def colour_of(self, patch: Patch) -> str | None:
        """Return the colour of the first square of a patch (by x, then y) that was felt; None when none was."""
        colours = [self.colours[square] for square in sorted(patch.squares()) if square in self.colours]
        return colours[0] if colours else None
