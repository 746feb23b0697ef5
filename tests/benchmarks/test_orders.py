"""The benchmark of orders: its search, its truth about runs, its results, and its table."""

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import box

from benchmarks.orders.__main__ import main
from benchmarks.orders.asked import AskedRun, is_touching, puzzles, random_tasks
from benchmarks.orders.carried_out import commands_of, does_task
from benchmarks.orders.relaxed import is_in_reach, may_pass, swept
from benchmarks.orders.row import OrderRow, RunBounds, row_of_entry
from benchmarks.orders.run import RunTooLongError, place_of, row_of_outcome, run_order
from benchmarks.orders.search import EXHAUSTED, FOUND, SEARCH_LIMIT, Carry, search
from benchmarks.orders.table import failures, table
from benchmarks.worlds.floorplans import FloorPlan
from benchmarks.worlds.several.kinds import several_world
from benchmarks.worlds.several.tasks import SeveralWorld
from tests.scripted import Scripted
from utak.geometry.manipulation.goals import Inside
from utak.geometry.manipulation.legs import Leg
from utak.geometry.manipulation.plan_carrying import plan_carrying
from utak.geometry.motion.se2 import Rotate, Translate
from utak.kb.body import Body, Command, Move
from utak.kb.task.task import Task
from utak.planner.cycle import TaskEnd
from utak.simulator.run.session import RobotMaker
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.sweep.executors.tasks import DIED, TOO_LONG, TaskOutcome, WorkerTask, carry_out

ENOUGH_SECONDS = 300  # of the processor, also where kernels are compiled first; searches end when they find a way

BOUNDS = RunBounds(max_steps=20, seconds=20, search=10)
PLUG = AskedRun("plug", "0")


def obedient(commands: Sequence[Command], verdict: str) -> RobotMaker:
    """Return a maker of robots that give commands and then a verdict."""

    def make(body: Body, told: Task, settings: Settings) -> Scripted:
        return Scripted(body, commands, TaskEnd(verdict == "done", verdict, "so it is"))

    return make


def found_commands(kind: str, seed: int) -> list[Command]:
    """Return commands that do the task of a world."""
    world = several_world(kind, seed)
    return commands_of(world, search(world, ENOUGH_SECONDS).way)


def numbers(world: SeveralWorld, pull: bool = True) -> list[int]:
    """Return the numbers of the things that are carried, in order; the way found does the task."""
    found = search(world, ENOUGH_SECONDS, pull)
    assert found.answer == FOUND
    assert does_task(world, found.way)
    return [part.thing for part in found.way if isinstance(part, Carry)]


def test_the_search_puts_the_deeper_thing_first() -> None:
    world = several_world("dead_end", 0)
    x, y = (want.region.centroid for want in world.stages[0])
    mouth = world.things[0].polygon.union(world.things[1].polygon).centroid
    deeper = 0 if x.distance(mouth) > y.distance(mouth) else 1
    assert numbers(world) == [deeper, 1 - deeper]


def test_the_search_fills_a_neck_after_the_other_thing_went_through() -> None:
    assert numbers(several_world("plug", 0)) == [0, 1]


def test_the_search_puts_a_thing_aside_where_two_change_places() -> None:
    world = next(w for seed in range(9) if (w := several_world("swap", seed)).variant == "poses")
    assert len(numbers(world)) == 3


def test_the_search_takes_the_steps_of_a_sequence_in_turn() -> None:
    assert numbers(several_world("sequence", 2)) == [0, 1, 1, 1]


def test_without_pulling_every_push_leads_away_from_the_robot() -> None:
    world = several_world("corners", 1)
    found = search(world, ENOUGH_SECONDS, pull=False)
    assert does_task(world, found.way)
    shapes = {number: thing.polygon for number, thing in enumerate(world.things)}
    for part in found.way:
        assert isinstance(part, Carry)
        for leg in part.legs:
            place = leg.place
            for motion in leg.motions:
                centre = shapes[part.thing].centroid
                if isinstance(motion, Translate):
                    assert motion.dx * (centre.x - place[0]) + motion.dy * (centre.y - place[1]) > 0
                    place = place[0] + motion.dx, place[1] + motion.dy
                shapes[part.thing] = motion.carry(shapes[part.thing])


