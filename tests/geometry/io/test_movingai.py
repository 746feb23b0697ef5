"""Maps of the Moving AI benchmarks: texts that are read, and the places of errors in all others."""

import tracemalloc

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.io.movingai import MapError, parse_map

ROWS = ["@@@@@@", "@....@", "@.TW.@", "@....@", "@@@@@@"]
GOOD = "\n".join(["type octile", "height 5", "width 6", "map", *ROWS]) + "\n"
FREE = parse_map(GOOD.encode()).tolist()

READ = {
    "lines that end in CR LF": GOOD.replace("\n", "\r\n"),
    "no last line end": GOOD.rstrip("\n"),
    "blanks at the ends of the head's lines": GOOD.replace("octile\n", "octile \n").replace("5\n", "5\t\n"),
    "blanks at the ends of rows": GOOD.replace("@\n", "@ \t\n"),
    "tabs in the head": GOOD.replace("height ", "height\t").replace("width ", "  width \t "),
    "width before height": GOOD.replace("height 5\nwidth 6", "width 6\nheight 5"),
    "no type": GOOD.replace("type octile\n", ""),
    "blank lines after the rows": GOOD + "\n \n\r\n",
    "a byte order mark": "\ufeff" + GOOD,
}
REFUSED = {
    "no number": (GOOD.replace("height 5", "height "), (2, 6), "one word was expected after height"),
    "a negative number": (GOOD.replace("height 5", "height -5"), (2, 8), "height must be a whole number above 0"),
    "nought": (GOOD.replace("width 6", "width 0"), (3, 7), "width must be a whole number above 0"),
    "a fraction": (GOOD.replace("width 6", "width 6.0"), (3, 7), "width must be a whole number above 0"),
    "an underscore": (GOOD.replace("width 6", "width 0_6"), (3, 7), "width must be a whole number above 0"),
    "a huge number": (GOOD.replace("height 5", "height 9999999999"), (2, 8), "height must be a whole number above 0"),
    "two numbers": (GOOD.replace("height 5", "height 5 5"), (2, 10), "one word was expected after height"),
    "height twice": (GOOD.replace("type octile", "height 5"), (2, 1), "height is given twice"),
    "no width": (GOOD.replace("width 6\n", ""), (3, 1), "'width N' is missing"),
    "no map": (GOOD.replace("map\n", ""), (4, 1), "'map' is missing"),
    "a blank line in the head": (GOOD.replace("map\n", "\nmap\n"), (4, 1), "'map' is missing"),
    "nothing at all": ("", (1, 1), "'map' is missing"),
    "a head alone": ("height 5\nwidth 6", (2, 1), "'map' is missing"),
    "surplus rows": (GOOD + "@@@@@@\n", (10, 1), "the map has more than 5 rows"),
    "surplus rows after a blank one": (GOOD + "\n@@@@@@\n", (11, 1), "the map has more than 5 rows"),
    "too few rows": (GOOD.replace("height 5", "height 6"), (9, 1), "the map has 5 rows, not 6"),
    "a row too long": (GOOD.replace("@.TW.@", "@.TW..@"), (7, 7), "the row has 7 squares, not 6"),
    "a row too short": (GOOD.replace("@.TW.@", "@.TW."), (7, 6), "the row has 5 squares, not 6"),
    "a blank row": (GOOD.replace("@.TW.@", ""), (7, 1), "the row has 0 squares, not 6"),
    "a blank amid a row": (GOOD.replace("@.TW.@", "@. W.@"), (7, 3), "unknown square ' '"),
    "a form feed": (GOOD.replace("@.TW.@", "@.\fW.@"), (7, 3), "unknown square"),
    "an unknown square": (GOOD.replace("@.TW.@", "@.TX.@"), (7, 4), "unknown square 'X'"),
}


@pytest.mark.parametrize("case", READ)
def test_maps_as_users_write_them_are_read(case: str) -> None:
    assert parse_map(READ[case].encode()).tolist() == FREE


@pytest.mark.parametrize("case", REFUSED)
def test_other_texts_are_refused_with_the_place_of_the_error(case: str) -> None:
    text, place, what = REFUSED[case]
    with pytest.raises(MapError) as caught:
        parse_map(text.encode())
    assert (caught.value.line, caught.value.column) == place
    assert what in caught.value.what


pieces = st.sampled_from(
    ["", " ", "\t", "\n", "\r\n", "\r", "-", "5", "999999999", "0", "map", "height", ".", "@", "\x00", "\xff"]
)


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_mutated_maps_are_read_or_refused_with_a_place(data: st.DataObject) -> None:
    text = GOOD
    for _ in range(data.draw(st.integers(1, 4))):
        start, length = data.draw(st.integers(0, len(text))), data.draw(st.integers(0, 9))
        text = text[:start] + data.draw(pieces) + text[start + length :]
    try:
        free = parse_map(text.encode("latin-1"))
    except MapError as error:
        lines = text.split("\n")
        assert 1 <= error.line <= len(lines)
        assert 1 <= error.column <= error.end
        return
    assert free.ndim == 2
    assert free.size > 0
    assert free.sum() == sum(text.split("map", 1)[1].count(square) for square in ".GS")


def test_a_head_takes_no_more_memory_than_its_size_lets_expect() -> None:
    raw = b"type" + b" a" * 500_000
    tracemalloc.start()
    with pytest.raises(MapError, match="one word"):
        parse_map(raw)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 20 * len(raw)
