"""The physics: each command by itself, and laws that hold for all commands."""

import math
from typing import Any

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.motion.se2 import Rotate, Translate
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.senses import NEIGHBOUR_OFFSETS
from utak.simulator.world.world import Thing, World, outer_ring

VERGE = shapely.box(0, 0, 20, 18).difference(shapely.box(2, 2, 18, 16))
DEEP = 1e-6


def table(*things: Thing, heading: int = 0, fixed: tuple[Thing, ...] = (), **options: Any) -> Tabletop:
    return Tabletop(World(20, 18, VERGE, things, fixed, (8.5, 8.5), heading), **options)


def box(name: str, x: float, y: float, width: float = 1, height: float = 1) -> Thing:
    return Thing(name, "g", shapely.box(x, y, x + width, y + height))


@pytest.mark.parametrize(
    ("heading", "end"), [(0, (9.5, 10.5)), (90, (6.5, 9.5)), (180, (7.5, 6.5)), (270, (10.5, 7.5))]
)
def test_commands_are_in_utaks_frame(heading: int, end: tuple[float, float]) -> None:
    world = table(heading=heading)
    world.move(1, 2)
    assert world.utak == end


def test_a_motion_stops_at_the_first_contact() -> None:
    world = table(box("a", 12, 8))
    world.move(50, 0)
    assert world.utak == pytest.approx((12, 8.5))
    assert world.motion == Translate(pytest.approx(3.5), 0)
    world.move(1, 0)
    assert world.motion is None
    world.move(0, 50)
    assert world.utak == pytest.approx((12, 16))


def test_the_table_ends_where_there_is_no_verge() -> None:
    world = Tabletop(World(4, 4, shapely.MultiPolygon(), (), (), (1.5, 1.5), 0))
    world.move(-50, 0.5)
    assert world.utak[0] == pytest.approx(0)
    assert world.look()[1][6] == "b"


def test_grasp_push_turn_release() -> None:
    world = table(box("a", 9, 8))
    world.grasp("east")
    assert world.held == "a"
    world.push(1, 1)
    assert (world.utak, world.polygons["a"].bounds) == ((9.5, 9.5), (10, 9, 11, 10))
    world.turn(90)
    assert world.motion == Rotate(90, (9.5, 9.5))
    assert world.polygons["a"].bounds == (9, 10, 10, 11)
    world.release()
    assert (world.held, world.motion) == (None, None)
    world.push(1, 0)
    assert world.utak == (9.5, 9.5)


def test_a_command_that_cannot_act_changes_nothing() -> None:
    world = table(box("a", 9, 8), box("z", 8, 9), fixed=(box("p", 7, 8),))
    before = (world.utak, dict(world.polygons))
    for command in [
        lambda: world.push(1, 1),
        lambda: world.turn(90),
        lambda: world.grasp("south"),  # floor
        lambda: world.grasp("west"),  # fixed
        lambda: world.release(),
        lambda: world.move(0, 0),
    ]:
        command()
        assert (world.utak, world.polygons, world.held, world.motion) == (*before, None, None)
    world.grasp("east")
    world.grasp("north")  # a hand is full
    world.move(-1, -1)
    assert (world.utak, world.polygons, world.held) == (*before, "a")


def test_a_pushed_thing_does_not_push_others() -> None:
    world = table(box("a", 9, 8), box("c", 13, 8))
    world.grasp("east")
    world.push(50, 0)
    assert world.polygons["a"].bounds == pytest.approx((12, 8, 13, 9))
    assert world.polygons["c"].bounds == (13, 8, 14, 9)


def test_an_object_behind_utak_stops_a_pull() -> None:
    world = table(box("a", 9, 8), box("c", 5, 8))
    world.grasp("east")
    world.push(-50, 0)
    assert world.utak == pytest.approx((6, 8.5))


