"""expect.lp: every expectation, met and not met."""

import math
from pathlib import Path

import pytest
import shapely
from shapely.affinity import translate

from benchmarks.harness.judging import judge_module, judge_path
from utak.kb.language.diagnostics import BadInputError
from utak.simulator.scenario.expectation import Snapshot, read_expectations, shortfalls, should_fail, unmet
from utak.simulator.scenario.points import PointScore, judge_expectations, score
from utak.simulator.world.world import Thing, World

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
SOUTH = 'visits(utak, "POLYGON ((4 0, 6 0, 6 2, 4 2, 4 0))")'
NORTH = 'visits(utak, "POLYGON ((4 2, 6 2, 6 4, 4 4, 4 2))")'
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
    (f"before({SOUTH}, {NORTH}).", STAY, True),
    (f"before({NORTH}, {SOUTH}).", STAY, False),
    (f"before({SOUTH}, {SOUTH}).", STAY, False),
    (f"before({NORTH}, {SOUTH}).", track((5, 5), (5, 3), (5, 1), (5, 3)), True),
    (f"before({SOUTH}, {NORTH}).", track((5, 3), (5, 1), (5, 3)), False),
    (f"before({NORTH.replace('utak', 't1')}, {SOUTH}).", STAY, False),
    ("circles(utak, t1).", way_round(1), True),
    ("circles(utak, t1).", way_round(-1), True),
    ("circles(utak, t1).", way_round(0.9), False),
    ("circles(utak, p1).", way_round(1), False),
    ("unmoved(t1).", STAY, True),
    ("unmoved(t1).", track((5, 1), (5, 1), pushed=1e-9), False),
    ("unmoved(p1).", STAY, True),
    ('near(utak, "POINT (5 5.5)", "2.5").', STAY, True),
    ('near(utak, "POINT (5 5.5)", "2.4").', STAY, False),
    ('avoids(utak, "POLYGON ((4 0, 6 0, 6 2, 4 2, 4 0))").', STAY, False),
    ('avoids(utak, "POLYGON ((7 0, 9 0, 9 2, 7 2, 7 0))").', STAY, True),
    ('avoids(t1, "POLYGON ((7 4, 9 4, 9 6, 7 6, 7 4))").', track((5, 1), (5, 1), pushed=3), False),
    ('pose(t1, "POINT (8 5)", 0, 0).', track((5, 1), (5, 1), pushed=3), True),
    ('pose(t1, "POINT (8 5)", 90, "0.01").', track((5, 1), (5, 1), pushed=3), True),
    ('pose(t1, "POINT (8 5)", 45, "0.3").', track((5, 1), (5, 1), pushed=3), False),
    ('pose(t1, "POINT (7.5 5)", 0, "0.4").', track((5, 1), (5, 1), pushed=3), False),
    ('pose(t1, "POINT (7.5 5)", 0, "0.5").', track((5, 1), (5, 1), pushed=3), True),
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
    "unmoved(block).": "there are p1, t1",
    f"before({SOUTH}, {NORTH.replace('utak', 't2')}).": "the world has no object t2",
    f"before({SOUTH}, within(3)).": "unknown predicate within/1",
    'rules("own.lp").': "rules belongs in trial.lp",
    f"before(utak, {NORTH}).": "unknown predicate utak/0",
    "unmoved(utak).": "the world has no object utak",
    "circles(t1, p1).": "unknown walker t1",
    "within(-1).": "from 0 to",
    'near(utak, "POINT (1 1)").': "near takes 3 arguments, not 2",
    'inside(utak, "POINT (1 1)").': "a shape here is a POLYGON or MULTIPOLYGON",
    "fails(t1).": "fails takes 0 arguments, not 1",
    'near(utak, "POINT (1 1)", "2,5").': 'a distance in squares must be a number, not "2,5"',
    'near(utak, "POINT (1 1)", "-1").': "a distance in squares must be from 0 to 4096",
    'pose(p1, "POINT (1 1)", 0, 1).': "p1 is fixed",
    'pose(utak, "POINT (1 1)", 0, 1).': "the world has no object utak",
    "verdict(dome).": "unknown verdict dome",
    "verdict(done). verdict(limit).": "1:16-29: error: a run has one verdict",
    "fails. verdict(done).": "1:8-20: error: verdict(done) contradicts fails",
    "within(3). within(3).": "1:12-20: error: stated twice: within(3)",
    "within(3). weight(within(4), 2).": "1:19-27: error: within(4) is weighed, but not expected",
    "within(3). weight(within(3), -2).": "a weight must be from 0 to",
    "within(3). weight(within(3), 0).": "1:30-30: error: all weights are 0",
    "within(3). weight(within(3), 2). weight(within(3), 2).": "1:34-53: error: a second weight of within(3)",
    "within(3). weight(within(3)).": "weight takes 2 arguments, not 1",
    "within(3). weight(weight(within(3), 1), 1).": "unknown predicate weight/2",
    "within(3). weight(unmoved(t2), 1).": "unmoved(t2) is weighed, but not expected",
    "weight(within(3), 1).": "nothing is expected: there are weights alone",
}


