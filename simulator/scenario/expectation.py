"""expect.lp: what must be true at the end of an episode, and whether it is."""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import shapely
from shapely.affinity import rotate, translate

from utak.kb.language.arguments import abbreviated, decimal_value, text_value
from utak.kb.language.diagnostics import BadInputError, Problem, did_you_mean
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import Source, read_source
from utak.kb.language.terms import Fact, Symbol, Term
from utak.kb.language.vocabulary import EXPECTATION_VOCABULARY, check_facts
from utak.kb.language.wkt import parse_wkt
from utak.simulator.scenario.trialfile import TRIAL_FILE
from utak.simulator.world.world import World, outer_ring

EXPECTATION_TOLERANCE = 1e-3  # squares; `inside` and `near` hold within it; a convention
MIN_CIRCLING_DEGREES = 330.0  # degrees of winding that count as once around (docs/files.md)
# By the name of an expectation: the index of the argument that names a thing.
THING_ARGUMENT_INDEX = {"inside": 0, "near": 0, "visits": 0, "avoids": 0, "circles": 1, "unmoved": 0, "pose": 0}
WALKER_EXPECTATIONS = ("inside", "near", "visits", "avoids")  # those whose thing may be the robot itself
MAX_NAMES_SHOWN = 12  # names of things that a hint lists; a convention
MAX_KEPT_REGIONS = 256  # regions of expectations that were read, so that a halt of a play costs little; a convention
NOT_ABOUT_THE_TRUTH = ("fails", "weight")  # facts of expect.lp that the truth at the end does not decide


class Snapshot(NamedTuple):
    """The true state at one step."""

    step: int  # the number of commands so far
    utak: tuple[float, float]  # Utak's place (x, y), squares, table frame
    polygons: Mapping[str, Any]  # the outlines of the movable things by name, squares, table frame


def read_expectations(path: Path | str, world: World | None) -> tuple[Fact, ...]:
    """Return the facts of expect.lp, checked."""
    source = read_source(path)
    facts = parse_facts(source)
    problems = check_facts(source, facts, EXPECTATION_VOCABULARY)
    if all(fact.name == "weight" for fact in facts):
        hint = "such as within(50). or fails.; without expected facts leave the file out"
        what = "expect.lp is empty" if not facts else "there are weights alone"
        problems = problems or [source.problem(source.start(), f"nothing is expected: {what}", hint)]
    if not problems:
        asked = Path(path).with_name(TRIAL_FILE).exists()  # questions may be worth points, too
        problems = [*_contradictions(source, facts), *_bad_weights(source, facts, asked)]
    if world is not None and not problems:
        problems = list(_unknown_names(source, facts, world))
    if problems:
        raise BadInputError(problems)
    return facts


def _contradictions(source: Source, facts: Sequence[Fact]) -> Iterator[Problem]:
    """Yield a problem for each expectation that is stated twice, and for verdicts that cannot hold together."""
    seen: dict[Fact, int] = {}
    for fact in facts:
        if fact in seen and fact.name != "weight":
            yield source.problem(fact.span, f"stated twice: {abbreviated(fact)}", f"first on line {seen[fact]}")
        seen.setdefault(fact, fact.span.line)
    verdicts = [fact for fact in seen if fact.name == "verdict"]
    for again in verdicts[1:]:
        hint = f"{verdicts[0]} is expected on line {verdicts[0].span.line}"
        yield source.problem(again.span, "a run has one verdict, and another one is expected already", hint)
    if should_fail(facts):
        for fact in verdicts:
            if str(fact.args[0]) == "done":
                yield source.problem(fact.span, "verdict(done) contradicts fails, which the file states, too")


def _bad_weights(source: Source, facts: Sequence[Fact], asked: bool) -> Iterator[Problem]:
    """Yield a problem for each weight of a fact that is not expected or has one already, and when all points are 0."""
    expected = [fact for fact in facts if fact.name != "weight"]
    seen: dict[str, int] = {}
    for weight in facts:
        if weight.name != "weight":
            continue
        weighed = weight.args[0]
        if weighed not in expected:
            hint = did_you_mean(str(weighed), map(str, expected)) or "state it as a fact of its own, too"
            yield source.problem(weighed.span, f"{abbreviated(weighed)} is weighed, but not expected", hint)
        elif str(weighed) in seen:
            hint = f"the first is on line {seen[str(weighed)]}"
            yield source.problem(weight.span, f"a second weight of {abbreviated(weighed)}", hint)
        seen.setdefault(str(weighed), weight.span.line)
    if seen and not asked and not any(weights_of(facts).values()):
        last = next(fact for fact in reversed(facts) if fact.name == "weight")
        hint = "give at least one expectation a weight of 1 or more"
        yield source.problem(last.args[1].span, "all weights are 0: there is no point to be earned", hint)


