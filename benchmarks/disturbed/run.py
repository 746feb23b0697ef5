"""One world run twice: as it is, and with a random disturbance; the row of what came of it, and sums of rows."""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.affinity import translate

from benchmarks.harness.judging import findings
from benchmarks.worlds.makers import scenario
from benchmarks.worlds.scenes import RandomScenario, wkt, write
from utak.geometry.counts.retina import RETINA_REACH
from utak.kb.language.source_text import source_from_bytes
from utak.simulator.episode.episode import EpisodeLog, read_episode
from utak.simulator.replay.drawing import PlacedFrame, rectangles
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Session
from utak.simulator.scenario.disturbances import disturbed_world
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import World

DISTURBING_ACTS = ("move", "lift", "appear", "vanish")
TASKS = {
    "move": (3, 5, 6, 7, 8, 9),
    "lift": (1, 2, 3, 5, 6, 7, 9),
    "appear": (1, 2, 3, 5, 6, 7),
    "vanish": (3, 5, 6, 7),
}
THING_TASK = 3  # the task to go to a thing
MIN_AWAY = 3.0  # squares by which the robot or a thing is put elsewhere at least; a convention
MIN_ROOM = 2.0  # squares that are left about a thing that is put somewhere; a convention
MAX_KNOWN_ERROR = 1.0  # squares by which a place that is known may be wrong; a convention
LOOKS_TO_KNOW = 3  # looks within which a lifted robot shall know where it is
SEEN_ABOUT = 6  # squares about a place that must have been in sight for it to count as seen; a convention
PLACES_TRIED = 2000
NOTICED_AS = ("changed", "lifted", "lost")
Line = dict[str, Any]


@dataclass(frozen=True)
class DisturbedRow:
    """The outcome of one disturbed run; None where a question does not arise."""

    act: str
    task: int
    seed: int
    fact: str = ""
    noticed: bool | None = None  # at the first look that contradicts what was seen before
    placed: bool | None = None  # whether the thing is believed where it is, at the end
    seen: bool | None = None  # whether a lifted robot was put where it had looked before
    looks: int | None = None  # after how many looks a lifted robot knew where it is; None also where it never did
    achieved: bool = False
    believed: bool = False
    verdict: str = ""
    steps: int = 0
    before: int = 0  # the commands of the undisturbed run
    judged: tuple[str, ...] = ()
    reason: str = ""
    seconds: float = 0.0


def disturbance(act: str, rng: np.random.Generator, world: RandomScenario, lines: Sequence[Line]) -> tuple[str, int]:
    """Return a random disturbance of a recorded run as a fact, and its step; "" where there is no room for one."""
    step = int(rng.integers(1, len(lines)))
    line, name = lines[step - 1], world.things[0].name if world.things else ""
    things = {other: shapely.Polygon(ring) for other, ring in line["objects"].items()}
    fixed = [thing.polygon for thing in world.things if thing.fixed]
    here = shapely.Point(line["utak"])
    if act == "vanish":
        return f"vanish({name},{step}).", step
    shape = {"move": things.get(name), "appear": shapely.box(0, 0, *rng.integers(1, 4, 2)), "lift": None}[act]
    rooms = [room.polygon for room in world.plan.rooms]
    if act == "move":
        assert shape is not None
        rooms = [room for room in rooms if room.covers(shape.centroid)]
    others = [*fixed, *(polygon for other, polygon in things.items() if other != (name if act == "move" else ""))]
    for _ in range(PLACES_TRIED if rooms else 0):
        west, south, east, north = rooms[int(rng.integers(len(rooms)))].bounds
        x, y = round(float(rng.uniform(west, east)), 2), round(float(rng.uniform(south, north)), 2)
        if act == "lift":
            near = shapely.Point(x, y)
            far = near.distance(here) >= MIN_AWAY
        else:
            x, y = (round(x), round(y)) if act == "appear" or _on_grid(shape) else (x, y)
            near = translate(shape, x - shape.centroid.x, y - shape.centroid.y)
            if _on_grid(shape):
                near = translate(near, round(near.bounds[0]) - near.bounds[0], round(near.bounds[1]) - near.bounds[1])
            x, y = near.centroid.x, near.centroid.y
            far = act == "appear" or near.centroid.distance(shape.centroid) >= MIN_AWAY
        room = near.buffer(0.3 if act == "lift" else MIN_ROOM)
        free = any(one.covers(room) for one in rooms) and not any(room.intersects(other) for other in others)
        if free and far and (act == "lift" or not room.contains(here)):
            if act == "appear":
                return f'appear(n1,r,"{wkt(near)}",{step}).', step
            return f'{act}({"utak" if act == "lift" else name},"POINT ({x!r} {y!r})",{step}).', step
    return "", step


