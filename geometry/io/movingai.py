"""Maps of the Moving AI benchmarks (Sturtevant 2012).

    file = head "map" row { row } blank lines
    head = { "type" word | "height" number | "width" number }     each once, a line each, in any order

Words of the head are separated by blanks or tabs, and blanks or tabs may end any line; lines end in LF or CR LF. There
are `height` rows of `width` squares, and only blank lines follow. A map's first row of text is its north edge; screens
have row 0 in the south, so rows are reversed.
"""

import re
from codecs import BOM_UTF8
from itertools import islice

import numpy as np

from utak.geometry.kernels.arrays import Bools

PASSABLE_LETTERS = ".GS"
MAP_LETTERS = PASSABLE_LETTERS + "@OTW"
HEADER_FIELDS = ("type", "height", "width")
NO_HEADER = "this is no line of a head ('type W', 'height N', 'width N'), and 'map' is missing before it"
MAX_HEADER_DIGITS = 9  # digits of a number in the head; derived: no file has room for more rows, or squares in a row
HEADER_WORD = re.compile(r"[^ \t]+")


class MapError(ValueError):
    """An error in the text of a map; its message is "line:column-end: error: what"."""

    def __init__(self, line: int, column: int, what: str, end: int | None = None) -> None:
        self.line, self.column, self.end, self.what = line, column, max(column, end or column), what
        super().__init__(f"{line}:{column}-{self.end}: error: {what}")


def parse_map(raw: bytes) -> Bools:
    r"""Return the free squares of the map that these bytes describe, (rows, columns) bool, row 0 in the south.

    The first row of text is the north edge. The letters ``.``, ``G`` and ``S`` are free (True), ``@``, ``O``, ``T`` and
    ``W`` are not.

    Parameters
    ----------
    raw : the content of a file in the format of the Moving AI benchmarks (lines `type`, `height N`, `width N`, then
        `map` and the rows of text). A byte order mark of UTF-8 before it counts for nothing.

    Raises
    ------
    MapError : when they describe none: at the first line, counted from 1, that goes wrong.

    Examples
    --------
    >>> parse_map(b"type octile\nheight 2\nwidth 3\nmap\n..@\n.@.\n").tolist()
    [[True, False, True], [True, True, False]]
    """
    text = raw.removeprefix(BOM_UTF8).decode("latin-1")
    lines = [line.removesuffix("\r").rstrip(" \t") for line in text.split("\n")]
    first, height, width = _header(lines)
    rows = lines[first : first + height]
    while rows and not rows[-1]:
        rows.pop()
    for number, row in enumerate(rows, first + 1):
        _check_row(number, row, width)
    if len(rows) < height:
        raise MapError(first + len(rows), 1, f"the map has {len(rows)} rows, not {height}")
    for number, line in enumerate(lines[first + height :], first + height + 1):
        if line:
            raise MapError(number, 1, f"the map has more than {height} rows", len(line))
    return np.array([[square in PASSABLE_LETTERS for square in row] for row in reversed(rows)], np.bool_)


def _header(lines: list[str]) -> tuple[int, int, int]:
    """Return the number of lines before the first row ("map" included), the height and the width in squares."""
    found: dict[str, int] = {}
    for number, line in enumerate(lines, 1):
        words = list(islice(HEADER_WORD.finditer(line), 3))  # a name, a value, and what is one too many
        if [word.group() for word in words] == ["map"]:
            for name in HEADER_FIELDS[1:]:
                if name not in found:
                    raise MapError(number, 1, f"a line that says '{name} N' is missing before this one")
            return number, found["height"], found["width"]
        if not words or words[0].group() not in HEADER_FIELDS:
            at = words[0].start() + 1 if words else 1
            raise MapError(number, at, NO_HEADER, len(line))
        name = words[0].group()
        if name in found:
            raise MapError(number, words[0].start() + 1, f"{name} is given twice", words[0].end())
        if len(words) != 2:
            at = words[2].start() + 1 if len(words) > 2 else len(line)
            raise MapError(number, at, f"one word was expected after {name}", len(line))
        found[name] = 0 if name == "type" else _number(number, name, words[1])
    raise MapError(len(lines), 1, "a line that says 'map' is missing")


def _number(line: int, name: str, word: "re.Match[str]") -> int:
    """Return the whole number above 0 that a word of the head gives, or raise MapError when it gives none."""
    text = word.group()
    if not re.fullmatch("[0-9]+", text) or len(text) > MAX_HEADER_DIGITS or int(text) == 0:
        raise MapError(line, word.start() + 1, f"{name} must be a whole number above 0, not {text[:20]!r}", word.end())
    return int(text)


def _check_row(number: int, row: str, width: int) -> None:
    """Raise MapError when a row has unknown letters or another width; return nothing."""
    for column, square in enumerate(row[:width], 1):
        if square not in MAP_LETTERS:
            raise MapError(number, column, f"unknown square {square!r}; known are {' '.join(MAP_LETTERS)}")
    if len(row) != width:
        raise MapError(number, min(len(row), width) + 1, f"the row has {len(row)} squares, not {width}", len(row))
