"""Rules that took part in a run and are not given where it is explained: an explanation says that it lacks them."""

from collections.abc import Iterable, Sequence

from utak.simulator.episode.episode import EpisodeLine
from utak.simulator.episode.record import rule_sums

SHOWN_SUM_DIGITS = 8  # hexadecimal digits by which a message names a file of rules; a convention


def missing_rules(header: EpisodeLine, rule_files: Sequence[str]) -> str:
    """Return in a line that rules of a run are not given; "" when all are."""
    sums = dict.fromkeys(_sums(header))
    if not sums:
        return ""
    given = set(rule_sums(tuple(rule_files)))
    missing = [one for one in sums if one not in given]
    if not missing:
        return ""
    count = f"{len(sums)} file{'s' * (len(sums) != 1)} of rules"
    what = f"{count} took part in this run, and {_number(len(missing), len(sums))} not given here"
    named = ", ".join(one[:SHOWN_SUM_DIGITS] for one in missing)
    return f"{what} (SHA-256 {named}): what {'it' if len(missing) == 1 else 'they'} brought about is not explained"


def _sums(header: EpisodeLine) -> Iterable[str]:
    """Yield the sums of the rules of all stages of a run, in order."""
    for stage in (*header.get("forked", ()), header):
        yield from stage.get("options", {}).get("kb", ())


def _number(missing: int, count: int) -> str:
    """Return how many of some files are missing, with the verb."""
    if missing == count:
        return "it is" if count == 1 else "they are"
    return f"{missing} of them {'is' if missing == 1 else 'are'}"
