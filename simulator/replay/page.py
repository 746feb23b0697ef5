"""The page of an episode: one HTML file that needs nothing else, neither a server nor a network.

The parts of the page lie in the folder `page_parts` as a browser reads them. They are put together here. The player
and the episode stand in the page deflated, and the browser inflates them. A policy in the page allows no script and no
style but these, and no request at all; so no text of an episode can do anything.

The episode is an index and the lines of its steps, each one line of JSON. The index has `header` and `result`, those of
the episode; `utak` and `place`, where the robot was and where it believed to be, by step; `anew`, the steps that state
`seen_from`; `events`, the steps of each kind of event; `bounds`, the least and greatest coordinates of floor and
things; `trees`, explanations by step; `certificate`, the text of a certificate, which the page checks; "" for none.
"""

import base64
import hashlib
import html
import json
import re
import zlib
from collections.abc import Mapping, Sequence
from importlib.resources import files
from string import Template
from typing import Any

from utak.geometry.counts.retina import RETINA_ZONES
from utak.simulator.episode.episode import Episode, EpisodeLine
from utak.simulator.episode.output_files import after_prologue
from utak.simulator.replay.drawing import rectangles
from utak.simulator.replay.events import episode_events
from utak.simulator.terminal.action_in_words import truth_in_words
from utak.simulator.terminal.streams import one_line

LOADER = ("loader.js",)  # the script that stands in a page as it is
# The scripts that stand in it deflated, in the order in which they need one another.
DRAWING = ("episode.js", "facts.js", "svg.js", "maps.js", "retina.js", "panels.js")
PLAYER = (*DRAWING, "certificate.js", "certificate_drawn.js", "player.js", "start.js")
MAX_TITLE_CHARACTERS = 300  # of a title made from an episode's goals; a convention
MAX_SAFE_INTEGER = 2**53  # the greatest integer that a browser's numbers hold exactly


def replay_page(
    episode: Episode,
    trees: Mapping[int, Sequence[Any]] | None = None,
    lacking: str = "",
    name: str = "",
    certificate: str = "",
) -> str:
    """Return an episode as a page of HTML that plays it."""
    if not episode.steps:
        raise ValueError("an episode without a step cannot be replayed")
    loader, player = _script(LOADER), _script(PLAYER, f"const RETINA_ZONES = {json.dumps(RETINA_ZONES)};")
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
        player=_deflated([{"style": style, "body": body, "script": player}]),
        episode=_deflated([_index(episode, trees or {}) | {"certificate": certificate}, *map(slim, episode.steps)]),
    )


def inflated(text: str) -> list[Any]:
    """Return the JSON values of a text that stands in a page deflated."""
    return [json.loads(line) for line in zlib.decompress(base64.b64decode(text)).decode("ascii").split("\n")]


def slim(value: Any) -> Any:
    """Return a JSON value as a browser can hold it: whole floats as integers, too great integers as text."""
    if isinstance(value, float) and value.is_integer() and abs(value) < MAX_SAFE_INTEGER:
        return int(value)
    if isinstance(value, int) and abs(value) > MAX_SAFE_INTEGER:
        return str(value)
    if isinstance(value, list):
        return [slim(item) for item in value]
    if isinstance(value, dict):
        return {key: slim(item) for key, item in value.items()}
    return value


def is_page(head: bytes) -> bool:
    """Return whether a file with these first bytes is a page of HTML."""
    return re.match(rb"<(!DOCTYPE\s+html|html)\b", after_prologue(head), re.IGNORECASE) is not None


def _deflated(values: Sequence[Any]) -> str:
    """Return JSON values, one a line, as text of a page (`inflated` reads it)."""
    lines = "\n".join(json.dumps(value, separators=(",", ":"), allow_nan=False) for value in values)
    return base64.b64encode(zlib.compress(lines.encode("ascii"), 9)).decode("ascii")


def _index(episode: Episode, trees: Mapping[int, Sequence[Any]]) -> dict[str, Any]:
    """Return what a page needs of all steps at once (see the module's description)."""
    beliefs = [line["belief"] for line in episode.steps]
    return {
        "header": slim(episode.header),
        "result": slim(episode.result),
        "utak": [line["utak"] for line in episode.steps],
        "place": [slim(belief.get("place")) for belief in beliefs],
        "anew": [step for step, belief in enumerate(beliefs) if "seen_from" in belief],
        "events": episode_events(episode),
        "bounds": _bounds(episode.steps),
        "trees": {step: slim(list(told)) for step, told in trees.items()},
    }


def _bounds(lines: Sequence[EpisodeLine]) -> list[int] | None:
    """Return the least east and north, and the greatest, of all rectangles, in hundredths of squares, robot frame."""
    known = rectangles({fact for line in lines for fact in line["belief"]["facts"]})
    boxes = [box for name, box in known if name != "verge"]
    if not boxes:
        return None
    west, south, east, north = zip(*boxes, strict=True)
    return [min(west), min(south), max(east), max(north)]


def _part(name: str) -> str:
    """Return a file of the folder `page`."""
    return (files(__package__) / "page_parts" / name).read_text(encoding="utf-8")


def _script(names: Sequence[str], first: str = "") -> str:
    """Return some scripts as one after a first line: no other script sees its names; without indents and comments."""
    lines = [line.strip() for name in names for line in _part(name).splitlines()]
    bare = "\n".join(line for line in lines if line and not line.startswith("//"))
    return f'"use strict";\n(() => {{\n{first}\n{bare}\n}})();\n'


def _hash(text: str) -> str:
    """Return what a content security policy calls a script or a style."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


def _goals(episode: Episode) -> str:
    return _clipped(", ".join(episode.header["task"]["goals"]))


def _about(episode: Episode) -> str:
    options = episode.header["options"]
    told = [f"seed {options['seed']}", f"noise {options['noise']:g}", f"paths {options['paths']}"]
    told += ["no pull"] if options.get("pull") is False else []
    count = len(options["kb"])
    told += [f"{count} file{'s' * (count != 1)} of rules"] if count else []
    if episode.result is None:
        return f"{', '.join(told)}; the episode was cut short after step {len(episode.steps) - 1}"
    result = episode.result
    truth = truth_in_words(result["achieved"])
    return f"{', '.join(told)}; {result['verdict']} in {result['steps']} steps{truth}: {_clipped(result['reason'])}"


def _clipped(text: str) -> str:
    """Return a text on one line, without control characters, cut where it is very long."""
    clean = one_line(text)
    return clean if len(clean) <= MAX_TITLE_CHARACTERS else clean[:MAX_TITLE_CHARACTERS] + " ..."
