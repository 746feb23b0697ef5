"""Carrying in simulated worlds, end to end: the robot believes of the carried object what is true of it."""

import math
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from itertools import chain, repeat
from pathlib import Path
from typing import Any, NamedTuple, cast

import pytest
import shapely
from shapely.affinity import rotate, translate

from benchmarks.harness.trial import Conditions, run_trial
from tests.planner.situations import watched_robot
from tests.tables import few
from utak.geometry.motion.se2 import Translate
from utak.kb.body import Body, Command, Grasp, Move, Push, Release, Turn
from utak.kb.task.task import Task
from utak.kb.world.model import Node, WorldModel
from utak.planner.agenda.decider import Decider
from utak.planner.carrying.manipulation_oracle import ManipulationPlan
from utak.planner.carrying.remaining_plan import PlanOperations, safe_prefix
from utak.planner.cycle import Options, Robot
from utak.planner.decision import Decision
from utak.planner.navigation.loop_guard import LoopGuard
from utak.planner.situation import Situation
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Result, Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings

ROOM = ["b" * 30, *["b" + "." * 28 + "b"] * 18, "b" * 30]


class Run(NamedTuple):
    """How a session ended, and the commands that were given."""

    result: Result
    session: Session
    commands: list[object]


def scene(folder: Path, world: str, start: str, goal: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "world.lp").write_text(world)
    (folder / "start.lp").write_text(start)
    (folder / "goal.lp").write_text(goal)
    return folder


def room(things: str, utak: str = "POINT (15.5 14.5)", heading: int = 0) -> str:
    """Return the world of a room of 28 x 18 squares in a verge 2 squares thick, as facts."""
    ring = "(0 0, 32 0, 32 22, 0 22, 0 0), (2 2, 2 20, 30 20, 30 2, 2 2)"
    return f'table(32, 22).\nverge("POLYGON ({ring})").\nutak("{utak}", {heading}).\n{things}\n'


def box(x0: float, y0: float, x1: float, y1: float) -> str:
    return f"POLYGON (({x0} {y0}, {x1} {y0}, {x1} {y1}, {x0} {y1}, {x0} {y0}))"


def run(folder: Path, settings: Settings | None = None) -> Run:
    session = Session(read_scenario(folder), settings or Settings(), make_robot, EpisodeLog(None))
    commands: list[object] = []
    session.wake()
    while not session.finished:
        commands.append(session.robot.decision.command)
        session.step()
    return Run(session.end(), session, commands)


def on_table(session: Session, polygon: shapely.Polygon) -> shapely.Polygon:
    """Return a polygon of the map frame in the table frame, for a robot that woke in the middle of a square."""
    world, frame = session.scenario.world, session.robot.knowledge.memory.frame
    moved = translate(polygon, -frame.origin[0], -frame.origin[1])
    turned = rotate(moved, world.heading - frame.angle, origin=(0, 0))
    return translate(turned, *world.utak)


def lies_as_believed(session: Session, name: str = "t") -> None:
    loads = session.robot.knowledge.memory.held_objects
    believed = min(
        (on_table(session, load.polygon) for load in loads.values()),
        key=lambda p: p.symmetric_difference(session.table.polygons[name]).area,
    )
    assert believed.symmetric_difference(session.table.polygons[name]).area < 1e-6


SQUARE = f'object(t, g, "{box(8, 6, 11, 9)}").'


@pytest.mark.parametrize("heading", few([0, 90, 217], 1))
def test_a_square_is_carried_into_a_corner(tmp_path: Path, heading: int) -> None:
    folder = scene(tmp_path, room(SQUARE, heading=heading), "object(x). shape(x, square).", "at(x, corner(northeast)).")
    done = run(folder)
    assert done.result.verdict == "done", done.result.reason
    lies_as_believed(done.session)
    assert {load.colour for load in done.session.robot.knowledge.memory.held_objects.values()} == {"g"}
    west, south, east, north = done.session.table.polygons["t"].bounds
    corners = {0: (30 - east, 20 - north), 90: (west - 2, 20 - north), 217: (west - 2, south - 2)}
    assert max(corners[heading]) <= 1.0 + 1e-6


BROAD_T = "POLYGON ((8.2 6.2, 16.8 6.2, 16.8 10.8, 13.8 10.8, 13.8 13.8, 11.2 13.8, 11.2 10.8, 8.2 10.8, 8.2 6.2))"


