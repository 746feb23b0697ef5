"""Forks: a recorded run is repeated up to a step, and goes on with another task, other rules or other options.

The episode of a fork says in its header, as `forked`, which stages it consists of: until which command the run had
which options and which task. The impression after the last command of a stage is interpreted with what counts in the
next stage (`Session.adopt`). So it can be repeated, resumed and forked again without the episode that it comes from.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import takewhile
from pathlib import Path
from typing import Any, NamedTuple

from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.simulator.episode.episode import Episode, EpisodeLine, EpisodeLog, encode
from utak.simulator.episode.record import header, recorded_task, rules_sum
from utak.simulator.run.robots import warm_for
from utak.simulator.run.session import RobotMaker, Session
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings


class RunStage(NamedTuple):
    """A part of a run with one task and one set of options."""

    until: int  # the number of the last step of the part; its belief is that of the following part
    scenario: Scenario  # the world and the task; without expectations
    settings: Settings  # the options
    entry: EpisodeLine  # the part as an element of `forked`


def stages_until(
    name: str, head: EpisodeLine, step: int | None, scenario: Scenario, kb_files: Sequence[str]
) -> list[RunStage]:
    """Return the stages of a recorded run up to a step."""
    if encode(head["world"]) != encode(header(scenario, Settings())["world"]):
        raise _unlike(name, 1, "the episode is of another world than the scenario's", "a fork keeps the world")
    steps = [change.get("step") for change in head.get("changes", ())]
    changed = [at if isinstance(at, int) else 0 for at in steps]
    if changed and (step is None or min(changed) <= step):
        what = f"the run was changed at the prompt, from step {min(changed)} on, and cannot be repeated beyond"
        raise _unlike(name, 1, what, "fork it at an earlier step, or change it again at the prompt of utak repl")
    entries = list(head.get("forked", ())) if step is None else _entries_until(head, step)
    if [entry["until"] for entry in entries] != sorted(entry["until"] for entry in entries):
        raise _unlike(name, 1, "forked: stages in the order of their steps are wanted: the episode is damaged")
    sums = {rules_sum(path): path for path in kb_files} if entries else {}
    return [
        RunStage(
            entry["until"],
            Scenario(scenario.world, recorded_task(name, entry["task"]), None),
            _settings(name, entry["options"], sums),
            entry,
        )
        for entry in entries
    ]


def _entries_until(head: EpisodeLine, step: int) -> list[EpisodeLine]:
    """Return the stages of a recorded run up to a step, as elements of `forked`."""
    entries: list[EpisodeLine] = list(head.get("forked", ()))
    before = list(takewhile(lambda entry: entry["until"] <= step, entries))
    last = entries[len(before)] if len(before) < len(entries) else head
    return [*before, {"until": step, "options": last["options"], "task": last["task"]}]


def options_at(head: EpisodeLine, step: int) -> EpisodeLine:
    """Return the options that a recorded run had at a step, by its header."""
    options: EpisodeLine = _entries_until(head, step)[-1]["options"]
    return options


def _settings(name: str, options: EpisodeLine, sums: dict[str, str]) -> Settings:
    """Return recorded options as settings; raise BadInputError when a file of rules with a recorded sum is missing."""
    missing = [one for one in options["kb"] if one not in sums]
    if missing:
        hint = "give it with --kb to keep it, or with --from-kb for the repetition alone"
        what = f"the recorded run had a file of rules that is not given, with the SHA-256 sum {missing[0][:80]}"
        raise _unlike(name, 1, what, hint)
    values: dict[str, Any] = {key: value for key, value in options.items() if key in Settings.__dataclass_fields__}
    return replace(Settings(), **values, kb_files=tuple(sums[one] for one in options["kb"]))


def repeat_stages(
    stages: Sequence[RunStage],
    scenario: Scenario,
    settings: Settings,
    make: RobotMaker,
    log: EpisodeLog,
    check: Callable[[EpisodeLine], None] = lambda line: None,
) -> Session:
    """Return a session at the end of some stages, ready to go on with a scenario and settings."""
    session = Session(stages[0].scenario, stages[0].settings, make, EpisodeLog(None))
    log.write(header(scenario, settings) | {"forked": [stage.entry for stage in stages]})
    session.wake()
    following = [(stage.scenario, stage.settings) for stage in stages[1:]]
    for stage, after in zip(stages, [*following, (scenario, settings)], strict=True):
        while session.line["step"] < stage.until and not session.finished:
            check(session.line)
            log.write(session.line)
            session.step()
        if session.line["step"] < stage.until:
            what = f"the run ends at step {session.line['step']}, and is to be forked at step {stage.until}"
            raise _unlike("utak", 1, what, "another version of utak may have recorded it")
        if stage is stages[-1]:
            check(session.line)
        warm_for(make, after[0].task, after[1])
        session.adopt(*after)
    session.write_to(log)
    return session


def repeat_until(
    name: Path | str,
    episode: Episode,
    step: int,
    scenario: Scenario,
    settings: Settings,
    make: RobotMaker,
    log: EpisodeLog,
    kb_files: Sequence[str] = (),
) -> Session:
    """Return a session that repeated a recorded run up to a step, ready to go on with a scenario and settings."""
    place = str(name)
    if not 0 <= step < len(episode.steps):
        last = len(episode.steps) - 1
        what = f"there is no step {step}: the last is {last}" if episode.steps else "the episode has no step"
        raise _unlike(place, 1, what)
    stages = stages_until(place, episode.header, step, scenario, [*settings.kb_files, *kb_files])

    def check(line: EpisodeLine) -> None:
        number = line["step"]
        if encode(line) != encode(episode.steps[number]):
            what = "the run does not repeat this line: another version of utak, or the episode was changed"
            raise _unlike(place, number + 2, what)

    return repeat_stages(stages, scenario, settings, make, log, check)


def _unlike(name: str, line: int, what: str, hint: str = "") -> BadInputError:
    """Return the error `what` at a line of an episode."""
    return BadInputError([Problem(name, SourceSpan(line, 1, 1), what, hint=hint)])
