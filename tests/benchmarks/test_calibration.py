"""Confidences compared with the truth, and priors counted: what the programs say of moments that are known."""

import json
import math
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from shapely import Point, Polygon, box
from shapely.affinity import rotate, translate

from benchmarks.calibration import __main__ as calibration
from benchmarks.calibration.dealt import DealtWorld, dealt, made
from benchmarks.calibration.figures import NO_CLASS, RECTANGLE, class_of
from benchmarks.calibration.moments import Moment
from benchmarks.calibration.necks import door_necks
from benchmarks.calibration.picture import picture
from benchmarks.calibration.runs import LookedAt, watched
from benchmarks.calibration.statements import HeldStatement, statements
from benchmarks.calibration.table import Held, as_json, reliabilities, table
from benchmarks.calibration.truth import TableTruth
from benchmarks.calibration.whereabouts import TrueAlternatives
from benchmarks.claims.asked import Asked, all_kinds
from benchmarks.harness.beliefs import TableFrame
from benchmarks.priors import __main__ as priors
from benchmarks.priors.bins import ANY, EXTENT, MASS, PLACES, WHOLE, Bin, bin_of, bins
from benchmarks.priors.count import Counted, counted_classes, counted_kinds, counted_places, counted_walls
from benchmarks.priors.measures import FitSeen, PlaceSeen, RegionSeen
from benchmarks.priors.walls import walls_seen, with_plugs
from benchmarks.worlds.furniture import OUTLINE_SHAPES, outline
from utak.kb.localisation.standing import Standing
from utak.kb.perception.frame import Frame
from utak.kb.task.task import task_from_texts
from utak.kb.world.rooms import Rooms


@pytest.mark.parametrize("shape", OUTLINE_SHAPES)
@pytest.mark.parametrize("degrees", [0, 90, 33])
def test_the_class_of_a_polygon_is_found_at_any_angle(shape: str, degrees: int) -> None:
    for seed in range(5):
        polygon = outline(np.random.default_rng(seed), shape, degrees % 90 > 0)
        turned = translate(rotate(polygon, degrees, origin=(0, 0)), 0.3, 7)
        assert class_of(turned) == shape
        assert class_of(Polygon(list(turned.exterior.coords)[::-1])) == shape


def test_what_is_of_no_class_and_what_is_between_two_is_said() -> None:
    cross = box(2, 0, 4, 6).union(box(0, 2, 6, 4))
    assert class_of(cross) == NO_CLASS
    assert class_of(box(0, 0, 10, 9)) == RECTANGLE
    assert class_of(box(0, 0, 9, 9).difference(box(3, 3, 6, 6))) == NO_CLASS


THING = SimpleNamespace(name="t1", colour="g", shape="square", polygon=box(3, 3, 6, 6), fixed=False)
STONE = SimpleNamespace(name="p1", colour="h", shape="brick", polygon=box(8, 3, 10, 8), fixed=True)

SQUARE = task_from_texts("object(x). shape(x, square).", "at(utak, x).")
# The west of the table was seen, and taken for one room; of the bounds the south alone.
SEEN = np.zeros((16, 20), np.int32)
SEEN[2:14, 7:14] = 1
MODEL = SimpleNamespace(view=SimpleNamespace(west=0, south=0), verge=np.arange(16)[:, None] + np.zeros((16, 20)) < 2)
ROOMS = Rooms((), SEEN, np.zeros_like(SEEN, np.bool_))


def moment(*facts: str, **nodes: tuple[int, int, int, int]) -> Moment:
    """Return a moment on a table of 20 x 16 squares. nodes : west, south, east, north of each, in squares."""
    floor = box(2, 2, 18, 14)
    plan = SimpleNamespace(width=20, height=16, floor=floor, verge=box(0, 0, 20, 16).difference(floor))
    world = SimpleNamespace(plan=plan, things=(THING, STONE), heading=0, utak=Point(5, 8))
    door = (box(18, 6, 20, 10), 4.0)
    truth = TableTruth(DealtWorld(Asked("plugged", 0), world, (door,)), {}, (12.5, 8.5))
    squares = {
        name: frozenset((x, y) for x in range(west, east) for y in range(south, north))
        for name, (west, south, east, north) in nodes.items()
    }
    nodes = {name: truth.of(there) for name, there in squares.items()}
    alternatives = TrueAlternatives(SQUARE, MODEL, ROOMS, TableFrame(0, 0, 0), truth, nodes)
    return Moment(facts, nodes, squares, truth, alternatives=alternatives)


def verdicts(found: Moment) -> dict[str, float]:
    return {statement.fact: statement.true for statement in statements(found)}