def test_what_is_of_no_class_of_shapes_is_carried_as_what_it_is(tmp_path: Path) -> None:
    goal = 'pose(x, "POINT (6 -5)", 0).'
    folder = scene(tmp_path, room(f'object(t, g, "{BROAD_T}").'), "object(x). colour(x, g).", goal)
    done = run(folder)
    assert done.result.verdict == "done", done.result.reason
    assert len(done.commands) <= 8
    (load,) = done.session.robot.knowledge.memory.held_objects.values()
    true = done.session.table.polygons["t"]
    assert true.area < on_table(done.session, load.polygon).area < 1.3 * true.area
    assert on_table(done.session, load.polygon).buffer(0.01).contains(true)


@pytest.mark.long
def test_an_immovable_object_is_found_out(tmp_path: Path) -> None:
    folder = scene(
        tmp_path, room(SQUARE.replace("object", "fixed")), "object(x). shape(x, square).", "at(x, corner(northwest))."
    )
    done = run(folder)
    assert not done.result.believed
    assert "cannot be moved" in done.result.reason
    assert done.result.steps < 90  # it was pushed each way, and the walls were felt


@pytest.mark.long
@pytest.mark.parametrize(
    ("third", "utak"), [("24 18, 24 20, 20 20, 20 36, 46 36, 46 20, 30 20, 30 18", "33.5 28.5"), ("", "14.5 10.5")]
)
def test_an_object_against_a_wall_that_would_make_a_door_is_felt(third: str, utak: str, tmp_path: Path) -> None:
    """With the object in its corner taken for wall, the western room is too narrow to have a door to the east."""
    points = ["2 2, 2 18, 18 18, 18 14, 20 14, 20 18", third, "46 18, 46 2, 20 2, 20 7, 18 7, 18 2, 2 2"]
    ring = f"(0 0, 0 38, 48 38, 48 0, 0 0), ({', '.join(part for part in points if part)})"
    things = f'object(p, h, "{box(2, 12, 8, 17)}").\nobject(t, g, "{box(9, 4, 13, 8)}").'
    world = f'table(48, 38).\nverge("POLYGON ({ring})").\nutak("POINT ({utak})", 0).\n{things}\n'
    done = run(scene(tmp_path, world, "object(x). shape(x, square).", "in(x, room(next))."))
    assert done.result.verdict == "done", done.result.reason
    assert shapely.box(20, 2, 46, 18).covers(done.session.table.polygons["t"])
    model = done.session.robot.model
    assert not any((part & model.mask(node.patch)).any() for part in model.protruding for node in model.objects)


@pytest.mark.long
def test_an_object_that_looks_like_wall_hides_nothing_until_it_is_felt(tmp_path: Path) -> None:
    ring = "(0 0, 0 34, 34 34, 34 0, 0 0), (18 4, 18 20, 4 20, 4 30, 30 30, 30 4, 18 4)"
    ell = "POLYGON ((18 11, 24 11, 24 19, 22 19, 22 13, 18 13, 18 11))"
    things = f'fixed(p, h, "{ell}").\nobject(t, g, "{box(12, 23, 14, 27)}").'
    world = f'table(34, 34).\nverge("POLYGON ({ring})").\nutak("POINT (27.5 21.5)", 200).\n{things}\n'
    done = run(scene(tmp_path, world, "object(x). shape(x, brick).", "around(x, corner)."))
    assert done.result.verdict == "done", done.result.reason
    wall, began = shapely.box(0, 0, 18, 20), shapely.Point(13, 25)
    corners = shapely.points(done.session.table.polygons["t"].exterior.coords)
    assert all(shapely.LineString([began, corner]).intersection(wall).length > 0 for corner in corners)


@pytest.mark.long
def test_a_square_that_looks_like_a_brick_is_measured(tmp_path: Path) -> None:
    between = f'object(t, g, "{box(8.5, 6, 11.5, 9)}").'
    folder = scene(tmp_path, room(between), "object(x). shape(x, square).", "at(x, corner(northeast)).")
    done = run(folder)
    assert done.result.verdict == "done", done.result.reason
    _, _, east, north = done.session.table.polygons["t"].bounds
    assert max(30 - east, 20 - north) <= 1.0


@pytest.mark.parametrize("goal", few(["at(utak, x).", "circled(utak, x)."], ["at(utak, x)."]))
def test_a_square_that_looks_like_a_brick_is_measured_for_a_goal_of_the_robot_itself(goal: str, tmp_path: Path) -> None:
    between = f'object(t, g, "{box(8.5, 6, 11.5, 9)}").'
    done = run(scene(tmp_path, room(between), "object(x). shape(x, square).", goal))
    assert done.result.verdict == "done", done.result.reason


