"""The speed of the Gymnasium environment and of the bare table: steps a second on one core, without rendering.

    python -m benchmarks.timing.environment [--steps N] [--runs N] [--before CHECKOUT]

Both play the same commands on examples: `random` draws from all five kinds, and `busy` grasps what is felt, pushes,
turns and releases it. Time is that of the processor, so that other work on the machine counts little; the best of some
runs counts. With --before, the bare table of another checkout of Utak plays them, too, in a process of its own, and
ratios to it are printed: those of one machine at one time.
"""

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from utak.kb.body import DIRECTIONS
from utak.simulator.scenario.scenario import read_any_world
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import VERGE_COLOUR

PLAYED_FOLDER = Path(__file__).resolve().parents[2] / "examples"
PLAYED_EXAMPLES = ("go_next_room", "push_l_next_room", "push_square_three_rooms", "go_northeast_askew")
COMMAND_NAMES = ("move", "push", "turn", "grasp", "release")
PLAY_LENGTH = 200  # commands of one play, as in the environment
STRIDE = 4.0  # squares
RawCommand = tuple[Any, ...]  # the name of a method of Tabletop, and its arguments


def random_commands(count: int, seed: int) -> list[RawCommand]:
    """Return commands of all kinds, drawn independently of what they lead to."""
    draw = np.random.default_rng(seed)
    found: list[RawCommand] = []
    for kind in draw.integers(len(COMMAND_NAMES), size=count).tolist():
        east, north, turn = draw.uniform(-1.0, 1.0, 3).tolist()
        values = [(STRIDE * east, STRIDE * north)] * 2 + [(180.0 * turn,), (DIRECTIONS[int(draw.integers(8))],), ()]
        found.append((COMMAND_NAMES[kind], *values[kind]))
    return found


def busy_commands(example: str, count: int, seed: int) -> list[RawCommand]:
    """Return commands that carry things about: what is felt is grasped, pushed and turned for a while, and released."""
    draw = np.random.default_rng(seed)
    found: list[RawCommand] = []
    table = Tabletop(read_any_world(PLAYED_FOLDER / example))
    while len(found) < count:
        if len(found) % PLAY_LENGTH == 0:
            table = Tabletop(table.world)
        command = _busy_command(table, draw)
        getattr(table, command[0])(*command[1:])
        found.append(command)
    return found


def _busy_command(table: Tabletop, draw: np.random.Generator) -> RawCommand:
    """Return the next command of somebody who carries things about."""
    east, north = (STRIDE * draw.uniform(-1.0, 1.0, 2)).tolist()
    if table.held is not None:
        choice = draw.random()
        return ("push", east, north) if choice < 0.6 else ("turn", 40 * east) if choice < 0.95 else ("release",)
    felt = [
        side for side, colour in zip(DIRECTIONS, table.look()[1], strict=True) if colour not in (None, VERGE_COLOUR)
    ]
    if felt and draw.random() < 0.8:
        return "grasp", felt[0]
    things = sorted(table.polygons)
    if not things or draw.random() < 0.3:
        return "move", east, north
    centre = table.polygons[things[int(draw.integers(len(things)))]].centroid
    turn = np.radians(-table.world.heading)
    dx, dy = centre.x - table.utak[0], centre.y - table.utak[1]
    return "move", float(dx * np.cos(turn) - dy * np.sin(turn)), float(dx * np.sin(turn) + dy * np.cos(turn))


def play_table(example: str, commands: Sequence[RawCommand]) -> None:
    """Carry out commands on the bare table, with an impression after each; a new table every PLAY_LENGTH commands."""
    table = Tabletop(read_any_world(PLAYED_FOLDER / example))
    world = table.world
    for number, (name, *values) in enumerate(commands):
        if number % PLAY_LENGTH == 0:
            table = Tabletop(world)
        getattr(table, name)(*values)
        table.look()


def environment_player(example: str, commands: Sequence[RawCommand]) -> Callable[[], None]:
    """Return what plays commands in the environment, as `play_table` does on the bare table."""
    import gymnasium

    import utak.gym  # noqa: F401 (it registers the environment)

    env = gymnasium.make("utak/Tabletop-v0", scenario=PLAYED_FOLDER / example, stride=STRIDE * 4, max_steps=PLAY_LENGTH)
    actions = [_action(command) for command in commands]

    def play() -> None:
        for number, action in enumerate(actions):
            if number % PLAY_LENGTH == 0:
                env.reset(seed=0)
            env.step(action)  # also after the end of the task, so that the table plays the very same commands

    return play


