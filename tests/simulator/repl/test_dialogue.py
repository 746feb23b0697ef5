"""What each command of the prompt prints, for a run of the real robot and for its recorded episode."""

import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import scripted_robot
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_scenes import write_scene

from utak.kb.reasoning.query import QueryEngine
from utak.simulator.cli.commands.files.new import NEW_SCENARIO_FILES
from utak.simulator.cli.main import main
from utak.simulator.repl.commands import PROMPT_COMMANDS
from utak.simulator.repl.dialogue import Dialogue, PromptCommand
from utak.simulator.repl.explaining import asked
from utak.simulator.repl.printer import Printer
from utak.simulator.repl.statements import StatementBuffer
from utak.simulator.run.story import open_story
from utak.simulator.scenario.settings import Settings


@pytest.fixture
def scripted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the scripted robot do every run."""
    monkeypatch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
    scripted_robot.install()


@pytest.fixture(scope="module")
def engine() -> Iterator[QueryEngine]:
    with QueryEngine(seconds=1.0) as running:
        yield running


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scenario that takes the real robot two steps."""
    folder = tmp_path_factory.mktemp("scenario")
    for name, text in NEW_SCENARIO_FILES.items():
        (folder / name).write_text(text)
    return folder


@pytest.fixture(scope="module")
def episode(scenario: Path) -> Path:
    """Its episode."""
    path = scenario.parent / "episode.jsonl"
    assert main(["run", str(scenario), "--log", str(path)]) == 0
    return path


def dialogue_of(path: Path, engine: QueryEngine, **given: Any) -> Dialogue:
    return Dialogue(open_story(path, Settings(**given)), engine, Printer(), PROMPT_COMMANDS)


def talk(dialogue: Dialogue, capsys: pytest.CaptureFixture[str], *lines: str) -> tuple[str, str]:
    """Return what some lines print: answers and messages."""
    buffer = StatementBuffer(dialogue.names)
    capsys.readouterr()
    for line in lines:
        for statement in buffer.feed(line):
            assert dialogue.obey(statement)
    for statement in buffer.finish():
        assert dialogue.obey(statement)
    seen = capsys.readouterr()
    assert "bug" not in seen.err
    return seen.out, seen.err


@pytest.fixture(params=["run", "episode"])
def dialogue(request: pytest.FixtureRequest, scenario: Path, episode: Path, engine: QueryEngine) -> Dialogue:
    return dialogue_of(scenario if request.param == "run" else episode, engine)


def test_going_back_and_forth(dialogue: Dialogue, capsys: pytest.CaptureFixture[str]) -> None:
    out, _ = talk(dialogue, capsys, "run", "back", "back 9", "goto 1", "step")
    told = [line.split(":")[0] for line in out.splitlines()]
    assert told == [
        "step 1",
        "step 2",
        "done after 2 steps",
        "step 1",
        "step 0",
        "step 1",
        "step 2",
        "done after 2 steps",
    ]
    assert talk(dialogue, capsys, "goto 0", "back")[1] == "this is step 0, the first one\n"
    out, err = talk(dialogue, capsys, "goto 99")
    assert "there is no step 99: the last is 2" in err
    assert dialogue.story.at == 2
    for bad in ("goto x", "goto", "back 0", "step 0", "goto -1", "step 1.5", "goto " + "9" * 30):
        assert "takes" in talk(dialogue, capsys, bad)[1], bad


def test_queries_facts_and_the_names_of_the_robot(dialogue: Dialogue, capsys: pytest.CaptureFixture[str]) -> None:
    talk(dialogue, capsys, "goto 2")
    assert talk(dialogue, capsys, "bound(x, N).")[0] == "N\no1\n"
    assert talk(dialogue, capsys, "?- at(utak, x).")[1].startswith("query:1:1-1: error: unknown predicate at/2")
    assert talk(dialogue, capsys, "offset(utak, E, N),", "E < 0.")[0].startswith("E ")
    utak, org = (talk(dialogue, capsys, f"facts {name}")[0] for name in ("utak", "org"))
    assert utak == org
    assert "in(org,r1,99)." in utak
    assert talk(dialogue, capsys, "facts parameter")[0] == "parameter(x).\n"
    assert talk(dialogue, capsys, "facts nothing")[0] == "none\n"
    assert talk(dialogue, capsys, ";")[1] == "there are no more rows\n"


