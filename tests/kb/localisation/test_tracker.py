"""The tracker: how an impression that differs from the predicted one is explained, and what is believed then."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.affinity import rotate, translate

from tests.kb.drawings import LARGE_ROOM, walked
from tests.kb.eyes import Occupied, impression, random_room, utak_in, world_of
from tests.kb.localisation.hypotheses.test_remap import around
from utak.kb.body import Move, Push, Turn
from utak.kb.localisation.field_account import CellStatus
from utak.kb.localisation.hypotheses.correction import WalkCorrection
from utak.kb.localisation.hypotheses.explanation import Explanation, cheapest
from utak.kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES, KEPT_ODDS, Hypothesis
from utak.kb.localisation.tracker import Tracker
from utak.kb.mapping.occupancy import FREE, OPEN
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.frame import CENTRE, Frame, turned

ROOM = [
    "b" * 30,
    *["b" + "." * 28 + "b"] * 6,
    *["b" + "." * 6 + "gggg" + "." * 18 + "b"] * 2,
    *["b" + "." * 28 + "b"] * 5,
    "b" + "." * 12 + "U" + "." * 15 + "b",
    *["b" + "." * 28 + "b"] * 6,
    "b" * 30,
]


def test_exact_moves_are_predicted() -> None:
    walk = walked(ROOM, [(2, 0), (0, 3), (-4, 1)])
    assert walk.poses == ("predicted",) * 4
    assert walk.model.place == pytest.approx((-1.5, 4.5))


def test_new_fields_are_explained_and_old_ones_predicted() -> None:
    tracker, occupied, square = Tracker(), world_of(ROOM), utak_in(ROOM)
    first = tracker.wake(impression(occupied, square))
    assert set(first.fields.status) <= {CellStatus.EXPLAINED, CellStatus.PREDICTED}
    again = tracker.accommodate(Move(0.0, 0.0), impression(occupied, square))
    assert CellStatus.NOISE not in again.fields.status
    fovea = again.fields.status[:64]
    assert set(fovea) == {CellStatus.PREDICTED}


def test_a_blocked_walk_is_recognised() -> None:
    walk = walked(ROOM, [(2, 0), (0, 3)])
    x, y = utak_in(ROOM)
    tracker, occupied = walk.knowledge.tracker, world_of(ROOM)
    found = tracker.accommodate(Move(0.0, -9.0), impression(occupied, (x + 2, y - 3)))  # blocked after 6 of 9
    assert found.explanation.how == "blocked"
    assert tracker.state.place == pytest.approx((2.5, -3.0), abs=1e-5)
    assert (2, -4) in tracker.state.blocked_squares


def test_settled_floor_blocks_no_walk() -> None:
    walk = walked(ROOM, [(2, 0), (0, 3)])
    x, y = utak_in(ROOM)
    tracker = walk.knowledge.tracker
    found = tracker.accommodate(Move(-4.0, 0.0), impression(world_of(ROOM), (x, y + 3)))  # 2 of 4
    assert found.explanation.how == "slipped"
    assert tracker.state.place == pytest.approx((0.5, 3.5))
    assert not tracker.state.blocked_squares


@pytest.mark.long
def test_a_slip_is_recognised_after_earlier_slips() -> None:
    walk = walked(ROOM, [(2, 0), (0, 3), (1, 0), (0, 1), (-1, 0), (0, -1)])
    x, y = utak_in(ROOM)
    tracker = walk.knowledge.tracker
    tracker.state = replace(tracker.state, slipped=True)
    found = tracker.accommodate(Move(-3.0, 0.0), impression(world_of(ROOM), (x - 1, y + 4)))
    assert found.explanation.how == "slipped"
    assert tracker.state.place == pytest.approx((-0.5, 4.5))


@pytest.mark.long
def test_another_orientation_of_the_frame_is_recognised() -> None:
    tracker, occupied, (x, y) = Tracker(), world_of(ROOM), utak_in(ROOM)
    hows = [tracker.wake(impression(occupied, (x, y), heading=30)).explanation.how]
    for n in range(1, 7):  # north in Utak's own frame: 30 degrees from the table's north
        px, py = x + 0.5 - 0.5 * n, y + 0.5 + 0.8660254 * n
        hows.append(
            tracker.accommodate(Move(0.0, 1.0), impression(occupied, (int(px), int(py)), heading=30)).explanation.how
        )
    assert "turned" in hows
    assert abs(tracker.state.frame.angle - 30) <= 8
    assert tracker.state.occupancy.overruled == 0


@pytest.mark.long
def test_a_contact_and_an_unknown_orientation_are_found_together() -> None:
    far, off = [], []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        occupied, heading = world_of(random_room(rng, 36, 36, 16)), int(rng.integers(-44, 46))
        free = [(i, j) for i in range(8, 28) for j in range(8, 28) if not occupied(i, j)]
        x, y = free[int(rng.integers(len(free)))]
        angle = rng.uniform(0, 2 * math.pi)
        way, middle = (9 * math.cos(angle), 9 * math.sin(angle)), (x + 0.5, y + 0.5)
        tracker = Tracker()
        tracker.wake(impression(occupied, (x, y), heading))
        stop = first_contact(occupied, middle, way, heading)
        seen = impression(occupied, (math.floor(stop[0]), math.floor(stop[1])), heading)
        tracker.accommodate(Move(*way), seen)
        walked = math.dist(tracker.state.frame.place_to_utak(*tracker.state.place), (0, 0))
        if math.dist(stop, middle) < 9 - 0.3:
            off.append(abs(tracker.state.frame.angle - heading))
            far.append(abs(walked - math.dist(stop, middle)))
    assert len(far) >= 9
    assert sum(angle <= 1 for angle in off) >= 0.9 * len(off)
    assert sum(squares <= 0.3 for squares in far) >= 0.75 * len(far)


@pytest.mark.long
def test_later_observations_tell_where_a_walk_was_blocked() -> None:
    """After a contact in an unknown frame one observation may fit more than one place."""
    walks = [walk for walk in (errors_after_a_contact(seed, True) for seed in range(24)) if walk is not None]
    assert len(walks) >= 12
    assert sum(at_once < 0.1 for at_once, *_ in walks) >= 0.7 * len(walks)
    assert sum(then < 0.1 for _, then, _ in walks) >= 0.9 * len(walks)
    assert all(then < 0.1 and later < 0.1 for at_once, then, later in walks if at_once < 0.1)  # right stays right


@pytest.mark.long
@pytest.mark.parametrize("seed", [1047, 1096, 1098, 1147, 1161])
def test_a_wrong_end_of_a_walk_is_corrected_by_later_observations(seed: int) -> None:
    """A contact was overlooked, or placed too far on; without re-estimation of motions the place stays wrong."""
    remembered, forgotten = errors_after_a_contact(seed, True), errors_after_a_contact(seed, False)
    assert remembered is not None and forgotten is not None
    assert min(remembered[0], *forgotten) > 0.1
    assert remembered[-1] < 0.1


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("other", [Frame(0, (0.97, 0.97)), Frame(7)])
def test_a_contact_with_something_known_is_preferred_to_another_frame(known: bool, other: Frame) -> None:
    """Something known stands just where an earlier motion would have been blocked, and all observations agree then."""
    told = WalkCorrection(1, (0.5, -0.5))
    explanations = [
        Explanation("predicted", (9.5, 0.5), Frame(), 6, 0.0),
        Explanation("turned", (9.5, 0.5), other, 0, 0.0),
        Explanation("misled", (10.0, 0.0), Frame(), 0, 0.7, correction=told, contact_known=known),
    ]
    numbers = [number for number, one in enumerate(explanations) if one.contact_known and one.frame == Frame()]
    chosen = cheapest(explanations, ["trust(3)", *(f"met({number})" for number in numbers)])
    assert chosen.how == ("misled" if known else "turned")


def errors_after_a_contact(seed: int, remember: bool) -> list[float] | None:
    """Return the error of the believed place in squares: after a contact, and after each of two free moves.

    None when nothing blocks any walk there. remember : whether earlier motions may be re-estimated.
    """
    rng = np.random.default_rng(seed)
    occupied, heading = world_of(random_room(rng, 30, 30, 14)), int(rng.choice([0, 0, *range(-44, 46)]))
    free = [(i, j) for i in range(6, 24) for j in range(6, 24) if not occupied(i, j)]
    here = origin = tuple(v + 0.5 for v in free[int(rng.integers(len(free)))])
    tracker, off = Tracker(), []
    tracker.wake(impression(occupied, (math.floor(here[0]), math.floor(here[1])), heading))
    for far in (12, 6, 6):
        for angle in rng.uniform(0, 2 * math.pi, 30):
            way = (far * math.cos(angle), far * math.sin(angle))
            end = first_contact(occupied, here, way, heading)
            if (math.dist(end, here) < far - 1e-2) == (far == 12):
                break
        else:
            return None
        here = end
        if not remember:
            tracker.state = replace(tracker.state, motions=())
        tracker.accommodate(Move(*way), impression(occupied, (math.floor(here[0]), math.floor(here[1])), heading))
        assert all(end.prior_cost <= KEPT_ODDS for end in tracker.state.ends)
        own = turned(here[0] - origin[0], here[1] - origin[1], -heading)
        off.append(math.dist(tracker.state.frame.place_to_utak(*tracker.state.place), own))
    return off


def first_contact(
    occupied: Occupied, start: tuple[float, float], way: tuple[float, float], heading: float
) -> tuple[float, float]:
    """Return where a walk is blocked, table frame. way : in Utak's own frame. heading : of that frame, degrees."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    ahead = way[0] * c - way[1] * s, way[0] * s + way[1] * c
    for part in np.linspace(0, 1, 8001)[1:]:
        x, y = start[0] + part * ahead[0], start[1] + part * ahead[1]
        if occupied(math.floor(x), math.floor(y)) or occupied(math.ceil(x) - 1, math.ceil(y) - 1):
            return x, y
    return start[0] + ahead[0], start[1] + ahead[1]


