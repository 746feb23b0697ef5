"""The intention: the task plan under way. It is kept while what it rests on stands, and made anew when that falls."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.goals import End, moved
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.terms import Fact
from utak.kb.reasoning.user_rules import rules_reach
from utak.kb.world.model import Node
from utak.planner.goals.placement import meets_end
from utak.planner.oracles.carry import CarryOracle
from utak.planner.oracles.problem import HERE, TaskProblem
from utak.planner.screen.projection import UNSEEN_LEVEL
from utak.planner.situation import Situation
from utak.planner.stages import Stage
from utak.planner.tasking.history import MAX_DISPLACEMENT, DoneErrands
from utak.planner.tasking.proposal import TASK_ENCODING
from utak.planner.tasking.rule_effects import (
    doors_at,
    doors_led_round,
    facts_rules_read,
    rules_alone_leave_no_plan,
    rules_without_plan,
)
from utak.planner.tasking.search import MAX_QUESTIONS, make_plan
from utak.planner.tasking.setting import (
    WhereGoalsHold,
    goal_of_place,
    place_name,
    problem_of,
    wish_of_place,
)
from utak.planner.tasking.settling import plan_that_settles, step_that_settles
from utak.planner.tasking.task_plan import Errand, RefutedStep, TaskPlan

MORE_FLOOR = 1.25  # times the floor for which there was no plan, with which it is worth to look for one; a convention


class NextErrand(NamedTuple):
    """The next errand of a plan, and the end that it leads to."""

    errand: Errand  # the step of the plan
    node: Node  # the object that is brought
    end: End  # where it shall lie, in squares, view frame
    goal: Fact | None  # the goal or wish whose own end this is; None for a spot that the planner chose
    end_name: str  # the name of that end among the ends of the goal; "" for a spot
    turned: float  # by how many degrees the object had been turned when the plan was made


@dataclass(frozen=True)
class _Kept:
    """A plan with what it rests on; all geometry in squares, map frame."""

    plan: TaskPlan  # the plan
    stage: Stage  # for which it was made
    names: tuple[str, ...]  # the things that may be carried
    places: frozenset[tuple[str, str]]  # the places of goals that were known
    spots: Mapping[tuple[str, str], End]  # the end of each place that the planner chose, by object and place
    # Where each thing lies at the beginning of each errand: its bounds, by the number of the errand and name
    bounds: tuple[Mapping[str, tuple[float, ...]], ...]
    ways: tuple[Any, ...]  # the squares (x, y) that each errand crosses, (n, 2)
    turned: Mapping[str, float]  # by how many degrees each thing had been turned when the plan was made
    # The middles (x, y) of the doors that each errand does not pass, where users' rules are about task plans
    led_round: tuple[tuple[XY, ...], ...] = ()
    read: frozenset[str] = frozenset()  # what users' rules read of the world model
    number: int = 0  # the errand that is done now

    @property
    def errand(self) -> Errand | None:
        """The errand that is done now; None when all are done."""
        return self.plan.errands[self.number] if self.number < len(self.plan.errands) else None

    def means_what_is_bound(self, problem: TaskProblem) -> bool:
        """Return whether each parameter still means in a problem what it means in the plan."""
        meanings = dict(self.plan.meanings)
        return all(meanings.get(goal.parameter, goal.subject) == goal.subject for goal in problem.goals)


class Intention:
    """Owns the task plan under way, and what was tried in vain."""

    def __init__(self, where: WhereGoalsHold, pull: bool = True) -> None:
        """Make an intention without a plan."""
        self.where, self._pull = where, pull
        self._kept: _Kept | None = None
        self._under_way: TaskPlan | None = None  # its first step is done amid a turn, while no plan can be made
        self._settling: TaskPlan | None = None  # the plan that settles something, while that is open
        self._attempt: TaskPlan | None = None  # the last plan that does not attain all goals, while there is no other
        self._tried: list[tuple[Any, RefutedStep]] = []  # with where everything lay then
        self._hopeless: Any = None  # what was believed when no plan was found last
        self._problem: TaskProblem | None = None  # of the present situation
        self._stage: Stage | None = None  # for which `_tried` counts
        self._history = DoneErrands()
        self._dropped: frozenset[Fact] = frozenset()  # wishes that could not be attained
        self._meant: Mapping[str, str] = {}  # the object that the last plan meant by each parameter of the task
        self.blamed: tuple[str, ...] = ()
        self.blamed_before: tuple[str, ...] = ()  # the last rules of the run because of which there was no plan
        self.shut_out = False  # whether these leave no plan for good, whatever else is found

    @property
    def plan(self) -> TaskPlan | None:
        """The plan under way, from its present errand on; None for none."""
        if self._kept is None:
            return None
        return replace(self._kept.plan, errands=self._kept.plan.errands[self._kept.number :])

    @property
    def followed(self) -> TaskPlan | None:
        """The plan whose present step is done, from that step on: also one that settles something; None for none."""
        return self._settling or self.plan or self._under_way

    @property
    def attempt(self) -> TaskPlan | None:
        """The best that was found in place of a plan: it leaves goals unmet; None while there is a plan."""
        return self._attempt if self._kept is None else None

    def update(self, stage: Stage, situation: Situation, avoid: Mapping[str, Any], turn: float) -> Situation:
        """Make the plan anew where it no longer holds; return the situation with what the plan means by parameters."""
        stage = self._without_dropped(stage)
        followed = self.followed if stage == self._stage else None
        self._history.note(situation)
        self._problem = problem_of(stage, situation, self.where, self._history)
        if stage != self._stage:
            self._stage, self._tried = stage, []
        is_carried = followed is not None and [one.subject for one in followed.errands[:1]] == [situation.model.held]
        self._under_way = followed if is_carried and self._problem is None else None
        self._settling = None
        if self._problem is None or self._problem.waiting:
            self._kept = self._attempt = None
        else:
            before, self._kept = self._kept, self._moved_on(stage, self._problem, situation)
            if self._kept is not before:  # an errand came to its end
                self._problem = problem_of(stage, situation, self.where, self._history) or self._problem
            self._kept = self._kept_still(self._problem, situation)
            if self._kept is None:
                self._kept = self._made(stage, self._problem, situation, avoid, turn)
        meant = self.meanings
        if any(situation.binding.get(parameter) != name for parameter, name in meant.items()):
            situation = with_meanings(situation, meant)
            self._problem = problem_of(stage, situation, self.where, self._history)
        return situation

    def settle(self, stage: Stage, situation: Situation, given: Sequence[str]) -> tuple[str, str]:
        """Plan what settles what is open."""
        # Return its first step, or "" and the words for what users' rules forbid then.
        stage = self._without_dropped(stage)
        problem = problem_of(stage, situation, self.where, self._history)
        if problem is not None:
            problem = self._with_past(problem, situation)
        refuted = () if self._attempt is None else self._attempt.refutations
        plan, left = plan_that_settles(problem, stage, situation, given, refuted)
        step = step_that_settles(plan, any(fact.startswith("stuck(") for fact in given))
        self._settling = None if step is None else plan
        return ("", left) if step is None else (str(step), "")

    @property
    def meanings(self) -> Mapping[str, str]:
        """The object that each parameter of the task means in the plan under way, where it chose among several."""
        return {} if self._kept is None else dict(self._kept.plan.meanings)

    def refused_meanings(self, stage: Stage, situation: Situation) -> frozenset[tuple[str, str]]:
        """Return the (parameter, object) pairs bound now that users' rules leave to no plan."""
        attempt = self.attempt
        if attempt is None or not attempt.proved or not self.blamed:
            return frozenset()
        meant, parameters = dict(attempt.meanings), {str(goal.args[0]) for goal in stage.carried}
        bound = ((x, name) for x, name in situation.binding.items() if x in parameters - meant.keys())
        return frozenset((x, name) for x, name in bound if situation.model.object(name) is not None)

    def next_errand(self, stage: Stage, situation: Situation) -> NextErrand | None:
        """Return the next errand of the plan; None when there is no plan, or the next step is the robot's own."""
        kept, problem, stage = self._kept, self._problem, self._without_dropped(stage)
        errand = None if kept is None else kept.errand
        if kept is None or problem is None or errand is None or errand.subject == ROBOT:
            return None
        spot = kept.spots.get((errand.subject, errand.place))
        node = problem.nodes[errand.subject]
        turned = kept.turned[errand.subject]
        if spot is not None:
            return NextErrand(errand, node, _moved_to_view(spot, situation), None, "", turned)
        goal, end_name = self._goal_of(errand, stage, problem, situation)
        end = problem.places[errand.subject, errand.place]
        return NextErrand(errand, node, end, goal, end_name, turned)

    def _goal_of(
        self, errand: Errand, stage: Stage, problem: TaskProblem, situation: Situation
    ) -> tuple[Fact | None, str]:
        """Return the goal or wish that an errand attains, and the name of its end there."""
        found = goal_of_place(errand.place, stage)
        if found is None:
            return None, ""
        name, goal = found
        land = self.where.of(goal, problem.nodes[errand.subject], situation)
        ends = (*land.ends, *land.loose)
        return next(((goal, end) for end in ends if place_name(name, end) == errand.place), (None, ""))

    def failed(self, errand: Errand, situation: Situation, why: str) -> None:
        """Note that an errand cannot be done as things lie now; the plan is made anew without it."""
        wish = None if self._kept is None else wish_of_place(errand.place, self._kept.stage)
        self._dropped |= set() if wish is None else {wish}
        others = () if self._problem is None else sorted(self._problem.nodes.keys() - {errand.subject})
        here = (lambda _name: HERE) if self._problem is None else self._problem.here
        given = tuple((name, here(name)) for name in others)
        refuted = RefutedStep(errand.subject, here(errand.subject), errand.place, given, found=why)
        self._tried.append((_lying(situation), refuted))
        self._kept = None

    @property
    def is_open(self) -> bool:
        """Whether it is open where exactly some goal of the problem holds."""
        return self._problem is None or self._problem.open or bool(self._problem.waiting)

    @property
    def knows_where_to_go(self) -> bool:
        """Whether it is known where goals hold for the robot itself."""
        return self._problem is not None and bool(self._problem.stands)

    def along_plan(self, situation: Situation) -> Situation:
        """Return the situation without the doors that the present errand does not pass, where users' rules count."""
        kept = self._kept
        if kept is None or kept.number >= len(kept.led_round):
            return situation
        closed = doors_at(kept.led_round[kept.number], situation)
        return situation.with_closed(closed) if closed else situation

    def own_wish(self) -> tuple[Errand, Fact] | None:
        """Return the next step of the plan and its wish, when the robot goes somewhere for a wish; None otherwise."""
        kept = self._kept
        errand = None if kept is None else kept.errand
        if kept is None or errand is None or errand.subject != ROBOT:
            return None
        wish = wish_of_place(errand.place, kept.stage)
        return None if wish is None else (errand, wish)

    def wishes_that_hold(self) -> tuple[str, ...]:
        """Return the wishes that hold now, as the task states them; () while no plan can be made."""
        goals = () if self._problem is None else self._problem.goals
        return tuple(goal.words for goal in goals if goal.weight is not None and goal.holds)

    def _without_dropped(self, stage: Stage) -> Stage:
        """Return a stage without the wishes that were dropped."""
        return replace(stage, wishes=tuple(pair for pair in stage.wishes if pair[0] not in self._dropped))

    def _kept_still(self, problem: TaskProblem, situation: Situation) -> _Kept | None:
        """Return the plan under way; None when what it rests on fell."""
        kept = self._kept
        if kept is None or kept.names != tuple(problem.nodes) or kept.places != problem.places_meant({}):
            return None
        if kept.read != facts_rules_read(situation):
            return None
        return kept if kept.means_what_is_bound(problem) and self._stands(kept, problem, situation) else None

    def _moved_on(self, stage: Stage, problem: TaskProblem, situation: Situation) -> _Kept | None:
        """Return the plan of a stage, moved on over errands that came to their ends, which are noted."""
        kept = None if self._kept is None or self._kept.stage != stage else self._kept
        while kept is not None and (errand := kept.errand) is not None:
            spot = kept.spots.get((errand.subject, errand.place))
            known = problem.places.get((errand.subject, errand.place))
            end = known if spot is None else _moved_to_view(spot, situation)
            if end is None or errand.subject not in problem.nodes:
                break  # the robot's own, or nothing is known of it any more
            if not meets_end(end, problem.state.things[errand.subject].outline):
                break
            self._history.note(situation, errand)
            kept = replace(kept, number=kept.number + 1)
        return kept

    def _stands(self, kept: _Kept, problem: TaskProblem, situation: Situation) -> bool:
        """Return whether all things lie as the plan expects, and no way that is left is seen to be blocked."""
        if kept.number >= len(kept.plan.errands):
            missed = kept.plan.missed
            return all(goal.holds or goal.name in missed for goal in problem.goals)
        subject = kept.plan.errands[kept.number].subject
        now = _bounds(problem, situation)
        for name, expected in kept.bounds[kept.number].items():
            off = max(abs(a - b) for a, b in zip(now[name], expected, strict=True))
            if name != subject and off > MAX_DISPLACEMENT:
                return False
        view, model = situation.model.view, situation.model
        open_ = situation.cost_maps.free(UNSEEN_LEVEL)
        for node in problem.nodes.values():
            open_ |= model.mask(node.patch)
        for way in kept.ways[kept.number :]:
            columns, rows = way[:, 0] - view.west, way[:, 1] - view.south
            inside = (columns >= 0) & (rows >= 0) & (columns < open_.shape[1]) & (rows < open_.shape[0])
            if not open_[rows[inside], columns[inside]].all():
                return False
        return True

    def _made(
        self, stage: Stage, problem: TaskProblem, situation: Situation, avoid: Mapping[str, Any], turn: float
    ) -> _Kept | None:
        """Return a new plan with what it rests on; None when there is none that attains all goals."""
        ruled = rules_reach(TASK_ENCODING.stem, situation.rules)  # then there may be goals that the task does not have
        if all(goal.holds for goal in problem.goals) and not ruled:
            self._attempt = None
            return None
        problem = self._with_past(problem, situation)
        lying = _lying(situation)
        # More that is seen leaves less that may be free, so only more floor to put things on can bring a new plan.
        floor = int(math.log(max(1, situation.cost_maps.free(0).sum()), MORE_FLOOR))
        doors = tuple((door.name, door.sides) for door in situation.rooms.doors) if ruled else ()
        read = facts_rules_read(situation)
        believed = (lying, frozenset(problem.places), floor, len(self._tried), doors, read)
        if self._hopeless is not None and (situation.model.held is not None or believed == self._hopeless):
            return None
        tried = [refutation for where, refutation in self._tried if where == lying]
        for on_lattice in (True, False):  # ways by whole squares are found fast, and mostly they do
            oracle = CarryOracle(problem, situation, self._pull, avoid, turn, on_lattice)
            made = make_plan(problem, situation, oracle, tried, self._meant)
            if not made.plan.unmet or oracle.asked > MAX_QUESTIONS:
                break  # who asked too much by whole squares would do so by exact ways, too
        self.blamed = rules_without_plan(made, situation)
        self.blamed_before = self.blamed or self.blamed_before
        self.shut_out = rules_alone_leave_no_plan(made, self.blamed, situation)
        self._hopeless = believed if made.plan.unmet else None
        self._attempt = made.plan if made.plan.unmet else None
        if made.plan.unmet:
            return None
        view = situation.model.view
        west, south = view.west, view.south
        spots = {key: moved(end, west, south) for key, end in made.places.items() if key not in problem.places}
        bounds = tuple(
            {name: _shifted(one.outline.bounds, west, south) for name, one in state.things.items()}
            for state in made.states
        )
        ways = tuple(_squares_of(way, west - made.margin, south - made.margin) for way in made.ways)
        turned = {name: node.turned for name, node in problem.nodes.items()}
        chosen = tuple(pair for pair in made.plan.meanings if pair[0] in problem.meanings)
        self._meant, plan = dict(chosen), replace(made.plan, meanings=chosen)
        names, places = tuple(problem.nodes), problem.places_meant(self._meant)
        led_round = doors_led_round(made, situation)
        return _Kept(plan, stage, names, places, spots, bounds, ways, turned, led_round, read)

    def _with_past(self, problem: TaskProblem, situation: Situation) -> TaskProblem:
        """Return a problem with what was done before, where users' rules are about task plans."""
        if not rules_reach(TASK_ENCODING.stem, situation.rules):
            return problem
        arrived = {goal.subject for goal in problem.goals if goal.holds}
        return replace(problem, past=self._history.facts(situation, arrived))


