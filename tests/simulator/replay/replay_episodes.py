"""Episodes for the tests of replays: a recorded run, and one that means no good."""

import json
import random
import re
from pathlib import Path
from typing import Any

from utak.simulator.cli.main import main
from utak.simulator.episode.episode import Episode, read_episode
from utak.simulator.episode.schema import accepts
from utak.simulator.replay.page import inflated

ROOT = Path(__file__).resolve().parents[3]
HOSTILE = (
    '</script><script>document.title="taken"</script><!-- \x1b[31m \u202e \ud800 <img src=x onerror=alert(1)> ${1} `'
)


def body_of(page: str) -> str:
    """Return the body of a page as markup, which the page holds deflated."""
    packed = re.search(r'id="player">\n(.*?)\n</script>', page, re.DOTALL)
    assert packed is not None
    return str(inflated(packed[1])[0]["body"])


def recorded(folder: Path, example: str, *options: str) -> tuple[Path, Episode]:
    """Run an example with some options; return the file of its episode, in a folder, and the episode."""
    path = folder / f"{example}.jsonl"
    main(["run", str(ROOT / "examples" / example), "--log", str(path), *options])
    return path, read_episode(path)


def hostile(episode: Episode) -> Episode:
    """Return an episode that is well-formed, but whose texts and further keys mean no good."""
    header, steps = json.loads(json.dumps([episode.header, list(episode.steps)]))
    header["task"]["goals"] = [HOSTILE, "$title $episode"]
    header["options"]["seed"] = 2**63 - 1
    header["world"]["movable"]["__proto__"] = {"colour": HOSTILE, "rings": [[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]]}
    odd: list[Any] = [None, True, -1, 1.5, "x" * 5000, [], {}, [[]], [{"points": 3}], {"__proto__": {"a": 1}}, HOSTILE]
    chance = random.Random(1)
    keys = ("place", "lattice", "pose", "cells", "bound", "least", "most", "status", "explained", "seen_from", "origin")
    keys += ("map_from", "solved", "regions", "routes", "necks", "moved", "outlines", "unfelt", "place_within")
    for line in steps:
        line["why"] = HOSTILE * 40
        line["objects"]["__proto__"] = [[1, 1], [2, 1], [2, 2]]
        line["held"] = "__proto__"
        line['["belief","pose"]'] = line["belief\npose"] = 3
        line["belief"]["facts"] += [
            "kind(a,b).",
            'rect("</script>",99999999999999999999,1,2,3).',
            "segment(f,x,1).",
            "p.",
        ]
        line["belief"]["facts"] += ['shape(o1,"\\"),(",7).', "plan(x,y).", "segment(o1,0,1,2,3,4,5).", "door(((((((("]
        line["belief"]["facts"][-1] = "door((((((((a))))))))."
        for key in keys:
            before = line["belief"]
            if chance.random() < 0.5:
                line["belief"] = before | {key: chance.choice(odd)}
            if not accepts("step", line):  # reading refuses it
                line["belief"] = before
    return Episode(header, tuple(steps), None)
