"""Feeling: before the robot gives up, it feels the walls that may be things, the likeliest places first.

planner.sights.walls says what is felt from where; planner/asp/deciding chooses where to halt next.
"""

import math
from collections.abc import Sequence

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.raster.components import components
from utak.kb.language.goal_words import ROBOT, TRACK_GOALS
from utak.kb.language.terms import Fact
from utak.kb.world.model import Node
from utak.kb.world.rooms import Door
from utak.planner.advice import Go
from utak.planner.deciding.search import contact_subgoals
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.decision import Decision, command_or_nothing, nothing_to_do
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.screen.moves import move_to, one_move_squares
from utak.planner.screen.projection import dilate, indices_to_mask
from utak.planner.sights.frontiers import Viewpoint
from utak.planner.sights.passages import SAME_LINE, WallLine, passages
from utak.planner.sights.walls import (
    FeelingPlace,
    FeelingScope,
    WallKind,
    feeling_places,
    is_ringed,
    walls_in_question,
)
from utak.planner.situation import Situation, neck_squares
from utak.planner.stages import DOOR_GOALS, TOUCHING_GOALS, Stage
from utak.planner.subgoal_kind import SubgoalKind

MAX_HALTS_OF_KIND = 16  # nearest halts of each kind of wall that are offered; a bound on time
PASSAGE_REASON = "floor is seen beyond the wall, so an opening that fills no whole square may be here"
FEELING_REASON = "what seems to be wall may be a thing that can be moved, so it is felt"


def feeling_scope(turn: StageTurn) -> FeelingScope:
    """Return which walls matter for a stage that cannot be attained otherwise."""
    stage, situation = turn.stage, turn.situation
    named = {str(term) for goal in stage.carried for term in goal.args}
    if turn.agreeing and sum(map(situation.task.is_object, named)) == 1:
        return FeelingScope(parting=False, things=False)  # where one thing shall be depends on the floor alone
    forbidden = situation.forbidden(ROBOT)
    track = any(goal.name in TRACK_GOALS for goal in stage.own)
    parting = bool(stage.carried) or track or bool(forbidden)
    allowed = _floor_this_side(forbidden, situation) if forbidden else None
    wanted = None if stage.carried or track else _wanted(stage, situation)
    about = any(situation.task.is_object(str(term)) for goal in stage.goals for term in goal.args)
    doorless = not situation.doors and any(goal.name in DOOR_GOALS for goal in stage.goals)  # whatever things there are
    things = (parting or about) and not doorless
    return FeelingScope(parting, wanted, allowed, things)


def _wanted(stage: Stage, situation: Situation) -> Bools | None:
    """Return the squares of an object at which the robot shall be, and to which no way leads; None for no such."""
    for goal in stage.own:
        node = situation.object_of(str(goal.args[1])) if goal.name in TOUCHING_GOALS else None
        if node is not None:
            mask = situation.model.mask(node.patch)
            if not (dilate(mask, 1) & situation.cost_maps.floor).any():
                return mask
    return None


def _floor_this_side(doors: Sequence[Door], situation: Situation) -> Bools:
    """Return the floor that the robot reaches without going through some doors, (rows, columns) bool."""
    floor = situation.cost_maps.floor
    free = floor & ~neck_squares(doors, floor.shape)
    column, row = situation.cost_maps.here
    labels = components(free).labels
    mask: Bools = free & (labels == labels[row, column])
    return mask


def walls_to_feel(turn: StageTurn) -> Bools:
    """Return the walls that were never felt and may be things that could help a stage, reachable to be felt or not."""
    walls = walls_in_question(turn.situation.model, turn.situation.cost_maps.floor, feeling_scope(turn))
    mask: Bools = np.any(list(walls.values()), axis=0)
    return mask


def feel_walls(turn: StageTurn) -> Decision:
    """Return the next command to feel walls that may be things; nothing when none is left that can be reached."""
    places = feeling_places(turn.situation.cost_maps, feeling_scope(turn))
    return command_or_nothing(turn.seek(halts(places, turn.situation)), "nothing is left to feel")


