"""Count accepted certificates whose claim is false on the true table.

python -m benchmarks.certificates --count 100 --seed 0 --mutants 20

Each random walk that a certificate is found for is held against the truth, and so are mutants of the certificate that
are accepted and claim something else; whether the rules allow what really happened is asked of all. The exit code is 1
when an accepted claim is false, or when what happened is excluded.
"""

import argparse
import json
import sys
import time
from collections import Counter
from typing import Any

from benchmarks.certificates.drawn import drawn_walk
from benchmarks.certificates.mutants import mutants
from benchmarks.certificates.recorded import RecordedWalk
from benchmarks.certificates.truth import holds, is_given, lost_truth
from utak.simulator.certificates.checker import verify
from utak.simulator.certificates.courses import RefusedError
from utak.simulator.certificates.search import NoCertificateError, certificate_of


def main() -> int:
    """Print a line for each walk that has a certificate, and the counts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--truth-alone", action="store_true", help="only whether the rules allow what happened")
    parser.add_argument("--mutants", type=int, default=0, help="of each certificate")
    options = parser.parse_args()
    counts: Counter[str] = Counter()
    for seed in range(options.seed, options.seed + options.count):
        walk, begun = drawn_walk(seed), time.perf_counter()
        goal = walk.goals[0]
        if lost := lost_truth(walk):
            counts["FALSE: what happened is excluded"] += 1
            print(seed, "what happened is excluded:", lost, flush=True)
        if options.truth_alone:
            counts["followed"] += 1
            continue
        try:
            text = certificate_of(walk.text.splitlines(keepends=True), "done")
        except NoCertificateError:
            counts[f"{goal[:12]} none"] += 1
            continue
        verify(walk.text, text)
        stated = json.loads(text)
        outcome = _outcome(walk, stated)
        counts[f"{goal[:12]} {outcome}"] += 1
        seconds = time.perf_counter() - begun
        print(
            seed, goal, walk.world.heading, outcome, stated["given"], f"{len(text)} bytes, {seconds:.1f} s", flush=True
        )
        for mutant in mutants(stated, options.mutants, seed):
            counts[f"mutant {_of_mutant(walk, stated, mutant)}"] += 1
    print(dict(sorted(counts.items())))
    return int(any("FALSE" in outcome for outcome in counts))


def _outcome(walk: RecordedWalk, stated: dict[str, Any]) -> str:
    """Return whether the claim of a certificate is true, in a word."""
    if not is_given(walk, stated["given"]):
        return "given is false"
    return "true" if holds(walk, walk.goals[0], stated["steps"][0], stated["meaning"]) else "FALSE"


def _of_mutant(walk: RecordedWalk, stated: dict[str, Any], mutant: dict[str, Any]) -> str:
    """Return what becomes of a mutant of a certificate, in words."""
    try:
        verify(walk.text, json.dumps(mutant))
    except RefusedError:
        return "refused"
    is_same = all(mutant[key] == stated[key] for key in ("goals", "steps", "meaning", "given"))
    return "accepted, the same claim" if is_same else f"accepted, another claim: {_outcome(walk, mutant)}"


if __name__ == "__main__":
    sys.exit(main())
