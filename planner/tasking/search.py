"""The search for a task plan: the encoding proposes, geometry verifies or refutes, until a plan is verified.

Geometry checks the steps in their order, each in the state that the steps before it lead to. A refutation comes back as
a fact with the least circumstances on which it rests: other things where they lie, where the robot stands, doors that
are not passed. Places to put things aside are offered for what is in the way, and for nothing else.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.manipulation.goals import End
from utak.geometry.motion.se2 import Translate
from utak.geometry.raster.rasterize import squares
from utak.kb.language.goal_words import ROBOT
from utak.kb.reasoning.encodings import encoding_constant
from utak.kb.reasoning.user_rules import rules_reach
from utak.kb.task.binding import NO_MEANINGS
from utak.kb.tracing.decisions import record_decisions
from utak.planner.carrying.manipulation_oracle import swept_squares
from utak.planner.oracles.carry import CarryOracle, Certainty, OracleAnswer
from utak.planner.oracles.problem import ANYWHERE, HERE, TableState, TaskProblem
from utak.planner.situation import Situation
from utak.planner.tasking.facts import Answers, answer_facts, overlaps_of, problem_facts, things_in_way
from utak.planner.tasking.offers import Offers, with_returns
from utak.planner.tasking.proposal import TASK_ENCODING, Proposal, propose
from utak.planner.tasking.task_plan import Errand, RefutedStep, TaskPlan
from utak.planner.under_way import UNDER_WAY

MAX_PROPOSALS = 80  # plans that are proposed for one decision; a bound on rounds, so that all machines do the same
MAX_BETTER_ROUNDS = 6  # plans that are verified after the first one, to find a cheaper one; likewise
MAX_MORE_ERRANDS = 5  # errands beyond one for each thing that is out of its place; a bound on the horizon
MAX_QUESTIONS = 150  # questions to geometry for one decision; a bound on work, so that all machines do the same
LEAST_COMMANDS = 4  # commands of an errand of which nothing is known, as in the encoding: walk, grasp, push, release
MAX_MEANING_QUESTIONS = 12  # to geometry before the first plan, about things that parameters may mean; likewise
CHANGE_OF_MEANING = encoding_constant(TASK_ENCODING, "change_of_meaning")  # commands
LEAST_WALK = 1  # commands of a walk of which nothing is known, as in the encoding


class MadePlan(NamedTuple):
    """A plan with the geometry that it rests on, in squares, view frame."""

    plan: TaskPlan  # the plan
    # The end of each place of each object: those of the goals, and those that the search offered
    places: Mapping[tuple[str, str], End]
    states: tuple[TableState, ...] = ()  # how everything lies at the beginning of each errand
    ways: tuple[Bools, ...] = ()  # the squares that each errand crosses, (rows, columns) bool with a margin
    margin: int = 0  # squares that were added to the arrays of the view on each side
    facts: tuple[str, ...] = ()  # what the encoding was given, without full stops


class PlanSearch:
    """Searches a plan for one problem; owns what geometry said so far."""

    def __init__(
        self,
        problem: TaskProblem,
        situation: Situation,
        oracle: CarryOracle,
        tried: Sequence[RefutedStep] = (),
        meant: Mapping[str, str] = NO_MEANINGS,
    ) -> None:
        """Make a search that knows nothing but what was tried."""
        self._meant = dict(meant)
        self._problem, self._situation, self._oracle = with_returns(problem), situation, oracle
        self._answers = Answers(refutations=tuple(tried))
        self._ruled = rules_reach(TASK_ENCODING.stem, situation.rules)  # whether users' rules are about task plans
        self._offers = Offers(oracle.floors, situation.rooms.labels if self._ruled else None)
        overlaps = tuple(overlaps_of(problem))
        self._facts = problem_facts(problem, (), situation, frozenset(), overlaps)
        self._cut = False  # whether a search of clingo was cut off by its limit
        self._offers.note_in_way(things_in_way(problem, overlaps))

    def run(self) -> MadePlan:
        """Return the cheapest plan that was found and verified; one with unmet goals when there is none for all."""
        self._ask_about_meanings()
        goals = self._problem.goals  # a wish that holds may not hold any more when something else was brought
        out_of_place = {goal.subject for goal in goals if not goal.holds or goal.weight is not None}
        horizon = shortest = max(1, len(out_of_place))
        most = horizon + MAX_MORE_ERRANDS
        best: TaskPlan | None = None
        facts: tuple[str, ...] = ()
        better, least, proved, number, best_price = 0, 0, False, 0, 0
        while number < MAX_PROPOSALS and better <= MAX_BETTER_ROUNDS and not proved:
            if self._oracle.asked > MAX_QUESTIONS:
                break
            number += 1
            UNDER_WAY.words = f"plan of at most {horizon} steps, proposal {number} of at most {MAX_PROPOSALS}"
            proposal = self._propose(horizon)
            fulfils = self._problem.fulfils
            if proposal.unmet and best is None and self._offer(proposal.unmet):
                if self._problem.fulfils == fulfils:  # one errand for each thing leaves none that moves something aside
                    horizon = max(horizon, shortest + 1)
                continue
            if proposal.unmet and best is None and horizon < most:
                horizon += 1
                continue
            if proposal.unmet and best is None and self._take(self._offers.further_places(self._problem)):
                horizon = shortest
                continue
            if proposal.unmet:
                best, proved = best or TaskPlan(proposal.errands, proposal.unmet, meanings=proposal.meanings), True
                facts = facts or proposal.facts
                continue
            least = least or self._estimated(proposal.errands)
            verified = self._verify(proposal.errands)
            if verified is None:
                continue
            better += 1
            proved = best is not None and verified == best.errands  # no proposal is cheaper by what geometry answered
            cost = sum(errand.commands for errand in verified)
            price = cost + sum(proposal.missed.values()) + self._price_of_meanings(proposal.meanings)
            if best is None or price <= best_price or proved:
                best = TaskPlan(verified, (), cost, missed=tuple(proposal.missed), meanings=proposal.meanings)
                facts = proposal.facts
                best_price = price
        if best is None:
            best = TaskPlan(
                (), tuple(goal.name for goal in self._problem.goals if goal.weight is None and not goal.holds)
            )
        if facts:  # the same answer again, from memory: this decision alone belongs into the record
            propose(facts, self._situation.rules, self._about())
        refutations = self._answers.refutations
        plan = replace(best, least=min(least, best.cost), proved=proved and not self._cut, rounds=number)
        plan = replace(plan, refutations=refutations, goals=self._problem.goals)
        return self._with_geometry(plan, facts)

    def _propose(self, horizon: int) -> Proposal:
        """Return the plan of the encoding with at most `horizon` errands."""
        before = [f"meant_before({parameter},{name})" for parameter, name in sorted(self._meant.items())]
        facts = (f"horizon({self._problem.begins + horizon})", *self._facts, *before, *answer_facts(self._answers))
        with record_decisions():  # of all proposals, only the last one is recorded
            proposal = propose(facts, self._situation.rules)
        self._cut = self._cut or not proposal.proved
        return proposal

    def _ask_about_meanings(self) -> None:
        """Ask geometry about the ways of things among which parameters may choose, to compare them at once."""
        several = {name for names in self._problem.meanings.values() if len(names) > 1 for name in names}
        here = self._problem.here
        asked = [(name, place) for name, place in self._problem.places if name in several and place != here(name)]
        commands, hoped = dict(self._answers.commands), set(self._answers.hoped)
        for name, place in asked[:MAX_MEANING_QUESTIONS]:
            errand = Errand("carry", name, place)
            if self._shut(errand):
                break  # with users' rules the way of an errand is that of its doors
            answer = self._ask(self._problem.state, errand, frozenset())
            if answer.after is not None:
                commands[name, here(name), place] = answer.commands
                hoped |= {(name, here(name), place)} if answer.certainty == Certainty.HOPED else set()
        self._answers = replace(self._answers, commands=commands, hoped=frozenset(hoped))

    def _price_of_meanings(self, meanings: Sequence[tuple[str, str]]) -> int:
        """Return the commands for which the encoding takes parameters that mean something else than before."""
        changed = sum(self._meant.get(parameter, name) != name for parameter, name in meanings)
        return CHANGE_OF_MEANING * changed

    def _offer(self, unmet: Sequence[str]) -> bool:
        """Offer places for things that are in the way; return whether any is new."""
        if not {goal.name for goal in self._problem.goals}.issuperset(unmet):
            self._offers.note_in_way(list(self._problem.nodes))
        return self._take(self._offers.places(self._problem))

    def _take(self, offered: TaskProblem | None) -> bool:
        """Go on with a problem that has further places; return False for None, and change nothing then."""
        if offered is None:
            return False
        self._problem = offered
        spots = self._offers.spots
        overlaps = overlaps_of(offered, spots)
        self._facts = problem_facts(offered, self._offers.aside, self._situation, spots, overlaps)
        return True

    def _estimated(self, errands: Sequence[Errand]) -> int:
        """Return how many commands the encoding reckons for some errands."""
        place = {name: self._problem.here(name) for name in (*self._problem.nodes, ROBOT)}
        total = 0
        for errand in errands:
            way = errand.subject, place[errand.subject], errand.place
            least = LEAST_WALK if errand.subject == ROBOT else LEAST_COMMANDS
            total += self._answers.commands.get(way, least) + len(errand.doors)
            place[errand.subject] = errand.place
        return total

    def _verify(self, errands: Sequence[Errand]) -> tuple[Errand, ...] | None:
        """Return the errands with what geometry says of each; None when one is refuted. Changes the answers."""
        state, found = self._problem.state, list[Errand]()
        weighed = self._ruled or any(goal.weight is not None for goal in self._problem.goals)
        if len(self._problem.nodes) == 1 and len(errands) == 1 and not weighed:
            return tuple(errands)  # one thing and one way: the plan executor asks geometry, and there is no other plan
        for errand in errands:
            origin = HERE if errand.subject == ROBOT else state.things[errand.subject].place
            answer = self._ask(state, errand, self._shut(errand))
            known = self._answers
            if answer.after is None:
                refutation = self._least_refutation(state, errand, origin)
                self._answers = replace(known, refutations=(*known.refutations, refutation))
                return None
            way = errand.subject, origin, errand.place
            hoped = known.hoped | {way} if answer.certainty == Certainty.HOPED else known.hoped
            self._answers = replace(known, commands={**known.commands, way: answer.commands}, hoped=hoped)
            found.append(replace(errand, certainty=answer.certainty, commands=answer.commands, avoid=answer.avoid))
            state = answer.after
        return tuple(found)

    def _shut(self, errand: Errand) -> frozenset[str]:
        """Return the doors that an errand does not pass, where users' rules may forbid some; else none is shut."""
        doors = {door.name for door in self._situation.rooms.doors} if self._ruled else set()
        return frozenset(doors - set(errand.doors))

    def _ask(self, state: TableState, errand: Errand, shut: frozenset[str]) -> OracleAnswer:
        """Return what geometry says of an errand in a state, with some doors shut."""
        if errand.subject == ROBOT:
            return self._oracle.arrive(state, self._problem.stands[errand.place], shut)
        end = self._problem.places[errand.subject, errand.place]
        return self._oracle.bring(state, errand.subject, end, errand.place, shut)

    def _is_refuted(self, state: TableState, errand: Errand, shut: frozenset[str]) -> bool:
        """Return whether geometry refuses an errand in a state, with some doors shut."""
        if errand.subject == ROBOT:
            return self._ask(state, errand, shut).after is None
        end = self._problem.places[errand.subject, errand.place]
        return self._oracle.is_refuted(state, errand.subject, end, shut)

    def _least_refutation(self, state: TableState, errand: Errand, origin: str) -> RefutedStep:
        """Return the refutation of an errand: each circumstance is left out while geometry still refuses."""
        shut = self._shut(errand)
        if shut and self._is_refuted(state, errand, frozenset()):
            shut = frozenset()
        known = self._known_circumstances(state, errand, shut)
        if known is not None:
            stood = None if known.stood is None else state.last
            return replace(known, origin=ANYWHERE if stood is None else origin, stood=stood)
        others = frozenset(name for name in state.things if name != errand.subject)
        gone = others - self._blocking(state, errand, shut, others)
        for name in sorted(others - gone):
            if self._is_refuted(state.without(gone | {name}), errand, shut):
                gone |= {name}
        given = tuple((name, state.things[name].place) for name in sorted(others - gone))
        self._offers.note_in_way([name for name, _ in given])
        stood = state.last if self._depends_on_robot(state.without(gone), errand, shut) else None
        found = "no way leads there"
        if errand.subject != ROBOT:
            end = self._problem.places[errand.subject, errand.place]
            found = self._oracle.refusal(state.without(gone), errand.subject, end, shut)
        barred = sorted({door.name for actor in {ROBOT, errand.subject} for door in self._situation.shut(actor)})
        found += f", with what the task or a user's rule forbids shut: {' and '.join(barred)}" if barred else ""
        return RefutedStep(errand.subject, origin, errand.place, given, stood, tuple(sorted(shut)), found)

    def _blocking(
        self, state: TableState, errand: Errand, shut: frozenset[str], others: frozenset[str]
    ) -> frozenset[str]:
        """Return some of the things because of which geometry refuses an errand: those on the ways that it finds."""
        margin, (rows, columns) = self._oracle.floors.margin, self._offers.shape
        placed = {name: Translate(margin, margin).carry(lying.outline) for name, lying in state.things.items()}
        blocking = frozenset[str]()
        while (answer := self._ask(state.without(others - blocking), errand, shut)).after is not None:
            if answer.plan is None:
                return others
            way = swept_squares(answer.plan, placed[errand.subject], self._offers.shape)
            if not blocking:  # the way that it would take by itself
                self._offers.keep_clear(way)
                self._offers.keep_way(errand.subject, placed[errand.subject], answer.plan.polygon)
            crossed = {name for name in others - blocking if (way & squares(placed[name], columns, rows)).any()}
            if not crossed:  # it is the robot's walk that is blocked
                return others
            blocking |= crossed
        return blocking

    def _depends_on_robot(self, state: TableState, errand: Errand, shut: frozenset[str]) -> bool:
        """Return whether a refuted errand could be done if the robot stood elsewhere."""
        if errand.subject == ROBOT:
            return True
        end = self._problem.places[errand.subject, errand.place]
        return not self._oracle.is_refuted_from_anywhere(state, errand.subject, end, shut)

    def _known_circumstances(self, state: TableState, errand: Errand, shut: frozenset[str]) -> RefutedStep | None:
        """Return an earlier refutation of the same errand from elsewhere, if what it rests on refutes it here, too."""
        for earlier in self._answers.refutations:
            if (earlier.subject, earlier.place, frozenset(earlier.shut)) != (errand.subject, errand.place, shut):
                continue
            if errand.subject == ROBOT or any(state.things[name].place != place for name, place in earlier.given):
                continue
            given = {name for name, _ in earlier.given}
            rest = frozenset(state.things) - given - {errand.subject}
            if self._is_refuted(state.without(rest), errand, shut):
                return earlier
        return None

    def _about(self) -> list[str]:
        """Return the goals in words, by their number from 1, and what geometry found, by refutation, for the record."""
        return [*(f"{goal.name}: {goal.words}" for goal in self._problem.goals), *self._answers.found]

    def _with_geometry(self, plan: TaskPlan, facts: tuple[str, ...]) -> MadePlan:
        """Return a plan with the states that it leads to and the squares that it crosses."""
        margin, state = self._oracle.floors.margin, self._problem.state
        states, ways = list[TableState](), list[Bools]()
        if not plan.verified:
            return MadePlan(plan, self._problem.places, (state,) * len(plan.errands), (), margin, facts)
        for errand in plan.errands if not plan.unmet else ():
            answer = self._ask(state, errand, self._shut(errand))
            assert answer.after is not None
            way: Bools = np.zeros(self._offers.shape, np.bool_)
            if answer.plan is not None:
                outline = Translate(margin, margin).carry(state.things[errand.subject].outline)
                way = swept_squares(answer.plan, outline, self._offers.shape)
            states.append(state)
            ways.append(way)
            state = answer.after
        return MadePlan(plan, self._problem.places, tuple(states), tuple(ways), margin, facts)


def make_plan(
    problem: TaskProblem,
    situation: Situation,
    oracle: CarryOracle,
    tried: Sequence[RefutedStep] = (),
    meant: Mapping[str, str] = NO_MEANINGS,
) -> MadePlan:
    """Return the cheapest plan that was found and verified; one with unmet goals when there is none for all of them."""
    return PlanSearch(problem, situation, oracle, tried, meant).run()
