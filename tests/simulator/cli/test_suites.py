"""Many scenarios at once, and scenarios from elsewhere: a bad one is reported and the others are still run."""

import csv
import json
import os
import re
import shlex
import shutil
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
import scripted_robot
from random_scenes import write_scene

from utak.kb.language.source_text import lies_outside, read_source
from utak.simulator.cli.main import main
from utak.simulator.episode.schema import complaints
from utak.simulator.terminal import exits
from utak.simulator.testing.grades import as_csv
from utak.simulator.testing.record import Wish, without_run

SECRET = "root_x17(toor_x18).\nand nonsense_x19 :- so(0n_x20.\n"


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a scenario that passes its test with the scripted robot."""
    monkeypatch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
    scripted_robot.install()
    folder = write_scene(tmp_path / "suite" / "good", 1)
    (folder / "expect.lp").write_text("fails.")
    return folder


def suite(scene: Path) -> Path:
    """Return a folder with the valid scenario and three invalid ones."""
    root = scene.parent
    (shutil.copytree(scene, root / "a_failed") / "expect.lp").write_text("within(0).")
    (shutil.copytree(scene, root / "b_bad") / "expect.lp").write_text("within(x).")
    (shutil.copytree(scene, root / "c_absent") / "world.lp").unlink()
    return root


def test_tests_continue_after_a_bad_scenario(
    scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    root = suite(scene)
    assert main(["test", str(root), str(root / "nowhere")]) == 66
    seen = capsys.readouterr()
    for word, name in (("FAILED", "a_failed"), ("BAD", "b_bad"), ("ABSENT", "c_absent"), ("ok", "good")):
        assert f"{word} {root / name}: " in seen.out
    assert f"{root / 'b_bad' / 'expect.lp'}:1:8-8: error: a number of steps" in seen.err
    assert "1 of 5 passed, 1 failed, 1 bad, 2 cannot be opened" in seen.err
    assert main(["test", str(root / "good"), str(root / "b_bad")]) == 65
    step = scripted_robot.Robot.step

    def failing(robot: scripted_robot.Robot) -> scripted_robot.Report:
        return step(robot) if len(os.environ.get("BROKEN", "")) % 2 else 1 // 0  # type: ignore[return-value]

    monkeypatch.setattr(scripted_robot.Robot, "step", failing)
    assert main(["test", str(root)]) == 70
    seen = capsys.readouterr()
    assert f"BUG {root / 'good'}: " in seen.out
    assert "2 ended by a bug of ours" in seen.err
    assert "a bug of ours: ZeroDivisionError" in seen.err


def test_outcomes_are_one_json_object_and_junit_xml(
    scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    root, junit = suite(scene), tmp_path / "junit.xml"
    (scene / "expect.lp").write_text("fails. within(3). weight(fails, 2). weight(within(3), 3).")
    arguments = ["test", str(root), str(root / "nowhere"), "--json", "--junit", str(junit), "--seed", "7"]
    assert main(arguments) == 66
    first = capsys.readouterr().out
    found = json.loads(first)
    assert list(complaints("test", found)) == []
    assert found["exit_code"] == 66
    assert found["counts"] == {"passed": 0, "failed": 2, "bad": 1, "absent": 2, "bug": 0}
    assert found["points"] == {"earned": 2, "possible": 7}  # that of the absent world, too, whose expect.lp is there
    assert all(list(one) == list(found["scenarios"][0]) for one in found["scenarios"])
    by_name = {Path(one["scenario"]).name: one for one in found["scenarios"]}
    assert set(by_name) == {"nowhere", "a_failed", "b_bad", "c_absent", "good"}
    good = by_name["good"]
    assert (good["outcome"], good["verdict"], good["steps"]) == ("failed", "limit", 30)
    assert good["points"] == {"earned": 2, "possible": 5}
    assert good["expectations"] == [
        {"expected": "fails", "met": True, "came": "", "points": 2},
        {"expected": "within(3)", "met": False, "came": "30 commands were given", "points": 3},
    ]
    assert good["faults"] == ["not met: within(3): 30 commands were given"]
    assert good["options"]["seed"] == 7
    assert [step["step"] for step in good["last_steps"]] == [26, 27, 28, 29, 30]
    assert good["command"] == f"utak test {scene} --seed 7"
    assert "b_bad/expect.lp:1:8-8: error: a number of steps" in by_name["b_bad"]["error"]
    suites = ElementTree.parse(junit).getroot()
    assert suites.attrib == {"name": "utak", "tests": "5", "failures": "2", "errors": "3"}
    assert main(arguments) == 66
    assert capsys.readouterr().out == first  # the same, byte for byte: no times
    assert main([*arguments, "--times"]) == 66
    assert all(one["seconds"] >= 0 for one in json.loads(capsys.readouterr().out)["scenarios"][1:])
    assert "time" in ElementTree.parse(junit).getroot()[0].attrib or "seconds" not in found["scenarios"][0]


def test_grades_are_a_table_for_spreadsheets(scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root, table = suite(scene), tmp_path / "grades.csv"
    (scene / "expect.lp").write_text("fails. within(3). weight(fails, 2). weight(within(3), 3).")
    for _ in range(2):  # its own file is overwritten
        assert main(["test", str(root), "--csv", str(table), "-k", "o"]) == 66
        rows = list(csv.DictReader(table.read_text().splitlines()))
        assert {Path(row["scenario"]).name: (row["outcome"], row["earned"], row["possible"]) for row in rows} == {
            "a_failed": ("failed", "0", "1"),
            "b_bad": ("bad", "", ""),
            "c_absent": ("absent", "0", "1"),
            "good": ("failed", "2", "5"),
        }
    assert rows[-1]["why"] == "not met: within(3): 30 commands were given"
    table.write_text("a,b\n1,2\n")
    assert main(["test", str(root), "--csv", str(table)]) == 66
    assert table.read_text() == "a,b\n1,2\n"
    assert "it is no table of grades" in capsys.readouterr().err
    formula = without_run(Wish("=1+1", "=1+1", {}), 66, "\x1b[2J")
    assert as_csv([formula]).splitlines()[1] == "'=1+1,absent,,,,,\\u001b[2J"


@pytest.mark.parametrize("missing", ["goal.lp", "start.lp", "world.lp"])
def test_a_scenario_without_one_of_its_files_earns_nothing_of_what_is_promised(
    missing: str, scene: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (scene / "expect.lp").write_text("fails. weight(fails, 4).")
    (scene / missing).unlink()
    for more in ([], ["--untrusted"]):
        assert main(["test", str(scene.parent), "--json", *more]) == 66
        assert json.loads(capsys.readouterr().out)["points"] == {"earned": 0, "possible": 4}


def test_junit_overwrites_no_other_file_and_says_so_before_anything_runs(
    scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "precious.txt"
    other.write_text("precious")
    assert main(["test", str(scene), "--junit", str(other)]) == 66
    seen = capsys.readouterr()
    assert (seen.out, other.read_text()) == ("", "precious")
    assert "it is no JUnit XML, and is not overwritten without --force" in seen.err
    assert main(["test", str(scene), "--junit", str(tmp_path / "no" / "j.xml")]) == 66
    assert main(["test", str(scene), "--junit", str(other), "--force"]) == 0
    assert main(["test", str(scene), "--junit", str(other)]) == 0


def test_scenarios_are_chosen_by_a_part_of_their_path(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root = suite(scene)
    assert main(["test", str(root), "-k", "GOOD"]) == 0
    assert capsys.readouterr().out.count("\n") == 1
    assert main(["test", str(root), str(root / "good"), "-k", "good"]) == 0
    assert capsys.readouterr().out.count("\n") == 1  # each scenario once
    assert main(["test", str(root), "-k", "nonsense"]) == 66
    assert "none of the 4 scenarios has that in its name" in capsys.readouterr().err


def test_points_are_told_where_they_are_weighed(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (scene / "expect.lp").write_text("fails. weight(fails, 4).")
    assert main(["test", str(scene)]) == 0
    seen = capsys.readouterr()
    assert seen.out == f"ok {scene}: 4 of 4 points: limit in 30 steps: the script has ended\n"
    assert "1 of 1 passed; 4 of 4 points" in seen.err


def test_what_a_scenario_is_worth_does_not_depend_on_whether_it_can_be_run(
    scene: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A pupil's goal.lp with an error in it earns nothing of the points that expect.lp and trial.lp promise."""
    (scene / "expect.lp").write_text("fails. weight(fails, 4).")
    (scene / "trial.lp").write_text('max_steps(5). asks("unseen(R, N)", rows(1)).')
    (scene / "goal.lp").write_text("at(utak, cornr(northeast)).")
    for jobs in ("1", "2"):
        assert main(["test", str(scene), str(scene), "--json", "--jobs", jobs]) == 65
        found = json.loads(capsys.readouterr().out)
        assert list(complaints("test", found)) == []
        assert found["points"] == {"earned": 0, "possible": 5}
    assert main(["test", str(scene)]) == 65
    assert capsys.readouterr().out == f"BAD {scene}: 0 of 5 points: see above\n"
    (scene / "expect.lp").write_text("fails. weight(")
    assert main(["test", str(scene), "--json"]) == 65
    assert json.loads(capsys.readouterr().out)["scenarios"][0]["points"] is None


