"""A recorded episode, read step by step, back and forth; and the live run that repeats it."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import shapely

from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import source_from_bytes
from utak.simulator.episode.episode import Episode, EpisodeLine
from utak.simulator.episode.record import facts_of_line, recorded_scenario, recorded_settings, recorded_world
from utak.simulator.run.changes import CHANGE_KINDS, AssumedRules, Change, RunConditions, changed_conditions
from utak.simulator.run.live_story import LiveStory
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import RobotMaker
from utak.simulator.scenario.picture import draw
from utak.simulator.scenario.scenario import Scenario

# What a header that is not as it must be leads to.
DAMAGE_ERRORS = (ValueError, KeyError, TypeError, AttributeError, shapely.errors.ShapelyError)
# What happened in the world at a step: the same in a repetition of the same run.
WORLD_KEYS = ("step", "action", "motion", "utak", "held", "objects", "retina", "touch")


class RecordedStory:
    """An episode that was read from a file."""

    def __init__(self, name: str, episode: Episode, kb_files: tuple[str, ...] = ()) -> None:
        self.name, self._episode, self.kb_files = name, episode, kb_files
        self._at = 0
        self._rules = AssumedRules()
        self._checked: dict[int, list[str]] = {}  # the facts of the step that was asked for last

    @property
    def header(self) -> EpisodeLine:
        """The header as it was read; of its changes only those up to the current step."""
        head = self._episode.header
        return {**head, "changes": [change.entry for change in self.changes]} if "changes" in head else head

    @property
    def changes(self) -> tuple[Change, ...]:
        """The changes of the run that the header states, up to the current step; damaged ones are left out."""
        entries = self._episode.header.get("changes")
        found = [_change_of(entry) for entry in entries] if isinstance(entries, list) else []
        return tuple(change for change in found if change is not None and change.step <= self._at)

    @property
    def is_awake(self) -> bool:
        """Whether lines can be read at once: always."""
        return True

    @property
    def at(self) -> int:
        """The number of the current step."""
        return self._at

    @property
    def lines(self) -> Sequence[EpisodeLine]:
        """The lines of all steps."""
        return self._episode.steps

    @property
    def line(self) -> EpisodeLine:
        """The line of the current step."""
        return self._episode.steps[self._at]

    @property
    def result(self) -> EpisodeLine | None:
        """The end, at the last step; else None."""
        return self._episode.result if self._at == len(self._episode.steps) - 1 else None

    @property
    def facts(self) -> list[str]:
        """The world model at the current step, as well-formed facts."""
        return self.facts_at(self._at)

    def facts_at(self, step: int) -> list[str]:
        """Return the world model at a step, as well-formed facts; raise BadInputError where they are damaged."""
        if step not in self._checked:
            task: Any = self.header.get("task")
            facts = facts_of_line(self.lines[step], task.get("parameters") if isinstance(task, dict) else None)
            try:
                parse_facts(source_from_bytes(self.name, "\n".join(facts).encode("utf-8")))
            except BadInputError as bad:
                first = bad.problems[0]
                what = f"belief.facts, number {first.span.line}: {first.what}: the episode is damaged"
                raise self._damaged(step, what) from None
            self._checked = {step: facts}
        return self._checked[step]

    @property
    def conditions(self) -> RunConditions:
        """The conditions that count at the current step besides the scenario, as far as the header states them."""
        # Raises BadInputError when the header's task has errors.
        conditions = RunConditions((), self._scenario().task)
        for change in self.changes:
            with suppress(BadInputError):
                conditions = changed_conditions(conditions, change, self.kb_files)
        return conditions

    def _scenario(self) -> Scenario:
        """Return the scenario that the header states; raise BadInputError when it states none."""
        try:
            return recorded_scenario(self.header, self.lines[0])
        except DAMAGE_ERRORS as error:
            raise self._damaged(-1, f"the header states no scenario: {type(error).__name__}: {error}") from None

    @property
    def rule_files(self) -> tuple[str, ...]:
        """The paths of the rules that queries use: the user's files, and assumptions that the header states."""
        assumed = self._rules.files(self.conditions.assumptions) if self.changes else ()
        return (*self.kb_files, *assumed)

    @property
    def next_action(self) -> tuple[EpisodeLine | None, str] | None:
        """The command after the current step and its reason, as recorded; None at the last step."""
        if self._at == len(self.lines) - 1:
            return None
        line = self.lines[self._at + 1]
        return line["action"], str(line.get("why", ""))

    def advance(self) -> bool:
        """Go on by one step. Return whether there was one."""
        if self._at == len(self._episode.steps) - 1:
            return False
        self._at += 1
        return True

    def go_to(self, step: int) -> None:
        """Go to a step; raise IndexError when there is none."""
        if not 0 <= step < len(self.lines):
            raise IndexError(step)
        self._at = step

    def picture(self) -> str:
        """Return the true table at the current step as a picture."""
        try:
            world = recorded_world(self._episode.header)
            polygons = {name: shapely.Polygon(ring) for name, ring in self.line["objects"].items()}
            x, y = self.line["utak"]
            return draw(world, polygons, (x, y))
        except (ValueError, shapely.errors.ShapelyError):  # a boundary that crosses itself, say
            what = f"step {self._at} does not record a table that can be drawn: the episode is damaged"
            raise self._damaged(self._at, what) from None

    def relive(
        self, tell: Callable[[int], object] = lambda step: None, make: RobotMaker = make_robot
    ) -> tuple[LiveStory, int | None]:
        """Return a live run that repeats this episode, at the current step."""
        scenario = self._scenario()
        try:
            settings = recorded_settings(self.header, self.kb_files)
        except DAMAGE_ERRORS as error:
            raise self._damaged(-1, f"this run cannot be repeated: {error}") from None
        live, differing = LiveStory(scenario, settings, make), None
        for step in range(self._at + 1):
            if step > 0 and not live.advance():
                raise self._damaged(step, f"the repeated run ends at step {step - 1}: another version of utak made it")
            for change in self.changes:
                if change.step == step:
                    live.change(change.kind, change.text)
            recorded, repeated = self.lines[step], live.line
            if any(recorded.get(key) != repeated.get(key) for key in WORLD_KEYS):
                keys = ", ".join(key for key in WORLD_KEYS if recorded.get(key) != repeated.get(key))
                what = f"the repeated run differs at step {step} ({keys}): another version of utak made this episode"
                raise self._damaged(step, what)
            if differing is None and facts_of_line(recorded) != facts_of_line(repeated):
                differing = step
            tell(step)
        return live, differing

    def _damaged(self, step: int, what: str) -> BadInputError:
        """Return, not raise, the error `what` at the line of a step; at the header for -1."""
        return BadInputError([Problem(self.name, SourceSpan(step + 2, 1, 1), what)])


def _change_of(entry: Any) -> Change | None:
    """Return a change as a header states it; None for a damaged one."""
    if isinstance(entry, dict) and type(entry.get("step")) is int and entry["step"] >= 0:
        for kind in CHANGE_KINDS:
            if isinstance(entry.get(kind), str):
                return Change(entry["step"], kind, entry[kind])
    return None