def test_the_square_beyond_a_contact_is_not_taken_for_floor() -> None:
    tracker, occupied, (x, y) = Tracker(), world_of(ROOM), utak_in(ROOM)
    tracker.wake(impression(occupied, (x, y)))
    wall = len(ROOM[0]) - 1
    tracker.accommodate(Move(wall - x, 0.0), impression(occupied, (wall, y)))  # blocked as it was touched
    assert tracker.state.place == pytest.approx((wall - x, 0.5), abs=1e-5)
    assert tracker.state.place[0] < wall - x
    assert tracker.state.occupancy.state[tracker.state.occupancy.index(wall - x, 0)] != FREE
    assert tracker.state.occupancy.state[tracker.state.occupancy.index(0, 0)] == FREE


def test_a_turn_does_not_move_utak() -> None:
    tracker, occupied, square = Tracker(), world_of(ROOM), utak_in(ROOM)
    tracker.wake(impression(occupied, square))
    found = tracker.accommodate(Turn(90.0), impression(occupied, square))
    assert found.explanation.how == "predicted"
    assert tracker.state.place == CENTRE


ELL = shapely.Polygon([(0, 0), (5, 0), (5, 2), (2, 2), (2, 5), (0, 5)])
PLAIN = world_of(LARGE_ROOM)


