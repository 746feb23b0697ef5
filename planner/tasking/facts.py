"""The facts of planner/asp/task: things, places, goals and rooms of a problem, and what geometry said so far."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Bools
from utak.geometry.manipulation.goals import At, End, InCorner, Inside, shape_at_pose
from utak.geometry.raster.rasterize import squares
from utak.kb.language.goal_words import ROBOT
from utak.kb.reasoning.user_rules import predicates_read, rules_reach
from utak.kb.world.chances import Chances
from utak.kb.world.facts import appearance_facts
from utak.kb.world.model import hundredths
from utak.kb.world.rooms import NO_ROOM
from utak.planner.oracles.problem import HERE, PlacedGoal, TaskProblem
from utak.planner.oracles.spots import SPOT_SLACK
from utak.planner.situation import Situation
from utak.planner.tasking.task_plan import RefutedStep

OVERLAP_ROUNDING = 1e-6  # squares by which two places may seem to overlap, though they only touch

Way = tuple[str, str, str]  # a thing, the place that it comes from, the place that it is brought to


@dataclass(frozen=True)
class Answers:
    """The answers of geometry so far."""

    # About how many commands a way takes, as geometry found it in the state where it was asked last
    commands: Mapping[Way, int] = field(default_factory=dict)
    hoped: AbstractSet[Way] = frozenset()  # the ways over floor that is only hoped to be free
    refutations: tuple[RefutedStep, ...] = ()  # the refuted ways, in the order in which they were refuted

    @property
    def found(self) -> list[str]:
        """Return what was found for each refutation, by its number, for the record of decisions."""
        return [f"refutation {n}: {one.found}" for n, one in enumerate(self.refutations) if one.found]


class Overlap(NamedTuple):
    """Two places of two things that overlap."""

    thing: str  # one thing and its place
    place: str
    other: str  # the other thing, later by name, and its place
    other_place: str

    def __str__(self) -> str:
        """Return the overlap as a fact without full stop."""
        return f"overlap({self.thing},{self.place},{self.other},{self.other_place})"


def problem_facts(
    problem: TaskProblem,
    aside: Sequence[tuple[str, str]],
    situation: Situation,
    spots: AbstractSet[tuple[str, str]],
    overlaps: Iterable[Overlap],
) -> tuple[str, ...]:
    """Return the facts of a problem that stay the same while answers come in, without full stops."""
    facts = [f"place({ROBOT},{HERE})"]
    facts += [fact for name in problem.nodes for fact in (f"thing({name})", f"place({name},{problem.here(name)})")]
    facts += [f"place({name},{place})" for name, place in problem.places if place != problem.here(name)]
    facts += [f"place({ROBOT},{place})" for place in problem.stands]
    facts += [f"aside({name},{place})" for name, place in aside]
    facts += problem.past
    facts += goal_facts(problem.goals, problem.waiting, problem.here)
    facts += [f"fulfils({name},{place},{goal})" for (name, place), goals in problem.fulfils.items() for goal in goals]
    facts += map(str, overlaps)
    facts += _part_facts(problem, spots)
    return (*facts, *_room_facts(problem, situation), *_world_facts(problem, situation))


def goal_facts(
    goals: Sequence[PlacedGoal], waiting: Sequence[str], here: Callable[[str], str] = lambda _name: HERE
) -> Iterator[str]:
    """Yield goals and wishes what they are about, whether they hold, and their order, as facts without full stops."""
    ranks: dict[str, int] = {}
    orders: dict[str, int] = {}
    for number, goal in enumerate(goals):
        if goal.parameter:
            orders.setdefault(goal.parameter, number)
            yield f"about({goal.name},{goal.parameter})"
        else:
            ranks.setdefault(goal.subject, number)
        yield f"goal({goal.name})" if goal.weight is None else f"wish({goal.name},{goal.weight})"
        if goal.name in waiting:
            yield f"waits({goal.name})"
        if goal.holds:
            yield f"fulfils({goal.subject},{here(goal.subject)},{goal.name})"
    yield from (f"rank({name},{number})" for name, number in ranks.items())
    yield from (f"order({parameter},{number})" for parameter, number in orders.items())


def answer_facts(answers: Answers) -> Iterator[str]:
    """Yield what geometry said as facts, without full stops."""
    for (name, origin, place), commands in answers.commands.items():
        yield f"estimate({name},{origin},{place},{commands})"
    for name, origin, place in sorted(answers.hoped):
        yield f"hoped({name},{origin},{place})"
    for number, refutation in enumerate(answers.refutations):
        yield f"refuted({number},{refutation.subject},{refutation.origin},{refutation.place})"
        yield from (f"given({number},{name},{place})" for name, place in refutation.given)
        yield from (f"shut({number},{door})" for door in refutation.shut)
        if refutation.stood is not None:
            yield f"stood({number},{refutation.stood})"


def _room_facts(problem: TaskProblem, situation: Situation) -> Iterator[str]:
    """Yield which doors connect which rooms, and in which room each place lies, where one room holds most of it."""
    rooms, model = situation.rooms, situation.model
    if rules_reach("task", situation.rules):
        yield "any_way"
    for door in rooms.doors:
        if NO_ROOM not in door.sides and door.sides[0] != door.sides[1]:
            yield f"connects({door.name},r{door.sides[0]},r{door.sides[1]})"
    robot = int(rooms.labels[model.view.locate(*model.place)])
    if robot != NO_ROOM:
        yield f"lies({ROBOT},{HERE},r{robot})"
    for name, place, mask in _masks(problem, rooms.labels.shape):
        counts = np.bincount(rooms.labels[mask].astype(np.int64), minlength=1)
        room = int(counts.argmax())
        if room != NO_ROOM and 2 * counts[room] > counts.sum():
            yield f"lies({name},{place},r{room})"


def overlaps_of(problem: TaskProblem, spots: AbstractSet[tuple[str, str]] = frozenset()) -> Iterator[Overlap]:
    """Yield the exact places of two things that overlap: where they lie now, poses and spots; regions do not count."""
    names, outlines = [], []
    for name, place, outline in _exact_places(problem, spots):
        names.append((name, place))
        outlines.append(outline if place == problem.here(name) else outline.buffer(-OVERLAP_ROUNDING))
    if not outlines:
        return
    tree = shapely.STRtree(outlines)
    for one, other in sorted(zip(*(column.tolist() for column in tree.query(outlines, "intersects")), strict=True)):
        (x, p), (y, q) = names[one], names[other]
        if x < y and (p, q) != (problem.here(x), problem.here(y)):
            yield Overlap(x, p, y, q)


def _exact_places(problem: TaskProblem, spots: AbstractSet[tuple[str, str]]) -> Iterator[tuple[str, str, Any]]:
    """Yield thing, place and outline there, where things lie now, at poses and at spots; regions are left out."""
    for name, lying in problem.state.things.items():
        yield name, lying.place, lying.outline
    for (name, place), end in problem.places.items():
        if place == problem.here(name):
            continue
        if isinstance(end, At):
            yield name, place, shape_at_pose(problem.state.things[name].outline, end.pose)
        elif isinstance(end, Inside) and (name, place) in spots:
            yield name, place, end.polygon.buffer(-SPOT_SLACK, join_style="mitre")


def _part_facts(problem: TaskProblem, spots: AbstractSet[tuple[str, str]]) -> Iterator[str]:
    """Yield which exact places of a thing lie within which region where a goal of it holds, without full stops."""
    regions = [
        (key, end.polygon)
        for key, end in problem.places.items()
        if isinstance(end, Inside) and key not in spots and key[1] != problem.here(key[0])
    ]
    for name, place, outline in _exact_places(problem, spots):
        for (thing, region), polygon in regions:
            if thing == name and polygon.covers(outline.buffer(-OVERLAP_ROUNDING)):
                yield f"within({name},{place},{region})"


def things_in_way(problem: TaskProblem, overlaps: Iterable[Overlap]) -> list[str]:
    """Return the things that lie now where another thing may have to lie, each once."""
    pairs = (pair for one in overlaps for pair in ((one.thing, one.place), (one.other, one.other_place)))
    return list(dict.fromkeys(name for name, place in pairs if place == problem.here(name)))


def _world_facts(problem: TaskProblem, situation: Situation) -> Iterator[str]:
    """Yield what is believed of the objects, and what the task calls them; of the world what users' rules name."""
    bound = [pair for pair in sorted(situation.binding.items()) if situation.model.object(pair[1]) is not None]
    meanings = {parameter: (name,) for parameter, name in bound} | dict(problem.meanings)
    yield from (f"bound({parameter},{name})" for parameter, name in bound)
    yield from (f"may_mean({parameter},{name})" for parameter, names in meanings.items() for name in names)
    for node in situation.model.objects:
        yield from appearance_facts(node)
        yield f"size({node.name},{int(node.patch.mask.sum())})"
    yield from (f"width({door.name},{hundredths(door.width)})" for door in situation.rooms.doors)
    yield from (f"relief({door},{saved})" for door, saved in situation.door_reliefs.items() if saved)
    if ("door", 2) in predicates_read("task", situation.rules):
        chances = Chances(situation.model, situation.rooms)
        yield from (
            f"door({door.name},{chances.of_door(door, chances.widths(door))})" for door in situation.rooms.doors
        )
        yield from (f"door({door.name},0)" for door in situation.possible_doors)
    yield from situation.facts_for_rules("task")


