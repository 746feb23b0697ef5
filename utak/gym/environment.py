"""TABLETOP as a Gymnasium environment."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from utak.geometry.counts.retina import FIELD_COUNT
from utak.gym.actions import action_form
from utak.gym.game import Rules, Scenarios, games
from utak.gym.pixels import image
from utak.simulator.scenario.picture import draw
from utak.simulator.world.senses import SENSED_NUMBERS

MAX_SEEN_LEVEL, MAX_FELT_COLOUR = 7, 26  # the greatest gray level, and the number of the last letter
DRAWN_SEEDS = 2**31  # seeds that are drawn lie below; a convention

Observation = dict[str, Any]  # retina and touch, uint8 arrays


class TabletopEnv(gymnasium.Env[Observation, Any]):
    """Utak's body on a table, for another mind.

    An observation is one impression: `retina`, (160,) uint8, gray levels from 0 for free to 7 for occupied fields, and
    `touch`, (8,) uint8, the colours of the adjacent squares clockwise from north as the places of their letters in the
    alphabet (a is 1), 0 for floor. Nothing says whether a command succeeded: that must be seen.

    An action is one command. Its form is chosen by `actions`:

    - "dict": `do` (0 move, 1 push, 2 turn, 3 grasp, 4 release), `way` (east and north as parts of `stride`, -1 to 1),
      `turn` (a part of 180 degrees, -1 to 1), and `direction` (0 north, clockwise to 7 northwest). Of these only what
      the command needs is used.
    - "box": 8 numbers from -1 to 1: preferences for the five commands, of which the greatest wins, then the way and the
      turn as before. A grasp is towards the compass point nearest to (east,
      north).
    - "discrete": 0-7 a move by one square (clockwise from north), 8-15 a push by one square, 16-19 turns by 90, -90, 15
      and -15 degrees, 20-27 grasps (clockwise from north), 28 release.

    The reward comes from expect.lp. "progress": the gain in the part of its points that is earned, so that rewards add
    up to what is gained from the first halt to the last. "sparse": 1 when all is achieved. A play terminates when
    everything that expect.lp says of the table holds at a halt; what it says of verdicts is ignored. It is truncated
    after `max_steps` commands, or as many as `within(N)` allows.

    `info` holds `achieved` and `share`, the part of the points that is earned now. `unwrapped.table` is the true table,
    which a mind must not look at.
    """

    metadata: dict[str, Any] = {"render_modes": ["ansi", "rgb_array"], "render_fps": 4}  # noqa: RUF012 (as Gymnasium declares it)

    def __init__(
        self,
        scenario: Scenarios,
        *,
        actions: str = "dict",
        stride: float = 4.0,
        reward: str | None = "progress",
        max_steps: int = 200,
        noise: float = 0.0,
        render_mode: str | None = None,
    ) -> None:
        """Make the environment of a scenario.

        Parameters
        ----------
        scenario : utak.Scenario, path, or a sequence of these
            The table and what is expected. Of several, one is drawn at each reset, or named by
            `reset(options={"scenario": number})`.
        actions : str
            The form of actions: "dict", "box" or "discrete".
        stride : float
            The greatest way east and north in one action, squares.
        reward : str or None
            "progress", "sparse" or None; with None the reward is 0, and only `max_steps` ends a play.
        max_steps : int
            The number of commands after which a play is truncated.
        noise : float
            How much motions are disturbed, 0 to 1.
        render_mode : str, optional
            "ansi" for the table as text, "rgb_array" for an image.

        Raises
        ------
        ValueError
            An option is out of its range, or expect.lp says nothing that can be rewarded.
        CannotOpenError, BadInputError
            A scenario cannot be read.
        """
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"no such render mode: {render_mode!r}; one of 'ansi' and 'rgb_array' is meant")
        self.render_mode = render_mode
        self._games = games(scenario, Rules(reward, max_steps, noise))
        self._game = self._games[0]
        self._form = action_form(actions, stride)
        self.action_space = self._form.space
        self.observation_space: spaces.Space[Observation] = spaces.Dict(
            {
                "retina": spaces.Box(0, MAX_SEEN_LEVEL, (FIELD_COUNT,), np.uint8),
                "touch": spaces.Box(0, MAX_FELT_COLOUR, (SENSED_NUMBERS - FIELD_COUNT,), np.uint8),
            }
        )

    @property
    def table(self) -> Any:
        """The true table: `utak`, `held`, `polygons`, `motion`."""
        return self._game.table

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin a new play and return the first impression.

        Parameters
        ----------
        seed : int, optional
            The seed of all randomness: with it, the same actions lead to the same plays. It is also that of the table's
            noise, as `utak run --seed`. None to go on with the random numbers of before.
        options : dict, optional
            `scenario`: the number of the scenario to play on.
        """
        super().reset(seed=seed)
        self._game = self._games[self._number((options or {}).get("scenario"))]
        self._game.begin(int(self.np_random.integers(DRAWN_SEEDS)) if seed is None else seed)
        return self._observation(), self._info()

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Execute one command; return the impression after it, the reward, whether the play ended, and `info`."""
        reward, terminated, truncated = self._game.play(self._form.command(action))
        return self._observation(), reward, terminated, truncated, self._info()

    def render(self) -> Any:
        """Return the true table, as text or as an image (rows, columns, 3); None without a render mode."""
        if self.render_mode is None:
            return None
        return draw(self.table.now) if self.render_mode == "ansi" else image(self.table)

    def _observation(self) -> Observation:
        sensed = self._game.table.sense()
        return {"retina": sensed[:FIELD_COUNT], "touch": sensed[FIELD_COUNT:]}

    def _number(self, named: Any) -> int:
        """Return the number of the game that the options of a reset name, or else one that is drawn."""
        if named is None:
            return int(self.np_random.integers(len(self._games))) if len(self._games) > 1 else 0
        if not isinstance(named, int | np.integer) or not 0 <= named < len(self._games):
            raise ValueError(f"there is no scenario {named!r:.200}: there are {len(self._games)}, numbered from 0")
        return int(named)

    def _info(self) -> dict[str, Any]:
        return {"achieved": self._game.progress.achieved, "share": self._game.progress.share}
