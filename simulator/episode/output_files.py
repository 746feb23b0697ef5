"""Files that are written: a file of another kind is never overwritten, and no two processes write to one file.

What is written at once is there whole or not at all: the old file stays until the new one is complete. What grows line
by line keeps its old contents until its first line comes.
"""

import os
import re
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from utak.kb.language.diagnostics import CannotOpenError
from utak.kb.language.operating_system import WRITE_FLAGS, lock_file

HEAD_BYTES = 4096  # first bytes of a file, from which its kind is told
EPISODE_START = b'{"utak":"episode"'  # the first bytes of every episode
Kind = Callable[[bytes], bool]  # whether a file with these first bytes may be overwritten


def is_episode(head: bytes) -> bool:
    """Return whether a file with these first bytes is an episode, even when its first line was cut short."""
    return bool(re.match(rb'\s*\{\s*"utak"\s*:\s*"episode"', head)) or EPISODE_START.startswith(head)


def is_svg(head: bytes) -> bool:
    """Return whether a file with these first bytes is an SVG picture."""
    return re.match(rb"<svg\b", after_prologue(head, b"<!DOCTYPE")) is not None


def is_junit(head: bytes) -> bool:
    """Return whether a file with these first bytes holds the outcomes of tests as JUnit XML."""
    return re.match(rb"<testsuites?\b", after_prologue(head)) is not None


def is_gif(head: bytes) -> bool:
    """Return whether a file with these first bytes is a GIF picture."""
    return head.startswith((b"GIF87a", b"GIF89a"))


def after_prologue(head: bytes, *more: bytes) -> bytes:
    """Return XML or HTML without the blanks, comments and declarations before its first tag."""
    ends = {b"<!--": b"-->", b"<?xml": b">", **dict.fromkeys(more, b">")}
    at = 0
    while (found := re.compile(rb"\s*(<!--|<\?xml|<!DOCTYPE)").match(head, at)) and found[1] in ends:
        end = head.find(ends[found[1]], found.end())
        if end < 0:
            return b""
        at = end + len(ends[found[1]])
    return head[at:].lstrip()


def open_for_writing(path: Path | str, kind: Kind, name: str, force: bool = False) -> BinaryIO:
    """Return a file for writing, positioned at its start, with its contents kept; a new file is made if needed."""
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


def check_path(path: Path | str, kind: Kind, name: str, force: bool = False) -> None:
    """Raise CannotOpenError unless a file can be written, as far as can be told; nothing is made or changed."""
    if os.path.lexists(path):
        open_for_writing(path, kind, name, force).close()
        return
    folder = os.path.dirname(os.path.abspath(path))  # noqa: PTH100, PTH120 (a path that is no path is told below)
    if not os.access(folder, os.W_OK | os.X_OK):
        what = "no file can be made in its folder" if os.path.isdir(folder) else "No such file or directory"  # noqa: PTH112
        raise CannotOpenError(str(path), what)


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


def write_whole(path: Path | str, contents: bytes, kind: Kind, name: str, force: bool = False) -> None:
    """Write a file, whole or not at all."""
    stream = None
    try:
        if os.path.lexists(path):
            stream = open_for_writing(path, kind, name, force)
        if stream is None or stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
            replace_whole(path, contents)
        else:
            stream.write(contents)
            stream.flush()
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise CannotOpenError(str(path), f"it cannot be written: {why}") from None
    finally:
        if stream is not None:
            with suppress(OSError):  # reported above
                stream.close()


def replace_whole(path: Path | str, contents: bytes) -> None:
    """Put a file with other contents in the place of a file, or make it; raise OSError and leave all as it was."""
    target = os.path.realpath(path)
    other = os.path.join(os.path.dirname(target), f".{os.getpid()}.part")  # noqa: PTH118, PTH120 (a path of any length)
    try:
        with suppress(FileNotFoundError):
            os.unlink(other)  # noqa: PTH108
        with open(other, "xb") as stream:  # noqa: PTH123
            stream.write(contents)
            stream.flush()
            os.fsync(stream.fileno())
        with suppress(FileNotFoundError):
            os.chmod(other, stat.S_IMODE(os.stat(target).st_mode))  # noqa: PTH101, PTH116
        os.replace(other, target)  # noqa: PTH105
    except BaseException:
        with suppress(OSError):
            os.unlink(other)  # noqa: PTH108
        raise


class GrowingFile:
    """A file that grows line by line, locked for this process until it is closed."""

    def __init__(self, path: Path | str, kind: Kind, name: str, force: bool = False) -> None:
        self._path, self._is_new, self._kept = str(path), not os.path.lexists(path), 0
        self.stream = open_for_writing(path, kind, name, force)
        self._has_begun = False

    def keep_first(self, size: int) -> None:
        """Let the file go on after its first `size` bytes, once a line is written or it is closed."""
        self._kept = size

    def write(self, line: bytes) -> None:
        """Write a line at once. Raises CannotOpenError when it cannot be written."""
        try:
            self._begin()
            self.stream.write(line)
            self.stream.flush()
        except OSError as error:
            raise CannotOpenError(self._path, f"it cannot be written: {error.strerror}") from None

    def _begin(self) -> None:
        """Cut off what is not kept."""
        if not self._has_begun:
            keep_first(self.stream, self._kept)
            self._has_begun = True

    def close(self) -> None:
        """Close the file; errors of writing were reported when they occurred."""
        with suppress(OSError):
            if self._kept:
                self._begin()
            elif self._is_new and not self._has_begun:
                os.unlink(self._path)  # noqa: PTH108 (nothing was written)
        with suppress(OSError):
            self.stream.close()
