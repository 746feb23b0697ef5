"""What shuts Utak off and can be moved is moved aside, when nothing else is left."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
import shapely.affinity

from geometry.manipulation.plan_carrying import At, Inside
from geometry.motion.se2 import Pose
from geometry.raster.geodesic import UNREACHED, reach
from geometry.raster.rasterize import areas
from kb.body import Grasp, Move, Push, Turn
from kb.language.reader import facts_of
from kb.mapping.patch import Patch
from kb.world.model import Node
from planner.carrying.plan_executor import PlanExecutor
from planner.deciding.clearing import Obstacle, ObstacleClearer, obstacles
from planner.deciding.pursuit import Pursuer
from planner.deciding.verification import Verifier
from planner.decision import Decision
from planner.goals.placement import drawn_out, hidden_behind, in_view
from planner.situation import Situation
from planner.stages import Stage
from tests.kb.drawings import seen_whole
from tests.planner.situations import situation_of

WALL = "b" * 12 + "bb" + "b" * 12
OPEN_ROW = "b" + "." * 11 + "bb" + "." * 11 + "b"


def rooms(middle: list[str]) -> list[str]:
    """Two rooms and what lies in the rows of the door between them; Utak stands in the western one."""
    return [WALL, *[OPEN_ROW] * 4, *middle, *[OPEN_ROW] * 3, "b..U" + "." * 8 + "bb" + "." * 11 + "b", WALL]


BEFORE = rooms(["b" + "." * 9 + "gg" + "." * 13 + "b"] * 3)  # the door
ELSEWHERE = rooms(["b..gg" + "." * 20 + "b"] * 3)
BEHIND = rooms(["b" + "." * 9 + "gg" + ".." + "kk" + "." * 9 + "b"] * 3)  # each other
WITHIN = rooms(["b" + "." * 9 + "ggb" + "." * 12 + "b"] * 3)  # one column of the door
AGAINST = rooms(["b" + "." * 9 + "gg" + "bb" + "." * 11 + "b"] * 3)  # a wall
UTAK = Stage(facts_of("in(utak, room(next))."))
GIVEN_UP = Decision(None, "no way leads there", "impossible")


def known(rows: list[str], moved: bool = False, movable: int = 50, held: str | None = None) -> Situation:
    """What one believes who has seen all of a drawing, and knows of each letter but b that it is a thing."""
    marks, model = np.array([list(row) for row in reversed(rows)]), seen_whole(rows, objects=False)
    nodes = []
    for letter in sorted(set(marks.ravel()) - set("b.U")):
        south, west = np.argwhere(marks == letter).min(0)
        north, east = np.argwhere(marks == letter).max(0) + 1
        mask = marks[south:north, west:east] == letter
        patch = Patch(int(west) + model.view.west, int(south) + model.view.south, mask)
        box = shapely.box(patch.west, patch.south, patch.west + mask.shape[1], patch.south + mask.shape[0])
        nodes.append(Node(letter, "object", 95, "part1", patch, 0, polygon=box, moved=moved, movable=movable))
    return situation_of(replace(model, objects=tuple(nodes), held=held))


def cleared(clearer: ObstacleClearer, decision: Decision, stage: Stage, situation: Situation) -> Decision:
    return clearer.cleared(decision, stage.goals, stage, situation)


def deciding() -> ObstacleClearer:
    return ObstacleClearer(PlanExecutor(), Pursuer("skeleton"), Verifier())


def found_in(situation: Situation) -> list[Obstacle]:
    return list(obstacles(situation.model.objects, situation))


def test_what_stands_before_the_only_door_is_in_the_way() -> None:
    situation = known(BEFORE)
    (node,), (found,) = situation.model.objects, found_in(situation)
    assert found.node == node
    assert isinstance(found.aside, Inside)
    shape = in_view(node.polygon, situation)
    lying = [shapely.affinity.translate(shape, dx, dy) for dx in range(-9, 3) for dy in range(-6, 6)]
    fits = [found.aside.polygon.covers(there) for there in lying]
    assert any(fits)
    for there, fit in zip(lying, fits, strict=True):  # where it may lie, he comes to the other room
        if fit:
            free = situation.model.space | situation.model.mask(node.patch)
            free &= areas(there, free.shape[1], free.shape[0]) == 0.0
            assert reach(free, *situation.cost_maps.here)[5, 20] != UNREACHED


@pytest.mark.parametrize("rows", [ELSEWHERE, AGAINST])
def test_what_stands_elsewhere_is_not(rows: list[str]) -> None:
    thick = [row[:13] + "bb" + row[13:] for row in rows]  # than a thing may reach into it
    assert not found_in(known(thick))


def test_of_two_that_stand_behind_each_other_the_first() -> None:
    assert [one.node.name for one in found_in(known(BEHIND))] == ["g"]


def test_what_stands_in_a_door_is_drawn_out_once() -> None:
    assert found_in(known(WITHIN))[0].aside == At(Pose(-2.0, 0.0, 0.0))
    assert not found_in(known(WITHIN, moved=True))


def test_he_takes_what_shuts_him_off_and_goes_on_with_it() -> None:
    situation, clearer = known(BEFORE), deciding()
    (node,) = situation.model.objects
    assert cleared(clearer, Decision(Push(1.0, 0.0), "on"), UTAK, situation).command == Push(1.0, 0.0)
    first = cleared(clearer, GIVEN_UP, UTAK, situation)
    assert isinstance(first.command, Move)
    beside = replace(situation.model, place=(node.patch.west - 0.5, node.patch.south + 0.5))
    taken = cleared(clearer, GIVEN_UP, UTAK, situation_of(beside))
    assert isinstance(taken.command, Grasp)
    assert "shuts him off" in taken.why
    held = situation_of(replace(beside, held=node.name))
    pushed = clearer.going_on(UTAK, held)
    assert pushed is not None
    assert isinstance(pushed.command, Push | Turn)
    assert deciding().going_on(UTAK, held) is None


def test_he_goes_on_to_what_shuts_him_off_whatever_else_there_is_to_do() -> None:
    situation, clearer = known(BEFORE), deciding()
    assert clearer.going_on(UTAK, situation) is None
    first = cleared(clearer, GIVEN_UP, UTAK, situation)
    nearer = situation_of(replace(situation.model, place=(1.5, 1.5)))
    again = clearer.going_on(UTAK, nearer)
    assert again is not None
    assert again.why == first.why
    assert again.command != first.command
    assert clearer.going_on(UTAK, known(ELSEWHERE)) is None  # it no longer does
    assert clearer.going_on(UTAK, situation) is None


def test_what_may_be_a_piece_of_wall_is_felt_first() -> None:
    situation = known(BEFORE)
    (node,) = situation.model.objects
    unsure = situation_of(replace(situation.model, objects=(replace(node, confidence=40),)))
    assert "colour" in cleared(deciding(), GIVEN_UP, UTAK, unsure).why
    hardly = situation_of(replace(situation.model, objects=(replace(node, confidence=10),)))
    assert cleared(deciding(), GIVEN_UP, UTAK, hardly) == GIVEN_UP


def test_what_the_task_is_about_stays() -> None:
    situation = replace(known(BEFORE), binding={"x": "g"})
    decided = cleared(deciding(), GIVEN_UP, Stage(facts_of("circled(utak, x).")), situation)
    assert (decided.command, decided.verdict) == (None, "limit")  # that it shuts him off proves nothing
    assert cleared(deciding(), GIVEN_UP, UTAK, situation).command is not None


@pytest.mark.parametrize(("rows", "verdict"), [(BEFORE, "limit"), (WITHIN, "limit"), (ELSEWHERE, "impossible")])
def test_what_did_not_move_may_be_wedged_in(rows: list[str], verdict: str) -> None:
    decided = cleared(deciding(), GIVEN_UP, UTAK, known(rows, movable=0))
    assert (decided.command, decided.verdict) == (None, verdict)
    assert ("g shuts him off" in decided.why) == (verdict == "limit")


@pytest.mark.parametrize(("rows", "depths"), [(WITHIN, (0, 3, 3, 3)), (AGAINST, (0, 3, 6, 6)), (BEFORE, (0, 0, 0, 0))])
def test_a_thing_may_go_on_in_what_is_wall_right_behind_it(rows: list[str], depths: tuple[int, ...]) -> None:
    model = known(rows).model
    (node,) = model.objects
    verge = model.labels == model.labels[0, 0]
    wall = replace(model, kinds=model.kinds._replace(kind={f"part{model.labels[0, 0]}": {"verge": 100}}))
    found = [int((hidden_behind(node, (1, 0), depth, wall) & verge).sum()) for depth in range(4)]
    assert tuple(found) == depths
    assert not hidden_behind(replace(node, moved=True), (1, 0), 3, wall).any()
    assert not hidden_behind(node, (-1, 0), 3, wall).any()


def test_what_is_needed_of_a_wall_behind_a_thing_is_seen_when_that_is_drawn_out() -> None:
    situation = known(WITHIN)
    (node,) = situation.model.objects
    behind = hidden_behind(node, (1, 0), 1, situation.model)
    end = drawn_out(node, behind, situation)
    assert end is not None
    assert end.pose.x < -1.0
    assert end.pose.y == 0.0
    assert drawn_out(node, ~behind, situation) is None
    assert drawn_out(replace(node, moved=True), behind, situation) is None
