"""The page of an episode: one HTML file that needs nothing else, neither a server nor a network.

The parts of the page lie in the folder `page_parts` as a browser reads them. They are put together here: what expands
stands in the page as it is, the player and the episode are packed. A policy in the page allows no script
and no style but these, and no request at all; so no text of an episode can do anything.
"""

import base64
import hashlib
import html
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from string import Template
from typing import Any

from simulator.episode.episode import Episode
from simulator.episode.output_files import after_prologue
from simulator.replay.packed.events import episode_events
from simulator.replay.packed.packing import packed_episode
from simulator.replay.packed.short_texts import short_text
from simulator.terminal.streams import escape_controls

LOADER = ("expand.js", "loader.js")  # the scripts that stand in a page as they are
# The scripts that stand in it packed, in the order in which they need one another.
PLAYER = ("decode.js", "facts.js", "svg.js", "maps.js", "retina.js", "panels.js", "player.js", "start.js")
MAX_TITLE_CHARACTERS = 300  # of a title made from an episode's goals; a convention


def replay_page(
    episode: Episode, trees: Mapping[int, Sequence[Any]] | None = None, lacking: str = "", name: str = ""
) -> str:
    """Return an episode as a page of HTML that plays it."""
    if not episode.steps:
        raise ValueError("an episode without a step cannot be replayed")
    loader, player = (_script(names) for names in (LOADER, PLAYER))
    style, shell = _part("style.css"), Template(_part("body.html"))
    body = shell.substitute(
        heading=html.escape(": ".join(filter(None, (_clipped(name), _goals(episode))))) or "no goal",
        about=html.escape("; ".join(filter(None, (_about(episode), _clipped(lacking))))),
        legend=_part("legend.html"),
        help=_part("help.html"),
    )
    return Template(_part("page.html")).substitute(
        title=html.escape(f"{_clipped(name) or 'Utak'}: {_goals(episode)}"),
        style_hash=_hash(style),
        loader=loader,
        script_hashes=f"'{_hash(loader)}' '{_hash(player)}'",
        player=short_text([{"style": style, "body": body, "script": player}]),
        episode="\n".join(packed_episode(episode, episode_events(episode), trees)),
    )


def is_page(head: bytes) -> bool:
    """Return whether a file with these first bytes is a page of HTML."""
    return re.match(rb"<(!DOCTYPE\s+html|html)\b", after_prologue(head), re.IGNORECASE) is not None


def _part(name: str) -> str:
    """Return a file of the folder `page`."""
    return (files(__package__) / "page_parts" / name).read_text(encoding="utf-8")


def _script(names: Sequence[str]) -> str:
    """Return some scripts as one, whose names no other script sees, without indentation and lines of comments."""
    lines = [line.strip() for name in names for line in _part(name).splitlines()]
    bare = "\n".join(line for line in lines if line and not line.startswith("//"))
    return f'"use strict";\n(() => {{\n{bare}\n}})();\n'


def _hash(text: str) -> str:
    """Return what a content security policy calls a script or a style."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


def _goals(episode: Episode) -> str:
    """Return the goals of an episode in a line."""
    return _clipped(", ".join(episode.header["task"]["goals"]))


def _about(episode: Episode) -> str:
    """Return the options and the end of an episode in a line."""
    options = episode.header["options"]
    told = [f"seed {options['seed']}", f"noise {options['noise']:g}", f"paths {options['paths']}"]
    told += ["no pull"] if options.get("pull") is False else []
    count = len(options["kb"])
    told += [f"{count} file{'s' * (count != 1)} of rules"] if count else []
    if episode.result is None:
        return f"{', '.join(told)}; the episode was cut short after step {len(episode.steps) - 1}"
    result = episode.result
    truth = {None: "", True: ", achieved", False: ", not achieved"}[result["achieved"]]
    return f"{', '.join(told)}; {result['verdict']} in {result['steps']} steps{truth}: {_clipped(result['reason'])}"


def _clipped(text: str) -> str:
    """Return a text on one line, without control characters, cut where it is very long."""
    clean = escape_controls(text, lines=False)
    return clean if len(clean) <= MAX_TITLE_CHARACTERS else clean[:MAX_TITLE_CHARACTERS] + " ..."
