"""The decisions in an episode's lines, as far as a page keeps them, and written so that little changes.

`belief.solved` names every decision since the step before: `[encoding, facts, answer, about]`, or `[encoding, [step,
index]]` for one that was taken before. A decision among hundreds of candidates is cut: see `trimmed`.
"""

import re
from collections.abc import Sequence
from typing import Any

from simulator.episode.episode import EpisodeLine

# What is kept of one decision, from much to little: so many candidates besides those chosen, and so many other facts.
# With none of either, its answer alone is kept. Conventions; docs/replay.md.
DETAILS = ((6, 60), (3, 30), (1, 12), (0, 6), (0, 0))
AS_ROUTES = "routes"  # stands for what a decision was about where the routes of its step are just that
CANDIDATE_NUMBER = re.compile(r"\d{1,9}", re.ASCII)


def trimmed(entry: Any, detail: tuple[int, int] = DETAILS[0]) -> Any:
    """Return a decision as a page keeps it: with the facts of its first candidates and of those chosen."""
    if not isinstance(entry, list) or len(entry) != 4:
        return entry
    encoding, facts, answer, about = entry
    if not all(isinstance(part, list) for part in (facts, answer, about)):
        return entry
    if detail == (0, 0):
        return [encoding, [], answer, [], len(facts)]
    chosen = {number for atom in answer for number in CANDIDATE_NUMBER.findall(str(atom))}
    candidates = sorted({_candidate(fact) for fact in facts} - chosen - {""}, key=int)
    named = chosen | set(candidates[: detail[0]])
    kept, others = [], 0
    for fact in facts:
        others += not _candidate(fact)
        if _candidate(fact) in named or (not _candidate(fact) and others <= detail[1]):
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
    return first if CANDIDATE_NUMBER.fullmatch(first) else ""


def by_encoding(
    solved: list[Any], before: dict[str, Any] | None, routes: Sequence[Any] | None = None
) -> dict[str, Any]:
    """Return the decisions of a step, with each kept by its encoding until the encoding is asked again."""
    last = dict(before["last"]) if before is not None else {}
    order: list[Any] = []
    for entry in solved:
        if isinstance(entry, list) and len(entry) > 3 and isinstance(entry[0], str) and entry[3] != AS_ROUTES:
            if routes and entry[3] == routes:
                entry = [*entry[:3], AS_ROUTES, *entry[4:]]
            key = f"{entry[0]} {len(order)}" if entry[0] in order else entry[0]
            last[key] = entry
            order.append(key)
        else:
            order.append([entry])
    return {"order": order, "last": last}


def route_points(line: EpisodeLine) -> list[Any] | None:
    """Return the points of each route that was weighed at a step, robot frame; None where it states none."""
    routes = line["belief"].get("routes")
    if not isinstance(routes, list) or not all(isinstance(route, dict) and "points" in route for route in routes):
        return None
    return [route["points"] for route in routes]