def _on_grid(shape: Any) -> bool:
    return bool(np.abs(shapely.get_coordinates(shape) % 1.0).max() < 1e-9)


def run(act: str, task: int, seed: int, kind: str, folder: Path) -> DisturbedRow | None:
    """Return the outcome of a disturbed run; None when the undisturbed one fails, or there is no room."""
    world = scenario(task, seed, kind)
    if not world.possible:
        return None
    place = write(world, folder / f"{act}-{world.name}")
    calm = _lines(place, place / "calm.jsonl", "")
    if not calm[1]["achieved"] or len(calm[0]) < 2:
        return None
    fact, step = disturbance(act, np.random.default_rng([DISTURBING_ACTS.index(act), task, seed]), world, calm[0])
    if not fact:
        return None
    (place / "others.lp").write_text(f"{fact}\n")
    if act == "move" and task == THING_TASK:  # the place that is expected is another one
        moved = disturbed_world(read_scenario(place).world, source_from_bytes("others", fact.encode())).disturbances[0]
        lies = moved.outline(world.things[0].polygon, world.plan.width)
        (place / "expect.lp").write_text(f'near(utak, "{wkt(lies)}", 2).\n')
    begin = time.process_time()
    lines, result = _lines(place, place / "episode.jsonl", fact)
    if not any(line.get("disturbed") for line in lines):
        return None
    row = DisturbedRow(act, task, seed, fact, steps=result["steps"], before=len(calm[0]) - 1)
    row = replace(row, seconds=round(time.process_time() - begin, 1), reason=result["reason"])
    judged = tuple(findings(place, place / "episode.jsonl") or ()) if act in ("move", "lift", "vanish") else ()
    row = replace(row, judged=judged, **{key: result[key] for key in ("achieved", "believed", "verdict")})
    truth = disturbed_world(read_scenario(place).world, source_from_bytes("others", fact.encode()))
    if act == "lift":
        there = next(line["disturbed"]["utak"] for line in lines if "disturbed" in line)
        seen = any(_sees(truth.heading, line["utak"], there) for line in lines[:step])
        return replace(row, looks=_known_after(truth, lines, step), seen=seen)
    if act == "appear":
        return row
    return replace(row, **_thing(truth, lines, step, world.things[0].name, act))


def _lines(place: Path, log: Path, fact: str) -> tuple[list[Line], Line]:
    """Return the lines of a run, and its result."""
    read = read_scenario(place)
    if fact:
        read = replace(read, world=disturbed_world(read.world, source_from_bytes("others", fact.encode())))
    with EpisodeLog(log, force=True) as written:
        Session(read, Settings(seed=1), make_robot, written).run()
    episode = read_episode(log)
    assert episode.result is not None
    return list(episode.steps), episode.result


def _known_after(world: World, lines: Sequence[Line], step: int) -> int | None:
    """Return after how many looks since it was lifted the robot knew where it is; None for never."""
    for number, line in enumerate(lines[step:], 1):
        if _error(world, line) <= MAX_KNOWN_ERROR and line["belief"]["pose"] != "lost":
            return number
    return None


def _sees(heading: float, here: Sequence[float], there: Sequence[float]) -> bool:
    """Return whether a place and what lies within `SEEN_ABOUT` squares of it was under the retina at another place."""
    away = PlacedFrame(0.0, 0.0, -heading).place(there[0] - here[0], there[1] - here[1])
    return max(map(abs, away)) <= RETINA_REACH - SEEN_ABOUT


