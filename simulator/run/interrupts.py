"""Ctrl-C during a step, which is completed first; and the request to end of other processes."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def end_at_request() -> Iterator[None]:
    """Let SIGTERM raise KeyboardInterrupt in a `with` block, so that all is cleaned up; then end by SIGTERM."""
    asked = False

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal asked
        if not asked:
            asked = True
            raise KeyboardInterrupt

    before = signal.getsignal(signal.SIGTERM)
    if before is signal.SIG_IGN or threading.current_thread() is not threading.main_thread():
        yield
        return
    signal.signal(signal.SIGTERM, note)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
        if asked:
            signal.raise_signal(signal.SIGTERM)


@contextmanager
def defer_interrupt(tell: Callable[[], object]) -> Iterator[list[int]]:
    """Hold back the first Ctrl-C until the end of a `with` block; yield the list of those that came in it."""
    # The second Ctrl-C raises KeyboardInterrupt in the block.
    pressed: list[int] = []
    before = signal.getsignal(signal.SIGINT)
    if not callable(before) or threading.current_thread() is not threading.main_thread():
        yield pressed
        return
    handler: Callable[[int, FrameType | None], object] = before

    def keep(number: int, frame: FrameType | None) -> None:
        pressed.append(number)
        if len(pressed) > 1:
            handler(number, frame)
        tell()

    signal.signal(signal.SIGINT, keep)
    try:
        yield pressed
    finally:
        signal.signal(signal.SIGINT, before)
