"""The decisions in an episode's lines, as far as a page keeps them, and written so that little changes.

`belief.solved` names every decision since the step before: `[encoding, facts, answer, about]`, or `[encoding, [step,
index]]` for one that was taken before. A decision among hundreds of candidates is cut: see `trimmed`.
"""

import re
from typing import Any

MAX_CANDIDATES = 6  # candidates of one decision that a page keeps, besides those chosen; a convention, docs/replay.md
MAX_OTHER_FACTS = 60  # facts of one decision, besides those of candidates, that a page keeps; a convention
NUMBER = re.compile(r"\d{1,9}", re.ASCII)


def trimmed(entry: Any) -> Any:
    """Return a decision as a page keeps it: with the facts of its first candidates and of those chosen.

    A candidate is a number that stands as the first argument of facts; it is chosen when the answer names it. At most
    MAX_CANDIDATES that were not chosen are kept, those with the least numbers, and of the other facts the first
    MAX_OTHER_FACTS. Where facts are left out, a fifth item says how many; what is said about candidates is then kept
    for those alone that are kept, with 0 for those between them. Values of other forms are returned as they are.
    """
    if not isinstance(entry, list) or len(entry) != 4:
        return entry
    encoding, facts, answer, about = entry
    if not all(isinstance(part, list) for part in (facts, answer, about)):
        return entry
    chosen = {number for atom in answer for number in NUMBER.findall(str(atom))}
    candidates = sorted({_candidate(fact) for fact in facts} - chosen - {""}, key=int)
    named = chosen | set(candidates[:MAX_CANDIDATES])
    kept, others = [], 0
    for fact in facts:
        others += not _candidate(fact)
        if _candidate(fact) in named or (not _candidate(fact) and others <= MAX_OTHER_FACTS):
            kept.append(fact)
    if len(kept) == len(facts):
        return entry
    told = [text if str(number) in named else 0 for number, text in enumerate(about)]
    while told and told[-1] == 0:
        told.pop()
    return [encoding, kept, answer, told, len(facts) - len(kept)]


def _candidate(fact: Any) -> str:
    """Return the number that is the first argument of a fact; "" when there is none."""
    first = str(fact).partition("(")[2].partition(",")[0].removesuffix(")")
    return first if NUMBER.fullmatch(first) else ""


def by_encoding(solved: Any, before: Any) -> Any:
    """Return the decisions of a step, with each kept by its encoding until the encoding is asked again.

    Parameters
    ----------
    solved : `belief.solved` of the step, trimmed.
    before : what this function returned for the step before; None at first.

    Returns
    -------
    `{"order": [...], "last": {...}}`. `order` has, for each decision, its key in `last`, or the decision itself where
    it refers to an earlier one. What encodings were given that were not asked at this step stays in `last`, so that the
    next time only differences need be told. Values of other forms are returned as they are.
    """
    if not isinstance(solved, list):
        return solved
    last = dict(before["last"]) if isinstance(before, dict) and "last" in before else {}
    order: list[Any] = []
    for entry in solved:
        if isinstance(entry, list) and len(entry) > 2 and isinstance(entry[0], str):
            key = f"{entry[0]} {len(order)}" if entry[0] in order else entry[0]
            last[key] = entry
            order.append(key)
        else:
            order.append([entry])
    return {"order": order, "last": last}
