"""Features that some operating systems lack: process limits, file locks, opening a file without waiting.

Every function does what the system supports and returns whether it did. `missing_features` lists what is missing.
"""

import os
import queue
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import ModuleType
from typing import Any

# Flags of os.open for reading and for writing; opening neither waits for a FIFO nor translates line ends.
READ_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
WRITE_FLAGS = (
    os.O_RDWR | os.O_CREAT | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
)
PR_SET_PDEATHSIG = 1  # option of prctl(2): the signal that this process gets when its parent ends
SIGKILL = 9  # signal(7); the module signal lacks it on Windows
MAX_BYTES_PER_READ = 65536  # bytes; the capacity of a pipe on Linux


def _optional(name: str) -> ModuleType | None:
    """Return a module of the standard library by its name, or None when this system does not have it."""
    try:
        return __import__(name)
    except ImportError:
        return None


_resource: Any = _optional("resource")  # not on Windows
_fcntl: Any = _optional("fcntl")  # not on Windows
_msvcrt: Any = None if _fcntl else _optional("msvcrt")


def missing_features() -> list[str]:
    """Return one sentence for users about each feature that this system lacks; [] when nothing is missing."""
    missing = []
    if _resource is None:
        missing.append("the memory of a question is not limited on this system: only its time is")
    if _fcntl is None and _msvcrt is None:
        missing.append("episodes are not locked on this system: two runs can write to one file")
    return missing


@contextmanager
def alarms(seconds: float, interval: float, ring: Callable[[], None]) -> Iterator[None]:
    """Call a function, which raises, while a `with` block goes on; not outside of the main thread, nor on Windows."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "setitimer"):
        yield
        return
    is_armed = True

    def rung(_number: int, _frame: object) -> None:
        """Call the function, unless the block has ended."""
        if is_armed:
            ring()

    before = signal.signal(signal.SIGALRM, rung)
    try:
        try:
            signal.setitimer(signal.ITIMER_REAL, max(seconds, 1e-6), interval)
            yield
        finally:
            is_armed = False  # an alarm may come just before: what follows is done all the same
    finally:
        is_armed = False
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def limit_resource(kind: str, most: int) -> bool:
    """Limit what this process may use from now on."""
    which = getattr(_resource, f"RLIMIT_{kind}", None)
    if which is None:
        return False
    try:
        _resource.setrlimit(which, (most, most))
    except (OSError, ValueError):  # macOS defines RLIMIT_AS, but refuses it
        return False
    return True


def limit_processor_time(seconds: int) -> bool:
    """Let the system end this process after `seconds` more seconds of processor time; return whether it does so."""
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
    """Let the system kill this process as soon as its parent process ends; return whether the system does so."""
    if not sys.platform.startswith("linux"):
        return False
    try:
        import ctypes

        return bool(ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0) == 0)
    except (ImportError, OSError, AttributeError):
        return False


def read_lines_from_parent() -> Iterator[bytes]:
    """Yield the lines of the standard input, without line ends; end this process at once when the input ends."""
    # A thread watches the input, because the input ends with the parent process on every system.
    lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()

    def watch() -> None:
        """Put each line of the standard input into `lines`; end the process at its end."""
        rest = b""
        with suppress(OSError):
            # Not through sys.stdin: Python aborts at exit while a thread waits for input with the lock of sys.stdin.
            while piece := os.read(0, MAX_BYTES_PER_READ):
                *whole, rest = (rest + piece).split(b"\n")
                for line in whole:
                    lines.put(line)
        os._exit(0)

    threading.Thread(target=watch, daemon=True).start()
    while True:
        yield lines.get()


def lock_file(handle: int) -> bool:
    """Lock an open file for this process alone, until the file is closed."""
    try:
        if _fcntl is not None:
            _fcntl.flock(handle, _fcntl.LOCK_EX | _fcntl.LOCK_NB)
        elif _msvcrt is not None:
            _msvcrt.locking(handle, _msvcrt.LK_NBLCK, 1)
    except BlockingIOError:
        return False
    except OSError as error:  # a file system without locks; Windows reports a lock that is held as EACCES (13)
        return _msvcrt is None or error.errno != 13
    return True
