"""Navigation among movable obstacles: what blocks the robot is moved aside when nothing else is left."""

from dataclasses import replace

import pytest
import shapely
import shapely.affinity

from tests.planner.situations import all_felt, situation_of, tools_with, turn_of
from tests.planner.situations import known_situation as known
from utak.geometry.manipulation.plan_carrying import At, Inside
from utak.geometry.motion.se2 import Pose
from utak.geometry.raster.geodesic import GEODESIC_UNREACHED, reach
from utak.geometry.raster.rasterize import covered_areas
from utak.kb.body import Grasp, Move, Push, Turn
from utak.kb.language.reader import facts_from_text
from utak.kb.localisation.propose.larger_object import MAX_HIDDEN_DEPTH
from utak.planner.deciding.clearing import ObstacleClearer
from utak.planner.deciding.obstacles import TRIAL_PUSH, Obstacle, obstacles
from utak.planner.decision import Decision
from utak.planner.goals.placement import possible_extension, pull_out_end, to_view_frame
from utak.planner.situation import Situation
from utak.planner.stages import Stage

WALL = "b" * 12 + "bb" + "b" * 12
OPEN_ROW = "b" + "." * 11 + "bb" + "." * 11 + "b"


def rooms(middle: list[str]) -> list[str]:
    """Return two rooms and what lies in the rows of the door between them; the robot stands in the western one."""
    return [WALL, *[OPEN_ROW] * 4, *middle, *[OPEN_ROW] * 3, "b..U" + "." * 8 + "bb" + "." * 11 + "b", WALL]


BEFORE = rooms(["b" + "." * 9 + "gg" + "." * 13 + "b"] * 3)  # the door
ELSEWHERE = rooms(["b..gg" + "." * 20 + "b"] * 3)
BEHIND = rooms(["b" + "." * 9 + "gg" + ".." + "kk" + "." * 9 + "b"] * 3)  # each other
WITHIN = rooms(["b" + "." * 9 + "ggb" + "." * 12 + "b"] * 3)  # one column of the door
AGAINST = rooms(["b" + "." * 9 + "gg" + "bb" + "." * 11 + "b"] * 3)  # a wall
UTAK = Stage(facts_from_text("in(utak, room(next))."))


class Clearing:
    """Activities that are decided for a stage whose goals are given up with a verdict."""

    def __init__(self) -> None:
        self._clearer, self._tools = ObstacleClearer(), tools_with()

    def on(self, stage: Stage, situation: Situation) -> Decision:
        return self._clearer.clear_on(turn_of(stage, situation, self._tools))

    def before(self, stage: Stage, situation: Situation) -> Decision:
        """What helps, if anything, before the goals of the robot itself are called impossible."""
        remedies = (self._clearer.clear, self._clearer.feel, self._clearer.bare)
        found = [remedy(stage.goals, turn_of(stage, situation, self._tools)) for remedy in remedies]
        return next((one for one in found if one.command is not None), self._clearer.blame(situation))


def felt(situation: Situation) -> Situation:
    """Return a situation in which every wall was felt to be wall."""
    return situation_of(all_felt(situation.model))


def found_in(situation: Situation) -> list[Obstacle]:
    """Return the obstacles among all objects of a situation."""
    return list(obstacles(situation.model.objects, situation))


def test_an_object_before_the_only_door_is_an_obstacle() -> None:
    situation = known(BEFORE)
    (node,), (found, *_) = situation.model.objects, found_in(situation)
    assert found.node == node
    assert isinstance(found.aside, Inside)
    shape = to_view_frame(node.polygon, situation)
    lying = [shapely.affinity.translate(shape, dx, dy) for dx in range(-9, 3) for dy in range(-6, 6)]
    fits = [found.aside.polygon.covers(there) for there in lying]
    assert any(fits)
    for there, fit in zip(lying, fits, strict=True):  # where it may lie, the robot comes to the other room
        if fit:
            free = situation.model.space | situation.model.mask(node.patch)
            free &= covered_areas(there, free.shape[1], free.shape[0]) == 0.0
            assert reach(free, *situation.cost_maps.here)[5, 20] != GEODESIC_UNREACHED


