"""The remaining plan: in the map frame, begun where the robot stands, and kept while the world is as it says."""

import math
from collections.abc import Mapping
from pathlib import Path

import pytest
import shapely
from shapely.affinity import translate

from benchmarks.harness.trial import Conditions, run_trial
from tests.planner.situations import watched_robot
from utak.geometry.manipulation.goals import End
from utak.geometry.motion.se2 import Rotate
from utak.kb.world.model import Node, WorldModel
from utak.planner.carrying.manipulation_oracle import ManipulationPlan
from utak.planner.carrying.remaining_plan import (
    AREA_TOLERANCE,
    PlanOperations,
    RemainingPlan,
    begin_plan,
    revalidate,
    start_from_robot,
)
from utak.planner.goals.placement import meets_end, to_view_frame
from utak.planner.situation import Situation


def turns(plan: RemainingPlan) -> bool:
    """Return whether a plan turns its object."""
    return any(isinstance(motion, Rotate) for leg in plan.legs for motion in leg.motions)


@pytest.mark.long
def test_a_remaining_plan_leads_where_the_manipulation_plan_does(tmp_path: Path) -> None:
    turned = []

    def watched(found: ManipulationPlan, node: Node, model: WorldModel) -> RemainingPlan:
        plan = begin_plan(found, node, model)
        end = translate(found.plan.polygon, model.view.west, model.view.south)
        if found.plan.legs and not found.level:
            assert plan.end.symmetric_difference(end).area < 1e-9
            turned.append(turns(plan))
        return plan

    maker = watched_robot(PlanOperations(begin_plan=watched))
    for task, seed in ((6, 91005), (7, 91010), (9, 91009)):
        assert run_trial(task, seed, Conditions(), tmp_path / f"{task}-{seed}", maker=maker).right
    assert any(turned)


@pytest.mark.long
def test_a_turned_object_lies_as_the_plan_says(tmp_path: Path) -> None:
    off = []

    def watched(plan: RemainingPlan, ends: Mapping[str, End] | None, situation: Situation) -> RemainingPlan | None:
        node = situation.model.object(plan.name)
        if plan.grasped and node is not None and node.turned:
            off.append(shapely.symmetric_difference(node.polygon, plan.polygon).area)
        return revalidate(plan, ends, situation)

    maker = watched_robot(PlanOperations(revalidate=watched))
    for task, seed in ((7, 91009), (9, 91009)):
        assert run_trial(task, seed, Conditions(), tmp_path / f"{task}-{seed}", maker=maker).right
    assert len(off) > 2
    assert max(off) < AREA_TOLERANCE


@pytest.mark.long
def test_an_object_is_grasped_from_where_the_robot_stands(tmp_path: Path) -> None:
    begun = []

    def watched(plan: RemainingPlan, ends: Mapping[str, End], situation: Situation) -> RemainingPlan | None:
        near = start_from_robot(plan, ends, situation)
        model = situation.model
        if near is not None:
            assert near.legs[0].place == model.place
            assert 0 < math.dist(near.legs[0].place, plan.legs[0].place) < 1
            assert any(meets_end(end, to_view_frame(near.end, situation)) for end in ends.values())
            begun.append(near)
        return near

    maker = watched_robot(PlanOperations(start_from_robot=watched))
    for task, seed in ((8, 91003), (6, 91015)):
        folder = tmp_path / f"{task}-{seed}"
        assert run_trial(task, seed, Conditions(), folder, maker=maker).right
        assert "to the middle of its square" not in next(folder.rglob("episode.jsonl")).read_text()
    assert begun
