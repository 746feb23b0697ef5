"""A scenario: a world with a task, and what a test expects, from a folder or from texts."""

import textwrap
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any

from utak.kb.language.diagnostics import BadInputError
from utak.kb.task.task import read_task, start_facts_of
from utak.markup import framed
from utak.simulator.replay.drawing import table_svg
from utak.simulator.scenario import scenario as files
from utak.simulator.scenario.disturbances import read_disturbed, undisturbed
from utak.simulator.scenario.expectation import read_expectations
from utak.simulator.scenario.picture import draw
from utak.simulator.sweep.contents import written


@dataclass(frozen=True, repr=False)
class Scenario:
    """A world with a task, read and checked. It shows itself in notebooks as a picture of the table.

    Attributes
    ----------
    name : str
        The name of its folder; "" when it was made from texts.
    content : simulator.scenario.scenario.Scenario
        What was read: `world`, `task` and `expectations`.

    Examples
    --------
    >>> scenario = Scenario.from_text(
    ...     world='''
    ...     bbbbbbbb
    ...     b....g.b
    ...     b......b
    ...     b.U....b
    ...     bbbbbbbb
    ...     ''',
    ...     goal="at(utak, corner(northeast)).",
    ... )
    >>> scenario
    <Scenario: 8 x 5 squares, 1 thing; at(utak,corner(northeast))>
    """

    name: str
    content: files.Scenario

    @staticmethod
    def read(path: Path | str) -> "Scenario":
        """Return the scenario in a folder.

        Parameters
        ----------
        path : Path or str
            The folder: `world.txt` or `world.lp`, `start.lp`, `goal.lp` and perhaps `expect.lp` (docs/files.md).

        Returns
        -------
        Scenario
            The scenario, checked.

        Raises
        ------
        CannotOpenError
            The folder or a file in it cannot be read.
        BadInputError
            Files have errors; the message names every one with its place.
        """
        return Scenario(Path(path).resolve().name, files.read_scenario(path))

    @staticmethod
    def from_text(world: str, goal: str, start: str = "", expect: str | None = None) -> "Scenario":
        """Return a scenario made from the texts of its files.

        Parameters
        ----------
        world : str
            A picture as in `world.txt`, one letter a square, or facts as in `world.lp`. Common indentation and empty
            lines around it are left out.
        goal : str
            What shall hold, as in `goal.lp`.
        start : str
            The parameters of the task and what is claimed of them, as in `start.lp`.
        expect : str, optional
            What a test expects, as in `expect.lp`; None for nothing.

        Returns
        -------
        Scenario
            The scenario, checked.

        Raises
        ------
        BadInputError
            Texts have errors; the message names every one with its place, as if the texts were files.
        """
        name = "world.lp" if "(" in world else "world.txt"
        texts = {name: textwrap.dedent(world).strip("\n") + "\n", "start.lp": start, "goal.lp": goal}
        if expect is not None:
            texts["expect.lp"] = expect
        return Scenario("", _read_texts(texts, files.read_scenario))

    def disturbed(self, path: Path | str) -> "Scenario":
        """Return a scenario in which others do meanwhile what a file states.

        Parameters
        ----------
        path : Path or str
            The file, as for `utak run --disturb` (docs/files.md).

        Returns
        -------
        Scenario
            The scenario with these disturbances alone.

        Raises
        ------
        CannotOpenError
            The file cannot be read.
        BadInputError
            The file has errors; the message names every one with its place.
        """
        world = read_disturbed(undisturbed(self.content.world), path)
        return Scenario(self.name, replace(self.content, world=world))

    def with_task(self, goal: str, start: str | None = None, expect: str | None = None) -> "Scenario":
        """Return a scenario with another task in the same world.

        Parameters
        ----------
        goal : str
            What shall hold, as in `goal.lp`.
        start : str, optional
            The parameters and what is claimed of them, as in `start.lp`; those of this scenario if None.
        expect : str, optional
            What a test expects, as in `expect.lp`; None for nothing.

        Returns
        -------
        Scenario
            The scenario, checked; it bears the same name.

        Raises
        ------
        BadInputError
            Texts have errors; the message names every one with its place.
        """
        texts = {
            "start.lp": "".join(f"{fact}.\n" for fact in start_facts_of(self.content.task)) if start is None else start,
            "goal.lp": goal,
        }
        if expect is not None:
            texts["expect.lp"] = expect
        world = self.content.world

        def read(folder: Path) -> files.Scenario:
            task = read_task(folder / "start.lp", folder / "goal.lp")
            expected = None if expect is None else read_expectations(folder / "expect.lp", world)
            return files.Scenario(world, task, expected)

        return Scenario(self.name, _read_texts(texts, read))

    @cached_property
    def picture(self) -> str:
        """The world as a picture, one letter a square, the north row first."""
        return draw(self.content.world)

    @property
    def goals(self) -> tuple[str, ...]:
        """The goals, as facts without full stops."""
        return tuple(str(goal) for goal in self.content.task.goals)

    @property
    def expectations(self) -> tuple[str, ...] | None:
        """The expectations of a test, as facts without full stops; None without expect.lp."""
        found = self.content.expectations
        return None if found is None else tuple(str(fact) for fact in found)

    def __repr__(self) -> str:
        """Return the name, the size of the table, the number of things and the goals."""
        world = self.content.world
        count = len(world.movable) + len(world.fixed)
        things = f"{count} thing" if count == 1 else f"{count} things"
        name = f" {self.name}" if self.name else ""
        return f"<Scenario{name}: {world.width} x {world.height} squares, {things}; {', '.join(self.goals)}>"

    def _repr_svg_(self) -> str:
        return table_svg(self.content.world)

    def _repr_html_(self) -> str:
        return framed(f"<b>{escape(self.name or 'scenario')}</b>: {escape(', '.join(self.goals))}", self._repr_svg_())

    def __deepcopy__(self, memo: dict[int, Any]) -> "Scenario":
        """Return the scenario itself: it never changes."""
        return self


def _read_texts(texts: dict[str, str], read: Callable[[Path], files.Scenario]) -> files.Scenario:
    """Return what is read from a folder with some texts as files; errors name the files without the folder."""
    with written([*texts.items()]) as folder:
        try:
            return read(folder)
        except BadInputError as bad:
            raise BadInputError(problem._replace(file=Path(problem.file).name) for problem in bad.problems) from None
