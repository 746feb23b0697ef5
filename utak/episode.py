"""The record of a run: its steps, what was believed after each, and how it ended."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any, overload

from utak.beliefs import World, world_of
from utak.explaining import ReasonTree
from utak.kb.body import Impression
from utak.markup import framed, table
from utak.simulator.certificates.search import certificate_of
from utak.simulator.episode.episode import Episode as EpisodeRecord
from utak.simulator.episode.episode import encode, read_episode
from utak.simulator.episode.output_files import is_episode, write_whole
from utak.simulator.explaining.missing_rules import rule_paths
from utak.simulator.explaining.questions import Questions, questions_of_episode
from utak.simulator.replay.drawing import step_svg
from utak.simulator.scenario.settings import USUAL_RISK
from utak.simulator.terminal.action_in_words import describe

MAX_STEPS_SHOWN = 200  # steps of an episode that a notebook lists; a convention


class Step:
    """One step of a run: a command, the impression after it, and what is believed since.

    It shows itself in notebooks as a picture: the table as it is, the fields of the retina in grey, and the boundaries
    that are believed in blue (floor and verge) and red (objects), the stronger the surer.

    Attributes
    ----------
    line : dict
        The step as the episode records it (docs/files.md).
    """

    def __init__(self, line: dict[str, Any], record: EpisodeRecord, rules: tuple[str, ...] = ()) -> None:
        """Make the step of an episode; episodes and runs do so themselves.

        Parameters
        ----------
        line : dict
            The line of the step.
        record : simulator.episode.episode.Episode
            The run, up to this step at least.
        rules : tuple of str
            The files with users' rules, for questions.
        """
        self.line = line
        self._record, self._rules = record, rules

    @property
    def number(self) -> int:
        """The number of commands so far; 0 on waking."""
        return int(self.line["step"])

    @property
    def action(self) -> str:
        """The command that was given, in the robot frame, such as `move(2, -1)`; `wake` on waking."""
        return describe(self.line["action"])

    @property
    def why(self) -> str:
        """The reason of the command, in words."""
        return str(self.line["why"])

    @property
    def impression(self) -> Impression:
        """The impression after the command: 160 gray levels and 8 touches."""
        return Impression(tuple(self.line["retina"]), tuple(self.line["touch"]))

    @cached_property
    def world(self) -> World:
        """The world model after the command."""
        return world_of(self.line, self._rules)

    @property
    def utak(self) -> tuple[float, float]:
        """The true place of the robot: (x, y) in squares, table frame."""
        x, y = self.line["utak"]
        return float(x), float(y)

    @property
    def held(self) -> str | None:
        """The true name of the thing in hand; None with empty hands."""
        name = self.line["held"]
        return None if name is None else str(name)

    def explain(self) -> ReasonTree:
        """Return why the command was given: the goals and facts behind it, and what was not chosen.

        Raises
        ------
        BadInputError
            The episode does not record what is needed.
        """
        asked = questions_of_episode(self._record, rule_paths(self._rules))
        return ReasonTree(asked.why_step(self.number), asked.lacking)

    def __repr__(self) -> str:
        """Return the number, the command and its reason."""
        return f"<Step {self.number}: {self.action}: {self.why}>"

    def _repr_svg_(self) -> str:
        return step_svg(self._record, self.line)

    def _repr_html_(self) -> str:
        return framed(f"<b>{self.number}: {escape(self.action)}</b> {escape(self.why)}", self._repr_svg_())


class Episode(Sequence[Step]):
    """The record of a run, a sequence of steps; step 0 is that of waking.

    Attributes
    ----------
    record : simulator.episode.episode.Episode
        The lines of the episode (docs/files.md): `header`, `steps` and `result`.
    rules : tuple of str
        The files with users' rules, which questions can use.
    """

    def __init__(self, record: EpisodeRecord, rules: tuple[str, ...] = ()) -> None:
        """Make the episode of some lines; `Run` and `Episode.read` do so.

        Parameters
        ----------
        record : simulator.episode.episode.Episode
            Header, steps and result.
        rules : tuple of str
            The files with users' rules.
        """
        self.record, self.rules = record, rules

    @staticmethod
    def read(path: Path | str, rules: Sequence[Path | str] = ()) -> "Episode":
        """Return an episode that was saved, or written by `utak run --log`, complete or cut short.

        Parameters
        ----------
        path : Path or str
            The file.
        rules : sequence of Path or str
            The files with users' rules that took part, for questions and reasons; an episode does not hold them.

        Returns
        -------
        Episode
            The episode, every value checked.

        Raises
        ------
        CannotOpenError
            The file cannot be read.
        BadInputError
            The file is no episode, or it is damaged.
        """
        return Episode(read_episode(path), tuple(map(str, rules)))

    def save(self, path: Path | str, force: bool = False) -> None:
        """Write the episode to a file as JSON lines.

        Parameters
        ----------
        path : Path or str
            The file. A file that is no episode is not overwritten.
        force : bool
            Whether to overwrite a file of any kind.

        Raises
        ------
        CannotOpenError
            The file cannot be written, or is of another kind.
        """
        write_whole(path, "".join(self._lines).encode("ascii"), is_episode, "episode", force)

    def certificate(self, risk: float = USUAL_RISK) -> str:
        """Return why the verdict follows from what was seen, felt and commanded, as a file for `utak verify`.

        Parameters
        ----------
        risk : float
            With noise: how likely it may be wrong, at most, in percent, 0.0001 to 99. Without noise it has none.

        Returns
        -------
        str
            A JSON text (docs/certificates.md), about the file that `save` writes.

        Raises
        ------
        NoCertificateError
            There is none: the verdict is neither `done` nor `impossible`, or nothing shows it; the message says why.
        """
        return certificate_of(self._lines, self.verdict, risk)

    @property
    def _lines(self) -> list[str]:
        """The lines of the file."""
        result = [] if self.record.result is None else [{"result": self.record.result}]
        return [encode(line) for line in (self.record.header, *self.record.steps, *result)]

    def __len__(self) -> int:
        """Return the number of steps, that of waking included."""
        return len(self.record.steps)

    @overload
    def __getitem__(self, index: int) -> Step: ...
    @overload
    def __getitem__(self, index: slice) -> list[Step]: ...
    def __getitem__(self, index: int | slice) -> Step | list[Step]:
        """Return a step by its number, counted from the end when negative; or the steps of a slice."""
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        try:
            line = self.record.steps[index]
        except IndexError:
            raise IndexError(f"there is no step {index}: the last is {len(self) - 1}") from None
        return Step(line, self.record, self.rules)

    def __iter__(self) -> Iterator[Step]:
        """Yield the steps."""
        return (self[number] for number in range(len(self)))

    @property
    def result(self) -> Mapping[str, Any] | None:
        """The end: `believed`, `achieved`, `verdict`, `reason`, `steps`; None when the run was cut short."""
        return self.record.result

    @property
    def verdict(self) -> str | None:
        """The verdict: done, impossible, possible_if or limit; None when the run was cut short."""
        return None if self.record.result is None else str(self.record.result["verdict"])

    @property
    def reason(self) -> str:
        """The reason of the verdict in words; "" when the run was cut short."""
        return "" if self.record.result is None else str(self.record.result["reason"])

    @property
    def idle_rules(self) -> tuple[str, ...]:
        """The users' rules that never applied in the run, in words with file and line; () while it goes on."""
        return () if self.record.result is None else tuple(self.record.result.get("idle_rules", ()))

    @property
    def achieved(self) -> bool | None:
        """Whether the end is as expect.lp expects; None without expectations or without an end."""
        return None if self.record.result is None else self.record.result["achieved"]

    @property
    def world(self) -> World:
        """The world model after the last step."""
        return self[-1].world

    def why(self, fact: str, step: int = -1) -> ReasonTree:
        """Return why a fact is believed, or why a goal or the verdict stands as it does.

        Parameters
        ----------
        fact : str
            A fact of the world model, such as `shape(o1, square, 95)`, one of the goals, or `verdict(done)`. Names with
            a capital letter stand for anything: the surest fact that fits is explained.
        step : int
            The number of the step, counted from the end when negative; by default the last one.

        Returns
        -------
        ReasonTree
            A tree of reasons, which prints itself.

        Raises
        ------
        BadInputError
            The text is no fact, the fact is not believed then, or the episode does not record what is needed.
        """
        return ReasonTree(self._questions.why(fact, self[step].number), self._questions.lacking)

    def why_cell(self, cell: int, step: int = -1) -> ReasonTree:
        """Return what a cell of the impression of a step is laid to.

        Parameters
        ----------
        cell : int
            The number of the cell, 0 to 159, in the order of an impression.
        step : int
            The number of the step.

        Returns
        -------
        ReasonTree
            A tree of reasons, which prints itself.

        Raises
        ------
        BadInputError
            There is no such cell, or the episode does not record what is needed.
        """
        return ReasonTree(self._questions.why_cell(cell, self[step].number), self._questions.lacking)

    @cached_property
    def _questions(self) -> Questions:
        """The questions about this episode, with its record read."""
        return questions_of_episode(self.record, rule_paths(self.rules))

    def __repr__(self) -> str:
        """Return the number of commands and how the run ended."""
        commands = len(self) - 1
        end = "cut short" if self.verdict is None else f"{self.verdict}: {self.reason}"
        return f"<Episode of {commands} command{'s' * (commands != 1)}; {end}>"

    def _repr_svg_(self) -> str:
        return self[-1]._repr_svg_()

    def _repr_html_(self) -> str:
        rows = [(step.number, step.action, step.why) for step in self[:MAX_STEPS_SHOWN]]
        steps = table(("step", "command", "why"), rows)
        caption = f"{escape(repr(self)[1:-1])}<details><summary>steps</summary>{steps}</details>"
        return framed(caption, self._repr_svg_())
