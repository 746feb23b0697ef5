"""`utak explain`: why a fact is believed, why a command was given, what a cell is laid to, what would have worked."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from utak.simulator.cli.commands.query import go_to, step_number
from utak.simulator.cli.commands.run import add_settings, settings_of
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.numbers import parse_decimal, parse_whole
from utak.simulator.terminal.printing import as_json
from utak.simulator.terminal.streams import escape_controls

if TYPE_CHECKING:
    from collections.abc import Callable

    from utak.kb.evidence.reason import Reason
    from utak.simulator.episode.episode import Episode
    from utak.simulator.explaining.fixing.changes import WorldChange
    from utak.simulator.explaining.fixing.proving import Budget, Outcome
    from utak.simulator.explaining.fixing.recorded import RecordedRun
    from utak.simulator.explaining.fixing.search import FixReport
    from utak.simulator.explaining.questions import Questions


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("explain", help="tell why: a fact, a command, a verdict, a cell of an impression")
    part.add_argument("story", metavar="SCENARIO|EP.jsonl", help="a scenario folder, which is run, or an episode")
    part.add_argument(
        "fact", metavar="FACT", nargs="?", help="a fact, a goal or verdict(V); without it the command of the step"
    )
    part.add_argument("--whynot", metavar="FACT", help="why a fact is not believed: what is missing or in the way")
    part.add_argument("--cell", type=_cell, metavar="N", help="a cell of the impression of the step, 0 to 159")
    part.add_argument("--at", type=step_number, metavar="STEP", help="the step (default: the last)")
    part.add_argument(
        "--depth",
        choices=("short", "mid", "long"),  # kb.evidence.reason.Depth, which every command would load here
        default="mid",
        help="how much of the tree is printed (default mid)",
    )
    part.add_argument("--json", action="store_true", help="print the whole tree as one JSON object")
    add_settings(part)
    fixing = part.add_argument_group("fixing", "what would have made a run work that failed")
    fixing.add_argument(
        "--fix", action="store_true", help="the smallest changes with which the run works, each proved by running again"
    )
    fixing.add_argument("--runs", type=_runs, metavar="N", help="with --fix: at most so many runs (default 40)")
    fixing.add_argument("--seconds", type=_seconds, metavar="S", help="with --fix: end after so many seconds")
    fixing.add_argument("--write", metavar="FOLDER", help="with --fix: write the changed scenario as a folder")
    fixing.add_argument(
        "--number", type=_place, metavar="K", help="with --write: the K-th change (default: the first that files state)"
    )
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Answer the question and print the tree of reasons, or the changes."""
    wrong = _usage_problem(options)
    if wrong:
        print(f"utak explain: {wrong}", file=sys.stderr)
        return exits.USAGE
    if options.fix:
        return _fix(options)
    from utak.simulator.explaining.questions import questions_of_episode, rule_paths

    questions = questions_of_episode(_episode(options), rule_paths(options.kb))
    if questions.lacking:
        print(f"utak: {questions.lacking}; give rules with --kb FILE", file=sys.stderr)
    reason = _answer(questions, options)
    if options.json:
        print(as_json(reason.as_dict()))
    else:
        print(escape_controls(_text(reason, options.depth)))
    return exits.SUCCESS


def _episode(options: argparse.Namespace) -> "Episode":
    """Return the episode that was named, or that of a run of the scenario, up to the step in question."""
    from utak.simulator.episode.episode import Episode, read_begun_episode

    refuse_links(options, options.story)
    if not Path(options.story).is_dir():
        return read_begun_episode(options.story)
    from utak.simulator.run.story import open_story

    story = open_story(options.story, settings_of(options))
    go_to(story, options.story, options.at)
    return Episode(story.header, tuple(story.lines), story.result)


def _answer(questions: "Questions", options: argparse.Namespace) -> "Reason":
    """Return the answer to the question of the command line."""
    if options.cell is not None:
        return questions.why_cell(options.cell, options.at)
    if options.whynot is not None:
        return questions.why_not(options.whynot, options.at)
    if options.fact is not None:
        return questions.why(options.fact, options.at)
    return questions.why_step(options.at)


def _text(reason: "Reason", depth: str) -> str:
    """Return a tree of reasons as text."""
    from utak.kb.evidence.reason import Depth

    return reason.text(Depth(depth))


def _usage_problem(options: argparse.Namespace) -> str:
    """Return which options do not go together; "" when all do."""
    questions = {"FACT": options.fact, "--whynot": options.whynot, "--cell": options.cell}
    asked = [name for name, value in questions.items() if value is not None]
    if options.fix and (asked or options.at is not None):
        return "--fix is about the whole run: it takes no FACT, no --whynot, no --cell and no --at"
    if len(asked) > 1:
        return f"one question at a time: {asked[0]} or {asked[1]}"
    needing = {
        "--runs": options.runs,
        "--seconds": options.seconds,
        "--write": options.write,
        "--number": options.number,
    }
    given = [name for name, value in needing.items() if value is not None]
    if given and not options.fix:
        return f"{given[0]} needs --fix"
    return "--number needs --write FOLDER" if options.number is not None and options.write is None else ""


def _fix(options: argparse.Namespace) -> int:
    """Print the smallest changes with which the run works; return whether there are any."""
    from utak.kb.evidence.reason import Depth
    from utak.simulator.explaining.fixing.proving import DEFAULT_RUNS, Budget
    from utak.simulator.explaining.fixing.recorded import recorded_run
    from utak.simulator.explaining.fixing.report import is_repeated, report_text, report_values
    from utak.simulator.explaining.fixing.search import find_fixes
    from utak.simulator.explaining.questions import rule_paths
    from utak.simulator.scenario.folder_writer import check_folder

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


def _write_fix(report: "FixReport", folder: str, number: int | None) -> int:
    """Write one of the changed scenarios; return the exit code."""
    from utak.simulator.explaining.fixing.changes import Led, MoreCommands, variant_of
    from utak.simulator.explaining.fixing.writing import write_scenario

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


def _progress_printer(
    run: "RecordedRun", budget: "Budget"
) -> "Callable[[int, tuple[WorldChange, ...], Outcome], None]":
    """Return the function that prints one line after each run, on a terminal only."""
    from utak.simulator.explaining.fixing.report import changes_in_words, outcome_in_words

    def tell(number: int, changes: "tuple[WorldChange, ...]", outcome: "Outcome") -> None:
        what = changes_in_words(changes, run.scenario.world) if changes else "unchanged"
        line = f"run {number} of at most {budget.runs}: {what}: {outcome_in_words(outcome)}"
        print(escape_controls(line, lines=False), file=sys.stderr)

    return tell if sys.stderr.isatty() else lambda number, changes, outcome: None


def _runs(text: str) -> int:
    """Return the number for `--runs`."""
    return parse_whole(text, 1, 100_000)


def _seconds(text: str) -> float:
    """Return the number for `--seconds`."""
    return parse_decimal(text, 0, 1e9)


def _place(text: str) -> int:
    """Return the number for `--number`."""
    return parse_whole(text, 1, 100_000)


def _cell(text: str) -> int:
    """Return the number for `--cell`."""
    return parse_whole(text, 0, 159)