def feel_rims(rims: Sequence[Viewpoint], turn: StageTurn) -> Decision:
    """Return the next command to feel things all round; nothing when none can be reached to be felt."""
    return turn.look_if_reached([Subgoal(SubgoalKind.INSPECT, *rim) for rim in rims])


def feel_rim(node: Node, turn: StageTurn) -> Decision:
    """Return the next command to feel how far an object goes on along the wall it stands in; nothing when known."""
    if node.moved or node.colour is None:
        return nothing_to_do(f"it is known how far {node.name} goes")
    near = dilate(turn.situation.model.mask(node.patch), 2).ravel()
    places = [p for p in feeling_places(turn.situation.cost_maps) if WallKind.THING in p.squares and near[p.square]]
    return command_or_nothing(turn.seek(halts(places, turn.situation)), f"nothing is left to feel of {node.name}")


def halts(places: Sequence[FeelingPlace], situation: Situation) -> list[Subgoal]:
    """Return the squares at which walls may be felt next, as subgoals: some of each kind of wall."""
    if not places:
        return []
    cost_maps, squares = situation.cost_maps, np.array([place.square for place in places])
    ways = cost_maps.far(squares)
    straight = one_move_squares(cost_maps, SubgoalKind.FEEL, indices_to_mask(squares, cost_maps.floor.shape)).ravel()
    found = []
    for number in sorted(_offered(places, np.argsort(ways, kind="stable").tolist())):
        place = places[number]
        told = [
            f"{kind},{size},{of_size[kind]}"
            for size, of_size in (("doorway", place.doorways), ("square", place.squares))
            for kind in WallKind
            if of_size[kind]
        ]
        felt = ("1" if straight[place.square] else "2", *told)
        found.append(Subgoal(SubgoalKind.FEEL, np.array([place.square]), FEELING_REASON, felt=felt))
    return found


def _offered(places: Sequence[FeelingPlace], order: Sequence[int]) -> set[int]:
    """Return the numbers of the places that are offered. order : all numbers, the nearest first."""
    offered: set[int] = set()
    for kind in WallKind:
        of_kind = [n for n in order if places[n].squares[kind] or places[n].doorways[kind]]
        full = [n for n in of_kind if places[n].doorways[kind] == max(places[m].doorways[kind] for m in of_kind)]
        offered.update(of_kind[:MAX_HALTS_OF_KIND], full[:MAX_HALTS_OF_KIND])
    return offered


def touch_contacts(_goals: Sequence[Fact], turn: StageTurn) -> Decision:
    """Return the next command to touch what may be an object against a wall, or part of one; nothing for none."""
    return turn.look_if_reached(contact_subgoals(turn.situation))


class Passages:
    """Walks against walls behind which floor is seen, and remembers the lines on which it did."""

    def __init__(self) -> None:
        """Make one that tried nothing."""
        self._tried: set[WallLine] = set()

    def next(self, turn: StageTurn) -> Decision:
        """Return the next command to walk through wall to floor beyond it; nothing when no line is left."""
        situation = turn.situation
        model, far = situation.model, situation.cost_maps.distances[0].ravel()
        walks = passages(situation.cost_maps, things=not is_ringed(model, situation.cost_maps.floor))
        left = [one for one in walks if not self._is_tried(one.line)]
        left.sort(key=lambda one: (not one.is_middle, int(far[one.square]), math.dist(one.start, model.place)))
        for passage in left:
            if math.dist(passage.start, model.place) < SAME_LINE / 2:
                self._tried.add(passage.line)
                return Decision(move_to(passage.end, model), f"{PASSAGE_REASON}; {turn.stage}")
            go = Go(np.array([passage.square]), passage.start, PASSAGE_REASON)
            walk = turn.go(go)
            if walk.command is not None:
                return walk
        return nothing_to_do("no wall is left behind which floor is seen")

    def _is_tried(self, line: WallLine) -> bool:
        """Return whether a walk on a line, or right beside it, was tried."""
        return any(line[0] == number and abs(line[1] - across) <= SAME_LINE for number, across in self._tried)
