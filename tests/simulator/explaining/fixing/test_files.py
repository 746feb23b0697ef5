"""A scenario comes back unchanged from the header of its episode, and from the files that are written."""

from pathlib import Path

import pytest

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.episode.episode import Episode
from utak.simulator.episode.record import header
from utak.simulator.explaining.fixing.recorded import recorded_run
from utak.simulator.explaining.fixing.writing import write_scenario
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings

EXAMPLES = sorted(path.parent for path in (Path(__file__).parents[4] / "examples").glob("*/goal.lp"))
SETTINGS = Settings(seed=7, noise=0.01, paths="grid", max_steps=33, pull=False)


def recorded(folder: Path) -> Episode:
    """Return an episode of one step in a scenario."""
    scenario = read_scenario(folder)
    return Episode(header(scenario, SETTINGS), ({"utak": list(scenario.world.utak), "held": None},), None)


@pytest.mark.parametrize("folder", EXAMPLES, ids=lambda folder: folder.name)
def test_every_example_comes_back(folder: Path, tmp_path: Path) -> None:
    episode = recorded(folder)
    run = recorded_run("ep", episode)
    assert run.settings == SETTINGS
    assert header(run.scenario, run.settings) == episode.header
    assert run.scenario.world.utak == read_scenario(folder).world.utak
    write_scenario(run.scenario, tmp_path / "new")
    again = read_scenario(tmp_path / "new")
    assert header(again, SETTINGS) == episode.header
    assert again.world.utak == run.scenario.world.utak


def test_a_full_folder_is_not_written(tmp_path: Path) -> None:
    run = recorded_run("ep", recorded(EXAMPLES[0]))
    (tmp_path / "mine").write_text("")
    with pytest.raises(CannotOpenError, match="not empty"):
        write_scenario(run.scenario, tmp_path)


def test_rules_must_be_those_of_the_run(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("wide(X) :- rect(X, W, _, E, _), E - W > 500.\n")
    with pytest.raises(BadInputError, match="used 0 files of rules, and 1"):
        recorded_run("ep", recorded(EXAMPLES[0]), [str(rules)])
    episode = recorded(EXAMPLES[0])
    episode.header["options"]["kb"] = ["0" * 64]
    with pytest.raises(BadInputError, match="other rules"):
        recorded_run("ep", episode, [str(rules)])


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("verge", [[[[0, 0], [1, 1]]]]),
        ("movable", {"g1": {"colour": "g", "rings": [[[0, 0], [1, 0]]]}}),
    ],
)
def test_a_damaged_world_is_refused(key: str, value: object) -> None:
    episode = recorded(EXAMPLES[0])
    episode.header["world"][key] = value
    with pytest.raises(BadInputError, match="damaged"):
        recorded_run("ep", episode)


def test_goals_that_are_none_are_refused() -> None:
    episode = recorded(EXAMPLES[0])
    episode.header["task"]["goals"] = ["fly(utak,corner(northeast))"]
    with pytest.raises(BadInputError, match="fly"):
        recorded_run("ep", episode)


def test_an_episode_without_steps_is_refused() -> None:
    with pytest.raises(BadInputError, match="first step"):
        recorded_run("ep", Episode(recorded(EXAMPLES[0]).header, (), None))
