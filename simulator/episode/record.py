"""The values in an episode's lines: options, world and task in its header, commands and motions in its steps."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import shapely

from utak.geometry.motion.se2 import Motion, Translate
from utak.kb.body import Command, Grasp, Release, Turn
from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.kb.language.reader import facts_from_text, parse_facts
from utak.kb.language.source_text import Source, read_source, source_from_bytes
from utak.kb.language.vocabulary import GOAL_VOCABULARY, START_VOCABULARY, check_facts
from utak.kb.task.task import Task, task_of
from utak.kb.world.facts import binding_facts
from utak.simulator.episode.episode import EpisodeLine
from utak.simulator.episode.schema import EPISODE_VERSION
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.world.world import Thing, World

SETTING_NAMES = ("seed", "noise", "paths", "max_steps", "pull")  # options of an episode that are settings of a run


def action_entry(command: Command | None) -> EpisodeLine | None:
    """Return a command as an episode states it, in Utak's frame; None for waking."""
    if command is None:
        return None
    do = type(command).__name__.lower()
    if isinstance(command, Grasp):
        return {"do": do, "direction": command.direction}
    if isinstance(command, Turn):
        return {"do": do, "degrees": command.degrees}
    if isinstance(command, Release):
        return {"do": do}
    return {"do": do, "east": command.east, "north": command.north}


def motion_entry(motion: Motion | None) -> EpisodeLine | None:
    """Return a true motion as an episode states it, in the table frame; None when nothing moved."""
    if motion is None:
        return None
    if isinstance(motion, Translate):
        return {"translate": [motion.dx, motion.dy]}
    return {"rotate": motion.degrees, "about": list(motion.about)}


def header(scenario: Scenario, settings: Settings) -> EpisodeLine:
    """Return the first line of an episode: options, world and task, without times and paths."""
    world, task = scenario.world, scenario.task
    options = {
        "seed": settings.seed,
        "noise": settings.noise,
        "paths": settings.paths,
        "max_steps": settings.max_steps,
        "pull": settings.pull,
        "kb": rule_sums(settings.kb_files),
    }
    task_entry = {
        "parameters": {name: parameter.kind for name, parameter in task.parameters.items()},
        "claims": [[str(claim.fact), claim.confidence] for claim in task.claims],
        "goals": [str(goal) for goal in task.goals],
        "expect": None if scenario.expectations is None else [str(fact) for fact in scenario.expectations],
    }
    return {
        "utak": "episode",
        "version": EPISODE_VERSION,
        "options": options,
        "world": _world_entry(world),
        "task": task_entry,
    }


def rules_sum(path: str) -> str:
    """Return the SHA-256 sum of a file of rules, in hexadecimal digits, by which an episode names it."""
    return hashlib.sha256(read_source(path).text.encode()).hexdigest()


def recorded_task(name: str, entry: EpisodeLine) -> Task:
    """Return the task in an episode's header."""
    try:
        claims = [f"confidence({fact}, {int(confidence)})." for fact, confidence in entry["claims"]]
        parameters = [f"{kind}({parameter})." for parameter, kind in entry["parameters"].items()]
        start, goal = (
            source_from_bytes(name, "\n".join(lines).encode("utf-8"))
            for lines in ([*parameters, *claims], [f"{fact}." for fact in entry["goals"]])
        )
        start_facts, goal_facts = parse_facts(start), parse_facts(goal)
        problems = check_facts(start, start_facts, START_VOCABULARY) + check_facts(goal, goal_facts, GOAL_VOCABULARY)
        if problems:
            raise BadInputError(problems)
        return task_of(start, start_facts, goal, goal_facts)
    except (BadInputError, TypeError, ValueError) as bad:
        why = bad.problems[0].what if isinstance(bad, BadInputError) else "a claim is no fact with a confidence"
        raise BadInputError([Problem(name, SourceSpan(1, 1, 1), f"task: {why}: the episode is damaged")]) from None


def _world_entry(world: World) -> EpisodeLine:
    """Return a world as an episode states it."""

    def entry(thing: Thing) -> EpisodeLine:
        return {"colour": thing.colour, "rings": _rings(thing.polygon)}

    return {
        "table": [world.width, world.height],
        "heading": world.heading,
        "verge": [_rings(part) for part in getattr(world.verge, "geoms", [world.verge]) if not part.is_empty],
        "fixed": {thing.name: entry(thing) for thing in world.fixed},
        "movable": {thing.name: entry(thing) for thing in world.movable},
    }


