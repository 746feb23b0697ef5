"""What others do between two looks: a thing is moved, taken or brought, or the robot is lifted; eyes.py makes looks."""

import math

from tests.kb.eyes import Occupied, impression, world_of
from utak.kb.body import Grasp, Move, Push
from utak.kb.knowledge import Knowledge
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN

ROOM = ["b" * 44, *["b" + "." * 42 + "b"] * 29, "b" * 44]
THING = [(x, y) for x in range(20, 23) for y in range(14, 17)]
HERE = (16, 12)
SMALL = ["b" * 30, *["b" + "." * 28 + "b"] * 23, "b" * 30]  # all of its walls are in sight


def with_things(*squares: tuple[int, int], room: list[str] = ROOM) -> Occupied:
    empty, there = world_of(room), set(squares)
    return lambda i, j: (i, j) in there or empty(i, j)


def settled(squares: list[tuple[int, int]], shift: tuple[int, int] = (0, 0)) -> list[tuple[int, int]]:
    """Return squares of the table as squares of the map."""
    return [(x - HERE[0] + shift[0], y - HERE[1] + shift[1]) for x, y in squares]


def looked() -> Knowledge:
    """Return what a robot knows that saw the thing from two places, and stands at `HERE`."""
    mind = Knowledge()
    mind.wake(impression(with_things(*THING), HERE))
    mind.perceive(Move(2.0, 1.0), impression(with_things(*THING), (HERE[0] + 2, HERE[1] + 1)))
    mind.perceive(Move(-2.0, -1.0), impression(with_things(*THING), HERE))
    return mind


def states(mind: Knowledge, squares: list[tuple[int, int]]) -> set[int]:
    occupancy = mind.memory.occupancy
    return {int(occupancy.state[occupancy.index(*square)]) for square in squares}


def test_a_thing_that_was_moved_is_noticed_at_once_and_keeps_its_name() -> None:
    mind = looked()
    (name,) = (node.name for node in mind.objects)
    moved = [(x - 9, y - 5) for x, y in THING]
    _, accommodated = mind.perceive(Move(1.0, 0.0), impression(with_things(*moved), (HERE[0] + 1, HERE[1])))
    explanation = accommodated.explanation
    assert explanation.how == "changed" and explanation.change is not None and explanation.change.gone == (name,)
    assert states(mind, settled(THING)) <= {FREE, OPEN} and OCCUPIED in states(mind, settled(moved))
    (node,) = mind.objects
    assert node.name == name and node.patch.squares() >= set(settled(moved))
    assert mind.memory.place == (1.5, 0.5) and not mind.memory.shaken
    _, accommodated = mind.perceive(Move(-1.0, 0.0), impression(with_things(*moved), HERE))
    assert accommodated.explanation.how == "predicted"


def test_a_thing_that_was_taken_is_missing_until_it_is_seen_again() -> None:
    mind = looked()
    model, accommodated = mind.perceive(Move(1.0, 0.0), impression(with_things(), (HERE[0] + 1, HERE[1])))
    assert accommodated.explanation.how == "changed" and model.objects == ()
    assert model.missing == ("o1",)
    model, _ = mind.perceive(Move(-1.0, 0.0), impression(with_things(*THING), HERE))
    assert [node.name for node in model.objects] == ["o1"] and model.missing == ()


def test_a_thing_that_was_brought_is_a_new_one() -> None:
    mind = looked()
    new = [(x, y) for x in (10, 11, 12) for y in (10, 11)]
    model, accommodated = mind.perceive(Move(1.0, 0.0), impression(with_things(*THING, *new), (HERE[0] + 1, HERE[1])))
    assert accommodated.explanation.how == "changed"
    assert sorted(node.name for node in model.objects) == ["o1", "o2"]


def test_walls_do_not_leave_so_the_robot_was_lifted_and_recognises_the_place() -> None:
    mind = looked()
    there = (27, 7)
    model, accommodated = mind.perceive(Move(1.0, 0.0), impression(with_things(*THING), there))
    assert accommodated.explanation.how == "lifted"
    assert mind.memory.square == (there[0] - HERE[0], there[1] - HERE[1])
    assert [node.name for node in model.objects] == ["o1"]
    assert not model.anew and mind.memory.in_hand is None


