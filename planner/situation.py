"""The situation: all that the meaning of a goal depends on, and what follows from it for doors and rooms."""

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.raster.rasterize import squares
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.terms import Fact
from utak.kb.mapping.patch import Patch
from utak.kb.task.described import IN_WORDS
from utak.kb.task.task import Task
from utak.kb.world.corners import Corner
from utak.kb.world.facts import Places, facts_for_rules
from utak.kb.world.model import Node, WorldModel
from utak.kb.world.rooms import (
    MIN_DOOR_CONFIDENCE,
    MIN_TRIED_DOOR_CONFIDENCE,
    NO_ROOM,
    SAME_DOOR,
    Door,
    Rooms,
    rooms_of,
    went_through,
)
from utak.planner.constraints import (
    CARRY_NOTHING_THROUGH,
    MAX_KEPT_SPREAD,
    OBJECT_DISTANCE,
    avoidances,
    in_view_frame,
    region_of,
    region_squares,
)
from utak.planner.question import NO_QUESTION, Question
from utak.planner.screen.projection import CostMaps, dilate
from utak.planner.sights.frontiers import Viewpoint, viewpoint_of
from utak.planner.stages import constraints

NECK_WIDTH = 0.01  # squares about the line of a shut door; a convention


def possible_doors(model: WorldModel, rooms: Rooms, rules: tuple[Path, ...]) -> tuple[Door, ...]:
    """Return the doors that there are besides those of the rooms if all things never felt are pieces of wall."""
    verge = model.verge.copy()
    for node in model.objects:
        if node.colour is None and not node.moved:
            verge |= model.mask(node.patch)
    if (verge == model.verge).all():
        return ()
    found = list(rooms.doors)
    certain = model.view._replace(probability=np.maximum(model.view.probability, verge))
    for view in (model.view, certain):  # what is hardly seen yet may bound doors, too
        others = rooms_of(replace(model, view=view), rules, verge).doors
        found += [one for one in others if all(math.dist(one.place, door.place) > SAME_DOOR for door in found)]
    return tuple(found[len(rooms.doors) :])


def neck_squares(doors: Iterable[Door], shape: tuple[int, ...], margin: int = 0) -> Bools:
    """Return the squares on the necks of some doors, (rows + 2 margin, columns + 2 margin) bool."""
    rows, columns = shape
    mask: Bools = np.zeros((rows, columns), np.bool_)
    for door in doors:
        mask |= squares(shapely.LineString([door.a, door.b]).buffer(NECK_WIDTH), columns, rows)
    return np.pad(mask, margin)