def test_possible_worlds(dialogue: Dialogue, capsys: pytest.CaptureFixture[str]) -> None:
    likeliest, second, *table = talk(dialogue, capsys, "worlds 2")[0].splitlines()
    assert "kind(o1,verge)" in likeliest and "kind(o1,object)" not in likeliest
    assert second.split("  ")[1].startswith("but ")
    assert 100.0 > float(likeliest.split(" %")[0]) >= float(second.split(" %")[0]) > 0.0
    acts = {row.split()[0]: row.split()[-1] for row in table[1:]}
    assert acts["kind(o1,verge)"] == acts["kind(o1,object)"] == "feel(o1)"
    for wrong in ("0", "x", "-1", "1001", "2 3", "9" * 30):
        assert "this is no number from 1 to 1000" in talk(dialogue, capsys, f"worlds {wrong}")[1]
    out = talk(dialogue, capsys, "?- chance(F, C), 0 < C, C < 100.")[0]
    assert out == talk(dialogue, capsys, "?- open(F, C).")[0]


def test_since_and_diff(dialogue: Dialogue, capsys: pytest.CaptureFixture[str]) -> None:
    talk(dialogue, capsys, "goto 2")
    assert talk(dialogue, capsys, "since room(r1).")[0] == "it holds since step 0\n"
    answers = [json.loads(json.dumps(dialogue.story.facts_at(step))) for step in range(3)]
    held = [any(fact.startswith("bound(x,") for fact in facts) for facts in answers]
    out = talk(dialogue, capsys, "since bound(x, _)")[0]
    assert out.startswith("it holds since step ") and held[int(re.findall(r"\d+", out)[0])]
    assert "it does not hold" in talk(dialogue, capsys, "since held(o1).")[0]
    assert talk(dialogue, capsys, "since nod(o1).")[1].startswith("query:1:1-1: error: unknown predicate nod/1")
    assert talk(dialogue, capsys, "since in(utak.")[1].startswith("since:1:8-8: error: ")
    out = talk(dialogue, capsys, "diff 0 2 utak")[0].splitlines()
    assert {line[2:] for line in out if line.startswith("+ ")} <= set(answers[2]) - set(answers[0])
    assert {line[2:] for line in out if line.startswith("- ")} == {
        fact for fact in set(answers[0]) - set(answers[2]) if "org" in fact or "utak" in fact
    }
    assert talk(dialogue, capsys, "diff 1 1")[0] == "no difference\n"
    for bad in ("diff", "diff 1", "diff a b", "diff 0 1 o1 o2"):
        assert "diff takes" in talk(dialogue, capsys, bad)[1]
    assert "there is no step 7" in talk(dialogue, capsys, "diff 0 7")[1]


def test_the_picture_is_of_the_belief_and_the_truth_is_labelled(
    dialogue: Dialogue, capsys: pytest.CaptureFixture[str]
) -> None:
    out, _ = talk(dialogue, capsys, "show")
    assert out.count("U") == 2  # in the picture and in the legend
    assert "east 0, north 0" in out and "1 x 1 square" in out and "the way the robot faced" in out
    assert talk(dialogue, capsys, "show truth")[0].startswith("the true table, which the robot may believe")
    assert "did you mean truth?" in talk(dialogue, capsys, "show trut")[1]


def test_the_plan_is_the_next_command(dialogue: Dialogue, capsys: pytest.CaptureFixture[str]) -> None:
    out, _ = talk(dialogue, capsys, "plan", "step")
    wanted, *others, step = out.splitlines()
    (coming,) = (line for line in others if line.startswith("next: "))
    assert wanted == "wanted: at(utak,x)."
    assert coming.removeprefix("next: ") == step.removeprefix("step 1: ")
    assert "the run has ended: done: at(utak,x) holds" in talk(dialogue, capsys, "run", "plan")[0]
    assert talk(dialogue, capsys, "why step.")[0].startswith("the command was move(")
    assert "why:1:1-9: error: this is not believed" in talk(dialogue, capsys, "why node(o99).")[1]


