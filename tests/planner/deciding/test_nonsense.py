"""With any impressions whatever, the robot goes on or gives up with a reason; it never raises an error."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.eyes import impression, random_room, utak_in, world_of
from tests.planner.test_cycle import NORTHEAST, SQUARE
from utak.geometry.counts.retina import FIELDS, OWN_FIELD
from utak.kb.body import Command, Impression
from utak.kb.task.task import Task
from utak.planner.cycle import Options, Robot
from utak.planner.decision import TaskVerdict

LEVELS = {1: (0, 7), 2: (0, 2, 4, 5, 7), 4: tuple(range(8))}


class Nonsense:
    """A body whose impressions are random in part. broken : the share of fields and touches that are."""

    def __init__(self, seed: int, broken: float) -> None:
        self.rng, self.broken = np.random.default_rng(seed), broken
        rows = random_room(self.rng, 24, 20, things=4)
        self.rows = [rows[0], *rows[1:5], rows[5][:5] + "U" + rows[5][6:], *rows[6:]]

    def wake(self) -> Impression:
        true = impression(world_of(self.rows), utak_in(self.rows))
        levels = [
            level if self.rng.random() >= self.broken else int(self.rng.choice(LEVELS[field.side]))
            for level, field in zip(true.retina, FIELDS, strict=True)
        ]
        levels[OWN_FIELD] = 7
        touch = tuple(self.rng.choice(["b", "g", None]) if self.rng.random() < self.broken else t for t in true.touch)
        return Impression(tuple(levels), touch)

    def act(self, command: Command) -> Impression:
        return self.wake()


@pytest.mark.long
@pytest.mark.parametrize("task", [Task({}, (), (NORTHEAST,)), SQUARE], ids=["corner", "square"])
@settings(max_examples=3, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), broken=st.sampled_from([0.02, 0.3, 1.0]))
def test_random_impressions_raise_no_error(task: Task, seed: int, broken: float) -> None:
    robot = Robot(Nonsense(seed, broken), task, Options(max_steps=6))
    report = robot.wake()
    while not robot.finished:
        assert sum(report.belief["cells"].values()) == len(FIELDS)
        report = robot.step()
    assert robot.verdict.verdict in tuple(TaskVerdict)
    assert robot.verdict.reason
