"""A scenario: a folder with the true world (world.lp or world.txt), the task (start.lp, goal.lp) and expect.lp."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from utak.kb.language.diagnostics import BadInputError, CannotOpenError, Problem, SourceSpan
from utak.kb.language.terms import Fact
from utak.kb.task.task import Task, read_task
from utak.simulator.scenario.expectation import read_expectations
from utak.simulator.scenario.picture import read_picture
from utak.simulator.scenario.worldfile import read_world
from utak.simulator.world.world import World

_T = TypeVar("_T")


@dataclass(frozen=True)
class Scenario:
    """A scenario that was read and checked."""

    world: World  # the true world
    task: Task  # the task
    expectations: tuple[Fact, ...] | None  # the facts of expect.lp; None without that file.


def read_scenario(folder: Path | str) -> Scenario:
    """Return the scenario in a folder."""
    folder = Path(folder)
    _must_be_folder(folder)
    problems: list[Problem] = []
    world = collect_problems(problems, lambda: read_any_world(folder))
    task = collect_problems(problems, lambda: read_task(folder / "start.lp", folder / "goal.lp"))
    expect = folder / "expect.lp"
    expectations = collect_problems(problems, lambda: read_expectations(expect, world)) if expect.exists() else None
    if problems or world is None or task is None:
        raise BadInputError(problems)
    return Scenario(world, task, expectations)


def read_any_world(folder: Path | str) -> World:
    """Return the world of a scenario folder, from world.lp or from the picture world.txt."""
    folder = Path(folder)
    _must_be_folder(folder)
    facts, picture = folder / "world.lp", folder / "world.txt"
    if facts.exists() and picture.exists():
        what = "the scenario has two worlds, world.lp and world.txt"
        raise BadInputError([Problem(str(picture), SourceSpan(1, 1, 1), what, hint="keep one of them")])
    if picture.exists():
        return read_picture(picture)
    if not facts.exists():
        raise CannotOpenError(str(folder), "there is neither world.lp nor world.txt in it")
    return read_world(facts)


def _must_be_folder(folder: Path) -> None:
    """Raise CannotOpenError unless the path is a folder."""
    try:
        if folder.is_dir():
            return
        exists = folder.exists()
    except (OSError, ValueError) as error:
        raise CannotOpenError(str(folder), str(error)) from None
    raise CannotOpenError(str(folder), "a scenario is a folder, this is none" if exists else "no such folder")


def collect_problems(problems: list[Problem], read: Callable[[], _T]) -> _T | None:
    """Return what `read` returns; append the problems that it raises to `problems`, and return None then."""
    try:
        return read()
    except BadInputError as bad:
        problems += bad.problems
        return None
