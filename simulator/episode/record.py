"""The values in an episode's lines: options, world and task in its header, commands and motions in its steps."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import asdict, replace
from typing import Any

import shapely

from utak.geometry.motion.se2 import Motion, Translate
from utak.kb.body import Command
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import read_source, source_from_bytes
from utak.kb.language.vocabulary import EXPECTATION_VOCABULARY, check_facts
from utak.kb.task.task import Task, task_from_texts
from utak.kb.world.facts import binding_facts
from utak.simulator.episode.episode import EpisodeLine
from utak.simulator.episode.schema import EPISODE_VERSION
from utak.simulator.scenario.disturbances import stated_disturbances
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import SETTING_NAMES, Settings
from utak.simulator.world.world import Thing, World, outer_ring


def action_entry(command: Command | None) -> EpisodeLine | None:
    """Return a command as an episode states it, in Utak's frame; None for waking."""
    if command is None:
        return None
    return {"do": type(command).__name__.lower(), **asdict(command)}


def motion_entry(motion: Motion | None) -> EpisodeLine | None:
    """Return a true motion as an episode states it, in the table frame; None when nothing moved."""
    if motion is None:
        return None
    if isinstance(motion, Translate):
        return {"translate": [motion.dx, motion.dy]}
    return {"rotate": motion.degrees, "about": list(motion.about)}


def disturbance_entries(disturbed: Mapping[str, Any], refused: Mapping[str, str]) -> EpisodeLine:
    """Return what others did and could not do before a command, as its line states it; {} for nothing."""
    entries: EpisodeLine = {}
    if disturbed:
        entries["disturbed"] = {
            name: list(place) if name == "utak" else [list(point) for point in outer_ring(place)]
            for name, place in disturbed.items()
        }
    return entries | ({"refused": dict(refused)} if refused else {})


def header(scenario: Scenario, settings: Settings) -> EpisodeLine:
    """Return the first line of an episode: options, world and task, without times and paths."""
    world, task = scenario.world, scenario.task
    task_entry = {
        "parameters": {name: parameter.kind for name, parameter in task.parameters.items()},
        "claims": [[str(claim.fact), claim.confidence] for claim in task.claims],
        "goals": [str(goal) for goal in task.goals],
        "expect": None if scenario.expectations is None else [str(fact) for fact in scenario.expectations],
    }
    return {
        "utak": "episode",
        "version": EPISODE_VERSION,
        "options": settings.options | {"kb": rule_sums(settings.kb_files)},
        "world": _world_entry(world),
        "task": task_entry,
    }


def rules_sum(path: str) -> str:
    """Return the SHA-256 sum of a file of rules, in hexadecimal digits, by which an episode names it."""
    return hashlib.sha256(read_source(path).text.encode()).hexdigest()


def recorded_task(name: str, entry: EpisodeLine) -> Task:
    """Return the task in an episode's header."""
    try:
        start = [f"{kind}({parameter})" for parameter, kind in entry["parameters"].items()]
        start += [f"confidence({fact},{int(confidence)})" for fact, confidence in entry["claims"]]
        return task_from_texts(fact_lines(start), fact_lines(entry["goals"]), name)
    except (BadInputError, TypeError, ValueError) as bad:
        why = bad.problems[0].what if isinstance(bad, BadInputError) else "a claim is no fact with a confidence"
        raise BadInputError.at(name, f"task: {why}: the episode is damaged") from None


def _world_entry(world: World) -> EpisodeLine:
    def entry(thing: Thing) -> EpisodeLine:
        return {"colour": thing.colour, "rings": _rings(thing.polygon)}

    disturbances = [act.fact for act in world.disturbances]
    return {
        "table": [world.width, world.height],
        "heading": world.heading,
        "verge": [_rings(part) for part in getattr(world.verge, "geoms", [world.verge]) if not part.is_empty],
        "fixed": {thing.name: entry(thing) for thing in world.fixed},
        "movable": {thing.name: entry(thing) for thing in world.movable},
        **({"disturbances": disturbances} if disturbances else {}),
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
    world = World(int(width), int(height), verge, movable, fixed, (0.0, 0.0), int(entry["heading"]))
    return replace(world, disturbances=stated_disturbances(fact_lines(entry.get("disturbances", ()))))


def world_at(head: EpisodeLine, line: EpisodeLine) -> World:
    """Return the true world at a step, by its line and the episode's header."""
    # Raises LookupError, TypeError, ValueError or ShapelyError when they are not as an episode has them.
    x, y = line["utak"]
    return recorded_world(head).moved({name: shapely.Polygon(ring) for name, ring in line["objects"].items()}, (x, y))


def facts_of_line(line: EpisodeLine, parameters: Mapping[str, str] | None = None) -> list[str]:
    """Return the world model in an episode's line as facts; parameters : those of the task, with their kinds."""
    believed, found = line["belief"], list(line["belief"]["facts"])
    if "bound" in believed and not any(fact.startswith(("parameter(", "bound(")) for fact in found):  # an older episode
        names = [name for name, kind in (parameters or {}).items() if kind == "object"]
        found += [f"{fact}." for fact in binding_facts(believed["bound"], names)]
    return found


def recorded_scenario(name: str, head: EpisodeLine, waking: EpisodeLine) -> Scenario:
    """Return the scenario of an episode, so that its run can be repeated."""
    try:
        x, y = waking["utak"]
        world = recorded_world(head)
        verge = world.verge.geoms[0] if len(world.verge.geoms) == 1 else world.verge
        for thing in (*world.movable, *world.fixed):
            shapely.prepare(thing.polygon)
        entry = head["task"]
        task = recorded_task(name, entry)
        expected = None if entry["expect"] is None else fact_lines(entry["expect"])
    except (ValueError, LookupError, TypeError, AttributeError, shapely.errors.ShapelyError):
        what = "the header does not state a world that can be built: the episode is damaged"
        raise BadInputError.at(name, what) from None
    expectations = None
    if expected is not None:
        source = source_from_bytes(f"{name}: expect", expected.encode())
        expectations = parse_facts(source)
        if problems := check_facts(source, expectations, EXPECTATION_VOCABULARY):
            raise BadInputError(problems)
    return Scenario(replace(world, verge=verge, utak=(float(x), float(y))), task, expectations)


def fact_lines(facts: Iterable[object]) -> str:
    """Return facts without full stops as the text of a fact file."""
    return "".join(f"{fact}.\n" for fact in facts)


def recorded_settings(name: str, head: EpisodeLine, kb_files: tuple[str, ...]) -> Settings:
    """Return the options of a run; raise BadInputError when the rules given are not those of the run."""
    options = head["options"]
    used, given = options["kb"], rule_sums(kb_files)
    if given != used:
        what = "the run used other rules than the files that are given, or another order of them"
        if len(given) != len(used):
            what = f"the run used {len(used)} file{'s' * (len(used) != 1)} of rules, and {len(given)} are given"
        raise BadInputError.at(name, what, "name its rules with --kb FILE")
    return Settings(kb_files=kb_files, **{name: options[name] for name in SETTING_NAMES if name in options})


def rule_sums(kb_files: tuple[str, ...]) -> list[str]:
    """Return the SHA-256 sums of rule files in order, as a header holds them."""
    return [rules_sum(path) for path in kb_files]


def _thing(name: str, entry: EpisodeLine) -> Thing:
    return Thing(name, str(entry["colour"]), shapely.Polygon(entry["rings"][0], entry["rings"][1:]))
