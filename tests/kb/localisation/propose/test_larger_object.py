"""An object drawn out of what seemed to be wall shows how far it went on; eyes.py makes the impressions."""

import pytest
import shapely
from shapely.affinity import translate

from tests.kb.eyes import Occupied, impression, world_of
from tests.kb.localisation.hypotheses.test_remap import around
from utak.kb.body import Move, Push
from utak.kb.knowledge import Knowledge
from utak.kb.localisation.tracker import Tracker
from utak.kb.mapping.occupancy import FREE, OCCUPIED
from utak.kb.objects.held_object import HeldObject, initial_insets

HERE = (17, 12)  # table frame: (0, 0) of the map frame
DOOR = ["b" + "." * 19 + "..." + "." * 17 + "b"] * 5
NO_DOOR = ["b" + "." * 19 + "bbb" + "." * 17 + "b"] * 5


def hall(middle: list[str]) -> Occupied:
    """Return two rooms and a wall of three squares between them. middle : five rows of it, from the tenth on."""
    wall = "b" + "." * 19 + "bbb" + "." * 17 + "b"
    return world_of(["b" * 40, *[wall] * 10, *middle, *[wall] * 9, "b" * 40])


def drawn(room: Occupied, deep: int, by: float) -> tuple[Tracker, str]:
    """Return the tracker, and the kind of its explanation, after an object before a wall was drawn back to the west.

    Two columns of the object stick out of the wall. room : without it. deep : squares that it goes on in the wall.
    by : squares that it is drawn.
    """
    thing = shapely.box(18, 10, 20 + deep, 15)
    tracker = Tracker()
    tracker.wake(impression(around(thing, room), HERE))
    tracker.accommodate(Move(0.0, 1.0), impression(around(thing, room), (HERE[0], HERE[1] + 1)))
    tracker.accommodate(Move(0.0, -1.0), impression(around(thing, room), HERE))
    felt = translate(shapely.box(18, 10, 20, 15), -HERE[0], -HERE[1])
    tracker.grasp(HeldObject("o1", felt, felt))
    after = around(translate(thing, -by), room)
    found = tracker.accommodate(Push(-by, 0.0), impression(after, (round(HERE[0] - by), HERE[1])))
    return tracker, found.explanation.how


@pytest.mark.long
@pytest.mark.parametrize("deep", [1, 2, 3])
@pytest.mark.parametrize("by", [2.0, 4.0])
def test_an_object_drawn_out_of_a_door_shows_its_true_size(deep: int, by: float) -> None:
    tracker, how = drawn(hall(DOOR), deep, by)
    assert how == "larger"
    held, occupancy = tracker.state.held_objects["o1"], tracker.state.occupancy
    first = translate(shapely.box(18, 10, 20 + deep, 15), -HERE[0], -HERE[1])
    assert held.first.equals(first)
    assert held.polygon.equals(translate(first, -by))
    assert held.proven
    assert tracker.state.place == pytest.approx((0.5 - by, 0.5))
    assert {occupancy.state[occupancy.index(3, y)] for y in range(-2, 3)} == {FREE}


@pytest.mark.parametrize("by", [2.0, 4.0])
def test_an_object_before_a_wall_is_no_larger_than_it_seemed(by: float) -> None:
    tracker, how = drawn(hall(NO_DOOR), 0, by)
    assert how == "predicted"
    assert tracker.state.held_objects["o1"].polygon.equals(
        translate(shapely.box(18, 10, 20, 15), -HERE[0] - by, -HERE[1])
    )
    assert tracker.state.occupancy.state[tracker.state.occupancy.index(3, 0)] == OCCUPIED


def test_an_object_that_was_moved_before_is_no_larger_than_it_seemed() -> None:
    tracker, _ = drawn(hall(DOOR), 1, 2.0)
    again = around(shapely.box(14, 10, 17, 15), hall(DOOR))
    assert tracker.accommodate(Push(-2.0, 0.0), impression(again, (13, 12))).explanation.how == "predicted"


def test_the_shape_class_of_a_larger_object_is_measured_anew() -> None:
    """A brick looks like a square while it sticks out of a door."""
    knowledge, wide = Knowledge(), shapely.box(15, 10, 22, 15)
    before, after = around(wide, hall(DOOR)), around(translate(wide, -3.0), hall(DOOR))
    here = (14, 12)
    knowledge.wake(impression(before, here, colour="g"))
    felt = translate(shapely.box(15, 10, 20, 15), -here[0], -here[1])
    knowledge.tracker.grasp(HeldObject("o1", felt, felt, shape={"square": 62, "brick": 30}))
    model, accommodated = knowledge.perceive(Push(-3.0, 0.0), impression(after, (11, 12), colour="g"))
    assert accommodated.explanation.how == "larger"
    node = model.object("o1")
    assert node is not None
    assert node.shape["brick"] > 50
    assert node.shape["square"] < 50


