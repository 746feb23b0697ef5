"""The true track of a run: where the robot was and where things lay, and what follows for doors and orders."""

import json
import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import shapely

# By example: the middle of the wall between its two rooms, which runs south to north, in squares; 0 without one.
WALL_AT = {
    "go_next_room": 21.0,
    "go_next_room_two_doors": 23.0,
    "push_square_next_room": 23.0,
    "push_exchange_rooms": 21.0,
    "push_two_corners": 0.0,
    "push_exchange_places": 0.0,
    "go_next_room_none": 0.0,
    "push_square_narrow_door": 0.0,
}
MOVED = 0.05  # squares by which a thing that lies elsewhere was moved


class TrueTrack:
    """The true places of the robot and of all things in a run, line by line, table frame."""

    def __init__(self, lines: Sequence[dict[str, Any]], wall: float) -> None:
        """Take the lines of the steps of an episode, and the wall between the rooms of its world."""
        self.robot = [line["utak"] for line in lines]
        self.things = {name: [shapely.Polygon(line["objects"][name]) for line in lines] for name in lines[0]["objects"]}
        self.wall = wall
        self.beliefs = [json.dumps(line["belief"]) for line in lines]

    def passes(self, name: str = "utak") -> list[float]:
        """Return how far north each pass through the wall was, of the robot or of a thing's middle."""
        points = self.robot if name == "utak" else [(one.centroid.x, one.centroid.y) for one in self.things[name]]
        pairs = pairwise(points)
        return [(y + v) / 2 for (x, y), (u, v) in pairs if (x < self.wall) != (u < self.wall)]

    def passes_where(self, door: str) -> bool:
        """Return whether the robot passed the wall where a door of a name was believed; it woke facing north."""
        x, y = self.robot[0]
        for belief, (one, other) in zip(self.beliefs, pairwise(self.robot), strict=False):
            spans = re.findall(rf"threshold\({door},(-?\d+),(-?\d+),(-?\d+),(-?\d+)\)", belief)
            for east, north, far_east, far_north in (map(int, span) for span in spans):
                low, high = sorted((y + north / 100, y + far_north / 100))
                here = abs(x + (east + far_east) / 200 - self.wall) <= 1.0 and low <= (one[1] + other[1]) / 2 <= high
                if here and (one[0] < self.wall) != (other[0] < self.wall):
                    return True
        return False

    def first_planned(self, steps: Sequence[str]) -> str:
        """Return the first of some steps that settle something with which a plan begins; "" for none."""
        found = (re.search(rf"plan\(0,({'|'.join(steps)})\(", belief) for belief in self.beliefs)
        return next((one[1] for one in found if one), "")

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
