"""Loads the plugin of pytest that collects scenarios, also where Utak is not installed, and the one that tests it.

A module of tests that cannot be imported is an error: pytest would skip it where doctests are collected, too.

Hypothesis tries the same examples each time, so that a test that passes goes on passing; HYPOTHESIS_PROFILE=random
tries others. Neither fails because the machine does much besides.

Processes that share the tests (pytest-xdist) find all kernels compiled; else each would compile the same ones.
"""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

pytest_plugins = ["utak.pytest_plugin", "pytester"]

for name in ("same", "random"):
    slow = [HealthCheck.too_slow]
    settings.register_profile(name, derandomize=name == "same", deadline=None, suppress_health_check=slow)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))
TESTS = Path(__file__).resolve().parent / "tests"
NOT_IMPORTED = "unable to import module"  # pytest's reason; what lacks an optional library skips itself for another


def pytest_configure(config: pytest.Config) -> None:
    """Compile all kernels that are not in the cache before pytest-xdist starts its processes."""
    is_worker, is_shared = hasattr(config, "workerinput"), getattr(config.option, "numprocesses", None)
    if is_shared and not is_worker and os.environ.get("NUMBA_DISABLE_JIT", "0") == "0":
        from utak.simulator.run.warming import warm_all

        warm_all()


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Iterator[None]:
    """Turn the skip of a module of tests that cannot be imported into an error."""
    report = yield
    if report.outcome == "skipped" and NOT_IMPORTED in str(report.longrepr) and TESTS in collector.path.parents:
        report.outcome, report.longrepr = "failed", f"{collector.path} cannot be imported; import it to see why"
    return report
