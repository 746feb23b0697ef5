"""`utak run`: run the robot on a scenario."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from utak.simulator.scenario.settings import PATH_CHOICES
from utak.simulator.scenario.untrusted import add_untrusted_option, refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.numbers import MAX_SECONDS, MIN_SECONDS, parse_decimal, parse_whole
from utak.simulator.terminal.printing import as_json
from utak.simulator.terminal.streams import escape_controls

if TYPE_CHECKING:
    from collections.abc import Callable

    from utak.simulator.episode.episode import Episode, EpisodeLine
    from utak.simulator.run.session import Result, Session
    from utak.simulator.run.time_limit import TimeLimit
    from utak.simulator.scenario.scenario import Scenario
    from utak.simulator.scenario.settings import Settings
    from utak.simulator.terminal.progress import StepProgress

    LineListener = Callable[[EpisodeLine], None]

DUMP_HELP = "write program and facts of every decision into this folder, as plain clingo reads them"
SETTINGS_OPTIONS = ("seed", "noise", "paths", "max_steps", "pull")  # the fields of Settings that options state


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("run", help="run the robot on a scenario")
    part.add_argument("scenario", metavar="SCENARIO", help="a scenario folder")
    add_settings(part)
    part.add_argument(
        "--log", metavar="EP.jsonl", help="write the episode to this file as it happens; - is the standard output"
    )
    part.add_argument("--html", metavar="FILE", help="write the whole run as a page that plays it in any browser")
    part.add_argument("--seconds", type=_seconds, metavar="S", help="end a run that takes longer, also within a step")
    part.add_argument("--resume", action="store_true", help="go on from the episode that --log names")
    part.add_argument(
        "--from",
        dest="origin",
        metavar="EP.jsonl",
        help="repeat this episode up to --at, then go on with the task of SCENARIO and the options given now",
    )
    part.add_argument("--at", type=_steps, metavar="STEP", help="the last step of --from that is repeated")
    part.add_argument(
        "--from-kb", action="append", metavar="FILE", default=[], help="a file of rules of the repeated run; repeatable"
    )
    part.add_argument("--dump-asp", metavar="DIR", help=DUMP_HELP)
    part.add_argument(
        "--force",
        action="store_true",
        help="let --log and --html overwrite files of other kinds, and --dump-asp fill a folder",
    )
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
    add_robot_settings(part)


def add_robot_settings(part: argparse.ArgumentParser) -> None:
    """Declare the options of a run besides seed and noise."""
    part.add_argument("--paths", choices=PATH_CHOICES, help="how routes are found (default skeleton)")
    part.add_argument(
        "--no-pull", dest="pull", action="store_false", default=None, help="push what is held, never pull"
    )
    part.add_argument("--max-steps", type=_steps, metavar="N", help="give up after so many commands (default 200)")
    part.add_argument("--kb", action="append", metavar="FILE", default=[], help="a file of rules to add; repeatable")
    add_untrusted_option(part)


def execute(options: argparse.Namespace) -> int:
    """Run the robot and print the result."""
    from utak.simulator.episode.episode import STANDARD_OUTPUT
    from utak.simulator.scenario.scenario import read_scenario
    from utak.simulator.terminal.progress import StepProgress

    wrong = _wrong_usage(options)
    if wrong:
        print(f"utak run: {wrong}", file=sys.stderr)
        return exits.USAGE
    refuse_links(options, options.scenario)
    scenario = read_scenario(options.scenario)
    if options.html is not None:
        from utak.simulator.replay.output import check_page_path

        check_page_path(options.html, options.force)
    lines: list[EpisodeLine] = []
    run = _run if options.origin is None else _run_fork
    with StepProgress(settings_of(options).max_steps) as progress:
        result = run(options, scenario, _progress_printer(options.watch, progress), _listener(options, lines))
    if options.html is not None:
        from utak.simulator.explaining.questions import rule_paths
        from utak.simulator.replay.output import write_page

        rule_files = rule_paths((*options.kb, *options.from_kb))
        write_page(options.html, _recorded(lines), options.force, rule_files, Path(options.scenario).resolve().name)
    _print(result, options.json, sys.stderr if options.log == STANDARD_OUTPUT else sys.stdout)
    return exit_code(result)


def _wrong_usage(options: argparse.Namespace) -> str:
    """Return what is wrong with the combination of options; '' for nothing."""
    from utak.simulator.episode.episode import STANDARD_OUTPUT

    if options.resume and options.log in (None, STANDARD_OUTPUT):
        return "--resume needs --log EP.jsonl"
    if (options.origin is None) != (options.at is None):
        return "--from EP.jsonl and --at STEP belong together"
    if options.origin is not None and options.resume:
        return "--resume goes on from the fork that --log names; leave out --from and --at"
    if options.origin is not None and _is_same_file(options.origin, options.log):
        return "--log names the episode of --from; a fork is written to another file"
    return ""


def _is_same_file(one: str, other: str | None) -> bool:
    """Return whether two names mean the same file."""
    try:
        return other is not None and Path(one).samefile(other)
    except (OSError, ValueError):
        return False


def _run(
    options: argparse.Namespace, scenario: "Scenario", watch: "Callable[[Session], None]", listen: "LineListener"
) -> "Result":
    """Run from the start, or go on from the episode that --log names; return the result."""
    from utak.simulator.episode.episode import EpisodeLog
    from utak.simulator.run.forking import repeat_stages, stages_until
    from utak.simulator.run.robots import make_robot
    from utak.simulator.run.session import Session

    head = _recorded_header(options) or {}
    settings = settings_of(options, head.get("options"))
    rules = [*options.kb, *options.from_kb]
    before = stages_until(options.log, head, None, scenario, rules) if "forked" in head else []
    with EpisodeLog(options.log, options.resume, options.force, listen) as log:
        if not before:
            return Session(scenario, settings, make_robot, log).run(watch, _time_limit(options))
        return repeat_stages(before, scenario, settings, make_robot, log).go_on(watch, _time_limit(options))


def _run_fork(
    options: argparse.Namespace, scenario: "Scenario", watch: "Callable[[Session], None]", listen: "LineListener"
) -> "Result":
    """Repeat the episode of --from up to --at, go on with the options given now, and return the result."""
    from utak.simulator.episode.episode import EpisodeLog, read_episode
    from utak.simulator.run.forking import options_at, repeat_until
    from utak.simulator.run.robots import make_robot

    episode = read_episode(options.origin)
    settings = settings_of(options, options_at(episode.header, options.at))
    with EpisodeLog(options.log, force=options.force, listen=listen) as log:
        session = repeat_until(
            options.origin, episode, options.at, scenario, settings, make_robot, log, options.from_kb
        )
        return session.go_on(watch, _time_limit(options))


def _time_limit(options: argparse.Namespace) -> "TimeLimit | None":
    """Return the limit of time that --seconds states; None without it."""
    from utak.simulator.run.time_limit import TimeLimit

    return None if options.seconds is None else TimeLimit(options.seconds)


def _listener(options: argparse.Namespace, lines: "list[EpisodeLine]") -> "LineListener":
    """Return the function that takes each line of the episode, for --dump-asp and --html."""
    listeners: list[LineListener] = []
    if options.dump_asp is not None:
        from utak.simulator.episode.program_dump import ProgramDump

        listeners.append(ProgramDump(options.dump_asp, "the run", [*options.kb, *options.from_kb], options.force).add)
    if options.html is not None:
        listeners.append(lines.append)

    def listen(line: "EpisodeLine") -> None:
        """Pass a line on."""
        for take in listeners:
            take(line)

    return listen


def settings_of(options: argparse.Namespace, recorded: dict[str, Any] | None = None) -> "Settings":
    """Return the settings of the command line; where it is silent, those of a recorded episode."""
    from dataclasses import replace

    from utak.simulator.scenario.settings import Settings, kb_files_named

    kept = {name: value for name, value in (recorded or {}).items() if name in SETTINGS_OPTIONS}
    return replace(Settings(kb_files=kb_files_named(options.kb)), **{**kept, **given_settings(options)})


def given_settings(options: argparse.Namespace) -> dict[str, Any]:
    """Return the fields of `Settings` that the command line states, by name, without the files of rules."""
    return {name: getattr(options, name) for name in SETTINGS_OPTIONS if getattr(options, name) is not None}


def exit_code(result: "Result") -> int:
    """Return the exit code for a result."""
    if result.believed:
        return exits.NOT_REACHED if result.achieved is False else exits.SUCCESS
    return exits.LIMIT if result.verdict == "limit" else exits.NOT_REACHED


def _recorded_header(options: argparse.Namespace) -> dict[str, Any] | None:
    """Return the header of the episode that is to be resumed; None when there is none."""
    from utak.simulator.episode.episode import lines_to_resume, read_episode

    if not options.resume or not Path(options.log).exists() or not lines_to_resume(options.log):
        return None
    return read_episode(options.log).header


def _print(result: "Result", json: bool, stream: TextIO) -> None:
    """Print the result."""
    if json:
        print(as_json({**result.line["result"], "unmet": list(result.unmet)}), file=stream)
        return
    achieved = ", achieved" if result.believed else ", as expected"  # by `verdict(V)` of expect.lp
    truth = {None: "", True: achieved, False: ", not achieved"}[result.achieved]
    print(
        f"{result.verdict} in {result.steps} steps{truth}: {escape_controls(result.reason, lines=False)}", file=stream
    )
    for expected, came in zip(result.unmet, result.came, strict=True):
        print(f"not met: {expected}: {came}", file=sys.stderr)
    for rule in result.idle_rules:
        print(escape_controls(rule, lines=False), file=sys.stderr)


def _progress_printer(watch: bool, progress: "StepProgress") -> "Callable[[Session], None]":
    """Return what prints after each step: nothing, one line on a terminal, or the table as a picture."""
    from utak.simulator.replay.watching import TableWatch, step_in_words

    tell = TableWatch().tell if watch else lambda session: print(step_in_words(session.line), file=sys.stderr)

    def note(session: "Session") -> None:
        """Tell the step that is done; the next one begins."""
        if watch or sys.stderr.isatty():
            tell(session)
        progress.begin(session.line["step"] + 1)

    return note


def _recorded(lines: "list[EpisodeLine]") -> "Episode":
    """Return a run as the episode that `--log` would have, from all of its lines."""
    import json

    from utak.simulator.episode.episode import Episode, encode

    first, *steps, last = (json.loads(encode(line)) for line in lines)
    return Episode(first, tuple(steps), last["result"])


def _seed(text: str) -> int:
    """Return the number for `--seed`."""
    return parse_whole(text, 0, 2**63 - 1)


def _steps(text: str) -> int:
    """Return the number for `--max-steps`."""
    return parse_whole(text, 0, 1_000_000)


def _seconds(text: str) -> float:
    """Return the number for `--seconds`."""
    return parse_decimal(text, MIN_SECONDS, MAX_SECONDS)


def _noise(text: str) -> float:
    """Return the number for `--noise`."""
    return parse_decimal(text, 0, 1)