def _rings(polygon: Any) -> list[list[list[float]]]:
    """Return the outer ring and the holes of a polygon, each without its repeated last point."""
    rings = [polygon.exterior, *polygon.interiors]
    return [[[float(x), float(y)] for x, y in ring.coords[:-1]] for ring in rings]


def recorded_world(head: EpisodeLine) -> World:
    """Return the world in an episode's header, as far as a picture needs it; Utak is put at (0, 0)."""
    # Raises KeyError, TypeError or ValueError when the header is not as `header` makes it.
    entry = head["world"]
    width, height = entry["table"]
    verge = shapely.MultiPolygon([shapely.Polygon(rings[0], rings[1:]) for rings in entry["verge"]])
    movable, fixed = (tuple(_thing(*item) for item in entry[kind].items()) for kind in ("movable", "fixed"))
    return World(int(width), int(height), verge, movable, fixed, (0.0, 0.0), int(entry["heading"]))


def facts_of_line(line: EpisodeLine, parameters: Mapping[str, Any] | None = None) -> list[str]:
    """Return the world model in an episode's line as facts; [] when it has none."""
    believed: Any = line.get("belief")
    facts: Any = believed.get("facts") if isinstance(believed, dict) else None
    if not isinstance(facts, list):
        return []
    found = [str(fact) for fact in facts]
    bound = believed.get("bound")
    if isinstance(bound, dict) and not any(fact.startswith(("parameter(", "bound(")) for fact in found):
        kinds = {name: getattr(kind, "kind", kind) for name, kind in (parameters or {}).items()}
        names = [name for name, kind in kinds.items() if kind == "object"]
        found += [f"{fact}." for fact in binding_facts({str(x): str(node) for x, node in bound.items()}, names)]
    return found


def recorded_scenario(head: EpisodeLine, waking: EpisodeLine) -> Scenario:
    """Return the scenario of an episode, so that its run can be repeated."""
    world, entry = recorded_world(head), head["task"]
    x, y = waking["utak"]
    verge = world.verge.geoms[0] if len(world.verge.geoms) == 1 else world.verge
    start = [f"{kind}({name})" for name, kind in entry["parameters"].items()]
    start += [f"confidence({fact},{int(confidence)})" for fact, confidence in entry["claims"]]
    sources = [Source("start.lp", _as_text(start)), Source("goal.lp", _as_text(entry["goals"]))]
    facts = [parse_facts(source) for source in sources]
    for source, stated, vocabulary in zip(sources, facts, (START_VOCABULARY, GOAL_VOCABULARY), strict=True):
        if problems := check_facts(source, stated, vocabulary):
            raise BadInputError(problems)
    expected = entry["expect"]
    return Scenario(
        replace(world, verge=verge, utak=(float(x), float(y))),
        task_of(sources[0], facts[0], sources[1], facts[1]),
        None if expected is None else facts_from_text(_as_text(expected), "expect.lp"),
    )


def _as_text(facts: Iterable[str]) -> str:
    """Return facts without full stops as the text of a fact file."""
    return "".join(f"{fact}.\n" for fact in facts)


def recorded_settings(head: EpisodeLine, kb_files: tuple[str, ...]) -> Settings:
    """Return the options of an episode."""
    options = dict(head["options"])
    sums = options.pop("kb")
    if sums != rule_sums(kb_files):
        raise ValueError(f"it was made with {len(sums)} rule files, which must be given again with --kb")
    return Settings(kb_files=kb_files, **{name: value for name, value in options.items() if name in SETTING_NAMES})


def rule_sums(kb_files: tuple[str, ...]) -> list[str]:
    """Return the SHA-256 sums of rule files in order, as a header holds them."""
    return [rules_sum(path) for path in kb_files]


def _thing(name: str, entry: EpisodeLine) -> Thing:
    """Return a thing in an episode's header."""
    return Thing(name, str(entry["colour"]), shapely.Polygon(entry["rings"][0], entry["rings"][1:]))
