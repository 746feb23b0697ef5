"""The prompt at a real pseudo-terminal: editing, completion, Ctrl-C, history, and the end of the input."""

import os
import re
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from utak.simulator.cli.commands.files.new import NEW_SCENARIO_FILES

pty = pytest.importorskip("pty")  # not on Windows
ROOT = Path(__file__).resolve().parents[3]
ESCAPES = re.compile(rb"\x1b\[[0-9;?]*[ -/]*[@-~]|\x1b[()=>].?|\x1b\][^\x07]*\x07")
MAX_WAIT_SECONDS = 600  # for one answer, on a busy machine


def take_terminal() -> None:
    """Make the standard input the terminal of this process, whose Ctrl-C reaches it."""
    import fcntl
    import termios

    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a shell may have let background jobs ignore it


class Terminal:
    """`utak repl` at a pseudo-terminal."""

    def __init__(self, story: Path, state: Path, **environment: str) -> None:
        self.handle, slave = pty.openpty()
        command = [sys.executable, str(ROOT / "utak" / "launcher.py"), "", "utak.simulator.cli", "repl", str(story)]
        given = {"XDG_STATE_HOME": str(state), "TERM": "xterm", "PROMPT_TOOLKIT_NO_CPR": "1", **environment}
        self.process = subprocess.Popen(
            command,
            stdin=slave,
            stdout=slave,
            stderr=slave,
            env=os.environ | given,
            start_new_session=True,
            preexec_fn=take_terminal,
        )
        os.close(slave)
        self.seen, self.at = b"", 0

    def until(self, text: str) -> str:
        """Read until a text is printed; return what is printed from the last call on to its end, without escapes."""
        end = time.monotonic() + MAX_WAIT_SECONDS
        while (found := self._printed().find(text, self.at)) < 0:
            assert time.monotonic() < end, f"{text!r} does not come: {self._printed()[self.at :]!r}"
            if select.select([self.handle], [], [], 0.5)[0]:
                try:
                    piece = os.read(self.handle, 65536)
                except OSError:
                    piece = b""
                assert piece, f"it ended before {text!r}: {self._printed()[self.at :]!r}"
                self.seen += piece
        before, self.at = self.at, found + len(text)
        return self._printed()[before : self.at]

    def _printed(self) -> str:
        """Return everything printed so far, without escape sequences."""
        return ESCAPES.sub(b"", self.seen).decode(errors="replace")

    def type(self, text: str) -> None:
        os.write(self.handle, text.encode())

    def ended(self) -> int:
        """Return the exit code, once the process ends."""
        end = time.monotonic() + MAX_WAIT_SECONDS
        while self.process.poll() is None and time.monotonic() < end:
            with suppress(OSError):
                if select.select([self.handle], [], [], 0.1)[0]:
                    os.read(self.handle, 65536)
        assert self.process.returncode is not None
        return self.process.returncode


@pytest.fixture(params=["toolkit", "readline"])
def terminal(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Terminal]:
    """A conversation about a run, with and without prompt_toolkit."""
    plain = {"UTAK_PLAIN_PROMPT": "1"} if request.param == "readline" else {}
    pytest.importorskip("readline" if plain else "prompt_toolkit")
    folder = tmp_path / "scenario"
    folder.mkdir()
    for name, text in NEW_SCENARIO_FILES.items():
        (folder / name).write_text(text)
    running = Terminal(folder, tmp_path / "state", **plain)
    yield running
    if running.process.poll() is None:
        running.process.kill()
        running.process.wait()
    os.close(running.handle)


def test_a_conversation_at_a_terminal(terminal: Terminal, tmp_path: Path) -> None:
    terminal.until("utak 0>")
    terminal.type("held(o1).\r")
    terminal.until("\nno")
    terminal.until("utak 0>")
    terminal.type("node(X),\r")  # goes on
    terminal.until("  ...")
    terminal.type("kind(X, K, 100).\r")
    terminal.until("org")
    terminal.until("utak 0>")
    terminal.type("?- shape(o1, squ\t")  # completed
    terminal.until("square")
    terminal.type(", C).\r")
    terminal.until("no")
    terminal.until("utak 0>")
    terminal.type("?- unseen(")
    time.sleep(0.3)
    terminal.type("\x03")  # Ctrl-C drops what was begun
    terminal.until("utak 0>")
    terminal.type("?- X = 1..9000, Y = 1..9000, X + Y < 0.\r")
    time.sleep(1.0)
    terminal.type("\x03")  # and interrupts what runs
    terminal.until("interrupted")
    terminal.until("utak 0>")
    terminal.type("step\r")
    terminal.until("step 1: move(")
    terminal.until("utak 1>")
    terminal.type("assume door(d7).\r")
    terminal.until("utak 1 +1 assumed>")
    terminal.type("\x1b[A\x1b[A\r")  # two statements back
    terminal.until("step 2: move(")
    terminal.until("utak 2 +1 assumed>")
    terminal.type("\x04")  # the end of the input leaves
    assert terminal.ended() == 0
    history = (tmp_path / "state" / "utak" / "history").read_text().splitlines()
    assert history[0] == "held(o1)."
    assert "node(X), kind(X, K, 100)." in history
    assert (tmp_path / "state" / "utak" / "history").stat().st_mode & 0o077 == 0


@pytest.mark.long
def test_history_is_that_of_earlier_conversations(terminal: Terminal, tmp_path: Path) -> None:
    terminal.until("utak 0>")
    terminal.type("help since\r")
    terminal.until("utak 0>")
    terminal.type("quit\r")
    assert terminal.ended() == 0
    again = Terminal(tmp_path / "scenario", tmp_path / "state")
    again.until("utak 0>")
    again.type("\x1b[A\x1b[A\r")
    again.until("since which step")
    again.process.send_signal(signal.SIGKILL)
    again.process.wait()
    os.close(again.handle)


@pytest.mark.long
def test_an_answer_that_goes_elsewhere_has_no_prompt_in_it(tmp_path: Path) -> None:
    """Without a terminal for the answers, the prompt is printed on the standard error."""
    for name, text in NEW_SCENARIO_FILES.items():
        (tmp_path / name).write_text(text)
    handle, slave = pty.openpty()
    command = [sys.executable, str(ROOT / "utak" / "launcher.py"), "", "utak.simulator.cli", "repl", str(tmp_path)]
    with subprocess.Popen(command, stdin=slave, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        os.close(slave)
        os.write(handle, b"node(org).\nquit\n")
        out, err = process.communicate(timeout=MAX_WAIT_SECONDS)
    os.close(handle)
    assert out == b"yes\n"
    assert err.count(b"utak 0> ") == 2
