"""One run of the robot, within limits of processor time and memory: python -m benchmarks.claims.child FOLDER ...

Writes FOLDER/episode.jsonl, FOLDER/cycles.txt (processor seconds of waking and of each command, a line each, as they
come: a run that is killed leaves them) and FOLDER/result.json.
"""

import argparse
import json
import resource
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from utak.simulator.run.session import RobotMaker

EPISODE_FILE, CYCLES_FILE, RESULT_FILE = "episode.jsonl", "cycles.txt", "result.json"


def main() -> None:
    """Limit this process, run, and write what came of it."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.claims.child")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--noise", type=float, default=0.0)
    parser.add_argument("--noise-seed", type=int, default=0)
    parser.add_argument("--max-steps", type=int, default=200)
    parser.add_argument("--seconds", type=int, default=0, help="of the processor; 0: no limit")
    parser.add_argument("--megabytes", type=int, default=0, help="of address space; 0: no limit")
    parser.add_argument("--no-pull", action="store_true", help="objects may only be pushed")
    given = parser.parse_args()
    if given.seconds:
        resource.setrlimit(resource.RLIMIT_CPU, (given.seconds, given.seconds + 5))
    if given.megabytes:
        resource.setrlimit(resource.RLIMIT_AS, (given.megabytes << 20,) * 2)
    from utak.simulator.run.robots import make_robot  # imported within the limits

    run(given.folder, given.noise, given.noise_seed, given.max_steps, make_robot, not given.no_pull)


def run(folder: Path, noise: float, noise_seed: int, max_steps: int, make: "RobotMaker", pull: bool = True) -> None:
    """Run a robot in the scenario of a folder and write the three files.

    make : makes the robot, as `utak.simulator.run.robots.make_robot` does.
    pull : whether a held object may be pulled.
    """
    from benchmarks.harness.stopwatch import TimedBody, TimedRobot
    from benchmarks.worlds.scenes import RULES_FILE
    from utak.kb.body import Body
    from utak.kb.task.task import Task
    from utak.simulator.episode.episode import EpisodeLog
    from utak.simulator.run.session import Session
    from utak.simulator.scenario.scenario import read_scenario
    from utak.simulator.scenario.settings import Settings

    robots: list[TimedRobot] = []

    def make_timed(body: Body, told: Task, settings: Settings) -> TimedRobot:
        timed = TimedBody(body)
        robots.append(TimedRobot(make(timed, told, settings), timed))
        return robots[0]

    rules = folder / RULES_FILE
    kb_files = (str(rules),) if rules.exists() else ()
    settings = Settings(seed=noise_seed, noise=noise, max_steps=max_steps, pull=pull, kb_files=kb_files)
    with EpisodeLog(folder / EPISODE_FILE) as log, (folder / CYCLES_FILE).open("w") as cycles:

        def noted(session: Session) -> None:
            cycles.write(f"{robots[0].cycles[-1].processor:.3f}\n")
            cycles.flush()

        result = Session(read_scenario(folder), settings, make_timed, log).run(noted)
    names = ("believed", "achieved", "verdict", "reason", "steps", "unmet")
    told = {name: getattr(result, name) for name in names}
    (folder / RESULT_FILE).write_text(json.dumps(told) + "\n")


if __name__ == "__main__":
    main()
