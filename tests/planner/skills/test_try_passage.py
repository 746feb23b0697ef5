"""Trials of a passage that may be wider than the squares of its walls leave it."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

import utak
from tests.planner.situations import known_situation
from utak.geometry.cspace.bottleneck import Bottleneck
from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.goals import Inside
from utak.kb.world.model import Node, WorldModel
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.carrying.manipulation_oracle import ManipulationOracle, Request, robot_squares
from utak.planner.skills.try_passage import PassageTrials

ROWS = [  # a passage of 3 through a wall of 2, and a thing of 4
    "b" * 22,
    *["b" + "." * 9 + "bb" + "." * 9 + "b"] * 3,
    "b.gggg" + "." * 15 + "b",
    "bUgggg" + "." * 15 + "b",
    "b.gggg" + "." * 15 + "b",
    "b.gggg....bb" + "." * 9 + "b",
    *["b" + "." * 9 + "bb" + "." * 9 + "b"] * 2,
    "b" * 22,
]
ENDS = {"east": Inside(shapely.box(12, 1, 21, 10))}


def world() -> tuple[WorldModel, Node, Bottleneck]:
    """Return what is believed of ROWS, the thing, and the passage in the view frame."""
    situation = known_situation(ROWS, moved=True)
    (node,) = situation.model.objects
    sides: tuple[XY, XY] = ((10.0, 4.0), (10.0, 7.0))
    return situation.model, node, Bottleneck((10.0, 5.5), sides, 3.0)


def shifted(node: Node, dx: float, dy: float) -> Node:
    """Return an object moved by some squares."""
    return replace(node, polygon=shapely.affinity.translate(node.polygon, dx, dy))


def test_what_is_missing_is_divided_between_the_sides_first_evenly() -> None:
    model, node, passage = world()
    trials, shares = PassageTrials(), []
    while trial := trials.next(node, passage, 1.0, model):
        if trial.aside:
            node = shifted(node, *trial.aside[0][:2])
            continue
        shares.append((passage.sides[0][1] - node.polygon.bounds[1]) % 1.0)
        last = node.polygon.bounds[0]
    assert shares == pytest.approx([0.5, 0.25, 0.75, 0.125, 0.375, 0.625, 0.875])
    assert node.polygon.bounds[0] == last - 3  # then the way is made free


@pytest.mark.parametrize(("missing", "number"), [(0.5, 7), (1.5, 3), (1.9, 1)])
def test_no_side_gives_more_than_the_square_in_which_its_wall_was_seen(missing: float, number: int) -> None:
    model, node, passage = world()
    trials, made = PassageTrials(), 0
    while trial := trials.next(node, passage, missing, model):
        made += not trial.aside
        node = shifted(node, *(trial.aside[0][:2] if trial.aside else (0.0, 0.0)))
    assert made == number


def test_the_walls_along_a_passage_are_supposed_to_be_free_on_both_sides_and_no_others() -> None:
    model, node, passage = world()
    trial = PassageTrials().next(node, passage, 1.0, model)
    assert trial is not None
    rows, columns = np.nonzero(trial.opened)
    assert sorted(zip(rows.tolist(), columns.tolist(), strict=True)) == [(3, 10), (3, 11), (7, 10), (7, 11)]


def test_a_thing_in_the_middle_is_carried_through_and_the_robot_keeps_off_the_walls() -> None:
    situation = known_situation(ROWS, moved=True)
    (node,) = situation.model.objects
    trial = PassageTrials().next(node, world()[2], 1.0, situation.model)
    assert trial is not None
    node = shifted(node, *trial.aside[0][:2])
    request = Request(node, ENDS)
    assert isinstance(ManipulationOracle().find(request, situation), Infeasibility)
    found = ManipulationOracle().through(request, trial.opened, situation)
    assert found is not None
    assert found.hopes
    assert not (found.swept & trial.opened).any()
    assert not any((robot_squares(leg, trial.opened.shape) & trial.opened).any() for leg in found.plan.legs)


@pytest.mark.long
def test_a_door_off_the_grid_is_passed_though_its_whole_squares_are_too_few() -> None:
    west, east = "14 9.95, 14 15, 1 15, 1 1, 14 1, 14 5.05", "16 5.05, 16 1, 29 1, 29 15, 16 15, 16 9.95"
    scenario = utak.Scenario.from_text(
        world=f'table(30, 16). verge("POLYGON ((0 0, 0 16, 30 16, 30 0, 0 0), ({west}, {east}, 14 9.95))").\n'
        'utak("POINT (9.5 3.5)", 0). object(t1, c, "POLYGON ((8 6, 8 10, 4 10, 4 6, 8 6))").\n',
        start="object(x). shape(x, square).\n",
        goal="in(x, room(next)).\n",
        expect='inside(t1, "POLYGON ((29 1, 29 15, 16 15, 16 1, 29 1))").\n',
    )
    result = utak.Run(scenario).finish().result
    assert result is not None
    assert (result["verdict"], result["achieved"]) == ("done", True)
    assert result["steps"] < 40