@pytest.mark.long
def test_two_things_may_share_the_squares_in_which_they_touch(tmp_path: Path) -> None:
    things = f'object(t, w, "{box(11.94, 11.32, 14.94, 14.32)}").object(d, h, "{box(9.94, 10.32, 11.94, 14.32)}").'
    ring = "(0 0, 0 22, 24 22, 24 0, 0 0), (23 2, 23 21, 2 21, 2 2, 23 2)"
    world = f'table(24, 22).verge("POLYGON ({ring})").utak("POINT (13.44 10.82)", 0).{things}'
    done = run(scene(tmp_path, world, "object(x). shape(x, square).", "at(x, corner(southeast))."))
    assert done.result.verdict == "done", done.result.reason
    _, south, east, _ = done.session.table.polygons["t"].bounds
    assert max(23 - east, south - 2) <= 1.0


@pytest.mark.long
def test_a_brick_that_is_measured_stays_one(tmp_path: Path) -> None:
    brick = f'object(t, g, "{box(8, 6, 12, 9)}").'
    folder = scene(tmp_path, room(brick), "object(x). shape(x, square).", "at(x, corner(northeast)).")
    done = run(folder)
    # It was moved, so it is one thing; and all walls were felt.
    assert done.result.verdict == "impossible" and "nothing seen so far is x" in done.result.reason
    assert done.session.table.polygons["t"].centroid.distance(shapely.Point(10, 7.5)) < 3.0


@pytest.mark.long
def test_an_immovable_object_is_not_the_one_to_be_carried(tmp_path: Path) -> None:
    other = f'fixed(s, g, "{box(20, 10, 23, 13)}").'
    folder = scene(tmp_path, room(SQUARE + other), "object(x). shape(x, square).", "at(x, corner(southeast)).")
    done = run(folder)
    assert done.result.verdict == "done", done.result.reason
    lies_as_believed(done.session)


@pytest.mark.long
def test_a_robot_off_the_middle_of_its_square_learns_that_from_the_first_turn(tmp_path: Path) -> None:
    brick = f'object(t, g, "{box(8, 6, 13, 8)}").'
    pose = 'pose(x, "POINT (4 -4)", 90).'
    folder = scene(tmp_path, room(brick, "POINT (15.2 14.7)"), "object(x). shape(x, brick).", pose)
    done = run(folder)
    assert any(isinstance(command, Turn) for command in done.commands)
    assert done.result.verdict == "done", done.result.reason
    middle = done.session.table.polygons["t"].centroid
    assert math.dist((middle.x, middle.y), (19.2, 10.7)) < 0.8


def test_without_pulling_every_push_leads_away_from_the_robot(tmp_path: Path) -> None:
    folder = scene(tmp_path, room(SQUARE), "object(x). shape(x, square).", "at(x, corner(southwest)).")
    session = Session(read_scenario(folder), Settings(pull=False), make_robot, EpisodeLog(None))
    session.wake()
    pushes = 0
    while not session.finished:
        command = session.robot.decision.command
        middle, utak = session.table.polygons["t"].centroid, session.table.utak
        if isinstance(command, Push):
            pushes += 1
            assert command.east * (middle.x - utak[0]) + command.north * (middle.y - utak[1]) > 0
        session.step()
    assert pushes
    assert session.end().verdict == "done"


@pytest.mark.long
def test_the_object_is_released_before_a_walk_and_both_goals_hold_at_the_end(tmp_path: Path) -> None:
    folder = scene(tmp_path, room(SQUARE), "object(x). shape(x, square).", "at(x, corner(southwest)). at(utak, start).")
    done = run(folder)
    assert done.result.verdict == "done", done.result.reason
    holding = False
    for command in done.commands:
        assert not (holding and isinstance(command, Move))
        holding = (holding or isinstance(command, Push | Turn)) and not isinstance(command, Release)
    assert math.dist(done.session.table.utak, (15.5, 14.5)) <= 1.5
    assert max(done.session.table.polygons["t"].bounds[:2]) <= 3.0 + 1e-6


