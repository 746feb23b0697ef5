"""The kind of a cell of poses holds at every pose in it, and distances are shapely's: sampled with shapely."""

import math

import numpy as np
import pytest
import shapely
from shapely import affinity, box

from utak.geometry.motion.body import new_moving_body
from utak.geometry.motion.cell_clearance import CELL_BLOCKED, CELL_CENTRE_FREE, CELL_FREE, classify_cell, clearance_at
from utak.geometry.motion.obstacle_field import ObstacleField
from utak.geometry.motion.se2 import Pose

HORSESHOE = shapely.Polygon([(0, 0), (6, 0), (6, 5), (4.8, 5), (4.8, 1.2), (1.2, 1.2), (1.2, 5), (0, 5)])
TWO = shapely.MultiPolygon([box(0, 0, 3, 1), box(4, 0, 4.1, 0.1)])
SHAPES = [box(-3, -1, 3, 1), HORSESHOE, TWO, shapely.Polygon([(0, 0), (4, 0), (1, 3)])]


def random_walls(rng: np.random.Generator) -> shapely.Geometry:
    """Return thick and thin rectangles at random, some of them small enough to lie within a body."""
    sizes = rng.choice([0.2, 0.5, 1.0, 4.0], (6, 2))
    things = [affinity.rotate(box(0, 0, w, h), float(rng.uniform(0, 360))) for w, h in sizes]
    return shapely.union_all([affinity.translate(t, *rng.uniform(0, 16, 2)) for t in things])


@pytest.mark.long
@pytest.mark.parametrize("shape", SHAPES)
def test_the_kind_of_a_cell_holds_at_every_pose_in_it(shape: shapely.Geometry) -> None:
    rng = np.random.default_rng(len(shape.wkt))
    body, seen = new_moving_body(shape), []
    for _ in range(12):
        walls = random_walls(rng)
        field = ObstacleField(walls, (0, 0, 16, 16))
        nearby = field.ground(body)
        for _ in range(60):
            x, y, angle = *rng.uniform(1, 15, 2), rng.uniform(0, 2 * math.pi)
            half_place, half_angle = rng.choice([0.02, 0.1, 0.4]), rng.choice([0.01, 0.05, 0.2])
            kind = classify_cell(body, nearby, x, y, angle, half_place * math.sqrt(2), half_angle)
            seen.append(kind)
            offsets = rng.choice([-1.0, 1.0, 0.3], (8, 3)) * [half_place, half_place, half_angle]
            for dx, dy, turn in [(0.0, 0.0, 0.0), *offsets]:
                check_pose(kind, body, shape, walls, (x + dx, y + dy, angle + turn), (dx, dy, turn) == (0, 0, 0))
    assert {CELL_FREE, CELL_BLOCKED} <= set(seen)


def check_pose(
    kind: int, body: object, shape: shapely.Geometry, walls: shapely.Geometry, pose: tuple, middle: bool
) -> None:
    """Check the kind of a cell at one pose of it with shapely."""
    x, y, angle = pose
    origin = np.asarray(body.reference)  # type: ignore[attr-defined]
    c, s = math.cos(angle), math.sin(angle)
    place = Pose(x + c * origin[0] - s * origin[1], y + s * origin[0] + c * origin[1], math.degrees(angle))
    common = place.place(shape).intersection(walls).area
    within = 0 <= place.x <= 16 and 0 <= place.y <= 16
    if kind == CELL_FREE or (kind == CELL_CENTRE_FREE and middle):
        assert within
        assert common < 1e-9
    if kind == CELL_BLOCKED:
        assert common > 0.0 or not within


def test_distances_agree_with_shapely() -> None:
    rng = np.random.default_rng(3)
    for shape in SHAPES:
        body = new_moving_body(shape)
        middle = affinity.translate(shape, *body.reference)
        for _ in range(40):
            walls = random_walls(rng)
            nearby = ObstacleField(walls, (0, 0, 16, 16)).ground(body)
            x, y, angle = *rng.uniform(0, 16, 2), rng.uniform(0, 2 * math.pi)
            want = Pose(x, y, math.degrees(angle)).place(middle).distance(walls)
            found = clearance_at(body, nearby, x, y, math.cos(angle), math.sin(angle))
            if want == 0.0:
                assert found == -1.0
            elif want < nearby.reach:
                assert found == pytest.approx(want, abs=1e-7)
