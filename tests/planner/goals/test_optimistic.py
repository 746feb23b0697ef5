"""Optimistic planning: the floor that is assumed, and plans over it."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.drawings import known_model, unclear
from tests.planner.situations import situation_of
from utak.geometry.manipulation.goals import End
from utak.geometry.manipulation.plan_carrying import Inside
from utak.kb.world.model import Node, WorldModel
from utak.planner.carrying.manipulation_oracle import ManipulationOracle, ManipulationPlan, Request
from utak.planner.goals.optimistic import UNSEEN_MARGIN, optimistic_floor, spread_into_unseen
from utak.planner.screen.projection import UNSEEN_LEVEL, indices_to_mask
from utak.planner.situation import Situation

HALF_SEEN = [  # the room goes on beyond its seen part
    "b" * 22 + "??",
    *["b" + "." * 21 + "??"] * 4,
    "b...gggg" + "." * 14 + "??",
    "b...gggg.........U....??",
    *["b" + "." * 21 + "??"] * 4,
    "b" * 22 + "??",
]

WALLED = [  # the near region lies behind a wall that the object must be pushed around
    "b" * 22 + "??",
    *["b" + "." * 9 + "b" + "." * 11 + "??"] * 4,
    "b...gggg" + "." * 14 + "??",
    "b...gggg.........U....??",
    *["b" + "." * 21 + "??"] * 4,
    "b" * 22 + "??",
]

JAGGED = [  # the seen part of the next room leaves no place for the object right behind the door
    "b" * 34,
    *["b" + "." * 12 + "bb" + "." * 18 + "b"] * 4,
    *["b..gggg" + "." * 6 + "bb" + "." * 18 + "b"] * 2,
    "b..gggg.......U" + "." * 18 + "b",
    *["b" + "." * 32 + "b"] * 4,
    *["b" + "." * 12 + "bb" + "." * 18 + "b"] * 3,
    "b" * 34,
]


@pytest.mark.long
@settings(deadline=None)
@given(st.integers(1, 10), st.integers(1, 23))
def test_only_unseen_squares_within_the_margin_are_assumed(row: int, column: int) -> None:
    situation = situation_of(known_model(HALF_SEEN))
    shape = situation.model.view.seen.shape
    mask = indices_to_mask(np.array([row * shape[1] + column]), shape)
    wider = spread_into_unseen(mask, situation)
    assert wider.shape == tuple(size + 2 * UNSEEN_MARGIN for size in mask.shape)
    inside = wider[UNSEEN_MARGIN:-UNSEEN_MARGIN, UNSEEN_MARGIN:-UNSEEN_MARGIN]
    assert not (inside & situation.model.view.seen & ~mask).any()
    rows, columns = np.nonzero(wider)
    assert (abs(rows - UNSEEN_MARGIN - row) + abs(columns - UNSEEN_MARGIN - column)).max() <= UNSEEN_MARGIN
    assert len(rows) > 1 if column >= 21 else len(rows) == 1


def test_floor_is_assumed_beyond_its_open_edge_but_not_through_walls() -> None:
    situation = situation_of(known_model(HALF_SEEN))
    free = optimistic_floor(situation)
    seen = np.pad(situation.cost_maps.free(0), UNSEEN_MARGIN)
    beyond = free & ~seen
    assert beyond[UNSEEN_MARGIN + 5, UNSEEN_MARGIN + 22 : UNSEEN_MARGIN + 22 + UNSEEN_MARGIN].all()
    assert not beyond[UNSEEN_MARGIN + 5, UNSEEN_MARGIN + 22 + UNSEEN_MARGIN :].any()
    assert not beyond[UNSEEN_MARGIN:-UNSEEN_MARGIN, UNSEEN_MARGIN : UNSEEN_MARGIN + 22].any()


def thing(model: WorldModel) -> Node:
    """Return the only object, with its outline."""
    (node,) = model.objects
    x0, y0 = node.patch.west, node.patch.south
    rows, columns = node.patch.mask.shape
    return replace(node, polygon=shapely.box(x0, y0, x0 + columns, y0 + rows))


def found(
    model: WorldModel, ends: dict[str, End], hoped: dict[str, End] | None = None, open_: bool = False
) -> tuple[ManipulationPlan, Situation]:
    """Return the chosen plan. open_ : whether the orientation is uncertain."""
    model = replace(model, likely_spread=0.3) if open_ else model
    situation = situation_of(model)
    answer = ManipulationOracle().find(Request(thing(model), ends), situation, hoped=lambda: hoped or {})
    assert isinstance(answer, ManipulationPlan)
    return answer, situation


def beside_the_jamb(chance: float) -> WorldModel:
    """Return JAGGED with two unsettled squares beside the jamb, on the straight way. chance : of being occupied."""
    return unclear(known_model(JAGGED), slice(8, 9), slice(13, 15), chance)


THROUGH = {"r2": Inside(shapely.box(15, 1, 33, 15))}


def test_an_optimistic_push_is_taken_where_it_saves_a_command() -> None:
    model = beside_the_jamb(0.2)
    haul, situation = found(model, THROUGH)
    assert haul.hopes and haul.level == UNSEEN_LEVEL
    assert len(haul.plan.legs[0].motions) == 1
    assert (haul.swept & ~situation.cost_maps.free(0) & ~situation.model.mask(thing(model).patch)).any()
    sure, _ = found(beside_the_jamb(0.6), THROUGH)
    assert not sure.hopes and sure.plan.commands > haul.plan.commands


def test_a_sure_plan_is_kept_where_an_optimistic_one_saves_nothing() -> None:
    haul, _ = found(known_model(JAGGED), THROUGH)
    assert not haul.hopes and haul.level == 0


@pytest.mark.parametrize("open_", [False, True])
def test_plans_end_in_seen_squares_while_the_orientation_is_uncertain(open_: bool) -> None:
    near, far = Inside(shapely.box(11, 7, 22, 11)), Inside(shapely.box(11, 1, 27, 11))
    haul, _ = found(known_model(WALLED), {"r": near}, {"r": far}, open_)
    assert haul.hopes != open_
    if open_:
        assert near.polygon.buffer(1e-6).covers(haul.plan.polygon)
