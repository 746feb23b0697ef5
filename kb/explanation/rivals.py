"""The other ways to choose, held against an answer: what each would cost, or which constraints forbid it."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from utak.kb.explanation.programs import DecisionProgram
from utak.kb.explanation.values import Price, RivalChoice
from utak.kb.tracing.syntax import JsonValues

MAX_PRICES_NAMED = 3  # prices that the sentence of a rival names for each side; a convention


def rivals_of(
    program: DecisionProgram, facts: Sequence[str], answer: Sequence[str], heads: Sequence[str], with_none: bool = True
) -> tuple[RivalChoice, ...]:
    """Return how each other way to choose compares with an answer."""
    request = {"task": "weigh", "facts": list(facts), "answer": list(answer), "heads": list(heads), "none": with_none}
    found = program.ask(request)
    chosen = found["chosen"]
    return tuple(sorted((_rival(program, chosen, other) for other in found["others"]), key=_order))


def _order(rival: RivalChoice) -> tuple[int, int, int, str]:
    """Return a key that sorts rivals: the least cost on the lowest level first, forbidden ones last."""
    return rival.verdict == "forbidden", -99_999 if rival.level is None else rival.level, rival.difference, rival.atom


def _rival(program: DecisionProgram, chosen: JsonValues, other: JsonValues) -> RivalChoice:
    """Return how one other way to choose compares with the answer; both are entries of kb.tracing.alternatives."""
    if "broken" in other:
        rules = tuple(program.instance(program.units[unit], values) for unit, values in other["broken"])
        reasons = " ".join(one.sentence for one in rules) or "no answer holds it"
        text = f"{other['atom']} is forbidden: {reasons}"
        return RivalChoice(other["atom"], "forbidden", (), None, 0, (), (), rules, text)
    mine, theirs = dict(map(tuple, chosen["costs"])), dict(map(tuple, other["costs"]))
    levels = sorted((mine.keys() | theirs.keys()), reverse=True)
    level = next((one for one in levels if mine.get(one, 0) != theirs.get(one, 0)), None)
    difference = 0 if level is None else theirs.get(level, 0) - mine.get(level, 0)
    verdict = "equal" if level is None else "dearer" if difference > 0 else "cheaper"
    ours, others = (Counter(_price_key(one) for one in entry["prices"]) for entry in (chosen, other))
    prices, saved = (tuple(_prices(program, part)) for part in (others - ours, ours - others))
    costs = tuple((one, theirs[one]) for one in levels if one in theirs)
    text = _sentence(other["atom"], verdict, level, difference, prices, saved)
    return RivalChoice(other["atom"], verdict, costs, level, difference, prices, saved, (), text, other["proved"])


def _price_key(price: Sequence[Any]) -> tuple[int, int, int, tuple[str, ...]]:
    """Return a price as a key: level downwards, unit, weight, values."""
    unit, values, weight, level = price
    return -level, unit, weight, tuple(values)


def _prices(program: DecisionProgram, found: Mapping[tuple[int, int, int, tuple[str, ...]], int]) -> Iterable[Price]:
    """Yield prices with the sentences of their weak constraints, the highest level first."""
    for level, unit, weight, values in sorted(found):
        yield Price(-level, weight, program.instance(program.units[unit], values))


def _sentence(
    atom: str, verdict: str, level: int | None, difference: int, prices: Sequence[Price], saved: Sequence[Price]
) -> str:
    """Return in one sentence how another way to choose compares with the answer."""
    what = atom or "To choose none of them"
    if verdict == "equal":
        return f"{what} costs the same: either could have been chosen."
    relation = f"costs {difference} more" if difference > 0 else f"costs {-difference} less"
    text = f"{what} {relation} on level {level}"
    theirs, ours = (_named([one for one in part if one.level == level]) for part in (prices, saved))
    parts = [f"it pays {theirs}"] if theirs else []
    parts += [f"the answer pays {ours}"] if ours else []
    return f"{text}: {'; '.join(parts)}." if parts else f"{text}."


def _named(prices: Sequence[Price]) -> str:
    """Return the greatest prices in words, `30 (why), 5 (why)`."""
    ordered = sorted((one for one in prices if one.weight), key=lambda one: -abs(one.weight))
    named = [f"{one.weight} ({one.instance.sentence.rstrip('.')})" for one in ordered[:MAX_PRICES_NAMED]]
    more = len(ordered) - MAX_PRICES_NAMED
    return ", ".join([*named, f"{more} more"] if more > 0 else named)