def test_a_node_is_what_covers_most_of_its_squares() -> None:
    found = moment(o1=(3, 3, 6, 5), o2=(0, 0, 3, 3), o3=(12, 12, 13, 13), o4=(3, 3, 10, 8), o5=(8, 3, 11, 8))
    assert [found.nodes[f"o{n}"].kind for n in range(1, 6)] == ["object", "verge", "floor", "object", "object"]
    assert [found.nodes[f"o{n}"].shape for n in range(1, 6)] == ["square", None, None, NO_CLASS, "brick"]


def test_statements_are_compared_with_what_is_so() -> None:
    facts = (
        *("kind(o1,object,90)", "kind(o1,verge,10)", "kind(org,utak,100)", "kind(o2,verge,60)"),
        *("shape(o1,square,70)", "shape(o1,disc,5)", "shape(o1,rectangle,80)", "shape(o1,polygon,95)"),
        *("shape(o2,square,30)", "colour(o1,r,99)", "movable(o1,95)", "movable(o5,95)", "movable(o2,1)"),
        *("adjacent(org,o1,9)", "adjacent(o1,o5,40)", "unheard_of(o1)"),
    )
    assert verdicts(moment(*facts, o1=(3, 3, 6, 6), o2=(0, 0, 3, 3), o5=(8, 3, 10, 8))) == {
        "kind(o1,object,90)": True,
        "kind(o1,verge,10)": False,
        "kind(o2,verge,60)": True,
        "shape(o1,square,70)": True,
        "shape(o1,disc,5)": False,
        "shape(o1,rectangle,80)": True,
        "shape(o1,polygon,95)": True,
        "colour(o1,r,99)": False,
        "movable(o1,95)": True,
        "movable(o5,95)": False,
        "movable(o2,1)": False,
        "adjacent(org,o1,9)": False,
        "adjacent(o1,o5,40)": False,
    }


def test_where_a_thing_is_that_nobody_saw_is_compared_with_what_is_so() -> None:
    facts = ("may_be(x,r1,70)", "may_be(x,o1,20)", "may_be(x,verge,10)")
    assert verdicts(moment(*facts)) == dict(zip(facts, (True, False, False), strict=True))
    assert verdicts(moment(*facts, o1=(3, 3, 6, 6))) == dict(zip(facts, (False, True, False), strict=True))
    assert verdicts(moment("may_be(y,r1,70)")) == {}


def test_where_the_robot_stands_is_compared_from_where_it_woke() -> None:
    """It woke in the square (5, 8) of the table, and is in (12, 8), whatever it believes."""
    model = SimpleNamespace(**vars(MODEL), standing=Standing("unsure", Frame(), {}))
    found = moment("loc(700,0,90)", "loc(600,0,10)")
    assert found.alternatives is not None
    compared = found._replace(alternatives=found.alternatives._replace(model=model))
    assert verdicts(compared) == {"loc(700,0,90)": True, "loc(600,0,10)": False}


def test_a_stretch_of_wall_is_a_thing_where_one_covers_most_of_it() -> None:
    """Between two strips of floor lie a thing, three squares wide and high, and then wall that is one square high."""
    space = np.zeros((16, 20), np.bool_)
    space[7, 3:9] = space[2, 3:6] = space[5, 6:9] = True
    view = SimpleNamespace(west=0, south=0, seen=np.ones_like(space))
    model = SimpleNamespace(**{**vars(MODEL), "view": view}, space=space, objects=(), felt_verge=np.zeros_like(space))
    facts = ("plug(w1,30)", "plug(w2,20)")
    found = moment(*facts)
    assert found.alternatives is not None
    compared = found._replace(alternatives=found.alternatives._replace(model=model))
    assert verdicts(compared) == {"plug(w1,30)": True, "plug(w2,20)": False}


def test_what_joins_parts_of_the_floor_is_compared_with_the_true_floor() -> None:
    """Of three parts of one room, in a row from west to east, the outer ones lead to the middle one first."""
    labels, occupied = np.zeros((16, 20), np.int32), SimpleNamespace(name="part4", occupied=True)
    for number, (west, east) in enumerate(((3, 5), (8, 10), (15, 17)), 1):
        labels[8, west:east] = number
    labels[0, :4] = 5  # taken for floor, and wall in truth
    free = [SimpleNamespace(name=f"part{n}", occupied=False) for n in (1, 2, 3, 5)]
    percept = SimpleNamespace(regions=(*free, occupied))
    model = SimpleNamespace(**vars(MODEL), labels=labels, space=labels > 0, percept=percept)
    facts = ("hidden(part1,part2,80)", "hidden(part3,part2,70)", "hidden(part3,part1,20)", "hidden(part5,part1,40)")
    found = moment(*facts)
    assert found.alternatives is not None
    compared = found._replace(alternatives=found.alternatives._replace(model=model))
    assert verdicts(compared) == dict(zip(facts, (True, True, False, False), strict=True))


