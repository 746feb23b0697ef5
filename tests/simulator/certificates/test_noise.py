"""Certificates of runs with noise, by both checkers: what they claim, and at what risk."""

import json
from pathlib import Path

import numpy as np
import pytest

import utak
from benchmarks.certificates.drawn import drawn_walk
from benchmarks.certificates.mutants import mutants
from benchmarks.certificates.recorded import RecordedWalk
from benchmarks.certificates.truth import lost_truth
from tests.simulator.certificates.test_checker import CLOSED, ROOM, found_certificate, refused, walk
from tests.simulator.certificates.test_second_checker import NODE, accepted_by_both
from tests.tables import few
from utak.kb.body import Move
from utak.simulator.certificates.checker import verify
from utak.simulator.certificates.courses import MILLION
from utak.simulator.certificates.search import certificate_of
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.explaining.questions import questions_of_episode

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
NOISE, DRAWS = 0.05, 100_000


def walked(tmp_path: Path, noise: float = NOISE) -> RecordedWalk:
    """Return a walk there and back that ends in the square where it began."""
    return walk(tmp_path, ROOM, [Move(-3.0, -1.0), Move(3.0, 1.0)], "at(utak,start)", noise=(noise, 3))


def test_a_noisy_walk_is_shown_at_a_risk(tmp_path: Path) -> None:
    found = walked(tmp_path)
    text = found_certificate(found)
    assert verify(found.text, text) == "done, at a risk of 1 percent: at(utak,start) at step 2"
    exact = walked(tmp_path, noise=0.0)
    assert verify(exact.text, found_certificate(exact)) == "done: at(utak,start) at step 2"
    assert json.loads(found_certificate(exact))["risk"] == 0


@pytest.mark.parametrize("risk", [1, 100, 5000])
def test_a_risk_that_is_understated_is_refused(tmp_path: Path, risk: int) -> None:
    found = walked(tmp_path)
    stated = json.loads(found_certificate(found))
    refused(found, stated | {"risk": risk})
    lines = found.text.splitlines(keepends=True)
    assert json.loads(certificate_of(lines, "done", risk * 100 / MILLION))["risk"] == risk


@pytest.mark.parametrize("risk", [0, MILLION, -1, True, 1.5, None, "1"])
def test_a_risk_is_a_part_of_a_million(tmp_path: Path, risk: object) -> None:
    found = walked(tmp_path)
    assert "its risk must be" in refused(found, json.loads(found_certificate(found)) | {"risk": risk})


def with_noise(found: RecordedWalk, noise: float) -> str:
    """Return the episode of a walk, with another noise in its header."""
    head, *rows = found.text.splitlines(keepends=True)
    options = {"options": {"noise": noise, "kb": []}}
    return json.dumps(json.loads(head) | options) + "\n" + "".join(rows)


@pytest.mark.skipif(NODE is None, reason="no Node was found")
def test_both_checkers_agree_on_risks_and_noises(tmp_path: Path) -> None:
    found = walked(tmp_path)
    stated = json.loads(found_certificate(found))
    risks = [json.dumps(stated | {"risk": risk}) for risk in (10_000, 9000, 100, 1, 0, MILLION, -1, True, 1.5, None)]
    assert 1 <= accepted_by_both(tmp_path, found.text, risks) <= 2  # of 9000 millionths nothing else may follow
    assert accepted_by_both(tmp_path, with_noise(found, 0.2), risks) == 0  # the noise is read from the episode
    assert accepted_by_both(tmp_path, with_noise(found, -NOISE), risks) == 0  # which is damaged then
    assert accepted_by_both(tmp_path, with_noise(found, True), risks) == 0
    assert accepted_by_both(tmp_path, with_noise(found, 0.0), risks) == 0  # what cannot have happened is not treated
    assert accepted_by_both(tmp_path, found.text, [json.dumps({**stated, "cases": stated["cases"][:-2]})]) == 0
    assert accepted_by_both(tmp_path, found.text, [json.dumps(stated), *map(json.dumps, mutants(stated, 30, 1))]) > 0


@pytest.mark.skipif(NODE is None, reason="no Node was found")
def test_both_agree_on_what_is_impossible_with_noise(tmp_path: Path) -> None:
    way = [(-1, 0), (0, 2), (0, 2), (2, 0), (3, 0), (0, -2), (0, -2), (-2, 0), (-2, 0)]
    found = walk(tmp_path, CLOSED, [Move(float(e), float(n)) for e, n in way], "in(utak,room(next))", noise=(0.02, 1))
    text = found_certificate(found, "impossible")
    assert verify(found.text, text).startswith("impossible, at a risk of 1 percent: in(utak,room(next)) at step 9")
    stated = json.loads(text)
    texts = [text, *(json.dumps(stated | {"risk": risk}) for risk in (0, 1)), *map(json.dumps, mutants(stated, 8, 3))]
    assert accepted_by_both(tmp_path, found.text, texts) > 0


