"""Places and motions come back from few digits."""

import math

from hypothesis import given
from hypothesis import strategies as st

from simulator.replay.packed.tracks import KEPT_OUTLINE_TOLERANCE, placed, posed

NUMBERS = st.floats(0, 100)
RINGS = st.lists(st.tuples(NUMBERS, NUMBERS), min_size=3, max_size=9, unique=True)


@given(RINGS, NUMBERS, NUMBERS, st.floats(-720, 720))
def test_a_moved_thing_is_told_by_its_pose(ring: list[tuple[float, float]], x: float, y: float, degrees: float) -> None:
    moved = placed([x, y, degrees], ring)
    found = posed(moved, ring)
    again = placed(found, ring) if isinstance(found[0], float) else found
    assert all(math.dist(a, b) < KEPT_OUTLINE_TOLERANCE for a, b in zip(again, moved, strict=True))


def test_an_outline_of_another_shape_is_kept_as_it_is() -> None:
    square, other = [(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 0), (2, 0), (1, 1), (0, 1)]
    assert posed(other, square) == [[0, 0], [2, 0], [1, 1], [0, 1]]
    assert posed(other[:3], square) == [[0, 0], [2, 0], [1, 1]]
