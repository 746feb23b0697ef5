"""Things that were felt and stand against walls are regions of their own, with the squares that belong to them."""

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.kb.drawings import known_model
from tests.kb.eyes import colours_of, impression, utak_in, world_of
from utak.kb.body import Grasp, Move, Push, Release
from utak.kb.knowledge import Knowledge
from utak.kb.world.objects import MapRegions, separate_felt_things

Mask = NDArray[np.bool_]
BETWEEN_WALLS = [
    "bbbbbbbbbbbbbb",
    "b............b",
    "bbbbbbcccbbbbb",
    "b.....ccc....b",
    "b.....ccc....b",
    "b.....ggg....b",
    "b.....ggg....b",
    "bbbbbbgggbbbbb",
    "b...U........b",
    "bbbbbbbbbbbbbb",
]
ALONG_A_WALL = [
    "bbbbbbbbbbbbbb",
    *["b........bb..b"] * 2,
    *["b.....cccbb..b"] * 14,
    "b........bb..b",
    "b....U...bb..b",
    "bbbbbbbbbbbbbb",
]
IN_A_DOORWAY = [
    "b" * 22,
    *["b" + "." * 20 + "b"] * 2,
    "bbbbbcccc" + "b" * 13,
    "b" + "." * 20 + "b",
    "b....U" + "." * 15 + "b",
    "b" * 22,
]
FLUSH = [
    "b" * 16,
    *["b" + "." * 14 + "b"] * 3,
    *["b....gggkkk....b"] * 3,
    *["b" + "." * 14 + "b"] * 3,
    "b..U" + "." * 11 + "b",
    "b" * 16,
]


def marks_of(rows: list[str]) -> NDArray[np.str_]:
    return np.array([list(row) for row in reversed(rows)])


def things_in(rows: list[str], felt: set[tuple[int, int]]) -> list[Mask]:
    """Return the masks of the things that part from walls when squares (row, column) of a known drawing were felt."""
    model, marks = known_model(rows, objects=False), marks_of(rows)
    colours = {(column + model.view.west, row + model.view.south): str(marks[row, column]) for row, column in felt}
    regions = separate_felt_things(MapRegions(model.percept, model.labels, model.kinds), model.view, colours)
    names = [name for name in regions.kinds.kind if name not in model.kinds.kind]
    return [regions.labels == int(name.removeprefix("part")) for name in names]


def among(masks: list[Mask], mask: Mask) -> bool:
    return any(np.array_equal(mask, other) for other in masks)


def test_two_things_that_touch_between_walls_are_parted_where_their_colours_change() -> None:
    marks = marks_of(BETWEEN_WALLS)
    found = things_in(BETWEEN_WALLS, {(4, 6), (5, 6), (3, 8), (6, 8)})
    between = marks.copy()
    between[[2, 7]] = "."  # what lies in the doorways cannot be seen to belong to them
    assert among(found, between == "c")
    assert among(found, between == "g")


@pytest.mark.parametrize("share", [14, 10, 9, 3])
def test_a_thing_along_a_wall_is_whole_once_most_of_its_length_was_felt(share: int) -> None:
    felt = {(3 + n, 6) for n in range(share)}
    assert among(things_in(ALONG_A_WALL, felt), marks_of(ALONG_A_WALL) == "c") == (share >= 10)


def test_of_a_thing_in_a_doorway_only_what_was_felt_is_taken_for_it() -> None:
    (found,) = things_in(IN_A_DOORWAY, {(3, 6), (3, 7)})
    assert sorted(map(tuple, np.argwhere(found).tolist())) == [(3, 6), (3, 7)]


@pytest.mark.long
def test_what_did_not_move_is_given_up_as_one_thing_when_two_colours_are_felt_on_it() -> None:
    occupied, (x, y), colour = world_of(FLUSH), utak_in(FLUSH), colours_of(FLUSH)
    knowledge = Knowledge()
    knowledge.wake(impression(occupied, (x, y), colour=colour))
    x, y = x + 2, y + 3  # below the western thing
    knowledge.perceive(Move(2, 3), impression(occupied, (x, y), colour=colour))
    seen = impression(occupied, (x, y), colour=colour)
    model, _ = knowledge.perceive(Grasp("north"), seen)
    (whole,) = model.objects
    assert model.held == whole.name
    assert whole.patch.mask.sum() == 18
    knowledge.perceive(Push(0, 2), seen)  # nothing moves
    model, _ = knowledge.perceive(Release(), seen)
    assert [node.name for node in model.objects] == [whole.name]
    model, _ = knowledge.perceive(Move(4, 0), impression(occupied, (x + 4, y), colour=colour))
    assert not knowledge.memory.held_objects
    assert sum(int(node.patch.mask.sum()) for node in model.objects) == 18
    assert model.unsettled_seams  # one column was not felt, and may belong to either
    model, _ = knowledge.perceive(Move(-2, 0), impression(occupied, (x + 2, y), colour=colour))
    assert not model.unsettled_seams
    assert {node.colour: int(node.patch.mask.sum()) for node in model.objects} == {"g": 9, "k": 9}
    assert not model.contradicted
