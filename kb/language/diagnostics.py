"""What is wrong with a file that the user wrote: where, what, and how to put it right."""

from collections.abc import Iterable
from typing import NamedTuple

AT_MOST = 20  # problems shown in one go
ENOUGH = 100  # problems of one file after which no more are looked for
WIDTH = 120  # characters of a source line that are shown


class Span(NamedTuple):
    """A stretch of one source line; lines and columns count from 1 in characters, `end` is the last column."""

    line: int
    start: int
    end: int


class Problem(NamedTuple):
    """One thing wrong: the file as the user named it, where, what, the source line, and a hint or ''."""

    file: str
    span: Span
    what: str
    source: str = ""
    hint: str = ""

    def __str__(self) -> str:
        """Return `file:line:col-col: error: what`, the source line, a caret and the hint."""
        line, start, end = self.span
        text = [f"{self.file}:{line}:{start}-{end}: error: {self.what}"]
        if self.source:
            shown, left = _window(self.source, start)
            carets = max(1, min(end, left + len(shown)) - start + 1)
            text += [f"  {shown}", "  " + " " * (start - 1 - left) + "^" * carets]
        if self.hint:
            text.append(f"  hint: {self.hint}")
        return "\n".join(text)


class BadInputError(Exception):
    """A file of the user's is not as it must be; carries every problem found, in the order of the files."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__(render(self.problems))


class CannotOpenError(Exception):
    """A file of the user's cannot be opened or read at all."""

    def __init__(self, path: str, why: str) -> None:
        self.path, self.why = path, why
        super().__init__(f"{path}: cannot open: {why}")


def render(problems: Iterable[Problem]) -> str:
    """Return the first 20 problems as text, and whether there are more."""
    every = list(problems)
    text = [str(problem) for problem in every[:AT_MOST]]
    if len(every) > AT_MOST:
        text.append("... and more")
    return "\n".join(text)


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return a hint that names the known word most like `word`, or '' when none is like it."""
    import difflib  # only when something is misspelt

    near = difflib.get_close_matches(word[:80], sorted(known), n=1, cutoff=0.6)
    return f"did you mean {near[0]}?" if near else ""


def _window(source: str, start: int) -> tuple[str, int]:
    """Return the part of a long line around column `start`, and how many characters were cut off on its left."""
    clean = "".join(c if " " <= c <= "~" else " " if c == "\t" else "?" for c in source)
    left = 0 if len(clean) <= WIDTH else max(0, start - 1 - WIDTH // 3)
    return clean[left : left + WIDTH], left