def weights_of(facts: Sequence[Fact]) -> dict[Fact, int]:
    """Return the points of each tested expectation of expect.lp, in the order of the file; 1 without a `weight`."""
    stated = {fact.args[0]: number_of(fact) for fact in facts if fact.name == "weight"}
    failing = should_fail(facts)
    return {
        fact: stated.get(fact, 1)
        for fact in facts
        if fact.name != "weight" and (not failing or fact.name in ("fails", "verdict") or fact in stated)
    }


def about_things(stated: Term) -> Iterator[tuple[Symbol, Term]]:
    """Yield each expectation about a thing that a fact states or is about, with the name of the thing."""
    if isinstance(stated, Symbol):
        if stated.name in THING_ARGUMENT_INDEX:
            yield stated, stated.args[THING_ARGUMENT_INDEX[stated.name]]
        for inner in stated.args if stated.name in ("weight", "before") else ():
            yield from about_things(inner)


def _unknown_names(source: Source, facts: Sequence[Fact], world: World) -> Iterator[Problem]:
    """Yield a problem for each name of a thing that the world does not have."""
    movable = {thing.name for thing in world.movable}
    known = sorted(movable | {thing.name for thing in world.fixed})
    for fact, term in (named for stated in facts for named in about_things(stated)):
        names = [*known, "utak"] if fact.name in WALKER_EXPECTATIONS else known
        if str(term) not in names:
            shown = ", ".join(names[:MAX_NAMES_SHOWN]) + " ..." * (len(names) > MAX_NAMES_SHOWN)
            hint = did_you_mean(str(term), names) or f"there are {shown}"
            yield source.problem(term.span, f"the world has no object {term}", hint if names else "")
        elif fact.name == "pose" and str(term) not in movable:
            yield source.problem(term.span, f"{term} is fixed: a pose is expected of things that can be moved")


def should_fail(expectations: Sequence[Fact]) -> bool:
    """Return whether the task is expected to be impossible (`fails`), so that Utak must not believe it done."""
    return any(fact.name == "fails" for fact in expectations)


def expects_verdict(expectations: Sequence[Fact]) -> bool:
    """Return whether expect.lp says what the verdict is to be, by `fails` or by `verdict(V)`; else it is `done`."""
    return any(fact.name in ("fails", "verdict") for fact in expectations)


def unmet(
    expectations: Sequence[Fact], world: World, track: Sequence[Snapshot], verdict: str | None = None
) -> list[Fact]:
    """Return the expectations that the truth does not meet."""
    return list(shortfalls(expectations, world, track, verdict))


def shortfalls(
    expectations: Sequence[Fact], world: World, track: Sequence[Snapshot], verdict: str | None = None
) -> dict[Fact, str]:
    """Return the expectations that the truth does not meet, each with what came instead, in words."""
    fixed = {thing.name: thing.polygon for thing in world.fixed}
    snapshots = [Snapshot(one.step, one.utak, {**fixed, **one.polygons}) for one in track]
    found: dict[Fact, str] = {}
    for fact in expectations:
        if fact.name == "verdict":
            came = f"the verdict is {verdict}" if verdict not in (None, str(fact.args[0])) else ""
        else:
            came = "" if fact.name in NOT_ABOUT_THE_TRUTH else _CHECKS[fact.name](fact, snapshots)
        if came:
            found[fact] = came
    return found


@lru_cache(MAX_KEPT_REGIONS)
def region_of(fact: Fact) -> Any:
    """Return the shape in a fact's second argument."""
    region = parse_wkt(text_value(fact.args[1]))
    shapely.prepare(region)
    return region


@lru_cache(MAX_KEPT_REGIONS)
def grown_region(fact: Fact) -> Any:
    """Return the region in a fact's second argument, with the tolerance within which a thing is `inside`."""
    region = region_of(fact).buffer(EXPECTATION_TOLERANCE)
    shapely.prepare(region)
    return region


def number_of(fact: Fact) -> int:
    """Return the number in a fact's last argument."""
    return int(decimal_value(fact.args[-1]))


def _thing(fact: Fact, snapshot: Snapshot) -> Any:
    name = str(fact.args[0])
    return shapely.Point(snapshot.utak) if name == "utak" else snapshot.polygons[name]


def _place(fact: Fact, snapshot: Snapshot) -> str:
    """Return in words where the middle of the named thing is, in squares of the table."""
    middle = _thing(fact, snapshot).centroid
    return f"{fact.args[0]} is at POINT ({middle.x:.2f} {middle.y:.2f})"


def _inside(fact: Fact, track: Sequence[Snapshot]) -> str:
    """Return '' when all of the thing is in the region at the end, else where it is."""
    region, thing = grown_region(fact), _thing(fact, track[-1])
    if region.covers(thing):
        return ""
    away = thing.distance(region)
    part = "" if away or not thing.area else f", {100 * thing.difference(region).area / thing.area:.0f} % of it outside"
    return f"{_place(fact, track[-1])} at the end{part or f', {away:.2f} squares away from the region'}"


