"""Malformed files are accepted, or refused with a place; the campaign finds other outcomes."""

from pathlib import Path
from typing import NoReturn

from benchmarks import malformed


def test_five_hundred_malformed_scenarios(tmp_path: Path) -> None:
    outcomes = malformed.campaign(500, 7, tmp_path)
    assert [result for result in outcomes if result.startswith("!")] == []
    assert outcomes["accepted"] > 10
    assert outcomes["refused"] > 200


def test_malformed_queries() -> None:
    outcomes = malformed.queries(400, 7)
    assert [result for result in outcomes if result.startswith("!")] == []
    assert outcomes["accepted"] > 25
    assert outcomes["refused"] > 200


def test_malformed_rules(tmp_path: Path) -> None:
    outcomes = malformed.rules(120, 7, tmp_path)
    assert [result for result in outcomes if result.startswith("!")] == []
    assert outcomes["accepted"] > 5
    assert outcomes["refused"] > 60


def test_malformed_maps() -> None:
    outcomes = malformed.maps(1000, 7)
    assert [result for result in outcomes if result.startswith("!")] == []
    assert outcomes["accepted"] > 20
    assert outcomes["refused"] > 500


def test_malformed_files_that_we_wrote(tmp_path: Path) -> None:
    outcomes = malformed.written(400, 7, tmp_path)
    assert [result for result in outcomes if result.startswith("!")] == []
    assert outcomes["accepted"] > 100
    assert outcomes["refused"] > 25


def test_the_campaign_sees_faults(tmp_path: Path) -> None:
    def forever(folder: Path) -> NoReturn:
        while True:
            pass

    def broken(source: object) -> NoReturn:
        raise ZeroDivisionError("integer division or modulo by zero")

    assert malformed.outcome(tmp_path, forever, seconds=0.05) == "! hung"
    assert malformed.outcome(tmp_path, broken).startswith("! ZeroDivisionError")
    assert list(malformed.maps(1, 0, broken)) == ["! ZeroDivisionError: integer division or modulo by zero"]
