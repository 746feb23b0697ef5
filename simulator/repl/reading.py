"""The sources of lines: a pipe, a terminal with readline, a terminal with prompt_toolkit; and the history."""

import os
import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

from utak.simulator.episode.output_files import replace_whole
from utak.simulator.repl.completion import CompletionWord
from utak.simulator.terminal.streams import StreamError

MAX_HISTORY_LINES = 1000  # statements that are remembered; a convention
PLAIN_PROMPT_VARIABLE = "UTAK_PLAIN_PROMPT"  # set, it lets the prompt take readline where prompt_toolkit is installed
CONTINUATION = "  ... "  # the prompt of a line that continues a statement
Complete = Callable[[str], tuple[str, list[CompletionWord]]]  # the word at the end of a text, and what completes it


class LineReader(Protocol):
    """A source of lines."""

    @property
    def is_terminal(self) -> bool:
        """Whether a person types the lines."""

    def read(self, prompt: str, is_open: bool) -> str:
        """Return the next line, or several; raise EOFError at the end, StreamError when it cannot be read."""


class PipedLines:
    """The lines of a standard input that is no terminal; no prompt is printed."""

    is_terminal = False

    def read(self, prompt: str, is_open: bool) -> str:
        """Return the next line; bytes that are no UTF-8 are replaced."""
        try:
            raw = sys.stdin.buffer.readline()
        except OSError as error:
            raise StreamError(f"the standard input cannot be read: {error.strerror}") from None
        if not raw:
            raise EOFError
        return raw.decode("utf-8", errors="replace")


class PromptingLines:
    """The lines of a terminal whose answers go elsewhere: the prompt is printed on the standard error."""

    is_terminal = True

    def read(self, prompt: str, is_open: bool) -> str:
        """Return the next line."""
        print(CONTINUATION if is_open else prompt, end="", file=sys.stderr, flush=True)
        line = sys.stdin.readline()
        if not line:
            raise EOFError
        return line


class ReadlineLines:
    """The lines of a terminal, with Python's readline where there is one."""

    is_terminal = True

    def __init__(self, complete: Complete, history: Sequence[str]) -> None:
        self._complete = complete
        self._found: list[str] = []
        self._begun = ""  # the lines of the statement before this one
        self._readline: Any = None
        with suppress(ImportError):
            import readline

            self._readline = readline
            for line in history:
                readline.add_history(line)
            readline.set_completer(self._completion)
            readline.set_completer_delims(" \t\n,(.")
            readline.parse_and_bind("tab: complete")

    def read(self, prompt: str, is_open: bool) -> str:
        """Return the next line."""
        if not is_open:
            self._begun = ""
        with suppress(AttributeError):
            sys.stdin.reconfigure(errors="replace")  # type: ignore[union-attr]  # what is typed may be of another encoding
        try:
            line = input(CONTINUATION if is_open else prompt)
        except KeyboardInterrupt:
            print()
            raise
        self._begun += f"{line}\n"
        return line

    def _completion(self, text: str, number: int) -> str | None:
        """Return one completion of the word at the cursor, for readline; None behind the last one."""
        if number == 0:
            before = self._readline.get_line_buffer()[: self._readline.get_endidx()]
            word, candidates = self._complete(self._begun + before)
            self._found = [text[: len(text) - len(word)] + one.text for one in candidates]
        return self._found[number] if number < len(self._found) else None


class ToolkitLines:
    """The statements of a terminal, with prompt_toolkit: several lines are edited together."""

    is_terminal = True

    def __init__(self, complete: Complete, history: Sequence[str], is_whole: Callable[[str], bool]) -> None:
        from prompt_toolkit import PromptSession
        from prompt_toolkit.application.current import get_app
        from prompt_toolkit.completion import Completer, Completion
        from prompt_toolkit.filters import Condition
        from prompt_toolkit.history import InMemoryHistory
        from prompt_toolkit.key_binding import KeyBindings
        from prompt_toolkit.output import create_output

        class Words(Completer):
            """Completes the word at the cursor."""

            def get_completions(self, document: Any, complete_event: Any) -> Iterable[Any]:
                """Yield the completions of the word before the cursor."""
                word, candidates = complete(document.text_before_cursor)
                for one in candidates:
                    yield Completion(one.text, start_position=-len(word), display_meta=one.meaning)

        keys = KeyBindings()

        @Condition
        def goes_on() -> bool:
            """Return whether Enter begins a new line of the statement."""
            return not is_whole(get_app().current_buffer.text)

        @keys.add("enter", filter=goes_on)
        def _(event: Any) -> None:
            """Begin a new line."""
            event.current_buffer.insert_text("\n")

        @keys.add("enter", filter=~goes_on)
        def _(event: Any) -> None:
            """End the statement."""
            event.current_buffer.validate_and_handle()

        self._session: Any = PromptSession(
            history=InMemoryHistory(list(history)),
            completer=Words(),
            complete_while_typing=False,
            multiline=True,
            key_bindings=keys,
            prompt_continuation=CONTINUATION,
            enable_history_search=False,
            output=create_output(stdout=sys.__stdout__),
        )

    def read(self, prompt: str, is_open: bool) -> str:
        """Return the next statement, perhaps of several lines."""
        try:
            return str(self._session.prompt(prompt))
        except OSError as error:
            raise StreamError(f"the terminal cannot be read: {error.strerror}") from None


class History:
    """The statements that were typed, in the folder of this user's state (XDG_STATE_HOME)."""

    def __init__(self, path: Path | None = None) -> None:
        self._path = path or state_folder() / "history"

    def read(self) -> list[str]:
        """Return the newest statements, the oldest first; [] when they cannot be read. A long file is cut."""
        lines: list[str] = []
        with suppress(OSError):
            lines = self._path.read_text(encoding="utf-8", errors="replace").splitlines()
            if len(lines) > 2 * MAX_HISTORY_LINES:
                replace_whole(self._path, "".join(f"{line}\n" for line in lines[-MAX_HISTORY_LINES:]).encode("utf-8"))
        return lines[-MAX_HISTORY_LINES:]

    def append(self, statement: str) -> None:
        """Remember a statement in one line; nothing happens when that fails."""
        line = " ".join(statement.split())
        with suppress(OSError):
            self._path.parent.mkdir(parents=True, exist_ok=True)
            handle = os.open(self._path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
            with os.fdopen(handle, "w", encoding="utf-8", errors="replace") as stream:
                stream.write(f"{line}\n")


def state_folder() -> Path:
    """Return the folder of what `utak` remembers of this user."""
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "utak"


def open_reader(complete: Complete, history: History, is_whole: Callable[[str], bool]) -> LineReader:
    """Return the best source of lines that there is; raise StreamError when the standard input is closed."""
    if sys.stdin is None:
        raise StreamError("the standard input is closed")
    if not sys.stdin.isatty():
        return PipedLines()
    if not sys.stdout.isatty():
        return PromptingLines()
    if os.environ.get("TERM") not in (None, "", "dumb") and not os.environ.get(PLAIN_PROMPT_VARIABLE):
        with suppress(ImportError):
            return ToolkitLines(complete, history.read(), is_whole)
    return ReadlineLines(complete, history.read())
