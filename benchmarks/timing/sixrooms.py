"""From the task to the first command in worlds of six rooms, all cold: each world in a process of its own.

    python -m benchmarks.timing.sixrooms [--count N] [--seed N] [--only KIND:SEED] [--loops]

Six rooms in two rows, each joined to the next by a door (with --loops some to others too). An object must be carried:
to a corner or a pose at least three doors away (corner, pose); or, at least two doors from the robot, into the next
room or through a door (square, brick, l_shape). The robot knows all six rooms from the start
(benchmarks.harness.knowing). Kernels were compiled earlier; the process is new, and nothing has been planned in it.

By the clock on the wall: `start` from the parent's call until Python runs benchmarks.timing.sixrooms_child, `import`
of the robot and of numba, `read` of start.lp and goal.lp, `model` from the first impression to the world model,
`decide` from there to the first command. `thinking` is the sum of the last three, `all` of everything. By the
processor's clock, which other work on the machine does not affect: `thought` is the thinking and `cpu` everything.
Not timed are the writing of the truth into the map, and what the body does. `rounds` are the
questions about carrying that geometry was asked.
"""

import argparse
import json
import pickle
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from utak.launcher import isolated_command

TIMED_KINDS = ("corner", "square", "brick", "l_shape", "pose")
STAGES = ("start", "import", "read", "model", "decide", "thinking", "all", "cpu", "thought")
BAR, MAX_QUERY_ROUNDS = 0.8, 5  # seconds; rounds


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line for each world, and the greatest value of each column."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=4, help="worlds of each kind (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first world's seed (%(default)s)")
    parser.add_argument("--only", metavar="KIND:SEED", help="one world")
    parser.add_argument("--loops", action="store_true", help="rooms may have more doors than they need")
    given = parser.parse_args(arguments)
    worlds = [(kind, seed) for kind in TIMED_KINDS for seed in range(given.seed, given.seed + given.count)]
    if given.only:
        kind, seed = given.only.split(":")
        worlds = [(kind, int(seed))]
    print(f"{'world':>12}" + "".join(f"{stage:>9}" for stage in STAGES) + "  rounds  first command")
    rows = []
    with tempfile.TemporaryDirectory(prefix="utak-sixrooms-") as folder:
        _timed(*worlds[0], given.loops, Path(folder))  # so that all kernels are compiled
        for kind, seed in worlds:
            row = _timed(kind, seed, given.loops, Path(folder))
            told = "".join(f"{row[stage]:9.3f}" for stage in STAGES)
            print(f"{kind + ':' + str(seed):>12}{told}{row['rounds']:8}  {row['command']}", flush=True)
            rows.append(row)
    for title, of in (("median", statistics.median), ("most", max)):
        print(f"{title:>12}" + "".join(f"{of(row[stage] for row in rows):9.3f}" for stage in STAGES))
    good = all(
        row["thinking"] <= BAR and row["rounds"] <= MAX_QUERY_ROUNDS and row["command"] != "None" for row in rows
    )
    return 0 if good else 1


def _timed(kind: str, seed: int, loops: bool, folder: Path) -> dict[str, Any]:
    """Time the way to the first command of a world, in a process of its own."""
    from benchmarks.worlds.scenes import write
    from benchmarks.worlds.six_rooms import six_room_world

    world = six_room_world(kind, seed, loops)
    place = write(world, folder / f"{kind}-{seed}")
    (place / "truth.pickle").write_bytes(pickle.dumps(world))
    command = isolated_command("benchmarks.timing.sixrooms_child", str(place), repr(time.perf_counter()))
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    row: dict[str, Any] = json.loads(done.stdout)
    row["thinking"] = row["read"] + row["model"] + row["decide"]
    row["all"] = row["start"] + row["import"] + row["thinking"]
    return row


if __name__ == "__main__":
    sys.exit(main())
