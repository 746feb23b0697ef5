"""Plain worlds: valid, on whole squares, the same for the same seed; and the robot that knows them."""

from pathlib import Path

import numpy as np
import pytest
import shapely

from benchmarks.harness.knowing import knowing
from benchmarks.harness.trial import Conditions, run_trial
from benchmarks.worlds.makers import scenario
from benchmarks.worlds.plain import PLAIN_GOALS
from benchmarks.worlds.scenes import write
from utak.kb.mapping.occupancy import FREE
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.session import Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings


@pytest.mark.parametrize("task", sorted(PLAIN_GOALS))
def test_plain_worlds_are_valid_and_on_whole_squares(task: int, tmp_path: Path) -> None:
    for seed in range(4):
        world = scenario(task, seed, kind="plain")
        assert world.possible
        assert world.heading % 90 == 0
        assert (world.utak.x % 1, world.utak.y % 1) == (0.5, 0.5)
        shapes = [world.plan.floor, *(thing.polygon for thing in world.things)]
        for shape in shapes:
            corners = shapely.get_coordinates(shape)
            assert np.allclose(corners, np.rint(corners))
        for thing in world.things:
            assert world.plan.floor.covers(thing.polygon)
            assert not thing.polygon.covers(world.utak)
        assert world == scenario(task, seed, kind="plain")
        read_scenario(write(world, tmp_path / f"{task}-{seed}"))


@pytest.mark.long
@pytest.mark.parametrize("task", [2, 5, 7])
def test_an_informed_robot_needs_no_more_commands(task: int, tmp_path: Path) -> None:
    trial = run_trial(task, 1, Conditions(knowing=True, kind="plain"), tmp_path)
    assert trial.achieved
    assert 0 < trial.needed <= trial.steps


@pytest.mark.long
@pytest.mark.parametrize("heading_seed", [(1, 1), (1, 4), (3, 0)])
def test_the_knowledge_of_the_informed_robot_is_true(heading_seed: tuple[int, int], tmp_path: Path) -> None:
    world = scenario(*heading_seed)
    session = Session(read_scenario(write(world, tmp_path / world.name)), Settings(), knowing(world), EpisodeLog(None))
    session.wake()
    view = session.robot.model.view
    free = int((view.state == FREE).sum())
    floor = world.plan.floor.difference(shapely.union_all([thing.polygon for thing in world.things])).area
    assert abs(free - floor) <= 0.2 * floor
