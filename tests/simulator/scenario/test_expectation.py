"""expect.lp: every expectation, met and not met."""

import math
from pathlib import Path

import pytest
import shapely
from shapely.affinity import translate

from kb.language.diagnostics import BadInputError
from simulator.scenario.expectation import Snapshot, read_expectations, should_fail, unmet
from simulator.world.world import Thing, World

T1 = shapely.box(4, 4, 6, 6)
PILLAR = Thing("p1", "h", shapely.box(1, 8, 2, 9))
WORLD = World(12, 12, shapely.MultiPolygon(), (Thing("t1", "g", T1),), (PILLAR,), (5.0, 1.0), 0)


def track(*places: tuple[float, float], pushed: float = 0.0) -> list[Snapshot]:
    """Return a track of Utak, at the end of which t1 has been pushed east."""
    steps = [Snapshot(number, place, {"t1": T1}) for number, place in enumerate(places)]
    end = translate(T1, pushed) if pushed else T1
    return [*steps[:-1], steps[-1]._replace(polygons={"t1": end})]


def way_round(turns: float) -> list[Snapshot]:
    """Return a track around t1 in small steps."""
    angles = [turns * 2 * math.pi * n / 24 for n in range(25)]
    return track(*((5 + 3 * math.cos(a), 5 + 3 * math.sin(a)) for a in angles))


STAY = track((5, 1), (5, 3))
CASES = [
    ('inside(utak, "POLYGON ((4 2, 6 2, 6 3, 4 3, 4 2))").', STAY, True),
    ('inside(utak, "POLYGON ((4 0, 6 0, 6 2, 4 2, 4 0))").', STAY, False),
    ('inside(t1, "POLYGON ((4 4, 6 4, 6 6, 4 6, 4 4))").', STAY, True),
    ('inside(t1, "POLYGON ((4 4, 6 4, 6 6, 4 6, 4 4))").', track((5, 1), pushed=0.5), False),
    ('near(utak, "POINT (5 5)", 2).', STAY, True),
    ('near(utak, "POINT (5 6)", 2).', STAY, False),
    ('near(t1, "LINESTRING (8 0, 8 9)", 2).', STAY, True),
    ('visits(utak, "POLYGON ((4 0, 6 0, 6 2, 4 2, 4 0))").', STAY, True),
    ('visits(t1, "POLYGON ((7 4, 9 4, 9 6, 7 6, 7 4))").', track((5, 1), (5, 1), pushed=3), True),
    ('visits(t1, "POLYGON ((7 4, 9 4, 9 6, 7 6, 7 4))").', STAY, False),
    ("circles(utak, t1).", way_round(1), True),
    ("circles(utak, t1).", way_round(-1), True),
    ("circles(utak, t1).", way_round(0.9), False),
    ("circles(utak, p1).", way_round(1), False),
    ("unmoved(t1).", STAY, True),
    ("unmoved(t1).", track((5, 1), (5, 1), pushed=1e-9), False),
    ("unmoved(p1).", STAY, True),
    ("within(1).", STAY, True),
    ("within(0).", STAY, False),
]


@pytest.mark.parametrize(("text", "steps", "met"), CASES)
def test_expectations(text: str, steps: list[Snapshot], met: bool, tmp_path: Path) -> None:
    (tmp_path / "expect.lp").write_text(text)
    expected = read_expectations(tmp_path / "expect.lp", WORLD)
    assert unmet(expected, WORLD, steps) == ([] if met else list(expected))
    assert not should_fail(expected)


BAD = {
    "unmoved(t2).": "the world has no object t2",
    "unmoved(utak).": "the world has no object utak",
    "circles(t1, p1).": "unknown walker t1",
    "within(-1).": "from 0 to",
    'near(utak, "POINT (1 1)").': "near takes 3 arguments, not 2",
    'inside(utak, "POINT (1 1)").': "a shape here is a POLYGON or MULTIPOLYGON",
    "fails(t1).": "fails takes 0 arguments, not 1",
}


@pytest.mark.parametrize("text", BAD)
def test_errors_of_expectations_are_reported(text: str, tmp_path: Path) -> None:
    (tmp_path / "expect.lp").write_text(text)
    with pytest.raises(BadInputError) as caught:
        read_expectations(tmp_path / "expect.lp", WORLD)
    assert BAD[text] in str(caught.value)