def woken_with_two_things(tmp_path: Path, goal: str) -> Session:
    """Return a run at its first step, with a square x and a brick y on the table."""
    things = SQUARE + f'\nobject(u, r, "{box(20, 5, 25, 7)}").'
    start = "object(x). shape(x, square). object(y). shape(y, brick)."
    folder = scene(tmp_path, room(things), start, goal)
    session = Session(read_scenario(folder), Settings(), make_robot, EpisodeLog(None))
    session.wake()
    return session


@pytest.mark.long
def test_reasons_name_the_thing_in_hand_and_the_one_that_comes_next(tmp_path: Path) -> None:
    """Two things are carried and pressed into corners, and one of two things is released for the other's sake."""
    session = woken_with_two_things(tmp_path, "at(x, corner(southwest)). at(y, corner(northwest)).")
    released = []
    while not session.finished:
        held = session.robot.model.held
        session.step()
        action, why = session.line["action"], session.line["why"]
        if action["do"] in ("push", "turn", "release"):
            assert why.startswith(f"{held} "), why
        released += [why.partition(";")[0]] if action["do"] == "release" else []
    assert session.end().verdict == "done"
    names = {session.robot.decider.bound[parameter] for parameter in "xy"}
    assert set(released) & {f"{one} is released, because {(names - {one}).pop()} is moved next" for one in names}


@pytest.mark.long
def test_first_beside_another_object_then_away(tmp_path: Path) -> None:
    session = woken_with_two_things(tmp_path, "first(beside(x, y)). then(at(x, corner(northwest))).")
    nearest = math.inf
    while not session.finished:
        session.step()
        nearest = min(nearest, session.table.polygons["t"].distance(session.table.polygons["u"]))
    assert session.end().verdict == "done"
    assert nearest <= 1.0
    lies_as_believed(session)


@pytest.mark.long
def test_a_grasp_that_slipped_is_made_again(tmp_path: Path) -> None:
    folder = scene(tmp_path, room(SQUARE), "object(x). shape(x, square).", "at(x, corner(northeast)).")
    done = run(folder, Settings(noise=0.02, seed=3))
    assert done.result.verdict == "done", done.result.reason
    _, _, east, north = done.session.table.polygons["t"].bounds
    assert max(30 - east, 20 - north) < 1.5


@pytest.mark.long
def test_the_safe_prefix_of_a_plan_is_done_before_the_rest_is_seen(tmp_path: Path) -> None:
    begun = []

    def watched(found: ManipulationPlan, node: Node, situation: Situation) -> ManipulationPlan | None:
        part = safe_prefix(found, node, situation)
        if part is not None:
            own = situation.model.mask(node.patch)
            (leg,), (whole, *_) = part.plan.legs, found.plan.legs
            *before, last = leg.motions
            assert not (part.swept & ~situation.cost_maps.safe & ~own).any()
            assert tuple(before) == whole.motions[: len(before)]
            push = whole.motions[len(before)]
            assert isinstance(last, Translate)
            assert isinstance(push, Translate)
            assert abs(last.dx * push.dy - last.dy * push.dx) <= math.hypot(push.dx, push.dy)  # nearly the same way
            assert math.hypot(last.dx, last.dy) <= math.hypot(push.dx, push.dy) + 1
            begun.append(part)
        return part

    maker = watched_robot(PlanOperations(safe_prefix=watched))
    for seed in (27017, 27018):
        trial = run_trial(5, seed, Conditions(), tmp_path / str(seed), maker=maker)
        assert trial.right, (trial.verdict, trial.reason, trial.crash)
    assert begun


@pytest.mark.long
def test_a_plan_to_grasp_from_an_occupied_square_is_dropped(tmp_path: Path) -> None:
    folder = scene(tmp_path, room(SQUARE), "object(x). shape(x, square).", "at(x, corner(northeast)).")
    session = Session(read_scenario(folder), Settings(), make_robot, EpisodeLog(None))
    session.wake()
    executor = session.robot.decider.executor
    while executor._plan is None or executor._plan.grasped:
        session.step()
    within = executor._plan.polygon.centroid
    leg = replace(executor._plan.legs[0], place=(math.floor(within.x) + 0.5, math.floor(within.y) + 0.5))
    executor._plan = replace(executor._plan, legs=(leg,))
    while not session.finished:
        session.step()
    assert session.end().verdict == "done"
    lies_as_believed(session)


