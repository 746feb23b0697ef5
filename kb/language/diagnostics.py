"""Problems in files that the user wrote: the place, the message and a hint."""

import re
from collections.abc import Iterable
from typing import NamedTuple

MAX_PROBLEMS_SHOWN = 20  # problems printed at once (docs/files.md)
MAX_PROBLEMS_PER_FILE = 100  # the search for more problems in a file ends here; a convention
LINE_END = re.compile(r"[\n\r\x0b\x0c\x85\u2028\u2029]")  # what ends a line of text
MAX_SOURCE_LINE_WIDTH = 120  # characters of a source line that a message shows; a convention


class SourceSpan(NamedTuple):
    """A range of columns on one line of a source; lines and columns count from 1, in characters."""

    line: int  # the line
    start: int  # the first column, from 1
    end: int  # the last column, which belongs to the range


class Problem(NamedTuple):
    """One error in a user's file."""

    file: str  # the file's name as the user gave it
    span: SourceSpan  # the place of the error
    what: str  # the error message, without its place
    source: str = ""  # the text of the whole line at `span`; '' when it is not shown
    hint: str = ""  # a remedy, or '' for none

    def __str__(self) -> str:
        """Return `file:line:col-col: error: what`, then the source line, a line of carets under the place, the hint."""
        line, start, end = self.span
        text = [f"{_on_one_line(self.file)}:{line}:{start}-{end}: error: {self.what}"]
        if self.source:
            shown, left = _window(self.source, start)
            carets = max(1, min(end, left + len(shown)) - start + 1)
            text += [f"  {shown}", "  " + " " * (start - 1 - left) + "^" * carets]
        if self.hint:
            text.append(f"  hint: {self.hint}")
        return "\n".join(text)


class BadInputError(Exception):
    """A user's file has errors; its text is that of the problems (see `format_problems`)."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__(format_problems(self.problems))

    @classmethod
    def at(cls, file: str, what: str, hint: str = "", line: int = 1, column: int = 1) -> "BadInputError":
        """Return, not raise, one error at a place of a file whose text is not shown."""
        return cls([Problem(file, SourceSpan(line, column, column), what, hint=hint)])

    @classmethod
    def about(cls, file: str, text: str, what: str, hint: str = "") -> "BadInputError":
        """Return, not raise, one error about a whole text of one line, which is shown."""
        return cls([Problem(file, SourceSpan(1, 1, max(1, len(text))), what, text, hint)])


class CannotOpenError(Exception):
    """A user's file cannot be opened or read."""

    def __init__(self, path: str, why: str) -> None:
        self.path, self.why = path, why
        super().__init__(f"{_on_one_line(path)}: cannot open: {why}")


def format_problems(problems: Iterable[Problem]) -> str:
    """Return the first `MAX_PROBLEMS_SHOWN` problems as text, and the last line `... and more` when there are more."""
    every = list(problems)
    text = [str(problem) for problem in every[:MAX_PROBLEMS_SHOWN]]
    if len(every) > MAX_PROBLEMS_SHOWN:
        text.append("... and more")
    return "\n".join(text)


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return the hint "did you mean X?" for the word X of `known` most similar to `word`."""
    import difflib  # only when something is misspelt

    near = difflib.get_close_matches(word[:80], sorted(known), n=1, cutoff=0.6)
    return f"did you mean {near[0]}?" if near else ""


def _on_one_line(name: str) -> str:
    """Return the name of a file with the ends of lines in it written out, so that no name begins a line of its own."""
    return LINE_END.sub(lambda match: f"\\u{ord(match[0]):04x}", name)


def _window(source: str, start: int) -> tuple[str, int]:
    """Return the part of a long line around column `start` (from 1), and how many characters were cut on its left."""
    left = 0 if len(source) <= MAX_SOURCE_LINE_WIDTH else max(0, start - 1 - MAX_SOURCE_LINE_WIDTH // 3)
    shown = source[left : left + MAX_SOURCE_LINE_WIDTH]
    return "".join(c if " " <= c <= "~" else " " if c == "\t" else "?" for c in shown), left
