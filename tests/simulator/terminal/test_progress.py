"""Progress on a terminal, and the estimate of the remaining time."""

import itertools
import sys

import pytest

from utak.planner.under_way import UNDER_WAY
from utak.simulator.terminal.progress import Progress, StepProgress, duration


def test_the_rest_is_estimated_by_kind_and_by_how_many_are_done_at_once() -> None:
    progress = Progress({"slow": 3, "quick": 10, "unknown": 1}, "runs")
    progress.note("slow", 10.0)
    progress.note("quick", 2.0)
    assert progress.remaining_seconds(12.0) == pytest.approx(2 * 10 + 9 * 2 + 6)
    assert progress.remaining_seconds(6.0) == pytest.approx((2 * 10 + 9 * 2 + 6) / 2)
    assert progress.line(6.0) == "2 of 14 runs done, about 22 s left"


def test_the_last_report_tells_how_long_it_took() -> None:
    progress = Progress({"one": 1}, "runs")
    progress.note("one", 3.0)
    assert progress.line(3.0) == "1 of 1 runs done in 3 s"


def test_reports_go_to_a_terminal_alone(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    Progress({"one": 1}, "runs", 0.0).note("one", 1.0)
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    progress = Progress({"one": 3}, "runs", 0.0)
    for _ in range(3):
        progress.note("one", 1.0)
    assert [line.split(",")[0].split(" in ")[0] for line in capsys.readouterr().err.splitlines()] == [
        "1 of 3 runs done",
        "2 of 3 runs done",
        "3 of 3 runs done",
    ]


@pytest.mark.parametrize("is_terminal", [True, False])
def test_a_long_step_is_reported_on_a_terminal_alone(
    is_terminal: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The report comes while the step goes on, from its beginning to the end of the block."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: is_terminal)
    said = ""
    with StepProgress(200, 0.001) as progress:
        assert capsys.readouterr().err == ""
        progress.begin(7)
        for _ in itertools.count() if is_terminal else range(10_000):
            said += capsys.readouterr().err
            if said:
                break
    assert said == "step 7 of at most 200: planning for 0 s ...\n" * said.count("\n")
    assert bool(said) == is_terminal
    UNDER_WAY.words = "proposal 3 of at most 80"
    assert progress.line(4.0) == "step 7 of at most 200: planning for 4 s, proposal 3 of at most 80 ..."
    progress.begin(8)
    assert progress.line(4.0) == "step 8 of at most 200: planning for 4 s ...", "what was planned before is over"


def test_durations_are_short_texts() -> None:
    assert [duration(n) for n in (0.4, 59, 60, 3599, 3600, 90061)] == [
        "0 s",
        "59 s",
        "1 min 0 s",
        "59 min 59 s",
        "1 h 0 min",
        "25 h 1 min",
    ]
