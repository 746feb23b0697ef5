"""A robot that carries objects walks by the fewest straight moves."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.kb.drawings import known_model
from tests.planner.situations import situation_of
from utak.kb.language.diagnostics import SourceSpan
from utak.kb.language.terms import Symbol
from utak.kb.task.task import Task
from utak.kb.world.rooms import rooms_of
from utak.planner.agenda.decider import Decider
from utak.planner.navigation.fewest_moves import ASSUMED_MOVES, MOVE_COST, SQUARE_COST, FewestMoves
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.screen.moves import one_move_squares
from utak.planner.screen.projection import CostMaps
from utak.planner.screen.sweeps import sweep_is_free
from utak.planner.screen.unseen_gain import GAIN_REACH
from utak.planner.sights.frontiers import best_views

WALLS = [
    "b" * 40,
    *["b" + "." * 38 + "b"] * 5,
    "b.........bbbbbbbbbbbbbbbbbbbbbbbbbbbbbb",
    "b.........bbbbbbbbbbbbbbbbbbbbbbbbbbbbbb",
    *["b" + "." * 38 + "b"] * 4,
    "bbbbbbbbbbbbbbbbbbbbbbbbbbbbbb.........b",
    "bbbbbbbbbbbbbbbbbbbbbbbbbbbbbb.........b",
    *["b" + "." * 38 + "b"] * 2,
    "b..U" + "." * 35 + "b",
    *["b" + "." * 38 + "b"] * 2,
    "b" * 40,
]


def flat(column: int, line: int) -> int:
    """Return the flat index of a square of the drawing; lines are counted from the north."""
    return (len(WALLS) - 1 - line) * len(WALLS[0]) + column


def subgoal(*squares: tuple[int, int]) -> Subgoal:
    """Return a subgoal at squares (column, line) of the drawing."""
    return Subgoal("explore", np.array([flat(*square) for square in squares]), "there", 50)


def symbol(name: str, *args: Symbol) -> Symbol:
    return Symbol(name, args, SourceSpan(0, 0, 0))


@pytest.fixture
def cost_maps() -> CostMaps:
    return CostMaps(known_model(WALLS))


def test_only_the_squares_of_a_subgoal_count_that_one_move_reaches(cost_maps: CostMaps) -> None:
    behind, open_ = (31, 12), (29, 15)
    assert one_move_squares(cost_maps, "explore").ravel()[[flat(*behind), flat(*open_)]].tolist() == [False, True]
    fewest = FewestMoves(cost_maps)
    (priced,) = fewest.priced([subgoal(behind, open_)])
    assert priced.squares.tolist() == [flat(*open_)]
    way = fewest.way(priced)
    assert way is not None
    assert way.squares == (cost_maps.here, (29, len(WALLS) - 1 - 15))


def test_a_long_detour_that_saves_a_move_is_taken() -> None:
    rows = ["b" * 40, *["b" + "." * 38 + "b"] * 11, "b..U........b" + "." * 26 + "b", "b" * 40]
    cost_maps = CostMaps(known_model(rows))
    width = len(rows[0])
    behind, far = width + 14, 12 * width + 37
    assert one_move_squares(cost_maps, "explore").ravel()[[behind, far]].tolist() == [False, True]
    ways = cost_maps.distances[0].ravel()[[behind, far]] / 5
    assert ways[0] + 2 < ways[1]
    (priced,) = FewestMoves(cost_maps).priced([Subgoal("explore", np.array([behind, far]), "there")])
    assert priced.squares.tolist() == [far]


@pytest.mark.parametrize(("square", "moves"), [((29, 15), 1), ((33, 9), 2), ((3, 2), ASSUMED_MOVES)])
def test_a_subgoal_costs_its_moves_and_a_share_of_its_way(
    cost_maps: CostMaps, square: tuple[int, int], moves: int
) -> None:
    far = cost_maps.distances[0].ravel()[flat(*square)] / 5
    (priced,) = FewestMoves(cost_maps).priced([subgoal(square)._replace(price=7.0)])
    assert far + priced.price == pytest.approx(7.0 + moves * MOVE_COST + SQUARE_COST * far)


def test_the_second_move_can_begin_where_the_first_ends(cost_maps: CostMaps) -> None:
    met = subgoal((33, 9))
    way = FewestMoves(cost_maps).way(met)
    assert way is not None
    (_, via) = way.squares
    end = (33, len(WALLS) - 1 - 9)
    assert sweep_is_free(cost_maps.safe, cost_maps.here, via)
    assert sweep_is_free(cost_maps.safe, via, end)
    assert FewestMoves(cost_maps).way(subgoal((3, 2))) is None


def test_of_squares_that_one_move_reaches_one_that_tells_more_is_chosen(cost_maps: CostMaps) -> None:
    """What must be felt sooner or later is felt where that costs no command."""
    met = np.flatnonzero(one_move_squares(cost_maps, "explore") & (cost_maps.distances[0] > 10))
    near, telling = met[np.argsort(cost_maps.far(met), kind="stable")][[0, 9]]
    mask = np.zeros(cost_maps.safe.shape, np.bool_)
    mask.ravel()[telling] = True
    for told, end in ((None, near), (mask, telling)):
        way = FewestMoves(cost_maps, told).way(Subgoal("explore", np.array([near, telling]), "there"))
        assert way is not None
        assert way.squares[1][1] * len(WALLS[0]) + way.squares[1][0] == end


@pytest.mark.parametrize("unseen", ["north", "south"])
def test_the_turn_is_where_unseen_squares_come_into_sight(unseen: str) -> None:
    """A block stands between the robot and its subgoal; the ways on both sides are as long."""
    hall, block = "b" + "." * 58 + "b", "b" + "." * 25 + "b" * 8 + "." * 25 + "b"
    here = "b..U" + block[4:]
    model = known_model(["b" * 60, *[hall] * 9, *[block] * 4, here, *[block] * 4, *[hall] * 9, "b" * 60])
    seen = model.view.seen.copy()
    seen[slice(-4, None) if unseen == "north" else slice(4)] = False
    cost_maps = CostMaps(replace(model, view=model.view._replace(seen=seen)))
    row = cost_maps.here[1]
    way = FewestMoves(cost_maps).way(Subgoal("explore", np.array([row * 60 + 56]), "there"))
    assert way is not None
    assert (way.squares[1][1] > row) == (unseen == "north")


def half_seen(shown: int) -> CostMaps:
    """Return a hall of which only the first `shown` columns from the west, where the robot stands, were seen."""
    model = known_model(["b" * 60, *["b" + "." * 58 + "b"] * 17, "b..U" + "." * 55 + "b", "b" * 60])
    seen = model.view.seen.copy()
    seen[:, shown:] = False
    return CostMaps(replace(model, view=model.view._replace(seen=seen)))


def test_the_best_view_has_the_most_gain_for_its_cost() -> None:
    cost_maps = half_seen(40)
    met = one_move_squares(cost_maps, "explore")
    (look,) = best_views(cost_maps, met, MOVE_COST, SQUARE_COST)
    columns = look.squares % met.shape[1]
    assert met.ravel()[look.squares].all()
    assert columns.min() > 40 - GAIN_REACH  # from further west hardly anything new comes into sight
    assert (columns < 39).any()  # and it need not border on unseen squares
    west = met & (np.arange(met.shape[1]) < columns.min())
    (nearer,) = best_views(cost_maps, west, MOVE_COST, SQUARE_COST)
    assert 1 <= nearer.chance <= look.chance


def test_there_is_no_best_view_where_nothing_new_comes_into_sight() -> None:
    cost_maps = half_seen(60)
    nowhere = np.zeros_like(one_move_squares(cost_maps, "explore"))
    assert best_views(cost_maps, nowhere, MOVE_COST, SQUARE_COST) == []
    hall = known_model(["b" * 70, *["b" + "." * 68 + "b"] * 40, "b..U" + "." * 65 + "b", "b" * 70])
    cost_maps = CostMaps(hall)
    nowhere = np.zeros(hall.view.seen.shape, bool)
    nowhere[20:23, 30:40] = True
    assert best_views(cost_maps, nowhere, MOVE_COST, SQUARE_COST) == []


def test_every_first_move_is_possible() -> None:
    for spread in (0.0, math.pi):
        cost_maps = CostMaps(replace(known_model(WALLS), likely_spread=spread))
        reached = one_move_squares(cost_maps, "explore")
        for square in np.flatnonzero(cost_maps.floor)[::7].tolist():
            way = FewestMoves(cost_maps).way(Subgoal("explore", np.array([square]), "there"))
            if way is not None:
                column, row = way.squares[-1]
                assert reached[row, column]


def test_no_straight_move_leads_through_a_forbidden_door() -> None:
    rows = ["b" * 30, *["b" + "." * 13 + "bb" + "." * 13 + "b"] * 5, "b...U" + "." * 24 + "b"]
    rows += ["b" + "." * 28 + "b"] * 2 + rows[1:6] + ["b" * 30]
    model = known_model(rows)
    assert len(rooms_of(model).doors) == 1
    carried = symbol("at", symbol("x"), symbol("corner", symbol("northeast")))
    never = symbol("not_through", symbol("utak"), symbol("d"))
    cost_maps, beyond = CostMaps(model), Subgoal("explore", np.array([7 * 30 + 25]), "there")
    assert FewestMoves(cost_maps).way(beyond) is not None
    for goals, moves in (((carried,), True), ((carried, never), False)):
        task = Task({}, (), goals)
        decider = Decider(task)
        situation = situation_of(model, task=task)
        decision = decider.pursuer._walk(beyond, decider.stages[0], situation, FewestMoves(cost_maps))
        assert (decision.command is not None) == moves