def test_commands_that_repeat_a_test_take_any_name(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    scene.rename(tmp_path / "-odd\nname")
    assert main(["test", "./-odd\nname", "--json"]) in (0, 1)
    command = json.loads(capsys.readouterr().out)["scenarios"][0]["command"]
    assert main(shlex.split(command)[1:]) in (0, 1)
    (tmp_path / "-odd\nname" / "goal.lp").write_text("at(")
    assert main(shlex.split(command)[1:]) == 65
    error = capsys.readouterr().err.splitlines()[-4]
    assert error.startswith("-odd\\u000aname/goal.lp:1:"), error


def test_a_plan_sets_options_and_asks(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (scene / "rules.lp").write_text("much(R) :- unseen(R, N), N > 20.")
    (scene / "trial.lp").write_text(
        'max_steps(5). seed(3). rules("rules.lp"). asks("much(R)", row(r1)). asks("unseen(R, N)", row(r1, 25)).'
        'weight(asks("much(R)", row(r1)), 3). asks("nonsense(X)", yes).'
    )
    (scene / "expect.lp").write_text("verdict(limit).")
    assert main(["check", str(scene)]) == 0
    capsys.readouterr()
    assert main(["test", str(scene), "--json", "--max-steps", "10"]) == 1
    one = json.loads(capsys.readouterr().out)["scenarios"][0]
    assert (one["steps"], one["options"]["seed"]) == (10, 3)  # the command line wins
    assert one["points"] == {"earned": 1, "possible": 6}
    assert [(e["met"], e["points"]) for e in one["expectations"]] == [(True, 1), (False, 3), (False, 1), (False, 1)]
    came = [e["came"] for e in one["expectations"]]
    assert came[1] == "the answer is no"
    assert "the answer has 1 row: r1, 0" in came
    assert any("the question cannot be answered: unknown predicate nonsense/1" in text for text in came)
    (scene / "rules.lp").write_text("much(R) :- unseen(R, N")
    assert main(["check", str(scene)]) == 65
    assert main(["test", str(scene)]) == 65
    (scene / "rules.lp").unlink()
    assert main(["test", str(scene)]) == 66


def test_checks_continue_after_a_bad_scenario(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root = suite(scene)
    assert main(["check", str(root), str(root / "nowhere")]) == 66
    seen = capsys.readouterr()
    assert seen.out.count(": ok\n") == 2
    assert f"{root / 'b_bad' / 'expect.lp'}:1:8-8: error: a number of steps" in seen.err
    assert "2 ok, 1 bad, 2 cannot be opened" in seen.err
    assert main(["check", str(root / "good"), str(root / "b_bad")]) == 65


def test_the_exit_code_is_the_most_severe_one() -> None:
    assert exits.worst([]) == 0
    assert exits.worst([0, 1, 0]) == 1
    assert exits.worst([1, 65, 0]) == 65
    assert exits.worst([66, 65]) == 66
    assert exits.worst([66, 70, 1]) == 70


@pytest.mark.parametrize("text", ["", "\n", "% nothing yet\n"])
def test_an_empty_expectation_is_refused(text: str, scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (scene / "expect.lp").write_text(text)
    for command in ("run", "test", "check"):
        assert main([command, str(scene)]) == 65
        assert "expect.lp:1:1-1: error: nothing is expected" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["start.lp", "goal.lp", "expect.lp", "world.lp", "world.txt"])
@pytest.mark.parametrize("command", ["run", "test", "check", "show", "query", "repl", "routes"])
def test_messages_hide_the_text_of_a_file_behind_a_link(
    name: str, command: str, scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "secret").write_text(SECRET)
    if name == "world.txt":
        (scene / "world.lp").unlink()
    (scene / name).unlink(missing_ok=True)
    (scene / name).symlink_to(tmp_path / "secret")
    more = {"query": ["node(X)"], "routes": ["--from", "1,1", "--to", "2,2"]}.get(command, [])
    code = main([command, str(scene), *more])
    seen = capsys.readouterr()
    if "world" in name or command not in ("show", "routes"):
        assert code == 65
        assert re.search(rf"{name}:\d+:", seen.err)
    assert not [word for word in ("x17", "x18", "x19", "x20", "nonsense") if word in seen.out + seen.err]
    assert main([command, str(scene), *more, "--untrusted"]) == 66
    assert "a link out of its folder" in capsys.readouterr().err


def test_links_inside_the_folder_are_read(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (scene / "goal.lp").rename(scene / "real.lp")
    (scene / "goal.lp").symlink_to("real.lp")
    other = scene.parent.parent / "other"
    other.symlink_to(scene)
    for folder in (scene, other):
        assert main(["check", str(folder), "--untrusted"]) == 0
    (scene / "real.lp").write_text("at(utak, cornr(northeast)).")
    assert main(["check", str(other), "--untrusted"]) == 65
    assert "at(utak, cornr(northeast))." in capsys.readouterr().err


def test_a_linked_folder_in_a_suite_is_refused_too(scene: Path, tmp_path: Path) -> None:
    shutil.copytree(scene, tmp_path / "elsewhere")
    (scene.parent / "linked").symlink_to(tmp_path / "elsewhere")
    assert not lies_outside(scene, scene.parent)
    assert lies_outside(scene.parent / "linked", scene.parent)
    assert lies_outside(scene.parent / "linked" / "goal.lp", scene.parent)
    assert not lies_outside(scene.parent / "linked" / "goal.lp")
    assert main(["check", str(scene.parent / "linked"), "--untrusted"]) == 0  # the user names it


def test_messages_hide_the_text_of_rules_behind_a_link(tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "rules.lp").write_text("fine(1).\nsecret_x17(1\n")
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "rules.lp").symlink_to(tmp_path / "far" / "rules.lp")
    source = read_source(tmp_path / "here" / "rules.lp")
    assert "x17" not in str(source.problem(source.start(), "unexpected secret_x17", "secret_x17"))
