"""Ctrl-C at any moment: a step is complete or did not happen, and the only effect is a message."""

import os
import random
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any

import pytest
import scripted_robot
from random_scenes import write_scene

from utak.kb.reasoning.query import QueryEngine
from utak.simulator.cli.commands.files.new import NEW_SCENARIO_FILES
from utak.simulator.repl.commands import PROMPT_COMMANDS
from utak.simulator.repl.dialogue import Dialogue
from utak.simulator.repl.printer import Printer
from utak.simulator.run.interrupts import defer_interrupt
from utak.simulator.run.story import Story, open_story
from utak.simulator.scenario.settings import Settings

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(autouse=True)
def ctrl_c_interrupts() -> Iterator[None]:
    """Let Ctrl-C interrupt, also where a shell runs the tests in the background and ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def scripted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the scripted robot do every run."""
    monkeypatch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
    scripted_robot.install()


def finished(story: Story) -> list[Any]:
    """Return every line of a story with its picture, and its result."""
    lines = [(story.line, story.picture())]
    while story.advance():
        lines.append((story.line, story.picture()))
    return [*lines, story.result]


@contextmanager
def interrupted_at(event: int) -> Iterator[None]:
    """Raise KeyboardInterrupt at the given line or return, counted in our code that the block executes."""
    left = event

    def trace(frame: FrameType, kind: str, _: Any) -> Any:
        nonlocal left
        if str(ROOT) not in frame.f_code.co_filename or ".venv" in frame.f_code.co_filename:
            return None
        left -= 1
        if left == 0:
            raise KeyboardInterrupt
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        yield
    finally:
        sys.settrace(before)


@pytest.mark.long
def test_a_step_interrupted_anywhere_did_not_happen(tmp_path: Path, scripted: None) -> None:
    folder, settings = write_scene(tmp_path / "s", 4), Settings(noise=0.05, max_steps=8)
    whole = finished(open_story(folder, settings))
    draw = random.Random(1)
    for _ in range(25):
        story = open_story(folder, settings)
        seen = [(story.line, story.picture())]
        broken = 0
        while story.result is None:
            before = story.line
            with suppress(KeyboardInterrupt), interrupted_at(draw.choice([draw.randint(1, 40), draw.randint(1, 700)])):
                story.advance()
            if story.line is not before:
                seen.append((story.line, story.picture()))
            else:
                broken += 1
            if broken > 6:
                seen += finished(story)[1:-1]
        assert [*seen, story.result] == whole


@pytest.mark.long
# Python itself calls destructors and the callbacks of its collector: an alarm there is only reported.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_the_robot_continues_unchanged_after_an_interrupted_step(tmp_path: Path) -> None:
    for name, text in NEW_SCENARIO_FILES.items():
        (tmp_path / name).write_text(text)
    whole = finished(open_story(tmp_path, Settings()))
    story, draw = open_story(tmp_path, Settings()), random.Random(2)

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        for _ in range(4):
            try:
                signal.setitimer(signal.ITIMER_REAL, draw.uniform(0.01, 0.3))
                story.advance()
            except Exception as other:  # some libraries raise another exception instead
                assert isinstance(other, RuntimeError | ImportError | SystemError), other
            except KeyboardInterrupt:
                pass
            finally:
                with suppress(KeyboardInterrupt):
                    signal.setitimer(signal.ITIMER_REAL, 0)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert finished(story)[-2:] == whole[-2:]


