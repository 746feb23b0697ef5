"""Pushes that tell how large a thing is, before he says that it cannot pass."""

from pathlib import Path

import pytest

from benchmarks.trial import Conditions, run_trial


@pytest.mark.parametrize(
    ("task", "seed", "kind"),
    [
        (7, 411011, "wide"),  # its way about is not clear where he could take it: he looks first
        (9, 420023, "snug"),  # by its least outline the passage lacks less, and it is the same passage
    ],
)
def test_how_large_it_is_is_told_before_he_says_what_is_missing(
    task: int, seed: int, kind: str, tmp_path: Path
) -> None:
    trial = run_trial(task, seed, Conditions(kind=kind), tmp_path)
    assert trial.verdict == "impossible", (trial.verdict, trial.reason, trial.crash)
    assert trial.narrow is not None
    assert trial.narrow.right, trial.reason
    assert not trial.judged
