"""The table of a campaign: one row for each task, and the worlds that went wrong."""

import math
from collections import Counter
from collections.abc import Sequence
from statistics import median

from benchmarks.harness.trial import CampaignTrial

ROMAN = {1: "i", 2: "ii", 3: "iii", 4: "iv", 5: "v", 6: "vi", 7: "vii", 8: "viii", 9: "ix"}


def table(trials: Sequence[CampaignTrial]) -> str:
    """Return the results of the trials, one row for each task and one for all, as aligned text."""
    tasks = sorted({trial.task for trial in trials})
    groups = [(f"({ROMAN[task]})", [trial for trial in trials if trial.task == task]) for task in tasks]
    rows = [_row(name, group) for name, group in [*groups, ("all", list(trials))]]
    head = list(rows[0])
    lines = [head, *([row[name] for name in head] for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    return "\n".join("  ".join(cell.rjust(w) for cell, w in zip(line, widths, strict=True)) for line in lines) + "\n"


def _row(name: str, trials: Sequence[CampaignTrial]) -> dict[str, str]:
    possible = [trial for trial in trials if trial.possible]
    unable = [trial for trial in trials if not trial.possible]
    ratios = [t.walked / t.shortest for t in possible if t.achieved and t.shortest > 1]
    steps = [trial.steps for trial in trials if not trial.crash]
    needed = [trial.steps / trial.needed for trial in possible if trial.achieved and trial.needed]
    return {
        "task": name,
        "achieved": _part(sum(t.achieved for t in possible), len(possible)),
        "refused": _part(sum(t.right for t in unable), len(unable)),
        "false done": str(sum(t.false_done for t in trials)),
        "judge": _judged(trials),
        "crashed": str(sum(bool(t.crash) for t in trials)),
        "commands": f"{median(steps):g} / {max(steps)}" if steps else "-",
        "of knowing": f"{median(needed):.2f} / {max(needed):.2f}" if needed else "-",
        "way ratio": f"{median(ratios):.2f} / {max(ratios):.2f}" if ratios else "-",
        "cycle ms": _milliseconds([cycle.wall for trial in trials for cycle in trial.cycles[1:]]),
        "cpu ms": _milliseconds([cycle.processor for trial in trials for cycle in trial.cycles[1:]]),
        "shapes": _part(_summed(trials, "known"), _summed(trials, "met")),
        "seen whole": _part(_summed(trials, "whole_known"), _summed(trials, "whole")),
        "wrong squares": f"{_summed(trials, 'wrong')} of {_summed(trials, 'certain')}",
    }


def _milliseconds(seconds: Sequence[float]) -> str:
    """Return the median and the 95th percentile of some seconds, in milliseconds, as text."""
    if not seconds:
        return "-"
    ordered = sorted(1000 * value for value in seconds)
    return f"{median(ordered):.0f} / {ordered[math.ceil(0.95 * len(ordered)) - 1]:.0f}"


def _part(some: int, whole: int) -> str:
    return f"{some}/{whole}" if whole else "-"


def _judged(trials: Sequence[CampaignTrial]) -> str:
    """Return the number of episodes in which the judge found something; "none!" when there was no judge."""
    judged = [trial.judged for trial in trials if not trial.crash]
    return "none!" if any(said is None for said in judged) else str(sum(bool(said) for said in judged))


def _summed(trials: Sequence[CampaignTrial], name: str) -> int:
    return sum(getattr(trial.score, name) for trial in trials if trial.score is not None)


def verdicts(trials: Sequence[CampaignTrial]) -> str:
    """Return how many times each verdict was given, for possible and for impossible tasks."""
    lines = []
    for possible in (True, False):
        counted = Counter(trial.verdict for trial in trials if trial.possible is possible)
        if counted:
            said = ", ".join(f"{name} {count}" for name, count in sorted(counted.items()))
            lines.append(f"verdicts in {'possible' if possible else 'impossible'} worlds: {said}")
    return "\n".join(lines) + "\n"


def narrowness(trials: Sequence[CampaignTrial]) -> str:
    """Return how well passages that are too narrow were named; "" when there were none."""
    told = [trial.narrow for trial in trials if trial.narrow is not None]
    if not told:
        return ""
    right = [narrow.right for narrow in told]
    off, away = (
        max((abs(v) for v in values if not math.isnan(v)), default=math.nan) for values in zip(*told, strict=True)
    )
    return (
        f"too narrow passages: {_part(sum(right), len(told))} told right; width off by {off:.2f}, place by {away:.2f}\n"
    )


def faults(trials: Sequence[CampaignTrial]) -> str:
    """Return a line for each kind of fault, with the worlds that have it."""
    said: dict[str, list[str]] = {}
    for trial in trials:
        found = _faults(trial)
        if found:
            said.setdefault("; ".join(found), []).append(f"{trial.task}:{trial.seed}")
    lines = [f"{' '.join(worlds)}  {what}" for what, worlds in said.items()]
    return "\n".join(lines) + ("\n" if lines else "")


def _faults(trial: CampaignTrial) -> list[str]:
    found = [f"crash: {trial.crash}"] if trial.crash else []
    if trial.false_done:
        found.append("FALSE DONE")
    if not trial.right and not trial.crash:
        what = "not achieved" if trial.possible else "should have been refused"
        found.append(f"{what}: {trial.verdict}: {trial.reason}")
    if trial.narrow is not None and not trial.narrow.right:
        found.append(f"the passage is told wrongly: {trial.reason}")
    if trial.judged:
        found.append(f"judge: {trial.judged[0]}" + (f" (+{len(trial.judged) - 1})" if len(trial.judged) > 1 else ""))
    if trial.score is not None:
        found += trial.score.mistaken
        found += [f"{trial.score.wrong} certain squares wrong"] if trial.score.wrong else []
        found += [f"the map slipped by {trial.score.drift}"] if trial.score.drift else []
    return found
