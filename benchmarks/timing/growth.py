"""The time of one action cycle, by the area that the robot has seen.

    python -m benchmarks.timing.growth [--sides 64,128,256,512] [--steps 60]

The robot crosses square tables of growing side, with blocks strewn over them, towards the northeast corner. One line a
table: the squares seen, and the processor's milliseconds of a cycle, for the last third of its cycles and for each
1,000 squares seen.
"""

import argparse
import statistics
import sys
import time
from collections.abc import Sequence

from shapely import Polygon, box

from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import Source
from utak.kb.task.task import task_of
from utak.planner.cycle import Options, Robot
from utak.simulator.run.embodiment import Embodiment
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import Thing, World


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.timing.growth", description="Time of a cycle by area seen."
    )
    parser.add_argument("--sides", default="64,128,256,512", help="sides of the tables, in squares")
    parser.add_argument("--steps", type=int, default=60, help="commands at most (default %(default)s)")
    given = parser.parse_args(arguments)
    print(f"{'side':>5} {'cycles':>6} {'squares seen':>12} {'ms a cycle':>10} {'ms per 1,000 squares':>20}")
    for side in [int(part) for part in given.sides.split(",")]:
        robot, times = crossing(side, given.steps)
        seen = int(robot.model.view.seen.sum())
        late = statistics.median(times[-max(1, len(times) // 3) :])
        print(f"{side:>5} {len(times):>6} {seen:>12} {late:>10.1f} {1000 * late / seen:>20.2f}", flush=True)
    return 0


def crossing(side: int, steps: int) -> tuple[Robot, list[float]]:
    """Let the robot cross a table; return it and the processor's milliseconds of each cycle without its body's."""
    body = Embodiment(Tabletop(strewn(side), 0.0, 0))
    facts = "at(utak, corner(northeast))."
    start, goal = Source("start.lp", ""), Source("goal.lp", facts)
    robot = Robot(body, task_of(start, parse_facts(start), goal, parse_facts(goal)), Options(max_steps=steps))
    robot.wake()
    times = []
    while not robot.finished:
        before = time.process_time()
        robot.step()
        times.append(1000 * (time.process_time() - before))
    return robot, times


def strewn(side: int) -> World:
    """Return a square table with a block of 3 x 3 in the middle of every 16 x 16 squares."""
    floor = box(2, 2, side - 2, side - 2)
    verge = Polygon([(0, 0), (side, 0), (side, side), (0, side)], [list(floor.exterior.coords)[:-1]])
    blocks = [
        Thing(f"t{i:04}", "g", box(x, y, x + 3, y + 3))
        for i, (x, y) in enumerate((x, y) for x in range(12, side - 8, 16) for y in range(12, side - 8, 16))
    ]
    return World(side, side, verge, tuple(blocks), (), (5.5, 5.5), 0)


if __name__ == "__main__":
    sys.exit(main())
