"""Who is lost: he notices that nothing agrees with what he believes, forgets it, and knows where he is soon after."""

import math

import numpy as np
import pytest
import shapely

from kb.body import Impression, Move, Release, Turn
from kb.knowledge import Knowledge
from kb.localisation.accommodation import Memory
from kb.localisation.holding import ASTRAY, LOST
from kb.localisation.hypotheses.explanation import Explanation
from kb.localisation.hypotheses.frames import FrameHypothesis
from kb.mapping.occupancy import FULL, OPEN
from kb.mapping.patch import Patch
from kb.objects.held_object import HeldObject
from kb.perception.frame import Frame, turned
from kb.task.task import Task
from kb.world.object_names import ObjectNames
from planner.deciding.decider import Decider
from tests.kb.drawings import walked
from tests.kb.eyes import impression, random_room, utak_in, world_of
from tests.kb.localisation.test_accommodation import ROOM

Point = tuple[float, float]


class Stroll:
    """One who walks over free squares of a random room."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.occupied = world_of(random_room(self.rng, 40, 40, 16))
        self.heading = int(self.rng.choice([0, 0, *range(-44, 46)]))
        self.free = [(i + 0.5, j + 0.5) for i in range(1, 39) for j in range(1, 39) if not self.occupied(i, j)]
        self.place: Point = self.free[int(self.rng.integers(len(self.free)))]
        self.knowledge = Knowledge()
        self.hows = [self.knowledge.wake(self.sees())[1].explanation.how]

    def sees(self) -> Impression:
        """What he senses there."""
        return impression(self.occupied, (math.floor(self.place[0]), math.floor(self.place[1])), self.heading)

    def go(self) -> None:
        """Four to six squares, over free ones."""
        while True:
            far, angle = self.rng.uniform(4, 6), self.rng.uniform(0, 2 * math.pi)
            way = far * math.cos(angle), far * math.sin(angle)
            east, north = turned(*way, self.heading)
            points = ((self.place[0] + east * t, self.place[1] + north * t) for t in np.linspace(0, 1, 200))
            if not any(self.occupied(math.floor(x), math.floor(y)) for x, y in points):
                break
        self.place = self.place[0] + east, self.place[1] + north
        self.hows.append(self.knowledge.perceive(Move(*way), self.sees())[1].explanation.how)

    def carried_off(self) -> None:
        """Somebody puts him down at least twelve squares away, and does not tell him."""
        away = [place for place in self.free if math.dist(place, self.place) >= 12]
        self.place = away[int(self.rng.integers(len(away)))]

    @property
    def wrong(self) -> float:
        """The part of what he takes for settled that is otherwise."""
        occupancy, (x, y) = self.knowledge.memory.occupancy, self.knowledge.memory.square
        i, j = math.floor(self.place[0]) - x, math.floor(self.place[1]) - y
        rows, columns = np.nonzero(occupancy.state != OPEN)
        squares = zip((columns + occupancy.west + i).tolist(), (rows + occupancy.south + j).tolist(), strict=True)
        there = np.array([self.occupied(*square) for square in squares])
        return float((there != (occupancy.state[rows, columns] == FULL)).mean())


def strolled(seed: int) -> Stroll:
    """Four moves, then he is carried off, and eight moves more."""
    stroll = Stroll(seed)
    for _ in range(4):
        stroll.go()
    assert "lost" not in stroll.hows
    stroll.carried_off()
    for _ in range(8):
        stroll.go()
    return stroll


def test_who_is_carried_off_notices_and_soon_knows_the_room_again() -> None:
    for seed in range(3):
        stroll = strolled(seed)
        assert "lost" in stroll.hows[5:8], seed
        assert stroll.wrong == 0.0, seed
        assert len(stroll.knowledge.memory.track) == len(stroll.hows)


def test_a_look_that_agrees_with_nothing_contradicts_what_is_believed() -> None:
    knowledge = walked(ROOM, [(2, 0), (0, 3)]).knowledge
    x, y = utak_in(ROOM)
    model, _ = knowledge.perceive(Release(), impression(world_of(ROOM), (x + 2, y + 3)))
    assert not model.contradicted
    shut_in = impression(lambda i, j: (i, j) != (0, 0), (0, 0))
    model, _ = knowledge.perceive(Release(), shut_in)
    assert model.contradicted


def test_who_cannot_forget_believes_in_a_room_that_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Memory, "lost", False)
    assert all(strolled(seed).wrong > 0.01 for seed in range(3))


def lost_in(rows: list[str]) -> Knowledge:
    """One who has walked a little, and whose last looks fitted badly."""
    knowledge = walked(rows, [(2, 0), (0, 3)]).knowledge
    knowledge.memory.unfit = (LOST, LOST)
    assert knowledge.memory.lost
    return knowledge


def test_misfits_of_a_single_look_are_no_reason_to_forget() -> None:
    memory = Memory(unfit=(0, 0, 0, 3 * LOST))
    assert not memory.lost
    assert not Memory(unfit=(1, 1, 1, 1)).lost
    assert Memory(unfit=(0, 1, 0, LOST)).lost


def test_who_has_moved_a_thing_forgets_less_readily() -> None:
    thing = shapely.box(4, 2, 8, 4)
    held, moved = HeldObject("o1", thing, thing), HeldObject("o1", thing, thing).moved(thing, 0.0)
    assert Memory(unfit=(1, LOST), loads={"o1": held}).lost
    assert not Memory(unfit=(1, LOST), loads={"o1": moved}).lost
    assert Memory(unfit=(1, ASTRAY), loads={"o1": moved}).lost


def test_what_he_holds_he_lets_go_before_he_forgets() -> None:
    knowledge = lost_in(ROOM)
    x, y = utak_in(ROOM)
    thing = shapely.box(4, 2, 8, 4)
    knowledge.memory.grasp(HeldObject("o1", thing, thing))
    sees = impression(world_of(ROOM), (x + 2, y + 3))
    model, accommodated = knowledge.perceive(Turn(5.0), sees)
    assert model.lost
    assert not model.anew
    decision = Decider(Task({}, (), ())).decide(model, knowledge.memory.track)
    assert isinstance(decision.command, Release)
    knowledge.memory.unfit = (LOST, LOST)
    model, accommodated = knowledge.perceive(Release(), sees)
    assert accommodated.explanation.how == "lost"
    assert model.anew
    assert not model.lost
    assert not knowledge.memory.loads


def test_on_another_lattice_what_never_moved_stands_where_it_is_seen() -> None:
    thing = shapely.box(-6, 5, -3, 8)  # there is nothing
    for moved, held in ((False, False), (True, False), (False, True)):
        memory = walked(ROOM, [(2, 0), (0, 3)]).knowledge.memory
        before = memory.occupancy.state.copy()
        memory.grasp(HeldObject("o1", thing, thing, proven=moved))
        memory.held = "o1" if held else None
        memory._lie(Explanation("predicted", memory.place, memory.frame, 0, 0.0))
        assert list(memory.loads) == ["o1"]
        other = Frame(origin=(0.4, 0.6))  # on which he saw the same
        memory._lie(Explanation("turned", memory.place, other, 0, 0.0, None, (FrameHypothesis(0, other.origin * 2),)))
        assert memory.frame == other
        assert list(memory.loads) == ["o1"] * (moved or held)
        assert (memory.occupancy.state == before).all() == (not moved and not held)


def test_who_forgot_knows_about_where_he_came_from() -> None:
    knowledge = lost_in(ROOM)
    x, y = utak_in(ROOM)
    before = knowledge.memory.place
    model, _ = knowledge.perceive(Move(1.0, 0.0), impression(world_of(ROOM), (x + 3, y + 3)))
    assert model.anew
    assert knowledge.memory.looked_from == {knowledge.memory.square}
    assert len(knowledge.memory.hypotheses) > 40
    assert model.place == pytest.approx((before[0] + 1, before[1]))
    assert knowledge.memory.track[:3] == [(0.5, 0.5), (2.5, 0.5), (2.5, 3.5)]
    row, column = model.view.locate(0.5, 0.5)  # where he woke is on his map, whether he sees it or not
    assert min(row, column) >= 24
    assert row + 24 < model.labels.shape[0]
    assert column + 24 < model.labels.shape[1]


def test_one_look_tells_how_the_lattice_lies_whatever_he_believed() -> None:
    off = []
    for seed in range(20):
        stroll = Stroll(seed)
        memory = Memory(frame=Frame((stroll.heading + 60) % 90 - 44)).anew()
        memory.wake(stroll.sees())
        off.append(abs((memory.frame.angle - stroll.heading + 45) % 90 - 45))
    assert sum(angle <= 2 for angle in off) >= 18


def test_names_are_not_given_again() -> None:
    names, patch = ObjectNames(), Patch(0, 0, np.ones((2, 2), np.bool_))
    assert names.assign([patch]) == names.assign([patch]) == ["o1"]
    names.forget()
    assert names.assign([patch]) == ["o2"]
