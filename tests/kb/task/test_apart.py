"""Parts of the floor that no seen floor joins, and the parts that they may be joined with."""

import pytest

from tests.kb.drawings import known_model, unclear
from utak.kb.task.apart import NO_PART, floor_parts, joints
from utak.kb.world.model import WorldModel

ROWS = [
    "bbbbbbbbbbbbbbb",
    "b....bb...b...b",
    "b.U..bb...b...b",
    "b....bb...b...b",
    "bbbbbbbbbbbbbbb",
]


def apart(model: WorldModel) -> dict[tuple[str, str], tuple[str, int]]:
    return {(one.apart, one.other): (one.case, one.measure) for one in joints(model)}


def test_floor_that_is_one_has_no_parts() -> None:
    assert not apart(known_model(["bbbbbb", "b.U..b", "bbbbbb"]))


def test_what_walls_part_may_be_joined_through_them() -> None:
    model = known_model(ROWS)
    here, near, far = floor_parts(model)
    assert apart(model) == {
        (near, here): ("wall", 12),
        (near, far): ("wall", 9),
        (near, NO_PART): ("shut", 9),
        (far, here): ("wall", 12),
        (far, near): ("wall", 9),
        (far, NO_PART): ("shut", 9),
    }


@pytest.mark.parametrize("chance", [0.3, 0.9])
def test_squares_that_may_be_floor_lead_on(chance: float) -> None:
    model = unclear(unclear(known_model(ROWS), slice(2, 3), slice(5, 7), chance), slice(2, 3), slice(10, 11), chance)
    here, near, far = floor_parts(model)
    found = apart(model)
    assert found[near, far] == ("near", 1) and found[near, here] == ("further", 1)
    assert found[far, near] == ("near", 1) and found[far, here] == ("wall", 12)  # no way leads there but through `near`


def test_what_was_never_seen_leads_on() -> None:
    wide = ["b" * 40, "b...b..U" + "?" * 20 + "...........b", "b" * 40]
    model = unclear(known_model(wide), slice(1, 2), slice(4, 5), 0.5)
    west, here, east = floor_parts(model)
    found = apart(model)
    assert found[west, here] == ("near", 1)
    assert found[east, here] == ("near", 20)
