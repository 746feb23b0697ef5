"""First contact against slow sweeps with shapely, and cases where touching is allowed."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely import affinity, box

from utak.geometry.motion.first_contact import ContactBody, Obstacles, obstacle_part
from utak.geometry.motion.se2 import Motion, Rotate, Translate

MAX_PENETRATION = 1e-6  # squares: an overlap deeper than this is penetration
ELL = shapely.Polygon([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])
SHAPES = [
    box(0, 0, 2, 2),
    box(-1, 0, 3, 1),
    ELL,
    shapely.Polygon([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]),
    shapely.Polygon([(0, 0), (4, 0), (4, 3)]),
    shapely.Point(0, 0).buffer(1.5, quad_segs=4),
    box(-3, -3, 4, 4).difference(box(-2, -2, 3, 3)),
]
whole = st.integers(-6, 6).map(float)
real = st.floats(-6, 6).map(lambda v: round(v, 2))
either = whole | real
shapes = st.builds(
    lambda shape, degrees, x, y: affinity.translate(affinity.rotate(shape, degrees, origin=(0, 0)), x, y),
    st.sampled_from(SHAPES),
    st.sampled_from([0, 90, 180, 270]) | st.floats(0, 360).map(lambda v: round(v, 1)),
    either,
    either,
)
pushes = st.builds(Translate, either.map(lambda v: 2 * v), either.map(lambda v: 2 * v))
turns = st.builds(
    Rotate, st.sampled_from([-450.0, -90.0, 90.0, 180.0, 360.0]) | st.floats(-400, 400), st.tuples(either, either)
)
motions = pushes | turns


def overlap(a: shapely.Geometry, b: shapely.Geometry) -> float:
    """Return the area in which two shapes overlap more deeply than touching allows."""
    return a.buffer(-MAX_PENETRATION, join_style="mitre").intersection(b).area if a.intersects(b) else 0.0


def apart(a: shapely.Geometry, b: shapely.Geometry) -> bool:
    """Return whether the interiors of two shapes do not meet in an area."""
    return a.relate(b)[0] != "2"


def swept(shape: shapely.Geometry, motion: Motion, steps: int = 40) -> list:
    """Return the shape at equal steps of a motion."""
    return [motion.part(t).carry(shape) for t in np.linspace(0, 1, steps)]


@pytest.mark.long
@settings(max_examples=250, deadline=None)
@given(shapes, st.lists(shapes, min_size=1, max_size=3), st.lists(motions, min_size=1, max_size=3))
def test_a_motion_goes_as_far_as_a_sweep_with_shapely_and_no_further(
    body: shapely.Geometry, still: list, way: list
) -> None:
    assume(all(apart(body, obstacle) for obstacle in still))
    obstacles = Obstacles(still)
    for motion in way:
        fraction = obstacles.first_contact(ContactBody(body), motion)
        travelled = motion.part(fraction)
        assert max(overlap(pose, o) for pose in swept(body, travelled) for o in still) == 0.0
        if fraction < 1.0:
            check_stopped(body, motion, fraction, still)
        body = travelled.carry(body)


def check_stopped(body: shapely.Geometry, motion: Motion, fraction: float, still: list) -> None:
    """Assert that the body touches an obstacle, and that going on would enter one."""
    end = motion.part(fraction).carry(body)
    assert min(end.distance(obstacle) for obstacle in still) < 1e-9
    length = math.hypot(*motion) if isinstance(motion, Translate) else abs(math.radians(motion.degrees)) * 10
    beyond = [motion.part(fraction + step / length).carry(body) for step in (1e-4, 1e-3)]
    assert any(pose.intersection(obstacle).area > 0.0 for pose in beyond for obstacle in still)


@settings(max_examples=100, deadline=None)
@given(st.tuples(either, either), st.lists(shapes, min_size=1, max_size=3), pushes)
def test_a_point_stops_where_its_line_enters(point: tuple, still: list, push: Translate) -> None:
    assume(all(not obstacle.contains(shapely.Point(point)) for obstacle in still))
    assume(math.hypot(*push) > 0.1)
    contact = Obstacles(still).first_contact(ContactBody(points=[point]), push)
    end = (point[0] + push.dx * contact, point[1] + push.dy * contact)
    for obstacle in still:
        assert shapely.LineString([point, end]).intersection(obstacle.buffer(-MAX_PENETRATION)).length == 0.0
    if contact < 1.0:
        step = 1e-3 / math.hypot(*push)
        ahead = shapely.Point(end[0] + push.dx * step, end[1] + push.dy * step)
        corner_cut = min(obstacle.distance(ahead) for obstacle in still)
        assert corner_cut < 1e-9


FLOOR, WALL = box(-20, -2, 20, 0), box(10, 0, 12, 2)
ROOM = Obstacles([FLOOR, WALL])


@pytest.mark.long
@settings(max_examples=200, deadline=None)
@given(st.tuples(either, either), st.lists(shapes, min_size=1, max_size=3), st.lists(motions, min_size=1, max_size=3))
def test_a_point_moves_the_same_whether_or_not_the_union_is_known(point: tuple, still: list, several: list) -> None:
    known, body = Obstacles(still), ContactBody(None, [point])
    assert len(known.point_surface.hull)
    for motion in several:
        assert Obstacles(still).first_contact(body, motion) == known.first_contact(body, motion)
    assert Obstacles([obstacle_part(shape) for shape in still]).first_contact(body, motion) == known.first_contact(
        body, motion
    )


def test_the_union_of_obstacles_is_computed_when_a_point_comes_near_only() -> None:
    walls = Obstacles([box(0, 0, 4, 1), box(0, 1, 4, 2)])
    for free in (Translate(3.0, 0.0), Translate(1e-9, 5.0), Rotate(90.0, (5.0, 1.0))):
        assert walls.first_contact(ContactBody(None, [(5.0, 1.0)]), free) == 1.0
    assert "point_surface" not in vars(walls)
    assert walls.first_contact(ContactBody(None, [(5.0, 1.0)]), Translate(-2.0, 0.0)) == 0.5
    assert "point_surface" in vars(walls)


@pytest.mark.parametrize(
    ("motion", "fraction"),
    [
        (Translate(6, 0), 1.0),  # slides along the floor
        (Translate(20, 0), 0.4),  # and into a wall exactly as high as itself
        (Translate(0, -1), 0.0),
        (Translate(1, -0.001), 0.0),
        (Translate(-1, 0.001), 1.0),
        (Translate(0, 1), 1.0),
        (Rotate(-90, (0, 0)), 0.0),
        (Rotate(90, (0, 0)), 1.0),
        (Rotate(-90, (2, 0)), 1.0),
        (Rotate(360, (1, 1)), 0.0),
        (Translate(1e6, 1e6), 1.0),
        (Translate(0, -1e6), 0.0),
    ],
)
def test_a_square_on_the_floor(motion: Motion, fraction: float) -> None:
    assert ROOM.first_contact(ContactBody(box(0, 0, 2, 2)), motion) == pytest.approx(fraction, abs=1e-12)


@pytest.mark.parametrize(
    ("motion", "fraction"),
    [
        (Translate(9, 0), 1.0),
        (Translate(20, 0), 0.5),
        (Translate(20, 4), 1.0),  # touches the wall's upper corner and slides over it
        (Translate(20, 3.999), 0.5),
        (Translate(0, -1), 0.0),
    ],
)
def test_utak_on_the_floor(motion: Motion, fraction: float) -> None:
    assert ROOM.first_contact(ContactBody(points=[(0, 0)]), motion) == pytest.approx(fraction, abs=1e-12)


def test_no_point_slips_into_a_seam_of_two_obstacles() -> None:
    """A box flush against a slanted wall: Utak slides down the wall and stops at the box."""
    turn = Rotate(31.7, (3.3, -2.1))
    wall, chest = turn.carry(box(-20, -2, 20, 0)), turn.carry(box(5, 0, 7, 2))
    along = turn.points(np.array([[0.0, 0.0], [9.0, 0.0]]))
    push = Translate(*(along[1] - along[0]).tolist())
    contact = Obstacles([wall, chest]).first_contact(ContactBody(points=[tuple(along[0])]), push)
    assert contact == pytest.approx(5 / 9, abs=1e-9)


@pytest.mark.parametrize("first", [0, 1])
def test_a_turn_that_begins_along_an_edge_is_stopped_by_that_edge(first: int) -> None:
    walls = [box(-2, 0, 0, 2), box(0, -1, 2, 1)]
    contact = Obstacles(walls[::-1] if first else walls).first_contact(ContactBody(box(1, 1, 2, 5)), Rotate(90, (1, 0)))
    assert contact == 0.0


def test_a_corridor_as_wide_as_the_body_lets_pass_that_body_and_no_wider_one() -> None:
    corridor = Obstacles([box(-9, -2, 9, 0), box(-9, 2, 9, 4)])
    assert corridor.first_contact(ContactBody(box(-12, 0, -10, 2)), Translate(30, 0)) == 1.0
    assert corridor.first_contact(ContactBody(box(-12, 0, -10, 2.001)), Translate(30, 0)) < 0.1


def test_body_and_utak_move_as_one() -> None:
    both = ContactBody(box(0, 0, 2, 2), points=[(5, 1)])
    contact = ROOM.first_contact(both, Translate(20, 0))
    assert contact == 0.25


@pytest.mark.parametrize(
    "motion",
    [Translate(math.nan, 0), Translate(0, math.inf), Rotate(math.nan, (0, 0)), Rotate(90, (0, math.nan))],
    ids=str,
)
def test_a_motion_that_is_not_finite_is_an_error(motion: Motion) -> None:
    with pytest.raises(ValueError, match="must be finite"):
        ROOM.first_contact(ContactBody(box(0, 0, 2, 2)), motion)
    with pytest.raises(ValueError, match="must be finite"):
        ROOM.pushes(ContactBody(box(0, 0, 2, 2)), np.array([[math.inf, 0.0]]))


def test_many_motions_at_once_give_the_same_as_one_by_one() -> None:
    body = ContactBody(box(0, 0.5, 2, 2))
    vectors = np.array([[20.0, 0.0], [0.0, -3.0], [1.0, 1.0]])
    singly = [ROOM.first_contact(body, Translate(*v)) for v in vectors.tolist()]
    assert ROOM.pushes(body, vectors).tolist() == singly


def test_a_body_after_a_motion_is_the_moved_shape() -> None:
    motion = Rotate(37.0, (1.0, 2.0))
    np.testing.assert_allclose(ContactBody(ELL).after(motion).edges, ContactBody(motion.carry(ELL)).edges, atol=1e-12)


def test_five_hundred_random_motions_stay_within_the_room() -> None:
    """Rounding does not accumulate, and a body in a corner is never jammed."""
    rng = np.random.default_rng(5)
    den = Obstacles([box(-5, -5, 10, 10).difference(box(0, 0, 5, 5))])
    body = box(1, 1, 4, 3)
    for _ in range(500):
        motion: Motion = Translate(*rng.normal(0, 2, 2).tolist())
        if rng.random() < 0.5:
            motion = Rotate(float(rng.normal(0, 60)), tuple(rng.uniform(0, 5, 2).tolist()))
        body = motion.part(den.first_contact(ContactBody(body), motion)).carry(body)
        assert body.difference(box(0, 0, 5, 5)).area < 1e-7
    home = [Translate(0, 9), Translate(9, 0), Translate(0, -9), Translate(-9, 0)]
    fractions = [den.first_contact(ContactBody(body), motion) for motion in home]
    assert max(fractions) > 0.0


def test_first_contact_is_the_same_without_numba() -> None:
    """The kernels also run as plain Python."""
    code = (
        "from shapely import box; from utak.geometry.motion.first_contact import *;"
        "from utak.geometry.motion.se2 import *;"
        "o = Obstacles([box(5, 0, 6, 9)]); b = ContactBody(box(0, 0, 1, 4));"
        "print(o.first_contact(b, Translate(9, 1)), o.first_contact(b, Rotate(-170, (1, 4))))"
    )
    runs = [
        subprocess.run([sys.executable, "-c", code], env=os.environ | flag, capture_output=True, text=True, check=True)
        for flag in ({}, {"NUMBA_DISABLE_JIT": "1"})
    ]
    assert runs[0].stdout == runs[1].stdout != ""


def test_importing_first_contact_does_not_import_numba() -> None:
    code = "import sys, geometry.motion.first_contact; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


@pytest.mark.parametrize("motion", [Translate(0, -5), Rotate(2, (50, 0))], ids=["push", "turn"])
@pytest.mark.parametrize("bump_on", ["body", "obstacle"])
def test_a_contour_of_points_very_near_each_other_is_met_where_it_is(bump_on: str, motion: Motion) -> None:
    """An arc of 1e-3 squares in 20,000 points on a straight side: each step is shorter than any corner."""
    radius = 1e-3 / math.pi
    arc = [(radius * math.cos(t), radius * math.sin(t)) for t in np.linspace(0, math.pi, 20_000)]
    bumpy, plain = shapely.Polygon([(-1, 0), (-1, -1), (1, -1), (1, 0), *arc]), box(-1, -1, 1, 0)
    above, below = (bumpy, plain) if bump_on == "body" else (plain, bumpy)
    end = Rotate(180, (0, 0)).carry(above)  # face to face: moved back, then on, it meets the bump alone
    start = motion.part(-0.5).carry(Translate(0, radius).carry(end))
    contact = Obstacles([below]).first_contact(ContactBody(start), motion)
    at = motion.part(contact).carry(start)
    assert contact == pytest.approx(0.5, abs=1e-3)
    assert at.distance(below) < 1e-6
    assert at.intersection(shapely.buffer(below, -1e-6, join_style="mitre")).area == 0.0
