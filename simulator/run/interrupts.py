"""Ctrl-C while a step is under way: the step comes to its end first."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


class InterruptCount:
    """Whether Ctrl-C was pressed while something was not to be broken off."""

    times = 0

    def __bool__(self) -> bool:
        return self.times > 0


@contextmanager
def defer_interrupt(tell: Callable[[], object]) -> Iterator[InterruptCount]:
    """Keep the first Ctrl-C until the end of the block, where the value that is given tells of it.

    The second breaks the block off, by KeyboardInterrupt. Where this is not the main thread, or Ctrl-C is ignored,
    nothing is kept.

    Parameters
    ----------
    tell : called at the first one.
    """
    pressed, before = InterruptCount(), signal.getsignal(signal.SIGINT)
    if not callable(before) or threading.current_thread() is not threading.main_thread():
        yield pressed
        return
    handler: Callable[[int, FrameType | None], object] = before

    def keep(number: int, frame: FrameType | None) -> None:
        pressed.times += 1
        if pressed.times > 1:
            handler(number, frame)
        tell()

    signal.signal(signal.SIGINT, keep)
    try:
        yield pressed
    finally:
        signal.signal(signal.SIGINT, before)
