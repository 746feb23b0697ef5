"""What some operating systems lack, asked for in one place: limits of a process, locks, opening without waiting.

Every function does what the system can do and says by its value whether it did; `lacking` names what is missing.
"""

import os
import queue
import sys
import threading
from collections.abc import Iterator
from contextlib import suppress
from types import ModuleType
from typing import Any

READ = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
WRITE = os.O_RDWR | os.O_CREAT | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of Linux's prctl
KILL = 9
PIECE = 65536  # bytes that are read at once, as many as a pipe holds


def _optional(name: str) -> ModuleType | None:
    try:
        return __import__(name)
    except ImportError:
        return None


_resource: Any = _optional("resource")  # not on Windows
_fcntl: Any = _optional("fcntl")  # not on Windows
_msvcrt: Any = None if _fcntl else _optional("msvcrt")


def lacking() -> list[str]:
    """Return what this system lacks, each as a sentence for users; empty where nothing is missing."""
    missing = []
    if _resource is None:
        missing.append("the memory of a question is not limited on this system: only its time is")
    if _fcntl is None and _msvcrt is None:
        missing.append("episodes are not locked on this system: two runs can write to one file")
    return missing


def limit(kind: str, most: int) -> bool:
    """Limit what this process may use from now on: `AS` bytes of memory, `NOFILE` open files, `CORE` bytes of a dump.

    Returns whether the system does that.
    """
    which = getattr(_resource, f"RLIMIT_{kind}", None)
    if which is None:
        return False
    try:
        _resource.setrlimit(which, (most, most))
    except (OSError, ValueError):  # macOS has no limit of memory, though it has its name
        return False
    return True


def limit_processor_time(seconds: int) -> bool:
    """Let the system end this process when it has worked for so many more seconds. Returns whether it does that."""
    if not hasattr(_resource, "RLIMIT_CPU"):
        return False
    used = sum(_resource.getrusage(_resource.RUSAGE_SELF)[:2])
    _, hardest = _resource.getrlimit(_resource.RLIMIT_CPU)
    try:
        _resource.setrlimit(_resource.RLIMIT_CPU, (int(used) + seconds, hardest))
    except (OSError, ValueError):
        return False
    return True


def end_with_parent() -> bool:
    """Let the system kill this process as soon as the one that started it ends. Returns whether it does that.

    A parent that has ended before is not noticed: `lines_of_parent` notices it, by the end of the input.
    """
    if not sys.platform.startswith("linux"):
        return False
    try:
        import ctypes

        return bool(ctypes.CDLL(None).prctl(PARENT_DEATH_SIGNAL, KILL, 0, 0, 0) == 0)
    except (ImportError, OSError, AttributeError):
        return False


def lines_of_parent() -> Iterator[bytes]:
    """Yield the lines of the standard input; when it ends this process ends at once, whatever it is doing.

    A thread watches the input, for it ends with the parent on every system.
    """
    lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()

    def watch() -> None:
        rest = b""
        with suppress(OSError):
            # Not through sys.stdin: Python aborts when it ends while a thread waits with the lock of that.
            while piece := os.read(0, PIECE):
                *whole, rest = (rest + piece).split(b"\n")
                for line in whole:
                    lines.put(line)
        os._exit(0)

    threading.Thread(target=watch, daemon=True).start()
    while True:
        yield lines.get()


def lock(handle: int) -> bool:
    """Lock an open file for this process alone, until it is closed. Returns False when another process has it."""
    try:
        if _fcntl is not None:
            _fcntl.flock(handle, _fcntl.LOCK_EX | _fcntl.LOCK_NB)
        elif _msvcrt is not None:
            _msvcrt.locking(handle, _msvcrt.LK_NBLCK, 1)
    except BlockingIOError:
        return False
    except OSError as error:  # a file system without locks; Windows refuses with a bare error
        return _msvcrt is None or error.errno != 13
    return True
