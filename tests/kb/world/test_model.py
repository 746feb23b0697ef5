"""Names that last, patches, and what is measured and believed of known objects."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests.kb.drawings import known_model, walked
from tests.kb.eyes import impression, utak_in, world_of
from utak.kb.body import Grasp, Move, Release
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, MapView
from utak.kb.mapping.patch import Patch, patch_of, patch_of_polygon
from utak.kb.objects.held_object import HeldObject
from utak.kb.objects.shape_fit import measure_seen
from utak.kb.perception.frame import Frame
from utak.kb.world.corners import corners
from utak.kb.world.facts import Places, model_facts
from utak.kb.world.model import MAX_FREE_PROBABILITY, count_open_squares
from utak.kb.world.object_names import ObjectNames
from utak.kb.world.objects import lay_upon
from utak.kb.world.rooms import rooms_of


def box(x: int, y: int, wide: int, high: int) -> Patch:
    return Patch(x, y, np.ones((high, wide), bool))


def test_an_object_that_is_seen_better_keeps_its_name() -> None:
    names = ObjectNames()
    first = names.assign([box(0, 0, 2, 2), box(10, 0, 3, 3)])
    assert names.assign([box(9, 0, 4, 4), box(0, 0, 3, 2)]) == first[::-1]


def test_a_patch_left_where_a_held_object_lay_is_another_object() -> None:
    names = ObjectNames()
    (held,) = names.assign([box(0, 0, 3, 3)])
    (left,) = names.assign([box(0, 2, 3, 1)], {held})
    assert left != held
    assert names.assign([box(0, 2, 3, 1)], {held}) == [left]


def test_when_a_patch_splits_the_larger_part_keeps_the_name() -> None:
    names = ObjectNames()
    (old,) = names.assign([box(0, 0, 10, 1)])
    small, large = names.assign([box(0, 0, 2, 1), box(4, 0, 6, 1)])
    assert large == old
    assert small != old


def test_a_patch_that_is_gone_is_forgotten_and_its_name_is_not_used_again() -> None:
    names = ObjectNames()
    (old,) = names.assign([box(0, 0, 2, 2)])
    assert names.assign([]) == []
    assert names.assign([box(0, 0, 2, 2)]) != [old]


patches = st.lists(
    st.builds(box, st.integers(0, 9), st.integers(0, 9), st.integers(1, 4), st.integers(1, 4)), max_size=5
)


@given(st.lists(patches, max_size=4))
def test_names_differ(steps: list[list[Patch]]) -> None:
    names = ObjectNames()
    for step in steps:
        given_names = names.assign(step)
        assert len(set(given_names)) == len(step)


@given(st.integers(1, 7), st.integers(1, 7), st.integers(0, 2**32 - 1), st.integers(-9, 9), st.integers(-9, 9))
def test_a_patch_is_the_squares_of_its_mask(rows: int, columns: int, seed: int, west: int, south: int) -> None:
    rng = np.random.default_rng(seed)
    mask = rng.random((rows, columns)) < 0.4
    mask[rng.integers(rows), rng.integers(columns)] = True
    blank = np.zeros(mask.shape)
    view = MapView(west, south, blank.astype(np.float32), blank.astype(np.int8), mask, blank.astype(np.int16))
    patch = patch_of(mask, view)
    want = {(c + west, r + south) for r, c in np.argwhere(mask).tolist()}
    assert patch.squares() == want
    assert patch.centre == pytest.approx(np.mean(sorted(want), axis=0) + 0.5)
    assert patch.mask.any(0).all() or not patch.mask.any(0)[1:-1].all()


def test_open_squares_are_counted_around_an_object_too() -> None:
    state = np.array([[0, -1, 0, 0], [-1, 1, 1, 0], [0, -1, 0, -1]], np.int8)
    thing = state == OCCUPIED
    likely = np.where(state == OPEN, 0.1, thing).astype(np.float32)
    likely[1, 0] = 0.5
    view = MapView(0, 0, likely, state, thing, np.zeros(state.shape, np.int16))
    assert count_open_squares(thing, view) == (3, 1)  # the corner to the southeast touches it at a corner only
    likely[0, 1], likely[2, 1] = 0.01, 0.99  # all completions show the same
    assert count_open_squares(thing, view) == (1, 1)


SHAPES = {
    "square": ["ggg", "ggg", "ggg"],
    "brick": ["ggggg", "ggggg"],
    "l_shape": ["gg...", "gg...", "ggggg", "ggggg"],
    "t_shape": ["gggggg", "gggggg", "..gg..", "..gg.."],
    "u_shape": ["gg..gg", "gg..gg", "gggggg", "gggggg"],
}


@pytest.mark.parametrize("shape", sorted(SHAPES))
def test_known_objects_are_measured_right(shape: str) -> None:
    full = np.array([list(row) for row in reversed(SHAPES[shape])]) == "g"
    framed = np.pad(full, 2)
    state = np.where(framed, OCCUPIED, FREE).astype(np.int8)
    view = MapView(-7, 4, framed.astype(np.float32), state, np.ones_like(framed), np.zeros(state.shape, np.int16))
    measured = measure_seen(patch_of(framed, view), view)
    assert measured.fits[0] == (shape, 0)
    assert measured.open == 0
    assert measured.polygon.area == pytest.approx(full.sum())
    assert measured.polygon.bounds == pytest.approx((-5, 6, -5 + full.shape[1], 6 + full.shape[0]))


def test_a_patch_that_is_hardly_settled_is_not_measured() -> None:
    state = np.full((4, 4), OPEN, np.int8)
    state[1, 1] = OCCUPIED
    thing = np.ones((4, 4), bool)
    view = MapView(0, 0, np.full((4, 4), 0.5, np.float32), state, thing, np.zeros((4, 4), np.int16))
    measured = measure_seen(patch_of(thing, view), view)
    assert (measured.fits, measured.polygon, measured.open) == ((), None, 15)


ROOM = [
    "b" * 26,
    *["b" + "." * 24 + "b"] * 12,
    *["b" + "." * 6 + "ggg" + "." * 15 + "b"] * 3,
    "b" + "." * 9 + "U" + "." * 14 + "b",
    *["b" + "." * 24 + "b"] * 6,
    "b" * 26,
]


def test_a_square_seen_from_one_side_is_believed() -> None:
    model = walked(ROOM, [(0, 2), (0, 2), (-2, 0), (3, 0)], colour="g").model
    thing = model.objects[0]
    assert thing.confidence >= 95  # it is taken without being felt first (utak.planner.goals.placement)
    assert thing.open == 0
    assert thing.patch.squares() == {(x, y) for x in (-3, -2, -1) for y in (1, 2, 3)}
    assert max(thing.shape, key=lambda s: (s != "polygon", s != "rectangle", thing.shape[s])) == "square"
    assert thing.polygon.area == pytest.approx(9)
    assert model.floor.sum() > 200
    assert not (model.floor & model.verge).any()


def test_an_object_that_reaches_into_the_robots_square_leaves_it_open() -> None:
    walk = walked(ROOM, [(0, 2), (0, 2), (-2, 0), (3, 0), (0, -4), (-3, 0)], colour="g")
    x, y = utak_in(ROOM)
    seen = impression(world_of(ROOM), (x - 2, y), colour="g")
    here = walk.model.view.locate(*walk.model.place)
    assert walk.model.view.state[here] == FREE
    taken, _ = walk.knowledge.perceive(Grasp("north"), seen)
    assert taken.view.by_counts is not None
    assert (taken.view.by_counts[taken.mask(taken.objects[0].patch)] == 1).all()
    memory = walk.knowledge.memory
    load = memory.held_objects[memory.in_hand or ""]
    walk.knowledge.tracker.update_object(replace(load, polygon=load.polygon.union(shapely.box(-1.6, 0.9, -1.4, 1.0))))
    model, _ = walk.knowledge.perceive(Release(), seen)
    assert model.view.state[here] == OPEN
    assert model.floor[here]


def test_squares_within_the_tolerance_of_a_held_object_count_as_floor() -> None:
    empty = [row.replace("g", ".") for row in ROOM]
    model, _ = lay_upon(
        known_model(empty), HeldObject("o1", shapely.box(-3, 1.3, 0, 4.3), None, slack=0.2, proven=True)
    )

    def chances(squares: set[tuple[int, int]]) -> list[float]:
        return [float(model.view.probability[model.view.locate(x + 0.5, y + 0.5)]) for x, y in squares]

    inside = {(x, y) for x in (-3, -2, -1) for y in (1, 2, 3, 4)}
    may_be = {(x, y) for x in range(-4, 1) for y in range(1, 5)} - inside
    assert min(chances(inside)) == 1.0
    assert 0.0 < min(chances(may_be)) <= max(chances(may_be)) <= MAX_FREE_PROBABILITY
    assert not any(model.view.state[model.view.locate(x + 0.5, y + 0.5)] == FREE for x, y in may_be)


def test_walls_stay_walls_within_the_tolerance_of_a_held_object() -> None:
    beside_wall = [row.replace("g", ".") for row in ROOM]
    before = known_model(beside_wall)
    x = before.view.west + 1  # the westernmost column of floor
    model, patch = lay_upon(
        before, HeldObject("o1", shapely.box(x + 0.1, 1.3, x + 3.1, 4.3), None, slack=0.2, proven=True)
    )
    wall = model.view.locate(x - 0.5, 2.5)
    assert model.view.state[wall] == OCCUPIED
    assert model.view.probability[wall] == 1.0
    assert patch.squares() == {(column, row) for column in range(x, x + 4) for row in range(1, 5)}


@pytest.mark.long
def test_a_felt_object_is_in_hand_after_a_grasp_in_its_direction() -> None:
    def grasped(aside: int, felt: str | None, angle: int = 0, wall: bool = False) -> str | None:
        """Return what is held after a grasp to the north, if an object lies `aside` squares to the east of it."""
        walk = walked(ROOM, [(0, 2), (0, 2), (-2, 0), (3, 0), (0, -4), (-3, 0)], colour="g")
        (x, y), knowledge = utak_in(ROOM), walk.knowledge
        seen = replace(impression(world_of(ROOM), (x - 2, y), colour="g"), touch=(felt, *[None] * 7))
        knowledge.perceive(Move(0.0, 0.0), seen)
        memory = knowledge.memory
        knowledge.tracker.state = replace(memory, frame=Frame(angle, memory.frame.origin))
        thing, (i, j) = walk.model.objects[0], memory.square
        polygon = shapely.box(i + aside, j + 1, i + aside + 3, j + 4)
        knowledge.objects = (replace(thing, polygon=polygon, patch=patch_of_polygon(polygon), colour="g"),)
        for column in (i - 1, i, i + 1):
            memory.occupancy.state[memory.occupancy.index(column, j + 1)] = OCCUPIED if wall else OPEN
        knowledge._grasp("north")
        return knowledge.memory.in_hand

    name = walked(ROOM, [(0, 2), (0, 2), (-2, 0), (3, 0), (0, -4), (-3, 0)], colour="g").model.objects[0].name
    assert grasped(0, None) == name
    assert grasped(1, "g") == name
    assert grasped(1, "g", wall=True) is None
    assert grasped(1, None) is None
    assert grasped(1, "r") is None
    assert grasped(3, "g") is None
    assert Frame(-30).beside("north") is None
    assert grasped(0, "g", angle=-30) == name
    assert grasped(0, None, angle=-30) is None


def test_the_facts_of_a_known_room() -> None:
    rows = ["bbbbbbbb", "b......b", "b.ggg..b", "b.ggg..b", "b......b", "b...U..b", "bbbbbbbb"]
    model = known_model(rows)
    facts = set(model_facts(model, Places(rooms_of(model), corners(model))))
    assert {"node(org)", "kind(org,utak,100)", "child(org,floor)", "child(floor,o1)"} <= facts
    assert "offset(org,0,0)" in facts
    assert "offset(o1,-100,250)" in facts  # its middle lies one square west and two and a half north
    assert "rect(o1,-250,150,50,350)" in facts
    assert {"room(r1)", "corner(northeast,250,450)", "corner(southwest,-350,-50)"} <= facts
    assert not any(fact.startswith("door(") for fact in facts)
    assert len([fact for fact in facts if fact.startswith("segment(o1,")]) == 4


WIDE = ["b" * 26, *["b" + "." * 24 + "b"] * 9, "b....U" + "." * 19 + "b", *["b" + "." * 24 + "b"] * 9, "b" * 26]


@pytest.mark.parametrize("degrees", [0.0, 1.0, 4.0, 30.0])
def test_far_squares_are_not_certain_while_the_orientation_is_slightly_uncertain(degrees: float) -> None:
    known = known_model(WIDE)
    model = replace(known, spread=math.radians(degrees))
    settled = known.view.state != OPEN
    assert (known.certain == settled).all()
    rows, columns = np.indices(settled.shape)
    origin = known.frame.origin[0] - known.view.west, known.frame.origin[1] - known.view.south
    far = np.hypot(columns + 0.5 - origin[0], rows + 0.5 - origin[1])
    moved = 2 * far * math.sin(math.radians(degrees) / 2)  # by a rotation about the point where the robot woke
    if degrees > 5:  # an error so large would have shown
        assert (model.certain == settled).all()
    else:
        assert (model.certain == (settled & (moved <= 0.3))).mean() > 0.99
        assert (model.certain <= settled).all()
    facts = model_facts(model, Places(rooms_of(model), corners(model)))
    (sure,) = (fact for fact in facts if fact.startswith("kind(floor,floor,"))
    share = int(sure.split(",")[-1].rstrip(")"))
    assert (share == 100) == bool(model.certain[model.floor].all())
    assert not replace(known, view=known.view._replace(sure=False)).certain.any()


@pytest.mark.parametrize("place", [(0.5, 0.5), (-1.5, 0.5), (-2.5, -1.5)])
def test_a_place_believed_in_a_wall_stands_for_the_floor_next_to_it(place: tuple[float, float]) -> None:
    model = known_model(
        ["b" * 12, *["bbb" + "." * 8 + "b"] * 4, "bbbU" + "." * 7 + "b", *["bbb" + "." * 8 + "b"] * 2, "b" * 12]
    )
    shifted = replace(model, place=place)
    assert shifted.space[shifted.view.locate(*place)] == (place == (0.5, 0.5))
    assert (shifted.floor == model.floor).all()
    assert {side: corner.point for side, corner in corners(shifted).items()} == {
        side: corner.point for side, corner in corners(model).items()
    }