@pytest.mark.long
def test_assumptions_count_from_their_step_on(dialogue: Dialogue, capsys: pytest.CaptureFixture[str]) -> None:
    talk(dialogue, capsys, "goto 1")
    out, _ = talk(dialogue, capsys, "assume shape(o1, disc, 77).")
    assert "+ shape(o1,disc,77)." in out
    assert "assumed from step 1 on: shape(o1,disc,77). It counts in shapes.lp." in out
    assert dialogue.prompt == "utak 1 +1 assumed> "
    assert talk(dialogue, capsys, "?- shape(o1, disc, 77).")[0] == "yes\n"
    out, _ = talk(dialogue, capsys, "assume door(d9).", "assume")
    assert out.splitlines()[-2:] == [
        "shape(o1,disc,77).  % counts in shapes.lp",
        "door(d9).  % counts for queries alone",
    ]
    assert talk(dialogue, capsys, "?- door(d9).", "facts d9", "step", "?- door(d9).")[0].count("yes") == 2
    assert "shape(o1,disc,77)." in dialogue.story.facts
    talk(dialogue, capsys, "back 2")
    assert dialogue.prompt == "utak 0> "
    assert talk(dialogue, capsys, "?- door(d9).")[0] != "yes\n"
    assert "shape(o1,disc,77)." not in dialogue.story.facts
    talk(dialogue, capsys, "goto 2")
    out, _ = talk(dialogue, capsys, "retract shape(o1, disc, 77)", "?- shape(o1, disc, 77).", "assume")
    assert "no longer assumed from step 2 on: shape(o1,disc,77)." in out
    assert "- shape(o1,disc,77)." in out
    assert out.splitlines()[-1].startswith("door(d9).")


REFUSED = {
    "assume shape(o1, sqare, 90).": "assume:1:11-15: error: unknown shape sqare",
    "assume shpe(o1, square, 90).": "assume:1:1-20: error: unknown predicate shpe/3",
    "assume in(utak, here).": "assume:1:10-13: error: unknown room here",
    "assume p(X).": "assume:1:3-3: error: X is a variable",
    "assume :- region(_,_,_).": "this rule contradicts what must hold: interpretation.lp",
    "assume a :- not a.": "it contradicts itself",
    'assume #include "x".': "#include is a directive",
    "retract door(d1).": "nothing is assumed here",
    "retract": "retract takes an assumption",
    "goal at(utak, y).": "goal:1:10-10: error: y is not introduced in start.lp",
    "goal at(utak, cornr(northeast)).": "did you mean corner?",
    "goal shape(x, disc).": "the goal is empty",
    "goal at(": "goal:1:4-4: error: ",
}


@pytest.mark.long
def test_what_cannot_be_assumed_or_wanted_changes_nothing(
    dialogue: Dialogue, capsys: pytest.CaptureFixture[str]
) -> None:
    facts = dialogue.story.facts
    for text, message in REFUSED.items():
        _, err = talk(dialogue, capsys, text)
        assert message in err
        assert dialogue.story.facts == facts
        assert not dialogue.story.changes
    assert talk(dialogue, capsys, "run")[0].endswith("done after 2 steps: at(utak,x) holds\n")


@pytest.mark.long
def test_other_goals_are_pursued(dialogue: Dialogue, capsys: pytest.CaptureFixture[str]) -> None:
    talk(dialogue, capsys, "run")
    out, _ = talk(dialogue, capsys, "goal")
    assert out == "at(utak,x).\n"
    out, _ = talk(dialogue, capsys, "goal object(y). at(utak, corner(southwest)).", "run", "goal")
    assert "wanted from step 2 on: at(utak,corner(southwest))." in out
    assert "at(utak,corner(southwest)) holds" in out.splitlines()[-2]
    assert out.splitlines()[-1] == "at(utak,corner(southwest))."
    assert "parameter(y)." in dialogue.story.facts
    assert dialogue.story.result is not None
    assert dialogue.story.result["achieved"] is None  # nothing is expected of other goals