def test_a_robot_put_where_it_never_looked_begins_a_map_and_keeps_the_old_one() -> None:
    long = ["b" * 130, *["b" + "." * 128 + "b"] * 28, "b" * 130]
    empty = world_of(long)
    mind = Knowledge()
    mind.wake(impression(empty, HERE))
    mind.perceive(Move(2.0, 1.0), impression(empty, (HERE[0] + 2, HERE[1] + 1)))
    model, accommodated = mind.perceive(Move(1.0, 0.0), impression(empty, (80, 6)))
    assert accommodated.explanation.how == "lost" and model.anew
    x, y = 80, 6
    for _ in range(12):
        x -= 6
        model, accommodated = mind.perceive(Move(-6.0, 0.0), impression(empty, (x, y)))
        if accommodated.explanation.how == "lifted":
            break
    assert accommodated.explanation.how == "lifted" and not model.anew
    assert mind.memory.square == (x - HERE[0], y - HERE[1])


def carrying(*others: tuple[int, int]) -> Knowledge:
    """Return what a robot knows that has carried the thing three squares west in a small room."""
    mind, there = Knowledge(), [(x - 3, y) for x, y in THING]
    mind.wake(impression(with_things(*THING, *others, room=SMALL), HERE))
    mind.perceive(Move(3.0, 3.0), impression(with_things(*THING, *others, room=SMALL), beside(0)))
    mind.perceive(Grasp("east"), impression(with_things(*THING, *others, room=SMALL), beside(0)))
    mind.perceive(Push(-3.0, 0.0), impression(with_things(*there, *others, room=SMALL), beside(3)))
    assert mind.memory.in_hand is not None
    return mind


def beside(west: int) -> tuple[int, int]:
    return HERE[0] + 3 - west, HERE[1] + 3


def test_a_thing_that_is_taken_from_the_hand_is_missed_at_once_and_found_again() -> None:
    mind = carrying()
    moved = [(x - 9, y - 9) for x, y in THING]
    model, accommodated = mind.perceive(Push(-2.0, 0.0), impression(with_things(*moved, room=SMALL), beside(3)))
    explanation = accommodated.explanation
    assert explanation.how == "changed" and explanation.change is not None and explanation.change.gone == ("o1",)
    assert mind.memory.in_hand is None and model.held is None
    assert mind.memory.square == (0, 3) and not mind.memory.shaken
    assert [node.name for node in model.objects] == ["o1"]


def test_another_thing_is_taken_while_one_is_carried() -> None:
    mind = carrying(*((x, y) for x in (8, 9, 10) for y in (18, 19, 20)))
    held, there = mind.memory.in_hand, [(x - 5, y) for x, y in THING]
    model, accommodated = mind.perceive(Push(-2.0, 0.0), impression(with_things(*there, room=SMALL), beside(5)))
    assert accommodated.explanation.how == "changed"
    assert mind.memory.in_hand == held and [node.name for node in model.objects] == [held]
    assert mind.memory.square == (-2, 3)


def test_a_robot_that_is_lifted_off_what_it_carries_recognises_the_place_and_has_an_empty_hand() -> None:
    mind, there = carrying(), [(x - 3, y) for x, y in THING]
    place = (6, 6)
    model, accommodated = mind.perceive(Push(-2.0, 0.0), impression(with_things(*there, room=SMALL), place))
    assert accommodated.explanation.how == "lifted" and model.held is None
    assert mind.memory.square == (place[0] - HERE[0], place[1] - HERE[1])
    assert [node.name for node in model.objects] == ["o1"]


def test_looks_since_a_lift_are_made_in_the_squares_that_agree_together() -> None:
    """The robot is put off the middle of a square, so that a later look tells in which square the first was made."""
    mind = looked()
    x, y = 27.9, 7.5
    for step in ((1.0, 0.0), (0.25, 0.0), (0.25, 4.0)):
        x, y = (x, y) if step == (1.0, 0.0) else (x + step[0], y + step[1])
        mind.perceive(Move(*step), impression(with_things(*THING), (int(x), int(y))))
    away = mind.memory.place[0] + HERE[0] - x, mind.memory.place[1] + HERE[1] - y
    west, south, east, north = mind.memory.place_error
    assert -east <= away[0] <= -west and -north <= away[1] <= -south
    squares = [(math.floor(i) + HERE[0], math.floor(j) + HERE[1]) for i, j in mind.memory.track[-3:]]
    assert squares == [(27, 7), (28, 7), (28, 11)]
    assert not mind.memory.shaken
