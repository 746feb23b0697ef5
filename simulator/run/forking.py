"""Forks: a recorded run is repeated up to a step, and goes on with another task, other rules or other options.

The episode of a fork says in its header, as `forked`, which stages it consists of: until which command the run had
which options and which task. The impression after the last command of a stage is interpreted with what counts in the
next stage (`Session.adopt`). So it can be repeated, resumed and forked again without the episode that it comes from.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import takewhile
from typing import NamedTuple

from utak.kb.language.diagnostics import BadInputError
from utak.simulator.episode.episode import Episode, EpisodeLine, EpisodeLog, encode
from utak.simulator.episode.record import fact_lines, header, recorded_task, rules_sum
from utak.simulator.run.robots import make_robot, warm_for
from utak.simulator.run.session import Session
from utak.simulator.scenario.disturbances import stated_disturbances
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings


class RunStage(NamedTuple):
    """A part of a run with one task and one set of options."""

    entry: EpisodeLine  # the part as an element of `forked`; `until` is the last step, whose belief is the next part's
    scenario: Scenario  # the world and the task; without expectations
    settings: Settings  # the options


def recorded_stages(
    name: str, episode: Episode, step: int | None, scenario: Scenario, rules: Iterable[str]
) -> list[RunStage]:
    """Return the stages of a recorded run up to a step; for None those before its last one."""
    head, entries = episode.header, _entries(episode.header, step)
    if not entries:
        return []
    if step is not None and not 0 <= step < len(episode.steps):
        last = len(episode.steps) - 1
        what = f"there is no step {step}: the last is {last}" if episode.steps else "the episode has no step"
        raise BadInputError.at(name, what)
    if _world_until(head["world"], step) != _world_until(header(scenario, Settings())["world"], step):
        raise BadInputError.at(name, "the episode is of another world than the scenario's", "a fork keeps the world")
    steps = [change.get("step") for change in head.get("changes", ())]
    changed = min((at if isinstance(at, int) else 0 for at in steps), default=None)
    if changed is not None and (step is None or changed <= step):
        what = f"the run was changed at the prompt, from step {changed} on, and cannot be repeated beyond"
        raise BadInputError.at(name, what, "fork it at an earlier step, or change it again at the prompt of utak repl")
    if [entry["until"] for entry in entries] != sorted(entry["until"] for entry in entries):
        raise BadInputError.at(name, "forked: stages in the order of their steps are wanted: the episode is damaged")
    sums = {rules_sum(path): path for path in rules}
    return [
        RunStage(
            entry,
            Scenario(scenario.world, recorded_task(name, entry["task"]), None),
            _settings(name, entry["options"], sums),
        )
        for entry in entries
    ]


def _world_until(entry: EpisodeLine, step: int | None) -> tuple[str, list[str]]:
    """Return the world of a header as text, and what others did in it up to a step; for None all that they do."""
    stated = stated_disturbances(fact_lines(entry.get("disturbances", ())))
    world = {key: value for key, value in entry.items() if key != "disturbances"}
    return encode(world), [act.fact for act in stated if step is None or act.step <= step]


def options_at(head: EpisodeLine, step: int | None) -> EpisodeLine:
    """Return the options that a recorded run had at a step, by its header; for None those at its end."""
    options: EpisodeLine = (head if step is None else _entries(head, step)[-1])["options"]
    return options


def _entries(head: EpisodeLine, step: int | None) -> list[EpisodeLine]:
    """Return the stages of a recorded run up to a step, or those before its last one, as elements of `forked`."""
    entries: list[EpisodeLine] = list(head.get("forked", ()))
    if step is None:
        return entries
    before = list(takewhile(lambda entry: entry["until"] <= step, entries))
    last = entries[len(before)] if len(before) < len(entries) else head
    return [*before, {"until": step, "options": last["options"], "task": last["task"]}]


def _settings(name: str, options: EpisodeLine, sums: dict[str, str]) -> Settings:
    """Return recorded options as settings; raise BadInputError when a file of rules with a recorded sum is missing."""
    missing = [one for one in options["kb"] if one not in sums]
    if missing:
        hint = "give it with --kb to keep it, or with --from-kb for the repetition alone"
        what = f"the recorded run had a file of rules that is not given, with the SHA-256 sum {missing[0][:80]}"
        raise BadInputError.at(name, what, hint)
    values = {key: value for key, value in options.items() if key in Settings.__dataclass_fields__}
    return replace(Settings(), **values, kb_files=tuple(sums[one] for one in options["kb"]))


def repeat_stages(
    stages: Sequence[RunStage],
    scenario: Scenario,
    settings: Settings,
    log: EpisodeLog,
    name: str = "",
    recorded: Sequence[EpisodeLine] = (),
) -> Session:
    """Return a session at the end of some stages, ready to go on; it must repeat the recorded lines that are given."""

    def check() -> None:
        line = session.line
        if recorded and encode(line) != encode(recorded[line["step"]]):
            what = "the run does not repeat this line: another version of utak, or the episode was changed"
            raise BadInputError.at(name, what, line=line["step"] + 2)

    log.write(header(scenario, settings) | {"forked": [stage.entry for stage in stages]})
    session = Session(stages[0].scenario, stages[0].settings, make_robot, EpisodeLog(None))
    session.wake()
    following = [(stage.scenario, stage.settings) for stage in stages[1:]]
    for stage, after in zip(stages, [*following, (scenario, settings)], strict=True):
        until = stage.entry["until"]
        while session.line["step"] < until and not session.finished:
            check()
            log.write(session.line)
            session.step()
        if session.line["step"] < until:
            what = f"the run ends at step {session.line['step']}, and is to be forked at step {until}"
            raise BadInputError.at("utak", what, "another version of utak may have recorded it")
        if stage is stages[-1]:
            check()
        warm_for(make_robot, after[0].task, after[1])
        session.adopt(*after)
    session.write_to(log)
    return session
