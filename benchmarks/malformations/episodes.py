"""Malformed episodes, read step by step as the prompt, questions and pictures read them."""

import io
import json
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

from benchmarks.malformations.mutate import spoil_bytes
from benchmarks.malformations.outcomes import came_out
from utak.kb.reasoning.query import QueryEngine
from utak.launcher import PROJECT_FOLDER
from utak.simulator.cli.main import main
from utak.simulator.run.story import open_story
from utak.simulator.scenario.settings import Settings
from utak.simulator.terminal.action_in_words import describe

RECORDED = (("go_northeast", "2"), ("push_square_corner", "3"))  # runs that are recorded: example, most commands
ASKED_SHARE = 0.05  # of the episodes that are asked a question: each takes a process about 5 ms
HOSTILE_VALUES = (  # JSON texts that are put in the place of values
    "null", "true", "-1", "0.5", "1e999", "NaN", "-Infinity", '""', "[]", "{}", "[[]]", "[" * 3000, '{"a":' * 3000,
    "9" * 5000, '"\\u0000"', '"\\ud800"', '"\\u001b[31m"', '"\\u202e"', '"' + "x" * 200_001 + '"', "[1e308, -1e308]",
    "[0, 0]", "-0.0", '"node(o1) :- node(o2)."', '["#include \\"/etc/passwd\\"."]', '"kind(o1,object,3000000000)."',
    "2147483648", '{"do":"move"}', '{"do":"fly"}', '{"rotate":1}', "[[0,0],[1,1],[0,1],[1,0]]", "[[0,0],[1,1]]",
    '"b\\u00e4r"', "1e-320", '{"a":1,"a":2}',
)  # fmt: skip


def recorded_episodes() -> list[bytes]:
    """Return short episodes of two examples, recorded now."""
    found = []
    with tempfile.TemporaryDirectory() as place:
        for name, steps in RECORDED:
            log = Path(place) / f"{name}.jsonl"
            with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
                main(["run", str(Path(PROJECT_FOLDER, "examples", name)), "--max-steps", steps, "--log", str(log)])
            found.append(log.read_bytes())
    return found


def spoil_episode(draw: random.Random, raw: bytes) -> bytes:
    """Return an episode after a mutation of its values, its lines or its bytes."""
    kind = draw.random()
    if kind < 0.5:
        return _with_other_value(draw, raw)
    if kind < 0.65:
        return _with_other_lines(draw, raw)
    return spoil_bytes(draw, raw)


def _with_other_value(draw: random.Random, raw: bytes) -> bytes:
    """Return an episode in which values, keys or items are replaced, removed or doubled."""
    lines = raw.splitlines()
    number = draw.randrange(len(lines))
    row = json.loads(lines[number])
    mark = "\x00here\x00"
    for _ in range(draw.choice([1, 1, 1, 2])):
        places = list(_places(row))
        holder, key = draw.choice(places)
        change = draw.random()
        if change < 0.2:
            del holder[key]
            if not row:
                break
        elif change < 0.3:
            holder[key] = draw.choice([holder[key], draw.choice(places)[0]])
            try:
                json.dumps(row)
            except (ValueError, RecursionError):  # a value within itself
                return raw[: draw.randrange(len(raw))]
        else:
            holder[key] = mark
    text = json.dumps(row, separators=(",", ":"))
    while json.dumps(mark) in text:
        text = text.replace(json.dumps(mark), draw.choice(HOSTILE_VALUES), 1)
    lines[number] = text.encode()
    return b"\n".join(lines) + b"\n"


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Yield the holder and the key or index of every value inside a value; of long lists the first three."""
    keys = (
        list(value) if isinstance(value, dict) else list(range(min(3, len(value)))) if isinstance(value, list) else []
    )
    for key in keys:
        yield value, key
        yield from _places(value[key])


def _with_other_lines(draw: random.Random, raw: bytes) -> bytes:
    """Return an episode with lines cut, doubled, swapped or left out."""
    lines = raw.splitlines(keepends=True)
    for _ in range(draw.choice([1, 1, 2])):
        at, other = draw.randrange(len(lines)), draw.randrange(len(lines))
        change = draw.randrange(5)
        if change == 0:
            lines[at], lines[other] = lines[other], lines[at]
        elif change == 1:
            lines.insert(other, lines[at])
        elif change == 2 and len(lines) > 1:
            del lines[at]
        elif change == 3:
            lines[at] = lines[at][: draw.randrange(len(lines[at]) + 1)]
        else:
            lines[at] = lines[at][:-1]
    return b"".join(lines)


def read_through(path: Path, engine: QueryEngine, ask: bool) -> None:
    """Read an episode, draw and list every step; raise what goes wrong.

    path : the episode. engine : answers questions. ask : whether to ask one.
    """
    story = open_story(path, Settings())
    while True:
        facts = story.facts
        if not story.picture() or not describe(story.line["action"]) + story.line["why"]:
            raise AssertionError("a step that says nothing")
        if not story.advance():
            break
    if ask:
        engine.ask(facts, "node(X)")


def episodes(
    count: int, seed: int, keep: Path, read: Callable[[Path, QueryEngine, bool], None] = read_through
) -> Counter[str]:
    """Count the outcomes of `count` malformed episodes; faulty ones are kept in `keep`.

    read : reads an episode, with an engine for questions, and whether to ask one.
    """
    outcomes: Counter[str] = Counter()
    good = recorded_episodes()
    with QueryEngine(seconds=2.0) as engine:
        for number in range(count):
            draw = random.Random(f"{seed}-{number}")
            path = keep / f"{seed}-{number}.jsonl"
            path.write_bytes(spoil_episode(draw, draw.choice(good)))
            ask = draw.random() < ASKED_SHARE
            result = came_out(lambda path=path, ask=ask: read(path, engine, ask))  # type: ignore[misc]
            outcomes[result] += 1
            if result.startswith("!"):
                print(f"{path}: {result}", file=sys.stderr)
            else:
                path.unlink()
    return outcomes
