"""Changes of a run from outside: assumptions made and taken back, and other goals, each from a step on."""

import shutil
import tempfile
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from utak.kb.language.diagnostics import BadInputError, did_you_mean
from utak.kb.language.source_text import source_from_bytes
from utak.kb.reasoning.assumptions import ASSUMPTION_FILE, Assumption, canonical_facts, read_assumptions
from utak.kb.task.task import Task, task_with_goals
from utak.simulator.episode.episode import EpisodeLine
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings

CHANGE_KINDS = ("assume", "retract", "goal")  # as commands of `utak repl` and episodes name them


@dataclass(frozen=True)
class Change:
    """One change of a run."""

    step: int  # the step from which it counts: the impression of this step is interpreted with it
    kind: str  # assume, retract or goal
    text: str  # what is assumed, taken back or wanted, as written, in one line

    @property
    def entry(self) -> EpisodeLine:
        """The change as an episode's header states it, such as {"step": 3, "assume": "shape(o1,square,90)."}."""
        return {"step": self.step, self.kind: self.text}


class RunConditions(NamedTuple):
    """The conditions that count at a step."""

    scenario: Scenario  # the world and the task
    settings: Settings  # the options
    assumptions: tuple[Assumption, ...] = ()  # what is assumed, in the order in which it was assumed

    @property
    def task(self) -> Task:
        """The task that counts."""
        return self.scenario.task


def changed_conditions(before: RunConditions, change: Change) -> RunConditions:
    """Return the conditions after a change. Nothing is expected of the truth when the goals are others."""
    if change.kind == "goal":
        source = source_from_bytes("goal", _ended(change.text).encode("utf-8", errors="surrogateescape"))
        task = task_with_goals(before.task, source)
        return before._replace(scenario=replace(before.scenario, task=task, expectations=None))
    if change.kind == "retract":
        return before._replace(assumptions=_without(before.assumptions, change.text))
    assumptions = before.assumptions
    for new in read_assumptions(change.text, before.settings.kb_files):
        if any(old.written == new.written for old in assumptions):
            raise BadInputError.about(ASSUMPTION_FILE, new.written, f"this is assumed already: {new.written}")
        assumptions = (*assumptions, new)
    return before._replace(assumptions=assumptions)


def _ended(text: str) -> str:
    """Return a text with a full stop at its end; an empty text stays empty."""
    text = text.strip()
    return text if not text or text.endswith(".") else f"{text}."


def _without(assumptions: tuple[Assumption, ...], text: str) -> tuple[Assumption, ...]:
    """Return the assumptions without those that a text names; raise BadInputError when it names none of them."""
    whole = " ".join(_ended(text).split())
    if any(one.written == whole for one in assumptions):
        return tuple(one for one in assumptions if one.written != whole)
    if not assumptions:
        raise BadInputError.about("retract", whole, "nothing is assumed here")
    named = canonical_facts(text, "retract")
    written = {one.written for one in assumptions}
    for fact in named:
        if fact not in written:
            hint = did_you_mean(fact, written) or f"assumed: {' '.join(sorted(written))}"
            raise BadInputError.about("retract", whole, f"this is not assumed: {fact}", hint)
    return tuple(one for one in assumptions if one.written not in named)


class AssumedRules:
    """Rule files of assumptions, for the encodings: they lie in a folder of their own that ends with this object."""

    def __init__(self) -> None:
        self._folder: Path | None = None
        self._paths: dict[str, str] = {}  # by the text of the rule

    def files(self, assumptions: Sequence[Assumption]) -> tuple[str, ...]:
        """Return the paths of the files that state some assumptions; those that reach queries alone need none."""
        return tuple(self._file(one.rule) for one in assumptions if one.rule)

    def _file(self, rule: str) -> str:
        """Return the path of the file with a rule; it is written when it is asked for the first time."""
        if self._folder is None:
            self._folder = Path(tempfile.mkdtemp(prefix="utak-assumed-"))
            weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        if rule not in self._paths:
            path = self._folder / f"{len(self._paths)}.lp"
            path.write_text(f"{rule}\n")
            self._paths[rule] = str(path)
        return self._paths[rule]

    @contextmanager
    def errors_as_typed(self) -> Iterator[None]:
        """Let errors in these files, in a `with` block, name the assumption that was typed, not a file."""
        try:
            yield
        except BadInputError as bad:
            own = set(self._paths.values())
            raise BadInputError(
                problem._replace(file=ASSUMPTION_FILE) if problem.file in own else problem for problem in bad.problems
            ) from None
