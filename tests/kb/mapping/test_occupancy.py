"""Settled squares are true, follow from the counts, and do not depend on the order of impressions."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.eyes import Occupied, random_room, retina, world_of
from utak.geometry.counts.retina import OWN_FIELD
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap
from utak.kb.perception.frame import MAX_SAMPLED_SQUARES, Frame, Samples
from utak.kb.perception.retina import count_ranges

seeds = st.integers(0, 2**32 - 1)


def observe(occupancy: OccupancyMap, occupied: Occupied, square: tuple[int, int], number: int) -> None:
    """Add one impression without rotation; the map frame is the table frame."""
    occupancy.observe(Frame(0).samples(), count_ranges(retina(occupied, square)), *square, number)


def settled(occupancy: OccupancyMap) -> dict[tuple[int, int], int]:
    """Return the settled squares (x, y) and their states."""
    rows, columns = np.nonzero(occupancy.state != OPEN)
    return {
        (c + occupancy.west, r + occupancy.south): int(occupancy.state[r, c])
        for r, c in zip(rows.tolist(), columns.tolist(), strict=True)
    }


def free_squares(rows: list[str], rng: np.random.Generator, count: int) -> list[tuple[int, int]]:
    """Return random free squares of a drawing."""
    squares = [(i, len(rows) - 1 - n) for n, row in enumerate(rows) for i, mark in enumerate(row) if mark == "."]
    return [squares[k] for k in rng.integers(len(squares), size=count)]


@settings(max_examples=12, deadline=None)
@given(seeds)
def test_settled_squares_are_true(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = random_room(rng, *rng.integers(8, 40, 2), things=rng.integers(0, 9))
    occupied, occupancy = world_of(rows), OccupancyMap()
    for number, square in enumerate(free_squares(rows, rng, 4)):
        observe(occupancy, occupied, square, number)
        occupancy.stand(*square, number)
        found = settled(occupancy)
        assert len(found) >= 63
        assert all(occupied(*s) == (state == OCCUPIED) for s, state in found.items())
    assert occupancy.overruled == 0


def tiny(fields: list[list[int]], weights: list[list[int]], slack: list[int]) -> Samples:
    """Return fields over a few squares in a row, padded like those of the retina."""
    columns = np.zeros((len(fields), MAX_SAMPLED_SQUARES), np.int32)
    weight = np.zeros((len(fields), MAX_SAMPLED_SQUARES), np.int16)
    for n, (squares, times) in enumerate(zip(fields, weights, strict=True)):
        columns[n, : len(squares)], weight[n, : len(squares)] = squares, times
    return Samples(columns, np.zeros_like(columns), weight, np.array(slack, np.int16))


@st.composite
def tiny_cases(draw):
    """Draw fields over at most seven squares, count ranges that the truth fulfils, and the truth."""
    many = draw(st.integers(2, 7))
    truth = np.array(draw(st.lists(st.booleans(), min_size=many, max_size=many)))
    fields = draw(st.lists(st.sets(st.integers(0, many - 1), min_size=1).map(sorted), min_size=1, max_size=6))
    weights = [[draw(st.sampled_from([1, 1, 1, 2])) for _ in squares] for squares in fields]
    slack = [draw(st.sampled_from([0, 0, 0, 1])) for _ in fields]
    ranges = []
    for squares, times, loose in zip(fields, weights, slack, strict=True):
        count = int((truth[squares] * np.array(times)).sum()) + draw(st.integers(0, loose))
        low, high = count - draw(st.integers(0, 1)), count + draw(st.integers(0, 1))
        ranges.append((max(low, 0), min(high, sum(times) + loose)))
    return many, fields, weights, slack, ranges


def consistent(case) -> list[tuple[int, ...]]:
    """Return all occupancies that every field allows: samples between two squares may be occupied or not."""
    many, fields, weights, slack, ranges = case
    answer = []
    for world in product((0, 1), repeat=many):
        for squares, times, loose, (low, high) in zip(fields, weights, slack, ranges, strict=True):
            count = sum(world[s] * t for s, t in zip(squares, times, strict=True))
            if not low - loose <= count <= high:
                break
        else:
            answer.append(world)
    return answer


@pytest.mark.long
@settings(max_examples=300, deadline=None)
@given(tiny_cases())
def test_settled_squares_follow_from_the_counts(case) -> None:
    _, fields, weights, slack, ranges = case
    occupancy = OccupancyMap()
    occupancy.observe(tiny(fields, weights, slack), np.array(ranges, np.int16), 0, 0, 0)
    worlds = consistent(case)
    assert worlds
    for (x, _), state in settled(occupancy).items():
        assert {world[x] for world in worlds} == {state}


@pytest.mark.long
def test_single_fields_and_full_counts_settle() -> None:
    occupancy = OccupancyMap()
    occupancy.observe(
        tiny([[0], [1, 2], [3, 4]], [[1], [1, 1], [1, 1]], [0] * 3), np.array([(1, 1), (0, 0), (2, 2)]), 0, 0, 0
    )
    assert settled(occupancy) == {(0, 0): OCCUPIED, (1, 0): FREE, (2, 0): FREE, (3, 0): OCCUPIED, (4, 0): OCCUPIED}


@pytest.mark.long
def test_the_difference_of_two_fields_settles() -> None:
    occupancy = OccupancyMap()
    occupancy.observe(tiny([[0, 1], [1, 2]], [[1, 1]] * 2, [0, 0]), np.array([(1, 1), (1, 1)]), 0, 0, 0)
    assert settled(occupancy) == {}
    occupancy.observe(tiny([[0, 1, 2]], [[1, 1, 1]], [0]), np.array([(2, 2)]), 0, 0, 1)
    assert settled(occupancy) == {(0, 0): OCCUPIED, (1, 0): FREE, (2, 0): OCCUPIED}


@pytest.mark.long
def test_samples_between_two_squares_settle_nothing() -> None:
    occupancy = OccupancyMap()
    occupancy.observe(tiny([[0, 1]], [[1, 1]], [1]), np.array([(2, 2)]), 0, 0, 0)
    assert settled(occupancy) == {}


@settings(max_examples=10, deadline=None)
@given(seeds, st.permutations(range(4)))
def test_the_order_of_impressions_hardly_matters(seed: int, order: list[int]) -> None:
    rng = np.random.default_rng(seed)
    rows = random_room(rng, *rng.integers(10, 30, 2), things=6)
    occupied, squares = world_of(rows), free_squares(rows, rng, 4)
    one, other = OccupancyMap(), OccupancyMap()
    for n in range(4):
        observe(one, occupied, squares[n], n)
        observe(other, occupied, squares[order[n]], n)
    mine, others = settled(one), settled(other)
    assert all(mine[s] == others[s] for s in mine.keys() & others.keys())
    assert len(mine.keys() ^ others.keys()) <= 0.02 * len(mine)  # old fields are not compared with each other again


@settings(max_examples=15, deadline=None)
@given(st.integers(-300, 300), st.integers(-300, 300))
def test_growing_keeps_everything(x: int, y: int) -> None:
    rows = random_room(np.random.default_rng(7), 20, 20, things=5)
    occupied, occupancy = world_of(rows), OccupancyMap()
    observe(occupancy, occupied, (9, 9), 0)
    before, view = settled(occupancy), occupancy.view()
    known = dict.fromkeys(before, 0)
    observe(occupancy, occupied, (x, y), 1)
    after, larger = settled(occupancy), occupancy.view()
    assert before.items() <= after.items()
    row, column = view.south - larger.south, view.west - larger.west
    part = larger.seen[row : row + view.seen.shape[0], column : column + view.seen.shape[1]]
    assert part[view.seen].all()
    for sx, sy in known:
        assert occupancy.settled_by[occupancy.index(sx, sy)] == 0


def test_the_view_locates_squares_of_the_map_frame() -> None:
    occupied, occupancy = world_of(random_room(np.random.default_rng(3), 12, 9, things=2)), OccupancyMap()
    observe(occupancy, occupied, (4, 4), 0)
    view = occupancy.view()
    for (x, y), state in settled(occupancy).items():
        row, column = view.locate(x + 0.5, y + 0.5)
        assert view.state[row, column] == state
        assert view.probability[row, column] == state
        assert view.seen[row, column]
    assert (view.probability[~view.seen] == 0.5).all()
    assert ((view.probability >= 0) & (view.probability <= 1)).all()


def test_open_squares_are_as_likely_as_their_field_says() -> None:
    occupancy = OccupancyMap()
    occupancy.observe(tiny([[0, 1, 2, 3]], [[1] * 4], [0]), np.array([(1, 1)]), 0, 0, 0)
    view = occupancy.view()
    likely = [view.probability[view.locate(x, 0)] for x in range(4)]
    assert likely == pytest.approx([0.25] * 4, abs=0.02)


def test_only_false_impressions_contradict_the_map() -> None:
    rows = ["b" * 24, *["b" + "." * 22 + "b"] * 10, "b.......ggg............b", *["b" + "." * 22 + "b"] * 8, "b" * 24]
    occupied, occupancy = world_of(rows), OccupancyMap()
    samples = Frame(0).samples()
    observe(occupancy, occupied, (12, 8), 0)
    ranges = count_ranges(retina(occupied, (10, 6)))
    assert occupancy.clashes(samples, ranges, 10, 6) == 0
    assert not occupancy.misfits(samples, ranges, 10, 6).any()
    assert occupancy.clashes(samples, ranges, 11, 6) > 0
    wrong = occupancy.misfits(samples, ranges, 10, 8)
    assert wrong.any()
    assert not wrong[OWN_FIELD]


def test_a_new_impression_overrules_settled_squares() -> None:
    rows = ["b" * 24, *["b" + "." * 22 + "b"] * 18, "b" * 24]
    changed = [row[:12] + "gg" + row[14:] if n in (9, 10) else row for n, row in enumerate(rows)]
    occupancy = OccupancyMap()
    observe(occupancy, world_of(rows), (10, 9), 0)
    observe(occupancy, world_of(changed), (10, 9), 1)
    assert occupancy.overruled > 0
    for (x, y), state in settled(occupancy).items():
        assert world_of(changed)(x, y) == (state == OCCUPIED)


def test_the_same_impression_from_the_same_place_adds_nothing() -> None:
    rows = ["b" * 24, *["b" + "." * 22 + "b"] * 10, "b.......ggg............b", *["b" + "." * 22 + "b"] * 8, "b" * 24]
    occupied, occupancy = world_of(rows), OccupancyMap()
    for number, place in enumerate([(12, 8), (5, 5)]):
        observe(occupancy, occupied, place, number)
    before = occupancy.view()
    observe(occupancy, occupied, (12, 8), 2)
    after = occupancy.view()
    assert all(np.array_equal(a, b) for a, b in zip(before.counts, after.counts, strict=True))
    assert np.array_equal(before.probability, after.probability)
    assert np.array_equal(before.settled_by, after.settled_by)


def test_after_a_withdrawal_the_same_impression_counts_again() -> None:
    occupancy = OccupancyMap()
    counts = tiny([[0], [1, 2]], [[1], [1, 1]], [0] * 2), np.array([(1, 1), (0, 0)])
    occupancy.observe(*counts, 0, 0, 0)
    occupancy.withdraw(
        np.array([occupancy.index(1, 0)[0] * occupancy.state.shape[1] + occupancy.index(1, 0)[1]], np.int32)
    )
    assert (1, 0) not in settled(occupancy)
    occupancy.observe(*counts, 0, 0, 1)
    assert settled(occupancy) == {(0, 0): OCCUPIED, (1, 0): FREE, (2, 0): FREE}


def test_withdrawn_squares_are_open_and_their_fields_forgotten() -> None:
    occupancy = OccupancyMap()
    fields = tiny([[0], [0, 1, 2], [2, 3]], [[1], [1] * 3, [1] * 2], [0] * 3)
    occupancy.observe(fields, np.array([(1, 1), (2, 2), (1, 1)]), 0, 0, 0)
    row, column = occupancy.index(1, 0)
    occupancy.withdraw(np.array([row * occupancy.state.shape[1] + column], np.int32))
    occupancy.observe(tiny([[1]], [[1]], [0]), np.array([(0, 0)]), 0, 0, 1)
    assert settled(occupancy) == {(0, 0): OCCUPIED, (1, 0): FREE}  # the field of three would have filled square 2


def test_standing_does_not_overrule_and_declaring_does() -> None:
    occupied, occupancy = world_of(["....", ".gg.", ".gg.", "...."]), OccupancyMap()
    observe(occupancy, occupied, (0, 0), 0)
    occupancy.stand(1, 1, 1)
    occupancy.stand(0, 0, 1)
    assert settled(occupancy)[1, 1] == OCCUPIED
    assert settled(occupancy)[0, 0] == FREE
    mask = np.zeros(occupancy.state.shape, bool)
    mask[occupancy.index(1, 1)] = True
    occupancy.declare(mask, FREE, 2)
    assert settled(occupancy)[1, 1] == FREE
    assert occupancy.settled_by[occupancy.index(1, 1)] == 2


def test_what_a_thing_leaves_is_open_where_another_thing_may_reach_in() -> None:
    occupied, occupancy = world_of(["......", ".gghh.", ".gghh.", "......"]), OccupancyMap()
    observe(occupancy, occupied, (0, 0), 0)
    lay, now = ((west, 1, np.ones((2, 2), bool)) for west in (1, 0))
    occupancy.declare_patch(lay, FREE, 0)
    occupancy.uncover(lay, now, 0)
    assert {square: settled(occupancy).get(square, OPEN) for square in [(1, 1), (1, 2), (2, 1), (2, 2)]} == {
        (1, 1): FREE,
        (1, 2): FREE,
        (2, 1): OPEN,
        (2, 2): OPEN,
    }
    observe(occupancy, world_of(["......", "..hhh.", "..hhh.", "......"]), (0, 0), 1)  # they shared a column
    assert not occupancy.overruled
    assert settled(occupancy)[2, 1] == settled(occupancy)[2, 2] == OCCUPIED
    occupancy.uncover(lay, now, 0)  # what was seen since stays so
    assert settled(occupancy)[2, 1] == OCCUPIED
