"""A run or a recorded episode, read step by step, back and forth."""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from utak.simulator.episode.episode import EpisodeLine, read_begun_episode
from utak.simulator.run.changes import Change, RunConditions
from utak.simulator.run.live_story import LiveStory
from utak.simulator.run.recorded_story import RecordedStory
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings


class Story(Protocol):
    """A sequence of episode lines, with a current step."""

    @property
    def header(self) -> EpisodeLine:
        """The header of the episode, with the changes up to the current step."""

    @property
    def is_awake(self) -> bool:
        """Whether lines can be read without waiting for the robot to wake."""

    @property
    def at(self) -> int:
        """The number of the current step."""

    @property
    def lines(self) -> Sequence[EpisodeLine]:
        """The lines of all steps known so far, step 0 first."""

    @property
    def line(self) -> EpisodeLine:
        """The line of the current step."""

    @property
    def result(self) -> EpisodeLine | None:
        """The end, at the last step: `believed`, `achieved`, `verdict`, `reason`, `steps`; else None."""

    @property
    def next_action(self) -> tuple[EpisodeLine | None, str] | None:
        """The command after the current step and its reason; None when there is none."""

    @property
    def changes(self) -> tuple[Change, ...]:
        """The changes of the run up to the current step."""

    @property
    def conditions(self) -> RunConditions:
        """The conditions that count at the current step besides the scenario: assumptions, and the task."""

    @property
    def rule_files(self) -> tuple[str, ...]:
        """The paths of all rules that count at the current step."""

    @property
    def facts(self) -> list[str]:
        """The world model at the current step, as well-formed facts. Raises BadInputError for a damaged episode."""

    def facts_at(self, step: int) -> list[str]:
        """Return the world model at a known step, as well-formed facts; raise BadInputError as `facts` does."""

    def advance(self) -> bool:
        """Go on by one step. Return whether there was one."""

    def go_to(self, step: int) -> None:
        """Go to a known step; raise IndexError when it is not known."""

    def picture(self) -> str:
        """Return the true table at the current step as a picture."""


def open_story(path: Path | str, settings: Settings) -> LiveStory | RecordedStory:
    """Return the story of a scenario folder, which is run, or of an episode file, at step 0."""
    if Path(path).is_dir():
        return LiveStory(read_scenario(path), settings)
    return RecordedStory(str(path), read_begun_episode(path), settings.kb_files)
