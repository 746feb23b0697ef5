"""The chance that things out of sight still lie where they lay, against its formula, and rules of users about it."""

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.objects.persistence import ChangesByOthers, Persistence, persistences

REACH = range(-16, 16)  # of the retina: offsets of the squares that it shows
places = st.tuples(st.integers(-40, 40), st.integers(-40, 40)).map(lambda p: (float(p[0]), float(p[1])))


def looks_without(place: tuple[float, float], looks: list[tuple[float, float]]) -> tuple[int, int]:
    """Return how many of the last looks did not reach a place, and how many looks did."""
    seen = [place[0] - x in REACH and place[1] - y in REACH for x, y in looks]
    return len(seen) - max((n for n, one in enumerate(seen, 1) if one), default=0), sum(seen)


@given(st.dictionaries(st.sampled_from(("o1", "o2")), places, min_size=1), st.lists(places, min_size=1), st.data())
@settings(max_examples=60, deadline=None)
def test_each_thing_taken_leaves_the_share_of_checks_to_checks_and_looks(
    things: dict[str, tuple[float, float]], looks: list[tuple[float, float]], data: st.DataObject
) -> None:
    removed = data.draw(st.integers(0, 4))
    since = data.draw(st.none() | st.integers(0, 9))
    found = persistences(things, looks, ChangesByOthers(removed, since))
    if not removed:
        assert found == {}  # what was never seen to change is as it was
        return
    counts = {name: looks_without(place, looks) for name, place in things.items()}
    checks = removed + sum(max(0, seen - 1) for _, seen in counts.values())
    for name, (unseen, _) in counts.items():
        thousandths = 1000
        for _ in range(removed):
            thousandths = int(thousandths * Fraction(checks, checks + unseen))
        again = unseen > 0 and since is not None and unseen > since and thousandths < 1000
        assert found[name] == Persistence(thousandths // 10, again)


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        ("persists(N, 100) :- thing(N).", Persistence(100, False)),
        ("persists(N, 7) :- out_of_sight(N, T), T > 1.", Persistence(7, True)),
        ("watched(N) :- colour(N, g, _).", Persistence(66, True)),
        ("watched(N) :- colour(N, r, _).", Persistence(66, True)),
    ],
)
def test_rules_of_users_say_what_persists(rule: str, expected: Persistence, tmp_path: Path) -> None:
    (tmp_path / "rules.lp").write_text(rule)
    looks = [(0.0, 0.0), (0.0, 1.0), (0.0, 2.0), (0.0, 3.0), (30.0, 0.0), (30.0, 1.0)]
    files = (tmp_path / "rules.lp",)
    found = persistences({"o1": (0.0, 0.0)}, looks, ChangesByOthers(1, 1), files, ["colour(o1,g,99)"])
    assert found == {"o1": expected}
    without = persistences({"o1": (0.0, 0.0)}, looks, ChangesByOthers(0, None), files, ["colour(o1,g,99)"])
    assert without["o1"].percent == (expected.percent if expected.percent == 7 else 100)
    assert without["o1"].again == (":- colour(N, g" in rule)
