"""Impressions are told by few signs."""

from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.replay.packed.impressions import BETWEEN, FIELD_COUNT, LEVEL_SIGNS, level_signs

DIGITS = st.lists(st.integers(0, 7), min_size=FIELD_COUNT, max_size=FIELD_COUNT)


def read(signs: str) -> tuple[str, str, str]:
    """Return the levels that signs tell, by counting through all bounds in their order."""
    bounds = [(least, least + more) for more in range(8) for least in range(8) if least + more < 8]
    found = []
    rest = list(signs)
    while rest:
        first = rest.pop(0)
        sign, level = (rest.pop(0), rest.pop(0)) if first == BETWEEN else (first, "")
        number = LEVEL_SIGNS.index(sign)
        low, high = bounds[number] if number < len(bounds) else bounds[number - len(bounds) + 8]
        found.append((str(low), str(high), level or str(high if number < len(bounds) else low)))
    least, most, retina = map("".join, zip(*found, strict=True))
    return least, most, retina


@settings(max_examples=20)  # each has 160 fields
@given(DIGITS, DIGITS, DIGITS)
def test_levels_come_back(one: list[int], other: list[int], levels: list[int]) -> None:
    least, most = ("".join(map(str, map(which, one, other))) for which in (min, max))
    retina = "".join(map(str, levels))
    signs = level_signs(least, most, retina)
    assert signs is not None
    assert read(signs) == (least, most, retina)


def test_a_field_at_a_bound_is_one_sign() -> None:
    for level in "05":
        signs = level_signs("0" * FIELD_COUNT, "5" * FIELD_COUNT, level * FIELD_COUNT)
        assert signs is not None and len(signs) == FIELD_COUNT


def test_levels_of_other_forms_are_not_told() -> None:
    fine = "3" * FIELD_COUNT
    for odd in (None, 3, fine[1:], fine[1:] + "8", fine[1:] + "\u0663", fine + "\n"):
        assert level_signs(odd, fine, fine) is None
        assert level_signs(fine, odd, fine) is None
    assert level_signs(fine[1:] + "4", fine, fine) is None  # above the greatest