HERE = "offset(org,0,0)"
DOOR, NO_DOOR = "threshold(d1,550,-250,550,150)", "threshold(d2,-850,-650,-850,550)"


def test_doors_and_corners_are_found_where_they_are() -> None:
    facts = (
        *(HERE, DOOR, "door(d1,100)", "width(d1,390,410)", "width(d1,450,500)"),
        *(NO_DOOR, "door(d2,40)", "width(d2,300,500)"),
        *("corner(northeast,550,550,70)", "corner(southwest,50,50,30)"),
    )
    assert verdicts(moment(*facts)) == {
        "door(d1,100)": True,
        "width(d1,390,410)": True,
        "width(d1,450,500)": False,
        "door(d2,40)": False,
        "corner(northeast,550,550,70)": True,
        "corner(southwest,50,50,30)": False,
    }


def test_a_neck_beside_a_thing_in_a_doorway_is_not_that_door() -> None:
    narrow = ("threshold(d1,550,-250,550,-200)", "door(d1,50)", "width(d1,40,60)")
    assert verdicts(moment(HERE, *narrow)) == {"door(d1,50)": False}


def test_of_a_corner_that_looks_along_the_grid_either_square_is_the_inner_one() -> None:
    found = moment(HERE, "corner(northeast,0,0,50)")
    truth = SimpleNamespace(
        heading=45,
        utak=(5, 5),
        seems=lambda square, occupied: occupied == (square != (4, 4)),
        is_floor=lambda square: square == (4, 4),
    )
    assert verdicts(found._replace(truth=truth)) == {"corner(northeast,0,0,50)": True}
    solid = SimpleNamespace(**{**vars(truth), "seems": lambda _, occupied: occupied, "is_floor": lambda _: False})
    assert verdicts(found._replace(truth=solid)) == {"corner(northeast,0,0,50)": False}


def test_what_is_several_things_is_compared_with_none_of_them() -> None:
    found = moment("adjacent(o1,verge,50)", o1=(3, 3, 6, 6))
    assert len(verdicts(found)) == 1
    several = {name: node._replace(several=True) for name, node in found.nodes.items()}
    assert not verdicts(found._replace(nodes=several))


def squares(west: int, south: int, east: int, north: int) -> frozenset[tuple[int, int]]:
    return frozenset((x, y) for x in range(west, east) for y in range(south, north))


def test_rooms_are_the_parts_of_the_floor_between_doors() -> None:
    two = box(2, 2, 9, 14).union(box(11, 2, 18, 14)).union(box(9, 6, 11, 9))
    facts = (HERE, "threshold(d1,-250,-250,-250,50)", "door(d1,90)")
    facts += ("connects(d1,r1,r2,90)", "connects(d1,r1,r1,90)", "in(org,r1,60)", "in(org,r2,40)", "in(o1,r1,99)")
    found = moment(*facts, o1=(3, 3, 6, 6))
    world = SimpleNamespace(
        plan=SimpleNamespace(width=20, height=16, floor=two, verge=box(0, 0, 20, 16).difference(two)),
        things=(THING,),
        heading=0,
        utak=Point(5, 8),
    )
    truth = TableTruth(DealtWorld(Asked("plugged", 0), world, None), {}, (12.5, 8.5))
    assert [width for _, width in truth.doors] == [3.0]  # where nobody says which doors there are, geometry does
    rooms = {"r1": squares(2, 2, 9, 14), "r2": squares(11, 2, 18, 14)}
    woke = found._replace(truth=truth, rooms=rooms | {"r1": squares(2, 2, 18, 14)})
    assert verdicts(woke)["in(o1,r1,99)"]  # r1 is where it woke, wherever else it is believed to reach
    assert verdicts(found._replace(truth=truth, rooms=rooms)) == {
        "door(d1,90)": True,
        "connects(d1,r1,r2,90)": True,
        "connects(d1,r1,r1,90)": False,
        "in(org,r1,60)": False,
        "in(org,r2,40)": True,
        "in(o1,r1,99)": True,
    }


