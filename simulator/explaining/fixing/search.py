"""The search for the smallest changes with which a run works.

Single changes come first, a gap as wide as it is tried at all. What works is made as small as possible. Then
pairs are tried of changes that do not work alone. So no change that is reported contains another one that works. Widths
are tried from what geometry allows on, further and further up, and bisected between one that fails and one that works:
with one step less they are shown to fail. What is left of the budget is spent on the smaller steps that were skipped.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import combinations

from utak.simulator.explaining.fixing.candidates import (
    Candidates,
    GapRange,
    candidates_of,
    carried_things,
    is_out_of_commands,
)
from utak.simulator.explaining.fixing.changes import Dropped, MoreCommands, Wider, WorldChange
from utak.simulator.explaining.fixing.gaps import WIDTH_STEP, GapSide
from utak.simulator.explaining.fixing.proving import Budget, BudgetEndedError, Outcome, VariantProver
from utak.simulator.explaining.fixing.recorded import RecordedRun
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Result, RobotMaker

MORE_COMMANDS_FACTOR = 4  # so many times the allowed commands are tried when they did not suffice; a convention
MIN_MORE_COMMANDS = 200  # commands; at least so many are added then: the default of `utak run`
SECOND_PROBE_STEPS = round(
    1.0 / WIDTH_STEP
)  # steps above what geometry allows: one square, as coarse as the robot sees
WorldChanges = tuple[WorldChange, ...]


@dataclass(frozen=True)
class Fix:
    """WorldChanges with which the run works."""

    changes: WorldChanges  # the changes
    outcome: Outcome  # how the run ends with them
    # Whether it was shown to fail without any of the changes, and with any of the widths one step less
    is_smallest: bool
    is_least: bool  # whether it was shown to fail with any smaller number of steps of a width, not only with one less


@dataclass(frozen=True)
class FixReport:
    """Holds what was found."""

    run: RecordedRun  # the recorded run
    # How the run ends without changes, when it is repeated; None when the time did not suffice for that
    before: Result | None
    fixes: tuple[Fix, ...]  # the changes with which it works
    # All changes that were tried, with how they ended, in order; those that were found among them
    tried: tuple[tuple[WorldChanges, Outcome], ...]
    runs: int  # how many runs there were, and how many commands they took
    commands: int
    ended: str  # why the search ended early; "" when everything was tried

    @property
    def is_needless(self) -> bool:
        """Whether the run works without any change."""
        return any(not changes and outcome.works for changes, outcome in self.tried)


def find_fixes(
    run: RecordedRun,
    budget: Budget,
    watch: Callable[[int, WorldChanges, Outcome], None] = lambda number, changes, outcome: None,
    make: RobotMaker = make_robot,
) -> FixReport:
    """Return the smallest changes with which a run would have worked."""
    prover = VariantProver(run.scenario, run.settings, budget, watch, make)
    search, before, ended = FixSearch(prover), None, ""
    try:
        unchanged = prover.outcome(())
        before = unchanged.result
        if not unchanged.works and before is not None:
            steps = run.episode.steps
            carried = carried_things(run.scenario, {str(step["held"]) for step in steps})
            seen_from = [(float(step["utak"][0]), float(step["utak"][1])) for step in steps]
            search.more_commands(before)
            candidates = candidates_of(run.scenario, carried, seen_from)
            search.pairs(search.singles(candidates))
            search.improve()
    except BudgetEndedError as bound:
        ended = str(bound)
    fixes, tried = search.found(), tuple(prover.tried.items())
    return FixReport(run, before, fixes, tried, prover.runs, prover.commands, ended)


@dataclass
class FixSearch:
    """The state of one search."""

    prover: VariantProver  # runs the changed scenarios
    _fixes: list[WorldChanges] = field(default_factory=list)
    _ranges: dict[tuple[object, object], GapRange] = field(default_factory=dict)

    def more_commands(self, before: Result) -> None:
        """Find out how many commands suffice, when the run ended because no more were allowed."""
        allowed = self.prover.settings.max_steps
        if is_out_of_commands(before, allowed):
            longer = MoreCommands(max(MORE_COMMANDS_FACTOR * allowed, allowed + MIN_MORE_COMMANDS))
            outcome = self.prover.outcome((longer,))
            if outcome.works and outcome.result is not None:
                enough = (MoreCommands(outcome.result.steps),)
                self.prover.tried[enough] = outcome  # no run of its own is needed
                self._fixes.append(enough)

    def singles(self, candidates: Candidates) -> list[WorldChange]:
        """Try every change alone, keep those that work, and return those of the others of which pairs are tried."""
        left: list[WorldChange] = []
        plain: tuple[WorldChange, ...] = (*candidates.dropped, *candidates.away)
        for change in plain:
            if self._works((change,)):
                self._fixes.append((change,))
            elif self.prover.variant((change,)) is not None:
                left.append(change)
        gaps: list[WorldChange] = []
        for ranges in candidates.ranges:
            self._ranges |= {(one.gap, one.side): one for one in ranges}
            found = self._gap(ranges)
            if found is None:
                strongest = next((one for one in ranges if one.side == GapSide.BOTH), ranges[0])
                gaps.append(strongest.change(strongest.most))
            else:
                self._fixes.append(found)
        for place in candidates.led:
            if self._works((place,)):
                self._fixes.append((place,))
        return [*gaps, *sorted(left, key=lambda change: isinstance(change, Dropped))]

    def pairs(self, left: list[WorldChange]) -> None:
        """Try pairs of changes that do not work alone, and make those that work as small as possible."""
        for pair in combinations(left, 2):
            if self._works(pair):
                self._fixes.append(pair)
                self._fixes[-1] = self._shrunk(pair)

    def improve(self) -> None:
        """Try all smaller steps of each width that were skipped."""
        for index in range(len(self._fixes)):
            for place, change in enumerate(self._fixes[index]):
                if isinstance(change, Wider):
                    for steps in range(1, change.steps):
                        smaller = _with_steps(self._fixes[index], place, steps)
                        if self._works(smaller):
                            self._fixes[index] = smaller
                            break

    def found(self) -> tuple[Fix, ...]:
        """Return what was found so far, as far as it was shown; the same changes once."""
        fixes = []
        for changes in dict.fromkeys(self._fixes):
            outcome = self.prover.outcome(changes)
            parts = [changes[:k] + changes[k + 1 :] for k in range(len(changes))] if len(changes) > 1 else []
            below = [
                [_with_steps(changes, k, steps) for steps in range(1, change.steps)]
                for k, change in enumerate(changes)
                if isinstance(change, Wider)
            ]
            if any(self._is_known(part, True) for part in parts):
                continue
            smallest = all(self._is_known(one, False) for one in [*parts, *(steps[-1] for steps in below if steps)])
            least = smallest and all(self._is_known(one, False) for steps in below for one in steps)
            fixes.append(Fix(changes, outcome, smallest, least))
        return tuple(fixes)

    def _works(self, changes: WorldChanges) -> bool:
        return self.prover.outcome(changes).works

    def _is_known(self, changes: WorldChanges, works: bool) -> bool:
        outcome = self.prover.tried.get(changes)
        return outcome is not None and outcome.works == works

    def _gap(self, ranges: tuple[GapRange, ...]) -> WorldChanges | None:
        """Return a gap made wider by as few steps as work, on the side where the fewest suffice; None when none do."""
        best: WorldChanges | None = None
        for number, one in enumerate(one for one in ranges if one.alone):
            for steps in _probes(one, 0 if number else 1) if best is None else _below(one, best):
                probed = (one.change(steps),)
                if self._works(probed):
                    self._fixes.append(probed)  # found, should the budget end before it is made smaller
                    best = self._shrunk(probed)
                    self._fixes.pop()
                    break
        return best

    def _shrunk(self, changes: WorldChanges) -> WorldChanges:
        """Return working changes with each width as small as possible beside the others, and without needless parts."""
        first = True
        before: WorldChanges = ()
        while changes != before:
            before = changes
            for place, change in enumerate(changes):
                if isinstance(change, Wider) and (first or self._works(_with_steps(changes, place, change.steps - 1))):
                    changes = self._fewest(changes, place)
            first = False
        for place in range(len(changes) if len(changes) > 1 else 0):
            part = changes[:place] + changes[place + 1 :]
            if self._works(part):
                return self._shrunk(part)
        return changes

    def _fewest(self, changes: WorldChanges, place: int) -> WorldChanges:
        """Return working changes with one width as small as possible: with one step less they are shown to fail."""
        change = changes[place]
        assert isinstance(change, Wider)
        fails, works = 0, change.steps
        least = self._ranges[change.gap, change.side].least
        trials = [least + 2**k - 1 for k in range(change.steps.bit_length())] + [least - 1]
        while works - fails > 1:
            steps = next((one for one in trials if fails < one < works), (works + fails) // 2)
            if self._works(_with_steps(changes, place, steps)):
                works = steps
                self._fixes[-1] = _with_steps(changes, place, works)
            else:
                fails = steps
        return _with_steps(changes, place, works)


def _probes(one: GapRange, others: int) -> Iterator[int]:
    """Yield the numbers of steps with which a gap is tried first: the most, and `others` smaller ones."""
    yield one.most
    if others and one.least + SECOND_PROBE_STEPS < one.most:
        yield one.least + SECOND_PROBE_STEPS


def _below(one: GapRange, best: WorldChanges) -> Iterator[int]:
    """Yield the number of steps that would be better than a gap that works on another side, if it can be made."""
    (change,) = best
    if isinstance(change, Wider) and 1 <= change.steps - 1 <= one.most:
        yield change.steps - 1


def _with_steps(changes: WorldChanges, place: int, steps: int) -> WorldChanges:
    """Return changes with another number of steps of the width at an index; without that change for no steps."""
    change = changes[place]
    assert isinstance(change, Wider)
    new = (replace(change, steps=steps),) if steps else ()
    return changes[:place] + new + changes[place + 1 :]
