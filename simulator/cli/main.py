"""The `utak` command: runs a subcommand, and turns what goes wrong into messages and exit codes."""

import os
import sys
from collections.abc import Sequence
from types import FrameType

from utak_command import exit_at_ctrl_c, find_ours_here

REPEAT_DELAY_SECONDS = 0.01  # seconds after which what Python ignores is over


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `utak` with arguments and return its exit code.

    Without any, those of the process are taken, and Ctrl-C and the standard streams with them: it is to end then.
    """
    interrupts = _Interrupts()
    if arguments is None:
        exit_at_ctrl_c()
    try:
        find_ours_here()
        from simulator.cli import parsing  # noqa: F401 (all that is imported before anything is done)
        from simulator.terminal.streams import guard_streams, open_missing_streams

        if arguments is None:
            open_missing_streams()
            interrupts.take()
        with guard_streams() as (_, err):
            code = _run_reporting_errors(arguments, interrupts)
            err.flush()
        return _final_code(code, err.lost)
    except KeyboardInterrupt:
        return 130  # before or after everything
    finally:
        if arguments is None:
            interrupts.ignore()


class _Interrupts:
    """Notes that Ctrl-C was pressed: what it breaks off may call it by another name, such as a failed import."""

    seen = False

    def take(self) -> None:
        """Handle SIGINT from now on, unless it is ignored, as in a background job."""
        import signal

        if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
            signal.signal(signal.SIGINT, self._note)
            sys.unraisablehook = self._again

    def ignore(self) -> None:
        """Nothing is left to interrupt."""
        import signal

        signal.signal(signal.SIGINT, signal.SIG_IGN)

    def _again(self, lost: "sys.UnraisableHookArgs") -> None:
        """Interrupt once more, when it happened where Python ignores every exception, as at the end of an import."""
        if issubclass(lost.exc_type, KeyboardInterrupt):
            from threading import Timer

            Timer(REPEAT_DELAY_SECONDS, signal_again).start()
        else:
            sys.__unraisablehook__(lost)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.seen = True
        raise KeyboardInterrupt


def signal_again() -> None:
    """Let the main thread be interrupted."""
    import _thread

    _thread.interrupt_main()


def _run_reporting_errors(arguments: Sequence[str] | None, interrupts: _Interrupts) -> int:
    """Run, with streams to which all can be written, and return the exit code."""
    from kb.language.diagnostics import BadInputError, CannotOpenError
    from simulator.terminal import exits
    from simulator.terminal.outcome import bug_message
    from simulator.terminal.streams import StreamError

    try:
        code = _parse_and_execute(arguments)
        sys.stdout.flush()
    except BadInputError as bad:
        return _print_error(exits.BAD_INPUT, str(bad))
    except CannotOpenError as absent:
        return _print_error(exits.CANNOT_OPEN, f"utak: {absent}")
    except KeyboardInterrupt:
        return _print_error(exits.INTERRUPTED, "utak: interrupted")
    except BrokenPipeError:
        return exits.NO_READER
    except StreamError as lost:
        return _print_error(exits.LOST_OUTPUT, f"utak: {lost}")
    except Exception as bug:
        if interrupts.seen:
            return _print_error(exits.INTERRUPTED, "utak: interrupted")
        if os.environ.get("UTAK_DEBUG"):
            raise
        return _print_error(exits.OUR_BUG, bug_message(bug))
    return code


def _parse_and_execute(arguments: Sequence[str] | None) -> int:
    from simulator.cli.parsing import build_parser
    from simulator.terminal import exits

    try:
        options = build_parser().parse_args(arguments)
    except SystemExit as stop:  # argparse has said what is wrong, or has printed the help
        return stop.code if isinstance(stop.code, int) else exits.USAGE
    code: int = options.execute(options)
    return code


def _print_error(code: int, message: str) -> int:
    print(message, file=sys.stderr)
    return code


def _final_code(code: int, lost: str) -> int:
    """The exit code, when something could not be said on the standard error: then it did not go well."""
    from simulator.terminal import exits

    return exits.LOST_OUTPUT if lost and code == exits.SUCCESS else code


if __name__ == "__main__":
    sys.exit(main())
