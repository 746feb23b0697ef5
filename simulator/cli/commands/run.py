"""`utak run`: run the robot on a scenario."""

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TextIO

from utak.kb.language.source_text import source_from_bytes
from utak.simulator.certificates.search import NoCertificateError, certificate_of, is_certificate
from utak.simulator.cli.commands.given import settings_of
from utak.simulator.episode.episode import (
    STANDARD_OUTPUT,
    Episode,
    EpisodeLine,
    EpisodeLog,
    encode,
    lines_to_resume,
    read_episode,
)
from utak.simulator.episode.output_files import check_path, write_whole
from utak.simulator.episode.program_dump import ProgramDump
from utak.simulator.episode.record import fact_lines
from utak.simulator.explaining.missing_rules import rule_paths
from utak.simulator.replay.output import PAGE_KIND, write_page
from utak.simulator.replay.page import is_page
from utak.simulator.replay.watching import TableWatch
from utak.simulator.run.forking import options_at, recorded_stages, repeat_stages
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Result, Session
from utak.simulator.run.time_limit import TimeLimit
from utak.simulator.scenario.disturbances import disturbed_world, read_disturbed
from utak.simulator.scenario.scenario import Scenario, read_scenario
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.action_in_words import step_in_words, truth_in_words
from utak.simulator.terminal.outcome import UsageError
from utak.simulator.terminal.printing import as_json
from utak.simulator.terminal.progress import StepProgress
from utak.simulator.terminal.streams import one_line

LineListener = Callable[[EpisodeLine], None]


def execute(options: argparse.Namespace) -> int:
    """Run the robot and print the result."""
    if wrong := _wrong_usage(options):
        raise UsageError(wrong)
    refuse_links(options, options.scenario)
    scenario = read_scenario(options.scenario)
    if options.html is not None:
        check_path(options.html, is_page, PAGE_KIND, options.force)
    if options.certificate is not None:
        check_path(options.certificate, is_certificate, "certificate", options.force)
    lines: list[EpisodeLine] = []
    with StepProgress(settings_of(options).max_steps) as progress:
        result = _run(options, scenario, _progress_printer(options.watch, progress), list(_listeners(options, lines)))
    certificate = "" if options.certificate is None else _certificate_written(options, result, lines)
    if options.html is not None:
        rule_files, name = rule_paths((*options.kb, *options.from_kb)), Path(options.scenario).resolve().name
        write_page(options.html, _recorded(lines), options.force, rule_files, name, certificate)
    _print(result, options.json, sys.stderr if options.log == STANDARD_OUTPUT else sys.stdout)
    return exit_code(result)


def _certificate_written(options: argparse.Namespace, result: Result, lines: Sequence[EpisodeLine]) -> str:
    """Write the certificate of the verdict and return its text; where there is none, say why and return ""."""
    try:
        text = certificate_of(map(encode, lines), result.verdict, options.risk)
    except NoCertificateError as why:
        print(one_line(f"no certificate: {why}"), file=sys.stderr)
        return ""
    write_whole(options.certificate, text.encode("ascii"), is_certificate, "certificate", options.force)
    return text


def _wrong_usage(options: argparse.Namespace) -> str:
    """Return what is wrong with the combination of options; '' for nothing."""
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
    try:
        return other is not None and Path(one).samefile(other)
    except (OSError, ValueError):
        return False


def _run(
    options: argparse.Namespace, scenario: Scenario, watch: Callable[[Session], None], listeners: Sequence[LineListener]
) -> Result:
    """Run from the start, from the step --at of --from, or from the end of --log; return the result."""
    name, step = (options.log, None) if options.resume else (options.origin, options.at)
    is_recorded = name is not None and (not options.resume or (Path(name).exists() and lines_to_resume(name)))
    episode = read_episode(name) if is_recorded else None
    scenario = _disturbed(options, scenario, name, episode)
    settings = settings_of(options, None if episode is None else options_at(episode.header, step))
    rules = [*options.kb, *options.from_kb]
    stages = [] if episode is None else recorded_stages(name, episode, step, scenario, rules)
    with EpisodeLog(options.log, options.resume, options.force, listeners) as log:
        if episode is None or not stages:
            session = Session(scenario, settings, make_robot, log)
        else:  # the log compares the lines of an episode that is resumed
            lines = () if step is None else episode.steps
            session = repeat_stages(stages, scenario, settings, log, name, lines)
        return session.run(watch, None if options.seconds is None else TimeLimit(options.seconds))


def _disturbed(options: argparse.Namespace, scenario: Scenario, name: str, episode: Episode | None) -> Scenario:
    """Return the scenario with what others do by --disturb; without it, by the episode that is gone on from."""
    world, facts = scenario.world, [] if episode is None else episode.header["world"].get("disturbances", [])
    if options.disturb is not None:
        world = read_disturbed(world, options.disturb)
    elif facts:
        world = disturbed_world(world, source_from_bytes(name, fact_lines(facts).encode()))
    return replace(scenario, world=world)


def _refusals(line: EpisodeLine) -> None:
    """Print what others could not do before the command of a line."""
    for fact, why in line.get("refused", {}).items():
        print(one_line(f"step {line['step']}: not disturbed: {fact}: {why}"), file=sys.stderr)


def _listeners(options: argparse.Namespace, lines: list[EpisodeLine]) -> Iterator[LineListener]:
    """Yield the functions that take each line of the episode, for --disturb, --dump-asp, --html and --certificate."""
    yield _refusals
    if options.dump_asp is not None:
        yield ProgramDump(options.dump_asp, "the run", [*options.kb, *options.from_kb], options.force).add
    if options.html is not None or options.certificate is not None:
        yield lines.append


def exit_code(result: Result) -> int:
    """Return the exit code for a result."""
    if result.believed:
        return exits.NOT_REACHED if result.achieved is False else exits.SUCCESS
    return exits.LIMIT if result.verdict == "limit" else exits.NOT_REACHED


def _print(result: Result, as_object: bool, stream: TextIO) -> None:
    if as_object:
        print(as_json({**result.line["result"], "unmet": list(result.unmet)}), file=stream)
        return
    truth = truth_in_words(result.achieved, "achieved" if result.believed else "as expected")  # by `verdict(V)`
    print(f"{result.verdict} in {result.steps} steps{truth}: {one_line(result.reason)}", file=stream)
    for expected, came in zip(result.unmet, result.came, strict=True):
        print(f"not met: {expected}: {came}", file=sys.stderr)
    for rule in result.idle_rules:
        print(one_line(rule), file=sys.stderr)


def _progress_printer(watch: bool, progress: StepProgress) -> Callable[[Session], None]:
    """Return what prints after each step: nothing, one line on a terminal, or the table as a picture."""
    tell = TableWatch().tell if watch else lambda session: print(step_in_words(session.line), file=sys.stderr)

    def note(session: Session) -> None:
        """Tell the step that is done; the next one begins."""
        if watch or sys.stderr.isatty():
            tell(session)
        progress.begin(session.line["step"] + 1)

    return note


def _recorded(lines: list[EpisodeLine]) -> Episode:
    """Return a run as the episode that `--log` would have, from all of its lines."""
    first, *steps, last = (json.loads(encode(line)) for line in lines)
    return Episode(first, tuple(steps), last["result"])
