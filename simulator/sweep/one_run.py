"""One run on a worker: the texts of its files and its options come in, its result goes out. All are JSON values."""

import os
from pathlib import Path
from typing import Any

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.certificates.keeping import kept_texts
from utak.simulator.episode.episode import EpisodeLine, EpisodeLog
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import RobotMaker, Session
from utak.simulator.run.trial import faults_of
from utak.simulator.run.warming import warm
from utak.simulator.scenario.expectation import expects_verdict
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.sweep.contents import written


def prepare(argument: dict[str, Any]) -> None:
    """Compile the geometry kernels and load the robot, so that no run waits for them."""
    from utak.planner.cycle import Robot  # noqa: F401 (loading it takes time)

    warm(argument["carrying"], argument["paths"])


def run_one(argument: dict[str, Any], make: RobotMaker = make_robot) -> dict[str, Any]:
    """Run the robot once and return the result."""
    rules = [(f"rules{number}-{Path(name).name}", text) for number, (name, text) in enumerate(argument["rules"])]
    with written([*argument["files"], *rules]) as folder:
        try:
            scenario = read_scenario(folder)
            settings = Settings(**argument["options"], kb_files=tuple(str(folder / name) for name, _ in rules))
            lines: list[EpisodeLine] = []
            result = Session(scenario, settings, make, EpisodeLog(None, listeners=[lines.append])).run()
        except BadInputError as bad:
            problems = [problem._replace(file=_short(problem.file, folder)) for problem in bad.problems]
            raise BadInputError(problems) from bad
        except CannotOpenError as absent:
            raise CannotOpenError(_short(absent.path, folder), absent.why) from absent
    expected, passed = scenario.expectations, None
    if expected is not None:
        passed = not list(faults_of(result, result.outcomes, expects_verdict(expected)))
    texts = {"kept": kept_texts(lines, result.verdict, argument["risk"])} if argument["certificates"] else {}
    return {"result": {**result.line["result"], "unmet": list(result.unmet)}, "passed": passed, **texts}


def _short(path: str, folder: Path) -> str:
    """Return a path without the temporary folder, which has another name on every worker."""
    return path.replace(f"{folder}{os.sep}", "").replace(str(folder), "the scenario")
