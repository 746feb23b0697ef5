"""Active size estimation: pushes that measure an object before it is said to be too large."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely import affinity

from benchmarks.harness.trial import Conditions, run_trial
from utak.geometry.manipulation.goals import At
from utak.kb.mapping.patch import Patch
from utak.kb.objects.subcell_extent import SubcellExtent
from utak.kb.world.model import Node
from utak.planner.skills.measure_size import MAX_SIZE_PUSHES, SizeEstimator


@pytest.mark.long
@pytest.mark.parametrize(
    ("task", "seed", "kind"),
    [
        (9, 420023, "snug"),  # by its least outline the passage lacks less, and it is the same passage
        (7, 440003, "snug"),  # it was turned, and impressions tell nothing of its sides before it is turned back
    ],
)
def test_an_object_is_measured_before_the_missing_width_is_said(
    task: int, seed: int, kind: str, tmp_path: Path
) -> None:
    trial = run_trial(task, seed, Conditions(kind=kind, seconds=3600, max_steps=300), tmp_path)
    assert trial.verdict == "possible_if", (trial.verdict, trial.reason, trial.crash)
    assert trial.narrow is not None
    assert trial.narrow.right, trial.reason
    assert not trial.judged


def node_of(polygon: shapely.Polygon, turned: float, astray: bool) -> Node:
    patch = Patch(0, 0, np.ones((1, 1), np.bool_))
    return Node(
        "o1", "object", 100, "", patch, 0, polygon=polygon, turned=turned, astray=astray, insets=SubcellExtent()
    )


@pytest.mark.parametrize("turned", [90.0, -90.0, 180.0, 270.0])
def test_an_object_that_a_turn_brought_astray_is_turned_back_first(turned: float) -> None:
    brick = shapely.box(3.3, 4.1, 5.3, 9.1)
    ends = list(SizeEstimator().poses(node_of(brick, turned, True)))
    assert len(ends) > 1
    assert len(set(ends)) == len(ends)
    for end in ends:
        assert isinstance(end, At)
        assert (end.pose.degrees + turned) % 360 == 0
        back = affinity.translate(affinity.rotate(brick, end.pose.degrees, origin="centroid"), *end.pose[:2])
        assert np.allclose(back.bounds, np.round(back.bounds))
    far = [float(np.hypot(*end.pose[:2])) for end in ends]
    assert far[0] <= 1.0
    assert max(far) >= 2.0


def test_an_object_that_is_not_astray_is_only_pushed_and_not_for_ever() -> None:
    sizer = SizeEstimator()
    tries = [list(sizer.poses(node_of(shapely.box(3, 4, 5, 9), 90.0, False))) for _ in range(MAX_SIZE_PUSHES + 1)]
    assert all(end.pose.degrees == 0 for ends in tries for end in ends)
    assert all(tries[:MAX_SIZE_PUSHES])
    assert tries[MAX_SIZE_PUSHES] == []
