"""`utak run`: run the robot on a scenario."""

import argparse
import sys
from typing import TYPE_CHECKING, Any, TextIO

from simulator.scenario.settings import PATH_CHOICES
from simulator.scenario.untrusted import add_untrusted_option, refuse_links
from simulator.terminal import exits
from simulator.terminal.numbers import parse_decimal, parse_whole
from simulator.terminal.printing import as_json
from simulator.terminal.streams import escape_controls

if TYPE_CHECKING:
    from collections.abc import Callable

    from simulator.episode.episode import Episode, EpisodeLine
    from simulator.run.session import Result, Session
    from simulator.scenario.settings import Settings


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("run", help="run the robot on a scenario")
    part.add_argument("scenario", metavar="SCENARIO", help="a scenario folder")
    add_settings(part)
    part.add_argument(
        "--log", metavar="EP.jsonl", help="write the episode to this file as it happens; - is the standard output"
    )
    part.add_argument("--html", metavar="FILE", help="write the whole run as a page that plays it in any browser")
    part.add_argument("--resume", action="store_true", help="go on from the episode that --log names")
    part.add_argument("--force", action="store_true", help="let --log and --html overwrite files of other kinds")
    part.add_argument("--json", action="store_true", help="print the result as one JSON object")
    part.add_argument(
        "--watch",
        action="store_true",
        help="draw the true table, which the robot does not see, on stderr after every step; on a terminal in place",
    )
    part.set_defaults(execute=execute)


def add_settings(part: argparse.ArgumentParser) -> None:
    """Declare the options that determine a run."""
    part.add_argument("--seed", type=_seed, metavar="N", help="seed of all randomness (default 0)")
    part.add_argument("--noise", type=_noise, metavar="S", help="how much motions are disturbed, 0 to 1 (default 0)")
    part.add_argument("--paths", choices=PATH_CHOICES, help="how routes are found (default skeleton)")
    part.add_argument(
        "--no-pull", dest="pull", action="store_false", default=None, help="push what is held, never pull"
    )
    part.add_argument("--max-steps", type=_steps, metavar="N", help="give up after so many commands (default 200)")
    part.add_argument("--kb", action="append", metavar="FILE", default=[], help="a file of rules to add; repeatable")
    add_untrusted_option(part)


def execute(options: argparse.Namespace) -> int:
    """Run the robot and print the result."""
    from simulator.episode.episode import STANDARD_OUTPUT, EpisodeLog
    from simulator.run.robots import make_robot
    from simulator.run.session import Session
    from simulator.scenario.scenario import read_scenario

    if options.resume and options.log in (None, STANDARD_OUTPUT):
        print("utak run: --resume needs --log EP.jsonl", file=sys.stderr)
        return exits.USAGE
    refuse_links(options, options.scenario)
    scenario = read_scenario(options.scenario)
    settings = settings_of(options, _recorded_options(options))
    if options.html is not None:
        from simulator.replay.output import check_page_path, write_page

        check_page_path(options.html, options.force)
    lines: list[EpisodeLine] = []
    tell = _progress_printer(options.watch)

    def note(session: Session) -> None:
        if options.html is not None and len(lines) <= session.line["step"]:
            lines.append(session.line)
        tell(session)

    with EpisodeLog(options.log, options.resume, options.force) as log:
        session = Session(scenario, settings, make_robot, log)
        result = session.run(note)
    if options.html is not None:
        write_page(options.html, _recorded(session, lines, result), options.force)
    _print(result, options.json, sys.stderr if options.log == STANDARD_OUTPUT else sys.stdout)
    return exit_code(result)


def settings_of(options: argparse.Namespace, recorded: dict[str, Any] | None = None) -> "Settings":
    """Return the settings of the command line; where it is silent, those of a recorded episode."""
    from dataclasses import replace

    from simulator.scenario.settings import Settings, kb_files_named

    names = ("seed", "noise", "paths", "max_steps", "pull")
    given = {name: getattr(options, name) for name in names if getattr(options, name) is not None}
    kept = {name: value for name, value in (recorded or {}).items() if name in names}
    return replace(Settings(kb_files=kb_files_named(options.kb)), **{**kept, **given})


def exit_code(result: "Result") -> int:
    """Return the exit code for a result."""
    if result.believed:
        return exits.NOT_REACHED if result.achieved is False else exits.SUCCESS
    return exits.LIMIT if result.verdict == "limit" else exits.NOT_REACHED


def _recorded_options(options: argparse.Namespace) -> dict[str, Any] | None:
    """Return the options of the episode that is to be resumed; None when there is none."""
    from pathlib import Path

    from simulator.episode.episode import complete_lines, read_episode

    if not options.resume or not Path(options.log).exists() or not complete_lines(options.log):
        return None
    found = read_episode(options.log).header.get("options")
    return found if isinstance(found, dict) else None


def _print(result: "Result", json: bool, stream: TextIO) -> None:
    """Print the result."""
    if json:
        print(as_json({**result.line["result"], "unmet": list(result.unmet)}), file=stream)
        return
    truth = {None: "", True: ", achieved", False: ", not achieved"}[result.achieved]
    print(
        f"{result.verdict} in {result.steps} steps{truth}: {escape_controls(result.reason, lines=False)}", file=stream
    )
    for expected in result.unmet:
        print(f"not met: {expected}", file=sys.stderr)


def _progress_printer(watch: bool) -> "Callable[[Session], None]":
    """Return what prints after each step: nothing, one line on a terminal, or the table as a picture."""
    from simulator.replay.watching import TableWatch, step_in_words

    if watch:
        return TableWatch().tell
    if not sys.stderr.isatty():
        return lambda session: None
    return lambda session: print(step_in_words(session.line), file=sys.stderr)


def _recorded(session: "Session", lines: "list[EpisodeLine]", result: "Result") -> "Episode":
    """Return a run as the episode that `--log` would have."""
    import json

    from simulator.episode.episode import Episode, encode
    from simulator.episode.record import header

    first, *steps = (json.loads(encode(line)) for line in (header(session.scenario, session.settings), *lines))
    return Episode(first, tuple(steps), result.line["result"])


def _seed(text: str) -> int:
    """Return the number for `--seed`."""
    return parse_whole(text, 0, 2**63 - 1)


def _steps(text: str) -> int:
    """Return the number for `--max-steps`."""
    return parse_whole(text, 0, 1_000_000)


def _noise(text: str) -> float:
    """Return the number for `--noise`."""
    return parse_decimal(text, 0, 1)
