"""The scenario and the options of a recorded run, as far as they are needed to repeat it."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import shapely

from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.kb.language.reader import facts_from_text, parse_facts
from utak.kb.language.source_text import read_source, source_from_bytes
from utak.kb.language.terms import Fact
from utak.kb.language.vocabulary import EXPECTATION_VOCABULARY, GOAL_VOCABULARY, START_VOCABULARY, check_facts
from utak.kb.task.task import CERTAIN_CONFIDENCE, Task, task_of
from utak.simulator.episode.episode import Episode, EpisodeLine
from utak.simulator.episode.record import recorded_world
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings, kb_files_named


@dataclass(frozen=True)
class RecordedRun:
    """A run that can be repeated."""

    scenario: Scenario  # what determines the run
    settings: Settings
    episode: Episode  # what was recorded of it


def recorded_run(name: str, episode: Episode, rule_files: Sequence[str] = ()) -> RecordedRun:
    """Return the run that an episode records."""
    if not episode.steps:
        raise _damaged(name, "the episode ends before its first step: it does not say where the robot woke")
    head = episode.header
    try:
        x, y = episode.steps[0]["utak"]
        world = replace(recorded_world(head), utak=(float(x), float(y)))
        for thing in (*world.movable, *world.fixed):
            shapely.prepare(thing.polygon)
    except (KeyError, TypeError, ValueError, IndexError, shapely.errors.ShapelyError):
        raise _damaged(name, "the header does not state a world that can be built: the episode is damaged") from None
    entry = head["task"]
    task = task_from_texts(start_text(entry["parameters"], entry["claims"]), _lines(entry["goals"]), name)
    expected = entry["expect"]
    expectations = None if expected is None else _expectations(_lines(expected), name)
    return RecordedRun(Scenario(world, task, expectations), _settings(name, head, rule_files), episode)


def start_text(parameters: dict[str, str], claims: Sequence[Sequence[object]]) -> str:
    """Return start.lp for parameters (name: kind) and claims ((fact, confidence in percent))."""
    rows = [f"{kind}({name})." for name, kind in parameters.items()]
    for fact, confidence in claims:
        rows.append(f"{fact}." if confidence == CERTAIN_CONFIDENCE else f"confidence({fact},{confidence}).")
    return "\n".join(rows) + "\n"


def task_from_texts(start: str, goal: str, name: str = "task") -> Task:
    """Return the task that the texts of start.lp and goal.lp state; raise BadInputError when they state none."""
    sources = [source_from_bytes(f"{name}: {part}", text.encode()) for part, text in (("start", start), ("goal", goal))]
    problems: list[Problem] = []
    facts = []
    for source, vocabulary in zip(sources, (START_VOCABULARY, GOAL_VOCABULARY), strict=True):
        facts.append(parse_facts(source))
        problems += check_facts(source, facts[-1], vocabulary)
    if problems:
        raise BadInputError(problems)
    return task_of(sources[0], facts[0], sources[1], facts[1])


def _expectations(text: str, name: str) -> tuple[Fact, ...]:
    """Return the facts of expect.lp, checked."""
    source = source_from_bytes(f"{name}: expect", text.encode())
    facts = parse_facts(source)
    problems = check_facts(source, facts, EXPECTATION_VOCABULARY)
    if problems:
        raise BadInputError(problems)
    return facts


def facts_of(texts: Sequence[str]) -> tuple[Fact, ...]:
    """Return the facts that some texts without full stops state."""
    return facts_from_text(_lines(texts))


def _lines(facts: Sequence[object]) -> str:
    """Return facts as the text of a fact file."""
    return "".join(f"{fact}.\n" for fact in facts)


def _settings(name: str, head: EpisodeLine, rule_files: Sequence[str]) -> Settings:
    """Return the options of a run; raise BadInputError when the rules given are not those of the run."""
    options = head["options"]
    given = [hashlib.sha256(read_source(path).text.encode()).hexdigest() for path in rule_files]
    if given != options["kb"]:
        count = len(options["kb"])
        what = (
            f"the run used {count} file{'s' * (count != 1)} of rules, and {len(given)} are given"
            if count != len(given)
            else ("the run used other rules than the files that are given, or another order of them")
        )
        raise BadInputError([Problem(name, SourceSpan(1, 1, 1), what, hint="name its rules with --kb FILE")])
    return Settings(
        seed=options["seed"],
        noise=options["noise"],
        paths=options["paths"],
        max_steps=options["max_steps"],
        kb_files=kb_files_named(list(rule_files)),
        pull=options.get("pull", True),
    )


def _damaged(name: str, what: str) -> BadInputError:
    """Return the error `what` about the header of an episode."""
    return BadInputError([Problem(name, SourceSpan(1, 1, 1), what)])
