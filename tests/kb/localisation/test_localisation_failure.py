"""Localisation failure: it is recognised, the map is given up, and the place is soon known again."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from tests.kb.drawings import walked
from tests.kb.eyes import impression, random_room, utak_in, world_of
from tests.kb.localisation.test_tracker import ROOM
from utak.kb.body import Impression, Move, Push, Release
from utak.kb.knowledge import Knowledge
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import Hypothesis
from utak.kb.localisation.known.state import MAX_RESIDUAL, MAX_RESIDUAL_AFTER_MOVING, TrackerState
from utak.kb.localisation.tracker import Tracker
from utak.kb.mapping.occupancy import OCCUPIED, OPEN
from utak.kb.mapping.patch import Patch
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.frame import Frame, turned
from utak.kb.task.task import Task
from utak.kb.world.object_names import ObjectNames
from utak.planner.agenda.decider import Decider

Point = tuple[float, float]


class Stroll:
    """A robot that walks over free squares of a random room."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.occupied = world_of(random_room(self.rng, 40, 40, 16))
        self.heading = int(self.rng.choice([0, 0, *range(-44, 46)]))
        self.free = [(i + 0.5, j + 0.5) for i in range(1, 39) for j in range(1, 39) if not self.occupied(i, j)]
        self.place: Point = self.free[int(self.rng.integers(len(self.free)))]
        self.knowledge = Knowledge()
        self.hows = [self.knowledge.wake(self.sees())[1].explanation.how]

    def sees(self) -> Impression:
        """Return the impression at the present place."""
        return impression(self.occupied, (math.floor(self.place[0]), math.floor(self.place[1])), self.heading)

    def go(self) -> None:
        """Walk four to six squares over free ones, and perceive."""
        while True:
            far, angle = self.rng.uniform(4, 6), self.rng.uniform(0, 2 * math.pi)
            way = far * math.cos(angle), far * math.sin(angle)
            east, north = turned(*way, self.heading)
            points = ((self.place[0] + east * t, self.place[1] + north * t) for t in np.linspace(0, 1, 200))
            if not any(self.occupied(math.floor(x), math.floor(y)) for x, y in points):
                break
        self.place = self.place[0] + east, self.place[1] + north
        self.hows.append(self.knowledge.perceive(Move(*way), self.sees())[1].explanation.how)

    def kidnap(self) -> None:
        """Put the robot down at least twelve squares away, without a command."""
        away = [place for place in self.free if math.dist(place, self.place) >= 12]
        self.place = away[int(self.rng.integers(len(away)))]

    @property
    def wrong(self) -> float:
        """Return the part of the settled squares that are settled wrongly, 0 to 1."""
        occupancy, (x, y) = self.knowledge.memory.occupancy, self.knowledge.memory.square
        i, j = math.floor(self.place[0]) - x, math.floor(self.place[1]) - y
        rows, columns = np.nonzero(occupancy.state != OPEN)
        squares = zip((columns + occupancy.west + i).tolist(), (rows + occupancy.south + j).tolist(), strict=True)
        there = np.array([self.occupied(*square) for square in squares])
        return float((there != (occupancy.state[rows, columns] == OCCUPIED)).mean())


def kidnapped(seed: int) -> Stroll:
    """Return a walk of four moves, a kidnapping, and eight moves more."""
    stroll = Stroll(seed)
    for _ in range(4):
        stroll.go()
    assert "lost" not in stroll.hows
    stroll.kidnap()
    for _ in range(8):
        stroll.go()
    return stroll


@pytest.mark.long
def test_a_kidnapped_robot_recognises_the_failure_and_maps_the_room_again() -> None:
    for seed in range(3):
        stroll = kidnapped(seed)
        assert {"lost", "lifted"} & {*stroll.hows[5:8]}, seed
        assert stroll.wrong == 0.0, seed
        # Looks from a map that was begun meanwhile are no part of the one that is recognised.
        assert len(stroll.knowledge.memory.track) <= len(stroll.hows)
        assert stroll.knowledge.memory.lifted_at or len(stroll.knowledge.memory.track) == len(stroll.hows)


@pytest.mark.long
def test_after_an_observation_that_agrees_with_nothing_a_new_map_is_begun() -> None:
    knowledge = walked(ROOM, [(2, 0), (0, 3)]).knowledge
    x, y = utak_in(ROOM)
    model, _ = knowledge.perceive(Release(), impression(world_of(ROOM), (x + 2, y + 3)))
    assert not model.contradicted and knowledge.memory.former is None
    shut_in = impression(lambda i, j: (i, j) != (0, 0), (0, 0))
    model, accommodated = knowledge.perceive(Release(), shut_in)
    assert accommodated.explanation.how == "lost"
    assert model.anew and knowledge.memory.former is not None


def lost_in(rows: list[str]) -> Knowledge:
    """Return the knowledge of a robot that walked a little, and whose last observations left large residuals."""
    knowledge = walked(rows, [(2, 0), (0, 3)]).knowledge
    knowledge.tracker.state = replace(knowledge.memory, residuals=(MAX_RESIDUAL, MAX_RESIDUAL))
    assert knowledge.memory.lost
    return knowledge


def test_the_residual_of_one_observation_alone_is_no_failure() -> None:
    state = TrackerState(residuals=(0, 0, 0, 3 * MAX_RESIDUAL))
    assert not state.lost
    assert not TrackerState(residuals=(1, 1, 1, 1)).lost
    assert TrackerState(residuals=(0, 1, 0, MAX_RESIDUAL)).lost


