"""A run or a recorded episode, read step by step, back and forth, and changed on the way."""

from collections.abc import Mapping
from contextlib import suppress
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import shapely

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import source_from_bytes
from utak.planner.decision import Decision
from utak.simulator.episode.episode import Episode, EpisodeLine, EpisodeLog, read_begun_episode
from utak.simulator.episode.record import (
    action_entry,
    facts_of_line,
    header,
    recorded_scenario,
    recorded_settings,
    world_at,
)
from utak.simulator.run.changes import CHANGE_KINDS, AssumedRules, Change, RunConditions, changed_conditions
from utak.simulator.run.robots import make_robot, warm_for
from utak.simulator.run.session import RobotMaker, RunNotRepeatedError, Session
from utak.simulator.scenario.picture import draw
from utak.simulator.scenario.scenario import Scenario, read_scenario
from utak.simulator.scenario.settings import Settings

MAX_KEPT_SESSIONS = 12  # copies of the run that are kept for going on from earlier steps; a convention
# What happened in the world at a step: the same in a repetition of the same run.
WORLD_KEYS = ("step", "action", "motion", "disturbed", "utak", "held", "objects", "retina", "touch")


class StoryMoment(NamedTuple):
    """All that a story knows at one moment. It is replaced as a whole, so an interrupt cannot tear it."""

    lines: tuple[EpisodeLine, ...]  # the lines of all steps known so far; () while the robot sleeps
    at: int  # the current step
    result: EpisodeLine | None  # the end of the run, which belongs to the last line; None while it goes on
    changes: tuple[Change, ...] = ()  # the changes of the run, in the order of their steps
    # What counts, by the step from which it counts; there is one for -1. {} for a recorded episode
    conditions: Mapping[int, RunConditions] = {}
    sessions: Mapping[int, Session] = {}  # copies of the run, by the step at which each rests

    def conditions_at(self, step: int) -> RunConditions:
        """Return what counts at a step."""
        return self.conditions[max(begin for begin in self.conditions if begin <= step)]

    def with_step(self, session: Session, step: int) -> "StoryMoment":
        """Return the moment at a step at which a session rests; later lines and copies are dropped."""
        result = session.end().line["result"] if session.finished else None
        kept = {at: other for at, other in self.sessions.items() if at < step}
        while len(kept) >= MAX_KEPT_SESSIONS:  # every second one is forgotten, but for the newest
            kept = {at: other for n, (at, other) in enumerate(kept.items()) if n % 2 == 0 or at == step - 1}
        lines = (*self.lines[:step], session.line)
        return self._replace(lines=lines, at=step, result=result, sessions={**kept, step: session})