@pytest.mark.parametrize("rows", [ELSEWHERE, AGAINST])
def test_an_object_elsewhere_is_no_obstacle(rows: list[str]) -> None:
    thick = [row[:13] + "b" * MAX_HIDDEN_DEPTH + row[13:] for row in rows]  # no object may reach so far into the wall
    assert not found_in(known(thick))


def test_of_two_objects_behind_each_other_the_first_is_the_obstacle() -> None:
    assert [one.node.name for one in found_in(known(BEHIND))] == ["g"]


def test_an_object_in_a_door_is_drawn_out_unless_it_was_moved() -> None:
    off, out, further = found_in(known(WITHIN))
    assert isinstance(off.aside, Inside)  # it is supposed to go on to the other side of the wall
    assert (out.aside, further.aside) == (At(Pose(-2.0, 0.0, 0.0)), At(Pose(TRIAL_PUSH, 0.0, 0.0)))
    assert all(one.node.patch.mask.sum() == 9 for one in (off, out, further))
    assert not found_in(known(WITHIN, moved=True))


def test_an_object_in_a_door_that_did_not_move_is_drawn_out_first() -> None:
    situation = known(WITHIN)
    (node,) = situation.model.objects
    stuck = situation_of(replace(situation.model, objects=(replace(node, resisted=("north",)),)))
    assert [type(one.aside) for one in found_in(stuck)] == [At, Inside, At]


def test_an_obstacle_is_grasped_and_its_plan_is_continued() -> None:
    situation, clearing = known(BEFORE), Clearing()
    (node,) = situation.model.objects
    first = clearing.before(UTAK, situation)
    assert isinstance(first.command, Move)
    beside = replace(situation.model, place=(node.patch.west - 0.5, node.patch.south + 0.5))
    taken = clearing.before(UTAK, situation_of(beside))
    assert isinstance(taken.command, Grasp)
    assert "blocks the robot's way" in taken.why
    held = situation_of(replace(beside, held=node.name))
    assert isinstance(clearing.on(UTAK, held).command, Push | Turn)
    assert Clearing().on(UTAK, held).result == "idle"


def test_what_is_in_the_way_of_an_obstacle_is_moved_on_once_it_is_in_hand() -> None:
    row = "b" + "." * 10 + "bb..b"
    plugged = ["b......kk.ggg..b"] * 3  # what fills the doorway can but be pulled, past another thing
    drawn = ["b" * 16, *[row] * 5, *plugged, "b.......U..bb..b", *[row] * 5, "b" * 16]
    situation, clearing = felt(known(drawn)), Clearing()
    taken = clearing.before(UTAK, situation)
    assert isinstance(taken.command, Grasp)
    assert taken.why.startswith("g blocks the robot's way: k is grasped")
    assert isinstance(clearing.on(UTAK, situation_of(replace(situation.model, held="k"))).command, Push | Turn)


def test_the_way_to_an_obstacle_is_continued_whatever_else_there_is_to_do() -> None:
    situation, clearing = known(BEFORE), Clearing()
    assert clearing.on(UTAK, situation).result == "idle"
    first = clearing.before(UTAK, situation)
    nearer = situation_of(replace(situation.model, place=(1.5, 1.5)))
    again = clearing.on(UTAK, nearer)
    assert again.why == first.why
    assert again.command not in (None, first.command)
    assert clearing.on(UTAK, known(ELSEWHERE)).result == "idle"  # it blocks no longer
    assert clearing.on(UTAK, situation).result == "idle"


