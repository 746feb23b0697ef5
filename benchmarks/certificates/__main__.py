"""Count accepted certificates whose claim is false on the true table.

python -m benchmarks.certificates --count 100 --seed 0 --mutants 20
python -m benchmarks.certificates --rooms --count 100 --seed 0 --mutants 20
python -m benchmarks.certificates --doors --count 100 --seed 0 --mutants 20
python -m benchmarks.certificates --pushes --count 100 --seed 0 --mutants 20
python -m benchmarks.certificates --noise 0.05 --risk 1 --count 100 --seed 0 --mutants 20
python -m benchmarks.certificates --impossible --count 4 --seed 0 -o FILE

Random walks claim that a goal is done; with --rooms, walks along all walls of a room claim that nothing gets out;
with --doors, walks and pushes through doors, and through what looks like one, claim to have led into the next room;
with --pushes, things that are pushed claim to be in a corner.
Each that a certificate is found for is held against the truth, and so are mutants of the certificate that are
accepted. Where none is found one is forged, for a checker that takes any goal to hold, and is held, with mutants of
it, against the checker as it is. Whether the rules allow what really happened is asked of all. With --noise the share
of walks is counted, too, in which noise led further than the risk allows for; what is false there is not held against
the checker. The exit code is 1 when an accepted claim is false, or when what happened is excluded. With --impossible
the robot runs in worlds in which its task cannot be done, so many of each kind, and those are counted in which a
certificate shows that; worlds that the FILE has are not run again.
"""

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.certificates.doors import drawn_doors
from benchmarks.certificates.drawn import drawn_push, drawn_walk
from benchmarks.certificates.gaps import drawn_room, gets_out, meets_corners
from benchmarks.certificates.mutants import mutants
from benchmarks.certificates.recorded import RecordedWalk
from benchmarks.certificates.truth import holds, is_given, lost_truth
from benchmarks.certificates.unable import run_unable
from utak.simulator.certificates import search
from utak.simulator.certificates.checker import OWN_NAME, CertificateCheck, goal_of, verify
from utak.simulator.certificates.courses import MILLION, RefusedError
from utak.simulator.certificates.doors import door_shown
from utak.simulator.certificates.search import NoCertificateError, certificate_of
from utak.simulator.scenario.settings import USUAL_RISK

FALSE = "FALSE"  # of a claim that was accepted
BARE_DOOR = [[3, -1, 3, 0], [-1, -2, 2, 2], [4, -2, 7, 2]]  # of a forged certificate, before it is changed at random


