"""Outcomes of reading something: accepted, refused with a place, or a fault."""

import re
import resource
import signal
from collections.abc import Callable
from pathlib import Path
from types import FrameType

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.kb.reasoning.query import QueryLimitError

HANG_SECONDS = 10.0  # seconds of processor time until reading a file counts as hung; a convention
MAX_GROWTH_BYTES = 1_000_000_000  # by which the data of a process may grow while files are read; a convention
REFUSAL = re.compile(r"\A[^\n]*:\d+:\d+-\d+: error: [^\n]+")


class _HungError(BaseException):
    """Reading took too long. No `except Exception` of ours catches it."""


def _hung(number: int, frame: FrameType | None) -> None:
    raise _HungError


def bound_memory() -> None:
    """Let this process, and those that it starts, grow by at most MAX_GROWTH_BYTES; more is a MemoryError."""
    kilobytes = re.search(r"^VmData:\s*(\d+)", Path("/proc/self/status").read_text(), re.MULTILINE)
    assert kilobytes is not None
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (1024 * int(kilobytes[1]) + MAX_GROWTH_BYTES, most))


def came_out(read: Callable[[], object], seconds: float = HANG_SECONDS) -> str:
    """Return `accepted`, `refused`, `given up`, `cannot open`, or a fault that begins with an exclamation mark."""
    signal.signal(signal.SIGPROF, _hung)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        read()
    except BadInputError as bad:
        faulty = [str(p) for p in bad.problems if not REFUSAL.match(str(p)) or "ended the process" in p.what]
        return f"! a refusal without place: {faulty[0]}" if faulty or not bad.problems else "refused"
    except CannotOpenError:
        return "cannot open"
    except QueryLimitError as limit:
        return f"! {limit}" if "ended the process" in str(limit) else "given up"
    except _HungError:
        return "! hung"
    except Exception as error:
        return f"! {type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return "accepted"
