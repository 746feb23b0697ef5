"""Cost maps, subgoals, frontiers, routes and moves on the screen."""

import itertools
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.kb.drawings import known_model, walked
from tests.kb.eyes import random_room
from tests.tables import few
from utak.kb.mapping.occupancy import FREE, OPEN
from utak.kb.world.model import WorldModel
from utak.kb.world.rooms import NO_ROOMS
from utak.planner.navigation.encircle import encircled_point, encircling_routes, winding_number
from utak.planner.navigation.subgoals import Chosen, NoSubgoal, Subgoal, choose
from utak.planner.navigation.walks import WalkChoice, WalkRules, choose_walk, find_walks, walks_along
from utak.planner.question import Question
from utak.planner.screen.moves import (
    CARRYING_PACE,
    LEEWAY_TOLERANCE,
    TIGHT_MOVE_LENGTH,
    WALKING_PACE,
    Pace,
    next_move,
    one_move_squares,
)
from utak.planner.screen.projection import (
    MAX_TRUSTED_PROBABILITY,
    MIN_DOUBTFUL_PROBABILITY,
    UNSEEN_LEVEL,
    CostMaps,
    dilate,
)
from utak.planner.screen.sweeps import line_sweep_is_free, swept_offsets
from utak.planner.sights import frontiers

WALKS = few(range(20), 4)  # seeds of random walks, each of which serves several tests


@cache
def random_walk(seed: int) -> WorldModel:
    """Return the world model after two or three observations in a random room."""
    rng = np.random.default_rng(seed)
    while True:
        rows = random_room(rng, *rng.integers(10, 34, 2), things=rng.integers(1, 7))
        free = [(i, n) for n, row in enumerate(rows) for i, mark in enumerate(row) if mark == "."]
        if free:
            break
    chosen = [free[k] for k in rng.integers(len(free), size=3)]
    (i, n), *rest = chosen
    rows[n] = rows[n][:i] + "U" + rows[n][i + 1 :]
    places = [(i, n), *rest]
    way = [(c - a, b - d) for (a, b), (c, d) in itertools.pairwise(places)]
    return walked(rows, way).model


@pytest.mark.long
@pytest.mark.parametrize("seed", WALKS)
def test_the_projection_is_monotone(seed: int) -> None:
    cost_maps = CostMaps(random_walk(seed))
    for level in range(UNSEEN_LEVEL):
        assert not (cost_maps.free(level) & ~cost_maps.free(level + 1)).any()
        before, after = cost_maps.distances[level], cost_maps.distances[level + 1]
        assert (after[before >= 0] >= 0).all()
        assert (after <= before)[before >= 0].all()
    assert not (cost_maps.floor & ~cost_maps.free(0)).any()
    assert cost_maps.floor[cost_maps.here[1], cost_maps.here[0]]


@pytest.mark.parametrize("seed", WALKS)
def test_safe_squares_are_settled_or_far_from_doubt(seed: int) -> None:
    model = random_walk(seed)
    safe, view = CostMaps(model).safe, model.view
    row, column = model.view.locate(*model.place)
    for r, c in np.argwhere(safe).tolist():
        if view.state[r, c] == FREE or (r, c) == (row, column):
            continue
        near = (slice(max(r - 1, 0), r + 2), slice(max(c - 1, 0), c + 2))
        assert view.seen[near].all()
        assert (view.probability[near][view.state[near] == OPEN] < 0.3).all()


@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 2**32 - 1), st.integers(0, 3))
def test_dilation_is_by_the_chebyshev_distance(rows: int, columns: int, seed: int, squares: int) -> None:
    mask = np.random.default_rng(seed).random((rows, columns)) < 0.15
    where = np.argwhere(mask)
    want = [
        [bool(len(where)) and int(np.abs(where - (r, c)).max(1).min()) <= squares for c in range(columns)]
        for r in range(rows)
    ]
    assert np.array_equal(dilate(mask, squares), np.array(want))


HALL = [
    "b" * 20,
    *["b" + "." * 18 + "b"] * 5,
    "b....U.....ggg.....b",
    *["b..........ggg.....b"] * 2,
    *["b" + "." * 18 + "b"] * 5,
    "b" * 20,
]


