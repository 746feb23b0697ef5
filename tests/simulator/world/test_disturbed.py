"""Changes by others between two commands: they happen before the command named, or are refused with a reason."""

import pytest
import shapely

from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import Disturbance, Thing, World

VERGE = shapely.box(0, 0, 20, 18).difference(shapely.box(2, 2, 18, 16))
THINGS = (Thing("a", "g", shapely.box(9, 8, 10, 9)), Thing("c", "r", shapely.box(4, 4, 6, 6)))


def table(*acts: Disturbance) -> Tabletop:
    return Tabletop(World(20, 18, VERGE, THINGS, (), (8.5, 8.5), 0, acts))


def move(step: int, name: str, x: float, y: float) -> Disturbance:
    return Disturbance(step, name, shapely.Point(x, y), f"move({name},{step})")


def test_a_thing_is_moved_before_the_command_of_that_number() -> None:
    world = table(move(2, "a", 12.5, 8.5))
    world.move(0.25, 0)
    assert world.polygons["a"].bounds == (9, 8, 10, 9) and not world.disturbed
    world.move(9, 0)
    assert world.polygons["a"].bounds == (12, 8, 13, 9) and list(world.disturbed) == ["a"]
    assert world.utak == pytest.approx((12, 8.5))  # where it lies now it is in the way
    world.move(-1, 0)
    assert not world.disturbed
    assert world.sense().tolist() == Tabletop(world.now).sense().tolist()


def test_what_is_held_is_let_go_where_it_is_moved_or_utak_is_lifted() -> None:
    for act in (move(2, "a", 12.5, 12.5), Disturbance(2, "utak", shapely.Point(4.5, 12.5), "lift"), vanishing(2, "a")):
        world = table(act)
        world.grasp("east")
        assert world.held == "a"
        world.push(1, 0)
        assert world.held is None and world.motion is None and not world.refused


def vanishing(step: int, name: str) -> Disturbance:
    return Disturbance(step, name, None, f"vanish({name},{step})")


def test_what_vanishes_lies_beside_the_table_and_can_come_back() -> None:
    world = table(vanishing(1, "a"), move(3, "a", 12.5, 8.5))
    world.release()
    assert world.polygons["a"].bounds == (22, 8, 23, 9)
    assert world.sense().tolist() == Tabletop(World(20, 18, VERGE, THINGS[1:], (), (8.5, 8.5), 0)).sense().tolist()
    world.move(9, 0)
    assert world.utak == pytest.approx((17.5, 8.5))
    world.move(-9, 0)
    assert world.utak == pytest.approx((13, 8.5))


@pytest.mark.parametrize(
    ("act", "why"),
    [
        (move(1, "a", 5, 6), "a would overlap c by 0.5 squares"),
        (move(1, "a", 2, 6), "a would overlap the verge by 0.5 squares"),
        (move(1, "c", 8.5, 8.5), "c would overlap a by 0.5 squares"),
        (move(1, "a", 8.5, 8.75), "a would lie over Utak"),
        (Disturbance(1, "utak", shapely.Point(5, 5), "lift"), "Utak would stand inside c, at (5, 5)"),
        (
            Disturbance(1, "a", shapely.box(19, 8, 21, 9), "appear"),
            "a would reach beyond the table: (19, 8) to (21, 9)",
        ),
    ],
)
def test_what_has_no_room_is_refused(act: Disturbance, why: str) -> None:
    world = table(act)
    before = dict(world.polygons)
    world.release()
    assert list(world.refused) == [act.fact] and why in world.refused[act.fact]
    assert not world.disturbed and world.polygons == before and world.utak == (8.5, 8.5)


def test_begun_anew_others_do_the_same_again() -> None:
    world = table(move(1, "a", 12.5, 8.5))
    for _ in range(2):
        world.restart(0)
        world.move(9, 0)
        assert world.utak == pytest.approx((12, 8.5))
