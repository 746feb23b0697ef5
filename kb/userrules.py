"""The user's own rules (`--kb FILE`) beside our encodings, worked on in a process that can be killed (kb.worker).

Clingo cannot be stopped while it grounds, and some bytes kill it. So a rule that never ends, needs too much memory or
is no rule at all is an error of its file, and nothing worse.
"""

import atexit
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import clingo

from kb.problems import BadInputError, Span
from kb.source import Source, read_source
from kb.worker import Worker

SECONDS = 10.0  # of work on one question with the user's rules
PLACE = re.compile(r"<\w+>:(\d+):(\d+)(?:-(?:\d+:)?(\d+))?: (?:error|info|warning): (.*)", re.DOTALL)


def solve_apart(ours: Sequence[Path], users: Sequence[Path], facts: Sequence[str]) -> list[clingo.Symbol] | None:
    """The shown atoms of the best answer set, or None when there is none; as kb.encodings.solve, in another process.

    Raises BadInputError when the users' rules are none, take too long or too much memory, and CannotOpenError.
    """
    sources = [read_source(path) for path in users]
    program = "\n".join([*(path.read_text() for path in ours), *(f"{fact}." for fact in facts)])
    rules = "\n".join(source.text.rstrip("\n") for source in sources)
    found = _worker().exchange({"program": program, "rules": rules, "seconds": SECONDS / 2}, SECONDS)
    if "limit" in found:
        raise _problem(sources[0], sources[0].start(), f"these rules were given up: {found['limit']}")
    if "error" in found:
        raise _located(sources, found["error"])
    atoms = found["atoms"]
    return None if atoms is None else [clingo.parse_term(text) for text in atoms]


@cache
def _worker() -> Worker:
    worker = Worker()
    atexit.register(worker.close)
    return worker


def _located(sources: Sequence[Source], message: str) -> BadInputError:
    """The error at the place in the user's file of which clingo speaks."""
    place = PLACE.search(message)
    if place is None:
        return _problem(sources[0], sources[0].start(), " ".join(message.split()))
    line, start, end = int(place[1]), int(place[2]), int(place[3] or place[2])
    for source in sources:
        lines = source.text.rstrip("\n").count("\n") + 1
        if line <= lines:
            return _problem(source, Span(line, start, max(start, end - 1)), " ".join(place[4].split()))
        line -= lines
    return _problem(sources[-1], sources[-1].start(), " ".join(place[4].split()))


def _problem(source: Source, span: Span, what: str) -> BadInputError:
    hint = "declare what is given elsewhere, such as #defined kind/3." if "does not occur" in what else ""
    return BadInputError([source.problem(span, what, hint)])