def _action(command: RawCommand) -> dict[str, Any]:
    """Return a command as an action of the environment."""
    name, *values = command
    ways = {"move": values, "push": values}.get(name, (0.0, 0.0))
    return {
        "do": COMMAND_NAMES.index(name),
        "way": np.array(ways, np.float32) / np.float32(STRIDE * 4),
        "turn": np.array([values[0] / 180.0 if name == "turn" else 0.0], np.float32),
        "direction": DIRECTIONS.index(values[0]) if name == "grasp" else 0,
    }


def vector_rate(example: str, steps: int, runs: int) -> float:
    """Return the steps a second of 16 tables that are stepped together with random actions."""
    import gymnasium

    import utak.gym  # noqa: F401 (it registers the environment)

    envs = gymnasium.make_vec("utak/Tabletop-v0", num_envs=16, scenario=PLAYED_FOLDER / example)
    envs.action_space.seed(1)
    actions = [envs.action_space.sample() for _ in range(max(steps // 16, 1))]
    envs.reset(seed=0)
    return best_rate(lambda: [envs.step(action) for action in actions], 16 * len(actions), runs)


def best_rate(play: Callable[[], object], count: int, runs: int) -> float:
    """Return steps a second, the best of some runs after one that is not counted."""
    best = 0.0
    play()
    for _ in range(runs):
        begin = time.process_time()
        play()
        best = max(best, count / (time.process_time() - begin))
    return best


def table_rates(steps: int, runs: int) -> dict[str, float]:
    """Return the commands a second of the bare table, by example and kind of commands."""
    found = {}
    for example in PLAYED_EXAMPLES:
        for kind, commands in kinds_of_commands(example, steps).items():
            found[f"{example} {kind}"] = best_rate(partial(play_table, example, commands), steps, runs)
    return found


def kinds_of_commands(example: str, steps: int) -> dict[str, list[RawCommand]]:
    """Return the commands that are played on an example, by kind."""
    return {"random": random_commands(steps, 1), "busy": busy_commands(example, steps, 1)}


def rates_of(checkout: Path, steps: int, runs: int) -> dict[str, float]:
    """Return `table_rates` of another checkout, measured by this program in a process of its own."""
    program = (
        "import json, sys; sys.path.insert(0, sys.argv[1])\nfrom runpy import run_path\n"
        "print(json.dumps(run_path(sys.argv[2])['table_rates'](int(sys.argv[3]), int(sys.argv[4]))))\n"
    )
    arguments = [str(checkout.resolve()), str(Path(__file__).resolve()), str(steps), str(runs)]
    command = [sys.executable, "-I", "-c", program, *arguments]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    rates: dict[str, float] = json.loads(done.stdout)
    return rates


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print one line an example and kind of commands; return 0."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.timing.environment", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("--steps", type=int, default=4000, help="commands a run (default %(default)s)")
    parser.add_argument("--runs", type=int, default=3, help="runs, of which the best counts (default %(default)s)")
    parser.add_argument("--before", type=Path, help="another checkout, whose bare table is measured, too")
    given = parser.parse_args(arguments)
    before = rates_of(given.before, given.steps, given.runs) if given.before else {}
    tables = table_rates(given.steps, given.runs)
    for name, rate in tables.items():
        example, kind = name.split(" ")
        play = environment_player(example, kinds_of_commands(example, given.steps)[kind])
        steps = best_rate(play, given.steps, given.runs)
        line = f"{example:24} {kind:7} environment {steps:7.0f}/s  bare table {rate:7.0f}/s"
        if before:
            line += f"  before {before[name]:6.0f}/s: {steps / before[name]:4.1f} and {rate / before[name]:4.1f} times"
        print(line, flush=True)
    together = vector_rate(PLAYED_EXAMPLES[0], given.steps, given.runs)
    print(f"{PLAYED_EXAMPLES[0]:24} random  16 tables stepped together {together:7.0f}/s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