def _near(fact: Fact, track: Sequence[Snapshot]) -> str:
    """Return '' when the thing is near enough to the shape at the end, else how far away it is."""
    thing = _thing(fact, track[-1])
    away = thing.distance(region_of(fact))
    if away <= decimal_value(fact.args[2]) + EXPECTATION_TOLERANCE:
        return ""
    return f"{_place(fact, track[-1])} at the end, {away:.2f} squares away from it"


def _ways(fact: Fact, track: Sequence[Snapshot]) -> list[float]:
    """Return how far the thing's centre was from the region at each step; 0 within it."""
    region = region_of(fact)
    return [float(region.distance(_thing(fact, snapshot).centroid)) for snapshot in track]


def _before(fact: Fact, track: Sequence[Snapshot]) -> str:
    """Return '' when the first visit came before the first of the second kind, else when each came."""
    ways = [_ways(visit, track) for visit in fact.args if isinstance(visit, Symbol)]
    first, second = (track[away.index(0.0)].step if 0.0 in away else None for away in ways)
    if first is not None and second is not None and first < second:
        return ""
    came = ("never" if step is None else f"at step {step}" for step in (first, second))
    return "the first of the two came {}, the second {}".format(*came)


def _visits(fact: Fact, track: Sequence[Snapshot]) -> str:
    """Return '' when the thing's centre was in the region at some step, else how near it came."""
    away = _ways(fact, track)
    if not min(away):
        return ""
    nearest = away.index(min(away))
    return f"it was at no step there; the nearest was step {track[nearest].step}, {away[nearest]:.2f} squares away"


def _avoids(fact: Fact, track: Sequence[Snapshot]) -> str:
    """Return '' when the thing's centre was in the region at no step, else when it was."""
    region = region_of(fact)
    there = [snapshot for snapshot in track if region.covers(_thing(fact, snapshot).centroid)]
    return f"it was there at step {there[0].step}: {_place(fact, there[0])}" if there else ""


def _circles(fact: Fact, track: Sequence[Snapshot]) -> str:
    """Return '' when Utak's track winds around the thing, else by how much it does."""
    degrees = winding(track, str(fact.args[1]))
    if abs(degrees) >= MIN_CIRCLING_DEGREES:
        return ""
    return f"the track winds about it by {abs(degrees):.0f} degrees; once around are {MIN_CIRCLING_DEGREES:.0f} or more"


def winding(track: Sequence[Snapshot], name: str) -> float:
    """Return by how many degrees Utak's track winds around the centre of a thing, counter-clockwise positive."""
    total = 0.0
    for before, after in pairwise(track):
        centre = after.polygons[name].centroid
        start, end = (math.atan2(y - centre.y, x - centre.x) for x, y in (before.utak, after.utak))
        total += (math.degrees(end - start) + 180.0) % 360.0 - 180.0
    return total


def _unmoved(fact: Fact, track: Sequence[Snapshot]) -> str:
    """Return '' when the thing is exactly where it was, else when it moved first."""
    name = str(fact.args[0])
    first = outer_ring(track[0].polygons[name])
    if first == outer_ring(track[-1].polygons[name]):
        return ""
    moved = next(snapshot for snapshot in track if outer_ring(snapshot.polygons[name]) != first)
    return f"it was moved, at step {moved.step} for the first time; {_place(fact, track[-1])} at the end"


def _pose(fact: Fact, track: Sequence[Snapshot]) -> str:
    """Return '' when the thing lies as wanted at the end, else how far its outline is from that."""
    name, place = str(fact.args[0]), region_of(fact)
    wanted = rotate(track[0].polygons[name], decimal_value(fact.args[2]), origin="centroid")
    wanted = translate(wanted, place.x - wanted.centroid.x, place.y - wanted.centroid.y)
    away = float(track[-1].polygons[name].hausdorff_distance(wanted))
    if away <= decimal_value(fact.args[3]) + EXPECTATION_TOLERANCE:
        return ""
    return f"{_place(fact, track[-1])} at the end, and its outline up to {away:.2f} squares from the one expected"


def _within(fact: Fact, track: Sequence[Snapshot]) -> str:
    """Return '' when no more commands were given than allowed, else how many were."""
    steps = track[-1].step
    if steps <= number_of(fact):
        return ""
    return "1 command was given" if steps == 1 else f"{steps} commands were given"


_CHECKS = {
    "inside": _inside,
    "near": _near,
    "visits": _visits,
    "before": _before,
    "avoids": _avoids,
    "circles": _circles,
    "unmoved": _unmoved,
    "pose": _pose,
    "within": _within,
}
