"""Replays as files: reading an episode that can be shown, and writing its page or its moving picture."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.episode.episode import Episode, read_begun_episode
from utak.simulator.episode.output_files import check_path, is_gif, write_whole
from utak.simulator.replay.page import is_page, replay_page

PAGE_KIND, GIF_KIND = "page of HTML", "GIF picture"  # as messages name them
MAX_NESTING = 100  # levels of lists and objects within each other; ours have about ten


def read_replayable(path: Path | str) -> Episode:
    """Return an episode with one step at least."""
    # Raises CannotOpenError when it cannot be read, BadInputError when it is damaged or has no step.
    episode = read_begun_episode(path)
    for number, line in enumerate((episode.header, *episode.steps), 1):
        if not _is_shallow(line):
            what = f"values are nested more than {MAX_NESTING} deep: no viewer can show this episode"
            raise BadInputError.at(str(path), what, line=number)
    return episode


def _is_shallow(value: Any) -> bool:
    """Return whether lists and objects in a JSON value are nested at most MAX_NESTING deep."""
    level = [value]
    for _ in range(MAX_NESTING + 1):
        inner = (part.values() if isinstance(part, dict) else part for part in level if isinstance(part, dict | list))
        level = [part for parts in inner for part in parts if isinstance(part, dict | list)]
        if not level:
            return True
    return False


def write_page(
    path: Path | str,
    episode: Episode,
    force: bool = False,
    rule_files: Sequence[str] = (),
    name: str = "",
    certificate: str = "",
) -> str:
    """Write the page of an episode, with trees of reasons, and with the text of a certificate, which it checks."""
    from utak.simulator.explaining.missing_rules import missing_rules
    from utak.simulator.explaining.trees import (
        trees_of_episode,  # takes clingo, which the other kinds of replay do not need
    )

    lacking = missing_rules(episode.header, rule_files)
    page = replay_page(episode, trees_of_episode(episode, rule_files, certificate), lacking, name, certificate)
    write_whole(path, page.encode("utf-8"), is_page, PAGE_KIND, force)
    return lacking


def write_gif(path: Path | str, episode: Episode, force: bool = False) -> None:
    """Write an episode as a moving picture."""
    try:
        from utak.simulator.replay.gif import animation
    except ImportError:
        what = "moving pictures need pillow, which is not installed: pip install pillow"
        raise CannotOpenError(str(path), what) from None
    check_path(path, is_gif, GIF_KIND, force)  # before the pictures are drawn, which takes long
    write_whole(path, animation(episode), is_gif, GIF_KIND, force)
