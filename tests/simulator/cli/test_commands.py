"""The subcommands query, repl, test and new, and scenarios as pytest tests."""

import io
import json
import re
import shutil
import sys
from pathlib import Path

import pytest
import scripted_robot
from random_scenes import write_scene

from utak.simulator.cli.main import main

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a scenario that the scripted robot will run."""
    monkeypatch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
    scripted_robot.install()
    return write_scene(tmp_path / "scene", 1)


def repl(monkeypatch: pytest.MonkeyPatch, text: str, *arguments: str) -> int:
    """Return what `utak repl` prints for piped input."""
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
    return main(["repl", *arguments])


def test_query_asks_a_run_at_a_step(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["query", str(scene), "unseen(R, N)", "--at", "0"]) == 0
    assert capsys.readouterr().out == "R   N\nr1  30\n"
    assert main(["query", str(scene), "unseen(R, N)", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "step": 30,
        "answer": "bindings",
        "variables": ["R", "N"],
        "rows": [["r1", 0]],
        "more": False,
    }


@pytest.mark.long
def test_rows_beyond_the_limit_are_announced(
    scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asking = ["query", str(scene), "unseen(R, N), X = 1..12000", "--at", "0"]
    for more, rows in (([], 10_000), (["--limit", "7"], 7), (["--limit", "12000"], 12_000)):
        assert main([*asking, "--json", *more]) == 0
        found = json.loads(capsys.readouterr().out)
        assert len(found["rows"]) == rows
        assert found["more"] == (rows < 12_000)
    assert main([*asking, "--limit", "3"]) == 0
    assert capsys.readouterr().out.endswith("\n... and more than these 3 rows\n")
    for bad in ("0", "-1", "x", "1000001"):
        assert main([*asking, "--limit", bad]) == 2
    assert repl(monkeypatch, "?- unseen(R, N), X = 1..12000.\n", str(scene)) == 0
    assert capsys.readouterr().out.endswith("\n... and more than these 10000 rows\n")


def test_queries_may_call_the_robot_utak(scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "ep.jsonl"
    main(["run", str(scene), "--log", str(path)])
    header, waking, *rest = path.read_text().splitlines()
    line = json.loads(waking)
    line["belief"]["facts"] = ["node(org).", "offset(org,100,200).", "node(o1)."]
    path.write_text("\n".join([header, json.dumps(line), *rest]) + "\n")
    capsys.readouterr()
    for query, said in {
        "offset(utak, E, N)": "E    N\n100  200\n",
        "offset(org, E, N)": "E    N\n100  200\n",
        "node(utak)": "yes\n",
        'X = "utak"': 'X\n"utak"\n',
    }.items():
        assert main(["query", str(path), query, "--at", "0"]) == 0
        assert capsys.readouterr().out == said


def test_a_picture_of_the_truth_is_labelled_so(
    scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert repl(monkeypatch, "show truth\nhelp\n", str(scene)) == 0
    out = capsys.readouterr().out
    assert out.startswith("the true table, which the robot may believe to be otherwise:\nbbb")
    assert "hundredths of a square" in out
    assert main(["run", str(scene), "--watch", "--max-steps", "1"]) == 75
    assert capsys.readouterr().err.count("the true table") == 2


@pytest.mark.long
def test_query_asks_an_episode(scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(tmp_path / "ep.jsonl")
    main(["run", str(scene), "--log", path])
    capsys.readouterr()
    assert main(["query", path, "unseen(r1, 20)", "--at", "10"]) == 0
    assert main(["query", path, "kind(n1, verge, 100)"]) == 0
    assert capsys.readouterr().out == "yes\nno\n"
    assert main(["query", path, "node(X)", "--at", "99"]) == 65
    assert main(["query", path, "nod(X)"]) == 65
    assert main(["query", path, "X = 1..1000000, Y = 1..1000000"]) == 75
    assert main(["query", str(tmp_path / "none"), "node(X)"]) == 66
    err = capsys.readouterr().err
    assert "there is no step 99: the last is 30" in err
    assert "did you mean node?" in err


def test_the_prompt_survives_every_line(
    scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (
        "help\n?- unseen(R, N).\nstep\nstep 2\nstep x\nfacts r1\nfacts zz\nshow truth\n\nfly\nfact\n?- nod(X).\n?-\n"
        "?- \xff\nstep -1\nstep 99999999999999\nrun\nstep\n?- unseen(r1, 0).\nquit\nhelp\n"
    )
    assert repl(monkeypatch, text, str(scene)) == 0
    out, err = capsys.readouterr()
    answers = ["go on to the end", "r1  30", "step 3: ", "unseen(r1,27).", "none", "bbbb"]
    for said in [*answers, "limit after 30 steps: the script has ended"]:
        assert said in out
    for said in [
        "step takes a number of steps, not x",
        "unknown command fly",
        "did you mean facts?",
        "did you mean node?",
        "the query is empty",
        "step takes a number of steps, not -1",
    ]:
        assert said in err
        assert said not in out
    assert out.endswith("yes\n")
    assert "Traceback" not in out + err


def test_the_prompt_reads_an_episode_cut_short(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "ep.jsonl"
    main(["run", str(scene), "--log", str(path)])
    rows = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(rows[:5]) + rows[5][:50])
    capsys.readouterr()
    assert repl(monkeypatch, "show truth\nrun\nstep\nshow truth", str(path)) == 0
    out, err = capsys.readouterr()
    assert "step 3: " in out
    assert "there are no more steps" in err
    assert out.count("U") == 2
    path.write_bytes(rows[0])
    assert repl(monkeypatch, "", str(path)) == 65
    bare = json.dumps({"utak": "episode", "version": 1}) + "\n" + json.dumps({"step": 0}) + "\n"
    path.write_text(bare)
    assert repl(monkeypatch, "show\n", str(path)) == 65
    assert f"{path}:1:1-1: error: the key options is missing" in capsys.readouterr().err


class DoneRobot(scripted_robot.Robot):
    """A robot that stands still and believes that the task is done."""

    @property
    def finished(self) -> bool:
        return True

    @property
    def verdict(self) -> scripted_robot.Verdict:
        return scripted_robot.Verdict(True, "done", "it holds")


def expecting(folder: Path, text: str) -> Path:
    (folder / "expect.lp").write_text(text)
    return folder


def test_test_runs_scenarios(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    expecting(scene, "fails.")
    assert main(["test", str(scene)]) == 0
    assert capsys.readouterr().out == f"ok {scene}: limit in 30 steps: the script has ended\n"
    good = expecting(shutil.copytree(scene, scene.parent / "good"), "within(0).")
    assert main(["test", str(scene.parent)]) == 1
    seen = capsys.readouterr()
    reasons = "not met: within(0): 30 commands were given; Utak does not believe that the task is done"
    assert f"FAILED {good}: {reasons}; limit in 30" in seen.out
    assert "1 of 2 passed" in seen.err
    scripted_robot.install(DoneRobot)
    assert main(["test", str(good)]) == 0
    assert main(["test", str(scene)]) == 1
    assert "Utak believes that an impossible task is done" in capsys.readouterr().out


def test_the_command_test_names_the_reasons(scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    expecting(scene, "unmoved(o77).")
    assert main(["test", str(scene)]) == 65
    (scene / "expect.lp").unlink()
    assert main(["test", str(scene)]) == 65
    (tmp_path / "empty").mkdir()
    assert main(["test", str(tmp_path / "empty")]) == 66
    err = capsys.readouterr().err
    assert "the world has no object o77" in err
    assert "a test needs expect.lp" in err


def test_new_writes_a_valid_scenario(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "deep" / "mine"
    assert main(["new", str(folder)]) == 0
    assert main(["check", str(folder)]) == 0
    before = (folder / "goal.lp").read_text()
    assert main(["new", str(folder)]) == 66
    assert main(["new", str(folder / "goal.lp")]) == 66
    assert "not empty" in capsys.readouterr().err
    assert (folder / "goal.lp").read_text() == before


def test_an_expected_verdict_is_told_of(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(expecting(scene, "verdict(limit)."))]) == 75
    assert capsys.readouterr().out == "limit in 30 steps, as expected: the script has ended\n"
    assert main(["test", str(scene)]) == 0
    assert main(["run", str(expecting(scene, "verdict(done). within(3)."))]) == 75
    seen = capsys.readouterr()
    assert "not met: verdict(done): the verdict is limit\nnot met: within(3): 30 commands were given\n" in seen.err
    assert main(["test", str(scene)]) == 1


def test_routes_pass_an_object_on_both_sides(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "s").mkdir()
    (tmp_path / "s" / "world.txt").write_text("......\n..gg..\n.U....\n")
    ends = [str(tmp_path / "s"), "--from", "0.5,1.5", "--to", "5.5,1.5"]
    assert main(["routes", *ends, "--json", "--svg", str(tmp_path / "out.svg")]) == 0
    routes = json.loads(capsys.readouterr().out)["routes"]
    assert [route["points"][1][1] for route in routes] in ([1, 2], [2, 1])
    assert len({tuple(route["signature"]) for route in routes}) == 2
    assert (tmp_path / "out.svg").read_text().startswith("<svg")
    assert main(["routes", *ends, "-k", "1"]) == 0
    assert capsys.readouterr().out.startswith("1: length 5.")


def test_routes_on_a_map(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.map"
    path.write_text("type octile\nheight 2\nwidth 3\nmap\n..@\n.@.\n")
    assert main(["routes", str(path), "--from", "0.5,0.5", "--to", "1.5,1.5"]) == 0
    assert main(["routes", str(path), "--from", "0.5,0.5", "--to", "2.5,0.5"]) == 1
    seen = capsys.readouterr()
    assert seen.out.count("\n") == 1
    assert "there is no way" in seen.err
    assert main(["routes", str(path), "--from", "0.5,0.5", "--to", "1.5,0.5"]) == 65
    assert main(["routes", str(path), "--from", "0.5", "--to", "1.5,0.5"]) == 2
    path.write_text("type octile\nheight 2\nwidth 3\nmap\n..@\n.?.\n")
    assert main(["routes", str(path), "--from", "0.5,0.5", "--to", "1.5,0.5"]) == 65
    assert main(["routes", str(tmp_path / "no.map"), "--from", "0,0", "--to", "1,1"]) == 66
    err = capsys.readouterr().err
    assert "lies in a blocked square" in err
    assert f"{path}:6:2-2: error: unknown square '?'" in err


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("rnu x", "did you mean run?"),
        ("repaly x", "did you mean replay?"),
        ("run x --paths gird", "did you mean grid?"),
        ("run x --nosie 0.1", "--nosie: did you mean --noise?"),
        ("test x --cvs=FILE", "--cvs: did you mean --csv?"),
        ("zzz", "choose from"),
    ],
)
def test_misspelt_words_of_the_shell_are_mended(line: str, hint: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(line.split()) == 2
    assert hint in capsys.readouterr().err


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    stated = re.findall(r'^version = "(.*)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.split() == ["utak", *stated]


@pytest.mark.long
def test_a_scenario_is_explained_as_its_episode_is_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, episode = ROOT / "examples" / "go_next_room", tmp_path / "ep.jsonl"
    assert main(["run", str(folder), "--seed", "3", "--noise", "0.02", "--log", str(episode)]) == 0
    for more in ([], ["verdict(done)"], ["--at", "1"], ["--cell", "3", "--at", "0"]):
        capsys.readouterr()
        assert main(["explain", str(episode), *more]) == 0
        told = capsys.readouterr().out
        assert main(["explain", str(folder), "--seed", "3", "--noise", "0.02", *more]) == 0
        assert capsys.readouterr().out == told
    assert main(["explain", str(folder), "--at", "99"]) == 65
