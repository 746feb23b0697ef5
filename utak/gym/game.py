"""A table that is played on: commands, rewards, and the end of a play. Knows nothing of Gymnasium's classes."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from utak.gym.progress import ExpectationProgress, time_limit
from utak.kb.body import Command
from utak.scenario import Scenario
from utak.simulator.run.embodiment import carry_out
from utak.simulator.scenario.scenario import Scenario as ScenarioContent
from utak.simulator.world.physics import Tabletop

REWARDS = ("progress", "sparse", None)
Scenarios = Scenario | Path | str | Sequence[Scenario | Path | str]


class Rules(NamedTuple):
    """The rules of a game."""

    reward: str | None = "progress"  # "progress", "sparse" or None
    max_steps: int = 200  # the number of commands after which a play is cut off
    noise: float = 0.0  # how much motions are disturbed, 0 to 1


class PlayOutcome(NamedTuple):
    """The outcome of a command."""

    reward: float  # as the rules say
    terminated: bool  # whether all that is expected holds
    truncated: bool  # whether the commands are used up


class Game:
    """A table that is played on, one play after the other."""

    def __init__(self, scenario: ScenarioContent, rules: Rules) -> None:
        self._expectations = scenario.expectations or ()
        self._world, self._reward = scenario.world, rules.reward
        if rules.reward not in REWARDS:
            raise ValueError(f"no such reward: {rules.reward!r}; one of 'progress', 'sparse' and None is meant")
        if rules.max_steps < 1:
            raise ValueError(f"max_steps must be 1 or greater, not {rules.max_steps}")
        if rules.reward is not None and not self._expectations:
            raise ValueError("the scenario has no expect.lp, which says what is rewarded; or give reward=None")
        if rules.reward is not None and any(fact.name == "fails" for fact in self._expectations):
            raise ValueError("the scenario expects failure, which no command achieves; give reward=None to play on it")
        limit = time_limit(self._expectations) if rules.reward is not None else None
        self._most = rules.max_steps if limit is None else min(rules.max_steps, max(limit, 1))
        self.table = Tabletop(scenario.world, rules.noise)
        self.begin(0)

    def begin(self, seed: int) -> None:
        """Put everything back to the start, and begin randomness anew with a seed."""
        self.table.restart(seed)
        self.steps = 0
        self.progress = ExpectationProgress(self._expectations if self._reward is not None else (), self._world)
        self._see()

    def play(self, command: Command) -> PlayOutcome:
        """Execute a command and return what comes of it."""
        before = self.progress.share
        carry_out(self.table, command)
        self.steps += 1
        if self._reward is None:
            return PlayOutcome(0.0, False, self.steps >= self._most)
        self._see()
        achieved = self.progress.achieved
        reward = self.progress.share - before if self._reward == "progress" else float(achieved)
        return PlayOutcome(reward, achieved, not achieved and self.steps >= self._most)

    def _see(self) -> None:
        self.progress.see(self.steps, self.table.utak, self.table.polygons)


def games(scenarios: Scenarios, rules: Rules) -> list[Game]:
    """Return a game for each scenario, read from its folder where a path is given."""
    several = [scenarios] if isinstance(scenarios, Scenario | Path | str) else list(scenarios)
    if not several:
        raise ValueError("at least one scenario is needed")
    contents = [one if isinstance(one, Scenario) else Scenario.read(one) for one in several]
    return [Game(one.content, rules) for one in contents]
