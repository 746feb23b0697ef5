"""Makes `pytest examples` run every scenario folder here as a test, as `utak test examples` does."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from kb.language.diagnostics import BadInputError, CannotOpenError
from simulator.run.trial import run_trial


class ScenarioFailedError(Exception):
    """A scenario did not end as expect.lp expects."""


class ScenarioFile(pytest.File):
    """The expect.lp of a scenario: it stands for one test."""

    def collect(self) -> Iterator[pytest.Item]:
        """The test of this scenario."""
        yield ScenarioTest.from_parent(self, name=self.path.parent.name)


class ScenarioTest(pytest.Item):
    """One scenario, run and compared with its expect.lp."""

    def runtest(self) -> None:
        """Run the robot on the scenario."""
        trial = run_trial(self.path.parent)
        if not trial.passed:
            raise ScenarioFailedError(trial.message)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: None = None) -> str:
        """What went wrong, without a traceback where the scenario is at fault."""
        if isinstance(excinfo.value, ScenarioFailedError | BadInputError | CannotOpenError):
            return str(excinfo.value)
        return str(super().repr_failure(excinfo))

    def reportinfo(self) -> tuple[Path, int, str]:
        """Where the test stands, and its name."""
        return self.path, 0, f"scenario {self.name}"


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ScenarioFile | None:
    """Take every expect.lp for a test."""
    return ScenarioFile.from_parent(parent, path=file_path) if file_path.name == "expect.lp" else None
