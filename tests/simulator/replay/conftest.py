"""Recorded episodes for the tests of replays; those that more than one module needs are recorded once."""

import sys
from pathlib import Path

import pytest

from utak.simulator.episode.episode import Episode

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def carried(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Episode]:
    """Return a run in which a thing is carried: its file and the episode."""
    from replay_episodes import recorded

    folder = tmp_path_factory.mktemp("carried")
    return recorded(folder, "push_square_three_rooms")
