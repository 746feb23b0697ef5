"""The examples of docs/reference-incremental.md give what the page says."""

import doctest
from pathlib import Path

PAGE = Path(__file__).resolve().parents[3] / "docs" / "reference-incremental.md"


def test_the_examples_of_the_reference_page_hold():
    failed, tried = doctest.testfile(str(PAGE), module_relative=False)
    assert tried > 10 and failed == 0