@pytest.mark.parametrize("text", BAD)
def test_errors_of_expectations_are_reported(text: str, tmp_path: Path) -> None:
    (tmp_path / "expect.lp").write_text(text)
    with pytest.raises(BadInputError) as caught:
        read_expectations(tmp_path / "expect.lp", WORLD)
    assert BAD[text] in str(caught.value)


CAME = {
    'inside(utak, "POLYGON ((4 0, 6 0, 6 2, 4 2, 4 0))").': "utak is at POINT (5.00 3.00) at the end, 1.00 squares",
    'inside(t1, "POLYGON ((5 4, 9 4, 9 6, 5 6, 5 4))").': "t1 is at POINT (5.00 5.00) at the end, 50 % of it outside",
    'near(utak, "POINT (5 6)", 2).': "utak is at POINT (5.00 3.00) at the end, 3.00 squares away from it",
    'visits(utak, "POLYGON ((4 4, 6 4, 6 6, 4 6, 4 4))").': "it was at no step there; the nearest was step 1",
    'avoids(utak, "POLYGON ((4 0, 6 0, 6 2, 4 2, 4 0))").': "it was there at step 0: utak is at POINT (5.00 1.00)",
    f"before({NORTH}, {SOUTH}).": "the first of the two came at step 1, the second at step 0",
    f"before({SOUTH}, {NORTH.replace('2', '6')}).": "at step 0, the second never",
    "circles(utak, p1).": "the track winds about it by",
    "within(0).": "1 command was given",
    "verdict(done).": "the verdict is limit",
}


@pytest.mark.parametrize("text", CAME)
def test_what_came_is_said_in_words(text: str, tmp_path: Path) -> None:
    (tmp_path / "expect.lp").write_text(text)
    found = shortfalls(read_expectations(tmp_path / "expect.lp", WORLD), WORLD, STAY, "limit")
    assert CAME[text] in next(iter(found.values()))


def outcomes(text: str, folder: Path, believed: bool, verdict: str, reason: str = "why") -> PointScore:
    """Return the points of the run STAY by an expect.lp."""
    (folder / "expect.lp").write_text(text)
    expected = read_expectations(folder / "expect.lp", WORLD)
    missed = shortfalls(expected, WORLD, STAY, verdict)
    return score(judge_expectations(expected, missed, believed, reason))


def test_points_are_weights_and_one_without_a_weight(tmp_path: Path) -> None:
    text = "within(0). unmoved(t1). verdict(done). weight(verdict(done), 5)."
    assert outcomes(text, tmp_path, True, "done") == (6, 7)
    assert outcomes(text, tmp_path, False, "limit") == (1, 7)
    assert outcomes("within(5). weight(within(5), 0). unmoved(t1).", tmp_path, True, "done") == (1, 1)


def test_where_failure_is_expected_other_facts_count_by_their_weight_alone(tmp_path: Path) -> None:
    text = "fails. within(0). verdict(possible_if)."
    assert outcomes(text, tmp_path, False, "possible_if") == (2, 2)
    assert outcomes(text, tmp_path, False, "limit") == (1, 2)
    assert outcomes(text, tmp_path, True, "done") == (0, 2)
    assert outcomes(text, tmp_path, False, "limit", reason="") == (0, 2)
    assert outcomes(text + " weight(within(0), 4).", tmp_path, False, "possible_if") == (2, 6)


@pytest.mark.skipif(judge_path() is None, reason="no judge (set UTAK_JUDGE)")
@pytest.mark.parametrize(("text", "steps", "met"), CASES)
def test_the_independent_judge_agrees(text: str, steps: list[Snapshot], met: bool, tmp_path: Path) -> None:
    (tmp_path / "expect.lp").write_text(text)
    (tmp_path / "world.lp").write_text(
        """table(12, 12). verge("POLYGON ((0 11, 0 12, 12 12, 12 11, 0 11))"). utak("POINT (5 1)", 0).
        object(t1, g, "POLYGON ((6 4, 6 6, 4 6, 4 4, 6 4))"). fixed(p1, h, "POLYGON ((2 8, 2 9, 1 9, 1 8, 2 8))")."""
    )
    path = judge_path()
    assert path is not None
    judge = judge_module(path)
    watcher = judge.Judge(judge.World(tmp_path))
    lines = [
        {"step": one.step, "utak": one.utak, "objects": {n: p.exterior.coords[:-1] for n, p in one.polygons.items()}}
        for one in steps
    ]
    if "p1" in text:
        for line in lines:
            line["objects"]["p1"] = PILLAR.polygon.exterior.coords[:-1]
    watcher.ends(tmp_path, lines, {"believed": True, "achieved": met, "verdict": "done", "reason": "", "steps": 1})
    assert bool(watcher.findings) != met
    assert not [finding for finding in watcher.findings if "says achieved" in str(finding)]
