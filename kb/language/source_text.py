"""The text of a file that the user wrote, read with care: never hangs, never reads more than it must, ASCII alone."""

import os
import stat
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from kb.language.diagnostics import ENOUGH, BadInputError, CannotOpenError, Problem, Span
from kb.language.operating_system import READ

LARGEST = 4_000_000  # bytes
WIDE = {b"\xff\xfe": "UTF-16", b"\xfe\xff": "UTF-16", b"\xef\xbb\xbf": "a UTF-8 byte order mark"}
QUOTES = "\u2018\u2019\u201a\u201b\u201c\u201d\u201e\u201f"
HIDDEN = "not as it must be; it is a link out of its folder, so nothing of its text is shown"
SPACES = "\u00a0\u2002\u2003\u2009\u200b\u202f\u3000"


@dataclass(frozen=True)
class Source:
    """A file's name as the user gave it, and its text (ASCII).

    `foreign` is set where the name is a link out of its folder: then nothing of the text is shown, for whoever made the
    link may not be whoever may read the file.
    """

    file: str
    text: str = field(repr=False)
    foreign: bool = False

    @cached_property
    def lines(self) -> list[str]:
        """The text in lines, without their ends."""
        return [line.removesuffix("\r") for line in self.text.split("\n")]

    def problem(self, span: Span, what: str, hint: str = "") -> Problem:
        """Return what is wrong at `span`, with the line it stands on."""
        if self.foreign:
            return Problem(self.file, span, HIDDEN, hint="check the file that it leads to, or copy it into the folder")
        source = self.lines[span.line - 1] if span.line <= len(self.lines) else ""
        return Problem(self.file, span, what, source, hint)

    def start(self) -> Span:
        """The first column of the file, where problems of the whole file are put."""
        return Span(1, 1, 1)


def read_source(path: Path | str) -> Source:
    """Read a text file.

    Raises CannotOpenError for a file that is absent, unreadable or no regular file (a FIFO or a device is not waited
    for), and BadInputError for one that is too big or holds anything but printable ASCII, tabs and line ends.
    """
    return decode(str(path), read_bytes(str(path), LARGEST), leads_out(path))


def leads_out(path: Path | str, folder: Path | str | None = None) -> bool:
    """Return whether a file lies, all links followed, outside of a folder: by default of that in which it is named."""
    named = os.path.abspath(path)  # noqa: PTH100 (a link in the folder's own name is not followed yet)
    home = os.path.realpath(folder if folder is not None else os.path.dirname(named))  # noqa: PTH120
    return not os.path.realpath(named).startswith(os.path.join(home, ""))  # noqa: PTH118


def decode(file: str, raw: bytes, foreign: bool = False) -> Source:
    """Return the text of `raw`, which must be ASCII; raises BadInputError that says what else is there."""
    if len(raw) > LARGEST:
        raise BadInputError([Problem(file, Span(1, 1, 1), f"the file is larger than {LARGEST} bytes")])
    for mark, name in WIDE.items():
        if raw.startswith(mark):
            hint = "save the file as plain ASCII (or UTF-8 without byte order mark)"
            raise BadInputError([Problem(file, Span(1, 1, 1), f"the file begins with {name}", hint=hint)])
    source = Source(file, raw.decode("utf-8", errors="surrogateescape"), foreign)
    problems = _strangers(source)
    if problems:
        raise BadInputError(problems)
    return source


def read_bytes(path: str, most: int) -> bytes:
    """Return the bytes of a regular file, one more than `most` at most; raises CannotOpenError."""
    try:
        handle = os.open(path, READ)
    except (OSError, ValueError) as error:
        raise CannotOpenError(path, getattr(error, "strerror", None) or str(error)) from None
    try:
        mode = os.fstat(handle).st_mode
        if not stat.S_ISREG(mode):
            raise CannotOpenError(path, "it is a directory" if stat.S_ISDIR(mode) else "it is no regular file")
        with os.fdopen(handle, "rb", closefd=False) as stream:
            return stream.read(most + 1)
    except OSError as error:
        raise CannotOpenError(path, error.strerror or str(error)) from None
    finally:
        os.close(handle)


def _strangers(source: Source) -> list[Problem]:
    """One problem for each run of characters that are not allowed in a text file of ours."""
    if source.text.isascii() and source.text.translate(_ALLOWED) == "":
        return []
    problems: list[Problem] = []
    for number, line in enumerate(source.lines, 1):
        if line.isascii() and line.translate(_ALLOWED) == "":
            continue
        column = 1
        while column <= len(line) and len(problems) < ENOUGH:
            char = line[column - 1]
            if " " <= char <= "~" or char == "\t":
                column += 1
                continue
            end = column
            while end < len(line) and line[end] == char:
                end += 1
            problems.append(source.problem(Span(number, column, end), *_name(char)))
            column = end + 1
    return problems


def _name(char: str) -> tuple[str, str]:
    """What a character that is not allowed is, and what to write instead."""
    code = ord(char)
    if char in QUOTES:
        return f"a typographic quotation mark (U+{code:04X})", 'write plain " quotes'
    if char in SPACES:
        return f"a space that is no plain space (U+{code:04X})", "write a plain space"
    if 0xDC80 <= code <= 0xDCFF:
        return f"the byte 0x{code - 0xDC00:02X}, which is not ASCII", "save the file as plain ASCII"
    if code < 128:
        hint = "is the file UTF-16? save it as plain ASCII" if code == 0 else "remove it"
        return f"a control character (0x{code:02X})", hint
    return f"a character that is not ASCII (U+{code:04X})", "use ASCII characters alone, in comments too"


_ALLOWED = dict.fromkeys([9, 10, 13, *range(32, 127)])