def with_meanings(situation: Situation, meanings: Mapping[str, str]) -> Situation:
    """Return a situation whose parameters mean what a plan means by them; what they meant before may be meant, too."""
    binding = {**situation.binding, **meanings}
    as_well = {
        parameter: tuple(name for name in (situation.binding[parameter], *others) if name != binding[parameter])
        for parameter, others in situation.as_well.items()
    }
    return replace(situation, binding=binding, as_well=as_well)


def _moved_to_view(end: End, situation: Situation) -> End:
    """Return an end in the view frame, from the map frame."""
    view = situation.model.view
    return moved(end, -view.west, -view.south)


def _lying(situation: Situation) -> Any:
    """Return where all things lie, to whole squares, as something that can be compared."""
    return tuple(
        (node.name, *(round(v) for v in node.polygon.bounds))
        for node in situation.model.objects
        if node.polygon is not None
    )


def _bounds(problem: TaskProblem, situation: Situation) -> dict[str, tuple[float, ...]]:
    """Return the bounds of all things now, in squares, map frame."""
    view = situation.model.view
    return {name: _shifted(one.outline.bounds, view.west, view.south) for name, one in problem.state.things.items()}


def _shifted(bounds: tuple[float, ...], dx: float, dy: float) -> tuple[float, ...]:
    """Return bounds (west, south, east, north) translated by (dx, dy)."""
    west, south, east, north = bounds
    return west + dx, south + dy, east + dx, north + dy


def _squares_of(mask: Bools, dx: int, dy: int) -> Any:
    """Return the squares (x, y) of a mask, translated by (dx, dy), (n, 2)."""
    rows, columns = np.nonzero(mask)
    return np.column_stack([columns + dx, rows + dy])
