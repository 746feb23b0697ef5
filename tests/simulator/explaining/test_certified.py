"""Certificates in words: with the verdict, a sentence for each line, down to impressions, touches and commands."""

import io
import json
from collections import Counter
from pathlib import Path

import pytest

from utak.kb.evidence.reason import ReasonKind
from utak.simulator.certificates.checker import ALONG_GRID, OF_COLOURS, OF_DOORS, OF_THINGS, OF_WALLS
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.explaining.certified import GRANTED
from utak.simulator.explaining.questions import questions_of_episode
from utak.simulator.explaining.trees import TREE_LEVELS, trees_of_episode

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


@pytest.fixture(scope="module")
def certified(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return a run's episode and its certificate."""
    folder = tmp_path_factory.mktemp("certified")
    episode, certificate = folder / "ep.jsonl", folder / "certificate.json"
    scenario = str(EXAMPLES / "go_round_square")
    assert main(["run", scenario, "--log", str(episode), "--certificate", str(certificate)]) == 0
    return episode, certificate


def test_each_line_is_a_sentence(certified: tuple[Path, Path]) -> None:
    episode, text = read_episode(certified[0]), certified[1].read_text()
    verdict = questions_of_episode(episode, certificate=text).why("verdict(done)")
    found, *others = verdict.rests_on
    assert tuple(others) == questions_of_episode(episode).why("verdict(done)").rests_on
    assert found.claim.startswith("a certificate shows done: circled(utak,x) at step 6, at(utak,start) at step 6")
    told = Counter(reason.claim for reason in found.walk())
    words = Counter(line[0] for line in json.loads(text)["cases"])
    assert told["it is as claimed here"] == words["holds"]
    assert told["the ways of the commands are worked out again"] == words["replay"]
    assert sum(n for claim, n in told.items() if claim.startswith("a command may have ended in")) == words["end"]
    kinds = Counter(reason.kind for reason in found.walk())
    assert kinds[ReasonKind.CELLS] == words["count"]
    assert kinds[ReasonKind.COMMAND] == len(episode.steps)  # each but that of waking, and their list
    assert [one.source for one in found.walk() if one.kind == ReasonKind.TOUCH] == ["impression 4"]
    for reason in found.walk():
        for step, cell, level in reason.data.get("cells", []):
            assert episode.steps[step]["retina"][cell] == level


def test_counts_are_told_in_words(certified: tuple[Path, Path]) -> None:
    found = questions_of_episode(read_episode(certified[0]), certificate=certified[1].read_text()).why("verdict(V)")
    text = found.text()
    assert "shape(x,square): taken for granted: the task says so" in text
    assert "x means the thing felt there: colour s was felt in the southwest  [impression 4]" in text
    claims = {f"{one.claim}: {one.because}" for one in found.walk()}
    assert "cell 130 of impression 0: 2 to 3 of its 16 squares are occupied: level 1 of 7" in claims
    assert (
        "cell 7 of impression 1 less cell 7 of impression 0: 1 squares in sum are occupied: levels 7, 0 of 7" in claims
    )


def test_a_certificate_that_is_refused_is_told_so(certified: tuple[Path, Path]) -> None:
    stated = json.loads(certified[1].read_text())
    altered = json.dumps(stated | {"steps": [6, 5]})
    found = questions_of_episode(read_episode(certified[0]), certificate=altered).why("verdict(V)").rests_on[0]
    assert (found.claim, found.rests_on) == ("the certificate is refused", ())
    assert found.because


def test_commands_and_pages_tell_it(
    certified: tuple[Path, Path], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    episode, certificate = map(str, certified)
    line = "  a certificate shows done: circled(utak,x)"
    assert main(["explain", episode, "verdict(V)", "--certificate", certificate]) == 0
    assert line in capsys.readouterr().out
    typed = io.TextIOWrapper(io.BytesIO(b"goto 6.\nwhy verdict(V).\n"))
    monkeypatch.setattr("sys.stdin", typed)
    assert main(["repl", episode, "--certificate", certificate]) == 0
    assert line in capsys.readouterr().out
    assert main(["explain", episode, "verdict(V)", "--certificate", episode]) == 65
    tree = trees_of_episode(read_episode(episode), certificate=certified[1].read_text())[6][-1]
    assert tree["children"][0]["text"].startswith(line.strip())
    depth, level = 0, [tree]
    while level:
        depth, level = depth + 1, [child for one in level for child in one.get("children", [])]
    assert depth == TREE_LEVELS


def test_all_that_certificates_take_for_granted_besides_the_task_has_words() -> None:
    assert set(GRANTED) == {ALONG_GRID, *OF_COLOURS, *OF_DOORS, *OF_WALLS, *OF_THINGS}
