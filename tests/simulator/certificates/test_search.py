"""Certificates of runs: written by the command and from Python, or one line that says why there is none."""

from pathlib import Path

import pytest

import utak
from tests.tables import few
from utak.simulator.certificates.checker import verify
from utak.simulator.cli.main import main

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
# What the checker says of the certificate of each example that has one, after its goals.
SHOWN = {
    "go_to_square": "given shape(x,square)",
    "go_northeast": "at step 5",
    "go_northeast_askew": "at step 5",
    "go_northeast_and_back": "then(at(utak,start)) at step 5",
    "go_round_square": "given shape(x,square), along(grid)",
    "go_next_room_middle": "given verge(walls), isolated(things), parted(rooms)",
    "push_square_next_room": "given shape(x,square), verge(walls), isolated(things), parted(rooms)",
}


@pytest.mark.parametrize("name", few(SHOWN, ["go_to_square", "go_round_square"]))
def test_a_run_has_a_certificate(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    episode, certificate = str(tmp_path / "ep.jsonl"), str(tmp_path / "certificate.json")
    assert main(["run", str(EXAMPLES / name), "--log", episode, "--certificate", certificate]) == 0
    capsys.readouterr()
    assert main(["verify", episode, certificate]) == 0
    told = capsys.readouterr().out
    assert told.startswith("accepted: done: ")
    assert told.endswith(f"{SHOWN[name]}\n")


def test_where_nothing_shows_the_verdict_one_line_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    certificate = tmp_path / "certificate.json"
    assert main(["run", str(EXAMPLES / "go_around_corner"), "--certificate", str(certificate)]) == 0
    told = [line for line in capsys.readouterr().err.splitlines() if "certificate" in line]
    assert told == ["no certificate: nothing is shown of around(utak,corner)"]
    assert not certificate.exists()


def test_a_file_of_another_kind_is_not_overwritten(tmp_path: Path) -> None:
    other = tmp_path / "notes"
    other.write_text("mine")
    assert main(["run", str(EXAMPLES / "go_to_square"), "--certificate", str(other)]) == 66
    assert other.read_text() == "mine"


def test_tests_and_sweeps_keep_certificates_in_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept = tmp_path / "kept"
    scenarios = [str(EXAMPLES / name) for name in ("go_to_square", "go_around_corner")]
    assert main(["test", *scenarios, "--certificate", str(kept)]) == 0
    assert main(["sweep", scenarios[0], "--seeds", "3", "--certificate", str(kept)]) == 0
    names = {"go_to_square.jsonl", "go_to_square.json", "go_around_corner.jsonl", "go_around_corner.txt"}
    assert {path.name for path in kept.iterdir()} == names | {"go_to_square-0-3.jsonl", "go_to_square-0-3.json"}
    assert (kept / "go_around_corner.txt").read_text().startswith("no certificate: nothing is shown of around(utak")
    for name in ("go_to_square", "go_to_square-0-3"):
        assert main(["verify", str(kept / f"{name}.jsonl"), str(kept / f"{name}.json")]) == 0
    (kept / "go_around_corner.txt").write_text("mine")
    assert main(["test", scenarios[1], "--certificate", str(kept)]) == 66
    assert (kept / "go_around_corner.txt").read_text() == "mine"
    capsys.readouterr()


def test_a_certificate_is_a_text_in_python(tmp_path: Path) -> None:
    run = utak.Run(EXAMPLES / "go_to_square")
    with pytest.raises(utak.NoCertificateError, match="the verdict is open"):
        run.certificate()
    episode = run.finish()
    episode.save(tmp_path / "ep.jsonl")
    assert verify((tmp_path / "ep.jsonl").read_text(), run.certificate()).startswith("done: at(utak,x) at step")