@pytest.mark.long
@pytest.mark.parametrize(
    ("task", "seed"),
    [
        *((task, seed) for seed in (101, 106) for task in (5, 6, 7, 8, 9)),
        (5, 107),  # no passage is wide enough: all walls that matter are felt
    ],
)
def test_random_worlds(task: int, seed: int, tmp_path: Path) -> None:
    trial = run_trial(task, seed, Conditions(), tmp_path)
    assert trial.right, (trial.verdict, trial.reason, trial.crash)
    assert not trial.judged
    assert not trial.score or trial.score.wrong == 0
    assert trial.narrow is None or trial.narrow.right, trial.reason


@pytest.mark.long
@pytest.mark.parametrize(
    ("task", "seed", "kind"),
    [
        (5, 73014, "wide"),  # the robot runs against a wall before it knows how the table is turned
        (5, 75012, "wide"),  # the furthest corner lies in a room that is not seen when the object is put down
        # two degrees off: after a turn that looks like a place beside the middle of the square
        (6, 75010, "wide"),
        (7, 75012, "wide"),
        # two degrees off: the first push is stopped, though the robot did not wake at the edge of its square
        (8, 92006, "wide"),
        (5, 141008, "snug"),  # the furthest corner lies in a room behind the next, that is entered from the side
    ],
)
def test_worlds_that_were_misread_before(task: int, seed: int, kind: str, tmp_path: Path) -> None:
    trial = run_trial(task, seed, Conditions(kind=kind), tmp_path)
    assert trial.right, (trial.verdict, trial.reason, trial.crash)
    assert not trial.judged


class Obedient:
    """A decider that decides, but gives the commands of a list, and then only releases."""

    def __init__(self, decider: Decider, orders: Iterator[Command]) -> None:
        self._decider, self._orders = decider, orders

    def decide(self, *believed: Any) -> Decision:
        return replace(self._decider.decide(*believed), command=next(self._orders), verdict=None)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._decider, name)

    def __deepcopy__(self, memo: dict[int, Any]) -> "Obedient":
        return Obedient(deepcopy(self._decider, memo), self._orders)  # a copy gives the same orders


@pytest.mark.long
def test_a_push_that_was_stopped_unseen_is_told_by_a_contradiction_in_the_next_impression(tmp_path: Path) -> None:
    # The impression after it fits where it should have led, but not together with what that impression settles.
    push = Push(16.787121481478813, 13.497872142159018)
    moves = [(-11.9382, -0.9659), (-4.5321629143, 0.113171748288), (-3.88002180319, 9.270675854908)]
    orders: Iterator[Command] = chain((Move(*move) for move in moves), [Grasp("west"), push], repeat(Release()))

    def make(body: Body, task: Task, settings: Settings) -> Robot:
        decider = Obedient(Decider(task, settings.paths), orders)
        return Robot(body, task, Options(settings.paths, max_steps=settings.max_steps), cast(Decider, decider))

    places: list[tuple[float, float]] = []
    trues: list[tuple[float, float]] = []

    def watch(at: Session) -> None:
        places.append(at.robot.robot.knowledge.memory.place)
        trues.append(at.table.utak)

    trial = run_trial(5, 170016, Conditions(kind="wide", max_steps=6), tmp_path, watch, make)
    assert not trial.believed and not trial.crash
    (pushed,) = [n for n in range(1, len(trues)) if math.dist(trues[n - 1], trues[n]) > 19]
    far = math.dist(trues[pushed - 1], trues[pushed])
    assert far < math.hypot(push.east, push.north) - 1
    assert math.dist(places[pushed - 1], places[pushed]) == pytest.approx(far, abs=1)


@pytest.mark.long
@pytest.mark.parametrize("heading", [81, 99])
def test_after_few_looks_one_more_comes_before_the_grasp_of_an_object_right_beside_the_robot(
    heading: int, tmp_path: Path
) -> None:
    world = room(f'object(t, g, "{box(14, 8, 17, 14)}").', heading=heading)
    folder = scene(tmp_path, world, "object(x). shape(x, brick).", "at(x, corner(northeast)).")
    done = run(folder)
    assert done.result.verdict == "done", done.result.reason
    assert not isinstance(done.commands[0], Grasp)
    lies_as_believed(done.session)


class FirstPushLoops:
    """A loop guard that takes every push from one place for a loop: the place of the first push."""

    def __init__(self) -> None:
        self._guard, self.circling = LoopGuard(), []  # type: ignore[var-annotated]

    def noticed(self, model: WorldModel, command: object) -> bool:
        again = isinstance(command, Push) and (not self.circling or self.circling[0] == model.place)
        self.circling.extend([model.place] * again)
        return again

    def __getattr__(self, name: str) -> Any:
        return getattr(self._guard, name)

    def __deepcopy__(self, memo: dict[int, Any]) -> "FirstPushLoops":
        copied = FirstPushLoops()
        copied._guard, copied.circling = deepcopy(self._guard, memo), self.circling
        return copied


