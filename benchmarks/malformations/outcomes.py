"""Outcomes of reading something: accepted, refused with a place, or a fault."""

import re
import signal
from collections.abc import Callable
from types import FrameType

from kb.language.diagnostics import BadInputError, CannotOpenError
from kb.reasoning.query import QueryLimitError

HANG_SECONDS = 5.0  # seconds of wall-clock time until reading a file counts as hung; a convention
REFUSAL = re.compile(r"\A[^\n]*:\d+:\d+-\d+: error: [^\n]+")


class _HungError(BaseException):
    """Reading took too long. No `except Exception` of ours catches it."""


def _hung(number: int, frame: FrameType | None) -> None:
    raise _HungError


def came_out(read: Callable[[], object], seconds: float = HANG_SECONDS) -> str:
    """Return `accepted`, `refused`, `given up`, `cannot open`, or a fault that begins with an exclamation mark."""
    signal.signal(signal.SIGALRM, _hung)
    signal.setitimer(signal.ITIMER_REAL, seconds)
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
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    return "accepted"
