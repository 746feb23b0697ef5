"""A stand-in for the robot in tests: its commands are deterministic, some of them senseless, and it believes little.

Run as a program, it is the `utak` command with this robot.
"""

import os
import random
import sys
import time
import types
from dataclasses import dataclass
from typing import Any

from utak.kb.body import DIRECTIONS, Body, Command, Grasp, Impression, Move, Push, Release, Turn
from utak.kb.task.task import Task


@dataclass(frozen=True)
class Options:
    paths: str = "skeleton"
    kb_files: tuple[str, ...] = ()
    max_steps: int = 200
    pull: bool = True


@dataclass(frozen=True)
class Report:
    command: Command | None
    impression: Impression
    belief: dict[str, Any]
    why: str


@dataclass(frozen=True)
class Verdict:
    believed: bool
    verdict: str
    reason: str


class Robot:
    """A robot that gives `max_steps` commands (at most 30) drawn from what it has seen so far, and then stops."""

    def __init__(self, body: Body, task: Task, options: Options) -> None:
        self.body, self.options = body, options
        self.left = min(30, options.max_steps)
        self.impression = Impression((), ())

    def wake(self) -> Report:
        return self._report(None, self.body.wake())

    def step(self) -> Report:
        time.sleep(float(os.environ.get("SCRIPTED_PAUSE", "0")))
        self.left -= 1
        command = self._choice(random.Random(hash((self.impression.retina, self.left))))
        return self._report(command, self.body.act(command))

    @property
    def finished(self) -> bool:
        return self.left == 0

    @property
    def verdict(self) -> Verdict:
        return Verdict(False, "limit", "the script has ended")

    def _choice(self, draw: random.Random) -> Command:
        felt = [d for d, colour in zip(DIRECTIONS, self.impression.touch, strict=True) if colour not in (None, "b")]
        straight = (draw.choice([draw.gauss(0, 4), draw.randint(-9, 9)]), draw.choice([draw.gauss(0, 4), 0.0, 50.0]))
        angle = draw.choice([draw.gauss(0, 60), 90, -180, 720.0])
        doing = [Move(*straight), Move(*straight), Push(*straight), Turn(angle), Grasp(draw.choice(DIRECTIONS))]
        doing += [Release()] if draw.random() < 0.3 else [Push(*straight), Turn(angle)]
        return Grasp(draw.choice(felt)) if felt and draw.random() < 0.4 else draw.choice(doing)

    def _report(self, command: Command | None, impression: Impression) -> Report:
        self.impression = impression
        facts = ["node(n1).", "kind(n1,floor,100).", f"unseen(r1,{self.left})."]
        return Report(command, impression, {"facts": facts}, f"{self.left} commands are left")


def install(robot: type[Robot] = Robot) -> None:
    """Let the command line make this robot, or another one of its kind."""
    module = types.ModuleType("utak.planner.cycle")
    module.Robot, module.Options = robot, Options  # type: ignore[attr-defined]
    sys.modules["utak.planner.cycle"] = module


if __name__ == "__main__":
    from utak.simulator.cli.main import main

    install()
    sys.exit(main())