def _error(world: World, line: Line) -> float:
    """Return how far the robot is from where it believes to be, in squares."""
    return math.dist(PlacedFrame(*world.utak, world.heading).place(*line["belief"]["place"]), line["utak"])


def _thing(world: World, lines: Sequence[Line], step: int, name: str, act: str) -> dict[str, bool | None]:
    """Return whether the absence of a thing was noticed at once, and whether it is believed where it is."""
    old, new = (shapely.Polygon(lines[at]["objects"][name]) for at in (step - 1, step))
    known = any(_shows(world, line, name, old) for line in lines[:step])
    floor_seen = any(_shows(world, line, name, new) for line in lines[:step])
    noticed = None
    for line in lines[step:] if known else ():
        there = shapely.Polygon(line["objects"][name])
        if not there.equals(new):
            break
        if _shows(world, line, name, old) or (floor_seen and _shows(world, line, name, new)):
            noticed = line["belief"]["pose"] in NOTICED_AS or not _believed(world, line, old)
            break
    last = lines[-1]
    seen = any(_shows(world, line, name, shapely.Polygon(line["objects"][name])) for line in lines[step:])
    placed = _believed(world, last, shapely.Polygon(last["objects"][name])) if seen and act == "move" else None
    return {"noticed": noticed, "placed": placed}


def _shows(world: World, line: Line, name: str, polygon: Any) -> bool:
    """Return whether a look differs by whether a thing lies at an outline."""
    polygons = {other: shapely.Polygon(ring) for other, ring in line["objects"].items()}
    beside = translate(polygon, 10.0 * world.width, 0.0)
    looks = []
    for outline in (polygon, beside):
        now = replace(world.moved({**polygons, name: outline}, tuple(line["utak"])), disturbances=())
        looks.append(Tabletop(now).look()[0])
    return looks[0] != looks[1]


def _believed(world: World, line: Line, polygon: Any) -> bool:
    """Return whether the robot believes that a thing lies at an outline."""
    frame = PlacedFrame(*world.utak, world.heading)
    for node, (west, south, east, north) in rectangles(line["belief"]["facts"]):
        middle = frame.place((west + east) / 200, (south + north) / 200)
        if node.startswith("o") and node != "org" and polygon.envelope.centroid.distance(shapely.Point(middle)) <= 1.5:
            return True
    return False


def summary(rows: Sequence[DisturbedRow]) -> Iterator[str]:
    """Yield a line for each kind of disturbance."""
    for act in DISTURBING_ACTS:
        own = [row for row in rows if row.act == act]
        if not own:
            continue
        noticed, placed = (
            [getattr(row, key) for row in own if getattr(row, key) is not None] for key in ("noticed", "placed")
        )
        soon = sum(row.looks is not None and row.looks <= LOOKS_TO_KNOW for row in own)
        told = [f"{len(own)} worlds", f"done {sum(row.achieved for row in own)}"]
        told += [f"noticed at once {sum(noticed)} of {len(noticed)}"] if act in ("move", "vanish") else []
        told += [f"place right {sum(placed)} of {len(placed)}"] if act == "move" else []
        told += [f"knows within {LOOKS_TO_KNOW} looks {soon}"] if act == "lift" else []
        on_map = [row for row in own if row.seen]
        soon = sum(row.looks is not None and row.looks <= LOOKS_TO_KNOW for row in on_map)
        told += [f"of those put where it had looked {soon} of {len(on_map)}"] if act == "lift" else []
        told += [f"false done {sum(row.believed and not row.achieved for row in own)}"]
        told += [f"impossible {sum(row.verdict == 'impossible' for row in own)}"]
        told += [f"commands {sum(row.steps for row in own)} (undisturbed {sum(row.before for row in own)})"]
        told += [f"judge's findings {sum(bool(row.judged) for row in own)}"]
        yield f"{act}: {', '.join(told)}"
