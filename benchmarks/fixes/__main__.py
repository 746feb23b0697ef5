"""WorldChanges that would have made failing scenarios work: what `utak explain --fix` finds, and whether it holds.

    python -m benchmarks.fixes FOLDER... [--runs N] [--seconds S] [--jsonl FILE]

Every scenario in the folders is run. Of those that do not end in `done` and achieved, the smallest changes are sought.
Each that files can state is confirmed: the changed scenario is written, read again and run, and must end in `done` and,
where its expect.lp asks for something, achieved. Printed is one line a scenario, and the sums.
"""

import argparse
import json
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.episode.episode import EpisodeLog, read_episode
from utak.simulator.explaining.fixing.changes import Led, MoreCommands, variant_of
from utak.simulator.explaining.fixing.proving import DEFAULT_RUNS, Budget
from utak.simulator.explaining.fixing.recorded import RecordedRun, recorded_run
from utak.simulator.explaining.fixing.report import change_values, changes_in_words, is_repeated
from utak.simulator.explaining.fixing.search import Fix, FixReport, find_fixes
from utak.simulator.explaining.fixing.writing import write_scenario
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Result, Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings


def scenarios_below(folders: Sequence[Path]) -> list[Path]:
    """Return the scenario folders among some folders and below them, in the order of their names."""
    return sorted({path.parent for folder in folders for path in folder.rglob("goal.lp")})


def run_logged(folder: Path, log: Path) -> Result:
    """Run a scenario with an episode and return the result."""
    with EpisodeLog(log) as written:
        return Session(read_scenario(folder), Settings(), make_robot, written).run()


def confirmed(fix: Fix, run: RecordedRun) -> bool | None:
    """Return whether a change holds when its scenario is written, read and run; None when files cannot state it."""
    if any(isinstance(change, Led | MoreCommands) for change in fix.changes):
        return None
    variant = variant_of(run.scenario, run.settings, fix.changes)
    if variant is None:
        return False
    with tempfile.TemporaryDirectory() as folder:
        write_scenario(variant.scenario, Path(folder) / "fixed")
        scenario = read_scenario(Path(folder) / "fixed")
    result = Session(scenario, run.settings, make_robot, EpisodeLog(None)).run()
    return result.verdict == "done" and result.achieved is not False and result.line == fix.outcome.result.line


def row_of(folder: Path, report: FixReport, before: Result, seconds: float) -> dict[str, Any]:
    """Return what was found in a scenario, ready for JSON."""
    world = report.run.scenario.world
    return {
        "scenario": folder.name,
        "before": f"{before.verdict} in {before.steps}",
        "repeated": is_repeated(report),
        "fixes": [
            {
                "words": changes_in_words(fix.changes, world),
                "kinds": sorted(change_values(change, world)["change"] for change in fix.changes),
                "steps": fix.outcome.result.steps,
                "achieved": fix.outcome.result.achieved,
                "smallest": fix.is_smallest,
                "least": fix.is_least,
                "confirmed": confirmed(fix, report.run),
            }
            for fix in report.fixes
            if fix.outcome.result is not None
        ],
        "runs": report.runs,
        "commands": report.commands,
        "seconds": round(seconds, 1),
        "ended": report.ended,
    }


def printed(row: dict[str, Any]) -> str:
    """Return the lines of the table for a scenario."""
    told = f" ({row['ended']})" if row["ended"] else ""
    head = (
        f"{row['scenario']}: {row['before']}; {row['runs']} runs, {row['commands']} commands, {row['seconds']} s{told}"
    )
    marks = {True: "confirmed", False: "NOT CONFIRMED", None: "not stated by files"}
    lines = [f"    {fix['words']}: done in {fix['steps']} [{marks[fix['confirmed']]}]" for fix in row["fixes"]]
    return "\n".join([head, *(lines or ["    none found"])])


def main(arguments: Sequence[str] | None = None) -> int:
    """Execute the command line; return 1 when a change is not confirmed or a run does not repeat itself."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fixes", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("folders", nargs="+", type=Path, help="scenarios, or folders of scenarios")
    parser.add_argument("--runs", type=int, default=DEFAULT_RUNS, help="runs for each scenario (default %(default)s)")
    parser.add_argument("--seconds", type=float, help="seconds for each scenario at most")
    parser.add_argument("--jsonl", type=Path, help="write the rows to this file, too")
    given = parser.parse_args(arguments)
    rows: list[dict[str, Any]] = []
    worked = 0
    for folder in scenarios_below(given.folders):
        with tempfile.TemporaryDirectory() as place:
            log = Path(place) / "ep.jsonl"
            try:
                before = run_logged(folder, log)
            except (BadInputError, CannotOpenError) as error:
                print(f"{folder.name}: not a scenario that can be run: {str(error).splitlines()[0]}")
                continue
            if before.believed and before.achieved is not False:
                worked += 1
                continue
            begun = time.monotonic()
            report = find_fixes(recorded_run(str(log), read_episode(log)), Budget(given.runs, given.seconds))
            rows.append(row_of(folder, report, before, time.monotonic() - begun))
        print(printed(rows[-1]), flush=True)
        if given.jsonl is not None:
            given.jsonl.write_text("".join(json.dumps(row) + "\n" for row in rows))
    fixes = [fix for row in rows for fix in row["fixes"]]
    fixed = sum(bool(row["fixes"]) for row in rows)
    print(f"{worked} scenarios work; of {len(rows)} others {fixed} are mended by {len(fixes)} changes")
    print(f"kinds: {dict(Counter('+'.join(fix['kinds']) for fix in fixes))}")
    print(f"confirmed: {dict(Counter(str(fix['confirmed']) for fix in fixes))}")
    print(f"runs: {sum(row['runs'] for row in rows)}, commands: {sum(row['commands'] for row in rows)}")
    wrong = any(fix["confirmed"] is False for fix in fixes) or not all(row["repeated"] for row in rows)
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