def holding(thing: shapely.Polygon, place: tuple[float, float], room: Occupied = PLAIN) -> Tracker:
    """Return a tracker that has just grasped an object at the place of waking. thing, place : table frame."""
    tracker, square = Tracker(), (math.floor(place[0]), math.floor(place[1]))
    tracker.wake(impression(around(thing, room), square))
    lies = translate(thing, -square[0], -square[1])
    tracker.grasp(HeldObject("o1", lies, lies, proven=True))
    return tracker


@pytest.mark.long
@pytest.mark.parametrize("place", [(20.85, 20.05), (20.2, 20.6), (20.4, 20.1)])
def test_a_turned_object_tells_the_origin_of_the_frame(place: tuple[float, float]) -> None:
    thing = translate(ELL, 21, 18)
    tracker = holding(thing, place)
    after = rotate(thing, 90, origin=place)
    found = tracker.accommodate(Turn(90.0), impression(around(after, PLAIN), (20, 20)))
    assert found.explanation.how == "turned"
    assert tracker.state.place == tracker.state.frame.origin
    assert math.dist(tracker.state.frame.origin, (place[0] - 20, place[1] - 20)) < math.dist(
        CENTRE, (place[0] - 20, place[1] - 20)
    )
    held = tracker.state.held_objects["o1"]
    true = translate(after, -20, -20)
    assert held.polygon.hausdorff_distance(true) <= held.play + 0.2
    assert not tracker.state.sure
    back = tracker.accommodate(Turn(-90.0), impression(around(thing, PLAIN), (20, 20)))
    assert back.explanation.residual == 0
    assert tracker.state.held_objects["o1"].polygon.hausdorff_distance(translate(thing, -20, -20)) < 1e-6
    assert tracker.state.held_objects["o1"].play == 0


