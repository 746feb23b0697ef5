"""The example scenarios can be read, and nothing is done in them before Utak has moved."""

from pathlib import Path

import pytest

from utak.simulator.scenario.expectation import Snapshot, should_fail, unmet
from utak.simulator.scenario.scenario import read_scenario

EXAMPLES = sorted(path.parent for path in (Path(__file__).resolve().parent.parent / "examples").glob("*/goal.lp"))


def test_there_are_examples_of_success_and_of_failure() -> None:
    expected = [read_scenario(folder).expectations for folder in EXAMPLES]
    assert None not in expected
    failing = [facts for facts in expected if facts is not None and should_fail(facts)]
    assert len(failing) >= 4
    assert len(expected) - len(failing) >= 15


@pytest.mark.parametrize("folder", EXAMPLES, ids=lambda folder: folder.name)
def test_an_example_is_not_done_at_the_start(folder: Path) -> None:
    scenario = read_scenario(folder)
    assert scenario.expectations is not None
    start = Snapshot(0, scenario.world.utak, {thing.name: thing.polygon for thing in scenario.world.movable})
    assert should_fail(scenario.expectations) or unmet(scenario.expectations, scenario.world, [start])


@pytest.mark.parametrize("folder", EXAMPLES, ids=lambda folder: folder.name)
def test_an_example_explains_itself(folder: Path) -> None:
    for name in ("start.lp", "goal.lp", "expect.lp"):
        assert (folder / name).read_text().startswith("% ")