def main() -> int:
    """Print a line for each walk that has a certificate, and the counts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--rooms", action="store_true", help="rooms that nothing gets out of, in place of goals done")
    parser.add_argument("--doors", action="store_true", help="goals of the next room, in place of others")
    parser.add_argument("--pushes", action="store_true", help="goals of things in corners, in place of others")
    parser.add_argument("--truth-alone", action="store_true", help="only whether the rules allow what happened")
    parser.add_argument("--noise", type=float, default=0.0, help="of the motions")
    parser.add_argument("--risk", type=float, default=USUAL_RISK, help="of the certificates, percent")
    parser.add_argument("--mutants", type=int, default=0, help="of each certificate")
    parser.add_argument("--impossible", action="store_true", help="runs in which the task cannot be done")
    parser.add_argument("-o", "--output", type=Path, help="of --impossible: a JSON line for each world")
    options = parser.parse_args()
    if options.impossible:
        return run_unable(options.count, options.seed, options.output)
    counts: Counter[str] = Counter()
    times: dict[str, list[float]] = {"found in": [], "checked in": [], "kilobytes": []}
    for seed in range(options.seed, options.seed + options.count):
        kinds = {drawn_room: options.rooms, drawn_doors: options.doors, drawn_push: options.pushes, drawn_walk: True}
        walk = next(draw for draw, is_asked in kinds.items() if is_asked)(seed, options.noise)
        risk = int(options.risk * MILLION / 100)
        counts["noise is beyond the risk"] += walk.is_beyond(risk)
        if lost := lost_truth(walk, risk):
            counts[_by_noise(walk, risk, "what happened is excluded")] += 1
            print(seed, "what happened is excluded:", lost, flush=True)
        else:
            counts["what happened is allowed"] += 1
        if not options.truth_alone:
            _count(walk, "impossible" if options.rooms else "done", seed, options, counts, times)
    print(dict(sorted(counts.items())))
    for what, values in times.items():
        if values:
            print(what, "median, 95 in 100:", *np.round(np.quantile(values, (0.5, 0.95)), 2))
    return int(any(FALSE in outcome for outcome in counts))


def _count(
    walk: RecordedWalk,
    claim: str,
    seed: int,
    options: argparse.Namespace,
    counts: Counter[str],
    times: dict[str, list[float]],
) -> None:
    """Count what becomes of the certificate of a walk, of mutants of it, and of forged ones."""
    lines, goal, begun = walk.text.splitlines(keepends=True), " ".join(walk.goals), time.perf_counter()
    try:
        text = certificate_of(lines, claim, options.risk)
    except NoCertificateError:
        counts[f"{goal}: none"] += 1
        _count_forged(walk, claim, seed, options, counts)
        return
    found = time.perf_counter()
    verify(walk.text, text)
    times["found in"].append(found - begun)
    times["checked in"].append(time.perf_counter() - found)
    times["kilobytes"].append(len(text) / 1000)
    stated = json.loads(text)
    outcome = _outcome(walk, stated)
    counts[f"{goal}: {outcome}"] += 1
    print(seed, goal, walk.world.heading, outcome, stated["given"], f"{found - begun:.1f} s", flush=True)
    for mutant in mutants(stated, options.mutants, seed):
        counts[f"mutant: {_of_mutant(walk, mutant, stated)}"] += 1


def _count_forged(walk: RecordedWalk, claim: str, seed: int, options: argparse.Namespace, counts: Counter[str]) -> None:
    """Count what becomes of a certificate that was made for a checker that takes every goal to hold, and of mutants."""
    forging = dict.fromkeys(("is_shown", "is_barred", "holds"), lambda *_: True)
    try:
        with patch.multiple(CertificateCheck, **forging), patch.object(search, "door_shown", _forged_door):
            stated = json.loads(certificate_of(walk.text.splitlines(keepends=True), claim, options.risk))
    except NoCertificateError:
        return
    for mutant in (stated, *mutants(stated, options.mutants, seed)):
        outcome = _of_mutant(walk, mutant, None)
        counts[f"forged: {outcome}"] += 1
        if FALSE in outcome:
            print(seed, "forged, and accepted:", walk.goals, mutant["meaning"], mutant["given"], flush=True)


def _forged_door(*about: Any, step: int | None = None) -> list[list[int]]:
    """Return the first door that was seen, whatever lies behind it, or one that is none."""
    return door_shown(*about, step=step) or BARE_DOOR


def _outcome(walk: RecordedWalk, stated: dict[str, Any]) -> str:
    """Return whether the claim of a certificate is true, in words."""
    if not is_given(walk, stated["given"], stated["cases"]):
        return "given is false"
    goal = walk.goals[0]
    if stated["claim"] == "done":
        is_true = holds(walk, goal, stated["steps"][0], stated["meaning"])
        return "true" if is_true else _by_noise(walk, stated["risk"], "claim")
    steps = zip(walk.goals, stated["steps"], strict=True)
    told = [goal_of(goal, "impossible") for goal, step in steps if step is not None]
    what = told[0][1]
    name = what if what == OWN_NAME else walk.felt(*stated["meaning"][what]) or ""
    answer = gets_out(walk, name) if told[0][0] == "room" else meets_corners(walk, name, [one[2] for one in told])
    return {"yes": _by_noise(walk, stated["risk"], "claim"), "no": "true", "open": "not known to be false"}[answer]


def _by_noise(walk: RecordedWalk, risk: int, what: str) -> str:
    """Return that something is false, or that it is so by noise for which the risk is taken."""
    return f"by noise beyond the risk: {what}" if walk.is_beyond(risk) else f"{FALSE}: {what}"


def _of_mutant(walk: RecordedWalk, mutant: dict[str, Any], origin: dict[str, Any] | None) -> str:
    """Return what becomes of a changed certificate, in words."""
    try:
        verify(walk.text, json.dumps(mutant))
    except (RefusedError, ValueError):
        return "refused"
    claim = ("goals", "steps", "meaning", "given")
    if origin is not None and all(mutant[key] == origin[key] for key in claim):
        return "accepted, the same claim"
    return f"accepted, another claim: {_outcome(walk, mutant)}"


if __name__ == "__main__":
    sys.exit(main())