def _masks(problem: TaskProblem, shape: tuple[int, ...]) -> Iterator[tuple[str, str, Bools]]:
    """Yield each place with the squares that it takes up, (rows, columns) bool on the arrays of the view."""
    rows, columns = shape
    for name, lying in problem.state.things.items():
        yield name, lying.place, squares(lying.outline, columns, rows)
    for (name, place), end in ((key, end) for key, end in problem.places.items() if key[1] != problem.here(key[0])):
        yield name, place, _squares_of(end, problem.state.things[name].outline, (rows, columns))
    for place, stand in problem.stands.items():
        mask: Bools = np.zeros((rows, columns), np.bool_)
        mask.flat[stand] = True
        yield ROBOT, place, mask


def _squares_of(end: End, outline: object, shape: tuple[int, int]) -> Bools:
    """Return the squares that an end takes up; of a corner those near it, as far as the object reaches."""
    rows, columns = shape
    if isinstance(end, Inside):
        return squares(end.polygon, columns, rows)
    if isinstance(end, At):
        return squares(shape_at_pose(outline, end.pose), columns, rows)
    mask: Bools = np.zeros(shape, np.bool_)
    if isinstance(end, InCorner):
        row, column = int(end.y - 0.5 * end.sy), int(end.x - 0.5 * end.sx)
        mask[max(0, row - 1) : row + 2, max(0, column - 1) : column + 2] = True
    return mask
