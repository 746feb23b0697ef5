"""What the robot does next, or how the task ended: the value that every part of planning returns."""

from dataclasses import dataclass

from kb.body import Command


@dataclass(frozen=True)
class Decision:
    """The next command and why; or no command, and the verdict.

    unless : the open fact that would overturn the verdict, in words; "" when none is known yet, None when there can be
    none. near : the place (x, y) that the verdict is about, in the frame of the view's arrays.
    """

    command: Command | None
    why: str
    verdict: str = ""
    unless: str | None = ""
    near: tuple[float, float] | None = None
