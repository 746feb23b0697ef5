"""A route: a tight path over a screen, and the homotopy class that it belongs to."""

from dataclasses import dataclass

from utak.geometry.kernels.arrays import Floats
from utak.geometry.routes.router import RouteAnswers


@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """A locally shortest path from a start to a goal.

    Two routes with the same ends on the same screen can be deformed into each other over
    free space exactly when their signatures are equal.

    Attributes
    ----------
    points : (n, 2) float64, corners (x, y) in squares from the screen's south-west corner, start and goal included;
        read-only.
    length : in squares.
    clearance : the radius of the largest body that can follow this route over the skeleton, from square to square, in
        squares; nan when the path over the skeleton is not known (from `shortest` alone).
    signature : signed crossing numbers of the portals crossed, from start to goal, negative when crossed southwards;
        empty for the class without any.
    chains : the numbers of the chains (edges of the pathgraph) that the route follows, in order (its ends may lie
        inside the first and last); empty when not known.
    """

    points: Floats
    length: float
    clearance: float
    signature: tuple[int, ...]
    chains: tuple[int, ...]


def routes_of_answers(answers: RouteAnswers, found: int, most: int) -> list[Route]:
    """Return at most `most` of the first `found` routes in a router's answers, shortest first."""
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
