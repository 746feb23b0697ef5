"""The standard streams: control characters are escaped in all output, and errors of writing are reported."""

import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

# Control characters except the line end, marks that change the direction of text, line separators, undecoded bytes.
UNSAFE_CHARACTERS = re.compile(
    "[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]"
)


class StreamError(Exception):
    """A standard stream is closed, full or unreadable; the message names it."""


def escape_controls(text: str) -> str:
    r"""Return a text with all characters that control a terminal written as JSON escapes.

    Examples
    --------
    >>> escape_controls("red \x1b[31m")
    'red \\u001b[31m'
    """
    return UNSAFE_CHARACTERS.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def one_line(text: str) -> str:
    """Return a text on one line, with all characters that control a terminal written as escapes."""
    return escape_controls(text).replace("\n", "\\n")


class GuardedStream:
    """A text stream that escapes control characters and reports errors of writing."""

    def __init__(self, stream: Any, name: str, vital: bool) -> None:
        self._stream, self._name, self._vital = stream, name, vital
        self.lost = ""

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the stream itself."""
        return getattr(self._stream, name)

    def isatty(self) -> bool:
        """Return whether the stream is a terminal."""
        return self._stream is not None and self._stream.isatty()

    def write(self, text: str) -> int:
        """Write a text; characters that the stream's encoding lacks are written as escapes."""
        clean = escape_controls(text)
        encoding = getattr(self._stream, "encoding", None) or "utf-8"
        self._attempt("write", clean.encode(encoding, "backslashreplace").decode(encoding))
        return len(text)

    def writelines(self, lines: Iterator[str]) -> None:
        """Write some texts."""
        for line in lines:
            self.write(line)

    def erase_rows(self, count: int) -> None:
        """Move the cursor of a terminal up by some rows, to the first column, and erase what is from there on."""
        self._attempt("write", f"\x1b[{count}F\x1b[J")

    def flush(self) -> None:
        """Flush the stream."""
        if self._stream is not None:
            self._attempt("flush")

    def _attempt(self, what: str, *arguments: str) -> None:
        """Call a method of the stream and handle its errors."""
        if self.lost or (self._stream is None and not self._vital):
            return
        try:
            if self._stream is None:
                raise OSError(0, "it is closed")
            getattr(self._stream, what)(*arguments)
        except BrokenPipeError:
            self._abandon("its reader went away")
            if self._vital:
                raise
        except (OSError, ValueError) as error:
            self._abandon(getattr(error, "strerror", None) or str(error))
            if self._vital:
                raise StreamError(f"{self._name} cannot be written: {self.lost}") from None

    def _abandon(self, why: str) -> None:
        """Redirect further output to the null device, so that nothing fails when the process ends."""
        self.lost = why
        with suppress(OSError, ValueError, AttributeError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())
            os.close(nowhere)


@contextmanager
def guard_streams() -> Iterator[tuple[GuardedStream, GuardedStream]]:
    """Guard the standard output and the standard error inside a `with` block; yield both."""
    before = sys.stdout, sys.stderr
    out, err = (
        GuardedStream(sys.stdout, "the standard output", True),
        GuardedStream(sys.stderr, "the standard error", False),
    )
    sys.stdout, sys.stderr = out, err
    try:
        yield out, err
    finally:
        sys.stdout, sys.stderr = before


def open_missing_streams() -> None:
    """Open the standard streams that are closed on the null device, so that no other file gets their numbers."""
    with suppress(OSError):
        while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
            pass
        os.close(handle)
