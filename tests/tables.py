"""Tables of cases of which a few are tried by default, and all by .ci/run."""

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def few(cases: Iterable[Any], kept: int | Collection[Any]) -> list[Any]:
    """Return the cases as parameters of a test, marked `long` but for those kept.

    cases : tuples stand for several parameters. kept : these cases, or so many, spread evenly over the table.
    """
    table = list(cases)
    if isinstance(kept, int):
        kept = [table[number * len(table) // kept] for number in range(kept)]
    missing = [case for case in kept if case not in table]
    assert not missing, f"not in the table: {missing}"
    return [
        pytest.param(*(case if isinstance(case, tuple) else [case]), marks=[] if case in kept else [pytest.mark.long])
        for case in table
    ]