def test_the_search_finds_nothing_where_nothing_can_be_done() -> None:
    world = several_world("plug", 0)
    door = world.plan.doors[0]
    west, south, east, north = door.polygon.bounds
    thin = box(west, south, east, south + 1) if door.vertical else box(west, south, west + 1, north)
    plan = FloorPlan(world.plan.width, world.plan.height, world.plan.rooms, (replace(door, polygon=thin, width=1),))
    found = search(replace(world, plan=plan), 0.5)
    assert found.answer in (EXHAUSTED, SEARCH_LIMIT)
    assert found.way == ()
    assert not does_task(world, ())


def test_the_search_ends_in_time() -> None:
    assert search(several_world("three", 0), 0.0).answer == SEARCH_LIMIT


def test_a_robot_that_does_the_task_and_says_so_is_right(tmp_path: Path) -> None:
    row = run_order(PLUG, BOUNDS, tmp_path, obedient(found_commands("plug", 0), "done"))
    assert (row.achieved, row.believed, row.possible, row.carries) == (True, True, "yes", 2)
    assert (row.met, row.wanted, row.carried) == (2, 2, 2)
    assert not row.faulty
    assert row.judged in (None, [])
    assert row_of_entry(json.loads(json.dumps(row.entry()))) == row


@pytest.mark.parametrize(("verdict", "done", "impossible"), [("done", True, False), ("impossible", False, True)])
def test_false_claims_are_found(verdict: str, done: bool, impossible: bool, tmp_path: Path) -> None:
    row = run_order(PLUG, BOUNDS, tmp_path, obedient([], verdict))
    assert (row.false_done, row.false_impossible, row.achieved, row.met) == (done, impossible, False, 0)
    assert row.faulty
    assert row.refutation


@pytest.mark.long
def test_a_sequence_whose_end_alone_is_so_is_not_achieved(tmp_path: Path) -> None:
    # Its last step ends where the sequence ends, but the steps before are left out.
    world = several_world("sequence", 2)
    last = replace(world, stages=world.stages[-1:])
    commands = commands_of(last, search(last, ENOUGH_SECONDS).way)
    row = run_order(AskedRun("sequence", "2"), BOUNDS, tmp_path, obedient(commands, "done"))
    assert row.false_done
    assert (row.met, row.wanted) == (0, 4)
    whole = run_order(AskedRun("sequence", "2"), BOUNDS, tmp_path, obedient(found_commands("sequence", 2), "done"))
    assert (whole.met, whole.achieved, whole.false_done) == (4, True, False)


def test_a_run_that_takes_too_long_is_cut_off(tmp_path: Path) -> None:
    def make(body: Body, told: Task, settings: Settings) -> Scripted:
        return Scripted(body, Endless(), TaskEnd(False, "limit", "no"))

    row = run_order(PLUG, replace(BOUNDS, seconds=1), tmp_path, make)
    assert (row.verdict, row.achieved, row.faulty) == ("time", False, False)
    assert row.commands >= 1


@pytest.mark.long
def test_a_run_is_also_cut_off_when_the_first_alarm_rings_where_python_drops_exceptions(tmp_path: Path) -> None:
    class SlowToDelete:
        def __del__(self) -> None:
            until = time.process_time() + 1.5
            while time.process_time() < until:
                pass

    def make(body: Body, told: Task, settings: Settings) -> Scripted:
        SlowToDelete()
        return Scripted(body, Endless(), TaskEnd(False, "limit", "no"))

    assert run_order(PLUG, replace(BOUNDS, seconds=1), tmp_path, make).verdict == "time"


