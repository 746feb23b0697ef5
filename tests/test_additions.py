"""A thing more of each kind, added to a copy of Utak as docs/guides say, and used in a run."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("geometry", "kb", "planner", "simulator", "utak")


def copy_with(folder: Path, *edits: tuple[str, str, str]) -> Path:
    """Return a copy of the packages in which each edit (file, anchor, text) puts a text before an anchor."""
    for package in PACKAGES:
        shutil.copytree(ROOT / package, folder / package)  # with the kernels that are compiled there
    for name, anchor, text in edits:
        file = folder / name
        before = file.read_text()
        assert before.count(anchor) == 1, f"{anchor!r} stands {before.count(anchor)} times in {name}"
        file.write_text(before.replace(anchor, text + anchor))
    return folder


def run_in(copy: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Return the result of a command of the copy's Utak."""
    start = "import sys; sys.path.insert(0, sys.argv.pop(1)); from utak.launcher import main; sys.exit(main())"
    command = [sys.executable, "-I", "-c", start, str(copy), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=copy)


def scenario(folder: Path, things: str, start: str, goal: str, expected: str) -> Path:
    """Return the folder of a scenario: one room of 30 x 20 squares with some things, and a task."""
    task = folder / "task"
    task.mkdir()
    room = 'verge("POLYGON ((0 0, 0 24, 34 24, 34 0, 0 0), (2 2, 32 2, 32 22, 2 22, 2 2))").'
    (task / "world.lp").write_text(f'table(34, 24). utak("POINT (20.5 14.5)", 0). {room}\n{things}\n')
    (task / "start.lp").write_text(f"{start}\n")
    (task / "goal.lp").write_text(f"{goal}\n")
    (task / "expect.lp").write_text(f"{expected}\n")
    return task


@pytest.mark.long
def test_a_shape_class_more(tmp_path: Path) -> None:
    """A Z in either sense is known by its class, among other things, and pushed into a corner."""
    disc, words = '    ShapeClass("disc", DISC, turns=1),\n', '"l_shape", "t_shape",'
    features = "        (F, (W - F) / 2, H - 2 * F),\n        0.0,\n        2,\n    ),\n"
    zed = f"""    ShapeClass(
        "z_shape",
        RECTANGLES,
        (
            *((-F / 2, -H / 2, W / 2, F - H / 2), (-F / 2, -H / 2, F / 2, H / 2)),
            (-W / 2, H / 2 - F, F / 2, H / 2),
        ),
        (
            *(((W - F) / 2, O), (W, O), (W, F), ((W + F) / 2, F)),
            *(((W + F) / 2, H), (O, H), (O, H - F), ((W - F) / 2, H - F)),
        ),
{features}    ShapeClass(
        "z_shape",
        RECTANGLES,
        (
            *((-W / 2, -H / 2, F / 2, F - H / 2), (-F / 2, -H / 2, F / 2, H / 2)),
            (-F / 2, H / 2 - F, W / 2, H / 2),
        ),
        (
            *((O, O), ((W + F) / 2, O), ((W + F) / 2, H - F), (W, H - F)),
            *((W, H), ((W - F) / 2, H), ((W - F) / 2, F), (O, F)),
        ),
{features}"""
    copy = copy_with(
        tmp_path,
        ("geometry/shapes/classes.py", disc, zed),
        ("kb/language/vocabulary.py", words, '"z_shape", '),
    )
    things = (
        'object(g1, g, "POLYGON ((10 6, 14 6, 14 8, 12 8, 12 12, 8 12, 8 10, 10 10, 10 6))"). '
        'object(g2, g, "POLYGON ((24 4, 30 4, 30 6, 26 6, 26 10, 24 10, 24 4))"). '
        'object(r1, r, "POLYGON ((7 15, 11 15, 11 19, 13 19, 13 21, 9 21, 9 17, 7 17, 7 15))").'
    )
    expected = 'verdict(done). unmoved(g2). unmoved(r1). inside(g1, "POLYGON ((24 14, 32 14, 32 22, 24 22, 24 14))").'
    start = "object(x). shape(x, z_shape). colour(x, g). object(y). shape(y, z_shape). colour(y, r)."
    goal = "at(x, corner(northeast)). at(utak, y)."
    task = scenario(tmp_path, things, start, goal, expected)
    log = tmp_path / "run.jsonl"
    ran = run_in(copy, "run", str(task), "--log", str(log))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    for name in "xy":
        asked = run_in(copy, "query", str(log), f"shape(X, z_shape, C), C > 60, bound({name}, X)")
        assert asked.returncode == 0, asked.stdout + asked.stderr


