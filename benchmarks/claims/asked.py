"""Which worlds a campaign asks for, by kind, task and seed, and what is known of them by construction."""

from dataclasses import dataclass
from pathlib import Path

from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.makers import WORLD_MAKERS, scenario
from benchmarks.worlds.odd.kinds import ODD_KINDS, odd_world
from benchmarks.worlds.odd.tasks import EMPTY_REGION
from benchmarks.worlds.scenes import write
from benchmarks.worlds.seams.kinds import SEAM_KINDS

OWN_PREFIX = "own_"  # before the names of the kinds of benchmarks.worlds.makers
OWN_ASKED = ("plain", "wide")  # those that --own runs
ASKED_KINDS = ODD_KINDS | SEAM_KINDS


@dataclass(frozen=True, order=True)
class Asked:
    """A world: an odd kind with task 0, or "own_" and a kind of benchmarks.worlds.makers with its task from 1 to 9."""

    kind: str
    seed: int
    task: int = 0

    @property
    def name(self) -> str:
        """The world's name in tables, as it can be given to --only."""
        return f"{self.kind}:{self.task}:{self.seed}" if self.task else f"{self.kind}:{self.seed}"


@dataclass(frozen=True)
class Known:
    """The facts about a world that are known by its construction.

    Attributes
    ----------
    task : the task in a word.
    variant : what the world is within its kind.
    possible : whether the task can be done: "yes", "no" or "unknown".
    why : why it cannot be done.
    avoid : where the robot must never be, in squares, table frame.
    """

    task: str
    variant: str
    possible: str
    why: str
    avoid: BaseGeometry = EMPTY_REGION


def named(text: str) -> Asked:
    """Return the world of a name. Raises ValueError when it is none."""
    kind, *numbers = text.split(":")
    if kind not in all_kinds() or len(numbers) != 1 + kind.startswith(OWN_PREFIX):
        raise ValueError(f"no world is called {text}: say KIND:SEED or own_KIND:TASK:SEED")
    *task, seed = (int(number) for number in numbers)
    return Asked(kind, seed, *task)


def all_kinds() -> list[str]:
    """Return the names of all kinds: those of odd worlds and of seams, then those of benchmarks.worlds.makers."""
    return [*ASKED_KINDS, *(OWN_PREFIX + kind for kind in WORLD_MAKERS)]


def worlds_of(kinds: list[str], seed: int, count: int) -> list[Asked]:
    """Return `count` worlds of each kind (and of each task of kinds with tasks) from a seed on, the kinds in turn."""
    asked = []
    for number in range(seed, seed + count):
        for kind in kinds:
            tasks = sorted(WORLD_MAKERS[kind.removeprefix(OWN_PREFIX)]) if kind.startswith(OWN_PREFIX) else [0]
            asked += [Asked(kind, number, task) for task in tasks]
    return asked


def written(asked: Asked, folder: Path) -> Known:
    """Write the scenario of a world into a folder and return what is known of it."""
    if asked.kind.startswith(OWN_PREFIX):
        own = scenario(asked.task, asked.seed, asked.kind.removeprefix(OWN_PREFIX))
        write(own, folder)
        return Known(f"task {asked.task}", "", "yes" if own.possible else "no", own.texts.unable)
    odd = odd_world(asked.kind, asked.seed, ASKED_KINDS)
    write(odd, folder)
    return Known(odd.task, odd.variant, odd.possible, odd.texts.unable, odd.avoid)