def flat(model: WorldModel, x: int, y: int) -> np.ndarray:
    """Return the flat index of a square (x, y) of the map frame."""
    row, column = model.view.locate(x + 0.5, y + 0.5)
    return np.array([row * model.labels.shape[1] + column])


@pytest.mark.parametrize("pace", [WALKING_PACE, CARRYING_PACE])
@pytest.mark.parametrize("kind", sorted(WALKING_PACE.longest_by_kind))
def test_a_move_sweeps_only_safe_squares(kind: str, pace: Pace) -> None:
    model = known_model(HALL)
    cost_maps = CostMaps(model)
    for goal in ((11, 0), (11, -2), (6, 5), (-4, 5), (0, 1)):
        for way in find_walks(cost_maps, 0, flat(model, *goal), "skeleton").routes:
            move = next_move(cost_maps, way.squares, way.level, kind, pace=pace)
            east, north = round(move.east), round(move.north)
            assert (east, north) == (move.east, move.north)
            assert max(abs(east), abs(north)) <= pace.longest_by_kind[kind]
            c, r = swept_offsets(east, north)
            assert cost_maps.safe[r + cost_maps.here[1], c + cost_maps.here[0]].all()


@pytest.mark.parametrize("seed", WALKS)
def test_longer_moves_than_a_step_are_safe_in_random_models(seed: int) -> None:
    model = random_walk(seed)
    cost_maps = CostMaps(model)
    squares = np.flatnonzero(cost_maps.floor)
    rng = np.random.default_rng(seed)
    for goal in rng.choice(squares, size=min(4, len(squares)), replace=False):
        for way in find_walks(cost_maps, 0, np.array([goal]), "skeleton").routes:
            if len(way.squares) < 2:
                continue
            move = next_move(cost_maps, way.squares, way.level, "attain")
            if max(abs(move.east), abs(move.north)) > 1:
                c, r = swept_offsets(round(move.east), round(move.north))
                assert cost_maps.safe[r + cost_maps.here[1], c + cost_maps.here[0]].all()


def test_routes_are_free_connected_and_distinct() -> None:
    model = known_model(HALL)
    cost_maps = CostMaps(model)
    found = find_walks(cost_maps, 0, flat(model, 12, -1), "skeleton").routes
    assert len(found) >= 2
    for way in found:
        assert way.squares[0] == cost_maps.here
        assert all(cost_maps.free(0)[y, x] for x, y in way.squares)
        assert all(abs(a - c) + abs(b - d) == 1 for (a, b), (c, d) in zip(way.squares, way.squares[1:], strict=False))
    assert found[0].length <= found[1].length
    chosen = choose_walk(walks_along(found), cost_maps, frozenset(), (), WalkRules(), Question())
    assert isinstance(chosen, WalkChoice) and chosen.route == found[0]
    before = frozenset(found[1].squares)
    sticky = choose_walk(walks_along(found[:2]), cost_maps, before, (), WalkRules(), Question())
    assert isinstance(sticky, WalkChoice)
    assert sticky.route == (found[1] if found[1].length - found[0].length < 2 else found[0])


def test_the_route_to_the_own_square_has_one_square() -> None:
    model = known_model(HALL)
    cost_maps = CostMaps(model)
    (way,) = find_walks(cost_maps, 0, flat(model, 0, 0), "skeleton").routes
    assert way.squares == (cost_maps.here,)
    assert way.length == 0


def test_the_surest_level_decides_what_is_nearest() -> None:
    rows = ["b" * 12, "b..........b", "b.U..?...?.b", "b..........b", "b" * 12]
    model = known_model(rows)
    cost_maps = CostMaps(model)
    reached = cost_maps.nearest(np.concatenate([flat(model, 3, 0), flat(model, 8, 0)]))
    assert reached is not None
    assert reached.level == 0  # the more distant one is floor, the nearer one is unseen
    assert reached.cost == pytest.approx(9.4)
    only = cost_maps.nearest(flat(model, 3, 0))
    assert only is not None
    assert only.level == UNSEEN_LEVEL
    assert cost_maps.nearest(flat(model, 9, 1)) is None


