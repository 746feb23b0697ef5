"""A route: a tight way over a screen, and the class it belongs to."""

from dataclasses import dataclass

import numpy as np

from geometry.kernels.arrays import Floats
from geometry.routes.router import RouteAnswers


@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """A locally shortest way from a start to a goal.

    Two routes with the same ends on the same screen, for bodies of one radius, can be deformed into each other over
    free space exactly when their signatures are equal.
    """

    points: Floats
    """(n, 2) corners in squares, start and goal included."""
    length: float
    """In squares."""
    clearance: float
    """The radius of the largest body that can go this way, over the skeleton, from square to square; nan when the way
    over the skeleton is not known (from ``shortest`` alone)."""
    signature: tuple[int, ...]
    """Signed crossing numbers of the portals crossed (see strips.py); empty for the class without any."""
    chains: tuple[int, ...]
    """The chains of the pathgraph that the way uses, in order (its ends may lie inside the first and last); empty
    when not known."""


def read_answers(answers: RouteAnswers, found: int, most: int) -> list[Route]:
    """The routes of a query, shortest first, at most so many."""
    bounds = answers.bounds[: found + 1].tolist()
    lengths, lowest = answers.length[:found].tolist(), answers.lowest[:found].tolist()
    corners, crossings, chains = bounds[found]
    points = answers.corners[:corners].copy()
    points.flags.writeable = False
    numbers, walked = answers.crossings[:crossings].tolist(), answers.chains[:chains].tolist()
    routes = []
    for k in sorted(range(found), key=lengths.__getitem__)[:most]:
        (a, c, e), (b, d, f) = bounds[k], bounds[k + 1]
        clearance = 0.5 * lowest[k] ** 0.5
        routes.append(Route(points[a:b], lengths[k], clearance, tuple(numbers[c:d]), tuple(walked[e:f])))
    return routes


def length_of(points: Floats) -> float:
    """The length of a polyline."""
    return float(np.hypot(*np.diff(points, axis=0).T).sum())
