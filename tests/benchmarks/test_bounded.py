"""Commands are timed in processes that end when their time is used up."""

from pathlib import Path

from benchmarks import bounded
from benchmarks.bounded import BoundedRow, TimedRun, report

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "go_northeast"


def test_every_command_of_a_run_is_timed() -> None:
    row = bounded.bounded(TimedRun(EXAMPLE, 0.0, 1, 3, False), 60)
    assert row.verdict in ("done", "limit")
    assert len(row.seconds) == len(row.actions) > 1
    assert min(row.seconds) > 0.0
    assert row.actions[0] is None
    assert not row.false


def test_an_endless_run_is_ended_and_reported() -> None:
    def endless(run: TimedRun, tell) -> None:
        tell((0.25, {"do": "release"}))
        while True:
            pass

    row = bounded.bounded(TimedRun(EXAMPLE, 0.0, 1, 3, False), 1, endless)
    assert (row.verdict, row.seconds) == ("ended", [0.25, 0.75])


def test_the_longest_commands_and_false_claims_are_listed() -> None:
    rows = [
        BoundedRow("slow", 0.02, 1, "done", True, False, [0.1, 3.0], [None, {"do": "release"}]),
        BoundedRow("quick", 0.02, 2, "impossible", False, True, [0.1], [None], "no way"),
    ]
    told = "\n".join(report(rows))
    assert told.index("slow") < told.index("quick")
    assert "3.00 s  slow --noise 0.02 --seed 1, step 1: {'do': 'release'}" in told
    assert "quick --noise 0.02 --seed 2: impossible: no way" in told
    assert "1 false claims, 3 commands, 1 over 2.0 s" in told