def test_the_choice_of_a_subgoal() -> None:
    model = known_model(HALL)
    cost_maps = CostMaps(model)
    near, far = Subgoal("explore", flat(model, 1, 0), "near"), Subgoal("explore", flat(model, 12, 0), "far")
    goal = Subgoal("attain", flat(model, 12, 3), "there")
    wall = Subgoal("attain", flat(model, 14, 0), "in the wall")
    for offered, expected in (
        ([near, far], near),
        ([near, far, goal], goal),
        ([wall, far], far),
        ([near._replace(price=30.0), far], far),
    ):
        chosen = choose(offered, cost_maps, frozenset(), Question(about=("g1: a goal",)), NO_ROOMS)
        assert isinstance(chosen, Chosen)
        assert chosen.subgoal is expected or chosen.subgoal == expected
    for offered in ([wall], []):
        assert choose(offered, cost_maps, frozenset(), Question(), NO_ROOMS) == NoSubgoal()


def test_frontiers_border_on_unseen_squares() -> None:
    rows = ["bbbbb?????", "b....?????", "b.U..?????", "b.........", "bbbbb....?"]
    model = known_model(rows)
    cost_maps = CostMaps(model)
    found = np.unique(np.concatenate([look.squares for look in frontiers.find_frontiers(cost_maps, 0)]))
    near = dilate(~model.view.seen, 1)
    assert np.array_equal(found, np.flatnonzero(cost_maps.floor & near))
    closed = CostMaps(known_model(HALL))
    assert frontiers.find_frontiers(closed, 0) == []
    assert frontiers.unsettled_boundaries(closed, 0) == []
    assert frontiers.unreached_rooms(closed) == []


def test_floor_seen_beyond_a_wall_is_an_unreached_room() -> None:
    rows = ["bbbbbbbbbbb", "b....b....b", "b.U..b....b", "b....b....b", "bbbbbbbbbbb"]
    cost_maps = CostMaps(known_model(rows))
    (room,) = frontiers.unreached_rooms(cost_maps)
    assert len(room.squares) == 12
    assert not cost_maps.floor.ravel()[room.squares].any()
    small = ["bbbbbbbbbbb", "b....b...bb", "b.U..b..bbb", "b....bbbbbb", "bbbbbbbbbbb"]
    assert frontiers.unreached_rooms(CostMaps(known_model(small))) == []


def test_no_viewpoint_is_used_twice() -> None:
    rows = ["bbbbb????", "b.U..????", "bbbbb????"]
    model = known_model(rows)
    (border,) = frontiers.find_frontiers(CostMaps(model), 0)
    looked = replace(model, looked_from=frozenset({(2, 0)}))
    assert frontiers.find_frontiers(CostMaps(looked), 0) == []
    beside = CostMaps(replace(model, looked_from=frozenset({(0, 0)})))
    assert len(frontiers.find_frontiers(beside, 0)[0].squares) == len(border.squares)
    assert frontiers.find_frontiers(beside, 2) == []


def test_encircling_routes_wind_once() -> None:
    model = known_model(HALL)
    (node,) = model.objects
    cost_maps = CostMaps(model)
    track = [model.place]
    offered = encircling_routes(cost_maps, track, node)
    assert len(offered) == 2
    sides = set()
    for turn, way in offered.items():
        assert way.squares[0] == way.squares[-1] == cost_maps.here
        assert all(cost_maps.free(0)[y, x] for x, y in way.squares)
        walked_track = [(x + 0.5 + model.view.west, y + 0.5 + model.view.south) for x, y in way.squares]
        assert winding_number(walked_track, node) == turn
        sides.add(turn)
    assert sides == {1, -1}


@pytest.mark.parametrize("aside", [-0.49, -1e-12, 0.0, 0.3])
def test_the_place_within_a_square_changes_no_encircling_route(aside: float) -> None:
    model = known_model(HALL)
    (node,) = model.objects
    x, y = encircled_point(node)
    moved = replace(model, place=(x + 6, y + aside))
    offered = encircling_routes(CostMaps(moved), [model.place, (x, y + 5), moved.place], node)
    centred = encircling_routes(CostMaps(moved), [model.place, (x, y + 5), (x + 6, y)], node)
    assert {turn: way.squares for turn, way in offered.items()} == {turn: way.squares for turn, way in centred.items()}


