"""The record of a run as the robot wrote it: commands, impressions, beliefs and decisions, nothing of the truth."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

from utak.geometry.kernels.arrays import XY, Square
from utak.kb.language.atoms import short_form
from utak.kb.perception.frame import Frame
from utak.kb.tracing.decisions import SolverCall

RecordLine = Mapping[str, Any]  # the JSON object of one step of an episode


class MissingRecordError(Exception):
    """The episode does not record what an explanation needs: an older version of utak wrote it."""


class RecordedStep:
    """The record of one step, as the robot wrote it."""

    def __init__(self, line: RecordLine, before: "RecordedStep | None") -> None:
        self.number: int = line["step"]
        self.action: Mapping[str, Any] | None = line["action"]
        self.retina: tuple[int, ...] = tuple(line["retina"])
        self.touch: tuple[str | None, ...] = tuple(line["touch"])
        self.why: str = line["why"]
        self._belief: Mapping[str, Any] = line["belief"]
        self._before = before

    def _recorded(self, key: str) -> Any:
        """Return a value of the belief; raise MissingRecordError when it was not recorded."""
        if key not in self._belief:
            raise MissingRecordError(f"step {self.number} does not record {key}: an older version of utak wrote it")
        return self._belief[key]

    @cached_property
    def facts(self) -> tuple[str, ...]:
        """The world model as facts without full stops, in the order of the episode."""
        found = [str(fact).removesuffix(".") for fact in self._recorded("facts")]
        bindings = [f"bound({parameter},{node})" for parameter, node in sorted(self.bound.items())]
        return tuple(dict.fromkeys((*found, *bindings)))

    @cached_property
    def long_facts(self) -> tuple[str, ...]:
        """The same facts without those that are the short form of another one."""
        short = {text for fact in self.facts if (text := short_form(fact))}
        return tuple(fact for fact in self.facts if fact not in short)

    @cached_property
    def fact_set(self) -> frozenset[str]:
        """The same facts as a set."""
        return frozenset(self.facts)

    @property
    def pose(self) -> str:
        """The kind of the explanation of the impression, such as predicted or blocked."""
        return str(self._recorded("pose"))

    @property
    def bound(self) -> Mapping[str, str]:
        """Parameter of the task -> the node that it means."""
        bound: Mapping[str, str] = self._belief.get("bound", {})
        return bound

    @property
    def status(self) -> str:
        """A letter for each of the 160 cells: p, e or n (predicted, explained, noise)."""
        return str(self._recorded("status"))

    @property
    def allowed(self) -> tuple[str, str]:
        """The least and the greatest gray level that the map allowed each cell, as 160 digits each."""
        return str(self._recorded("least")), str(self._recorded("most"))

    @property
    def explained(self) -> Mapping[str, Sequence[int]]:
        """Fact with a full stop -> the cells that are laid to it."""
        explained: Mapping[str, Sequence[int]] = self._recorded("explained")
        return explained

    @property
    def regions(self) -> Mapping[str, str]:
        """Node -> its region of the map."""
        regions: Mapping[str, str] = self._recorded("regions")
        return regions

    @property
    def moved(self) -> Sequence[str]:
        """The nodes whose place is known from having been moved."""
        moved: Sequence[str] = self._recorded("moved")
        return moved

    @property
    def necks(self) -> Mapping[str, Sequence[XY]]:
        """Door -> the two ends (east, north) of the line across its neck, in squares, robot frame."""
        return {door: [(e, n) for e, n in ends] for door, ends in self._recorded("necks").items()}

    @property
    def first_impression(self) -> int:
        """The number of the first impression on which the map rests."""
        return int(self._recorded("map_from"))

    @cached_property
    def frame(self) -> Frame:
        """The place of the robot frame in the map frame, as believed."""
        x, y = self._recorded("origin")
        return Frame(self._recorded("lattice"), (x, y))

    @cached_property
    def places(self) -> tuple[XY, ...]:
        """The places of all impressions up to this one, as believed now: (east, north), squares, robot frame."""
        later: list[Sequence[float]] = []
        step: RecordedStep | None = self
        while step is not None and "seen_from" not in step._belief:
            later.append(step._recorded("place"))
            step = step._before
        given = step._belief["seen_from"] if step is not None else ()
        return tuple((east, north) for east, north in (*given, *reversed(later)))

    def square_of(self, place: XY) -> Square:
        """Return the square (column, row) of the map frame in which a point (east, north) of the robot frame lies."""
        x, y = self.frame.place_from_utak(*place)
        return int(x // 1), int(y // 1)

    def entries(self) -> Sequence[Any]:
        """Return the entries of `solved` as they stand in the episode."""
        entries: Sequence[Any] = self._recorded("solved")
        return entries


class Record:
    """The steps of a run."""

    def __init__(self, lines: Sequence[RecordLine]) -> None:
        steps: list[RecordedStep] = []
        for line in lines:
            steps.append(RecordedStep(line, steps[-1] if steps else None))
        self.steps = tuple(steps)
        self._decisions: dict[int, tuple[SolverCall, ...]] = {}

    def decisions(self, step: int) -> tuple[SolverCall, ...]:
        """Return the answers of encodings that a step records, in order."""
        # Those written elsewhere are looked up there.
        # Raises MissingRecordError when the episode does not record them.
        if step not in self._decisions:
            self._decisions[step] = tuple(self._call(entry) for entry in self.steps[step].entries())
        return self._decisions[step]

    def _call(self, entry: Sequence[Any]) -> SolverCall:
        """Return one answer from its entry: in full, or [encoding, [step, index]]."""
        if len(entry) == 2:
            step, index = entry[1]
            entry = self.steps[step].entries()[index]
        encoding, facts, answer, about = entry
        return SolverCall(encoding, tuple(facts), None if answer is None else tuple(answer), tuple(about))

    def last_answer(self, step: int, encoding: str, atom: str, oldest: int = 0) -> tuple[int, SolverCall] | None:
        """Return the newest answer of an encoding, up to a step, that holds an atom, with the step of its record."""
        # None when no answer holds it.
        return next((found for found in self.answers(step, encoding, oldest) if atom in (found[1].answer or ())), None)

    def answers(self, step: int, encoding: str, oldest: int = 0) -> Iterator[tuple[int, SolverCall]]:
        """Yield the answers of an encoding between two steps, the newest first, each with the step of its record."""
        for number in range(step, oldest - 1, -1):
            yield from ((number, call) for call in reversed(self.decisions(number)) if call.encoding == encoding)