def test_an_error_that_python_makes_of_the_alarm_is_a_run_that_takes_too_long(tmp_path: Path) -> None:
    def make(body: Body, told: Task, settings: Settings) -> Scripted:
        raise SystemError("a result with an exception set") from RunTooLongError("too long")

    row = run_order(PLUG, BOUNDS, tmp_path, make)
    assert (row.verdict, row.faulty) == ("time", False)


def test_a_robot_that_breaks_is_a_row_with_what_was_known(tmp_path: Path) -> None:
    def make(body: Body, told: Task, settings: Settings) -> Scripted:
        raise KeyError("o7")

    row = run_order(PLUG, BOUNDS, tmp_path, make)
    assert (row.verdict, row.possible, row.carries, row.commands, row.faulty) == ("error", "yes", 2, 0, True)
    assert "KeyError: 'o7'" in row.reason


class Endless(list[Command]):
    """Commands without an end."""

    def __iter__(self) -> Any:
        return iter([Move(0.0, 0.0)] * 1_000_000)


@pytest.mark.parametrize(("failure", "verdict"), [(TOO_LONG, "time"), (DIED, "error")])
def test_a_process_that_is_ended_leaves_a_row(failure: str, verdict: str, tmp_path: Path) -> None:
    outcome = TaskOutcome(None, failure, "it was ended")
    assert row_of_outcome(PLUG, BOUNDS, tmp_path, outcome).commands == 0
    run_order(PLUG, BOUNDS, tmp_path, obedient([Move(1.0, 0.0), Move(0.0, 1.0)], "limit"))
    row = row_of_outcome(PLUG, BOUNDS, tmp_path, outcome)
    assert (row.verdict, row.reason, row.commands, row.possible) == (verdict, "it was ended", 2, "unknown")
    assert (place_of(PLUG, tmp_path) / "world.lp").exists()


WORLD_PICTURE = "bbbbbbbbbb\nb........b\nb..aa{gap}cc.b\nb..aa{gap}cc.b\nb........b\nb..U.....b\nbbbbbbbbbb\n"


def puzzle(folder: Path, gap: str) -> None:
    """Write a puzzle with a gap between its two things."""
    folder.mkdir()
    (folder / "world.txt").write_text(WORLD_PICTURE.format(gap=gap).replace("cc.", "cc" + "." * (2 - len(gap))))
    (folder / "start.lp").write_text("object(x). colour(x, a).\n")
    (folder / "goal.lp").write_text('pose(x, "POINT (0.5 4.5)", 0).\n')
    (folder / "expect.lp").write_text('inside(a1, "POLYGON ((2 1, 6 1, 6 3, 2 3, 2 1))").\n')


def test_puzzles_are_told_apart(tmp_path: Path) -> None:
    for name, gap in (("apart", "."), ("close", "")):
        puzzle(tmp_path / name, gap)
    (tmp_path / "SOLVABLE.tsv").write_text("name\tverdict\tcarries\napart\tsolvable\t1\nclose\tnot found\t\n")
    (tmp_path / "LICENSE").write_text("")
    assert [asked[:2] + asked[3:] for asked in puzzles(tmp_path)] == [
        ("pushworld", "apart", True, ""),
        ("pushworld_touching", "close", False, ""),
    ]
    picture = (tmp_path / "apart" / "world.txt").read_text().replace("b..aa", "baa..")
    (tmp_path / "apart" / "world.txt").write_text(picture)
    assert puzzles(tmp_path)[0].variant == "at wall"
    assert is_touching(read_scenario(tmp_path / "close"))


def test_a_puzzle_is_judged_by_its_own_expectations(tmp_path: Path) -> None:
    puzzle(tmp_path / "apart", ".")
    asked = AskedRun("pushworld", "apart", str(tmp_path / "apart"), True)
    row = run_order(asked, BOUNDS, tmp_path / "out", obedient([], "impossible"))
    assert (row.possible, row.achieved, row.false_impossible) == ("yes", False, True)
    free = run_order(asked, replace(BOUNDS, pull=False), tmp_path / "out", obedient([], "limit"))
    assert free.possible == "unknown"