class Story:
    """The steps of a run, which the robot goes on with, or those of a recorded episode; one is the current step.

    The robot wakes when the first line is asked for.
    """

    def __init__(
        self,
        name: str,
        head: EpisodeLine,
        kb_files: tuple[str, ...],
        moment: StoryMoment,
        make: RobotMaker | None = None,
        goes_back: bool = True,
    ) -> None:
        self.name, self.kb_files = name, kb_files
        self._head, self._make, self._goes_back = head, make, goes_back
        self._moment = moment
        self._rules = AssumedRules()
        self._checked: dict[int, list[str]] = {}  # the facts of the recorded step that was asked for last

    # ---- reading ----

    @property
    def is_recorded(self) -> bool:
        """Whether this is a recorded episode, which ends at its last line."""
        return self._make is None

    @property
    def header(self) -> EpisodeLine:
        """The header of the episode, with the changes up to the current step."""
        entries = [change.entry for change in self.changes]
        return {**self._head, "changes": entries} if entries or "changes" in self._head else self._head

    @property
    def changes(self) -> tuple[Change, ...]:
        """The changes of the run up to the current step; damaged ones are left out."""
        return tuple(change for change in self._moment.changes if change.step <= self._moment.at)

    @property
    def is_awake(self) -> bool:
        """Whether lines can be read without waiting for the robot to wake."""
        return bool(self._moment.lines)

    @property
    def at(self) -> int:
        """The number of the current step."""
        return self._moment.at

    @property
    def lines(self) -> tuple[EpisodeLine, ...]:
        """The lines of all steps known so far, step 0 first."""
        return self._awake().lines

    @property
    def line(self) -> EpisodeLine:
        """The line of the current step."""
        return self.lines[self.at]

    @property
    def result(self) -> EpisodeLine | None:
        """The end, at the last step: `believed`, `achieved`, `verdict`, `reason`, `steps`; else None."""
        moment = self._awake()
        return moment.result if moment.at == len(moment.lines) - 1 else None

    @property
    def episode(self) -> Episode:
        """The episode so far."""
        return Episode(self.header, self.lines, self.result)

    @property
    def facts(self) -> list[str]:
        """The world model at the current step, as well-formed facts. Raises BadInputError for a damaged episode."""
        return self.facts_at(self.at)

    def facts_at(self, step: int) -> list[str]:
        """Return the world model at a known step, as well-formed facts; raise BadInputError where they are damaged."""
        if step in self._checked:
            return self._checked[step]
        facts = facts_of_line(self.lines[step], self._head["task"]["parameters"])
        if self.is_recorded:
            try:
                parse_facts(source_from_bytes(self.name, "\n".join(facts).encode("utf-8")))
            except BadInputError as bad:
                first = bad.problems[0]
                what = f"belief.facts, number {first.span.line}: {first.what}: the episode is damaged"
                raise self._damaged(step, what) from None
            self._checked = {step: facts}
        return facts

    @property
    def conditions(self) -> RunConditions:
        """The conditions that count at the current step; of a recorded episode as far as its header states them."""
        # Raises BadInputError when the header has errors.
        if not self.is_recorded:
            return self._moment.conditions_at(self.at)
        scenario = recorded_scenario(self.name, self._head, self.lines[0])
        conditions = RunConditions(scenario, Settings(kb_files=self.kb_files))
        for change in self.changes:
            with suppress(BadInputError):
                conditions = changed_conditions(conditions, change)
        return conditions

    @property
    def rule_files(self) -> tuple[str, ...]:
        """The paths of all rules that count at the current step: the user's files, and assumptions."""
        return self._files(self.conditions) if self.changes else self.kb_files

    @property
    def decision(self) -> Decision | None:
        """The robot's decision after the last line known so far; None where there is none, as in an episode."""
        moment = self._awake()
        if self.is_recorded or moment.result is not None:
            return None
        last = len(moment.lines) - 1
        if last not in moment.sessions:
            session = self._session_at(moment, last)
            self._moment = moment._replace(sessions={**moment.sessions, last: session})
        return getattr(self._moment.sessions[last].robot, "decision", None)

    @property
    def next_action(self) -> tuple[EpisodeLine | None, str] | None:
        """The command after the current step, as an episode states it, and its reason; None when there is none."""
        if self.at < len(self.lines) - 1:
            line = self.lines[self.at + 1]
            return line["action"], str(line.get("why", ""))
        decision = self.decision
        return None if decision is None else (action_entry(decision.command), str(decision.why))

    def picture(self) -> str:
        """Return the true table at the current step as a picture."""
        try:
            return draw(world_at(self._head, self.line))
        except (ValueError, shapely.errors.ShapelyError):  # a boundary that crosses itself, say
            what = f"step {self.at} does not record a table that can be drawn: the episode is damaged"
            raise self._damaged(self.at, what) from None

    # ---- going ----

    def advance(self) -> bool:
        """Go on by one step: along the known lines, or by letting the robot act. Return whether there was a step."""
        moment = self._awake()
        step = moment.at + 1
        if step < len(moment.lines):
            self._moment = moment._replace(at=step)
            return True
        if self.is_recorded or moment.result is not None:
            return False
        with self._rules.errors_as_typed():
            session = self._forward(self._session_at(moment, moment.at), moment, step)
        self._moment = self._moment.with_step(session, step)
        return True

    def go_to(self, step: int) -> None:
        """Go to a known step; raise IndexError when it is not known."""
        moment = self._awake()
        if not 0 <= step < len(moment.lines):
            raise IndexError(step)
        self._moment = moment._replace(at=step)

    # ---- changing ----

    def change(self, kind: str, text: str) -> RunConditions:
        """Change the run from the current step on: the impression of this step is interpreted anew."""
        moment = self._awake()
        now = moment.conditions_at(moment.at)
        new = Change(moment.at, kind, " ".join(text.split()))
        after = changed_conditions(now, new)
        changed = self._with_conditions(moment, after)._replace(changes=(*self.changes, new))
        same_run = self._files(after) == self._files(now) and after.task == now.task
        if same_run and moment.changes == self.changes:  # it counts for queries alone: the steps stay as they are
            self._moment = changed
        else:
            self._adopt(changed)
        return after

    def fork(self) -> "Story":
        """Return a story at the same step that goes on by itself, byte for byte as this one would."""
        moment, other = self._awake(), copy(self)
        other._moment = moment._replace(sessions={moment.at: self._copy_at(moment, moment.at)})
        return other

    def adopt(self, scenario: Scenario, settings: Settings) -> None:
        """Go on from the last step with another scenario in the same world, and with other options."""
        moment = self._awake()
        stage = {"until": moment.at, "options": self._head["options"], "task": self._head["task"]}
        head = header(scenario, settings) | {"forked": [*self._head.get("forked", ()), stage]}
        self._adopt(self._with_conditions(moment, RunConditions(scenario, settings)))
        self._head = head

    def relive(self) -> tuple["Story", int | None]:
        """Return a run that repeats this episode, at the current step; and the first step where it believes another."""
        scenario = recorded_scenario(self.name, self._head, self.lines[0])
        live = live_story(scenario, recorded_settings(self.name, self._head, self.kb_files))
        differing = None
        for step in range(self.at + 1):
            if step > 0 and not live.advance():
                raise self._damaged(step, f"the repeated run ends at step {step - 1}: another version of utak made it")
            for change in self.changes:
                if change.step == step:
                    live.change(change.kind, change.text)
            recorded, repeated = self.lines[step], live.line
            if keys := ", ".join(key for key in WORLD_KEYS if recorded.get(key) != repeated.get(key)):
                what = f"the repeated run differs at step {step} ({keys}): another version of utak made this episode"
                raise self._damaged(step, what)
            if differing is None and facts_of_line(recorded) != facts_of_line(repeated):
                differing = step
        return live, differing

    # ---- sessions ----

    def _awake(self) -> StoryMoment:
        """Return the present moment; let the robot wake first, unless it is awake."""
        if not self._moment.lines:
            self._moment = self._moment.with_step(self._session_at(self._moment, 0), 0)
        return self._moment

    def _files(self, conditions: RunConditions) -> tuple[str, ...]:
        """Return the paths of all rules under some conditions."""
        return (*conditions.settings.kb_files, *self._rules.files(conditions.assumptions))

    def _with_conditions(self, moment: StoryMoment, conditions: RunConditions) -> StoryMoment:
        """Return a moment with other conditions from its current step on."""
        earlier = {step: kept for step, kept in moment.conditions.items() if step < moment.at}
        return moment._replace(conditions={**earlier, moment.at: conditions})

    def _adopt(self, changed: StoryMoment) -> None:
        """Go on at the current step with the conditions that begin there in a changed moment."""
        with self._rules.errors_as_typed():
            session = self._adopted(self._session_at(self._moment, changed.at), changed, changed.at)
        self._moment = changed.with_step(session, changed.at)

    def _session_at(self, moment: StoryMoment, step: int) -> Session:
        """Return a session that rests at a step and may be used freely; for -1 one of a robot that sleeps."""
        if not self._goes_back and step in moment.sessions:  # used up: nothing rests there until the step is whole
            self._moment = moment._replace(sessions={})
            return moment.sessions[step]
        return self._copy_at(moment, step)

    def _copy_at(self, moment: StoryMoment, step: int) -> Session:
        """Return a copy of the run at a step, or the run repeated where it cannot be copied."""
        # Raises RunNotRepeatedError when a known step comes out otherwise.
        nearest = max((kept for kept in moment.sessions if kept <= step), default=-1)
        session: Session | None = None
        if nearest >= 0:
            with suppress(Exception):  # of whatever kind: a mind may hold files, locks or generators
                session = moment.sessions[nearest].fork()
        if session is None:
            assert self._make is not None
            scenario, settings, _ = moment.conditions[-1]
            nearest, session = -1, Session(scenario, settings, self._make, EpisodeLog(None))
        for at in range(nearest + 1, step + 1):
            ended = at > 0 and session.finished
            if ended or (self._forward(session, moment, at).line,) != (moment.lines[at : at + 1] or (session.line,)):
                raise RunNotRepeatedError(f"step {at} came out otherwise when the run was repeated")
        return session

    def _forward(self, session: Session, moment: StoryMoment, step: int) -> Session:
        """Let a session that rests at the step before take a step; return it with the conditions of that step."""
        if step == 0:
            session.wake()
        else:
            session.step()
        return self._adopted(session, moment, step) if step in moment.conditions else session

    def _adopted(self, session: Session, moment: StoryMoment, step: int) -> Session:
        """Let a session that rests at a step adopt the conditions that begin there; return it."""
        conditions = moment.conditions[step]
        settings = replace(conditions.settings, kb_files=self._files(conditions))
        if self._make is not None:
            warm_for(self._make, conditions.task, settings)
        session.adopt(conditions.scenario, settings)
        return session

    def _damaged(self, step: int, what: str) -> BadInputError:
        """Return, not raise, the error `what` at the line of a step."""
        return BadInputError.at(self.name, what, line=step + 2)


