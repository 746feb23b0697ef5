"""`utak explain --fix` from the command line, with the robot itself in tiny worlds; and leading it to a place."""

import json
from pathlib import Path

import pytest

from utak.simulator.cli.main import main
from utak.simulator.episode.episode import EpisodeLog, read_episode
from utak.simulator.episode.schema import complaints
from utak.simulator.explaining.fixing.changes import Led, variant_of
from utak.simulator.explaining.fixing.leading import free_squares, lead, move_towards, way_between
from utak.simulator.explaining.fixing.proving import Budget, VariantProver
from utak.simulator.explaining.fixing.recorded import recorded_run
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Session
from utak.simulator.scenario.scenario import Scenario, read_scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.world.physics import Tabletop

pytestmark = pytest.mark.long

CLOSED = """\
bbbbbbbbbbbbbbbbb
b.......b.......b
b.......b.......b
b.......b.......b
b.......b.......b
b..U....b.......b
b.......b.......b
b.......b.......b
bbbbbbbbbbbbbbbbb
"""


def scenario(folder: Path, world: str, start: str, goal: str, expect: str | None = None) -> Path:
    """Write a scenario and return its folder."""
    folder.mkdir()
    files = {"world.txt": world, "start.lp": start, "goal.lp": goal} | ({"expect.lp": expect} if expect else {})
    for name, text in files.items():
        (folder / name).write_text(text)
    return folder


@pytest.fixture(scope="module")
def closed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the episode of a run in a closed room, whose goal is the next one."""
    folder = tmp_path_factory.mktemp("closed")
    expect = 'inside(utak, "POLYGON ((9 1, 16 1, 16 8, 9 8, 9 1))").'
    made = scenario(folder / "s", CLOSED, "% nothing", "in(utak,room(next)).", expect)
    assert main(["run", str(made), "--log", str(folder / "ep.jsonl")]) == 1
    return folder / "ep.jsonl"


def test_a_new_door_is_found_and_written(closed: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    new = tmp_path / "new"
    assert main(["explain", str(closed), "--fix", "--json", "--write", str(new)]) == 0
    out, err = capsys.readouterr()
    answer = json.loads(out)
    assert err == ""
    assert list(complaints("fix", answer)) == []
    assert answer["repeated"] and not answer["needless"] and answer["ended"] == ""
    (fix,) = answer["fixes"]
    (change,) = fix["changes"]
    assert change["change"] == "new_door"
    assert (change["from"], change["to"]) == (0.0, change["by"])
    assert fix["verdict"] == "done" and fix["achieved"] and fix["smallest"] and fix["least"]
    assert change["table"]["left"][0] == 8.5
    assert change["robot"]["left"] == [change["table"]["left"][0] - 3.5, change["table"]["left"][1] - 3.5]
    assert main(["check", str(new)]) == 0
    capsys.readouterr()
    assert main(["run", str(new), "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert (again["steps"], again["achieved"]) == (fix["steps"], True)


def test_a_budget_that_ends_is_told(closed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", str(closed), "--fix", "--runs", "1", "--depth", "long"]) == 1
    out, err = capsys.readouterr()
    assert "no change was found" in out
    assert err == "utak: the budget of 1 runs ended: not everything was tried\n"


def test_an_episode_that_was_altered_is_told(closed: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = closed.read_text().splitlines()
    result = json.loads(lines[-1])
    result["result"]["steps"] += 1
    (tmp_path / "ep.jsonl").write_text("\n".join([*lines[:-1], json.dumps(result)]) + "\n")
    assert main(["explain", str(tmp_path / "ep.jsonl"), "--fix", "--runs", "1"]) == 1
    assert "does not end as it is recorded" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options",
    [
        ["--fix", "object(x)"],
        ["--fix", "--cell", "3"],
        ["--fix", "--at", "1"],
        ["--runs", "3"],
        ["--seconds", "3"],
        ["--write", "here"],
        ["--fix", "--number", "1"],
        ["--fix", "--runs", "0"],
        ["--fix", "--seconds", "-1"],
    ],
    ids=" ".join,
)
def test_wrong_usage(options: list[str], closed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", str(closed), *options]) == 2
    assert capsys.readouterr().out == ""


def test_what_cannot_be_opened_or_read(closed: Path, tmp_path: Path) -> None:
    assert main(["explain", str(tmp_path / "none"), "--fix"]) == 66
    assert main(["explain", str(closed), "--fix", "--write", str(closed.parent)]) == 66
    assert main(["explain", str(closed), "--fix", "--write", str(closed)]) == 66
    (tmp_path / "bad").write_text("{}\n")
    assert main(["explain", str(tmp_path / "bad"), "--fix"]) == 65


def test_a_run_that_works_needs_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made = scenario(tmp_path / "one", CLOSED, "% nothing", "at(utak,start).")
    main(["run", str(made), "--log", str(tmp_path / "one.jsonl")])
    capsys.readouterr()
    assert main(["explain", str(tmp_path / "one.jsonl"), "--fix"]) == 1
    assert "nothing needs to be changed" in capsys.readouterr().out


@pytest.mark.parametrize("heading", [0, 90, 37])
def test_a_command_that_leads_moves_as_it_should(heading: int) -> None:
    folder = Path(__file__).parents[4] / "examples" / "go_northeast"
    world = read_scenario(folder).world
    table = Tabletop(type(world)(**{**vars(world), "heading": heading}))
    x, y = table.utak
    command = move_towards((1.5, -0.5), heading)
    table.move(command.east, command.north)
    assert table.utak == pytest.approx((x + 1.5, y - 0.5))


def test_the_robot_is_led_to_a_place_and_then_acts_by_itself(closed: Path) -> None:
    run = recorded_run("ep", read_episode(closed))
    place = (6.5, 6.5)
    variant = variant_of(run.scenario, run.settings, [Led(place, "a corner")])
    assert variant is not None and variant.led == (place,)
    session = Session(run.scenario, run.settings, make_robot, EpisodeLog(None))
    session.wake()
    assert lead(session, place, lambda: None)
    assert session.table.utak == pytest.approx(place)
    assert session.line["why"] == "the robot is led here by a command that is given to it"
    while not session.finished:
        session.step()
    assert session.end().verdict != "done"
    outcome = VariantProver(run.scenario, run.settings, Budget(2)).outcome((Led(place, "a corner"),))
    assert outcome.led_commands == 1 and not outcome.works


def test_no_way_leads_through_walls(closed: Path) -> None:
    world = recorded_run("ep", read_episode(closed)).scenario.world
    free = free_squares(world)
    assert way_between(free, world.utak, (12.5, 4.5)) == []
    assert way_between(free, world.utak, (8.5, 4.5)) == []
    assert way_between(free, world.utak, (6.5, 4.5))[-1] == (6.5, 4.5)
    assert (
        not VariantProver(
            Scenario(world, recorded_run("ep", read_episode(closed)).scenario.task, None), Settings(), Budget(1)
        )
        .outcome((Led((12.5, 4.5), "beyond"),))
        .works
    )