@pytest.mark.long
def test_an_object_that_is_carried_in_circles_is_released_and_grasped_elsewhere(tmp_path: Path) -> None:
    folder = scene(tmp_path, room(SQUARE), "object(x). shape(x, square).", "at(x, corner(northeast)).")
    guard = FirstPushLoops()

    def make(body: Body, task: Task, settings: Settings) -> Robot:
        decider = Decider(task, settings.paths)
        decider.pursuer._circles = cast(LoopGuard, guard)
        return Robot(body, task, Options(), decider)

    session = Session(read_scenario(folder), Settings(), make, EpisodeLog(None))
    session.wake()
    circling = guard.circling
    taken, after = [], []
    while not session.finished:
        command = session.robot.decision.command
        if isinstance(command, Grasp):
            taken.append(session.robot.model.place)
        session.step()
        if circling and not after:
            after.append(session.robot.decision.command)
    assert session.end().verdict == "done"
    assert isinstance(after[0], Release)
    assert taken[0] == circling[0]
    assert math.dist(taken[0], taken[1]) >= 1
    _, _, east, north = session.table.polygons["t"].bounds
    assert max(30 - east, 20 - north) <= 1


def into_northeast(folder: Path) -> None:
    """Assert that the square is carried into the northeast corner, and truly lies there."""
    done = run(folder)
    assert done.result.verdict == "done", done.result.reason
    _, _, east, north = done.session.table.polygons["t"].bounds
    assert max(30 - east, 20 - north) <= 1


@pytest.mark.long
@pytest.mark.parametrize("corners", [(12, 2, 15, 5), (2, 9, 5, 12), (2, 2, 5, 5)])
def test_an_object_against_a_wall_is_felt_and_carried(corners: tuple[float, ...], tmp_path: Path) -> None:
    x0, y0, x1, y1 = corners
    world = room(f'object(t, g, "{box(x0, y0, x1, y1)}").')
    into_northeast(scene(tmp_path, world, "object(x). shape(x, square).", "at(x, corner(northeast))."))


@pytest.mark.long
@pytest.mark.parametrize("part", [0.07, 0.35, 0.5, 0.81])
def test_an_object_off_the_grid_is_carried_right_into_its_corner(part: float, tmp_path: Path) -> None:
    world = room(f'object(t, g, "{box(8 + part, 6 + part, 11 + part, 9 + part)}").')
    into_northeast(scene(tmp_path, world, "object(x). shape(x, square).", "at(x, corner(northeast))."))


@pytest.mark.long
@pytest.mark.parametrize(
    ("seed", "kind", "how"),
    [
        (402017, "wide", "is taken along: "),
        (371029, "loose", "is led out of the nook, to be grasped from elsewhere"),
    ],
)
def test_a_robot_that_is_shut_in_a_corner_leads_the_held_object_out(
    seed: int, kind: str, how: str, tmp_path: Path
) -> None:
    trial = run_trial(5, seed, Conditions(kind=kind), tmp_path)
    assert how in next(tmp_path.rglob("episode.jsonl")).read_text()
    assert trial.achieved
    assert trial.believed


@pytest.mark.long
def test_a_square_is_pressed_into_a_slanted_corner_before_it_is_let_go_for_a_look(tmp_path: Path) -> None:
    ring = (
        "(0 0, 0 31, 30 31, 30 0, 0 0), (17.01391 2, 28.178458 17.499119, 14.245991 29.687285, 2 12.68686, 17.01391 2)"
    )
    square = "(11.955654 17.34, 11.56 20.313795, 14.533795 20.709449, 14.929449 17.735654, 11.955654 17.34)"
    things = f'verge("POLYGON ({ring})"). object(t, j, "POLYGON ({square})").'
    world = f'table(30, 31). utak("POINT (9.5 9.5)", 326). {things}'
    done = run(scene(tmp_path, world, "object(x). shape(x, square).", "at(x, corner(southeast))."))
    assert done.result.verdict == "done", done.result.reason
    corner = shapely.Point(17.01391, 2)
    assert done.session.table.polygons["t"].distance(corner) < 3