def test_a_turn_stops_at_the_first_contact_and_never_jumps() -> None:
    world = table(box("a", 9, 8), fixed=(box("p", 8, 9.5),))
    world.grasp("east")
    world.turn(720)
    assert isinstance(world.motion, Rotate)
    assert 0 < world.motion.degrees < 60
    assert world.polygons["a"].intersection(world.world.fixed[0].polygon).area < DEEP


def test_after_a_release_between_wall_and_object_both_block() -> None:
    world = table(box("a", 8.5, 8))
    world.grasp("east")
    world.push(-50, 0)
    world.release()
    assert (world.utak[0], world.polygons["a"].bounds[0]) == pytest.approx((2, 2))
    for east in (-1, 1):
        world.move(east, 0)
        assert world.utak[0] == pytest.approx(2)
    world.move(0, 3)
    assert world.utak == pytest.approx((2, 11.5))


def test_a_grasp_takes_the_first_by_name_of_those_that_share_a_square() -> None:
    world = table(box("a", 9.5, 8, 0.5), box("z", 9, 8, 0.5))
    world.grasp("east")
    assert world.held == "a"


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_commands_must_be_finite(value: float) -> None:
    world = table(box("a", 9, 8))
    with pytest.raises(ValueError, match="not a finite number"):
        world.move(value, 0)
    world.grasp("east")
    with pytest.raises(ValueError, match="not a finite number"):
        world.push(0, value)
    with pytest.raises(ValueError, match="not a finite number"):
        world.turn(value)


amount = st.floats(-12, 12) | st.integers(-12, 12).map(float)
command = st.one_of(
    st.tuples(st.just("move"), amount, amount),
    st.tuples(st.just("push"), amount, amount),
    st.tuples(st.just("turn"), st.floats(-400, 400) | st.sampled_from([90.0, -90.0, 180.0])),
    st.tuples(st.just("grasp"), st.sampled_from(["north", "northeast", "east", "south", "west"])),
    st.tuples(st.just("release")),
)
THINGS = (
    box("a", 9, 8, 2, 1),
    box("c", 6, 8.25, 2, 2),
    Thing("d", "d", shapely.Polygon([(12, 12), (15, 13), (12, 14)])),
)


def depth(world: Tabletop) -> float:
    """Return the greatest area that two things on the table have in common."""
    shapes = [VERGE, *world.polygons.values(), *(t.polygon for t in world.world.fixed)]
    return max(a.intersection(b).area for n, a in enumerate(shapes) for b in shapes[:n])


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(st.integers(0, 359), st.lists(command, max_size=12), st.sampled_from([0.0, 0.05]))
def test_things_never_overlap_after_motions(heading: int, commands: list[Any], noise: float) -> None:
    world = table(*THINGS, heading=heading, fixed=(box("p", 4, 12, 3, 1),), noise=noise)
    sizes = {name: (p.area, p.length) for name, p in world.polygons.items()}
    for name, *values in commands:
        getattr(world, name)(*values)
        assert depth(world) < 20 * DEEP
        assert not shapely.box(2, 2, 18, 16).exterior.distance(shapely.Point(world.utak)) > 20
        inside = [p for p in world.polygons.values() if p.buffer(-DEEP).contains(shapely.Point(world.utak))]
        assert not inside
    for name, polygon in world.polygons.items():
        assert (polygon.area, polygon.length) == pytest.approx(sizes[name])


# Grasps what is beside Utak, if anything is, so that random commands carry something.
carrying = st.one_of(command, st.just(("take",)), st.just(("take",)))


def play(world: Tabletop, commands: list[Any]) -> None:
    """Carry out commands; "take" grasps the first adjacent thing that can be grasped."""
    for name, *values in commands:
        if name != "take":
            getattr(world, name)(*values)
        for direction in NEIGHBOUR_OFFSETS if name == "take" else ():
            world.grasp(direction)


