"""The plugin of pytest for Utak: scenario folders are collected as tests (docs/testing.md).

A folder with an expect.lp and another file of a scenario is one test. It is run by a process of its own, which is
started with the first scenario that is run. So pytest loads this module and the handle of that process alone, and
nothing that pytest does to its own process, such as turning warnings into errors, changes a run.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from utak.simulator.scenario.settings import MAX_NOISE, MAX_SEED, MAX_STEPS
from utak.simulator.sweep.executors.task_process import TaskProcess
from utak.simulator.sweep.executors.tasks import TRYING_FUNCTION, WorkerTask, bug_of

EXPECTATION_FILE = "expect.lp"  # the file that stands for a scenario's test
# The other files of a scenario: at least one lies beside expect.lp. Missing ones are reported by the test.
OTHER_FILES = ("world.lp", "world.txt", "start.lp", "goal.lp")
MARKER = "utak"  # every scenario's test bears it
# The options by their fields in the settings of a run: name on the command line, greatest value, its letter, and help.
OPTIONS = {
    "seed": ("--utak-seed", MAX_SEED, "N", "seed of all randomness in scenarios"),
    "noise": ("--utak-noise", MAX_NOISE, "S", "how much motions are disturbed in scenarios, 0 to 1"),
    "max_steps": ("--utak-max-steps", MAX_STEPS, "N", "give up a scenario after so many commands"),
}
HANDLE_KEY = pytest.StashKey[TaskProcess]()  # where pytest's configuration keeps the handle of the process


class ScenarioFailedError(Exception):
    """A scenario did not end as expected, or could not be run; the message is the report."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the options and the settings of ini files."""
    group = parser.getgroup("utak", "scenarios of Utak")
    for name, (option, greatest, value, what) in OPTIONS.items():
        group.addoption(option, dest=f"utak_{name}", type=type(greatest), metavar=value, default=None, help=what)
    group.addoption("--no-utak", dest="utak_off", action="store_true", help="collect no scenarios")
    parser.addini("utak_scenarios", "whether scenario folders are collected as tests", type="bool", default=True)


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marker and check the options."""
    config.addinivalue_line("markers", f"{MARKER}: a scenario folder of Utak, run and compared with its expect.lp")
    for name, (option, greatest, _, _) in OPTIONS.items():
        value = config.getoption(f"utak_{name}")
        if value is not None and not 0 <= value <= greatest:
            raise pytest.UsageError(f"{option} must be from 0 to {greatest:g}, not {value:g}")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "ScenarioFile | None":
    """Return the collector of an expect.lp beside other files of a scenario; None for every other file."""
    if file_path.name != EXPECTATION_FILE or not any((file_path.parent / name).exists() for name in OTHER_FILES):
        return None
    if parent.config.getoption("utak_off") or not parent.config.getini("utak_scenarios"):
        return None
    file: ScenarioFile = ScenarioFile.from_parent(parent, path=file_path)
    return file


def pytest_unconfigure(config: pytest.Config) -> None:
    """End the process that runs scenarios."""
    kept = config.stash.get(HANDLE_KEY, None)
    if kept is not None:
        kept.close()


class ScenarioFile(pytest.File):
    """The expect.lp of a scenario: it stands for one test."""

    def collect(self) -> Iterator[pytest.Item]:
        """Yield the test of this scenario."""
        yield ScenarioItem.from_parent(self, name=self.path.parent.name)


class ScenarioItem(pytest.Item):
    """One scenario, run and compared with its expect.lp."""

    def __init__(self, **given: Any) -> None:
        """Make the test and mark it as a scenario's."""
        super().__init__(**given)
        self.add_marker(MARKER)

    def runtest(self) -> None:
        """Run the robot in the scenario; raise ScenarioFailedError when it does not end as expected."""
        options = {name: self.config.getoption(f"utak_{name}") for name in OPTIONS}
        given = {name: value for name, value in options.items() if value is not None}
        start = self.config.invocation_params.dir
        folder = str(self.path.parent.relative_to(start) if self.path.is_relative_to(start) else self.path.parent)
        wish = WorkerTask(TRYING_FUNCTION, {"folder": folder, "root": folder, "given": given})
        if HANDLE_KEY not in self.config.stash:  # made once a session
            self.config.stash[HANDLE_KEY] = TaskProcess(folder=str(start), is_quiet=False)
        outcome = self.config.stash[HANDLE_KEY].run(wish)
        if outcome.failure:
            raise ScenarioFailedError(f"{folder}: {bug_of(outcome)}")
        record = outcome.value
        if record["points"] is not None:
            self.user_properties += [(f"points_{name}", value) for name, value in record["points"].items()]
        if record["exit_code"]:
            raise ScenarioFailedError(record["report"])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return the report of a scenario's failure, without a traceback."""
        if isinstance(excinfo.value, ScenarioFailedError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Return the file of the test, no line, and its name."""
        return self.path, None, f"scenario {self.name}"
