"""Spoilt scenario files are accepted or refused with a place; and the campaign sees when they are not."""

from pathlib import Path

import pytest

from benchmarks import malformed


def test_five_hundred_spoilt_scenarios(tmp_path: Path) -> None:
    outcomes = malformed.campaign(500, 7, tmp_path)
    assert [result for result in outcomes if result.startswith("!")] == []
    assert outcomes["accepted"] > 10
    assert outcomes["refused"] > 200


def test_the_campaign_sees_faults(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def forever(folder: Path) -> None:
        while True:
            pass

    monkeypatch.setattr(malformed, "PATIENCE", 0.05)
    monkeypatch.setattr(malformed, "read_scenario", forever)
    assert malformed.outcome(tmp_path) == "! hung"
    monkeypatch.setattr(malformed, "read_scenario", lambda folder: 1 // 0)
    assert malformed.outcome(tmp_path).startswith("! ZeroDivisionError")