@pytest.mark.long
def test_a_goal_word_more(tmp_path: Path) -> None:
    """`amid(x, y, z)` says that x lies in the convex hull of y and z; it holds for things and for the robot."""
    row, names = '    "pose": GoalWord(\n', "NAME_ARGUMENT, NAME_ARGUMENT, NAME_ARGUMENT"
    word = f"""    "amid": GoalWord(
        ({names}), (_MOVER, _THING, _THING), ("rect({{0}},", "rect({{1}},", "rect({{2}},")
    ),
"""
    squares = """def hull_of(goal: Fact, situation: Situation) -> Any:
    nodes = [situation.object_of(str(name)) for name in goal.args[1:]]
    known = [mask_to_polygon(situation.model.mask(node.patch)) for node in nodes if node is not None]
    return shapely.union_all(known).convex_hull if len(known) == len(nodes) else None


def _amid(goal: Fact, situation: Situation) -> Destination:
    hull = hull_of(goal, situation)
    if hull is None:
        return unknown_destination("not all of its things are seen yet")
    rows, columns = np.indices(situation.model.labels.shape)
    inside = shapely.contains_xy(hull, columns + 0.5, rows + 0.5) & situation.cost_maps.floor
    return Destination(np.flatnonzero(inside)) if inside.any() else unknown_destination("no way is seen there yet")


"""
    placement = """def _amid(goal: Fact, node: Node, began: XY, situation: Situation) -> Placement:
    hull = hull_of(goal, situation)
    if hull is None:
        return Placement({}, "not all of its things are seen yet")
    return Placement({"amid": Inside(hull)}, some=True)  # its things may be moved


"""
    robot_goals, object_goals = "planner/goals/robot_goals.py", "planner/goals/object_goals.py"
    copy = copy_with(
        tmp_path,
        ("kb/language/goal_words.py", row, word),
        (
            robot_goals,
            "from utak.kb.language.terms import Fact, Symbol\n",
            "from utak.geometry.raster.runs import mask_to_polygon\n",
        ),
        (robot_goals, "# By goal word: where it holds for the robot.\n", squares),
        (robot_goals, '    "beside": _thing,\n', '    "amid": _amid,\n'),
        (object_goals, "# By goal word: where it holds for a thing", placement),
        (object_goals, '    "beside": lambda', '    "amid": _amid,\n'),
        (
            object_goals,
            "from utak.planner.situation import Situation",
            "from utak.planner.goals.robot_goals import hull_of\n",
        ),
    )
    things = (
        'object(g1, g, "POLYGON ((8 6, 8 9, 11 9, 11 6, 8 6))"). '
        'object(r1, r, "POLYGON ((4 14, 4 18, 8 18, 8 14, 4 14))"). '
        'object(c1, c, "POLYGON ((24 14, 24 18, 28 18, 28 14, 24 14))").'
    )
    start = "object(x). colour(x, g). object(y). colour(y, r). object(z). colour(z, c)."
    hull = '"POLYGON ((7.5 13.5, 24.5 13.5, 24.5 18.5, 7.5 18.5, 7.5 13.5))"'
    expected = f"verdict(done). unmoved(r1). unmoved(c1). inside(g1, {hull}). inside(utak, {hull})."
    task = scenario(tmp_path, things, start, "amid(x, y, z). amid(utak, y, z).", expected)
    log = tmp_path / "run.jsonl"
    ran = run_in(copy, "run", str(task), "--log", str(log))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    told = run_in(copy, "explain", str(log), "amid(x, y, z)")
    assert told.stdout.count("\n  rect(") == 3, told.stdout + told.stderr


