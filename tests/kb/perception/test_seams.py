"""Where one thing ends and another begins in a region is found by the colours that are felt."""

from itertools import count

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from utak.geometry.raster.components import components
from utak.kb.perception.regions import map_regions
from utak.kb.perception.seams import cornered_parts, part_by_colour, part_mixed_regions

Mask = NDArray[np.bool_]
Marks = NDArray[np.str_]
Felt = dict[tuple[int, int], str]
WIDE, HIGH = 18, 16


def marks_of(rows: list[str]) -> Marks:
    """Return a drawing as an array, row 0 in the south; `.` is floor."""
    return np.array([list(row) for row in reversed(rows)])


def rim(marks: Marks) -> Felt:
    """Return all colours that can be felt from the floor: of squares with floor among the eight about them."""
    found: Felt = {}
    for row, column in np.argwhere(marks != ".").tolist():
        about = marks[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
        if (about == ".").any():
            found[row, column] = str(marks[row, column])
    return found


@st.composite
def neighbours(draw: st.DrawFn) -> Marks:
    """Draw two rectangles that share a part of an upright edge, somewhere on the floor."""
    marks = np.full((HIGH, WIDE), ".")
    edge, row = draw(st.integers(4, WIDE - 5)), draw(st.integers(3, 6))
    high, wide = draw(st.integers(1, 5)), draw(st.integers(2, 3))
    other_high, other_wide = draw(st.integers(1, 5)), draw(st.integers(2, 3))
    other_row = draw(st.integers(max(1, row - other_high + 1), row + high - 1))
    marks[row : row + high, edge - wide : edge] = "c"
    marks[other_row : other_row + other_high, edge : edge + other_wide] = draw(st.sampled_from("bd"))
    return marks if draw(st.booleans()) else np.ascontiguousarray(marks.T)


@given(neighbours())
@settings(max_examples=100, deadline=None)
def test_two_things_part_where_their_colours_say_so(marks: Marks) -> None:
    parting = part_by_colour(marks != ".", rim(marks))
    drawn = {tuple(map(tuple, np.argwhere(marks == colour).tolist())) for colour in set(marks.ravel()) - {"."}}
    assert {tuple(map(tuple, np.argwhere(part).tolist())) for part in parting.parts} == drawn
    assert not parting.unsettled


@given(neighbours(), st.randoms(use_true_random=False))
@settings(max_examples=60, deadline=None)
def test_feeling_what_is_unsettled_leads_to_the_seam(marks: Marks, random: object) -> None:
    """From one square of each thing on, what is felt beside an unsettled seam parts the two things rightly at last."""
    all_felt = rim(marks)
    felt: Felt = {}
    for colour in sorted(set(marks.ravel()) - {"."}):
        squares = sorted(place for place, other in all_felt.items() if other == colour)
        place = random.choice(squares)  # type: ignore[attr-defined]
        felt[place] = colour
    parts, felt = felt_on(marks, felt)
    for part in parts:
        assert len({colour for place, colour in felt.items() if part[place]}) == 1


def felt_on(marks: Marks, felt: Felt) -> tuple[tuple[NDArray[np.bool_], ...], Felt]:
    """Feel beside seams until all are settled; return the parts then, and all that was felt."""
    all_felt = rim(marks)
    for halt in count():
        assert halt < 8  # each halt at least halves what is left, and there are at most ten squares in a row
        parting = part_by_colour(marks != ".", felt)
        if not parting.unsettled:
            return parting.parts, felt
        row, column = np.argwhere(parting.unsettled[0])[0].tolist()
        near = [place for place in all_felt if max(abs(place[0] - row), abs(place[1] - column)) <= 1]
        felt = felt | {place: all_felt[place] for place in near}
    raise AssertionError


def test_an_inner_corner_may_be_that_of_one_thing() -> None:
    """Felt at its end alone, the lower arm of an L looks like a thing of its own."""
    marks = marks_of([".....ll....", ".....ll....", ".ccccllll..", ".ccccllll..", "..........."])
    felt = {(1, 4): "c", (1, 8): "l"}
    assert not any(np.array_equal(part, marks == "l") for part in part_by_colour(marks != ".", felt).parts)
    assert any(np.array_equal(part, marks == "l") for part in felt_on(marks, felt)[0])


def test_without_a_second_colour_nothing_is_parted() -> None:
    region = marks_of(["ccc...", "ccc..."]) == "c"
    (part,) = part_by_colour(region, {(0, 0): "c", (1, 2): "c"}).parts
    assert np.array_equal(part, region)
    (part,) = part_by_colour(region, {}).parts
    assert np.array_equal(part, region)


def test_a_thing_that_closes_a_ring_of_wall_is_parted_by_two_seams() -> None:
    marks = marks_of([".......", ".bbbbb.", ".b...b.", ".b...c.", ".b...b.", ".bbbbb.", "......."])
    felt = {(3, 5): "c", (2, 5): "b", (4, 5): "b"}
    parts = part_by_colour(marks != ".", felt).parts
    assert any(np.array_equal(part, marks == "c") for part in parts)


def test_what_cannot_be_parted_with_few_cuts_stays_one_region() -> None:
    """Colours that change from square to square would take more cuts than are made."""
    region = np.ones((3, 40), np.bool_)
    felt: Felt = {(0, x): "cd"[x % 2] for x in range(40)}
    assert sum(int(part.sum()) for part in part_by_colour(region, felt).parts) == region.sum()


@given(neighbours())
@settings(max_examples=40, deadline=None)
def test_parted_regions_of_the_map_are_regions_of_their_own(marks: Marks) -> None:
    solid = np.pad(marks != ".", 1, constant_values=True)
    felt = {(row + 1, column + 1): colour for (row, column), colour in rim(marks).items()}
    percept, labels = map_regions(solid, np.ones_like(solid), np.ones_like(solid))
    new, parted, unsettled = part_mixed_regions(percept, labels, felt, np.ones_like(solid), solid.astype(np.float32))
    assert not unsettled
    assert len(new.regions) == len(percept.regions) + 1
    assert np.array_equal(parted > 0, labels > 0)
    for region in new.regions:
        squares = parted == int(region.name.removeprefix("part"))
        assert components(squares).number == 1
        if region.occupied:
            assert region.mass == 10 * squares.sum()
            assert len({felt[place] for place in felt if squares[place]}) <= 1
    inner = {inner for _, inner in percept.surrounds if inner not in {one.name for one in percept.regions if one.rim}}
    assert {name for _, name in new.surrounds} >= inner
    things = [region.name for region in new.regions if region.occupied and not region.rim]
    assert len({frozenset(outer for outer, name in new.surrounds if name == thing) for thing in things}) == 1


def test_a_region_of_one_colour_and_the_verge_stay_as_they_are() -> None:
    solid = np.pad(marks_of([".....", ".cc..", "....."]) != ".", 1, constant_values=True)
    percept, labels = map_regions(solid, np.ones_like(solid), np.ones_like(solid))
    felt = {(2, 2): "c", (0, 0): "b", (0, 3): "d"}  # the outer verge is not parted here: what leans on it sticks out
    new, parted, _ = part_mixed_regions(percept, labels, felt, np.ones_like(solid), solid.astype(np.float32))
    assert new == percept
    assert np.array_equal(parted, labels)


PLUG = marks_of(
    [
        "bbbbbbbbbbbbbb",
        "b............b",
        "b.....bbbbbbbb",
        "b.....cccbb..b",
        "b.....cccbb..b",
        "b.....cccbb..b",
        "b.....ccc....b",
        "b.....cccbb..b",
        "b.....cccbb..b",
        "b.....bbbbbbbb",
        "b............b",
        "bbbbbbbbbbbbbb",
    ]
)


def test_a_thing_that_leans_on_a_wall_with_a_long_side_is_parted_along_inner_corners() -> None:
    rows = marks_of(
        [
            "bbbbbbbbbb",
            "b........b",
            "b.....bb.b",
            *["b...ccbb.b"] * 12,
            "b...cc...b",
            *["b...ccbb.b"] * 2,
            "b.....bb.b",
            "b........b",
            "bbbbbbbbbb",
        ]
    )
    (thing,) = cornered_parts(rows != ".", {(5, 4): "c"})
    assert np.array_equal(thing, rows == "c")


def test_what_lies_in_no_corner_is_left_with_the_wall() -> None:
    """The thing of PLUG meets walls at its ends without an inner corner, so it is one with the wall there."""
    (part,) = cornered_parts(PLUG != ".", {(5, 6): "c"})
    assert (part & (PLUG == "b")).any()
