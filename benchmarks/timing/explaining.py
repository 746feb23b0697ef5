"""The time to explain the decisions of recorded episodes, warm.

    python -m benchmarks.timing.explaining EPISODE.jsonl ... [--absences N]

One line an encoding: its decisions; the processor's milliseconds until the first atom of an answer is explained (the
decision is grounded then), for any further atom, and, with `--absences`, for why another way to choose is not chosen.
"""

import argparse
import json
import statistics
import sys
import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path

from utak.kb.explanation.programs import decision_program, encoding_names
from utak.kb.explanation.proof import explain_decision
from utak.kb.explanation.whynot import explain_absence

ExplainedCall = tuple[str, tuple[str, ...], tuple[str, ...]]  # the encoding, its facts, the shown atoms of its answer


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.timing.explaining", description="Time to explain recorded decisions."
    )
    parser.add_argument("episodes", nargs="+", help="episodes, as of utak run --log")
    parser.add_argument("--absences", type=int, default=0, help="decisions of each encoding to ask for what is absent")
    given = parser.parse_args(arguments)
    for name in encoding_names():
        decision_program(name)  # each encoding is read once
    times: dict[tuple[str, str], list[float]] = defaultdict(list)
    for name, facts, answer in dict.fromkeys(one for path in given.episodes for one in decisions(Path(path))):
        rivals: list[str] = []
        for number, atom in enumerate(answer):
            begin = time.process_time()
            proof = explain_decision(name, facts, answer, atom)
            times[name, "further" if number else "first"].append(1000 * (time.process_time() - begin))
            rivals += [rival.atom for rival in proof.root.rivals if rival.atom]
        if rivals and len(times[name, "absent"]) < given.absences:
            begin = time.process_time()
            explain_absence(name, facts, answer, rivals[0])
            times[name, "absent"].append(1000 * (time.process_time() - begin))
    print(f"{'encoding':<15} {'decisions':>9} {'first: median, worst':>22} {'further':>16} {'absent':>16}")
    for name in sorted({name for name, _ in times}):
        first, further, absent = (in_words(times[name, kind]) for kind in ("first", "further", "absent"))
        print(f"{name:<15} {len(times[name, 'first']):>9} {first:>22} {further:>16} {absent:>16}")
    return 0


def decisions(path: Path) -> Iterator[ExplainedCall]:
    """Yield the decisions of an episode that have an answer with atoms, in order."""
    for line in map(json.loads, path.read_text().splitlines()):
        for entry in line.get("belief", {}).get("solved", ()):
            if len(entry) > 2 and entry[2]:
                yield entry[0], tuple(entry[1]), tuple(entry[2])


def in_words(times: Sequence[float]) -> str:
    """Return the median and the greatest of some times, or a dash when there are none."""
    return f"{statistics.median(times):.1f}, {max(times):.1f}" if times else "-"


if __name__ == "__main__":
    sys.exit(main())