def test_after_half_a_turn_the_other_half_is_left() -> None:
    model = known_model(HALL)
    (node,) = model.objects
    x, y = encircled_point(node)
    over = [model.place, (x, y + 5), (x + 6, y + 0.5)]
    moved = replace(model, place=over[-1])
    offered = encircling_routes(CostMaps(moved), over, node)
    whole_turns = set()
    for turn, way in offered.items():
        rest = [(c + 0.5 + model.view.west, r + 0.5 + model.view.south) for c, r in way.squares]
        assert winding_number([*over, *rest[1:]], node) == turn
        whole_turns.add(turn)
    assert whole_turns == {1, -1}
    shortest = min(offered.values(), key=lambda way: way.length)
    assert min(r for _, r in shortest.squares) + model.view.south + 0.5 < y  # south of it, not back on the north side


def test_the_pivot_lies_within_the_object() -> None:
    model = known_model(["bbbbbbbb", "b......b", "b.gggg.b", "b.g..g.b", "b.g..g.b", "b.U....b", "bbbbbbbb"])
    (node,) = model.objects
    x, y = encircled_point(node)
    assert (int(np.floor(x)), int(np.floor(y))) in node.patch.squares()


@pytest.mark.parametrize("leeway", [(-0.5, -0.5, 0.5, 0.5), (-0.5, 0.0, 0.0, 0.5), (-0.05, -0.05, 0.05, 0.05)])
def test_moves_end_near_the_edge_of_a_square_while_the_origin_is_uncertain(leeway: tuple[float, ...]) -> None:
    model = replace(known_model(HALL), leeway=leeway)
    cost_maps = CostMaps(model)
    for goal in ((4, 3), (-3, -2), (5, -4)):
        way = find_walks(cost_maps, 0, flat(model, *goal), "skeleton").routes[0]
        move = next_move(cost_maps, way.squares, way.level, "explore")
        whole = next_move(cost_maps, way.squares, way.level, "attain")
        assert (whole.east, whole.north) == (round(whole.east), round(whole.north))
        west, south, east, north = leeway
        for gone, back, forth in ((move.east, west, east), (move.north, south, north)):
            aside = gone - round(gone)
            assert math.floor(gone + 0.5) == round(gone)  # still in the square of the subgoal
            assert -0.5 < aside < 0.5
            assert (
                aside == 0 or (aside > 0.4 and forth > LEEWAY_TOLERANCE) or (aside < -0.4 and -back > LEEWAY_TOLERANCE)
            )
        assert (round(move.east), round(move.north)) == (move.east, move.north) or max(leeway) > LEEWAY_TOLERANCE
    assert any(
        next_move(
            cost_maps, find_walks(cost_maps, 0, flat(model, *goal), "skeleton").routes[0].squares, 0, "explore"
        ).east
        % 1
        for goal in ((4, 3), (-3, -2), (5, -4))
    ) == (max(leeway) > LEEWAY_TOLERANCE)


def test_no_move_ends_near_a_grid_line_at_any_turn_while_the_orientation_is_uncertain() -> None:
    model = replace(known_model(HALL), likely_spread=math.pi)
    cost_maps = CostMaps(model)
    whole = 0
    for goal in np.flatnonzero(cost_maps.floor).tolist():
        for way in find_walks(cost_maps, 0, np.array([goal]), "skeleton").routes[:1]:
            if len(way.squares) < 2:
                continue
            move = next_move(cost_maps, way.squares, way.level, "explore")
            whole += (move.east, move.north) == (round(move.east), round(move.north))
            for degrees in range(360):
                c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
                x = model.place[0] + c * move.east - s * move.north
                y = model.place[1] + s * move.east + c * move.north
                assert 1e-4 < x % 1 < 1 - 1e-4
                assert 1e-4 < y % 1 < 1 - 1e-4
    assert whole > 0


@pytest.mark.long
@pytest.mark.parametrize("pace", [WALKING_PACE, CARRYING_PACE])
def test_longer_moves_keep_clearance_while_the_orientation_is_uncertain_unless_bold(pace: Pace) -> None:
    model = replace(known_model(HALL), likely_spread=math.pi)
    cost_maps = CostMaps(model)
    clear_of = ~dilate(~cost_maps.safe, 1)
    longest, near = 0.0, []
    for goal in np.flatnonzero(cost_maps.floor).tolist():
        for way in find_walks(cost_maps, 0, np.array([goal]), "skeleton").routes[:1]:
            if len(way.squares) < 2:
                continue
            move = next_move(cost_maps, way.squares, way.level, "explore", pace=pace)
            far = max(abs(move.east), abs(move.north))
            longest = max(longest, far)
            assert far < pace.longest_uncertain + 0.5
            column, row = cost_maps.here[0] + round(move.east), cost_maps.here[1] + round(move.north)
            near.append(far > TIGHT_MOVE_LENGTH + 0.5 and not clear_of[row, column])
    assert longest > TIGHT_MOVE_LENGTH + 0.5
    assert any(near) == pace.bold