def test_moved_objects_raise_the_residual_of_a_failure() -> None:
    thing = shapely.box(4, 2, 8, 4)
    held, moved = HeldObject("o1", thing, thing), HeldObject("o1", thing, thing).moved(thing, 0.0)
    assert TrackerState(residuals=(1, MAX_RESIDUAL), held_objects={"o1": held}).lost
    assert not TrackerState(residuals=(1, MAX_RESIDUAL), held_objects={"o1": moved}).lost
    assert TrackerState(residuals=(1, MAX_RESIDUAL_AFTER_MOVING), held_objects={"o1": moved}).lost


@pytest.mark.long
def test_a_held_object_is_released_before_the_map_is_given_up() -> None:
    knowledge = lost_in(ROOM)
    x, y = utak_in(ROOM)
    thing = shapely.box(4, 2, 8, 4)
    knowledge.tracker.grasp(HeldObject("o1", thing, thing))
    sees = impression(world_of(ROOM), (x + 2, y + 3))
    model, accommodated = knowledge.wake(sees)
    held = replace(model, lost=True, held="o1")
    decision = Decider(Task({}, (), ())).decide(held, knowledge.memory.track)
    assert isinstance(decision.command, Release)
    knowledge.tracker.state = replace(knowledge.memory, residuals=(MAX_RESIDUAL, MAX_RESIDUAL))
    model, accommodated = knowledge.perceive(Release(), sees)
    assert accommodated.explanation.how == "slipped"  # what it sees is the map of before, which it recognises
    assert not model.anew and model.interrupted
    assert not model.lost
    assert not knowledge.memory.held_objects


@pytest.mark.long
def test_who_gets_lost_with_something_in_hand_puts_down_what_it_may_be() -> None:
    knowledge = walked(ROOM, [(2, 0), (0, 3)]).knowledge
    thing = shapely.box(4, 2, 8, 4)
    knowledge.tracker.grasp(HeldObject("o1", thing, thing))
    shut_in = impression(lambda i, j: (i, j) != (0, 0), (0, 0))
    model, accommodated = knowledge.perceive(Push(1.0, 0.0), shut_in)
    assert accommodated.explanation.how == "lost"
    assert model.held is None
    assert model.may_hold
    assert isinstance(Decider(Task({}, (), ())).decide(model, knowledge.memory.track).command, Release)
    model, _ = knowledge.perceive(Release(), shut_in)
    assert not model.may_hold


@pytest.mark.long
def test_in_another_frame_an_object_that_never_moved_is_forgotten() -> None:
    thing = shapely.box(-6, 5, -3, 8)  # nothing is there
    for moved, held in ((False, False), (True, False), (False, True)):
        tracker = walked(ROOM, [(2, 0), (0, 3)]).knowledge.tracker
        before = tracker.state.occupancy.state.copy()
        tracker.grasp(HeldObject("o1", thing, thing, proven=moved))
        tracker.state = replace(tracker.state, in_hand="o1" if held else None)
        tracker._apply(Explanation("predicted", tracker.state.place, tracker.state.frame, 0, 0.0))
        assert list(tracker.state.held_objects) == ["o1"]
        other = Frame(origin=(0.4, 0.6))  # with the same observations
        tracker._apply(
            Explanation("turned", tracker.state.place, other, 0, 0.0, None, (Hypothesis(0, other.origin * 2),))
        )
        assert tracker.state.frame == other
        assert list(tracker.state.held_objects) == ["o1"] * (moved or held)
        assert (tracker.state.occupancy.state == before).all() == (not moved and not held)


@pytest.mark.long
def test_a_new_beginning_keeps_the_track() -> None:
    knowledge = lost_in(ROOM)
    x, y = utak_in(ROOM)
    before = knowledge.memory.place
    model, _ = knowledge.perceive(Move(1.0, 0.0), impression(world_of(ROOM), (x + 3, y + 3)))
    assert model.anew
    assert knowledge.memory.looked_from == {knowledge.memory.square}
    assert len(knowledge.memory.hypotheses) > 40
    assert model.place == pytest.approx((before[0] + 1, before[1]))
    assert knowledge.memory.track[:3] == [(0.5, 0.5), (2.5, 0.5), (2.5, 3.5)]
    row, column = model.view.locate(0.5, 0.5)  # the place of waking is on the map, seen or not
    assert min(row, column) >= 24
    assert row + 24 < model.labels.shape[0]
    assert column + 24 < model.labels.shape[1]


@pytest.mark.long
def test_one_observation_tells_the_orientation_whatever_was_believed() -> None:
    off = []
    for seed in range(20):
        stroll = Stroll(seed)
        tracker = Tracker(TrackerState(frame=Frame((stroll.heading + 60) % 90 - 44))).anew()
        tracker.wake(stroll.sees())
        off.append(abs((tracker.state.frame.angle - stroll.heading + 45) % 90 - 45))
    assert sum(angle <= 2 for angle in off) >= 18


def test_names_of_objects_are_not_given_again() -> None:
    names, patch = ObjectNames(), Patch(0, 0, np.ones((2, 2), np.bool_))
    assert names.assign([patch]) == names.assign([patch]) == ["o1"]
    names.forget()
    assert names.assign([patch]) == ["o2"]
