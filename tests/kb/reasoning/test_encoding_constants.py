"""Numbers that an encoding states are read from it, and only from it."""

from pathlib import Path

import pytest

from kb.perception.interpretation import (
    FELT_OBJECT_CONFIDENCE,
    LONGEST_OBJECT,
    SHORTEST_WALL,
    SURELY_VERGE,
    interpret_regions,
)
from kb.perception.regions import Percept, Region
from kb.reasoning.encoding_constants import encoding_constant


def test_a_constant_is_read_from_its_encoding(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("#const longest = 7.\np(longest).\n")
    assert encoding_constant(rules, "longest") == 7


def test_an_unknown_constant_is_refused(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("p(1).\n")
    with pytest.raises(KeyError, match=r"rules\.lp defines no constant longest"):
        encoding_constant(rules, "longest")


@pytest.mark.parametrize(
    ("extent", "verge"), [(SHORTEST_WALL, SURELY_VERGE), (LONGEST_OBJECT, 92), (LONGEST_OBJECT + 1, 95)]
)
def test_constants_agree_with_the_answers_of_the_interpretation(extent: int, verge: int) -> None:
    region = Region("r", True, 100, True, extent, 60)
    kinds = interpret_regions(Percept((region,), frozenset(), frozenset()))
    assert kinds.of("r", "verge") == verge
    felt = interpret_regions(Percept((region,), frozenset(), frozenset()), [("r", "g")])
    # What is longer than any object is verge, and a thing is in it.
    assert felt.of("r", "object") == (FELT_OBJECT_CONFIDENCE if extent <= LONGEST_OBJECT else 0)
