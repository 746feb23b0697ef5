"""Which walls may be things that lead on, and from where they are felt."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.drawings import known_model
from tests.planner.situations import all_felt
from utak.kb.world.model import WorldModel
from utak.planner.screen.projection import CostMaps
from utak.planner.sights.walls import (
    ALL_WALLS,
    FeelingScope,
    WallKind,
    feeling_places,
    unfelt_walls,
    walls_in_question,
)

WALKING = FeelingScope(parting=False)
CLOSED = ["b" * 12, *["b" + "." * 10 + "b"] * 4, "b...U......b", *["b" + "." * 10 + "b"] * 4, "b" * 12]
TWO = ["b" * 20, *["b" + "." * 8 + "bb" + "." * 8 + "b"] * 8, "b..U" + "." * 5 + "bb" + "." * 8 + "b", "b" * 20]
NICHE = [*TWO[:3], *["b" + "." * 9 + "b" + "." * 8 + "b"] * 3, *TWO[6:]]
FAR_NICHE = [*TWO[:3], *["b" + "." * 8 + "b" + "." * 9 + "b"] * 3, *TWO[6:]]
PILLAR = [*CLOSED[:7], "b....bb....b", "b....bb....b", *CLOSED[9:]]


def kinds_of(rows: list[str], scope: FeelingScope = ALL_WALLS) -> tuple[WorldModel, dict[WallKind, np.ndarray]]:
    """Return the world model of a drawing, all of it seen, and the walls in question by kind."""
    model = known_model(rows, objects=False)
    return model, walls_in_question(model, CostMaps(model).floor, scope)


def columns_of(mask: np.ndarray, model: WorldModel) -> set[int]:
    """Return the columns of a drawing in which a mask has squares."""
    return set((np.nonzero(mask)[1] - _drawn_from(model)[1]).tolist())


def rows_of(mask: np.ndarray, model: WorldModel) -> set[int]:
    """Return the rows, from the south, of a drawing in which a mask has squares."""
    return set((np.nonzero(mask)[0] - _drawn_from(model)[0]).tolist())


def _drawn_from(model: WorldModel) -> tuple[int, int]:
    """Return the row and the column of the view where the drawing begins."""
    rows, columns = np.nonzero(model.view.seen)
    return int(rows.min()), int(columns.min())


def test_all_walls_of_a_closed_room_are_in_question() -> None:
    model, kinds = kinds_of(CLOSED, WALKING)
    assert sum(int(mask.sum()) for mask in kinds.values()) == int(unfelt_walls(model).sum()) == 38
    assert not any(mask.any() for mask in walls_in_question(all_felt(model), CostMaps(model).floor).values())


def test_a_thin_wall_before_floor_that_is_not_reached_is_likelier_than_others() -> None:
    model, kinds = kinds_of(TWO, WALKING)
    assert columns_of(kinds[WallKind.THIN], model) == {9}
    assert kinds[WallKind.THIN].sum() == 9
    assert not kinds[WallKind.NICHE].any() and not kinds[WallKind.RIM].any()


def test_the_back_of_a_niche_and_what_lies_before_one_on_the_far_side_are_told_apart() -> None:
    model, near = kinds_of(NICHE, WALKING)
    assert columns_of(near[WallKind.NICHE], model) == {10} and rows_of(near[WallKind.NICHE], model) == {5, 6, 7}
    model, far = kinds_of(FAR_NICHE, WALKING)
    assert columns_of(far[WallKind.RIM], model) == {9} and rows_of(far[WallKind.RIM], model) >= {5, 6, 7}


def test_a_pillar_leads_a_walking_robot_nowhere() -> None:
    model, walking = kinds_of(PILLAR, WALKING)
    _, all_kinds = kinds_of(PILLAR)
    assert not walking[WallKind.PARTING].any()
    assert columns_of(all_kinds[WallKind.PARTING], model) == {5, 6}


def test_only_walls_count_that_may_lead_to_the_place_that_is_wanted() -> None:
    ring = ["b" * 16, *["b" + "." * 14 + "b"] * 3, "b....bbbbb.....b", *["b....b...b.....b"] * 3, "b....bbbbb.....b"]
    rows = [*ring, *["b" + "." * 14 + "b"] * 2, "b.U" + "." * 12 + "b", "b" * 16]
    model = known_model(rows, objects=False)
    reached = CostMaps(model).floor
    inside = model.space & ~reached
    kinds = walls_in_question(model, reached, FeelingScope(parting=False, wanted=inside))
    found = np.any(list(kinds.values()), axis=0)
    assert found.any() and columns_of(found, model) <= set(range(5, 10))


@given(st.sets(st.tuples(st.integers(0, 37), st.booleans()), max_size=38))
@settings(max_examples=30, deadline=None)
def test_a_halt_tells_the_squares_around_it_and_nothing_that_was_felt(felt: set[tuple[int, bool]]) -> None:
    model = known_model(CLOSED, objects=False)
    walls = np.argwhere(unfelt_walls(model)).tolist()
    known = {(walls[n][1] + model.view.west, walls[n][0] + model.view.south): "b" for n, _ in felt}
    model = replace(model, felt=known)
    left = {(row, column) for row, column in np.argwhere(unfelt_walls(model)).tolist()}
    places = feeling_places(CostMaps(model))
    width = model.labels.shape[1]
    for place in places:
        row, column = divmod(place.square, width)
        about = {(row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)}
        assert sum(place.squares.values()) == len(about & left)
    told = {divmod(p.square, width) for p in places}
    near = {(r + i, c + j) for r, c in left for i in (-1, 0, 1) for j in (-1, 0, 1)}
    floor = {
        (row, column) for row, column in np.argwhere(CostMaps(model).floor & ~CostMaps(model).looked_from).tolist()
    }
    assert told == near & floor


def test_a_halt_beside_a_straight_wall_tells_of_five_stretches_as_wide_as_a_doorway() -> None:
    model = known_model(CLOSED, objects=False)
    told = {(sum(p.squares.values()), sum(p.doorways.values())) for p in feeling_places(CostMaps(model))}
    assert told == {(4, 4), (3, 3), (3, 4), (3, 5)}  # in a corner, one and two squares beside one, and elsewhere
