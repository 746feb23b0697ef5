"""The true track of a run: where the robot was and where things lay, and what follows for doors and orders."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import shapely

# By example: the middle of the wall between its two rooms, which runs south to north, in squares.
WALL_AT = {
    "go_next_room": 21.0,
    "go_next_room_two_doors": 23.0,
    "push_square_next_room": 23.0,
    "push_exchange_rooms": 21.0,
}
MOVED = 0.05  # squares by which a thing that lies elsewhere was moved


class TrueTrack:
    """The true places of the robot and of all things in a run, line by line, table frame."""

    def __init__(self, lines: Sequence[dict[str, Any]], wall: float) -> None:
        """Take the lines of the steps of an episode, and the wall between the rooms of its world."""
        self.robot = [line["utak"] for line in lines]
        self.things = {name: [shapely.Polygon(line["objects"][name]) for line in lines] for name in lines[0]["objects"]}
        self.wall = wall

    def passes(self, name: str = "utak") -> list[float]:
        """Return how far north each pass through the wall was, of the robot or of a thing's middle."""
        points = self.robot if name == "utak" else [(one.centroid.x, one.centroid.y) for one in self.things[name]]
        pairs = pairwise(points)
        return [(y + v) / 2 for (x, y), (u, v) in pairs if (x < self.wall) != (u < self.wall)]

    def moved_at(self, name: str) -> int | None:
        """Return the first line in which a thing does not lie where it lay at first; None where it stayed."""
        first, *others = self.things[name]
        found = (n for n, one in enumerate(others, 1) if first.hausdorff_distance(one) > MOVED)
        return next(found, None)

    def moved(self) -> list[str]:
        """Return the things that were moved, in the order in which they were."""
        times = {name: self.moved_at(name) for name in self.things}
        return sorted((name for name, time in times.items() if time is not None), key=lambda name: times[name] or 0)

    def ends_east(self, name: str) -> bool:
        """Return whether a thing lies east of the wall at the end."""
        return bool(self.things[name][-1].centroid.x > self.wall)
