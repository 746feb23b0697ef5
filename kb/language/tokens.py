"""Tokens of a fact file: names, variables, numbers, strings and punctuation marks, each with its place."""

import re
from collections.abc import Iterator
from typing import NamedTuple

from utak.kb.language.diagnostics import Problem, SourceSpan
from utak.kb.language.source_text import Source

# Every character of a text belongs to exactly one match; the name of its group is its kind.
TOKEN_PATTERN = re.compile(
    r"""
    (?P<space>[ \t\r\n]+)
  | (?P<block>%\*)
  | (?P<comment>%[^\n]*)
  | (?P<string>"(?:[^"\\\n]|\\[^\n])*")
  | (?P<open>"[^\n]*)
  | (?P<number>[0-9]+)
  | (?P<name>_*[a-z][A-Za-z0-9_']*)
  | (?P<variable>_*[A-Z][A-Za-z0-9_']*|_+)
  | (?P<directive>\#[a-z_]*)
  | (?P<mark>:-|:~|\.\.|\*\*|!=|<=|>=|.)
    """,
    re.VERBOSE,
)
BLOCK_COMMENT_MARK = re.compile(r"%\*|\*%")  # the begin or the end of a block comment


class Token(NamedTuple):
    """One token."""

    # `name`, `variable`, `number`, `string`, `directive`, `mark`, `comment`, `open` (a string that is not closed) or
    # `end`
    kind: str
    text: str  # the characters as they stand in the source
    span: SourceSpan  # the place in the source, one line with columns from 1

    @property
    def in_words(self) -> str:
        """The token as messages show it: its text, cut to 40 characters; or `the end of the file`."""
        if self.kind == "end":
            return "the end of the file"
        return self.text if len(self.text) <= 40 else f"{self.text[:37]}..."


def tokenize(source: Source, problems: list[Problem], comments: bool = False) -> Iterator[Token]:
    """Yield the tokens of a text, without blanks and comments; the last one has the kind `end` and the text ''."""
    text, at, line, begin = source.text, 0, 1, 0
    while at < len(text):
        match = TOKEN_PATTERN.match(text, at)
        assert match is not None  # every character but a line end is at least a mark, and line ends are spaces
        kind, end = match.lastgroup or "", match.end()
        span = SourceSpan(line, at - begin + 1, end - begin)
        if kind == "block":
            end = _block_end(text, at)
            if end < 0:
                problems.append(source.problem(span, "this comment is never closed", "close it with *%"))
                end = len(text)
        elif kind == "open":
            problems.append(source.problem(span, "this string is not closed on its line", 'close it with "'))
            yield Token(kind, match.group(), span)
        elif kind != "space" and (kind != "comment" or comments):
            yield Token(kind, match.group(), span)
        breaks = text.count("\n", at, end)
        if breaks:
            line, begin = line + breaks, text.rindex("\n", at, end) + 1
        at = end
    yield Token("end", "", SourceSpan(line, max(1, at - begin), max(1, at - begin)))


def _block_end(text: str, start: int) -> int:
    """Return the index after the block comment that begins at `start` (comments nest); -1 when it is never closed."""
    depth = 0
    for edge in BLOCK_COMMENT_MARK.finditer(text, start):
        depth += 1 if edge.group() == "%*" else -1
        if depth == 0:
            return edge.end()
    return -1
