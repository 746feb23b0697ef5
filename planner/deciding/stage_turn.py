"""The basis of a decision: a stage of the task, what is believed, and the tools with which commands are worked out."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

from utak.geometry.kernels.arrays import XY
from utak.kb.body import Command, Move
from utak.kb.language.terms import Fact
from utak.kb.task.binding import Reconciliation
from utak.planner.advice import Act, Go, See
from utak.planner.carrying.plan_executor import Advice, PlanExecutor
from utak.planner.carrying.preconditions import Doubt, rules_that_leave_untold, sensed_first
from utak.planner.deciding.pursuit import Pursuer
from utak.planner.deciding.verification import Verifier
from utak.planner.decision import Decision, TaskVerdict, command_or_nothing, nothing_to_do
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.question import Question
from utak.planner.screen.moves import halt_exactly_at
from utak.planner.situation import Situation
from utak.planner.stages import Stage
from utak.planner.steps import forbidden_by
from utak.planner.subgoal_kind import SubgoalKind

ALL_OBJECTS, ROBOT_ITSELF, CONSTRAINTS = "all", "robot", "task"  # what planner/asp/deciding/activities.lp calls them


@dataclass(frozen=True)
class StageTurn:
    """All that one decision is worked out with. The decider lends its tools for the time of a decision."""

    stage: Stage  # of the task: the goals that shall hold now; none when all stages are attained
    situation: Situation  # what is believed: world model, rooms, doors, corners and track
    # What the parameters of the task mean, and which objects may match those that nothing matches yet
    reconciled: Reconciliation
    track: Sequence[XY]  # where the robot has been, (x, y) in squares, map frame
    executor: PlanExecutor  # follows manipulation plans, and remembers the one under way
    pursuer: Pursuer  # walks after subgoals, and remembers the present route
    verifier: Verifier  # makes sure of what is believed, and remembers what was looked at for that
    agreeing: bool = False  # whether it is only asked if the goals for objects can hold at once

    @cached_property
    def goals(self) -> Mapping[str, Fact]:
        """The goals for objects by name: g1, g2, ... in the order of the task."""
        return {f"g{number}": goal for number, goal in enumerate(self.stage.carried, 1)}

    def goals_of(self, subject: str) -> tuple[Fact, ...]:
        """Return the goals that the robot is stuck with."""
        if subject in self.goals:
            return (self.goals[subject],)
        return {ALL_OBJECTS: self.stage.carried, ROBOT_ITSELF: self.stage.own}.get(subject, ())

    def within(self, situation: Situation) -> "StageTurn":
        """Return the turn with something else believed."""
        return replace(self, situation=situation)

    def seek(
        self,
        subgoals: Sequence[Subgoal],
        missing: Callable[[], str] = str,
        proof: Sequence[str] = (),
        along: Callable[[Subgoal], Decision] | None = None,
    ) -> Decision:
        """Return the next command towards the best of some subgoals, or the verdict: see Pursuer.pursue."""
        return self.pursuer.pursue(subgoals, self.stage, self.situation, missing, proof, along)

    def closes_loop(self, command: Command) -> bool:
        """Return whether a command that is about to be given leads in a loop: see Pursuer.closes_loop."""
        return self.pursuer.closes_loop(self.situation.model, command)

    def look(self, looks: Sequence[Subgoal], along: Callable[[Subgoal], Decision] | None = None) -> Decision:
        """Return the next command towards the best look; nothing for no looks; `limit` when no way leads there."""
        if not looks:
            return nothing_to_do("nothing is left to look at")
        return self.seek(looks, lambda: looks[0].what, along=along)

    def look_if_reached(self, looks: Sequence[Subgoal]) -> Decision:
        """Return the next command towards the best look; nothing for no looks, or when no way leads there."""
        return command_or_nothing(self.look(looks))

    def make_sure(
        self, doubts: Iterable[Doubt], pushes: "Mapping[str, Callable[[Subgoal], Decision]] | None" = None
    ) -> Decision:
        """Return the next command to see or feel what must be told first; nothing for no need, or for no way there."""
        # pushes : by doubts, what shows it with a thing in hand
        left, last = list(doubts), [f"telling({self.verifier.telling})"] * bool(self.verifier.telling)
        situation = replace(self.situation, question=self.situation.question.adding(last))
        self.verifier.telling = ""
        while (sense := sensed_first(left, situation)) is not None:
            asked = self.within(replace(situation, question=sense.question))
            look = asked.look([Subgoal(SubgoalKind.INSPECT, *sense.doubt.look)], (pushes or {}).get(sense.doubt.name))
            if look.command is not None or sense.doubt.must:
                self.verifier.telling = sense.doubt.name
                return look
            left = [doubt for doubt in left if doubt.name != sense.doubt.name]
        if rules := rules_that_leave_untold(left, situation):
            why = f"{self.stage} cannot be said to hold: {forbidden_by(rules, 'to make sure of that')}"
            return Decision(None, why, TaskVerdict.LIMIT)
        return nothing_to_do("nothing must be told first")

    def react(self, facts: Iterable[str], reflexes: "Mapping[str, Callable[[StageTurn], Decision]]") -> Decision:
        """Return the reflex that planner/asp/deciding/hand.lp chooses of those for which geometry finds a motion."""
        return self.first_of("hand", "react", facts, reflexes) or nothing_to_do("no reflex is called for")

    def first_of(
        self, part: str, name: str, facts: Iterable[str], options: "Mapping[str, Callable[[StageTurn], Decision]]"
    ) -> Decision | None:
        """Return what comes of the option that a part of planner/asp/deciding chooses: see Question.first_of."""
        doing = {option: partial(self._so, do) for option, do in options.items()}
        return self.situation.question.adding(facts).first_of(part, name, doing)

    def _so(self, do: "Callable[[StageTurn], Decision]", question: Question) -> Decision:
        """Return what is decided where a question is as it is given."""
        decision = do(self.within(replace(self.situation, question=question)))
        return replace(decision, question=decision.question or question)

    def see(self, see: See, along: Callable[[Subgoal], Decision] | None = None) -> Decision:
        """Return the next command to see some squares; the steps of the plan come after those there. Or the verdict."""
        asked = self.within(replace(self.situation, question=see.question))
        decision = asked.seek([Subgoal(SubgoalKind.INSPECT, *see.viewpoint)], along=along)
        walks = decision.steps[-1:] and decision.steps[-1].name == "look"
        return replace(decision, steps=(*decision.steps, *see.steps)) if walks else decision

    def go(self, go: Go) -> Decision:
        """Return the next command to where an object is grasped, so that the last move halts there; or the verdict."""
        walk = self.seek([Subgoal(SubgoalKind.ATTAIN, go.square, go.why)], lambda: "no way leads there")
        if not isinstance(walk.command, Move):
            return walk
        return replace(walk, command=halt_exactly_at(walk.command, go.place, self.situation.model), steps=go.steps)

    def act(self, act: Act, why: str = "") -> Decision:
        """Return the command of an act, for a reason of its own or another one."""
        self.executor.depart(act)
        return Decision(act.command, f"{why or act.why}; {self.stage}", steps=act.steps, question=act.question)

    def act_anew(self, advice: Advice, why: str = "") -> Decision:
        """Return the same of an act; nothing where its command would close a loop, and for other advice."""
        if not isinstance(advice, Act):
            return nothing_to_do(f"nothing is under way; {self.stage}")
        if self.closes_loop(advice.command):
            return nothing_to_do(f"{advice.why}, as before in the same state; {self.stage}")
        return self.act(advice, why)

    def prepare(self, advice: Advice) -> Decision:
        """Return the next command to where an object is grasped or squares are seen; nothing for other advice."""
        if isinstance(advice, Go):
            return command_or_nothing(self.go(advice))
        if isinstance(advice, See):
            return command_or_nothing(self.see(advice))
        return nothing_to_do("no place to go to, and nothing to look at first, is known")
