"""Goals for the robot itself: the way there, round an object, and the looks that make sure of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY
from utak.kb.body import Release
from utak.kb.language.goal_words import ROBOT, TRACK_GOALS
from utak.kb.language.terms import Fact
from utak.kb.localisation.tracker import RESIDUAL_WINDOW
from utak.kb.world.model import Node
from utak.kb.world.rooms import MIN_DOOR_CONFIDENCE
from utak.planner.carrying.open_facts import NOTHING_LEFT, proof_if_not_found
from utak.planner.carrying.preconditions import doubts_of_thing
from utak.planner.deciding.pursuit import end_of
from utak.planner.deciding.search import contact_subgoals, subgoals_towards
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.deciding.transport import Transporter, push_to_see
from utak.planner.deciding.verification import doubts_of_belief, doubts_of_bounds, robot_square
from utak.planner.decision import Decision, TaskVerdict, done, impossible, nothing_to_do
from utak.planner.goals.joint import is_apart_from_start, too_far_reason
from utak.planner.goals.placement import to_view_frame
from utak.planner.goals.robot_goals import (
    Destination,
    jointly,
    robot_stands_on,
    unknown_destination,
    unreachable_reason,
)
from utak.planner.navigation.encircle import encircled_point, encircling_routes, winding_number
from utak.planner.screen.moves import next_move
from utak.planner.sights.viewpoints import TO_REACH
from utak.planner.situation import Situation
from utak.planner.skills.into_corner import IntoCorner, halt_beside_walls
from utak.planner.stages import ORIGIN_GOALS, is_at_start
from utak.planner.steps import towards
from utak.planner.subgoal_kind import SubgoalKind
from utak.planner.tasking.intention import Intention
from utak.planner.tasking.setting import DestinationFunction

LEAST_ROUND = 330.0  # degrees by which a track winds about a thing that it goes round (the meaning of the goal)
START_REACH = 1.5  # squares in each axis from where the robot woke within which it is back there, at most (derived)
NO_ROUND = 5.0  # degrees that do not matter for the sense of rotation (convention)


@dataclass(frozen=True)
class Round:
    """A way round a thing, which is counted anew when the thing was moved."""

    begin: int = 0  # the index of the place of the track at which it begins: where the thing was let go last
    before: float = 0.0  # by how many degrees the track went round the thing before that, counter-clockwise positive
    # By how many degrees more or fewer: where the thing was moved through its own middle, the sense of half a turn is
    # not known
    doubt: float = 0.0

    def besides(self, track: Sequence[XY], node: Node, back: bool) -> float:
        """Return by how many degrees the robot goes round the thing before this way and on the shortest way back."""
        return self.before + (_turned(track[self.begin], track[0], node) if back else 0.0)

    def gone_on(self, track: Sequence[XY], node: Node, held: bool) -> "Round":
        """Return the round after another place of the track. held : whether the thing was moved to there."""
        if not held:
            return self
        turns = [_turned(start, end, node) for start, end in pairwise(track[self.begin :])]
        known = [turn for turn in turns if abs(turn) <= 180.0 - NO_ROUND]
        doubt = self.doubt + 180.0 * (len(turns) - len(known))
        return Round(len(track) - 1, self.before + sum(known), doubt)


class OwnGoals:
    """Leads the robot itself where it shall be, and remembers what was begun for that."""

    def __init__(self, where: DestinationFunction) -> None:
        """Make one that has begun nothing."""
        self._where = where
        self._into_corner = IntoCorner()
        self._turn = 0  # the sign of the turn that was begun about an object
        self._round = Round()

    def note(self, turn: StageTurn) -> None:
        """Note how far the robot has gone round the thing that it shall go round; called after each impression."""
        about = next((str(goal.args[1]) for goal in turn.stage.own if goal.name in TRACK_GOALS), "")
        if (node := turn.situation.object_of(about)) is not None:
            self._round = self._round.gone_on(turn.track, node, turn.situation.model.held == node.name)

    def go(self, turn: StageTurn, intention: Intention) -> Decision:
        """Return the next command towards where the robot shall be, or the verdict; done when it is there."""
        along = intention.along_plan(turn.situation)
        decision = self._go(turn.within(along))
        if decision.verdict in (None, TaskVerdict.DONE) or along.closed == turn.situation.closed:
            return decision
        return self._go(turn)

    def go_for_wish(self, turn: StageTurn, intention: Intention) -> Decision:
        """Return the next command for a wish about the robot itself that the plan has; nothing for none."""
        found = intention.own_wish()
        if found is None:
            return nothing_to_do("the task wishes nothing more of the robot itself")
        errand, wish = found
        goals = tuple(goal for goal in turn.stage.goals if goal.name not in TRACK_GOALS)
        decision = self._go(replace(turn, stage=replace(turn.stage, goals=(*goals, wish))))
        if decision.command is not None:
            return decision
        if decision.verdict != TaskVerdict.DONE:
            intention.failed(errand, turn.situation, decision.why)
        return nothing_to_do(decision.why)

    def may_reach(self, goal: Fact, turn: StageTurn, supposed: Situation) -> bool:
        """Return whether the robot may come in another situation to where a goal for itself holds now."""
        where = None if goal.name in TRACK_GOALS else self._where(goal, turn.situation)
        return where is None or bool(where.missing) or supposed.cost_maps.nearest(where.squares) is not None

    def look(self, turn: StageTurn, transporter: Transporter) -> Decision:
        """Return a look at what makes it doubtful that the goals of a stage hold, or the verdict."""
        situation, model = turn.situation, turn.situation.model
        meant = [situation.object_of(str(term)) for goal in turn.stage.goals for term in goal.args]
        doubts, pushes = [*doubts_of_belief(filter(None, meant), situation)], {}
        rests = [goal for goal in turn.stage.goals if goal.name in ORIGIN_GOALS]
        for x in dict.fromkeys(str(goal.args[0]) for goal in rests):
            node, goals = situation.object_of(x), [goal for goal in rests if str(goal.args[0]) == x]
            began = model.frame.origin if node is None else transporter.origin_of(x, node, situation)
            covered = robot_square(model) if node is None else model.mask(node.patch)
            doubts += doubts_of_bounds(goals, x, began, covered, situation)
            if node is not None and node.name == model.held:
                there = situation.goal_rooms(goals[0], began, situation.rooms, MIN_DOOR_CONFIDENCE)
                pushes[f"bounds({x})"] = partial(push_to_see, node, there, turn)
        # So many looks from elsewhere told nothing new.
        found = turn.make_sure(doubts if model.contradicted < RESIDUAL_WINDOW else [], pushes)
        if not found and model.contradicted:
            why = f"it cannot be told whether {turn.stage} holds: what is seen differs from what is believed"
            found = Decision(None, f"{why}, and nothing is left to look at", TaskVerdict.LIMIT)
        if found.verdict is not None and model.held is not None:  # what is in hand may shut the robot in
            return Decision(Release(), f"{model.held} is released, because the robot must walk: {found.why}")
        return found

    def _go(self, turn: StageTurn) -> Decision:
        """Return the next command towards where the robot itself shall be, or the verdict; done when it is there."""
        stage, situation, reconciled = turn.stage, turn.situation, turn.reconciled
        goals = stage.own
        if situation.model.held is not None:
            why = f"{situation.model.held} is released, because the robot must walk; {stage}"
            return Decision(Release(), why)
        if goals[0].name in TRACK_GOALS:
            node = situation.object_of(str(goals[0].args[1]))
            if node is not None:
                return self._go_round(node.name, turn)
            where: Sequence[Destination] = [self._where(goals[0], situation)]
        else:
            where = jointly([self._where(goal, situation) for goal in goals])
            if halt := self._halt(where, turn):
                return halt
        woke = situation.model.frame.origin
        about_start = shapely.Point(*woke).buffer(START_REACH, cap_style="square")
        fixed = {str(goal): to_view_frame(about_start, situation) for goal in goals if is_at_start(goal)}
        if far := too_far_reason(goals, situation, fixed=fixed):
            return impossible(f"{stage} cannot be attained: {far}", far, unless=None)
        missing = "; ".join(d.missing for d in where if d.missing) or unreachable_reason(where)
        subgoals = subgoals_towards(where, situation, reconciled, TO_REACH)
        if situation.possible_doors:  # which doors there are tells which one must not be passed
            subgoals = [*subgoals, *contact_subgoals(situation)]
        unseen = any(str(term) in reconciled.hypothesised for goal in goals for term in goal.args[1:])
        proof = proof_if_not_found(situation.model) if unseen else (missing, NOTHING_LEFT)

        decision = turn.seek(subgoals, lambda: missing, proof)
        is_shut_off = decision.command is None and bool(situation.shut(ROBOT))
        opened = situation.through_shut_doors() if is_shut_off else situation
        if (opened.cost_maps.floor & ~situation.cost_maps.floor).any():
            unknown = unknown_destination("every way that is known leads through a forbidden door")
            others = subgoals_towards([unknown], situation, reconciled, TO_REACH)
            decision = turn.seek(others, lambda: unknown.missing, (unknown.missing, NOTHING_LEFT) if proof else ())
        if decision.verdict == TaskVerdict.IMPOSSIBLE and is_apart_from_start(goals, woke, situation):
            return replace(decision, unless=None)
        return halt_beside_walls(decision, stage, situation)

    def _halt(self, where: Sequence[Destination], turn: StageTurn) -> Decision:
        """Return what is done where the goals hold or are doubtful: looks, presses, or done; else nothing."""
        stage, situation = turn.stage, turn.situation
        there = all(not d.missing and robot_stands_on(d.squares, situation.model) for d in where)
        there = there or self._into_corner.is_pressing(stage, situation)
        look = _make_sure(stage.own, there, turn)
        if look or not there:
            return look
        if nearer := self._into_corner.next(stage, situation):
            return nearer
        return _attained(f"{stage} holds for the robot", turn)

    def _go_round(self, name: str, turn: StageTurn) -> Decision:
        """Return the next command on the way round an object; done when the robot has gone round it and is back."""
        stage, situation, track = turn.stage, turn.situation, turn.track[self._round.begin :]
        model, cost_maps = situation.model, situation.cost_maps
        node = model.object(name)
        assert node is not None
        is_home = (np.floor(track[0]) == np.floor(model.place)).all()
        winding = winding_number(track, node)
        back = any(is_at_start(goal) and str(goal.args[0]) == ROBOT for goal in situation.task.goals)
        besides = self._round.besides(turn.track, node, back)
        if is_home and abs(winding) == 1 and abs(besides + 360.0 * winding) - self._round.doubt >= LEAST_ROUND:
            return _attained(f"{stage} holds", turn)
        if is_home and abs(winding) == 1:  # once more: what is in doubt may have been in the other sense
            turned = self._round.before + 360.0 * winding
            self._round = replace(self._round, begin=len(turn.track) - 1, before=turned)
            return self._go_round(name, turn)
        offered = encircling_routes(cost_maps, track, node)
        self._turn = self._turn or (besides > NO_ROUND) - (besides < -NO_ROUND)
        begun = [offered[self._turn]] if self._turn in offered else list(offered.values())
        walk = turn.pursuer.choose_route(begun, situation)
        if walk is None:
            why = f"{stage} cannot be attained: no way leads round {name}"
            return impossible(why, f"no way leads round {name}")
        route, question = walk
        self._turn = next(turn for turn, other in offered.items() if other is route)
        turn.pursuer.keep_route(route, model)
        kind = SubgoalKind.ATTAIN if route.level == 0 else SubgoalKind.EXPLORE
        move = next_move(cost_maps, route.squares, route.level, kind, off_centre=False)
        steps = towards(kind, end_of(route, model), model)
        return Decision(move, f"the way round {name}; {stage}", steps=steps, question=question)


def _turned(start: XY, end: XY, node: Node) -> float:
    """Return by how many degrees a straight way turns about an object's middle, counter-clockwise positive, to 180."""
    x, y = encircled_point(node) if node.polygon is None else (node.polygon.centroid.x, node.polygon.centroid.y)
    before, after = (math.atan2(place[1] - y, place[0] - x) for place in (start, end))
    return math.degrees(math.remainder(after - before, math.tau))


def _attained(why: str, turn: StageTurn) -> Decision:
    """Return `done`; the verdict `limit` where a goal rests on where the robot woke, and it was lost since then."""
    model = turn.situation.model
    # Where a robot was lifted to, its first room is not known, either.
    resting = [
        str(goal)
        for goal in turn.stage.own
        if (model.interrupted and goal.name in TRACK_GOALS)
        or (model.anew and is_at_start(goal))
        or (model.elsewhere and goal.name in ORIGIN_GOALS)
    ]
    if not resting:
        return done(why)
    doubt = f"it cannot be told whether {' and '.join(resting)} hold{'s' * (len(resting) == 1)}: the robot was lost"
    return Decision(None, f"{doubt} since it woke", TaskVerdict.LIMIT)


def _make_sure(goals: Sequence[Fact], there: bool, turn: StageTurn) -> Decision:
    """Return a look at the objects of some goals before these are believed to hold; nothing when all are settled."""
    situation = turn.situation
    nodes = [situation.object_of(str(term)) for goal in goals for term in goal.args[1:]]
    meant = [(node, (f"due({node.name})",) * there) for node in nodes if node is not None]
    return turn.make_sure(doubt for node, due in meant for doubt in doubts_of_thing(node, due, situation, must=True))
