"""Rules that took part in a run and are not given where it is explained: an explanation says that it lacks them."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from utak.simulator.episode.episode import EpisodeLine
from utak.simulator.episode.record import rule_sums

SHOWN_SUM_DIGITS = 8  # hexadecimal digits by which a message names a file of rules; a convention


def rule_paths(files: Iterable[Path | str]) -> list[str]:
    """Return the absolute paths of files with users' rules, as text."""
    return [str(Path(file).absolute()) for file in files]


def missing_rules(header: EpisodeLine, rule_files: Sequence[str]) -> str:
    """Return in a line that rules of a run are not given; "" when all are."""
    stages = (*header.get("forked", ()), header)
    sums = dict.fromkeys(one for stage in stages for one in stage.get("options", {}).get("kb", ()))
    given = set(rule_sums(tuple(rule_files))) if sums else set()
    missing = [one for one in sums if one not in given]
    if not missing:
        return ""
    count = f"{len(sums)} file{'s' * (len(sums) != 1)} of rules"
    what = f"{count} took part in this run, and {_number(len(missing), len(sums))} not given here"
    named = ", ".join(one[:SHOWN_SUM_DIGITS] for one in missing)
    return f"{what} (SHA-256 {named}): what {'it' if len(missing) == 1 else 'they'} brought about is not explained"


def _number(missing: int, count: int) -> str:
    """Return how many of some files are missing, with the verb."""
    if missing == count:
        return "it is" if count == 1 else "they are"
    return f"{missing} of them {'is' if missing == 1 else 'are'}"