@pytest.mark.parametrize("seed", WALKS)
def test_bold_moves_go_up_to_unsettled_squares_but_not_to_unseen_ones(seed: int) -> None:
    cost_maps = CostMaps(random_walk(seed))
    view = cost_maps.model.view
    more = cost_maps.believed & ~cost_maps.safe
    assert (cost_maps.believed & cost_maps.safe == cost_maps.safe).all()
    hardly = cost_maps.free(0) & (view.probability <= MAX_TRUSTED_PROBABILITY)
    assert (more == hardly & ~cost_maps.safe & ~dilate(~view.seen, 1)).all()
    beside_doubt = dilate(view.seen & (view.state == OPEN) & (view.probability >= MIN_DOUBTFUL_PROBABILITY), 1)
    assert not (more & ~beside_doubt).any()


@pytest.mark.parametrize("spread", [0.0, math.pi])
def test_only_the_carrying_pace_is_bold(spread: float) -> None:
    cost_maps = CostMaps(replace(random_walk(3), likely_spread=spread))
    for kind in WALKING_PACE.longest_by_kind:
        assert (
            CARRYING_PACE.passable(cost_maps, kind)
            == (cost_maps.approachable if kind == "inspect" else cost_maps.believed)
        ).all()
        assert (WALKING_PACE.passable(cost_maps, kind) == cost_maps.safe).all()
    assert (cost_maps.believed != cost_maps.safe).any()


@pytest.mark.parametrize("spread", [0.0, math.pi])
@pytest.mark.parametrize("kind", sorted(WALKING_PACE.longest_by_kind))
def test_one_move_reaches_exactly_the_possible_ends_of_the_next_move(kind: str, spread: float) -> None:
    cost_maps = CostMaps(replace(known_model(HALL), likely_spread=spread))
    reached = one_move_squares(cost_maps, kind)
    ended = np.zeros_like(reached)
    ended[cost_maps.here[1], cost_maps.here[0]] = True
    for row, column in np.argwhere(cost_maps.floor).tolist():
        if (column, row) != cost_maps.here:
            step = (
                (column, row)
                if max(abs(column - cost_maps.here[0]), abs(row - cost_maps.here[1])) <= 1
                else cost_maps.here
            )
            move = next_move(cost_maps, [cost_maps.here, step, (column, row)], 0, kind, CARRYING_PACE)
            ended[cost_maps.here[1] + round(move.north), cost_maps.here[0] + round(move.east)] = True
    assert (reached & cost_maps.believed == ended & cost_maps.believed).all()


def test_no_move_ends_near_an_edge_where_the_next_square_may_stop_it() -> None:
    model = replace(known_model(HALL), leeway=(-0.5, -0.5, 0.5, 0.5))
    cost_maps = CostMaps(model)
    for goal in np.flatnonzero(cost_maps.floor).tolist():
        for way in find_walks(cost_maps, 0, np.array([goal]), "skeleton").routes[:1]:
            if len(way.squares) > 1:
                move = next_move(cost_maps, way.squares, way.level, "explore")
                here = (cost_maps.here[0] + 0.5, cost_maps.here[1] + 0.5)
                assert line_sweep_is_free(cost_maps.safe, here, (here[0] + move.east, here[1] + move.north))


def test_a_robot_pressed_into_squares_that_walls_cover_in_part_reaches_the_floor_that_it_came_from() -> None:
    """The square in which it stands meets floor at a corner alone, as in a corner of walls off the grid."""
    rows = [*["b" * 14] * 3, *["bbb" + "." * 8 + "bbb"] * 6, "bbbU" + "." * 7 + "bbb", *["b" * 14] * 3]
    model = known_model(rows)
    for place in ((-0.1, -0.1), (-0.1, 0.5), (8.1, 7.1)):
        reached = CostMaps(replace(model, place=place)).floor
        assert reached[model.space].all()
    assert not CostMaps(replace(model, place=(-1.5, -1.5))).floor[model.space].any()  # too deep in the wall