@pytest.mark.long
@settings(max_examples=80, deadline=None)
@given(st.sampled_from([0, 90, 33]), st.lists(carrying, max_size=10), st.lists(carrying, max_size=4))
def test_a_table_that_was_played_on_is_as_a_new_one(heading: int, commands: list[Any], further: list[Any]) -> None:
    """What is kept between commands for speed changes no digit: neither what is sensed nor how far motions go."""
    played = table(*THINGS, heading=heading, fixed=(box("p", 4, 12, 3, 1),))
    play(played, commands)
    played.release()
    things = tuple(Thing(name, "g", polygon) for name, polygon in played.polygons.items())
    new = Tabletop(World(20, 18, VERGE, things, played.world.fixed, played.utak, heading))
    for one in further:
        play(played, [one])
        play(new, [one])
        assert (played.motion, played.utak, played.held) == (new.motion, new.utak, new.held)
        assert [outer_ring(p) for p in played.polygons.values()] == [outer_ring(p) for p in new.polygons.values()]
        assert played.look()[0] == new.look()[0]


def test_a_thing_with_points_very_near_each_other_is_carried_as_any_other() -> None:
    near = shapely.Polygon([(9, 8), (10, 8), (10, 8 + 1.5e-7), (10, 9), (9, 9)])
    worlds = [table(Thing("a", "g", shape)) for shape in (near, shapely.box(9, 8, 10, 9))]
    for world in worlds:
        play(world, [("take",), ("push", 0.3, 1.0), ("turn", 33.3), ("push", 50.0, 0.0), ("turn", -50.0)])
    assert worlds[0].utak == pytest.approx(worlds[1].utak)
    assert worlds[0].look() == worlds[1].look()


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 359), amount, amount, st.floats(-170, 170))
def test_a_reversed_motion_returns(heading: int, east: float, north: float, degrees: float) -> None:
    world = table(*THINGS, heading=heading)
    directions = ("north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest")
    world.grasp(directions[next(n for n, colour in enumerate(world.look()[1]) if colour)])
    held = world.held
    assert held is not None
    start = world.polygons[held]
    world.push(east, north)
    pushed = world.motion
    world.turn(degrees)
    if isinstance(world.motion, Rotate):
        world.turn(-world.motion.degrees)
    if isinstance(pushed, Translate):
        cosine, sine = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        dx, dy = -pushed.dx, -pushed.dy
        world.push(dx * cosine + dy * sine, dy * cosine - dx * sine)
    assert world.utak == pytest.approx((8.5, 8.5), abs=1e-6)
    assert shapely.hausdorff_distance(world.polygons[held], start) < 1e-6


@given(st.lists(command, max_size=8), st.integers(0, 5))
@settings(max_examples=30, deadline=None)
def test_same_seed_same_world(commands: list[Any], seed: int) -> None:
    worlds = [table(*THINGS, noise=0.2, seed=seed) for _ in range(2)]
    for world in worlds:
        for name, *values in commands:
            getattr(world, name)(*values)
    first, second = ((w.utak, w.held, {n: outer_ring(p) for n, p in w.polygons.items()}) for w in worlds)
    assert first == second


@pytest.mark.long
def test_noise_disturbs_distance_direction_and_grasp() -> None:
    ends, slips = [], 0
    for seed in range(300):
        world = table(box("a", 9, 8), noise=0.1, seed=seed)
        world.move(-3, 0)
        ends.append(world.utak)
        world = table(box("a", 9, 8), noise=0.1, seed=seed)
        world.grasp("east")
        slips += world.held is None
    lengths = [math.dist(end, (8.5, 8.5)) for end in ends]
    spread = math.sqrt(sum((length - 3) ** 2 for length in lengths) / 300)
    assert spread == pytest.approx(0.3, rel=0.2)
    angles = [math.atan2(8.5 - y, 8.5 - x) for x, y in ends]
    assert math.sqrt(sum(angle**2 for angle in angles) / 300) == pytest.approx(0.1, rel=0.2)
    assert 15 <= slips <= 48
