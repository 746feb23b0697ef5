"""Files that are written: nothing of another kind is ever overwritten, and no two write to one at once."""

import os
import re
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from kb.language.diagnostics import CannotOpenError
from kb.language.operating_system import WRITE_FLAGS, lock_file

HEAD_BYTES = 4096  # bytes by which the kind of a file is known
EPISODE_START = b'{"utak":"episode"'
Kind = Callable[[bytes], bool]


def is_episode(head: bytes) -> bool:
    """Return whether a file that begins so is an episode, even one whose first line was cut short."""
    return bool(re.match(rb'\s*\{\s*"utak"\s*:\s*"episode"', head)) or EPISODE_START.startswith(head)


def is_rows(head: bytes) -> bool:
    """Return whether a file that begins so holds JSON objects."""
    return head.lstrip().startswith(b"{")


def is_svg(head: bytes) -> bool:
    """Return whether a file that begins so is an SVG picture."""
    return re.match(rb"\s*(<\?xml[^>]*>\s*)?(<!--.*?-->\s*|<!DOCTYPE[^>]*>\s*)*<svg\b", head, re.DOTALL) is not None


def opened(path: Path | str, kind: Kind, name: str, force: bool = False) -> BinaryIO:
    """Open a file to write, at its beginning, with what it holds; a new one is made. It is locked until it is closed.

    Parameters
    ----------
    kind : whether a file that begins with these bytes may be overwritten; an empty one always may.
    name : of the kind, for the message.
    force : overwrite whatever is there.

    Raises CannotOpenError when it cannot be opened, is of another kind, or another process writes to it. What is no
    regular file, such as a pipe or a device, is opened as it is.
    """
    try:
        if Path(path).exists() and not Path(path).is_file():
            return Path(path).open("wb")
        stream = os.fdopen(os.open(path, WRITE_FLAGS, 0o666), "r+b")
    except (OSError, ValueError) as error:
        raise CannotOpenError(str(path), getattr(error, "strerror", None) or str(error)) from None
    problem = _problem(stream, kind, name, force)
    if problem:
        stream.close()
        raise CannotOpenError(str(path), problem)
    return stream


def _problem(stream: BinaryIO, kind: Kind, name: str, force: bool) -> str:
    """Why a file that was opened is not to be written; else ''."""
    if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
        return "it is no regular file"
    if not lock_file(stream.fileno()):
        return "another process is writing to it"
    head = stream.read(HEAD_BYTES)
    stream.seek(0)
    if head and not force and not kind(head):
        return f"it is no {name}, and is not overwritten without --force"
    return ""


def keep_first(stream: BinaryIO, size: int) -> None:
    """Keep the first bytes of an opened file alone, and go on behind them; nothing is done to what is no file."""
    if stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
        stream.truncate(size)
        stream.seek(size)


def write_whole(path: Path | str, text: str, kind: Kind, name: str, force: bool = False) -> None:
    """Write a file, as `opened` allows it; raises CannotOpenError when it cannot be."""
    stream = opened(path, kind, name, force)
    try:
        keep_first(stream, 0)
        stream.write(text.encode("utf-8"))
        stream.flush()
    except OSError as error:
        raise CannotOpenError(str(path), f"it cannot be written: {error.strerror}") from None
    finally:
        with suppress(OSError):  # which was reported then
            stream.close()
