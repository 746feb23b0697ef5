"""The squares from which an object is inspected or taken."""

from dataclasses import replace

import numpy as np
import pytest

from tests.kb.drawings import drawing, known_model
from tests.planner.situations import situation_of
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.language.reader import facts_from_text
from utak.kb.mapping.occupancy import OCCUPIED, OPEN
from utak.kb.world.corners import Corner
from utak.planner.goals.corner_goal import approach_for_goals
from utak.planner.navigation.fewest_moves import FewestMoves
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.screen.moves import CARRYING_PACE, one_move_squares
from utak.planner.screen.projection import LEVEL_MAX_PROBABILITY, SURELY_OCCUPIED, CostMaps, dilate
from utak.planner.sights.frontiers import FOVEA_RANGE, MIDDLE_ZONE_RANGE
from utak.planner.sights.viewpoints import (
    MIN_APPROACH_PROBABILITY,
    TO_REACH,
    TO_TAKE,
    Approach,
    inspection_squares,
    sightings,
)

ROOM = [row[:4] + "U" + row[5:] if k == 38 else row for k, row in enumerate(drawing(30, 20, 4, 4))]


def distance_from(squares: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Return the Chebyshev distance of each square (flat indices) to the nearest square of a mask."""
    at = np.stack(np.divmod(squares, mask.shape[1]), axis=1)
    apart = np.abs(at[:, None] - np.argwhere(mask)[None]).max(2)
    return np.asarray(apart.min(1))


def room(looked_from: frozenset[tuple[int, int]] = frozenset()) -> tuple[CostMaps, np.ndarray]:
    """Return the cost maps of a room with one object, and its mask. looked_from : squares of the map frame."""
    model = replace(known_model(ROOM), looked_from=looked_from)
    return CostMaps(model), model.mask(model.objects[0].patch)


def test_an_unlikely_object_is_seen_from_a_distance_first() -> None:
    cost_maps, mask = room()
    away = distance_from(inspection_squares(cost_maps, mask, 0.2, TO_REACH), mask)
    assert away.max() == MIDDLE_ZONE_RANGE > FOVEA_RANGE
    assert distance_from(inspection_squares(cost_maps, mask, 0.2, TO_TAKE), mask).max() <= FOVEA_RANGE
    row, column = np.argwhere(mask).min(0)
    view = cost_maps.model.view
    cost_maps, mask = room(frozenset({(int(column) + view.west - MIDDLE_ZONE_RANGE, int(row) + view.south)}))
    away = distance_from(inspection_squares(cost_maps, mask, 0.2, TO_REACH), mask)
    assert away.max() == FOVEA_RANGE


@pytest.mark.parametrize("to", [TO_REACH, TO_TAKE])
def test_a_likely_object_is_approached(to: Approach) -> None:
    cost_maps, mask = room()
    squares = inspection_squares(cost_maps, mask, 0.8, to)
    assert (distance_from(squares, mask) == 1).all()
    assert with_edge_neighbours(mask).ravel()[squares].all()


def test_an_object_to_take_is_approached_where_it_surely_is() -> None:
    cost_maps, mask = room()
    column = int(np.argwhere(mask)[:, 1].min())
    rim = mask & (np.arange(mask.shape[1]) == column)[None]  # may be part of the object, and may be floor
    view = cost_maps.model.view
    doubtful = np.where(rim, 0.5, view.probability).astype(np.float32)
    cost_maps = CostMaps(replace(cost_maps.model, view=view._replace(probability=doubtful)))
    squares = inspection_squares(cost_maps, mask, 0.8, TO_TAKE)
    assert with_edge_neighbours(mask & ~rim).ravel()[squares].all()
    only = CostMaps(replace(cost_maps.model, view=view._replace(probability=np.where(mask, 0.5, doubtful))))
    assert with_edge_neighbours(mask).ravel()[inspection_squares(only, mask, 0.8, TO_TAKE)].all()


def looking(cost_maps: CostMaps, squares: np.ndarray, probability: float, state: int) -> CostMaps:
    """Return cost maps with another probability and state for some squares."""
    view = cost_maps.model.view
    chance = np.where(squares, probability, view.probability).astype(np.float32)
    states = np.where(squares, state, view.state).astype(view.state.dtype)
    return CostMaps(replace(cost_maps.model, view=view._replace(probability=chance, state=states)))


def sides(mask: np.ndarray) -> dict[str, np.ndarray]:
    """Return the squares at each side of the bounding box of a mask."""
    (south, west), (north, east) = np.argwhere(mask).min(0), np.argwhere(mask).max(0)
    rows, columns = np.indices(mask.shape)
    across, up = (columns >= west) & (columns <= east), (rows >= south) & (rows <= north)
    return {
        "west": up & (columns == west - 1),
        "east": up & (columns == east + 1),
        "south": across & (rows == south - 1),
        "north": across & (rows == north + 1),
    }


@pytest.mark.parametrize(
    ("corner", "wanted"),
    [
        ((1, 1), {"west", "south"}),
        ((-1, 1), {"east", "south"}),
        ((1, -1), {"west", "north"}),
        ((-1, -1), {"east", "north"}),
    ],
)
def test_the_robot_does_not_stand_between_an_object_and_its_corner(corner: tuple[int, int], wanted: set[str]) -> None:
    cost_maps, mask = room()
    squares = inspection_squares(cost_maps, mask, 1.0, TO_TAKE._replace(corner=corner))
    by_side = sides(mask)
    assert len(squares)
    assert np.logical_or.reduce([by_side[name] for name in wanted]).ravel()[squares].all()


def test_the_robot_stands_in_the_way_where_no_other_side_is_floor() -> None:
    cost_maps, mask = room()
    by_side = sides(mask)
    cost_maps = looking(cost_maps, by_side["west"] | by_side["south"], 1.0, OCCUPIED)
    squares = inspection_squares(cost_maps, mask, 1.0, TO_TAKE._replace(corner=(1, 1)))
    assert len(squares)
    assert (by_side["east"] | by_side["north"]).ravel()[squares].all()


def test_a_side_that_one_straight_move_reaches_is_preferred() -> None:
    cost_maps, mask = room()
    met = one_move_squares(cost_maps, "inspect").ravel()
    at_sides = np.flatnonzero(with_edge_neighbours(mask) & cost_maps.floor)
    assert met[at_sides].any()
    assert not met[at_sides].all()
    assert met[inspection_squares(cost_maps, mask, MIN_APPROACH_PROBABILITY, TO_TAKE)].all()
    all_round = inspection_squares(cost_maps, mask, MIN_APPROACH_PROBABILITY, TO_REACH)
    assert sorted(all_round.tolist()) == at_sides.tolist()


def test_an_approach_crosses_squares_beside_an_object_that_may_be_floor() -> None:
    cost_maps, mask = room()
    ring = dilate(mask, 1) & ~mask
    cost_maps = looking(cost_maps, ring, LEVEL_MAX_PROBABILITY[1], OPEN)
    assert not cost_maps.believed[ring].any()
    assert (CARRYING_PACE.passable(cost_maps, "inspect") == cost_maps.approachable).all()
    assert (cost_maps.approachable & ~cost_maps.believed == with_edge_neighbours(mask) & ring).all()
    squares = inspection_squares(cost_maps, mask, 1.0, TO_TAKE)
    assert with_edge_neighbours(mask).ravel()[squares].all()
    fewest, subgoal = FewestMoves(cost_maps), Subgoal("inspect", squares, "a thing")
    way, dear = fewest.way(subgoal), fewest.priced([subgoal])[0]
    assert way is not None
    assert (np.flatnonzero(ring) == way.squares[-1][1] * mask.shape[1] + way.squares[-1][0]).any()
    assert len(dear.squares)
    assert not fewest.way(subgoal._replace(kind="explore"))
    assert dear.price < fewest.priced([subgoal._replace(kind="explore")])[0].price
    assert not looking(cost_maps, ring, LEVEL_MAX_PROBABILITY[2], OPEN).approachable[ring].any()


def test_no_such_approach_leads_beside_the_verge() -> None:
    cost_maps, _ = room()
    verge = cost_maps.model.verge & (cost_maps.model.view.probability >= SURELY_OCCUPIED)
    assert (with_edge_neighbours(verge) & cost_maps.believed).any()
    beside = with_edge_neighbours(verge) & ~verge
    cost_maps = looking(cost_maps, beside, LEVEL_MAX_PROBABILITY[1], OPEN)
    assert not cost_maps.approachable[beside].any()


def test_the_distance_of_an_unreachable_square_is_straight() -> None:
    cost_maps, mask = room()
    inside = np.flatnonzero(mask)[:1]
    row, column = divmod(int(inside[0]), mask.shape[1])
    assert cost_maps.far(inside) == pytest.approx(np.hypot(column - cost_maps.here[0], row - cost_maps.here[1]))
    some = np.flatnonzero(cost_maps.floor)
    assert (cost_maps.far(some) == cost_maps.distances[0].ravel()[some] / 5).all()


def test_an_object_for_a_corner_is_approached_from_the_side_away_from_its_walls() -> None:
    cost_maps, _ = room()
    corners = {"northeast": Corner((9.0, 5.0), (8, 5)), "southwest": Corner((2.0, 3.0), (2, 3))}
    goals = {name: facts_from_text(f"at(x, corner({name})).")[0] for name in (*corners, "southeast")}
    situation = situation_of(cost_maps.model, {})
    situation = replace(situation, corners=corners)
    assert approach_for_goals([goals["northeast"]], situation) == TO_TAKE._replace(corner=(1, -1))
    assert approach_for_goals([goals["southwest"]], situation) == TO_TAKE._replace(corner=(-1, -1))
    assert approach_for_goals([goals["southeast"]], situation) == TO_TAKE
    assert approach_for_goals([facts_from_text("in(x, room(next)).")[0], goals["northeast"]], situation).corner == (
        1,
        -1,
    )
    assert approach_for_goals([facts_from_text("beside(x, y).")[0]], situation) == TO_TAKE


def test_what_all_completions_show_is_still_no_more_than_likely() -> None:
    model = known_model(ROOM)
    model = replace(model, view=model.view._replace(state=np.full_like(model.view.state, OPEN)))
    likely = model.mask(model.objects[0].patch).astype(np.float64)
    found = sightings(CostMaps(model), likely, "it may be there", TO_TAKE)
    assert [look.chance for _, look in found] == [99]