@pytest.mark.parametrize("by", [4.0, 12.0])
def test_an_arm_that_leans_on_a_wall_comes_along_with_its_thing(by: float) -> None:
    """A U seems an L while one of its arms leans on the end of a wall, and so seems to be the end of that."""
    wall = ["b" + "." * 28 + "bbb" + "." * 17 + "b"] * 12
    room = world_of(["b" * 49, *wall, *["b" + "." * 47 + "b"] * 10, "b" * 49])
    thing = shapely.box(20, 5, 32, 11) - shapely.box(23, 8, 29, 11)
    knowledge, here = Knowledge(), (19, 10)
    knowledge.wake(impression(around(thing, room), (19, 4)))
    knowledge.perceive(Move(0.0, 6.0), impression(around(thing, room), here))
    felt = translate(thing & shapely.box(20, 5, 29, 11), -here[0], -4)
    knowledge.tracker.grasp(HeldObject("o1", felt, felt))
    after = impression(around(translate(thing, -by), room), (round(here[0] - by), here[1]))
    _, accommodated = knowledge.perceive(Push(-by, 0.0), after)
    assert accommodated.explanation.how == "larger"
    assert knowledge.memory.held_objects["o1"].polygon.equals(translate(thing, -here[0] - by, -4))


@pytest.mark.parametrize(
    "felt", [shapely.box(20, 10, 22, 11), shapely.box(21, 10, 22, 11), shapely.box(20, 10, 23, 11)]
)
@pytest.mark.parametrize("by", [1.0, 3.0])
def test_a_thing_flush_in_a_niche_comes_out_with_all_its_sides(felt: shapely.Polygon, by: float) -> None:
    """Of a thing that fills a niche only the squares that were felt seem a thing."""
    rows = ["b" * 40, *["b" * 20 + "..." + "b" * 17] * 3, *["b" + "." * 38 + "b"] * 9, "b" * 40]
    room, thing, here = world_of(rows), shapely.box(20, 10, 23, 13), (21, 9)
    knowledge = Knowledge()
    knowledge.wake(impression(around(thing, room), (15, 6)))
    knowledge.perceive(Move(6.0, 3.0), impression(around(thing, room), here))
    lying = translate(felt, -15, -6)
    knowledge.tracker.grasp(HeldObject("o1", lying, lying))
    after = impression(around(translate(thing, 0, -by), room), (here[0], round(here[1] - by)))
    _, accommodated = knowledge.perceive(Push(0.0, -by), after)
    assert accommodated.explanation.how == "larger"
    assert knowledge.memory.held_objects["o1"].polygon.equals(translate(thing, -15, -6 - by))


def test_a_thing_may_fill_the_notch_of_what_was_felt() -> None:
    rows = ["b" * 40, *["b" * 20 + ".." + "b" * 18] * 2, *["b" + "." * 38 + "b"] * 9, "b" * 40]
    room, thing, here = world_of(rows), shapely.box(20, 10, 22, 12), (20, 9)
    knowledge = Knowledge()
    knowledge.wake(impression(around(thing, room), here))
    lying = translate(thing - shapely.box(21, 11, 22, 12), -here[0], -here[1])
    knowledge.tracker.grasp(HeldObject("o1", lying, lying))
    after = impression(around(translate(thing, 0, -1), room), (here[0], here[1] - 1))
    _, accommodated = knowledge.perceive(Push(0.0, -1.0), after)
    assert accommodated.explanation.how == "larger"
    assert knowledge.memory.held_objects["o1"].polygon.equals(translate(thing, -here[0], -here[1] - 1))


def test_a_thing_that_was_moved_by_a_part_of_a_square_may_still_be_larger() -> None:
    """The walls beside it stay what they are."""
    rows = ["b" * 40, *["b" * 20 + "..." + "b" * 17] * 3, *["b" + "." * 38 + "b"] * 9, "b" * 40]
    room, thing, here = world_of(rows), shapely.box(20, 10, 23, 13), (21, 9)
    knowledge = Knowledge()
    knowledge.wake(impression(around(thing, room), here))
    lying = translate(shapely.box(20, 10, 23, 11), -here[0], -here[1])
    knowledge.tracker.grasp(HeldObject("o1", lying, lying, insets=initial_insets(lying)))
    knowledge.perceive(Push(0.0, -0.1), impression(around(translate(thing, 0, -0.1), room), here))
    assert knowledge.memory.held_objects["o1"].proven
    after = impression(around(translate(thing, 0, -3.1), room), (here[0], here[1] - 3))
    _, accommodated = knowledge.perceive(Push(0.0, -3.0), after)
    assert accommodated.explanation.how == "larger"
    held, occupancy = knowledge.memory.held_objects["o1"], knowledge.memory.occupancy
    assert held.first.equals(translate(thing, -here[0], -here[1]))
    assert {occupancy.state[occupancy.index(x, y)] for x in (-2, 2) for y in (1, 2, 3)} == {OCCUPIED}
    assert not knowledge.memory.shaken


def test_what_left_elsewhere_is_no_part_of_the_thing() -> None:
    rows = ["b" * 40, *["b" + "." * 38 + "b"] * 18, "b" * 40]
    room, thing, block, here = world_of(rows), shapely.box(18, 10, 20, 12), shapely.box(18, 6, 20, 8), (17, 10)
    knowledge = Knowledge()
    knowledge.wake(impression(around(thing, around(block, room)), here))
    lying = translate(thing, -here[0], -here[1])
    knowledge.tracker.grasp(HeldObject("o1", lying, lying))
    after = impression(around(translate(thing, -1), room), (here[0] - 1, here[1]))
    knowledge.perceive(Push(-1.0, 0.0), after)
    assert knowledge.memory.held_objects["o1"].polygon.area == thing.area