@dataclass(frozen=True)
class Situation:
    """All that the meaning of a goal depends on."""

    # The view frame is that of the arrays of the model's view: the map frame moved so that (0, 0) is the south-west
    # corner of square [0, 0].

    model: WorldModel  # the world model
    cost_maps: CostMaps  # the world model projected on the screen, an array of squares
    binding: Mapping[str, str]  # the name of the node that each parameter of the task means
    rooms: Rooms  # the rooms and doors of the floor, view frame; whatever is taken for verge bounds them
    # The corner of the known floor towards each side ("northeast", ...) of the robot frame, view frame.
    corners: Mapping[str, Corner]
    task: Task  # the task, with its constraints
    rules: tuple[Path, ...] = ()  # the user's rule files, read by every encoding
    # Where the robot has been, the present place last: points (x, y) of the map frame, in squares
    track: tuple[XY, ...] = ()
    # By object: where its middle has been since it was first moved, as `track`
    carried: Mapping[str, tuple[XY, ...]] = field(default_factory=dict)
    renamed: Mapping[str, str] = field(default_factory=dict)  # the next name of things that were moved, by that before
    closed: frozenset[str] = frozenset()  # the names of doors that users' rules close to the robot
    # By the name of a door: the commands that users' rules add to a pass through it
    door_prices: Mapping[str, int] = field(default_factory=dict)
    door_reliefs: Mapping[str, int] = field(default_factory=dict)  # how many fewer these are, as a door may be wider
    # Doors that there are if things that were seen and never felt are pieces of wall. They count where a constraint or
    # a rule is about doors: to go through one cannot be undone.
    possible_doors: tuple[Door, ...] = ()
    # Whether regions that the task forbids count only where a whole square lies within them, and for those alone whom
    # they are forbidden to. Then what is not possible is proved not to be, and what is possible may not be.
    lenient: bool = False
    # Parameters that mean nothing, with what is as claimed of them in all but a property, and that property
    near_misses: tuple[tuple[str, str, str], ...] = ()
    # By parameter of the task: other nodes that match it as well as the one that it is bound to
    as_well: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    # By parameter of the task that means nothing seen: the places where it may be, with percent (kb/asp/chances.lp)
    may_be: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    # By the name of an object: squares across passages through which it surely does not fit
    too_narrow: Mapping[str, Bools] = field(default_factory=dict)
    question: Question = NO_QUESTION  # what to do: what was given so far in this decision

    @cached_property
    def rooms_by_sure_walls(self) -> Rooms:
        """The rooms that follow when everything that may be an object is one, and does not bound a room."""
        if (self.model.walls == self.model.verge).all():
            return self.rooms
        return rooms_of(self.model, self.rules, self.model.walls)

    def facts_for_rules(self, encoding: str) -> tuple[str, ...]:
        """Return the facts of the world model that users' rules name in an encoding, without full stops."""
        return facts_for_rules(encoding, self.rules, self.model, Places(self.rooms, self.corners))

    @property
    def doors(self) -> tuple[Door, ...]:
        """The doors of the rooms, and those that there may be besides."""
        return (*self.rooms.doors, *self.possible_doors)

    def object_of(self, parameter: str) -> Node | None:
        """Return the object that a parameter of the task means; None while none is known, and for any other word."""
        return self.model.object(self.binding.get(parameter, ""))

    def nothing_is(self, parameter: str) -> str:
        """Return in words that nothing is known to be what a parameter means: so far, or since the map is a new one."""
        since = "since the map was begun anew" if self.model.anew else "so far"
        missed = sorted((name, IN_WORDS.get(what, what)) for x, name, what in self.near_misses if x == parameter)
        nothing = f"nothing seen {since} is {parameter}"
        return "; ".join([nothing, *(f"{name} is not: its {what} is not as claimed" for name, what in missed)])

    def named_by(self, goals: Iterable[Fact]) -> frozenset[str]:
        """Return the names of the objects of which some goals speak, and "" where a term means none that is known."""
        return frozenset(self.binding.get(str(term), "") for goal in goals for term in goal.args)

    def along_with(self, patch: Patch) -> "Situation":
        """Return the situation with cost maps for a robot that carries an object along, so that it blocks no way."""
        return self.with_free(self.model.mask(patch))

    def with_free(self, mask: Bools) -> "Situation":
        """Return the situation with cost maps on which some squares, (rows, columns) bool, are free."""
        return replace(self, cost_maps=CostMaps(self.model, mask, self.cost_maps.kept_off))

    def rooms_beyond(self, goal: Fact, place: XY) -> tuple[Bools, tuple[Viewpoint, ...]]:
        """Compute the squares of the rooms where a goal about rooms holds, and what to look at before it is claimed."""
        mask = self.goal_rooms(goal, place, self.rooms, MIN_DOOR_CONFIDENCE)
        both = mask & self.goal_rooms(goal, place, self.rooms_by_sure_walls, MIN_TRIED_DOOR_CONFIDENCE)
        if both.any() or not mask.any():
            return both, ()
        return mask, doubtful_wall_ends(self)

    def likely_rooms_beyond(self, goal: Fact, place: XY) -> tuple[Rooms, Bools]:
        """Compute the squares of the rooms where a goal about rooms likely holds."""
        for rooms in (self.rooms, self.rooms_by_sure_walls):
            mask = self.goal_rooms(goal, place, rooms, MIN_TRIED_DOOR_CONFIDENCE)
            if mask.any():
                break
        return rooms, mask

    def forbidden(self, actor: str) -> tuple[Door, ...]:
        """Return the doors that the constraints of the task forbid to an actor, in the order of `rooms.doors`."""
        avoided = [
            sorted(self.avoided(fact), key=lambda door: door.width)[:1]
            for fact, actors in self.kept_from_doors
            if actor in actors or (not actors and actor != ROBOT)
        ]
        if all(avoided):
            return tuple(dict.fromkeys(door for doors in avoided for door in doors))
        return self.doors if actor == ROBOT else tuple(door for door in self.rooms.doors if door.likely)

    @property
    def kept_from_doors(self) -> tuple[tuple[Fact, tuple[str, ...]], ...]:
        """The constraints that forbid a door, each with the actors that it names: none where it means all objects."""
        return tuple(
            (fact, () if fact.name == CARRY_NOTHING_THROUGH else (self.binding.get(name, name),))
            for fact in constraints(self.task)
            if fact.name in (CARRY_NOTHING_THROUGH, "not_through")
            for name in (str(fact.args[0]),)
        )

    def minds_doors(self, name: str) -> bool:
        """Return whether it matters through which doors an object goes, by constraints of the task or users' rules."""
        kept = any(not actors or name in actors for _, actors in self.kept_from_doors)
        return kept or bool(self.closed or self.door_prices)

    def avoided(self, fact: Fact) -> tuple[Door, ...]:
        """Return the doors that a constraint may mean and through which none went whom it keeps from one, in order."""
        actors, meant = dict(self.kept_from_doors)[fact] or tuple(self.carried), self.described_by(fact)
        doors = [door for door in self.doors if door.name == self.binding.get(meant)] if meant else self.rooms.sure
        return tuple(door for door in doors if not any(self._passed(actor, door) for actor in actors))

    def shut(self, actor: str) -> tuple[Door, ...]:
        """Return the doors that neither the constraints of the task nor users' rules let an actor pass."""
        forbidden = self.forbidden(actor)
        return (*forbidden, *(door for door in self.doors if door.name in self.closed and door not in forbidden))

    def region_kept_off(self, actor: str, margin: int = 0) -> Bools:
        """Compute the squares that the task forbids to an actor: see `regions_kept_off`."""
        return regions_kept_off(self.task, self.binding, self.model, actor, margin, self.lenient)

    def with_closed(self, closed: frozenset[str]) -> "Situation":
        """Return the situation with some more doors closed, and cost maps on which no way leads through a shut one."""
        return replace(self, closed=self.closed | closed).within_shut_doors()

    def with_too_narrow(self, name: str, mask: Bools) -> "Situation":
        """Return the situation with squares across passages through which an object surely does not fit."""
        return replace(self, too_narrow={**self.too_narrow, name: mask})

    def within_shut_doors(self, others: Iterable[Door] = ()) -> "Situation":
        """Return the situation with cost maps on which no way leads through a door that is shut to the robot."""
        kept_off = neck_squares((*self.shut(ROBOT), *others), self.model.labels.shape) | self.cost_maps.kept_off
        return replace(self, cost_maps=CostMaps(self.model, kept_off=kept_off)) if kept_off.any() else self

    def without(self, left_out: Collection[Fact]) -> "Situation":
        """Return the situation if the task did not have some of its constraints, and cost maps for it."""
        goals = tuple(goal for goal in self.task.goals if goal not in left_out)
        return replace(self, task=replace(self.task, goals=goals)).through_shut_doors().within_shut_doors()

    def as_lenient(self) -> "Situation":
        """Return the situation with forbidden regions as small as they surely are, and cost maps for it."""
        return replace(self, lenient=True).through_shut_doors().within_shut_doors()

    def through_shut_doors(self) -> "Situation":
        """Return the situation with cost maps on which all doors are open."""
        kept_off = self.region_kept_off(ROBOT)
        return replace(self, cost_maps=CostMaps(self.model, kept_off=kept_off if kept_off.any() else None))

    @property
    def closed_doors_passed(self) -> tuple[tuple[str, Door], ...]:
        """Passes through doors that users' rules close, by tracks: `utak` or the name of an object, and the door."""
        closed = [door for door in self.doors if door.name in self.closed]
        return tuple((actor, door) for actor in (ROBOT, *self.carried) for door in closed if self._passed(actor, door))

    def _passed(self, actor: str, door: Door) -> bool:
        """Return whether the robot, or an object by name, was ever beyond a door, by its track."""
        track = self.track if actor == ROBOT else self.carried.get(actor, ())
        return went_through(np.array(track).reshape(-1, 2) - (self.model.view.west, self.model.view.south), door)

    def described_by(self, goal: Fact) -> str:
        """Return the door or room of a goal of which start.lp claims something; "" where any will do."""
        return next((str(term) for term in goal.args if str(term) in self.task.described), "")

    def goal_rooms(self, goal: Fact, place: XY, rooms: Rooms, least: int) -> Bools:
        """Compute the squares of the rooms where a goal holds for what began at a point, (rows, columns) bool."""
        # The rooms may be another partition of the floor than that of the situation.
        row, column = self.model.view.locate(*place)
        home, parameter = int(rooms.labels[row, column]), self.described_by(goal)
        if not parameter:
            return rooms.beyond(home, least)
        meant = self.binding.get(parameter, "")
        if self.task.parameters[parameter].kind == "door":
            door = next((door for door in self.rooms.doors if door.name == meant), None)
            found = [] if door is None else rooms.far_side(door.place, home)
        else:
            own = self.rooms.labels == int(meant[1:] or NO_ROOM)
            found = [] if not meant else rooms.most_of(own, other_than=NO_ROOM if own[row, column] else home)
        mask: Bools = np.isin(rooms.labels, found) & ~rooms.doorways
        return mask


