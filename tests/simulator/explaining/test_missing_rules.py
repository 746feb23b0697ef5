"""An episode of a run with users' rules, explained without them: each way to ask says so in a line."""

from pathlib import Path

import pytest

from tests.simulator.replay.replay_episodes import body_of
from utak.episode import Episode
from utak.kb.reasoning.query import QueryEngine
from utak.simulator.cli.commands.files.new import NEW_SCENARIO_FILES
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.explaining.missing_rules import missing_rules
from utak.simulator.repl.commands import PROMPT_COMMANDS
from utak.simulator.repl.dialogue import Dialogue
from utak.simulator.repl.printer import Printer
from utak.simulator.run.story import recorded_story

pytestmark = pytest.mark.long

TWO = "2 files of rules took part in this run, and "
END = "took part in this run"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str], Path]:
    """Return the episode of a run with two files of rules, these files, and the page that the run wrote."""
    folder = tmp_path_factory.mktemp("rules")
    for name, text in NEW_SCENARIO_FILES.items():
        (folder / name).write_text(text)
    rules = [folder / "big.lp", folder / "small.lp"]
    rules[0].write_text("big(X) :- object(X), rect(X, W, S, E, N), E - W > 300.\n")
    rules[1].write_text("small(X) :- object(X), not big(X).\n")
    log, page = folder / f"{folder.name}.jsonl", folder / "run.html"
    given = [word for path in rules for word in ("--kb", str(path))]
    assert main(["run", str(folder), *given, "--log", str(log), "--html", str(page)]) == 0
    return log, list(map(str, rules)), page


def test_the_line_counts_what_is_missing_and_a_changed_file_is_another_one(
    made: tuple[Path, list[str], Path], tmp_path: Path
) -> None:
    log, rules, _ = made
    head = read_episode(log).header
    sums = [one[:8] for one in head["options"]["kb"]]
    assert missing_rules(head, rules) == ""
    assert missing_rules(head, rules[::-1]) == ""
    assert missing_rules({**head, "options": {**head["options"], "kb": []}}, []) == ""
    assert missing_rules(head, []).startswith(f"{TWO}they are not given here (SHA-256 {', '.join(sums)}): what they ")
    assert missing_rules(head, rules[:1]).startswith(f"{TWO}1 of them is not given here (SHA-256 {sums[1]}): what it ")
    changed = tmp_path / "big.lp"
    changed.write_text(Path(rules[0]).read_text() + "% another version\n")
    assert missing_rules(head, [str(changed), rules[1]]).startswith(f"{TWO}1 of them is not given here")
    stage = {"until": 1, "options": head["options"], "task": head["task"]}
    forked = {**head, "options": {**head["options"], "kb": []}, "forked": [stage]}
    assert missing_rules(forked, []).startswith(TWO)  # an earlier stage of the run had them


def test_each_way_to_ask_says_it_once_and_keeps_silent_when_all_rules_are_given(
    made: tuple[Path, list[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, rules, _ = made
    given = [word for path in rules for word in ("--kb", path)]
    for options, count in ([], 1), (given[:2], 1), (given, 0):
        assert main(["explain", str(log), *options, "--json"]) == 0
        out, err = capsys.readouterr()
        assert err.count(END) == count and END not in out
        assert err.count("--kb FILE") == count
    with QueryEngine() as engine:
        dialogue = Dialogue(recorded_story(str(log), read_episode(log)), engine, Printer(), PROMPT_COMMANDS)
        for statement in ("why step.", "whynot held(o1).", "why big(o1)."):
            dialogue.obey(statement)
    assert capsys.readouterr().err.count(END) == 1
    for read, count in (Episode.read(log), 1), (Episode.read(log, rules), 0):
        for tree in (read.why("kind(utak, K, C)"), read.why_cell(3), read[1].explain()):
            assert repr(tree).count(END) == str(tree).count(END) == tree._repr_html_().count(END) == count
            assert END not in tree.text()


def test_pages_of_runs_and_replays_have_the_reasons_with_rules_or_say_what_they_lack(
    made: tuple[Path, list[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, rules, page = made
    given = [word for path in rules for word in ("--kb", path)]
    again, without = tmp_path / "again.html", tmp_path / "without.html"
    assert main(["replay", str(log), "--html", str(again), *given]) == 0
    assert capsys.readouterr().err == ""
    assert again.read_text() == page.read_text()
    assert END not in body_of(page.read_text()) and "2 files of rules" in body_of(page.read_text())
    assert main(["replay", str(log), "--html", str(without)]) == 0
    assert END in capsys.readouterr().err and END in body_of(without.read_text())
    assert main(["replay", str(log), "--text", "--kb", rules[0]]) == 2
