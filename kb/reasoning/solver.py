"""The one place where encodings meet clingo: files by absolute path, facts as text, every message an error.

Facts come from our own values, never as raw text from a user; with a user's own rules (`--kb`) all is worked on in
another process, by kb.reasoning.user_rules.
"""

from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path

import clingo

KB = Path(__file__).resolve().parent.parent / "asp"
OURS = (KB, KB.parent.parent / "planner" / "asp")


class EncodingError(Exception):
    """An encoding is wrong, or contradicts the facts: a fault of ours or of the user's own rules."""


def solve(files: Sequence[Path], facts: Iterable[str], seconds: float = 20.0) -> list[clingo.Symbol] | None:
    """The shown atoms of the best answer set found, in the order of their text; None when there is none.

    The same files and facts are answered from memory: an answer depends on nothing else.

    Parameters
    ----------
    files : paths of the encodings.
    facts : atoms without the full stop.
    seconds : the search stops then, with the best answer so far.

    Raises EncodingError on any message of clingo, and BadInputError where files that are not ours cause one.
    """
    answer = _answer(tuple(files), tuple(facts), seconds)
    return None if answer is None else list(answer)


@lru_cache(maxsize=256)
def _answer(files: tuple[Path, ...], facts: tuple[str, ...], seconds: float) -> tuple[clingo.Symbol, ...] | None:
    users = [path for path in files if path.resolve().parent not in OURS]
    if users:
        from kb.reasoning.user_rules import solve_apart  # only who has rules of his own waits for it

        files = tuple(path for path in files if path not in users)
        found = solve_apart(files, users, facts)
        if found is not None:
            return tuple(sorted(found, key=str))
    messages: list[str] = []
    control = clingo.Control(["--stats=0"], logger=lambda _code, text: messages.append(text), message_limit=20)
    try:
        for path in files:
            control.load(str(path.resolve()))
        control.add("base", [], "".join(f"{fact}.\n" for fact in facts))
        control.ground([("base", [])])
    except RuntimeError as error:
        raise EncodingError("\n".join([*messages, str(error)])) from error
    if messages:
        raise EncodingError("\n".join(messages))
    best: list[clingo.Symbol] | None = None

    def keep(model: clingo.Model) -> None:
        nonlocal best
        best = list(model.symbols(shown=True))

    with control.solve(on_model=keep, async_=True) as handle:
        if not handle.wait(seconds):
            handle.cancel()
        handle.get()
    return None if best is None else tuple(sorted(best, key=str))
