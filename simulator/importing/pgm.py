"""Grey images in the portable grey-map format (.pgm): P2, with numbers as text, and P5, with bytes.

    file    = "P2" | "P5", width, height, greatest value, values from the north-west corner row by row
    comment = "#" to the end of the line, wherever blanks may stand in the head (and in P2 among the values)

Values above 255 have two bytes in P5, the high one first. The greatest value is 1 to 65535.
"""

import re
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from utak.kb.language.diagnostics import BadInputError, SourceSpan
from utak.kb.language.source_text import Source

MAX_IMAGE_PIXELS = 1 << 25  # pixels of an image that is read: 8192 x 4096; a convention
MAX_TEXT_BYTES_A_PIXEL, MAX_COMMENT_BYTES = 16, 100_000  # bytes of P2, blanks and comments included; a convention
MAX_PGM_VALUE = 65535  # by the format
GAP = re.compile(r"(?:[ \t\r\n\v\f]|#[^\r\n]*)*")  # blanks and comments
TOKEN = re.compile(r"[^ \t\r\n\v\f#]+")
COMMENT = re.compile(r"#[^\r\n]*")
NO_VALUE = re.compile(r"[^ \t\r\n\v\f]*(?:[^0-9 \t\r\n\v\f]|(?<![0-9])[0-9]{10})")  # up to what makes a word no number
MAX_PGM_DIGITS = 9  # digits of a number; more are refused before they are calculated with


class GreyImage(NamedTuple):
    """A grey image."""

    values: npt.NDArray[np.int32]  # (rows, columns) int32, row 0 in the SOUTH
    greatest: int  # the greatest value that a pixel may have


def parse_pgm(source: Source) -> GreyImage:
    """Return the image that the bytes of a file describe."""
    kind = source.text[:2]
    if kind not in ("P2", "P5"):
        hint = "ROS maps are .pgm files of kind P2 or P5: save the image as one"
        raise BadInputError([source.problem(source.start(), "the image does not begin with P2 or P5", hint)])
    at, found = 2, []
    for name, low, high in (("width", 1, 10**8), ("height", 1, 10**8), ("greatest value", 1, MAX_PGM_VALUE)):
        value, at = _number(source, at, name, low, high)
        found.append(value)
    width, height, greatest = found
    if width * height > MAX_IMAGE_PIXELS:
        what = f"an image of {width} x {height} pixels, more than {MAX_IMAGE_PIXELS}"
        raise BadInputError([source.problem(source.start(), what)])
    read = _text_values if kind == "P2" else _byte_values
    values = read(source, at, width * height, greatest)
    return GreyImage(np.ascontiguousarray(values.reshape(height, width)[::-1]), greatest)


def _number(source: Source, at: int, name: str, low: int, high: int) -> tuple[int, int]:
    """Return the next number and the index of the character after it; raise BadInputError unless it is in bounds."""
    gap = GAP.match(source.text, at)
    assert gap is not None
    word = TOKEN.match(source.text, gap.end())
    if word is None:
        raise _wrong(source, len(source.text), len(source.text), f"the {name} is missing: the file ends before it")
    text = word.group()
    if gap.end() == at or not (text.isascii() and text.isdecimal() and len(text) <= MAX_PGM_DIGITS):
        raise _wrong(source, word.start(), word.end(), f"the {name} must be a whole number, not {text[:20]!r}")
    if not low <= int(text) <= high:
        raise _wrong(source, word.start(), word.end(), f"the {name} must be from {low} to {high}, not {text}")
    return int(text), word.end()


def _text_values(source: Source, at: int, count: int, greatest: int) -> npt.NDArray[np.int32]:
    """Return the values of P2, (count,) int32; raise BadInputError when there are others."""
    if len(source.text) - at > MAX_TEXT_BYTES_A_PIXEL * count + MAX_COMMENT_BYTES:
        raise _wrong(source, at, at, f"more text than {count} pixels need")
    text = COMMENT.sub(lambda found: " " * len(found[0]), source.text[at:])  # places stay where they are
    wrong = NO_VALUE.search(text)
    if wrong is not None:
        place = wrong.start()
    else:
        values = np.fromstring(text, np.int32, sep=" ") if text.strip() else np.zeros(0, np.int32)
        above = np.flatnonzero(values[:count] > greatest)
        if len(values) == count and not len(above):
            return values
        index = int(above[0]) if len(above) else count
        filled = np.frombuffer(text.encode("latin-1"), np.uint8) > ord(" ")
        starts = np.flatnonzero(filled & ~np.append(False, filled[:-1]))
        place = int(starts[index]) if index < len(values) else len(text)
        if index == count < len(values):
            raise _wrong(source, at + place, at + place, f"more than {count} pixels")
    _number(source, at + place - (place < len(text)), "value of a pixel", 0, greatest)  # says what is wrong there
    raise AssertionError(place)


def _byte_values(source: Source, at: int, count: int, greatest: int) -> npt.NDArray[np.int32]:
    """Return the values of P5, (count,) int32; raise BadInputError when bytes are missing or left over."""
    raw = source.text[at + 1 :].encode("latin-1")
    size = 1 if greatest < 256 else 2
    if source.text[at : at + 1] not in tuple(" \t\r\n") or len(raw) < count * size:
        end = len(source.text)
        what = f"the image ends too early: {count * size} bytes of pixels are wanted, {len(raw)} are there"
        raise _wrong(source, end, end, what)
    if len(raw) > count * size and raw[count * size :].strip():
        raise _wrong(source, at + 1 + count * size, at + 1 + count * size, "bytes after the last pixel")
    values = np.frombuffer(raw, ">u1" if size == 1 else ">u2", count).astype(np.int32)
    if values.max() > greatest:
        first = int(np.argmax(values > greatest))
        place = at + 1 + first * size
        raise _wrong(source, place, place + size, f"a pixel of {values[first]}, above the greatest value {greatest}")
    return values


def _wrong(source: Source, start: int, end: int, what: str) -> BadInputError:
    """Return the error `what` about the characters from `start` up to `end` of the file."""
    line = source.text.count("\n", 0, start) + 1
    first = start - (source.text.rfind("\n", 0, start) + 1)
    return BadInputError([source.problem(SourceSpan(line, first + 1, first + max(1, end - start)), what)])
