"""The action cycle on a tiny body: a drawn world, exact moves, nothing else. And the meaning of each goal."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from benchmarks.harness.trial import Conditions, run_trial
from tests.kb.drawings import known_model
from tests.kb.eyes import colours_of, impression, utak_in, world_of
from tests.planner.situations import all_felt
from utak.kb.body import Command, Impression, Move
from utak.kb.language.diagnostics import SourceSpan
from utak.kb.language.terms import Symbol
from utak.kb.perception.frame import turned
from utak.kb.task.task import Claim, Parameter, Task
from utak.kb.world.corners import corners
from utak.kb.world.rooms import rooms_of
from utak.planner.agenda.decider import Decider
from utak.planner.cycle import Options, Robot
from utak.planner.screen.projection import CostMaps
from utak.planner.stages import constraints, stages

NOWHERE = SourceSpan(0, 0, 0)


class DrawnBody:
    """A body in a drawing that wakes in the middle of a square. A command to walk into something is an error.

    Attributes
    ----------
    bumps : whether such a command is allowed, and stops.
    """

    bumps = False

    def __init__(self, rows: list[str], heading: int = 0) -> None:
        self.occupied, self.colours, self.heading = world_of(rows), colours_of(rows), heading
        i, j = utak_in(rows)
        self.place = np.array([i + 0.5, j + 0.5])
        self.track = [self.square]
        self.commands: list[Command] = []

    @property
    def square(self) -> tuple[int, int]:
        return int(self.place[0]), int(self.place[1])

    def wake(self) -> Impression:
        return impression(self.occupied, self.square, self.heading, self.colours)

    def act(self, command: Command) -> Impression:
        assert isinstance(command, Move)
        way = np.array(turned(command.east, command.north, self.heading))
        for part in np.linspace(0, 1, 2000 if self.bumps else 200):
            if self.occupied(*(int(v) for v in self.place + part * way)):
                assert self.bumps
                way *= part - 1 / 2000
                break
        self.place = self.place + way
        self.track.append(self.square)
        self.commands.append(command)
        return impression(self.occupied, self.square, self.heading, self.colours)


def term(text: str) -> Symbol:
    name, _, rest = text.partition("(")
    return Symbol(name, tuple(term(part) for part in rest[:-1].split(",") if part), NOWHERE)


def goal(name: str, who: str, where: Symbol) -> Symbol:
    return Symbol(name, (term(who), where), NOWHERE)


NORTHEAST = goal("at", "utak", term("corner(northeast)"))
SQUARE = Task(
    {"x": Parameter("x", "object", NOWHERE)},
    (Claim(term("shape(x,square)")),),
    (goal("at", "utak", term("x")),),
)

EMPTY = ["b" * 22, *["b" + "." * 20 + "b"] * 10, "b...U" + "." * 16 + "b", *["b" + "." * 20 + "b"] * 5, "b" * 22]
THINGS = ["b" * 24, *["b" + "." * 22 + "b"] * 3, *["b" + "." * 12 + "ggg" + "." * 7 + "b"] * 3]
THINGS += ["b" + "." * 22 + "b"] * 5 + ["b...U" + "." * 18 + "b"] + ["b" + "." * 22 + "b"] * 4 + ["b" * 24]


ROOMS = ["b" * 32, *["b" + "." * 14 + "bb" + "." * 14 + "b"] * 6, *["b" + "." * 30 + "b"] * 4]
ROOMS += ["b..U" + "." * 11 + "bb" + "." * 14 + "b", *["b" + "." * 14 + "bb" + "." * 14 + "b"] * 5, "b" * 32]


def run(rows: list[str], task: Task, heading: int = 0, **options: int) -> tuple[Robot, DrawnBody]:
    body = DrawnBody(rows, heading)
    robot = Robot(body, task, Options(**options))
    robot.wake()
    while not robot.finished:
        robot.step()
    return robot, body


def test_the_northeast_corner_of_a_plain_room() -> None:
    robot, body = run(EMPTY, Task({}, (), (NORTHEAST,)))
    assert robot.verdict.believed
    assert robot.verdict.verdict == "done"
    assert body.square == (20, 16)
    assert robot.steps == len(body.track) - 1 <= 8


def two_rooms(west: int, east: int, door: range) -> list[str]:
    """Return two rooms 14 squares wide on one southern wall, `west` and `east` squares long, with a door between."""
    rows = ["b" * 32]
    for north in range(max(west, east), 0, -1):
        left, right = ("." if north <= size else "b" for size in (west, east))
        rows.append("b" + left * 14 + ("bb" if north not in door else "..") + right * 14 + "b")
    return [*rows, rows[0]]


def with_utak(rows: list[str], column: int, north: int) -> list[str]:
    """Return a drawing with Utak in a square; the one in the southwest corner of the floor is (1, 1)."""
    row = len(rows) - 1 - north
    return [r[:column] + "U" + r[column + 1 :] if k == row else r for k, r in enumerate(rows)]


@pytest.mark.long
@pytest.mark.parametrize("seed", [24027, 27006, 65024, 66007, 71009, 76045, 85039])
def test_the_furthest_corner_may_lie_in_a_room_that_is_not_seen_yet(seed: int, tmp_path: Path) -> None:
    trial = run_trial(1, seed, Conditions(), tmp_path)
    assert trial.right, (trial.verdict, trial.reason, trial.crash)


@pytest.mark.long
def test_unseen_floor_beside_a_door_is_looked_at_before_the_next_room_counts_as_reached(
    tmp_path: Path,
) -> None:
    trial = run_trial(2, 63026, Conditions(), tmp_path)
    assert trial.right, (trial.verdict, trial.reason, trial.crash)


@pytest.mark.long
def test_a_robot_that_wakes_beside_a_doorway_is_in_the_room_on_its_side(tmp_path: Path) -> None:
    trial = run_trial(2, 83026, Conditions(), tmp_path)
    assert trial.right, (trial.verdict, trial.reason, trial.crash)


def test_a_room_that_cannot_reach_further_is_not_visited() -> None:
    robot, body = run(with_utak(two_rooms(14, 40, range(3, 7)), 22, 34), Task({}, (), (NORTHEAST,)))
    assert robot.verdict.verdict == "done"
    assert body.square == (30, 40)
    assert all(x >= 17 for x, _ in body.track)


def test_an_object_seen_beyond_a_wall_is_reached_by_the_door() -> None:
    rows = ["b" * 32, *["b" + "." * 14 + "bb" + "." * 14 + "b"] * 6, *["b" + "." * 30 + "b"] * 4]
    rows += ["b" + "." * 14 + "bb" + "." * 14 + "b"] * 3
    rows += ["b" + "." * 14 + "bb" + "." * 4 + "ggg" + "." * 7 + "b"] * 2
    rows += ["b" + "." * 10 + "U..." + "bb" + "." * 4 + "ggg" + "." * 7 + "b"]
    rows += ["b" + "." * 14 + "bb" + "." * 14 + "b"] * 3 + ["b" * 32]
    robot, body = run([row[:15] + row[-17:] for row in rows], SQUARE)
    assert robot.verdict.verdict == "done"
    assert body.square[0] > 16


@pytest.mark.long
def test_around_the_corner_is_out_of_sight() -> None:
    rows = ["b" * 34, *["b" * 20 + "." * 13 + "b"] * 14, *["b" + "." * 32 + "b"] * 5]
    rows += ["b..U" + "." * 29 + "b", *["b" + "." * 32 + "b"] * 2, "b" * 34]
    robot, body = run(rows, Task({}, (), (goal("around", "utak", term("corner")),)))
    assert robot.verdict.verdict == "done"
    start, end = (np.array(square) + 0.5 for square in (body.track[0], body.square))
    seen = [not body.occupied(*(int(v) for v in start + part * (end - start))) for part in np.linspace(0, 1, 500)]
    assert not all(seen)
    plain, _ = run(EMPTY, Task({}, (), (goal("around", "utak", term("corner")),)))
    assert plain.verdict.verdict == "impossible"  # its walls were all felt


def test_the_robot_goes_to_the_square() -> None:
    robot, body = run(THINGS, SQUARE)
    assert robot.verdict.believed
    x, y = body.square
    assert 12 <= x <= 16
    assert 10 <= y <= 14


@pytest.mark.long
def test_an_object_that_is_not_there_is_searched_and_given_up() -> None:
    robot, body = run(EMPTY, SQUARE)
    assert not robot.verdict.believed
    assert robot.verdict.verdict != "done"
    assert "x" in robot.verdict.reason
    assert len(body.track) == len(set(body.track))


def test_the_limit_of_commands() -> None:
    robot, body = run(EMPTY, Task({}, (), (NORTHEAST,)), max_steps=1)
    assert robot.verdict[:2] == (False, "limit")
    assert len(body.track) == 2
    assert "1 command" in robot.verdict.reason


def test_nothing_happens_after_the_end() -> None:
    robot, _ = run(EMPTY, Task({}, (), (NORTHEAST,)))
    with pytest.raises(ValueError, match="finished"):
        robot.step()


def test_each_step_reports_command_belief_and_reason() -> None:
    body = DrawnBody(THINGS)
    robot = Robot(body, SQUARE, Options())
    report = robot.wake()
    assert report.command is None
    while not robot.finished:
        report = robot.step()
        assert isinstance(report.command, Move)
        assert report.why
        x, y = report.belief["place"]
        assert (x + body.track[0][0] + 0.5, y + body.track[0][1] + 0.5) == pytest.approx(tuple(body.place))
        assert sum(report.belief["cells"].values()) == 160
        assert report.belief["cells"].get("noise", 0) == 0
        assert all(fact.endswith(").") for fact in report.belief["facts"])
    assert set(report.belief["bound"]) == {"x"}


@pytest.mark.long
def test_adopting_what_counts_already_changes_nothing() -> None:
    """The newest impression is interpreted anew with the same outcome however often; the run stays the same."""
    want, body = run(THINGS, SQUARE)[1].commands, DrawnBody(THINGS)
    robot = Robot(body, SQUARE, Options())
    with pytest.raises(ValueError, match="has not been woken"):
        robot.adopt(SQUARE, Options())
    report = robot.wake()
    while not robot.finished:
        assert robot.adopt(SQUARE, Options()) == report
        assert robot.adopt(Task({}, (), (NORTHEAST,)), Options()) != report
        assert robot.adopt(SQUARE, Options()) == report  # what was adopted between leaves no trace
        report = robot.step()
    assert body.commands == want


@pytest.mark.long
@pytest.mark.parametrize("task", [Task({}, (), (NORTHEAST,)), SQUARE], ids=["corner", "square"])
def test_a_quarter_turn_of_table_and_heading_changes_nothing(task: Task) -> None:
    rows, want = THINGS, run(THINGS, task)[1].commands
    for heading in (90, 180, 270):
        rows = [row[::-1] for row in zip(*rows[::-1], strict=True)][::-1]
        assert run(["".join(row) for row in rows], task, heading)[1].commands == want


def test_the_next_room() -> None:
    task = Task({}, (), (goal("in", "utak", term("room(next)")),))
    robot, body = run(ROOMS, task)
    assert robot.verdict.believed
    assert body.square[0] >= 17


@pytest.mark.long
def test_the_robot_goes_round_an_object_and_back() -> None:
    circled = goal("circled", "utak", term("x"))
    task = Task(SQUARE.parameters, SQUARE.claims, (circled, goal("at", "utak", term("start"))))
    robot, body = run(THINGS, task)
    assert robot.verdict.believed
    x, y = body.track[0]
    assert max(abs(body.square[0] - x), abs(body.square[1] - y)) <= 1
    about = (14.5, 12.5)
    angles = [math.atan2(j + 0.5 - about[1], i + 0.5 - about[0]) for i, j in [*body.track, body.track[0]]]
    turns = sum((b - a + math.pi) % (2 * math.pi) - math.pi for a, b in pairwise(angles)) / (2 * math.pi)
    assert abs(round(turns)) == 1


def test_first_and_then_are_attained_one_after_the_other() -> None:
    corner = goal("at", "utak", term("corner(southwest)"))
    task = Task({}, (), (Symbol("first", (NORTHEAST,), NOWHERE), Symbol("then", (corner,), NOWHERE)))
    robot, body = run(EMPTY, task)
    assert robot.verdict.believed
    assert body.square == (1, 1)
    assert (20, 16) in body.track


def test_the_same_world_is_walked_the_same_way() -> None:
    assert run(THINGS, SQUARE)[1].track == run(THINGS, SQUARE)[1].track


def test_stages_and_constraints() -> None:
    circled, at = goal("circled", "utak", term("x")), goal("at", "utak", term("start"))
    never = goal("not_through", "utak", term("d"))
    task = Task({}, (), (at, never, circled))
    assert [stage.goals for stage in stages(task)] == [(circled,), (at,)]
    assert constraints(task) == (never,)
    first, then = (Symbol(word, (g,), NOWHERE) for word, g in (("first", at), ("then", NORTHEAST)))
    assert [stage.goals for stage in stages(Task({}, (), (first, then)))] == [(at,), (NORTHEAST,)]


def test_the_destination_of_a_corner_is_its_square() -> None:
    from utak.planner.goals.robot_goals import destination
    from utak.planner.situation import Situation

    model = known_model(EMPTY)
    situation = _situation(Situation, model, {})
    squares = destination(NORTHEAST, situation).squares
    row, column = model.view.locate(16.5, 10.5)
    assert row * model.labels.shape[1] + column in squares.tolist()
    for square in squares:
        r, c = divmod(int(square), model.labels.shape[1])
        assert abs(r - row) <= 1
        assert abs(c - column) <= 1


def test_the_destination_of_an_object_is_beside_it() -> None:
    from utak.planner.goals.robot_goals import destination
    from utak.planner.situation import Situation

    model = known_model(THINGS)
    (node,) = model.objects
    found = destination(SQUARE.goals[0], _situation(Situation, model, {"x": node.name}))
    assert not found.missing
    mask = model.mask(node.patch)
    for square in found.squares:
        r, c = divmod(int(square), model.labels.shape[1])
        assert np.abs(np.argwhere(mask) - (r, c)).sum(1).min() == 1
        assert CostMaps(model).floor[r, c]
    missing = destination(SQUARE.goals[0], _situation(Situation, model, {}))
    assert missing.missing
    assert len(missing.squares) == 0


def _situation(kind, model, binding):  # type: ignore[no-untyped-def]
    """Return a situation, with whatever fields it has."""
    known = {"model": model, "cost_maps": CostMaps(model), "binding": binding, "rooms": rooms_of(model)}
    known |= {"corners": corners(model), "task": SQUARE, "rules": (), "track": ()}
    return kind(**{name: known[name] for name in kind.__dataclass_fields__ if name in known})


def test_a_window_that_begins_elsewhere_changes_nothing() -> None:
    model = known_model(THINGS)
    one = CostMaps(model)
    shift, view = ((0, 0), (3, 0)), model.view
    padded = view._replace(
        west=view.west - 3,
        state=np.pad(view.state, shift, constant_values=-1),
        seen=np.pad(view.seen, shift),
        settled_by=np.pad(view.settled_by, shift, constant_values=-1),
        probability=np.pad(view.probability, shift, constant_values=0.5),
    )
    other = CostMaps(replace(model, view=padded, labels=np.pad(model.labels, ((0, 0), (3, 0)))))
    assert np.array_equal(one.floor, other.floor[:, 3:])
    assert other.here == (one.here[0] + 3, one.here[1])


@pytest.mark.long
def test_a_robot_that_is_carried_off_does_its_task_all_the_same() -> None:
    for seed in range(3):
        rng = np.random.default_rng(seed)
        body = DrawnBody(THINGS, int(rng.integers(-44, 46)))
        robot = Robot(body, Task({}, (), (NORTHEAST,)), Options(max_steps=60))
        robot.wake()
        robot.step()
        body.place = np.array([rng.integers(2, 9), rng.integers(1, 12)]) + 0.5  # somebody carries the robot there
        body.occupied, body.colours = world_of(ROOMS), colours_of(ROOMS)  # into another house
        body.bumps = True
        while not robot.finished:
            robot.step()
        assert robot.verdict.verdict == "done"
        assert body.square == (30, 16)


@pytest.mark.parametrize(
    ("anew", "shaken", "verdict"),
    [(False, False, "impossible"), (True, False, "impossible"), (False, True, "limit"), (True, True, "limit")],
)
def test_nothing_is_proved_of_the_unseen_while_impressions_contradict_each_other(
    anew: bool, shaken: bool, verdict: str
) -> None:
    assert "it is felt" in Decider(SQUARE).decide(known_model(EMPTY), [(0.5, 0.5)]).why
    model = all_felt(known_model(EMPTY))
    found = Decider(SQUARE).decide(model, [model.place])
    assert (found.command, found.verdict) == (None, "impossible")
    after = Decider(SQUARE).decide(replace(model, anew=anew, shaken=shaken), [model.place])
    assert (after.command, after.verdict) == (None, verdict)
    said = after.why.partition(";")[0].replace("since the map was begun anew", "so far")
    assert found.why.startswith(said)