def test_a_door_that_is_none_parts_no_true_room() -> None:
    assert not door_necks(box(2, 2, 18, 14), 20, 16)
    found = moment(HERE, NO_DOOR, "in(org,r1,60)", "in(org,r2,40)", "connects(d2,r1,r2,30)")
    rooms = {"r1": squares(4, 2, 18, 14), "r2": squares(2, 2, 4, 6)}
    expected = {"in(org,r1,60)": True, "in(org,r2,40)": False, "connects(d2,r1,r2,30)": False}
    assert verdicts(found._replace(rooms=rooms)) == expected


def test_what_speaks_of_many_squares_is_true_to_a_share() -> None:
    facts = (HERE, "region(part1,zero,90)", "region(part2,nonzero,100)", "kind(floor,floor,99)", "kind(verge,verge,99)")
    facts += ("segment(verge,0,-1050,-650,-1050,-150,100)",)
    parts = {"part1": squares(2, 2, 4, 4), "part2": squares(0, 0, 2, 2) | squares(12, 4, 14, 6)}
    found = moment(*facts)._replace(regions=parts, solid=squares(0, 2, 2, 7))
    wholes = {"floor": squares(6, 6, 8, 8), "verge": squares(0, 0, 4, 4)}
    assert verdicts(found._replace(squares=wholes)) == {
        "region(part1,zero,90)": 0.75,  # a corner of t1 is in it
        "region(part2,nonzero,100)": 0.5,
        "kind(floor,floor,99)": 1,
        "kind(verge,verge,99)": 0.75,
        "segment(verge,0,-1050,-650,-1050,-150,100)": 1,
    }
    assert verdicts(found._replace(solid=frozenset()))["segment(verge,0,-1050,-650,-1050,-150,100)"] == 0.5


def test_a_square_that_was_crossed_and_is_covered_in_part_is_both() -> None:
    floor = box(2.5, 2, 18, 14)
    plan = SimpleNamespace(width=20, height=16, floor=floor, verge=box(0, 0, 20, 16).difference(floor))
    world = SimpleNamespace(plan=plan, things=(THING,), heading=0, utak=Point(2.8, 10.5))
    truth = TableTruth(DealtWorld(Asked("plugged", 0), world, ()), {}, (4.5, 10.5), [(2.8, 10.5), (4.5, 10.5)])
    assert truth.seems((2, 10), True) and truth.seems((2, 10), False)
    assert truth.is_kind((2, 10), "floor") and truth.is_kind((2, 10), "verge")
    assert truth.seems((2, 8), True) and not truth.seems((2, 8), False)


def statement(confidence: int, true: bool, alternatives: str = "") -> Held:
    return Held(
        "plugged:0", 3, HeldStatement("kind/3", f"kind(o1,object,{confidence})", confidence, true, alternatives)
    )


def test_the_error_is_the_mean_difference_of_bins_and_certain_mistakes_are_listed() -> None:
    held = [statement(72, n < 5) for n in range(10)] + [statement(100, n > 0) for n in range(10)]
    (found,) = reliabilities(held)
    assert math.isclose(found.error, (abs(0.72 - 0.5) + abs(1 - 0.9)) / 2)
    assert [(row.number, row.true) for row in found.rows.values()] == [(10, 0.5), (10, 0.9)]
    assert [one.statement.confidence for one in found.wrong] == [100]
    assert "wrong at 100: kind(o1,object,100) in plugged:0, step 3" in table([found])
    assert json.loads(json.dumps(as_json([found])))[0]["statements"] == 20
    assert picture([found]).count("<title>") == 2


def test_alternatives_are_added_up() -> None:
    (found,) = reliabilities([statement(60, True, "kind(o1)"), statement(40, False, "kind(o1)")])
    assert found.sums == {100: 1} and "100 in 1 of 1" in table([found])


def test_worlds_are_dealt_of_all_kinds_before_any_comes_again() -> None:
    number = len({(asked.kind, asked.task) for asked, _ in dealt(200, 7, [0.0])})
    first = [asked for asked, _ in dealt(number, 7, [0.0])]
    assert {asked.kind for asked in first} == set(all_kinds())
    assert len({(asked.kind, asked.task) for asked in first}) == number
    assert [asked for asked, _ in dealt(5, 7, [0.0])] == first[:5] != [asked for asked, _ in dealt(5, 8, [0.0])]
    twice = list(dealt(2 * number, 7, [0.0, 0.05]))
    assert all(noise != other for (_, noise), (_, other) in zip(twice[:number], twice[number:], strict=True))
    assert made(Asked("two_doors", 1)).doors


