"""The `utak` command: runs a subcommand, and turns errors into messages and exit codes."""

import sys
from collections.abc import Sequence
from types import FrameType

from utak.launcher import exit_at_ctrl_c, install_package_finder

REPEAT_DELAY_SECONDS = 0.01  # until Python no longer drops exceptions; a convention


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `utak` and return its exit code."""
    interrupts = _Interrupts()
    if arguments is None:
        exit_at_ctrl_c()
    try:
        install_package_finder()
        from utak.simulator.cli import parsing  # noqa: F401 (all imports happen before anything is done)
        from utak.simulator.terminal import exits
        from utak.simulator.terminal.streams import guard_streams, open_missing_streams

        if arguments is None:
            open_missing_streams()
            interrupts.take()
        with guard_streams() as (_, err):
            code = _run_reporting_errors(arguments, interrupts)
            err.flush()
        return exits.LOST_OUTPUT if err.lost and code == exits.SUCCESS else code
    except KeyboardInterrupt:
        return 130  # interrupted before the work began or after it ended
    finally:
        if arguments is None:
            interrupts.ignore()


class _Interrupts:
    """Remembers that Ctrl-C was pressed, because an interrupted operation may fail with another exception."""

    seen = False

    def take(self) -> None:
        """Handle SIGINT from now on, unless it is ignored, as in a background job."""
        import signal

        if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
            signal.signal(signal.SIGINT, self._note)
            sys.unraisablehook = self._again

    def ignore(self) -> None:
        """Ignore SIGINT from now on: nothing is left to interrupt."""
        import signal

        signal.signal(signal.SIGINT, signal.SIG_IGN)

    def _again(self, lost: "sys.UnraisableHookArgs") -> None:
        """Interrupt once more after an interrupt where Python drops all exceptions, such as the end of an import."""
        # That is no bug, so nothing is said.
        if issubclass(lost.exc_type, KeyboardInterrupt):
            repeat_soon()
        elif not self.seen:
            sys.__unraisablehook__(lost)

    def _note(self, number: int, frame: FrameType | None) -> None:
        """Note the interrupt and raise KeyboardInterrupt, or wait for the end of an import that is under way."""
        self.seen = True
        if is_importing(frame):
            repeat_soon()
        else:
            raise KeyboardInterrupt


def is_importing(frame: FrameType | None) -> bool:
    """Return whether the code of a frame runs within an import."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def repeat_soon() -> None:
    """Interrupt the main thread once more, a moment later."""
    from threading import Timer

    Timer(REPEAT_DELAY_SECONDS, signal_again).start()


def signal_again() -> None:
    """Interrupt the main thread, also where it waits for something."""
    import _thread
    import signal
    import threading

    main_thread = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main_thread is not None:
        signal.pthread_kill(main_thread, signal.SIGINT)
    else:  # Windows has no signals between threads
        _thread.interrupt_main()


def _run_reporting_errors(arguments: Sequence[str] | None, interrupts: _Interrupts) -> int:
    """Run with guarded streams, report errors and return the exit code."""
    from utak.simulator.terminal import exits
    from utak.simulator.terminal.outcome import outcome_of
    from utak.simulator.terminal.streams import StreamError

    try:
        code, message = outcome_of(_parse_and_execute, arguments)
    except KeyboardInterrupt:
        code, message = exits.INTERRUPTED, "utak: interrupted"
    except BrokenPipeError:
        return exits.NO_READER
    except StreamError as lost:
        code, message = exits.LOST_OUTPUT, f"utak: {lost}"
    except Exception:  # with UTAK_DEBUG
        if not interrupts.seen:
            raise
        code, message = exits.OUR_BUG, ""
    if code == exits.OUR_BUG and interrupts.seen:
        code, message = exits.INTERRUPTED, "utak: interrupted"
    if message:
        print(message, file=sys.stderr)
    return code


def _parse_and_execute(arguments: Sequence[str] | None) -> int:
    from importlib import import_module

    from utak.simulator.cli.parsing import build_parser
    from utak.simulator.terminal import exits
    from utak.simulator.terminal.outcome import UsageError

    try:
        options = build_parser().parse_args(arguments)
    except SystemExit as stop:  # argparse has said what is wrong, or has printed the help
        return stop.code if isinstance(stop.code, int) else exits.USAGE
    try:
        code: int = import_module(f"utak.simulator.cli.commands.{options.command.module}").execute(options)
        sys.stdout.flush()
    except UsageError as wrong:
        print(f"utak {options.command.name}: {wrong}", file=sys.stderr)
        return exits.USAGE
    return code