def test_the_first_ctrl_c_completes_the_step_and_the_second_interrupts_it() -> None:
    announced: list[str] = []
    with defer_interrupt(lambda: announced.append("once")) as pressed:
        signal.raise_signal(signal.SIGINT)
        assert announced == ["once"]
    assert pressed
    with pytest.raises(KeyboardInterrupt), defer_interrupt(lambda: None):
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
    with defer_interrupt(lambda: None) as pressed:
        pass
    assert not pressed
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def test_the_prompt_stops_after_a_complete_step(
    tmp_path: Path, scripted: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    story = open_story(write_scene(tmp_path / "s", 4), Settings())
    step = scripted_robot.Robot.step

    def pressing(robot: scripted_robot.Robot) -> Any:
        if robot.left == 27:
            signal.raise_signal(signal.SIGINT)
        return step(robot)

    monkeypatch.setattr(scripted_robot.Robot, "step", pressing)
    with QueryEngine() as engine:
        Dialogue(story, engine, Printer(), PROMPT_COMMANDS).obey("run")
    said = capsys.readouterr()
    assert [text.split(":")[0] for text in said.out.splitlines()] == ["step 1", "step 2", "step 3", "step 4"]
    assert said.err.splitlines()[-1] == "interrupted"
    assert story.line["step"] == 4


def test_a_late_answer_is_not_given_to_the_next_query() -> None:
    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    with QueryEngine() as engine:
        engine.ask(["node(o1)."], "node(X)")
        before = signal.signal(signal.SIGALRM, interrupt)
        try:
            with pytest.raises(KeyboardInterrupt):
                signal.setitimer(signal.ITIMER_REAL, 0.2)
                engine.ask(["node(o1)."], "X = 1..9000000")
        finally:
            signal.signal(signal.SIGALRM, before)
        assert engine.ask(["node(o1)."], "node(o1)").kind == "yes"


def press_at_first_line(command: list[str], **options: Any) -> tuple[int, str]:
    """Return the exit code and the messages of a command that gets SIGINT when it has printed a line."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options) as run:
        assert run.stdout is not None and run.stdout.readline()
        run.send_signal(signal.SIGINT)
        _, said = run.communicate()
    return run.returncode, said


def test_ctrl_c_soon_after_the_start_gives_no_traceback(tmp_path: Path) -> None:
    """The test begins with the first line of our code; earlier output is Python's. Calls are counted, not time."""
    folder = write_scene(tmp_path / "s", 1)
    code = f"""
import os, signal, sys
sys.path.insert(0, {str(ROOT)!r})
from utak.launcher import exit_at_ctrl_c, main
left, sys.argv = int(sys.argv[2]), ['utak', 'run', sys.argv[1]]
def press(frame, event, argument):
    global left
    left -= event == 'call'
    if not left:
        sys.setprofile(None)
        os.kill(os.getpid(), signal.SIGINT)
exit_at_ctrl_c()
sys.setprofile(press)
sys.exit(main())
"""
    for calls in (1, 300, 3_000, 20_000, 60_000):
        command = [sys.executable, "-c", code, str(folder), str(calls)]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        said = run.stderr
        assert run.returncode in (130, 1, 75), said
        assert "Traceback" not in said
        assert "bug" not in said


@pytest.mark.long
def test_a_background_job_ignores_ctrl_c(tmp_path: Path) -> None:
    def ignore() -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)

    folder = write_scene(tmp_path / "s", 1)
    command = [sys.executable, scripted_robot.__file__, "run", str(folder), "--log", "-"]
    prepare: Callable[[], None] = ignore
    environment = os.environ | {"PYTHONPATH": str(ROOT), "SCRIPTED_PAUSE": "0.02"}
    code, said = press_at_first_line(command, preexec_fn=prepare, env=environment)
    assert code == 75, said


def test_an_import_that_is_under_way_ends_before_the_interrupt(tmp_path: Path) -> None:
    (tmp_path / "interrupted_module.py").write_text(
        "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n"
        "for _ in range(1000): pass\nprint('whole', flush=True)\n"
    )
    code = (
        f"import signal, sys, time; sys.path[:0] = [{str(ROOT)!r}, {str(tmp_path)!r}]\n"
        "from utak.simulator.cli.main import _Interrupts\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "_Interrupts().take()\n"
        "try:\n    import interrupted_module\n    time.sleep(20)\n"
        "except KeyboardInterrupt:\n    print('interrupted', flush=True)\n"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["whole", "interrupted"]
    assert found.stderr == ""


def test_objects_whose_making_was_interrupted_leave_no_traceback() -> None:
    code = (
        f"import os, signal, sys; sys.path[:0] = [{str(ROOT)!r}]\n"
        "from utak.simulator.cli.main import _Interrupts\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "_Interrupts().take()\n"
        "class Handle:\n"
        "    def __init__(self):\n"
        "        if sys.argv[1] == 'interrupted': os.kill(os.getpid(), signal.SIGINT)\n"
        "    def __del__(self):\n        self.opened\n"
        "try:\n    Handle()\n"
        "except KeyboardInterrupt:\n    print('interrupted', flush=True)\n"
    )

    def run(how: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-c", code, how], capture_output=True, text=True, check=True)

    assert (run("interrupted").stdout, run("interrupted").stderr) == ("interrupted\n", "")
    assert "AttributeError" in run("whole").stderr  # without an interrupt it is a bug, and told
