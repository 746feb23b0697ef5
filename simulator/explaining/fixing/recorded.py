"""A recorded run, as far as it is needed to repeat it."""

from collections.abc import Sequence
from dataclasses import dataclass

from utak.kb.language.diagnostics import BadInputError
from utak.simulator.episode.episode import Episode
from utak.simulator.episode.record import recorded_scenario, recorded_settings
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings, kb_files_named


@dataclass(frozen=True)
class RecordedRun:
    """A run that can be repeated."""

    scenario: Scenario  # what determines the run
    settings: Settings
    episode: Episode  # what was recorded of it


def recorded_run(name: str, episode: Episode, rule_files: Sequence[str] = ()) -> RecordedRun:
    """Return the run that an episode records."""
    if not episode.steps:
        what = "the episode ends before its first step: it does not say where the robot woke"
        raise BadInputError.at(name, what)
    scenario = recorded_scenario(name, episode.header, episode.steps[0])
    settings = recorded_settings(name, episode.header, tuple(rule_files))
    kb_files_named(list(rule_files))
    return RecordedRun(scenario, settings, episode)
