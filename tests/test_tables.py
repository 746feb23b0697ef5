"""A table of which a few cases are tried by default loses none of its cases."""

import pytest

from tests.tables import few


def test_all_cases_stay_and_those_not_kept_are_long() -> None:
    for cases, kept, tried in ((range(10), 3, [0, 3, 6]), ([(1, "a"), (2, "b")], [(2, "b")], [(2, "b")])):
        parameters = few(cases, kept)
        values = [
            one.values if isinstance(case, tuple) else one.values[0]
            for one, case in zip(parameters, cases, strict=True)
        ]
        assert values == list(cases)
        assert [value for one, value in zip(parameters, values, strict=True) if not one.marks] == tried


def test_a_case_to_keep_that_is_not_there_is_an_error() -> None:
    with pytest.raises(AssertionError, match=r"not in the table: \[7\]"):
        few([1, 2], [7])
