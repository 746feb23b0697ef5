"""Many environments that are stepped together in one process, without the costs of one environment object each."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from utak.gym.actions import action_form
from utak.gym.environment import (
    MAX_SEED,
    check_render_mode,
    next_game,
    observation_space,
    rendered,
    split,
)
from utak.gym.game import Rules, Scenarios, games
from utak.simulator.world.senses import SENSED_NUMBERS


class TabletopVectorEnv(VectorEnv[Any, Any, Any]):
    """Several tables that are stepped together; each is as `TabletopEnv` with the same options.

    A play that has ended begins anew at the next step (`AutoresetMode.NEXT_STEP`), with reward 0. `infos` holds
    `achieved` and `share`, one value a table.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 (declared so by Gymnasium)
        "render_modes": ["ansi", "rgb_array"],
        "render_fps": 4,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        scenario: Scenarios,
        num_envs: int = 1,
        *,
        actions: str = "dict",
        stride: float = 4.0,
        reward: str | None = "progress",
        max_steps: int = 200,
        noise: float = 0.0,
        render_mode: str | None = None,
    ) -> None:
        """Make the tables; the parameters besides `num_envs` are those of `TabletopEnv`."""
        check_render_mode(render_mode, self.metadata)
        if num_envs < 1:
            raise ValueError(f"num_envs must be 1 or greater, not {num_envs}")
        self.num_envs, self.render_mode = num_envs, render_mode
        rules = Rules(reward, max_steps, noise)
        self._games = [games(scenario, rules) for _ in range(num_envs)]
        self._playing = [several[0] for several in self._games]
        self._form = action_form(actions, stride)
        self.single_action_space = self._form.space
        self.single_observation_space = observation_space()
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._random = [np.random.default_rng() for _ in range(num_envs)]
        self._ended = np.zeros(num_envs, bool)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin a new play on every table and return the first impressions.

        Parameters
        ----------
        seed : int, sequence of int or None, optional
            The seed of each table; from one number on, those that follow it. None to go on with the random numbers of
            before.
        options : dict, optional
            As for `TabletopEnv.reset`, for all tables.
        """
        seeds = [seed] * self.num_envs if seed is None else seed
        seeds = [seeds + number for number in range(self.num_envs)] if isinstance(seeds, int) else list(seeds)
        if len(seeds) != self.num_envs:
            raise ValueError(f"{len(seeds)} seeds are given for {self.num_envs} tables")
        for number, one in enumerate(seeds):
            self._begin(number, one, options)
        self._ended[:] = False
        return self._observations(), self._infos()

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Execute one command on every table; return impressions, rewards, both kinds of ends, and `infos`."""
        rewards = np.zeros(self.num_envs)
        terminations, truncations = np.zeros(self.num_envs, bool), np.zeros(self.num_envs, bool)
        commands = self._form.commands(actions)
        if len(commands) != self.num_envs:
            raise ValueError(f"{len(commands)} actions are given for {self.num_envs} tables")
        for number, command in enumerate(commands):
            if self._ended[number]:
                self._begin(number, None, None)
            else:
                rewards[number], terminations[number], truncations[number] = self._playing[number].play(command)
        self._ended = terminations | truncations
        return self._observations(), rewards, terminations, truncations, self._infos()

    def render(self) -> tuple[Any, ...] | None:
        """Return the true tables, each as text or as an image (rows, columns, 3); None without a render mode."""
        if self.render_mode is None:
            return None
        return tuple(rendered(game, self.render_mode) for game in self._playing)

    def _begin(self, number: int, seed: int | None, options: dict[str, Any] | None) -> None:
        """Begin a new play on one table."""
        if seed is not None:
            self._random[number] = np.random.default_rng(seed)
        random = self._random[number]
        self._playing[number] = next_game(self._games[number], random, options)
        self._playing[number].begin(int(random.integers(MAX_SEED)) if seed is None else seed)

    def _observations(self) -> Any:
        """Return the present impressions."""
        sensed = np.empty((self.num_envs, SENSED_NUMBERS), np.uint8)
        for row, game in zip(sensed, self._playing, strict=True):
            game.table.sense(row)
        return split(sensed)

    def _infos(self) -> dict[str, Any]:
        """Return what is achieved on each table."""
        achieved = np.array([game.progress.achieved for game in self._playing], bool)
        share = np.array([game.progress.share for game in self._playing])
        every = np.ones(self.num_envs, bool)
        return {"achieved": achieved, "_achieved": every, "share": share, "_share": every.copy()}
