"""Files that are written: a file of another kind is never overwritten, and no two processes write to one file."""

import os
import re
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from kb.language.diagnostics import CannotOpenError
from kb.language.operating_system import WRITE_FLAGS, lock_file

HEAD_BYTES = 4096  # first bytes of a file, from which its kind is told
EPISODE_START = b'{"utak":"episode"'  # the first bytes of every episode
Kind = Callable[[bytes], bool]  # whether a file with these first bytes may be overwritten


def is_episode(head: bytes) -> bool:
    """Return whether a file with these first bytes is an episode, even when its first line was cut short."""
    return bool(re.match(rb'\s*\{\s*"utak"\s*:\s*"episode"', head)) or EPISODE_START.startswith(head)


def is_json_lines(head: bytes) -> bool:
    """Return whether a file with these first bytes holds JSON objects."""
    return head.lstrip().startswith(b"{")


def is_svg(head: bytes) -> bool:
    """Return whether a file with these first bytes is an SVG picture."""
    return re.match(rb"\s*(<\?xml[^>]*>\s*)?(<!--.*?-->\s*|<!DOCTYPE[^>]*>\s*)*<svg\b", head, re.DOTALL) is not None


def is_junit(head: bytes) -> bool:
    """Return whether a file with these first bytes holds the outcomes of tests as JUnit XML."""
    return re.match(rb"\s*(<\?xml[^>]*>\s*)?<testsuites?\b", head) is not None


def open_for_writing(path: Path | str, kind: Kind, name: str, force: bool = False) -> BinaryIO:
    """Return a file for writing, positioned at its start, with its contents kept; a new file is made if needed.

    The file is locked until it is closed. A pipe or a device is returned as it is.

    Parameters
    ----------
    path : the file.
    kind : returns whether a file with given first bytes may be overwritten. An empty file always may.
    name : the name of this kind of file, for the message.
    force : whether to overwrite a file of any kind.

    Returns
    -------
    The binary stream.

    Raises
    ------
    CannotOpenError : the file cannot be written, is of another kind, or another process writes to it.
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
    """Return the reason why a file must not be written; '' when it may."""
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
    """Cut a file after its first `size` bytes and continue there; no effect on a pipe or a device."""
    if stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
        stream.truncate(size)
        stream.seek(size)


def write_whole(path: Path | str, text: str, kind: Kind, name: str, force: bool = False) -> None:
    """Write a text as a file, encoded as UTF-8.

    Parameters
    ----------
    path : the file.
    text : the whole new contents.
    kind, name, force : which files may be overwritten, as for `open_for_writing`.

    Raises
    ------
    CannotOpenError : the file cannot be written, is of another kind, or another process writes to it.
    """
    stream = open_for_writing(path, kind, name, force)
    try:
        keep_first(stream, 0)
        stream.write(text.encode("utf-8"))
        stream.flush()
    except OSError as error:
        raise CannotOpenError(str(path), f"it cannot be written: {error.strerror}") from None
    finally:
        with suppress(OSError):  # reported above
            stream.close()