@pytest.mark.parametrize("noise", [0.01, 0.05, 0.3, 1.0])
@pytest.mark.parametrize("risk", [10_000, 500_000])
def test_noise_leads_a_command_as_far_as_its_part_of_the_risk_says(tmp_path: Path, noise: float, risk: int) -> None:
    found = walk(tmp_path, ROOM, [Move(-3.0, -1.0)] * 3, "at(utak,start)", noise=(noise, 1))
    evidence = found.evidence(risk)
    random = np.random.default_rng(1)
    for step in (1, 2, 3):
        longer, turned = random.standard_normal((2, DRAWS))
        far = np.hypot(3, 1) * np.abs((1 + noise * longer) * np.exp(1j * noise * turned) - 1)
        chance, part = np.mean(far > evidence.errors[step] / evidence.unit), risk / MILLION / (step * (step + 1))
        assert chance <= part + 4 * np.sqrt(part / DRAWS)
        assert chance > part / 4 or noise > 0.3 or part < 0.01  # nor is it much less


@pytest.mark.parametrize("noise", [NOISE, 0.5])  # every second grasp slips with the greater one
@pytest.mark.parametrize("seed", few(range(30), 6))
def test_the_rules_allow_what_happened_but_for_the_risk(seed: int, noise: float) -> None:
    found = drawn_walk(seed, noise)
    assert lost_truth(found, 10_000) == "" or found.is_beyond(10_000)


def test_a_thing_that_is_felt_needs_no_risk(tmp_path: Path) -> None:
    room = ROOM.replace("U", ".").replace("b..gg......b", "b..ggU.....b", 1)
    found = walk(tmp_path, room, [], "at(utak,x)", noise=(NOISE, 1))
    text = found_certificate(found)
    assert verify(found.text, text).startswith("done: at(utak,x) at step 0")
    assert "its risk must be" in refused(found, json.loads(text) | {"risk": 1})


def test_the_command_and_python_take_a_risk(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept, run = tmp_path / "kept", ["run", str(EXAMPLES / "go_northeast_and_back"), "--noise", "0.05", "--seed", "2"]
    files = ["--log", str(tmp_path / "ep.jsonl"), "--certificate", str(tmp_path / "c.json"), "--risk", "2.5"]
    assert main([*run, *files]) == 0
    capsys.readouterr()
    assert main(["verify", str(tmp_path / "ep.jsonl"), str(tmp_path / "c.json")]) == 0
    assert capsys.readouterr().out.startswith("accepted: done, at a risk of 2.5 percent: first(at(utak,corner(north")
    episode = utak.Episode.read(tmp_path / "ep.jsonl")
    assert json.loads(episode.certificate(risk=2.5))["risk"] == 25_000
    with pytest.raises(ValueError, match="percent, not 0"):
        episode.certificate(risk=0.0)
    assert main(["explain", str(tmp_path / "ep.jsonl"), "verdict(V)", "--certificate", str(tmp_path / "c.json")]) == 0
    assert "done, at a risk of 2.5 percent" in capsys.readouterr().out
    questions = questions_of_episode(read_episode(tmp_path / "ep.jsonl"), certificate=(tmp_path / "c.json").read_text())
    told = next(one for one in questions.why("verdict(V)").walk() if one.claim.startswith("noise led no command"))
    assert told.because.startswith("it does in at most 2.5 of 100 runs")
    for command in ("test", "sweep"):
        options = ["--noise", "0.05", "--certificate", str(kept), "--risk", "2.5"]
        seed = ["--seed", "2"] if command == "test" else ["--seeds", "2"]
        assert main([command, str(EXAMPLES / "go_northeast_and_back"), *options, *seed]) == 0
    capsys.readouterr()
    for path in kept.glob("*.json"):
        assert json.loads(path.read_text())["risk"] == 25_000
    assert len(list(kept.glob("*.json"))) == 2


@pytest.mark.parametrize("risk", ["0", "100", "-1", "much"])
def test_a_risk_is_a_percentage(risk: str) -> None:
    assert main(["run", str(EXAMPLES / "go_to_square"), "--risk", risk]) == 2
