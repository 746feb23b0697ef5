"""The history of the prompt: the newest statements stay, whatever happens while a long one is cut."""

import os
from pathlib import Path

import pytest

from utak.simulator.repl.reading import MAX_HISTORY_LINES, History

OLD = [f"held(o{number})." for number in range(2 * MAX_HISTORY_LINES + 1)]


def test_a_long_history_is_cut(tmp_path: Path) -> None:
    path = tmp_path / "history"
    path.write_text("\n".join(OLD) + "\n")
    assert History(path).read() == OLD[-MAX_HISTORY_LINES:] == path.read_text().splitlines()


def test_on_a_full_disk_a_long_history_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_: int) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "history"
    path.write_text("\n".join(OLD))
    monkeypatch.setattr(os, "fsync", fail)
    assert History(path).read() == OLD[-MAX_HISTORY_LINES:]
    assert path.read_text().splitlines() == OLD and list(tmp_path.iterdir()) == [path]


def test_a_history_that_cannot_be_read_is_empty(tmp_path: Path) -> None:
    assert History(tmp_path / "none" / "history").read() == []
    assert History(tmp_path).read() == []