def regions_kept_off(
    task: Task, binding: Mapping[str, str], model: WorldModel, actor: str, margin: int = 0, lenient: bool = False
) -> Bools:
    """Compute the squares that a task forbids to the robot or to an object by avoid(T, "WKT")."""
    # Plans keep objects OBJECT_DISTANCE from a region, and more while the angle of the frame is a little open, since
    # nothing tells exactly where these are.
    shape = model.labels.shape
    mask: Bools = np.zeros((shape[0] + 2 * margin, shape[1] + 2 * margin), np.bool_)
    for name, fact in avoidances(task):
        if binding.get(name, name) != actor:
            continue
        region = in_view_frame(region_of(fact), model.frame, model.view.west, model.view.south)
        if not lenient and actor != ROBOT:
            far = float(region_of(fact).hausdorff_distance(shapely.Point(0.0, 0.0)))
            distance = OBJECT_DISTANCE + min(model.spread, MAX_KEPT_SPREAD) * far
            region = region.buffer(distance, join_style="mitre")
        mask |= region_squares(region, shape, lenient, margin)
    return mask


def doubtful_wall_ends(situation: Situation) -> tuple[Viewpoint, ...]:
    """List where to look at pieces of verge that go on unseen and are hardly long enough to be walls."""
    model = situation.model
    pieces = model.verge & ~model.walls & dilate(~model.view.seen, 1)
    labels = np.where(pieces, model.labels, 0)
    views = (
        viewpoint_of(situation.cost_maps, labels == n, "what seems to be a wall may be an object")
        for n in np.unique(labels[pieces])
    )
    return tuple(view for view in views if len(view.squares))
