"""One cold run of benchmarks.timing.sixrooms: python -m benchmarks.timing.sixrooms_child FOLDER BEGAN.

It prints its times as JSON.
"""

import time

AWAKE = time.perf_counter()

import json  # noqa: E402
import pickle  # noqa: E402
import sys  # noqa: E402
from pathlib import Path  # noqa: E402


def main(folder: Path, began: float) -> None:
    """Time the way to the first command in the world of a folder. began : the parent's clock at its call."""
    import numba  # noqa: F401

    from benchmarks.harness.knowing import Informed
    from utak.kb.task.task import read_task
    from utak.planner.carrying import manipulation_oracle
    from utak.planner.cycle import Robot
    from utak.simulator.run.embodiment import Embodiment
    from utak.simulator.scenario.scenario import read_any_world
    from utak.simulator.world.physics import Tabletop

    imported, spent = time.perf_counter(), time.process_time()
    truth = pickle.loads((folder / "truth.pickle").read_bytes())
    body = Embodiment(Tabletop(read_any_world(folder), 0.0, 0))
    knowledge = Informed(truth)
    knowledge.learn()
    impression = body.wake()
    choices = _counted(manipulation_oracle)

    spent -= (thought := time.process_time())
    begun = time.perf_counter()
    task = read_task(folder / "start.lp", folder / "goal.lp")
    read = time.perf_counter()
    robot = Robot(body, task)
    model, _ = super(Informed, knowledge).wake(impression)
    modelled = time.perf_counter()
    decision = robot.decider.decide(model, knowledge.memory.track)
    decided = time.perf_counter()
    times = {
        "start": AWAKE - began,
        "import": imported - AWAKE,
        "read": read - begun,
        "model": modelled - read,
        "decide": decided - modelled,
        "cpu": spent + time.process_time(),
        "thought": time.process_time() - thought,
        "rounds": len(choices),
        "command": f"{decision.command}; {decision.why}",
    }
    print(json.dumps(times))


def _counted(manipulation_oracle: object) -> list[object]:
    """Return a list that grows with each manipulation query that geometry is asked."""
    asked: list[object] = []
    plan = manipulation_oracle.plan_carrying  # type: ignore[attr-defined]

    def counting(*args: object, **kwargs: object) -> object:
        asked.append(args)
        return plan(*args, **kwargs)

    manipulation_oracle.plan_carrying = counting  # type: ignore[attr-defined]
    return asked


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]))
