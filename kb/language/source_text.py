"""The text of a user's file, read safely: no waiting, no more bytes than needed, ASCII only."""

import os
import stat
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from utak.kb.language.diagnostics import MAX_PROBLEMS_PER_FILE, BadInputError, CannotOpenError, Problem, SourceSpan
from utak.kb.language.operating_system import READ_FLAGS

MAX_FILE_BYTES = 4_000_000  # bytes of a user's file (docs/files.md)
PIECE_BYTES = 1 << 20  # bytes that are read at once; a convention
# Byte order marks at the start of files that are not ASCII, and how messages name them.
UNSUPPORTED_ENCODINGS = {b"\xff\xfe": "UTF-16", b"\xfe\xff": "UTF-16", b"\xef\xbb\xbf": "a UTF-8 byte order mark"}
TYPOGRAPHIC_QUOTES = "\u2018\u2019\u201a\u201b\u201c\u201d\u201e\u201f"  # quotes that word processors write
# The message in the place of every other one about a hidden text.
HIDDEN_TEXT_MESSAGE = "not as it must be; it leads out of its folder, so nothing of its text is shown"
UNUSUAL_SPACES = "\u00a0\u2002\u2003\u2009\u200b\u202f\u3000"  # blanks that look like a space and are none


@dataclass(frozen=True)
class Source:
    """The text of a user's file."""

    file: str  # the file's name as the user gave it
    # The whole text; printable ASCII, tabs and line ends when `source_from_bytes` accepted it
    text: str = field(repr=False)
    # Whether the file is a link that leads out of its folder. Then messages show none of its text, because the author
    # of the link may have no right to read the file.
    hide_text: bool = False

    @cached_property
    def lines(self) -> list[str]:
        """The lines of the text, without line ends; line n of a span is at index n - 1."""
        return [line.removesuffix("\r") for line in self.text.split("\n")]

    def problem(self, span: SourceSpan, what: str, hint: str = "") -> Problem:
        """Return the problem `what` at `span`, with the file's name, the source line and the hint ('' for none)."""
        if self.hide_text:
            return Problem(
                self.file, span, HIDDEN_TEXT_MESSAGE, hint="check the file that it leads to, or copy it into the folder"
            )
        source = self.lines[span.line - 1] if span.line <= len(self.lines) else ""
        return Problem(self.file, span, what, source, hint)

    def start(self) -> SourceSpan:
        """Return line 1, column 1 of the file, the place of problems that concern the whole file."""
        return SourceSpan(1, 1, 1)


def read_source(path: Path | str) -> Source:
    """Read a text file."""
    return source_from_bytes(str(path), read_bytes(str(path), MAX_FILE_BYTES), lies_outside(path))


def lies_outside(path: Path | str, folder: Path | str | None = None) -> bool:
    """Return whether a file lies outside of a folder when all links are followed; subfolders count as inside."""
    named = os.path.abspath(path)  # noqa: PTH100 (a link in the folder's own name is not followed yet)
    home = os.path.realpath(folder if folder is not None else os.path.dirname(named))  # noqa: PTH120
    return not os.path.realpath(named).startswith(os.path.join(home, ""))  # noqa: PTH118


def source_from_bytes(file: str, raw: bytes, hide_text: bool = False) -> Source:
    """Return the text of a file's bytes, checked to be ASCII."""
    if len(raw) > MAX_FILE_BYTES:
        raise BadInputError([Problem(file, SourceSpan(1, 1, 1), f"the file is larger than {MAX_FILE_BYTES} bytes")])
    for mark, name in UNSUPPORTED_ENCODINGS.items():
        if raw.startswith(mark):
            hint = "save the file as plain ASCII (or UTF-8 without byte order mark)"
            raise BadInputError([Problem(file, SourceSpan(1, 1, 1), f"the file begins with {name}", hint=hint)])
    source = Source(file, raw.decode("utf-8", errors="surrogateescape"), hide_text)
    problems = _disallowed_characters(source)
    if problems:
        raise BadInputError(problems)
    return source


def read_bytes(path: str, most: int) -> bytes:
    """Return the bytes of a regular file."""
    try:
        handle = os.open(path, READ_FLAGS)
    except (OSError, ValueError) as error:
        raise CannotOpenError(path, getattr(error, "strerror", None) or str(error)) from None
    try:
        mode = os.fstat(handle).st_mode
        if not stat.S_ISREG(mode):
            raise CannotOpenError(path, "it is a directory" if stat.S_ISDIR(mode) else "it is no regular file")
        with os.fdopen(handle, "rb", closefd=False) as stream:
            pieces: list[bytes] = []  # one call for `most` bytes would reserve them all, however small the file is
            while (left := most + 1 - PIECE_BYTES * len(pieces)) > 0 and (piece := stream.read(min(left, PIECE_BYTES))):
                pieces.append(piece)
            return b"".join(pieces)
    except OSError as error:
        raise CannotOpenError(path, error.strerror or str(error)) from None
    finally:
        os.close(handle)


def _disallowed_characters(source: Source) -> list[Problem]:
    """Return one problem for each run of equal characters on a line that are not allowed in users' text files."""
    if source.text.isascii() and source.text.translate(_ALLOWED) == "":
        return []
    problems: list[Problem] = []
    for number, line in enumerate(source.lines, 1):
        if line.isascii() and line.translate(_ALLOWED) == "":
            continue
        column = 1
        while column <= len(line) and len(problems) < MAX_PROBLEMS_PER_FILE:
            char = line[column - 1]
            if " " <= char <= "~" or char == "\t":
                column += 1
                continue
            end = column
            while end < len(line) and line[end] == char:
                end += 1
            problems.append(source.problem(SourceSpan(number, column, end), *_character_and_remedy(char)))
            column = end + 1
    return problems


def _character_and_remedy(char: str) -> tuple[str, str]:
    """Return the description of a character that is not allowed, and a hint: what it is, and the remedy."""
    code = ord(char)
    if char in TYPOGRAPHIC_QUOTES:
        return f"a typographic quotation mark (U+{code:04X})", 'write plain " quotes'
    if char in UNUSUAL_SPACES:
        return f"a space that is no plain space (U+{code:04X})", "write a plain space"
    if 0xDC80 <= code <= 0xDCFF:
        return f"the byte 0x{code - 0xDC00:02X}, which is not ASCII", "save the file as plain ASCII"
    if code < 128:
        hint = "is the file UTF-16? save it as plain ASCII" if code == 0 else "remove it"
        return f"a control character (0x{code:02X})", hint
    return f"a character that is not ASCII (U+{code:04X})", "use ASCII characters alone, in comments too"


_ALLOWED = dict.fromkeys([9, 10, 13, *range(32, 127)])
