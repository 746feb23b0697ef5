"""A run that is read step by step, back and forth, and changed on the way."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import NamedTuple

import shapely

from utak.kb.language.diagnostics import BadInputError
from utak.simulator.episode.episode import EpisodeLine, EpisodeLog
from utak.simulator.episode.record import action_entry, facts_of_line, header
from utak.simulator.run.changes import AssumedRules, Change, RunConditions, changed_conditions
from utak.simulator.run.robots import make_robot, warm_for
from utak.simulator.run.session import RobotMaker, Session
from utak.simulator.scenario.picture import draw
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings

MAX_KEPT_SESSIONS = 12  # copies of the run that are kept for going on from earlier steps; a convention


class StoryMoment(NamedTuple):
    """All that a live story knows at one moment. It is replaced as a whole, so an interrupt cannot tear it."""

    lines: tuple[EpisodeLine, ...]  # the lines of all steps seen so far; () while the robot sleeps
    at: int  # the current step
    result: EpisodeLine | None  # the end of the run, which belongs to the last line; None while it goes on
    sessions: Mapping[int, Session]  # copies of the run, by the step at which each rests
    # What counts besides the scenario, by the step from which it counts; there is one for -1
    conditions: Mapping[int, RunConditions]
    changes: tuple[Change, ...] = ()  # the changes of the run, in the order of their steps

    def conditions_at(self, step: int) -> RunConditions:
        """Return what counts at a step besides the scenario."""
        return self.conditions[max(begin for begin in self.conditions if begin <= step)]

    def with_step(self, session: Session, step: int) -> "StoryMoment":
        """Return the moment at a step at which a session rests; later lines and copies are dropped."""
        result = session.end().line["result"] if session.finished else None
        kept = {at: other for at, other in self.sessions.items() if at < step}
        while len(kept) >= MAX_KEPT_SESSIONS:  # every second one is forgotten, but for the newest
            kept = {at: other for n, (at, other) in enumerate(kept.items()) if n % 2 == 0 or at == step - 1}
        lines = (*self.lines[:step], session.line)
        return self._replace(lines=lines, at=step, result=result, sessions={**kept, step: session})


class LiveStory:
    """A run of the robot in a scenario, with all lines so far. The robot wakes when the first line is asked for."""

    def __init__(self, scenario: Scenario, settings: Settings, make: RobotMaker = make_robot) -> None:
        self.scenario, self.settings = scenario, settings
        self._make = make
        self._rules = AssumedRules()
        self._moment = StoryMoment((), 0, None, {}, {-1: RunConditions((), scenario.task)})

    # ---- reading ----

    @property
    def header(self) -> EpisodeLine:
        """The header of the episode so far; `changes` is there when the run was changed."""
        head, entries = header(self.scenario, self.settings), [change.entry for change in self.changes]
        return {**head, "changes": entries} if entries else head

    @property
    def changes(self) -> tuple[Change, ...]:
        """The changes of the run up to the current step."""
        return tuple(change for change in self._moment.changes if change.step <= self._moment.at)

    @property
    def is_awake(self) -> bool:
        """Whether the robot was woken; until then nothing is known of the run."""
        return bool(self._moment.lines)

    @property
    def at(self) -> int:
        """The number of the current step."""
        return self._moment.at

    @property
    def lines(self) -> Sequence[EpisodeLine]:
        """The lines of all steps seen so far, step 0 first."""
        return self._awake().lines

    @property
    def line(self) -> EpisodeLine:
        """The line of the current step."""
        moment = self._awake()
        return moment.lines[moment.at]

    @property
    def result(self) -> EpisodeLine | None:
        """The end of the run, at its last step; else None."""
        moment = self._awake()
        return moment.result if moment.at == len(moment.lines) - 1 else None

    @property
    def facts(self) -> list[str]:
        """The world model at the current step, as facts."""
        return self.facts_at(self._moment.at)

    def facts_at(self, step: int) -> list[str]:
        """Return the world model at a step that was seen, as facts."""
        return facts_of_line(self.lines[step], self.scenario.task.parameters)

    @property
    def conditions(self) -> RunConditions:
        """The conditions that count at the current step besides the scenario."""
        return self._moment.conditions_at(self._moment.at)

    @property
    def rule_files(self) -> tuple[str, ...]:
        """The paths of all rules that count at the current step: the user's files, and assumptions."""
        return self._files(self.conditions)

    @property
    def next_action(self) -> tuple[EpisodeLine | None, str] | None:
        """The command after the current step, as an episode states it, and its reason; None when there is none."""
        moment = self._awake()
        if moment.at < len(moment.lines) - 1:
            line = moment.lines[moment.at + 1]
            return line["action"], str(line.get("why", ""))
        decision = getattr(self._session_at(moment, moment.at).robot, "decision", None)
        if moment.result is not None or decision is None:
            return None
        return action_entry(decision.command), str(decision.why)

    def picture(self) -> str:
        """Return the true table at the current step as a picture."""
        line = self.line
        polygons = {name: shapely.Polygon(ring) for name, ring in line["objects"].items()}
        x, y = line["utak"]
        return draw(self.scenario.world, polygons, (x, y))

    # ---- going ----

    def advance(self) -> bool:
        """Go on by one step: along the lines seen, or by letting the robot act. Return whether there was a step."""
        moment = self._awake()
        step = moment.at + 1
        if step < len(moment.lines):
            self._moment = moment._replace(at=step)
            return True
        if moment.result is not None:
            return False
        with self._errors_as_typed():
            session = self._forward(self._session_at(moment, moment.at), moment, step)
        self._moment = moment.with_step(session, step)
        return True

    def go_to(self, step: int) -> None:
        """Go to a step that was seen already; raise IndexError when it was not."""
        moment = self._awake()
        if not 0 <= step < len(moment.lines):
            raise IndexError(step)
        self._moment = moment._replace(at=step)

    # ---- changing ----

    def change(self, kind: str, text: str) -> RunConditions:
        """Change the run from the current step on: the impression of this step is interpreted anew."""
        moment = self._awake()
        new = Change(moment.at, kind, " ".join(text.split()))
        after = changed_conditions(moment.conditions_at(moment.at), new, self.settings.kb_files)
        earlier = {step: kept for step, kept in moment.conditions.items() if step < moment.at}
        changed = moment._replace(conditions={**earlier, moment.at: after}, changes=(*self.changes, new))
        now = moment.conditions_at(moment.at)
        same_run = self._files(after) == self._files(now) and after.task == now.task
        if same_run and moment.changes == self.changes:  # it counts for queries alone: the steps stay as they are
            self._moment = changed
            return after
        with self._errors_as_typed():
            session = self._adopted(self._session_at(moment, moment.at), changed, moment.at)
        self._moment = changed.with_step(session, moment.at)
        return after

    # ---- sessions ----

    def _awake(self) -> StoryMoment:
        """Return the present moment; let the robot wake first, unless it is awake."""
        if not self._moment.lines:
            self._moment = self._moment.with_step(self._session_at(self._moment, 0), 0)
        return self._moment

    def _files(self, conditions: RunConditions) -> tuple[str, ...]:
        """Return the paths of all rules under some conditions."""
        return (*self.settings.kb_files, *self._rules.files(conditions.assumptions))

    def _session_at(self, moment: StoryMoment, step: int) -> Session:
        """Return a session that rests at a step and may be used freely; for -1 one of a robot that sleeps."""
        nearest = max((kept for kept in moment.sessions if kept <= step), default=-1)
        session: Session | None = None
        if nearest >= 0:
            with suppress(Exception):  # a robot that cannot be copied: the run is repeated
                session = moment.sessions[nearest].fork()
        if session is None:
            nearest, session = -1, Session(self.scenario, self.settings, self._make, EpisodeLog(None))
        for at in range(nearest + 1, step + 1):
            self._forward(session, moment, at)
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
        scenario = self.scenario
        if conditions.is_changed_task:  # nothing is expected of the truth any more
            scenario = replace(scenario, task=conditions.task, expectations=None)
        settings = replace(self.settings, kb_files=self._files(conditions))
        warm_for(self._make, scenario.task, settings)
        session.adopt(scenario, settings)
        return session

    @contextmanager
    def _errors_as_typed(self) -> Iterator[None]:
        """Let errors in the rule files of assumptions, in a `with` block, name what was typed."""
        try:
            yield
        except BadInputError as bad:
            raise self._rules.named_as_typed(bad) from None
