"""One run on a worker: the result of `Session`, from texts alone, without a trace of where they were written."""

import json
from pathlib import Path
from typing import Any

import pytest
import scripted_robot
from random_scenes import write_scene

from utak.kb.body import Body
from utak.kb.language.diagnostics import BadInputError
from utak.kb.task.task import Task
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.session import Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.sweep.contents import read_contents
from utak.simulator.sweep.one_run import run_one
from utak.simulator.sweep.plan import SweepPlan


def make(body: Body, task: Task, settings: Settings) -> scripted_robot.Robot:
    """Make the scripted robot; it reports the rules that it gets in its verdict."""
    options = scripted_robot.Options(settings.paths, settings.kb_files, settings.max_steps, settings.pull)
    return scripted_robot.Robot(body, task, options)


def argument_of(folder: Path, **options: Any) -> dict[str, Any]:
    """Return what a worker gets for a run of a scenario, after a journey as JSON."""
    plan = SweepPlan((read_contents(folder, "scene"),), ((4, 5),), (0.2,), **options)
    argument: dict[str, Any] = json.loads(json.dumps(plan.task(plan.runs[0]).argument))
    return argument


def test_a_run_on_a_worker_ends_as_one_at_home(tmp_path: Path) -> None:
    scene = write_scene(tmp_path / "scene", 3)
    settings = Settings(seed=4, noise=0.2, max_steps=7, pull=False)
    at_home = Session(read_scenario(scene), settings, make, EpisodeLog(None)).run()
    found = run_one(argument_of(scene, settings=Settings(max_steps=7, pull=False)), make)
    assert found["result"] == {**at_home.line["result"], "unmet": list(at_home.unmet)}
    assert found["passed"] is False and found["result"]["steps"] == 7


def test_a_run_passes_as_utak_test_says(tmp_path: Path) -> None:
    scene = write_scene(tmp_path / "scene", 3)
    (scene / "expect.lp").write_text("fails.")
    assert run_one(argument_of(scene), make)["passed"] is True
    (scene / "expect.lp").unlink()
    found = run_one(argument_of(scene), make)
    assert (found["passed"], found["result"]["achieved"]) == (None, None)


def test_messages_do_not_tell_the_place_on_the_worker(tmp_path: Path) -> None:
    scene = write_scene(tmp_path / "scene", 3)
    (scene / "goal.lp").write_text("at(utak, cornr(northeast)).")
    with pytest.raises(BadInputError) as caught:
        run_one(argument_of(scene), make)
    assert str(caught.value).startswith("goal.lp:1:10-25: error: unknown place")


def test_rules_travel_too(tmp_path: Path) -> None:
    scene = write_scene(tmp_path / "scene", 3)
    seen = []

    def looking(body: Body, task: Task, settings: Settings) -> scripted_robot.Robot:
        seen.extend(Path(name).read_text() for name in settings.kb_files)
        return make(body, task, settings)

    run_one(argument_of(scene, rules=(("r.lp", "a(1)."), ("r.lp", "a(2)."))), looking)
    assert seen == ["a(1).", "a(2)."]