def live_story(scenario: Scenario, settings: Settings, make: RobotMaker = make_robot, goes_back: bool = True) -> Story:
    """Return the story of a run that begins; without `goes_back` no copies of it are kept for earlier steps."""
    moment = StoryMoment((), 0, None, conditions={-1: RunConditions(scenario, settings)})
    return Story("utak", header(scenario, settings), settings.kb_files, moment, make, goes_back)


def recorded_story(name: str, episode: Episode, kb_files: tuple[str, ...] = ()) -> Story:
    """Return the story of an episode that was read from a file."""
    entries = episode.header.get("changes")
    found = [_change_of(entry) for entry in entries] if isinstance(entries, list) else []
    changes = tuple(change for change in found if change is not None)
    return Story(name, episode.header, kb_files, StoryMoment(episode.steps, 0, episode.result, changes))


def _change_of(entry: Any) -> Change | None:
    """Return a change as a header states it; None for a damaged one."""
    if isinstance(entry, dict) and type(entry.get("step")) is int and entry["step"] >= 0:
        for kind in CHANGE_KINDS:
            if isinstance(entry.get(kind), str):
                return Change(entry["step"], kind, entry[kind])
    return None


def open_story(path: Path | str, settings: Settings) -> Story:
    """Return the story of a scenario folder, which is run, or of an episode file, at step 0."""
    if Path(path).is_dir():
        return live_story(read_scenario(path), settings)
    return recorded_story(str(path), read_begun_episode(path), settings.kb_files)
