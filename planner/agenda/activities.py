"""Activities: the steps of the robot for a stage of its task, and their results.

The activities have the names of planner/asp/deciding, which chooses among them.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

from utak.geometry.kernels.arrays import Bools
from utak.kb.body import Grasp, Push, Release, Turn
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.terms import Fact
from utak.kb.language.vocabulary import RESUMED_STEPS, SETTLING_STEPS
from utak.kb.task.task import Task
from utak.planner.agenda.choice import Activity, Agenda, StageEnd
from utak.planner.agenda.own_goals import OwnGoals
from utak.planner.carrying.open_facts import OpenQuestion, open_facts
from utak.planner.carrying.remaining_plan import RemainingPlan
from utak.planner.constraints import avoidances
from utak.planner.deciding.clearing import ObstacleClearer
from utak.planner.deciding.errands import ErrandRunner
from utak.planner.deciding.feeling import feeling_scope, touch_contacts
from utak.planner.deciding.keeping import ConstraintKeeper
from utak.planner.deciding.search import contact_subgoals
from utak.planner.deciding.stage_turn import ALL_OBJECTS, CONSTRAINTS, ROBOT_ITSELF, StageTurn
from utak.planner.deciding.transport import Transporter
from utak.planner.deciding.trials import Trials
from utak.planner.decision import Decision, TaskVerdict, nothing_to_do
from utak.planner.goals.placement import meets_any_end, to_view_frame
from utak.planner.goals.robot_goals import destination
from utak.planner.oracles.problem import PlacedGoal
from utak.planner.per_model import PerModel
from utak.planner.question import DECIDING_ENCODING, Question
from utak.planner.sights.frontiers import find_frontiers
from utak.planner.sights.walls import ALL_WALLS
from utak.planner.situation import Situation
from utak.planner.stages import Stage
from utak.planner.steps import refusal, steps_of
from utak.planner.tasking.rule_effects import rules_close_all_doors, rules_that_close
from utak.planner.tasking.setting import place_name, waiting_goal
from utak.planner.tasking.task_plan import RECOVERY, Errand, TaskPlan

# As what steps of a plan activities without one of that name are done, where there is no task plan.
_ERRANDS = {"go": Errand("pursue", ROBOT_ITSELF), "look": Errand("confirm", ALL_OBJECTS), "release": RECOVERY}
# What verdicts say of open facts.
_HOPES = {TaskVerdict.POSSIBLE_IF: "it may be possible if", TaskVerdict.LIMIT: "no plan is known to exist even if"}


class Activities:
    """Does what the agenda chooses, and owns what carries it out."""

    def __init__(self, task: Task, pull: bool) -> None:
        """Make activities of which none was begun."""
        where = PerModel(destination)
        self._transporter, self._clearer, trials = Transporter(), ObstacleClearer(), Trials()
        clearer, checks = self._clearer, self._transporter.checks
        # By the name of a step that settles something: its next command, or what it came to. These are methods, not
        # lambdas: when a mind is copied (planner/cycle.py), a method goes with its object, a lambda keeps the old one.
        self._settling: Mapping[str, Callable[[Sequence[Fact], StageTurn], Decision]] = {
            "find": self._towards_first,
            "pursue": self._towards_first,
            "touch": touch_contacts,
            "recheck": checks.recheck,
            "measure": checks.measure,
            "probe": checks.probe,
            "gauge": checks.gauge,
            "pull": clearer.pull,
            "make_way": clearer.clear,
            "try": trials.next,
            "feel": clearer.feel,
            "bare": clearer.bare,
        }
        # By the name of a step that is resumed in later decisions: whether it was begun, and its next command then.
        self._resumed: Mapping[str, tuple[Callable[[Situation], bool], Callable[[StageTurn], Decision]]] = {
            "feel": (clearer.is_feeling, clearer.feel_on),
            "make_way": (clearer.is_moving, clearer.clear_on),
            "try": (trials.is_pushing, trials.go_on),
            "measure": (checks.is_measuring, checks.measure_on),
            "gauge": (checks.is_at_wall, checks.step_back),
        }
        if (set(self._settling), set(self._resumed)) != (set(SETTLING_STEPS), set(RESUMED_STEPS)):
            raise LookupError("the steps of kb/language/vocabulary.py and of planner/agenda/activities.py differ")
        self.errands, self.keeper = ErrandRunner(self._transporter, where, pull), ConstraintKeeper(task)
        self._own, self._untouched = OwnGoals(where), PerModel(contact_subgoals)
        self._bare = TaskPlan(())  # the step as which the newest command is given, where the task plan has none for it
        self._follows = False  # whether the newest command is one of the present step of the task plan
        self._begun: dict[str, TaskPlan] = {}  # those that may be resumed, by their names
        # The goal that the newest command pursues by itself, with each goal that held then, and what they mean.
        self._held: frozenset[tuple[Fact, Fact, frozenset[str]]] = frozenset()
        # Goals that were pursued by themselves, with those that this undid, and what they meant.
        self._undid: set[tuple[Fact, Fact, frozenset[str]]] = set()

    def holds(self, situation: Situation) -> Callable[[Fact], bool]:
        """Return the function that tells whether a goal for an object holds in a situation."""

        def is_so(goal: Fact) -> bool:
            """Return whether the goal holds for what its parameter means; False while nothing is known to be that."""
            node = situation.object_of(str(goal.args[0]))
            if node is None or node.polygon is None:
                return False
            land = self.errands.intention.where.of(goal, node, situation)
            return land.holds or meets_any_end(land.loose, to_view_frame(node.polygon, situation))

        return is_so

    def decide(self, turn: StageTurn) -> Decision:
        """Return the next command for a stage, or the verdict with which the robot gives up."""
        self._own.note(turn)
        self._transporter.checks.begin(turn)
        holds = self.holds(turn.situation)
        self._undid |= {undone for undone in self._held if not holds(undone[1])}
        about = tuple(f"{name}: {goal}" for name, goal in turn.goals.items())
        agenda = Agenda(Question(turn.situation.rules, tuple(self._facts(turn)), about))
        last = proved = nothing_to_do("all goals hold")
        while isinstance(found := agenda.next(), Activity):
            asked = replace(turn, agreeing=found.subject == ALL_OBJECTS)
            if self._learns(found, agenda, last, asked):
                continue
            asked = asked.within(replace(turn.situation, question=agenda.question.keeping(f"do({found})")))
            decision = self._transporter.led_out(self._allowed(self._do(found, asked, last), found, asked), asked)
            decision = _done_by_rules(decision, asked.situation)
            if decision.command is not None:
                self._note_step(found, decision, turn)
                self._note_pursuit(found, turn)
                return decision
            agenda.note(found, decision)
            if decision.verdict not in (None, TaskVerdict.DONE):
                last = decision
                proved = decision if decision.verdict == TaskVerdict.IMPOSSIBLE else proved
        agenda.question.recorded()
        if agenda.open.facts and found.verdict in _HOPES:
            last = replace(last, why=f"{last.why}; {_HOPES[found.verdict]} {agenda.open.in_words(agenda.named)}")
        return self._ended(found, proved if found.verdict == TaskVerdict.IMPOSSIBLE else last, turn)

    def _learns(self, activity: Activity, agenda: Agenda, last: Decision, turn: StageTurn) -> bool:
        """Return whether an activity does nothing but ask for facts, after these were noted on the agenda."""
        if activity.kind == "settle" and (step := self.errands.settle(turn, self._open(turn, agenda))):
            agenda.learn([f"planned({step})"])
        elif activity.kind == "doubt":
            scope = ALL_WALLS if activity.subject == CONSTRAINTS else feeling_scope(turn)
            exists = partial(self._plan_exists, turn.goals_of(activity.subject), turn)
            agenda.ask(activity, OpenQuestion(open_facts(last, turn.situation, scope), exists))
            agenda.learn(["rules_close_all_doors"] * rules_close_all_doors(turn.situation))
        elif activity.kind == "suppose":
            agenda.learn(agenda.open.answer(agenda.named))
        else:
            return False
        return True

    def _open(self, turn: StageTurn, agenda: Agenda) -> list[str]:
        """Return what is open, as facts for the task plan."""
        untouched = ["untouched"] * bool(self._untouched(turn.situation))
        return [*_unknown(turn), *agenda.results, *untouched, *self._transporter.checks.facts(turn)]

    @property
    def stated(self) -> TaskPlan:
        """The task plan, where the newest command is one of its present step; else the step as which it is given."""
        plan = self.errands.intention.followed
        return plan if self._follows and plan is not None else self._bare

    def _note_pursuit(self, activity: Activity, turn: StageTurn) -> None:
        """Note which goal an activity pursues by itself, and which hold meanwhile."""
        holds, goals = self.holds(turn.situation), turn.goals.items()
        pursued = [goal for name, goal in goals if activity == Activity("pursue", name)]
        kept = [(one, goal) for one in pursued for _, goal in goals if holds(goal)]
        self._held = frozenset((*pair, turn.situation.named_by(pair)) for pair in kept)

    def _note_step(self, activity: Activity, decision: Decision, turn: StageTurn) -> None:
        """Note as what step of a plan an activity is done."""
        plan = self.errands.intention.followed
        errands = () if plan is None else plan.errands
        self._bare = self._as_step(activity, decision, turn)
        self._follows = bool(errands) and (
            activity.kind in ("errand", "wish")
            or (activity.kind == "go" and errands[0].action == "arrive")
            or errands[:1] == self._bare.errands
            or (
                not errands[0].settles and errands[0].place == _carried_to(activity, decision, errands[0].subject, turn)
            )
        )

    def _as_step(self, activity: Activity, decision: Decision, turn: StageTurn) -> TaskPlan:
        """Return the step as which an activity is done that is none of the task plan, with the goals that it is for."""
        if activity.kind == "resume":
            return self._begun.get(activity.subject) or TaskPlan((Errand(activity.subject, ALL_OBJECTS),))
        errand = _ERRANDS.get(activity.kind) or Errand(activity.kind, activity.subject)
        meant = [(name, goal) for name, goal in turn.goals.items() if name == errand.subject]
        goals = [waiting_goal(name, goal) for name, goal in meant]
        unmet = [name for name, goal in meant if not self._attains(decision, goal, turn)]
        if errand.subject == ROBOT_ITSELF and turn.stage.own:
            name = f"g{len(turn.goals) + 1}"
            goals = [PlacedGoal(name, " and ".join(map(str, turn.stage.own)), ROBOT, False)]
            # The last step towards what is only looked at is the look.
            unmet = [] if decision.steps and decision.steps[-1].name == "go" else [name]
        bare = TaskPlan((errand,), tuple(unmet), goals=tuple(goals))
        if activity.kind in self._resumed:
            self._begun[activity.kind] = bare
        return bare

    def _attains(self, decision: Decision, goal: Fact, turn: StageTurn) -> bool:
        """Return whether a goal for an object holds, or will hold where the steps of a decision leave that."""
        node, situation = turn.situation.object_of(str(goal.args[0])), turn.situation
        if node is None or node.polygon is None:
            return False
        plan = _under_way(decision, node.name, turn)
        if plan is None:
            return self.holds(situation)(goal)
        land, outline = self.errands.intention.where.of(goal, node, situation), to_view_frame(plan.end, situation)
        return meets_any_end(land.ends, outline) or meets_any_end(land.hoped.ends(), outline)

    def _facts(self, turn: StageTurn) -> Iterator[str]:
        """Yield the facts of a stage for the agenda, without full stops."""
        model = turn.situation.model
        yield from (f"stage_goal({name},{number})" for number, name in enumerate(turn.goals, 1))
        yield from _unknown(turn)
        yield from [f"holds({model.held})"] * (model.held is not None)
        names = {goal: name for name, goal in turn.goals.items()}
        undid = [(a, b) for a, b, meant in self._undid if meant == turn.situation.named_by((a, b))]
        pairs = [(names[one], names[other]) for one, other in undid if {one, other} <= names.keys()]
        yield from (f"undid({one},{other})" for one, other in sorted(pairs))
        yield from (f"begun({name})" for name, (is_begun, _) in self._resumed.items() if is_begun(turn.situation))
        if not turn.stage.goals and self._doubt_of_done(turn.situation):
            yield "constraints_doubtful"
        given = {
            "own_goals": bool(turn.stage.own),
            "stages_attained": not turn.stage.goals,
            "regions_forbidden": any(True for _ in avoidances(turn.situation.task)),
            "hand_unsure": model.may_hold,
            "unplanned": self.errands.intention.attempt is not None,
            "robot_lost": model.lost,
            "map_contradicted": model.anew and model.shaken,
        }
        yield from (name for name, holds in given.items() if holds)
        yield from turn.situation.facts_for_rules(DECIDING_ENCODING.stem)

    def _do(self, activity: Activity, turn: StageTurn, last: Decision) -> Decision:
        """Return what an activity comes to."""
        stage, situation = turn.stage, turn.situation
        goals = turn.goals_of(activity.subject)
        if activity.kind in self._settling:
            return self._settling[activity.kind](goals, turn)
        doing: Mapping[str, Callable[[], Decision]] = {
            "release": lambda: _put_down(situation),
            "keep": lambda: self.keeper.broken_at_start(situation),
            "resume": lambda: self._resumed[activity.subject][1](turn),
            "agree": lambda: self._transporter.conflict(stage, situation),
            "errand": lambda: self.errands.next(turn),
            "settle": self._nothing_settles,
            "go": lambda: self._own.go(turn, self.errands.intention),
            "clash": lambda: _clash(goals[0], stage),
            "wish": lambda: self._own.go_for_wish(turn, self.errands.intention),
            "look": lambda: self._own.look(turn, self._transporter),
            "blame": lambda: _added(last, self._clearer.blame(turn.situation)),
        }
        return doing[activity.kind]()

    def _towards_first(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command towards the first of some goals for objects, or what it came to."""
        return self._transporter.towards(goals[0], turn)

    def _plan_exists(self, goals: Sequence[Fact], turn: StageTurn, opened: Bools) -> bool:
        """Return whether some goals may be attained if some squares, (rows, columns) bool, are free."""
        return bool(opened.any()) and self._may_attain(goals, turn, turn.situation.with_free(opened))

    def _may_attain(self, goals: Sequence[Fact], turn: StageTurn, supposed: Situation) -> bool:
        """Return whether some goals may be attained in another situation where they hold now, as far as is known."""
        own = turn.stage.own
        may = [(goal, self._own.may_reach if goal in own else self._transporter.may_bring) for goal in goals]
        return all(attain(goal, turn, supposed) for goal, attain in may)

    def may_do_more(self, turn: StageTurn, supposed: StageTurn) -> bool:
        """Return whether in another situation the goals may be attained, or more be seen, and as things are not."""
        goals, here, there = turn.stage.goals, turn.situation, supposed.situation
        if not self._may_attain(goals, supposed, there):
            return False
        sees = [bool(find_frontiers(situation.cost_maps, 0)) for situation in (here, there)]
        return sees == [False, True] or not self._may_attain(goals, turn, here)

    def _nothing_settles(self) -> Decision:
        """Return that no step of the task plan settles what is open; `limit` where users' rules forbid such a step."""
        if not self.errands.forbidden:
            return nothing_to_do("no step of the task plan settles what is open")
        return Decision(None, f"users' rules forbid {self.errands.forbidden}", TaskVerdict.LIMIT)

    def _allowed(self, decision: Decision, doing: Activity, turn: StageTurn) -> Decision:
        """Return a decision; `limit` in place of a grasp or a way to a goal while users' rules leave no plan so far."""
        # What is in hand is not brought on then.
        goes = doing.kind == "go" and decision.command is not None and self.errands.intention.knows_where_to_go
        if not (goes or isinstance(decision.command, Grasp | Push | Turn)):
            return decision
        blamed = self.errands.blamed_so_far(turn.situation)
        if not blamed:
            return decision
        if isinstance(decision.command, Push | Turn):
            return Decision(Release(), f"{turn.situation.model.held} is released, for {blamed}")
        return Decision(None, f"{turn.stage} cannot be attained as far as is known; {blamed}", TaskVerdict.LIMIT)

    def _ended(self, end: StageEnd, last: Decision, turn: StageTurn) -> Decision:
        """Return the decision with which a stage ends: done, or a verdict with its reason."""
        if end.verdict == TaskVerdict.DONE:
            return replace(last, why=f"{turn.stage} holds", verdict=TaskVerdict.DONE)
        why = last.why
        if end.forbidden:
            forbidden = self.errands.forbidden or f"all that may still be done{end.forbidden}"
            why = f"{turn.stage} cannot be attained: users' rules forbid {forbidden}"
        elif last.verdict is None:
            why = f"what the task asks for holds, but {self._doubt_of_done(turn.situation)}"
        if self.errands.blamed not in why and not self.errands.is_shut_out:
            why = f"{why}; {self.errands.blamed}"
        before = self.errands.intention.blamed_before
        if before and not self.errands.blamed and end.verdict == TaskVerdict.LIMIT:
            why = f"{why}; {_rules_at(before)} left no plan before"
        if closing := rules_that_close(turn.situation):
            why = f"{why}; doors are closed by {_rules_at(closing)}"
        return replace(last, why=why, verdict=end.verdict)

    def _doubt_of_done(self, situation: Situation) -> str:
        """Return why the constraints may not have been kept when all goals hold, in words; "" when they surely were."""
        if self.errands.blamed and self.errands.intention.plan is None:
            return self.errands.blamed
        for actor, door in situation.closed_doors_passed:
            return f"{'the robot' if actor == ROBOT else actor} went through {door.name}, which users' rules close"
        return self.keeper.doubt_of_done(situation)


