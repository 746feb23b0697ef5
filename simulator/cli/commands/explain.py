"""`utak explain`: why a fact is believed, why a command was given, what a cell is laid to, what would have worked."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from utak.kb.evidence.reason import Depth, Reason
from utak.simulator.cli.commands.given import given_certificate, given_story, go_to
from utak.simulator.episode.episode import Episode, read_begun_episode
from utak.simulator.explaining.fixing.changes import Led, MoreCommands, WorldChange, variant_of
from utak.simulator.explaining.fixing.proving import DEFAULT_RUNS, Budget, Outcome
from utak.simulator.explaining.fixing.recorded import RecordedRun, recorded_run
from utak.simulator.explaining.fixing.report import (
    changes_in_words,
    is_repeated,
    outcome_in_words,
    report_text,
    report_values,
)
from utak.simulator.explaining.fixing.search import FixReport, find_fixes
from utak.simulator.explaining.fixing.writing import write_scenario
from utak.simulator.explaining.missing_rules import rule_paths
from utak.simulator.explaining.questions import Questions, questions_of_episode
from utak.simulator.scenario.folder_writer import check_folder
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.outcome import UsageError
from utak.simulator.terminal.printing import as_json
from utak.simulator.terminal.streams import escape_controls, one_line


def execute(options: argparse.Namespace) -> int:
    """Answer the question and print the tree of reasons, or the changes."""
    if wrong := _usage_problem(options):
        raise UsageError(wrong)
    if options.fix:
        return _fix(options)
    questions = questions_of_episode(_episode(options), rule_paths(options.kb), given_certificate(options))
    if questions.lacking:
        print(f"utak: {questions.lacking}; give rules with --kb FILE", file=sys.stderr)
    reason = _answer(questions, options)
    if options.json:
        print(as_json(reason.as_dict()))
    else:
        print(escape_controls(reason.text(Depth(options.depth))))
    return exits.SUCCESS


def _episode(options: argparse.Namespace) -> Episode:
    """Return the episode that was named, or that of a run of the scenario, up to the step in question."""
    if not Path(options.story).is_dir():
        refuse_links(options, options.story)
        return read_begun_episode(options.story)
    story = given_story(options)
    go_to(story, options.story, options.at)
    return story.episode


def _answer(questions: Questions, options: argparse.Namespace) -> Reason:
    if options.cell is not None:
        return questions.why_cell(options.cell, options.at)
    if options.whynot is not None:
        return questions.why_not(options.whynot, options.at)
    if options.fact is not None:
        return questions.why(options.fact, options.at)
    return questions.why_step(options.at)


def _usage_problem(options: argparse.Namespace) -> str:
    """Return which options do not go together; "" when all do."""
    questions = {"FACT": options.fact, "--whynot": options.whynot, "--cell": options.cell}
    asked = [name for name, value in questions.items() if value is not None]
    if options.fix and (asked or options.at is not None):
        return "--fix is about the whole run: it takes no FACT, no --whynot, no --cell and no --at"
    if len(asked) > 1:
        return f"one question at a time: {asked[0]} or {asked[1]}"
    given = [name for name in ("runs", "seconds", "write", "number") if getattr(options, name) is not None]
    if given and not options.fix:
        return f"--{given[0]} needs --fix"
    return "--number needs --write FOLDER" if options.number is not None and options.write is None else ""


def _fix(options: argparse.Namespace) -> int:
    """Print the smallest changes with which the run works; return whether there are any."""
    rules = rule_paths(options.kb)
    run = recorded_run(options.story, _episode(options), rules)
    if options.write is not None:
        check_folder(Path(options.write))
    budget = Budget(DEFAULT_RUNS if options.runs is None else options.runs, options.seconds)
    report = find_fixes(run, budget, _progress_printer(run, budget))
    if options.json:
        print(as_json(report_values(report)))
    else:
        print(escape_controls(report_text(report, Depth(options.depth))))
    if not is_repeated(report) and report.before is not None:
        end = f"{report.before.verdict} in {report.before.steps} steps"
        print(f"utak: the run does not end as it is recorded: repeated without changes, {end}", file=sys.stderr)
    if report.ended:
        print(f"utak: {report.ended}: not everything was tried", file=sys.stderr)
    if options.write is not None and report.fixes:
        return _write_fix(report, options.write, options.number)
    return exits.SUCCESS if report.fixes else exits.NOT_REACHED


def _write_fix(report: FixReport, folder: str, number: int | None) -> int:
    """Write one of the changed scenarios; return the exit code."""
    stated = [
        not any(isinstance(change, Led | MoreCommands) for change in fix.changes) for fix in report.fixes
    ]  # whether files can state it
    index = next((k for k, can in enumerate(stated) if can), None) if number is None else number - 1
    if index is None or index >= len(stated) or not stated[index]:
        print(f"utak: nothing is written to {folder}: there is no such change that files can state", file=sys.stderr)
        return exits.NOT_REACHED
    variant = variant_of(report.run.scenario, report.run.settings, report.fixes[index].changes)
    assert variant is not None
    write_scenario(variant.scenario, folder)
    return exits.SUCCESS


def _progress_printer(run: RecordedRun, budget: Budget) -> Callable[[int, tuple[WorldChange, ...], Outcome], None]:
    """Return the function that prints one line after each run, on a terminal only."""

    def tell(number: int, changes: tuple[WorldChange, ...], outcome: Outcome) -> None:
        what = changes_in_words(changes, run.scenario.world) if changes else "unchanged"
        line = f"run {number} of at most {budget.runs}: {what}: {outcome_in_words(outcome)}"
        print(one_line(line), file=sys.stderr)

    return tell if sys.stderr.isatty() else lambda number, changes, outcome: None
