"""Doors and rooms: the necks of the floor that geometry measures, which of them are doors (kb/asp/rooms.lp), and the parts between them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kb.worldmodel import WorldModel

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Rooms:
    """doors: by name. labels: (rows, columns) the room of each square, 0 for none. start: the room in which Utak began."""

    doors: tuple[str, ...]
    labels: NDArray[np.int32]
    start: int

    def next_to_start(self) -> Mask:
        """(rows, columns): squares well inside rooms that share a door with the one in which Utak began."""
        return np.zeros(self.labels.shape, bool)


def rooms_of(model: WorldModel) -> Rooms:
    """The rooms of a world model."""
    return Rooms((), np.zeros(model.labels.shape, np.int32), 0)