def _under_way(decision: Decision, name: str, turn: StageTurn) -> RemainingPlan | None:
    """Return what is left of the plan with an object that a decision goes on with; None where it moves it by none."""
    moves = any(step.name in ("push", "press", "turn") and step.args[0] == name for step in decision.steps)
    return turn.executor.plan_of(name) if moves else None


def _carried_to(activity: Activity, decision: Decision, name: str, turn: StageTurn) -> str:
    """Return the place of the task plan to which an activity that pursues a goal carries an object; "" for none."""
    plan = _under_way(decision, name, turn) if activity.kind == "pursue" else None
    return "" if plan is None else place_name(activity.subject, plan.target)


def _unknown(turn: StageTurn) -> Iterator[str]:
    """Yield which goals are about an object that is missing or of which the outline is not known, as facts."""
    for name, goal in turn.goals.items():
        node = turn.situation.object_of(str(goal.args[0]))
        if node is None or node.polygon is None:
            yield f"{'missing' if node is None else 'unclear'}({name})"


def _rules_at(places: Sequence[str]) -> str:
    """Return users' rules in words, by their places."""
    return f"the rule{'s' * (len(places) > 1)} at {' and '.join(places)}"


def _put_down(situation: Situation) -> Decision:
    """Return the release of what a robot holds that is lost, or that does not know what it holds."""
    held = situation.model.held
    lost = f"{held} is released, because the robot does not know where it is: nothing looks as expected"
    unsure = "what may be in hand is released, for it was grasped before the map was begun"
    return Decision(Release(), unsure if held is None else lost)


def _done_by_rules(decision: Decision, situation: Situation) -> Decision:
    """Return a decision; `limit` in place of a command of which the steps may not be done."""
    if decision.command is None:
        return decision
    refused = refusal(steps_of(decision, situation.model), situation, decision.question, last=True)
    return Decision(None, f"{decision.why}; {refused}", TaskVerdict.LIMIT) if refused else decision


def _clash(goal: Fact, stage: Stage) -> Decision:
    """Return the verdict `limit` for a goal whose pursuit undoes another one, where no plan attains both."""
    why = f"no plan that attains {stage} was found, and the pursuit of {goal} undoes another goal"
    return Decision(None, why, TaskVerdict.LIMIT)


def _added(verdict: Decision, found: Decision) -> Decision:
    """Return what was found, with the reason of a verdict before its own."""
    return found if found.verdict is None else replace(found, why=f"{verdict.why}; {found.why}")
