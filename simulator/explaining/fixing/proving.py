"""Runs of changed scenarios, each at most once, within a budget."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.explaining.fixing.bounds import refutation
from utak.simulator.explaining.fixing.changes import Variant, WorldChange, variant_of
from utak.simulator.explaining.fixing.leading import lead
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Result, RobotMaker, Session
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings

DEFAULT_RUNS = 40  # runs; a convention: some minutes
PROOFS_PER_RUN = 5  # proofs of geometry that are allowed for each allowed run, which takes longer; a convention


class BudgetEndedError(Exception):
    """No further run is allowed; the message says which bound was reached."""


@dataclass(frozen=True)
class Budget:
    """Bounds how much may be run."""

    # How many runs at most, the unchanged one among them. The same number gives the same answer.
    runs: int = DEFAULT_RUNS
    # After how many seconds it ends at the latest; None for never. The answer then depends on the machine.
    seconds: float | None = None


@dataclass(frozen=True)
class Outcome:
    """Holds how a changed scenario ended."""

    works: bool  # whether the robot ended in `done`, and the expectations that can be asked hold
    result: Result | None  # the end of the run; None when the change cannot be made, or the robot could not be led
    refuted: str = ""  # the expectation that geometry refutes, so that nothing was run; "" otherwise
    led_commands: int = 0  # how many commands were given to lead it


IMPOSSIBLE_CHANGE = Outcome(False, None)


@dataclass
class VariantProver:
    """Runs a scenario with changes and remembers how it ended."""

    scenario: Scenario  # the scenario and the options without changes
    settings: Settings
    budget: Budget  # how much may be run
    # Called after every run with its number, its changes and its outcome
    watch: Callable[[int, tuple[WorldChange, ...], Outcome], None] = lambda number, changes, outcome: None
    make: RobotMaker = make_robot  # makes the robot
    runs: int = 0  # how many runs there were
    commands: int = 0  # how many commands they took together
    # All changes that were tried, with how they ended, in their order
    tried: dict[tuple[WorldChange, ...], Outcome] = field(default_factory=dict)
    _proofs: int = 0
    _begun: float = field(default_factory=time.monotonic)

    def variant(self, changes: tuple[WorldChange, ...]) -> Variant | None:
        """Return the scenario with some changes; None when they cannot be made."""
        return variant_of(self.scenario, self.settings, changes)

    def outcome(self, changes: tuple[WorldChange, ...]) -> Outcome:
        """Return how the scenario with some changes ends; it is run unless that is known."""
        # Raises BudgetEndedError when no run is left.
        if changes not in self.tried:
            variant = self.variant(changes)
            refuted = "" if variant is None or not changes else refutation(variant.scenario)
            if variant is None:
                self.tried[changes] = IMPOSSIBLE_CHANGE
            elif refuted:
                self._check_time()
                self._proofs += 1
                if self._proofs > PROOFS_PER_RUN * self.budget.runs:
                    ended = f"the budget of {self.budget.runs} runs ended with {self._proofs - 1} proofs"
                    raise BudgetEndedError(ended)
                self.tried[changes] = Outcome(False, None, refuted)
            else:
                self.tried[changes] = self._run(changes, variant)
        return self.tried[changes]

    def _run(self, changes: tuple[WorldChange, ...], variant: Variant) -> Outcome:
        if self.runs >= self.budget.runs:
            raise BudgetEndedError(f"the budget of {self.budget.runs} runs ended")
        self._check_time()
        self.runs += 1
        session = Session(variant.scenario, variant.settings, self.make, EpisodeLog(None))
        session.wake()
        arrived = not variant.led or lead(session, variant.led[0], self._check_time)
        led = session.line["step"]
        while arrived and not session.finished:
            session.step()
            self._check_time()
        self.commands += session.line["step"]
        result = session.end() if arrived else None
        works = result is not None and result.verdict == "done" and result.believed and result.achieved is not False
        outcome = Outcome(works, result, "", led)
        self.watch(self.runs, changes, outcome)
        return outcome

    def _check_time(self) -> None:
        """Raise BudgetEndedError when the time is up."""
        if self.budget.seconds is not None and time.monotonic() - self._begun > self.budget.seconds:
            raise BudgetEndedError(f"the budget of {self.budget.seconds:g} seconds ended")