@pytest.fixture
def counted(tmp_path: Path) -> Callable[..., tuple[int, int]]:
    """Return a function that runs the program with robots that give up, and returns its exit code and its runs."""

    def ran(*arguments: str) -> tuple[int, int]:
        runs = []

        def executor(tasks: Sequence[WorkerTask]) -> Any:
            runs.extend(tasks)
            yield from enumerate(carry_out(task._replace(function=f"{__name__}:giving_up")) for task in tasks)

        return main([*arguments, "-o", str(tmp_path / "results.jsonl")], executor), len(runs)

    return ran


def giving_up(argument: dict[str, Any]) -> dict[str, Any]:
    """Return the row of a run that gives up."""
    return OrderRow(argument["asked"]["kind"], argument["asked"]["name"], possible="yes", verdict="limit").entry()


def test_runs_are_not_repeated(
    counted: Callable[..., tuple[int, int]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert counted("--kinds", "plug", "--count", "2") == (0, 2)
    assert counted("--kinds", "plug", "--count", "2") == (0, 0)
    with (tmp_path / "results.jsonl").open("a") as results:
        results.write('{"kind":"plug","na')  # as a run that was killed leaves it
    assert counted("--kinds", "plug,swap", "--count", "2") == (0, 2)
    assert capsys.readouterr().out.splitlines()[-1].strip().startswith("2 x limit")
    rows = [json.loads(line) for line in (tmp_path / "results.jsonl").read_text().splitlines()]
    assert [(row["kind"], row["name"]) for row in rows] == [("plug", "0"), ("plug", "1"), ("swap", "0"), ("swap", "1")]


def test_a_damaged_file_of_results_is_refused(
    counted: Callable[..., tuple[int, int]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    counted("--kinds", "plug", "--count", "1")
    with (tmp_path / "results.jsonl").open("a") as results:
        results.write('{"kind":"plug","colour":"c"}\n')
    assert counted("--kinds", "plug", "--count", "1") == (2, 0)
    assert "results.jsonl:2" in capsys.readouterr().err
    (tmp_path / "results.jsonl").write_text("notes of mine\n")
    assert counted("--kinds", "plug", "--count", "1") == (2, 0)
    assert (tmp_path / "results.jsonl").read_text() == "notes of mine\n"


def test_a_folder_of_puzzles_that_is_not_there_is_reported(counted: Callable[..., tuple[int, int]]) -> None:
    assert counted("--count", "0", "--pushworld", "/no/such/folder") == (2, 0)


def test_a_folder_without_puzzles_is_reported(
    counted: Callable[..., tuple[int, int]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert counted("--count", "0", "--pushworld", str(tmp_path)) == (2, 0)
    assert "no puzzles in" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--jobs=0", "--count=-1", "--seed=x", "--seconds=0", "--kinds=plug,door"])
def test_an_option_that_makes_no_sense_is_refused(option: str, counted: Callable[..., tuple[int, int]]) -> None:
    with pytest.raises(SystemExit, match="2"):
        counted(option)


def test_the_table_counts_and_tells_reasons() -> None:
    rows = [
        OrderRow(
            "swap", "0", possible="yes", verdict="done", achieved=True, commands=10, carries=2, carried=3, judged=[]
        ),
        OrderRow(
            "swap", "1", possible="yes", verdict="done", false_done=True, refutation="not so", judged=["step 1: bad"]
        ),
        OrderRow("swap", "2", possible="yes", verdict="impossible", false_impossible=True, reason="door is 3.5 wide"),
        OrderRow("swap", "3", verdict="impossible", reason="door is 4 wide", judged=["step 9: expected inside(t1)"]),
        OrderRow("swap", "4", pull=False, possible="yes", verdict="time", wanted=2, met=1),
        OrderRow("plug", "0", possible="yes", verdict="done", achieved=True, commands=20),
        OrderRow("plug", "1", verdict="error", reason="KeyError"),
    ]
    lines = [line.split() for line in table(rows).splitlines()]
    head = "kind tasks possible achieved false done false impossible impossible limit time error judge"
    assert lines[0] == [*head.split(), "commands", "carries", "seconds"]
    assert lines[1] == ["swap", "4", "3", "1", "1", "1", "2", "0", "0", "0", "1/3", "10", "3/2", "0"]
    assert lines[2][:3] == ["swap", "--no-pull", "1"]
    assert lines[3] == ["plug", "2", "1", "1", "0", "0", "0", "0", "0", "1", "0/0", "20", "-", "0"]
    assert lines[4][:4] == ["all", "7", "5", "2"]
    told = failures(rows)
    assert "  2 x impossible: door is # wide" in told
    assert "FALSE done, 1: not so" in told
    assert "swap --no-pull: 1 of 1 failed; 1 of the 2 things that they want are so" in told


def test_kinds_come_in_turn() -> None:
    names = [(asked.kind, asked.name) for asked in random_tasks(["plug", "swap"], 4, 2)]
    assert names == [("plug", "4"), ("swap", "4"), ("plug", "5"), ("swap", "5")]


OPEN_FLOOR = np.ones((12, 20), bool)


def floor_with_wall(door: int) -> np.ndarray:
    """Return a floor of 20 x 12 squares with a wall at x = 9 that has a door of a width, from y = 4 on."""
    free = OPEN_FLOOR.copy()
    free[:, 9] = False
    free[4 : 4 + door, 9] = True
    return free


def test_what_is_behind_a_closed_wall_is_out_of_reach() -> None:
    thing = box(12, 4, 15, 7)
    assert is_in_reach(thing, floor_with_wall(1), (2.5, 2.5))
    assert not is_in_reach(thing, floor_with_wall(0), (2.5, 2.5))
    assert is_in_reach(thing, floor_with_wall(0), (11.5, 3.5))
    assert is_in_reach(thing, floor_with_wall(0), (12.5, 4.5))  # on its squares: not decided


@pytest.mark.parametrize(("door", "may"), [(0, False), (1, False), (5, True), (6, True)])
def test_a_thing_that_is_wider_than_a_door_cannot_pass(door: int, may: bool) -> None:
    assert may_pass(box(2, 4, 7, 9), floor_with_wall(door), box(11, 0, 20, 12)) == may
    assert may_pass(box(2, 4, 7, 9), floor_with_wall(door), box(0, 0, 8, 12))


@settings(max_examples=25, deadline=None)
@given(
    door=st.integers(0, 6), x=st.integers(1, 5), y=st.integers(1, 7), east=st.integers(2, 4), north=st.integers(1, 4)
)
def test_no_carry_that_is_found_is_ruled_out(door: int, x: int, y: int, east: int, north: int) -> None:
    thing, free, region = box(x, y, x + east, y + north), floor_with_wall(door), box(10, 0, 20, 12)
    plan = plan_carrying(thing, free, (0.5, 0.5), Inside(region))
    if plan.status == "found":
        assert is_in_reach(thing, free, (0.5, 0.5))
        assert may_pass(thing, free, region)
        way = swept(thing, plan.legs)
        assert way.intersects(region)
        assert not way.intersects(box(9, 0, 10, 3.9))


def test_a_carry_sweeps_what_it_passes_and_not_where_it_began() -> None:
    leg = Leg((3.5, 1.5), (0, 1), (Translate(6.0, 0.0), Rotate(90.0, (9.5, 1.5))))
    way = swept(box(2, 2, 5, 4), [leg])
    assert way.intersects(box(6, 2.2, 7, 3.8))
    assert not way.intersects(box(2.5, 2.2, 4, 3.8))
    assert way.intersects(Rotate(90.0, (9.5, 1.5)).carry(box(8, 2, 11, 4)))
