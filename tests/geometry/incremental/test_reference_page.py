"""The examples of docs/changing_screens.md give what the page says."""

import doctest
from pathlib import Path

PAGE = Path(__file__).resolve().parents[3] / "docs" / "changing_screens.md"


def test_the_examples_of_the_reference_page_hold():
    failed, tried = doctest.testfile(str(PAGE), module_relative=False)
    assert tried > 10 and failed == 0