def test_an_unchanged_impression_after_a_push_means_that_nothing_moved() -> None:
    thing = translate(ELL, 38, 18)  # against the wall already
    tracker = holding(thing, (37.5, 20.5))
    # how the frame lies is known:
    tracker.state = replace(tracker.state, hypotheses=(Hypothesis(0, CENTRE + CENTRE),), confirmations=20)
    found = tracker.accommodate(Push(1.0, 0.0), impression(around(thing, PLAIN), (37, 20)))
    assert found.explanation.outcome is not None and found.explanation.outcome.stopped
    assert tracker.state.place == CENTRE
    assert tracker.state.held_objects["o1"].polygon.equals(translate(thing, -37, -20))
    assert tracker.state.held_objects["o1"].resisted == ("east",)


def test_a_turn_about_the_middle_of_the_square_leaves_the_origin_there() -> None:
    thing = translate(ELL, 21, 18)
    tracker = holding(thing, (20.5, 20.5))
    found = tracker.accommodate(Turn(90.0), impression(around(rotate(thing, 90, origin=(20.5, 20.5)), PLAIN), (20, 20)))
    assert found.explanation.how == "predicted"
    assert tracker.state.frame.origin == CENTRE
    assert tracker.state.held_objects["o1"].play == 0


def test_an_observation_beside_the_middle_tells_the_origin() -> None:
    room = world_of(ROOM)
    x, y = utak_in(ROOM)
    truly = (x + 0.8, y + 0.3)
    tracker = Tracker()
    tracker.wake(impression(room, (x, y)))
    now = truly
    for east, north in ((0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (0.46, 3.46)):
        now = (now[0] + east, now[1] + north)
        tracker.accommodate(Move(east, north), impression(room, (math.floor(now[0]), math.floor(now[1]))))
    assert tracker.state.frame.angle == 0
    assert tracker.state.frame.origin[0] > 0.5
    assert math.floor(tracker.state.place[0]) + x == math.floor(now[0])
    assert math.floor(tracker.state.place[1]) + y == math.floor(now[1])
    west, south, east, north = tracker.state.leeway
    assert west <= 0.8 - tracker.state.frame.origin[0] <= east
    assert south <= 0.3 - tracker.state.frame.origin[1] <= north


def test_an_unknown_contact_makes_the_squares_ahead_suspected() -> None:
    def posts(i: int, j: int) -> bool:
        return PLAIN(i, j) or (j == 16 and i % 7 == 0)

    thing = shapely.box(22, 18, 27, 21)
    tracker = holding(thing, (21.5, 19.5), posts)
    # how the frame lies is known:
    tracker.state = replace(tracker.state, hypotheses=CENTRED_HYPOTHESES[:1])
    row, column = tracker.state.occupancy.index(29 - 21, -1)
    tracker.state.occupancy.state[row - 3 : row + 6, column] = OPEN  # not seen closely
    stopped = translate(thing, 2, 0)  # of 6
    found = tracker.accommodate(Push(6.0, 0.0), impression(around(stopped, posts), (23, 19)))
    assert found.explanation.how == "blocked"
    assert tracker.state.suspected_squares
    assert {column for column, _ in tracker.state.suspected_squares} == {29 - 21}
    tracker.state.occupancy.state[tracker.state.occupancy.index(*min(tracker.state.suspected_squares))] = FREE
    assert min(tracker.state.suspected_squares) not in tracker.state.closed


@pytest.mark.long
@pytest.mark.parametrize(
    ("slips", "state", "about", "closed"),
    [
        (False, FREE, OPEN, True),
        (False, FREE, FREE, False),
        (False, OPEN, FREE, True),
        (True, FREE, OPEN, False),
        (True, OPEN, FREE, True),
    ],
)
def test_a_blocked_square_that_is_seen_to_be_free_is_open_again(
    slips: bool, state: int, about: int, closed: bool
) -> None:
    tracker = walked(ROOM, [(2, 0)]).knowledge.tracker
    tracker.state = replace(tracker.state, slipped=slips, blocked_squares=tracker.state.blocked_squares | {(3, 1)})
    row, column = tracker.state.occupancy.index(3, 1)
    tracker.state.occupancy.state[row - 1 : row + 2, column - 1 : column + 2] = about
    tracker.state.occupancy.state[row, column] = state
    assert ((3, 1) in tracker.state.closed) == closed
