"""Shapes as text: the same geometry as shapely reads, and the character at which an invalid text goes wrong."""

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.language.wkt import WktError, parse_wkt

GOOD = [
    "POINT (1.5 -2)",
    "LINESTRING (0 0, 1e1 .5)",
    "polygon((0 0,4 0,4 2,0 0))",
    "POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (2 2, 2 4, 4 4, 2 2))",
    "MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)), ((5 5, 6 5, 6 6, 5 5)))",
]
BAD = {
    "": (0, "a shape here is"),
    "CIRCLE (1 2)": (0, "not 'CIRCLE'"),
    "POINT 1 2": (6, "'(' was expected, '1' found"),
    "POINT (1)": (8, "a number was expected, ')' found"),
    "POINT (1 2": (10, "the end"),
    "POINT (1 2) x": (12, "the shape ends before 'x'"),
    "POINT (1 nan)": (9, "a number was expected"),
    "POINT (1 .)": (9, "a number was expected"),
    "POINT (8.5 8.5, 3 3)": (14, "')' was expected, ',' found"),
    "POINT (10.5.5 3)": (7, "a number was expected, '10.5.5' found"),
    "POINT (8-5)": (7, "a number was expected, '8-5' found"),
    "POINT (1 2 3)": (11, "')' was expected, '3' found"),
    "POINT ((1 2))": (7, "a number was expected, '(' found"),
    "POINT (1, 2)": (8, "a number was expected, ',' found"),
    "POINT (1 2)(3 4)": (11, "the shape ends before '('"),
    "POINT (1 2),": (11, "the shape ends before ','"),
    "POINT (1 0x10)": (9, "a number was expected"),
    "POINT (1 1_0)": (9, "a number was expected"),
    "POINT (1 1e)": (9, "a number was expected"),
    "POINT (1 \u0661)": (9, "a number was expected"),
    "POINT (1 -inf)": (9, "a number was expected"),
    "POINT EMPTY": (6, "'(' was expected, 'EMPTY' found"),
    "POINT Z (1 2 3)": (6, "'(' was expected, 'Z' found"),
    "LINESTRING (0 0, 1 1": (20, "the end"),
    "LINESTRING (0 0 1 1)": (16, "')' was expected, '1' found"),
    "LINESTRING (0 0,, 1 1)": (16, "a number was expected, ',' found"),
    "LINESTRING (0 0, 1 1,)": (21, "a number was expected, ')' found"),
    "POLYGON ((0 0, 1 0, 1 1, 0 0) (5 5, 6 5, 6 6, 5 5))": (30, "was expected, '(' found"),
    "MULTIPOLYGON ((0 0, 1 0, 1 1, 0 0))": (15, "'(' was expected, '0' found"),
    "GEOMETRYCOLLECTION (POINT (1 2))": (0, "a shape here is"),
    "POINT (1 1e999)": (9, "a coordinate beyond"),
    "POLYGON ((0 0, 1 0, 1 1))": (9, "a ring that does not end where it begins"),
    "POLYGON ((0 0, 1 0, 0 0))": (9, "three corners"),
    "POLYGON ((0 0, 4 4, 4 0, 0 4, 0 0))": (0, "the boundary crosses or touches itself at (2, 2)"),
    "POLYGON ((0 0, 1 0, 2 0, 0 0))": (0, "crosses or touches itself"),
    "POLYGON ((0 0, 1 0, 1 1, 0 0), (5 5, 6 5, 6 6, 5 5))": (0, "a hole lies outside"),
    "POLYGON EMPTY": (8, "'(' was expected"),
    "(" * 100_000: (0, "a shape here is"),
}


@pytest.mark.parametrize("text", GOOD)
def test_valid_text_gives_the_shape_that_shapely_reads(text: str) -> None:
    assert parse_wkt(text).equals_exact(shapely.from_wkt(text), 0)


@pytest.mark.parametrize("text", BAD)
def test_invalid_text_is_refused_at_its_first_wrong_character(text: str) -> None:
    with pytest.raises(WktError) as caught:
        parse_wkt(text)
    at, what = BAD[text]
    assert caught.value.at == at
    assert what in caught.value.what


@settings(deadline=None)
@given(st.text(alphabet="POLYGNIT ()0123456789.,-+eE\n", max_size=60))
def test_any_text_is_a_shape_or_refused(text: str) -> None:
    try:
        assert parse_wkt(text).is_valid
    except WktError as error:
        assert 0 <= error.at <= len(text)


PIECES = "POINT|LINESTRING|POLYGON|MULTIPOLYGON|EMPTY|Z|(|)|((|))|,| |  |0|1|4|1.5|-2|+3|.5|1.|10.5.5|8-5|1e1|1e999|nan"
words = st.sampled_from([*PIECES.split("|"), "inf", "0 0", "4 0", "4 4", "0 4", "0 0, 4 0, 4 4, 0 0"])


@settings(deadline=None)
@given(
    st.lists(words, max_size=12).map("".join)
    | st.sampled_from(GOOD).flatmap(
        lambda t: st.builds(
            lambda at, word, drop: t[:at] + word + t[at + drop :], st.integers(0, len(t)), words, st.integers(0, 3)
        )
    )
)
def test_every_accepted_text_is_read_alike_by_shapely(text: str) -> None:
    """A reader that accepts more than the standard reads something else than the user wrote."""
    try:
        shape = parse_wkt(text)
    except WktError:
        return
    assert shape.equals_exact(shapely.from_wkt(text), 0)
