"""Where something that is carried must end."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from kb.factfile import facts_of
from kb.loads import covered
from kb.worldmodel import Node, WorldModel
from planner.landing import Landing, landing
from tests.kb.drawings import seen_whole
from tests.planner.situations import situation_of

SHUT_IN = [
    "b" * 20,
    *["b" + "." * 18 + "b"] * 5,
    "bggggg" + "." * 13 + "b",
    "bUgggg" + "." * 13 + "b",
    "bggggg" + "." * 13 + "b",
    *["b" + "." * 18 + "b"] * 5,
    "b" * 20,
]
NORTHEAST = facts_of("at(x, corner(northeast)).")[0]


def landing_of(model: WorldModel, held: bool) -> Landing:
    """Where the ring about him must end, and whether he has hold of it."""
    ring = shapely.box(-1, -1, 4, 2) - shapely.box(0, 0, 1, 1) - shapely.box(-1, 0, 0, 1)
    node = Node("o1", "object", 95, "part1", covered(ring), 0, polygon=ring, moved=held)
    situation = situation_of(replace(model, objects=(node,), held="o1" if held else None), {"x": "o1"})
    return landing(NORTHEAST, node, (0.0, 0.0), situation)


@pytest.mark.parametrize("held", [True, False])
def test_what_he_holds_does_not_shut_him_in(held: bool) -> None:
    model = seen_whole(SHUT_IN)
    assert np.count_nonzero(situation_of(model).screens.floor) == 1
    found = landing_of(model, held)
    assert bool(found.ends) == held
    assert ("passage" in found.missing) != held