@pytest.mark.long
def test_a_plan_step_more(tmp_path: Path) -> None:
    """Before something is called impossible, the robot rests for two commands; a rule of a user may forbid that."""
    rest = """% Action rest: the robot rests.

%! because "Before {S} is called impossible, the robot rests."
settles(rest(S), S) :- stuck(S, impossible).
%! because "To rest takes {C} commands."
default_price(rest(S), C) :- settles(rest(S), S), C = 1.
"""
    method = """    _rests = 0

    def _rest(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        self._rests += 1
        return Decision(Release(), "the robot rests") if self._rests == 1 else nothing_to_do("it has rested")

    def _is_resting(self, situation: Situation) -> bool:
        return self._rests == 1

    def _rest_on(self, turn: StageTurn) -> Decision:
        self._rests += 1
        return Decision(Release(), "the robot rests on")

"""
    activities = "planner/agenda/activities.py"
    copy = copy_with(
        tmp_path,
        (
            "kb/language/vocabulary.py",
            '    "find": "what {} is about is looked for",\n',
            '    "rest": "the robot rests, for {}",\n',
        ),
        ("kb/language/vocabulary.py", '"make_way", "try", "feel", "measure", "gauge")', '"rest", '),
        (activities, '            "find": self._towards_first', '            "rest": self._rest,\n'),
        (activities, '            "feel": (clearer', '            "rest": (self._is_resting, self._rest_on),\n'),
        (activities, "    def holds(self, situation", method),
    )
    (copy / "planner" / "asp" / "task" / "rest.lp").write_text(rest)
    task = scenario(tmp_path, "", "", "in(utak, room(next)).", "verdict(impossible).")
    log = tmp_path / "run.jsonl"
    ran = run_in(copy, "run", str(task), "--log", str(log))
    assert ran.stdout.startswith("impossible"), ran.stdout + ran.stderr
    assert log.read_text().count('"the robot rests"') == log.read_text().count('"the robot rests on"') == 1
    (tmp_path / "own.lp").write_text(":- occurs(rest(_), _).\n")
    ran = run_in(copy, "run", str(task), "--kb", str(tmp_path / "own.lp"), "--log", str(log))
    assert ran.stdout and "the robot rests" not in log.read_text(), ran.stderr


@pytest.mark.long
def test_another_retina(tmp_path: Path) -> None:
    """With a fovea twice as wide the robot does the same task, and its episode has as many gray levels."""
    copy = copy_with(tmp_path)
    plan = copy / "geometry" / "counts" / "retina.py"
    zones = "RETINA_ZONES = ((4, 1), (8, 2), (16, 4))"
    assert zones in plan.read_text()
    plan.write_text(plan.read_text().replace(zones, "RETINA_ZONES = ((8, 1), (16, 4))"))
    things = 'object(g1, g, "POLYGON ((8 6, 8 9, 11 9, 11 6, 8 6))").'
    expected = 'verdict(done). inside(g1, "POLYGON ((24 14, 32 14, 32 22, 24 22, 24 14))").'
    task = scenario(tmp_path, things, "object(x). shape(x, square).", "at(x, corner(northeast)).", expected)
    log = tmp_path / "run.jsonl"
    ran = run_in(copy, "run", str(task), "--log", str(log))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    step = json.loads(log.read_text().splitlines()[1])
    assert len(step["retina"]) == 16 * 16 + 48


@pytest.mark.long
def test_a_command_of_the_body_more(tmp_path: Path) -> None:
    """`Home()` puts the body back where it woke, for another mind and in its episode."""
    command = '''@dataclass(frozen=True, slots=True)
class Home:
    """The command to go back to where the robot woke."""


'''
    method = """    def home(self) -> None:
        self.motion = None
        x, y = self.world.utak
        self._move_until_contact(Translate(x - self.utak[0], y - self.utak[1]))

"""
    body, physics = "kb/body.py", "simulator/world/physics.py"
    copy = copy_with(
        tmp_path,
        (body, "Command = Move | Grasp", command),
        (body, "Push, Turn, Grasp, Release)  # each", "Home, "),
        (physics, "    def release(self) -> None:", method),
        ("simulator/episode/schema.json", '"turn", "grasp", "release"]', '"home", '),
    )
    task = scenario(tmp_path, "", "", "at(utak, start).", "verdict(done).")
    program = f"""
import sys
sys.path.insert(0, {str(copy)!r})
import utak
from utak.kb.body import Home

class There(utak.Mind):
    answers = iter((utak.Move(3, 2), Home(), utak.Verdict("done")))
    def step(self, impression):
        return next(self.answers)

run = utak.Run(utak.Scenario.read({str(task)!r}), mind=There)
run.finish()
places = [(step.line["utak"], step.line["action"]) for step in run.episode]
assert places[1][0] != places[0][0] == places[2][0], places
assert places[2][1] == {{"do": "home"}}, places
"""
    ran = subprocess.run([sys.executable, "-I", "-c", program], capture_output=True, text=True, check=False, cwd=copy)
    assert ran.returncode == 0, ran.stdout + ran.stderr
