"""What is left of a plan: on the lattice, begun where he stands, and kept while the world is as it says."""

import math
from collections.abc import Mapping
from pathlib import Path

import pytest
import shapely
from shapely.affinity import translate

import planner.carrying.plan_executor
from benchmarks.harness.trial import Conditions, run_trial
from geometry.manipulation.goals import End
from geometry.motion.se2 import Rotate
from kb.world.model import Node, WorldModel
from planner.carrying.manipulation_oracle import ManipulationPlan
from planner.carrying.remaining_plan import ALIKE, RemainingPlan, course_of, followed, from_here
from planner.goals.placement import in_view, lands
from planner.situation import Situation


def turns(course: RemainingPlan) -> bool:
    return any(isinstance(motion, Rotate) for leg in course.legs for motion in leg.motions)


def test_a_course_leads_where_its_plan_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    turned = []

    def watched(haul: ManipulationPlan, node: Node, model: WorldModel) -> RemainingPlan:
        course = course_of(haul, node, model)
        end = translate(haul.plan.polygon, model.view.west, model.view.south)
        if haul.plan.legs and not haul.level:
            assert course.end.symmetric_difference(end).area < 1e-9
            turned.append(turns(course))
        return course

    monkeypatch.setattr(planner.carrying.plan_executor, "course_of", watched)
    for task, seed in ((6, 91005), (7, 91010), (9, 91009)):
        assert run_trial(task, seed, Conditions(), tmp_path / f"{task}-{seed}").right
    assert any(turned)


def test_what_was_turned_lies_as_the_course_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    off = []

    def watched(course: RemainingPlan, ends: Mapping[str, End] | None, situation: Situation) -> RemainingPlan | None:
        node = situation.model.object(course.name)
        if course.grasped and node is not None and node.turned:
            off.append(shapely.symmetric_difference(node.polygon, course.polygon).area)
        return followed(course, ends, situation)

    monkeypatch.setattr(planner.carrying.plan_executor, "followed", watched)
    for task, seed in ((7, 91009), (9, 91009)):
        assert run_trial(task, seed, Conditions(), tmp_path / f"{task}-{seed}").right
    assert len(off) > 2
    assert max(off) < ALIKE


def test_a_thing_is_taken_from_where_he_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun = []

    def watched(course: RemainingPlan, ends: Mapping[str, End], situation: Situation) -> RemainingPlan | None:
        near = from_here(course, ends, situation)
        model = situation.model
        if near is not None:
            assert near.legs[0].place == model.place
            assert 0 < math.dist(near.legs[0].place, course.legs[0].place) < 1
            assert any(lands(end, in_view(near.end, situation)) for end in ends.values())
            begun.append(near)
        return near

    monkeypatch.setattr(planner.carrying.plan_executor, "from_here", watched)
    for task, seed in ((8, 91003), (6, 91015)):
        folder = tmp_path / f"{task}-{seed}"
        assert run_trial(task, seed, Conditions(), folder).right
        assert "to the middle of the square" not in next(folder.rglob("episode.jsonl")).read_text()
    assert begun
