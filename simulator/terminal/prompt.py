"""The prompt of `utak repl`: each line is a command or a query; the prompt survives every input."""

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from kb.language.diagnostics import BadInputError, CannotOpenError, did_you_mean
from kb.reasoning.query import QUERY_PREDICATES, QueryEngine, QueryLimitError
from simulator.run.interrupts import defer_interrupt
from simulator.run.story import Story
from simulator.terminal.action_in_words import describe
from simulator.terminal.streams import StreamError, escape_controls

# The answer to `help`.
HELP = """\
?- QUERY.     ask what Utak believes: ?- object(X), shape(X, square, C).
facts [WORD]  the world model as facts; with a word those that name it
step [N]      go on by one step, or by N
run           go on to the end
show          the true table as a picture; what the robot believes of it are the facts
help          this
quit          leave (so does the end of the input)

In facts, places and lengths are whole hundredths of a square, in the robot's frame: east and north from where it woke,
north being the way it faced then. Confidences are percent. The robot is called utak in questions, and org in facts."""
# Printed above every picture of the truth.
TRUE_TABLE_NOTICE = "the true table, which the robot may believe to be otherwise:"


class Prompt:
    """Executes commands about one story.

    Parameters
    ----------
    story : a run or a recorded episode.
    engine : answers queries.
    write : prints a text; by default on the standard output.
    """

    def __init__(self, story: Story, engine: QueryEngine, write: Callable[[str], object] | None = None) -> None:
        self._story, self._engine = story, engine
        self._write = write or (lambda text: print(text, flush=True))
        self._commands: dict[str, Callable[[str], None]] = {
            "?-": self._ask,
            "facts": self._facts,
            "help": lambda rest: self._say(HELP),
            "run": lambda rest: self._advance(None),
            "show": lambda rest: self._say(f"{TRUE_TABLE_NOTICE}\n{self._story.picture()}".rstrip("\n")),
            "step": self._step,
        }

    def words(self) -> list[str]:
        """Return the words that can be completed: commands and names of predicates."""
        return sorted([*self._commands, "quit", *(f"{name}(" for name, _ in QUERY_PREDICATES)])

    def obey(self, line: str) -> bool:
        """Execute a line. Return False when it says to quit. Errors are printed, not raised."""
        text = line.strip()
        name, _, rest = ("?-", "", text[2:]) if text.startswith("?-") else text.partition(" ")
        name = name.removesuffix(".")
        if name in ("quit", "exit"):
            return False
        if not text or text.startswith("%"):
            return True
        try:
            if name in self._commands:
                self._commands[name](rest.strip())
            else:
                self._unknown(name)
        except (BadInputError, CannotOpenError, QueryLimitError) as problem:
            self._say(str(problem))
        except KeyboardInterrupt:
            self._say("interrupted")
        except (BrokenPipeError, StreamError):
            raise
        except Exception as bug:  # the prompt must come back, whatever happens
            self._say(f"this is a bug of ours: {type(bug).__name__}: {str(bug)[:500]}")
        return True

    def _say(self, text: str) -> None:
        """Print a text."""
        self._write(text)

    def _ask(self, rest: str) -> None:
        """Print the answer to a query."""
        self._say(str(self._engine.ask(self._story.facts, rest)))

    def _facts(self, rest: str) -> None:
        """Print the facts of the world model; with a word, only those that contain it."""
        word = rest.removesuffix(".")
        facts = [fact for fact in self._story.facts if not word or word in _words_of(fact)]
        self._say("\n".join(facts) if facts else "none")

    def _step(self, rest: str) -> None:
        """Advance by a number of steps, 1 by default."""
        count = rest.removesuffix(".") or "1"
        if not (count.isascii() and count.isdigit() and 0 < int(count[:9]) <= 1_000_000):
            self._say(f"step takes a number of steps, not {rest}")
            return
        self._advance(int(count[:9]))

    def _advance(self, count: int | None) -> None:
        """Advance by `count` steps, or to the end for None, and print each step."""
        done = 0
        while done != count:
            with defer_interrupt(self._announce_interrupt) as pressed:
                moved = self._story.advance()
            if not moved:
                break
            done += 1
            line = self._story.line
            why = escape_controls(str(line.get("why", "")), False)
            self._say(f"step {line['step']}: {describe(line.get('action'))}: {why}")
            if pressed:
                self._say("interrupted")
                return
        result: Any = self._story.result
        if result is not None:
            reason = escape_controls(str(result["reason"]), False)
            self._say(f"{result['verdict']} after {result['steps']} steps: {reason}")
        elif done == 0:
            self._say("there are no more steps")

    def _announce_interrupt(self) -> None:
        """Print how to stop after the first Ctrl-C."""
        with suppress(RuntimeError):  # something is being printed just now
            self._say("the step comes to its end first; Ctrl-C once more breaks it off, and it did not happen")

    def _unknown(self, name: str) -> None:
        """Print that a command is unknown."""
        hint = did_you_mean(name, self._commands)
        self._say(f"unknown command {name[:40]}; {hint or 'help lists what there is, ?- asks'}")


def _words_of(fact: str) -> set[str]:
    """Return the words of a fact."""
    return set("".join(char if char.isalnum() or char == "_" else " " for char in fact).split())


def lines_of(words: Sequence[str]) -> Iterator[str]:
    """Yield the lines of the standard input; on a terminal, with history and completion.

    Parameters
    ----------
    words : the words that can be completed.

    Yields
    ------
    One line, with or without its line end.

    Raises
    ------
    StreamError : the standard input is closed or cannot be read.
    """
    if sys.stdin is None:
        raise StreamError("the standard input is closed")
    if not sys.stdin.isatty():
        try:
            for raw in sys.stdin.buffer:
                yield raw.decode("utf-8", errors="replace")
        except OSError as error:
            raise StreamError(f"the standard input cannot be read: {error.strerror}") from None
        return
    _prepare(words)
    with suppress(AttributeError):
        sys.stdin.reconfigure(errors="replace")  # type: ignore[union-attr]  # what is typed may be of another encoding
    while True:
        try:
            yield input("utak> ")
        except EOFError:
            print()
            return
        except KeyboardInterrupt:
            print()


def _prepare(words: Sequence[str]) -> None:
    """Set up history and completion, where Python has readline."""
    try:
        import atexit
        import readline
    except ImportError:
        return
    home = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
    history = home / "utak" / "history"
    try:
        history.parent.mkdir(parents=True, exist_ok=True)
        if history.exists():
            readline.read_history_file(history)
        readline.set_history_length(1000)
        atexit.register(_write_history, readline, history)
    except OSError:
        pass  # no history, then
    readline.set_completer(lambda text, n: [*[w for w in words if w.startswith(text)], None][n])
    readline.set_completer_delims(" \t\n,")
    readline.parse_and_bind("tab: complete")


def _write_history(readline: Any, history: Path) -> None:
    """Write the history file; print a message when that fails."""
    try:
        readline.write_history_file(history)
    except OSError:
        print(f"utak: the history could not be written to {history}", file=sys.stderr)