@pytest.mark.parametrize("moved", [True, False])
def test_what_a_goal_speaks_of_is_moved_away_from_unfelt_walls_where_the_robot_put_it(moved: bool) -> None:
    model = known(["b" * 9, *["b.......b"] * 4, "b....gg.b", "b..U.ggbb", "b" * 9], moved=moved).model
    hidden = all_felt(model).felt.keys() - {(2, -1), (3, -1)}  # the wall south of the thing
    situation = situation_of(replace(model, felt=dict.fromkeys(hidden, "b")), {"x": model.objects[0].name})
    stage = Stage(facts_from_text("in(x, room(next))."))
    assert (ObstacleClearer().bare(stage.goals, turn_of(stage, situation)).command is not None) == moved


def test_goals_are_asked_about_anew_when_what_is_held_was_led_out_before_walls_are_felt() -> None:
    situation, clearer = known(ELSEWHERE), ObstacleClearer()
    held = situation_of(replace(situation.model, held=situation.model.objects[0].name))
    clearer.feel(UTAK.goals, turn_of(UTAK, situation))
    assert clearer.is_feeling(situation)
    assert not clearer.is_feeling(held)
    assert not clearer.is_feeling(situation)


def test_an_obstacle_that_may_be_wall_is_felt_first() -> None:
    situation = known(BEFORE)
    (node,) = situation.model.objects
    unsure = situation_of(replace(situation.model, objects=(replace(node, confidence=40, felt_first=True),)))
    assert "colour" in Clearing().before(UTAK, unsure).why
    hardly = situation_of(replace(situation.model, objects=(replace(node, confidence=10, felt_first=True),)))
    assert "it is felt" in Clearing().before(UTAK, hardly).why  # what it is taken for is a wall
    assert Clearing().before(UTAK, felt(hardly)).result == "idle"


def test_an_object_that_the_goal_is_about_stays() -> None:
    situation = replace(felt(known(BEFORE)), binding={"x": "g"})
    decided = Clearing().before(Stage(facts_from_text("circled(utak, x).")), situation)
    assert decided.result == "limit"  # nothing is proved of what lies behind it
    assert Clearing().before(UTAK, situation).result == "command"


@pytest.mark.parametrize(("rows", "result"), [(BEFORE, "limit"), (WITHIN, "command"), (ELSEWHERE, "idle")])
def test_an_obstacle_that_did_not_move_may_be_wedged_in(rows: list[str], result: str) -> None:
    decided = Clearing().before(UTAK, felt(known(rows, movable=0)))
    assert decided.result == result
    assert ("g blocks the robot's way" in decided.why) == (result == "limit")
    assert ("an opening that fills no whole square" in decided.why) == (result == "command")  # the wall behind it


@pytest.mark.parametrize(("rows", "depths"), [(WITHIN, (0, 3, 3, 3)), (AGAINST, (0, 3, 6, 6)), (BEFORE, (0, 0, 0, 0))])
def test_an_object_may_go_on_in_the_wall_right_behind_it(rows: list[str], depths: tuple[int, ...]) -> None:
    model = known(rows).model
    (node,) = model.objects
    verge = model.labels == model.labels[0, 0]
    wall = replace(model, kinds=model.kinds._replace(kind={f"part{model.labels[0, 0]}": {"verge": 100}}))
    found = [int((possible_extension(node, (1, 0), depth, wall) & verge).sum()) for depth in range(4)]
    assert tuple(found) == depths
    assert not possible_extension(replace(node, moved=True), (1, 0), 3, wall).any()
    assert not possible_extension(node, (-1, 0), 3, wall).any()


def test_an_object_is_drawn_out_to_see_the_needed_squares_of_the_wall_behind_it() -> None:
    situation = known(WITHIN)
    (node,) = situation.model.objects
    behind = possible_extension(node, (1, 0), 1, situation.model)
    end = pull_out_end(node, behind, situation)
    assert end is not None
    assert end.pose.x < -1.0
    assert end.pose.y == 0.0
    assert pull_out_end(node, ~behind, situation) is None
    assert pull_out_end(replace(node, moved=True), behind, situation) is None