@pytest.mark.parametrize("found", [*MASS.values(), *EXTENT.values(), *PLACES.values(), bins(0, 3, 9)])
def test_bins_have_no_gaps(found: tuple[Bin, ...]) -> None:
    assert found[0].least == 0 and found[-1].most == ANY
    assert all(one.most + 1 == other.least for one, other in pairwise(found))
    assert all(bin_of(value, found).holds(value) for value in range(50))


def test_rates_follow_laplace_and_are_never_certain() -> None:
    assert [Counted("p", (), true, of).thousandths for true, of in ((0, 0), (0, 8), (8, 8), (10**6, 10**6))] == [
        *(500, 100, 900, 999),
    ]


def test_in_walls_that_are_felt_things_begin_once_where_one_fills_a_doorway() -> None:
    """In a closed room none begins; with a thing in the doorway one does, at the first decision where to feel."""

    def began(look: LookedAt) -> tuple[int, int]:
        """Return how many places of walls were offered, and how many of them count as beginnings."""
        rows = [*counted_walls(walls_seen(look))]
        return sum(row.of for row in rows), sum(row.true for row in rows)

    asked = [world for world, noise in with_plugs(15, 3) if not noise]
    assert [world.name for world in asked[:2]] == ["filled_flush:1:3", "filled_flush:2:3"] and len(asked) == 15
    for world, number in ((asked[0], 1), (Asked("filled_closed", 3, 1), 0)):
        looks = watched(world, 0.0, 12, 60, began, 12).looks
        assert next(true for places, true in looks if places) == number


def test_regions_and_classes_are_counted_by_their_bins() -> None:
    regions = [
        RegionSeen("undecided", 3, 40, "o1", "object"),
        RegionSeen("undecided", 30, 900, "", "verge"),
        RegionSeen("undecided", 2, 3, "o2", "floor"),
    ]
    kinds = {(row.predicate, *row.given): (row.true, row.of) for row in counted_kinds(regions)}
    assert kinds["counted_solid", "undecided", bin_of(3, MASS["undecided"])] == (0, 1)
    assert kinds["counted_object", "undecided", bin_of(3, EXTENT["undecided"]), *WHOLE] == (1, 1)
    assert kinds["counted_object", "undecided", bin_of(30, EXTENT["undecided"]), *WHOLE] == (0, 1)
    fits = (("square", 0), ("brick", 0), ("disc", 3))
    seen = [FitSeen("o1", fits, 0, 9, "object", shape) for shape in ("square", "brick", NO_CLASS, None)]
    classes = {(row.predicate, *row.given): (row.true, row.of) for row in counted_classes(seen)}
    assert classes["counted_first", Bin(0, 0), Bin(0, 0), Bin(0, 25)] == (1, 3)
    assert classes["counted_other", Bin(0, 2)] == (1, 2)
    assert classes["counted_none", Bin(0, 2)] == (1, 2)


def test_facts_about_places_are_counted_by_what_was_measured() -> None:
    seen = [PlaceSeen("corner", 15, False), PlaceSeen("corner", 19, True), PlaceSeen("corner_unsure", 15, True)]
    found = {row.given: (row.true, row.of) for row in counted_places(seen)}
    assert found["corner", Bin(10, 19)] == (1, 2)
    assert found["corner_unsure", Bin(10, 19)] == (1, 1)


@pytest.mark.long
def test_a_world_is_run_compared_and_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    few = ["--worlds", "1", "--seed", "500", "--max-steps", "4"]
    calibration.main([*few, "--svg", str(tmp_path / "b.svg"), "--runs", str(tmp_path / "runs")])
    assert "`kind/3`" in capsys.readouterr().out and (tmp_path / "b.svg").read_text().startswith("<svg")
    (line,) = (tmp_path / "runs").read_text().splitlines()
    assert json.loads(line)["world"] == "own_plain:3:500"
    calibration.main([*few, "--runs", str(tmp_path / "runs")])  # what was run is not run again
    assert (tmp_path / "runs").read_text().splitlines() == [line] and "`kind/3`" in capsys.readouterr().out
    once, again = tmp_path / "once", tmp_path / "again"
    few += ["--samples", str(tmp_path / "samples")]
    for folder, more in ((once, []), (again, ["--recount"])):
        folder.mkdir()
        assert priors.main([*few, *more, "--to", str(folder)]) == 0
    assert {file.name: file.read_text() for file in once.iterdir()} == {f.name: f.read_text() for f in again.iterdir()}
    counted = (
        ("priors_of_places", "counted_chance("),
        ("priors", "counted_solid("),
        ("priors_of_whereabouts", "counted_plug("),
    )
    assert all(predicate in (once / f"{name}.lp").read_text() for name, predicate in counted)
