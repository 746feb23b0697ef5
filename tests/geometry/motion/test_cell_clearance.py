"""What is said of a cell of poses holds for every pose in it: sampled with shapely."""

import math

import numpy as np
import pytest
import shapely
from shapely import affinity, box

from geometry.motion.body import new_mover
from geometry.motion.cell_clearance import FREE, FULL, OPEN, classify, distance_at
from geometry.motion.obstacle_field import ObstacleField
from geometry.motion.se2 import Pose

HORSESHOE = shapely.Polygon([(0, 0), (6, 0), (6, 5), (4.8, 5), (4.8, 1.2), (1.2, 1.2), (1.2, 5), (0, 5)])
TWO = shapely.MultiPolygon([box(0, 0, 3, 1), box(4, 0, 4.1, 0.1)])
BODIES = [box(-3, -1, 3, 1), HORSESHOE, TWO, shapely.Polygon([(0, 0), (4, 0), (1, 3)])]


def random_walls(rng: np.random.Generator) -> shapely.Geometry:
    """Thick and thin things about, some of them small enough to lie within a body."""
    sizes = rng.choice([0.2, 0.5, 1.0, 4.0], (6, 2))
    things = [affinity.rotate(box(0, 0, w, h), float(rng.uniform(0, 360))) for w, h in sizes]
    return shapely.union_all([affinity.translate(t, *rng.uniform(0, 16, 2)) for t in things])


@pytest.mark.parametrize("body", BODIES)
def test_a_verdict_holds_all_through_the_cell(body: shapely.Geometry) -> None:
    rng = np.random.default_rng(len(body.wkt))
    mover, seen = new_mover(body), []
    for _ in range(12):
        walls = random_walls(rng)
        floor = ObstacleField(walls, (0, 0, 16, 16))
        ground = floor.ground(mover)
        for _ in range(60):
            x, y, angle = *rng.uniform(1, 15, 2), rng.uniform(0, 2 * math.pi)
            half_place, half_angle = rng.choice([0.02, 0.1, 0.4]), rng.choice([0.01, 0.05, 0.2])
            kind = classify(mover, ground, x, y, angle, half_place * math.sqrt(2), half_angle)
            seen.append(kind)
            offsets = rng.choice([-1.0, 1.0, 0.3], (8, 3)) * [half_place, half_place, half_angle]
            for dx, dy, turn in [(0.0, 0.0, 0.0), *offsets]:
                check(kind, mover, body, walls, (x + dx, y + dy, angle + turn), (dx, dy, turn) == (0, 0, 0))
    assert {FREE, FULL} <= set(seen)


def check(kind: int, mover: object, body: shapely.Geometry, walls: shapely.Geometry, pose: tuple, middle: bool) -> None:
    """One pose against shapely."""
    x, y, angle = pose
    origin = np.asarray(mover.reference)  # type: ignore[attr-defined]
    c, s = math.cos(angle), math.sin(angle)
    place = Pose(x + c * origin[0] - s * origin[1], y + s * origin[0] + c * origin[1], math.degrees(angle))
    common = place.place(body).intersection(walls).area
    within = 0 <= place.x <= 16 and 0 <= place.y <= 16
    if kind == FREE or (kind == OPEN and middle):
        assert within
        assert common < 1e-9
    if kind == FULL:
        assert common > 0.0 or not within


def test_distances_are_shapelys() -> None:
    rng = np.random.default_rng(3)
    for body in BODIES:
        mover = new_mover(body)
        middle = affinity.translate(body, *mover.reference)
        for _ in range(40):
            walls = random_walls(rng)
            ground = ObstacleField(walls, (0, 0, 16, 16)).ground(mover)
            x, y, angle = *rng.uniform(0, 16, 2), rng.uniform(0, 2 * math.pi)
            want = Pose(x, y, math.degrees(angle)).place(middle).distance(walls)
            found = distance_at(mover, ground, x, y, math.cos(angle), math.sin(angle))
            if want == 0.0:
                assert found == -1.0
            elif want < ground.reach:
                assert found == pytest.approx(want, abs=1e-7)