def test_a_saved_episode_is_that_of_a_run(
    scenario: Path, episode: Path, engine: QueryEngine, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "saved.jsonl"
    talk(dialogue_of(scenario, engine), capsys, "step", f"save {path}")
    assert path.read_bytes() == b"".join(episode.read_bytes().splitlines(keepends=True)[:3])
    assert main(["run", str(scenario), "--log", str(path), "--resume"]) == 0
    assert path.read_bytes() == episode.read_bytes()
    talk(dialogue_of(episode, engine), capsys, "run", f"save {path}")
    assert path.read_bytes() == episode.read_bytes()
    other = tmp_path / "text"
    other.write_text("mine\n")
    assert "is not overwritten without --force" in talk(dialogue_of(episode, engine), capsys, f"save {other}")[1]
    assert other.read_text() == "mine\n"
    talk(dialogue_of(episode, engine), capsys, f"save --force {other}")
    assert other.read_text().startswith('{"utak":"episode"')
    for bad in ("save", "save a b", 'save "', f"save {tmp_path}/none/ep.jsonl"):
        assert talk(dialogue_of(episode, engine), capsys, bad)[1]


@pytest.mark.long
def test_a_changed_run_says_so_and_can_be_gone_on_from(
    scenario: Path, episode: Path, engine: QueryEngine, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "changed.jsonl"
    first = dialogue_of(scenario, engine)
    talk(first, capsys, "step", "assume shape(o1, disc, 77). door(d9).", "step", "goal at(utak, start).", "run")
    talk(first, capsys, f"save {path}")
    head = json.loads(path.read_text().splitlines()[0])
    assert head["changes"] == [
        {"step": 1, "assume": "shape(o1, disc, 77). door(d9)."},
        {"step": 2, "goal": "at(utak, start)."},
    ]
    assert main(["run", str(scenario), "--log", str(path), "--resume"]) == 65
    assert "was changed at the prompt" in capsys.readouterr().err
    again = dialogue_of(path, engine)
    talk(again, capsys, "goto 2")
    assert again.prompt == "utak 2 +2 assumed> "
    assert talk(again, capsys, "?- door(d9).", "goal")[0] == "yes\nat(utak,start).\n"
    _, err = talk(again, capsys, "retract door(d9).", "run")  # only a run can be changed: it is repeated
    assert "is repeated up to step 2" in err
    assert again.story.lines[-1] == first.story.lines[-1]
    assert again.story.result == first.story.result


def test_an_episode_of_another_world_is_not_repeated(
    episode: Path, engine: QueryEngine, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [json.loads(row) for row in episode.read_text().splitlines()]
    rows[2]["utak"][0] += 0.25
    path = tmp_path / "ep.jsonl"
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    dialogue = dialogue_of(path, engine)
    _, err = talk(dialogue, capsys, "step", "assume door(d9).")
    assert f"{path}:3:1-1: error: the repeated run differs at step 1 (utak)" in err
    assert not dialogue.story.changes
    rows[0]["options"]["kb"] = ["0" * 64]
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    assert "name its rules with --kb FILE" in talk(dialogue_of(path, engine), capsys, "assume door(d9).")[1]


DAMAGED_HEADERS = [
    ("claims", [["shape(x,", 1]]), ("claims", [3]), ("claims", [["a", "b"]]), ("goals", ["at(utak,q)"]), ("goals", []),
    ("parameters", {"x y": "object"}), ("parameters", {"x": "thing"}), ("expect", ["within("]),
]  # fmt: skip


def test_damaged_headers_and_changes_are_survived(
    episode: Path, engine: QueryEngine, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [json.loads(row) for row in episode.read_text().splitlines()]
    path = tmp_path / "ep.jsonl"
    for key, value in DAMAGED_HEADERS:
        head = {**rows[0], "task": {**rows[0]["task"], key: value}}
        path.write_text("".join(json.dumps(row) + "\n" for row in [head, *rows[1:]]))
        out, err = talk(dialogue_of(path, engine), capsys, "plan", "goal", "assume door(d9).", "?- node(org).", "show")
        assert err and out.startswith("yes\n"), (key, value)
    changes = [{"step": 0, "assume": "nonsense("}, {"step": -1, "goal": "x"}, 7, {"step": True, "retract": "y"}]
    path.write_text("".join(json.dumps(row) + "\n" for row in [{**rows[0], "changes": changes}, *rows[1:]]))
    dialogue = dialogue_of(path, engine)
    assert talk(dialogue, capsys, "?- node(org).", "assume", "goal")[0] == (
        "yes\nnothing is assumed at this step\nat(utak,x).\n"
    )
    assert "error" in talk(dialogue, capsys, "assume door(d9).")[1]  # the change cannot be repeated


def test_older_episodes_bind_their_parameters_too(
    episode: Path, engine: QueryEngine, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [json.loads(row) for row in episode.read_text().splitlines()]
    for row in rows[1:-1]:
        facts = row["belief"]["facts"]
        row["belief"]["facts"] = [fact for fact in facts if not fact.startswith(("bound(", "parameter(", "threshold("))]
    path = tmp_path / "old.jsonl"
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    dialogue = dialogue_of(path, engine)
    assert talk(dialogue, capsys, "goto 2", "?- bound(x, N).")[0].endswith("N\no1\n")
    assert "from step 0 on what is believed differs" in talk(dialogue, capsys, "assume door(d9).")[1]


def test_a_robot_that_takes_no_changes_says_so(
    scripted: None, tmp_path: Path, engine: QueryEngine, capsys: pytest.CaptureFixture[str]
) -> None:
    dialogue = dialogue_of(write_scene(tmp_path / "s", 1), engine)
    assert "takes no assumptions" in talk(dialogue, capsys, "assume shape(o1, square, 90).")[1]
    assert talk(dialogue, capsys, "assume door(d9).", "?- door(d9).")[0].endswith("yes\n")  # queries alone


def test_the_table_of_commands_can_be_another_one(
    episode: Path, engine: QueryEngine, capsys: pytest.CaptureFixture[str]
) -> None:
    def explain(dialogue: Dialogue, rest: str) -> None:
        dialogue.printer.say(" ".join(asked(rest)))

    commands = {key: one for key, one in PROMPT_COMMANDS.items() if key != "why"}
    commands["whynot"] = PromptCommand("whynot FACT.", "what would have to be otherwise", explain)
    dialogue = Dialogue(open_story(episode, Settings()), engine, Printer(), commands)
    assert talk(dialogue, capsys, "whynot long shape(o1,", "square, 9).")[0] == "shape(o1,\nsquare, 9) long\n"
    assert "what would have to be otherwise" in talk(dialogue, capsys, "help whynot")[0]
    assert "unknown command why" in talk(dialogue, capsys, "why x")[1]


def test_a_word_too_many_is_told(episode: Path, engine: QueryEngine, capsys: pytest.CaptureFixture[str]) -> None:
    """No other command is proposed for one that is right but for what stands behind it."""
    _, told = talk(dialogue_of(episode, engine), capsys, "quit now")
    assert "quit takes nothing behind it" in told and "did you mean" not in told


def test_help_is_there_for_every_command(
    episode: Path, engine: QueryEngine, capsys: pytest.CaptureFixture[str]
) -> None:
    dialogue = dialogue_of(episode, engine)
    whole, _ = talk(dialogue, capsys, "help")
    for name in dialogue.names:
        out, err = talk(dialogue, capsys, f"help {name}")
        assert out and not err, name
        assert name in whole or name == "exit"
    assert "did you mean goto?" in talk(dialogue, capsys, "help gotoo")[1]


def test_pages_of_rows(episode: Path, engine: QueryEngine, capsys: pytest.CaptureFixture[str]) -> None:
    dialogue = dialogue_of(episode, engine)
    dialogue.printer.is_terminal = True
    out, _ = talk(dialogue, capsys, "?- X = 1..40.")
    size = int(re.findall(r"rows 1 to (\d+) of 40", out)[0])
    out, _ = talk(dialogue, capsys, *[";"] * (39 // size))
    assert out.splitlines()[-2:] == ["40", "40 rows"]
    assert talk(dialogue, capsys, ";")[1] == "there are no more rows\n"
    assert "C: percent." in talk(dialogue, capsys, "kind(X, object, C).")[0]
    dialogue.printer.is_terminal = False
    assert talk(dialogue, capsys, "?- X = 1..12000.")[0].endswith("... and more than these 10000 rows\n")
    assert talk(dialogue, capsys, ";")[0].endswith("\n12000\n")


def test_pages_of_facts(episode: Path, engine: QueryEngine, capsys: pytest.CaptureFixture[str]) -> None:
    """Each fact comes once, and all of them at once on a pipe."""
    dialogue = dialogue_of(episode, engine)
    whole = talk(dialogue, capsys, "facts")[0].splitlines()
    dialogue.printer.is_terminal = True
    out, _ = talk(dialogue, capsys, "facts")
    pages = []
    while found := re.search(r"\nfacts 1 to (\d+) of (\d+): .*\n$", out):
        pages += out[: found.start()].splitlines()
        assert (len(pages), len(whole)) == tuple(map(int, found.groups()))
        out, _ = talk(dialogue, capsys, ";")
    assert pages and [*pages, *out.splitlines()] == whole
    assert talk(dialogue, capsys, ";")[1] == "there are no more rows\n"


def test_text_is_broken_between_words_on_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On a pipe no line is broken; a word that is too long stays whole."""
    text = "  step 12: carries o2 to the east, as the plan says it is to be done\n" + "x" * 50
    monkeypatch.setenv("COLUMNS", "30")
    for is_terminal in (True, False):
        printer = Printer(is_terminal)
        printer.say(text)
        printer.tell(text)
        for said in capsys.readouterr():
            assert said.split() == text.split()
            assert (max(len(line) for line in said.splitlines()[:-1]) <= 30) == is_terminal


COMMAND_WORDS = """?- worlds facts step back goto run diff since assume retract goal plan show truth why step. ; help
    save
    node(o1) shape(o1,square,90). door(d9). kind(X,object,C), 0 1 2 99 at(utak,x). at(utak,corner(southwest)). utak not
    . , ( { :- #include X bound(x,o2). 1..99999999"""
WORDS = st.sampled_from([*COMMAND_WORDS.split(), '"', "%", "\n", "\x00", "\x1b[31m", "\u00f6", "\ud800"])


@settings(max_examples=5, deadline=None, suppress_health_check=list(HealthCheck))
@given(words=st.lists(st.one_of(WORDS, st.text(max_size=4)), max_size=14))
def test_any_input_is_survived(
    words: list[str],
    episode: Path,
    scenario: Path,
    engine: QueryEngine,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)  # save may write a file here
    text = " ".join(words).encode("utf-8", "surrogateescape" if "\ud800" not in " ".join(words) else "surrogatepass")
    for path in (episode, scenario):
        dialogue = dialogue_of(path, engine)
        lines = text.decode("utf-8", "replace").split("\n")
        buffer = StatementBuffer(dialogue.names)
        for statement in [one for line in lines for one in buffer.feed(line)] + buffer.finish():
            assert dialogue.obey(statement) or statement.split()[0].strip(".") in ("quit", "exit")
            assert dialogue.prompt.startswith("utak ")
        seen = capsys.readouterr()
        assert "bug" not in seen.err
        assert "Traceback" not in seen.out + seen.err
        assert dialogue.obey("?- node(org).")
        assert capsys.readouterr().out == "yes\n"
