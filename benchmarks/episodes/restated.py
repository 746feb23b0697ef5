"""Encodings of the planner restated as a least price: how often that makes the same choices in recorded episodes.

    python -m benchmarks.unchanged write FOLDER --count 100
    python -m benchmarks.episodes.restated FOLDER

Each encoding is restated in the shortest way that is known: the least of prices that stand in its facts. Printed are,
for each encoding, the decisions and those in which the restatement chooses the same. Where these are all, the encoding
does no more in these runs than to sort, and is there for what users' rules say in it.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.timing.explaining import decisions
from utak.kb.language.atoms import atom_parts
from utak.kb.reasoning.encodings import encoding_constant, encoding_facts
from utak.planner.question import DECIDING_ENCODING, PLANNER_ASP

PRICED = {"explore": "look", "inspect": "look", "pass": "pass", "settle": "settle"}  # by kinds of subgoals
FactTable = Mapping[str, Sequence[Sequence[str]]]  # the arguments of the facts of each name
_SUBGOALS, _WALKS = (partial(encoding_constant, DECIDING_ENCODING / f"{one}.lp") for one in ("subgoals", "walks"))


def cheapest_aim(facts: FactTable) -> str:
    """Return the subgoal of the least expected price; one that attains the goal first."""
    prices = {kind: _SUBGOALS(f"{name}_price") for kind, name in PRICED.items()}
    chances, besides = dict(facts.get("chance", ())), dict(facts.get("besides", ()))
    last = {number for (number,) in facts.get("last", ())} & {aim[0] for aim in facts["aim"]}

    def price(aim: Sequence[str]) -> tuple[Any, ...]:
        number, kind, way = aim
        cost = int(way) + int(besides.get(number, 0)) + prices.get(kind, 0)
        switch = _SUBGOALS("aim_switch_price") if last and number not in last else 0
        return kind != "attain", 100 * cost // int(chances.get(number, 100)) + switch, int(number)

    return f"choose({min(facts['aim'], key=price)[0]})"


def cheapest_halt(facts: FactTable) -> str:
    """Return the halt of the fewest moves for each thing that is to be expected there."""
    counted = encoding_facts(PLANNER_ASP / "priors_of_walls.lp", "counted_wall", 3)
    chances = {(kind, size): int(chance) for kind, size, chance in counted}
    value: Counter[str] = Counter()
    for halt, kind, size, number in facts.get("tells", ()):
        value[halt] += int(number) * chances[kind, size]
    halts = [halt for halt in facts["halt"] if value[halt[0]]]
    number, *_ = min(halts, key=lambda one: (1_000_000 * int(one[2]) // value[one[0]], int(one[1]), int(one[0])))
    return f"choose({number})"


def cheapest_way(facts: FactTable) -> str:
    """Return the way, of those pulled tight, of the least length with its risk and clearance."""
    last = {number for (number,) in facts.get("last", ())} & {way[0] for way in facts["tight"]}

    def price(way: Sequence[str]) -> tuple[int, int]:
        number, length, clearance, risk = way
        switch = _WALKS("way_switch_price") if last and number not in last else 0
        squeezed = max(0, _WALKS("free_clearance") - int(clearance))
        return int(length) + _WALKS("risk_price") * int(risk) + squeezed + switch, int(number)

    return f"walked({min(facts['tight'], key=price)[0]})"


def first_activity(facts: FactTable) -> str:
    """Return the first activity, in one fixed order, that something given asks for and that came to nothing yet."""
    came = {activity for activity, _ in facts.get("came_to", ())}
    goals = [goal for goal, _ in facts.get("stage_goal", ())]
    offered = [
        *(["release"] if "robot_lost" in facts and any(fact.startswith("holds(") for fact in facts) else []),
        *(["keep"] if "regions_forbidden" in facts else []),
        *(f"resume({name})" for (name,) in facts.get("begun", ())),
        *(["agree"] if goals else []),
        *(name for (name,) in facts.get("planned", ())),
        "errand",
        *(f"pursue({goal})" for goal in goals),
        *(["go"] if "own_goals" in facts else []),
        "wish",
        "look",
        "settle",
    ]
    return next((f"do({one})" for one in offered if one not in came), "")


def cheapest_errand(facts: FactTable) -> str:
    """Return the errand to a goal's place of the least estimate, as the first step."""
    fulfils = {(mover, place) for mover, place, _ in facts.get("fulfils", ())}
    estimates = [one for one in facts.get("estimate", ()) if (one[0], one[2]) in fulfils]
    if not estimates:
        return ""
    mover, _, place, _ = min(estimates, key=lambda one: int(one[3]))
    return f"occurs(arrive({place}),0)" if mover == "utak" else f"occurs(carry({mover},{place}),0)"


def restated_decision(facts: FactTable) -> set[str]:
    """Return activity, subgoal and way as the restatements of these choose them."""
    found = {first_activity(facts)}
    found |= {cheapest_halt(facts) if "halt" in facts else cheapest_aim(facts)} if "aim" in facts else set()
    return found | ({cheapest_way(facts)} if "tight" in facts else set())


RESTATED: Mapping[str, Callable[[FactTable], set[str]]] = {
    "deciding": restated_decision,
    "task": lambda facts: {cheapest_errand(facts)},
}
# The parts of a decision by themselves: what they are about, and their restatement.
PARTS: Mapping[str, tuple[str, Callable[[FactTable], str]]] = {
    "activity": ("stage_goal", first_activity),
    "halt": ("halt", cheapest_halt),
    "subgoal": ("aim", cheapest_aim),
    "way": ("tight", cheapest_way),
}


def by_name(facts: Sequence[str]) -> FactTable:
    """Return the arguments of facts, by the name of these."""
    found: dict[str, list[Sequence[str]]] = {}
    for name, arguments in map(atom_parts, facts):
        found.setdefault(name, []).append(arguments)
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line for each encoding, and for each part of `deciding`."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="folders with episodes, *.jsonl")
    made: Counter[str] = Counter()
    same: Counter[str] = Counter()
    for log in sorted(log for folder in parser.parse_args(arguments).folders for log in folder.rglob("*.jsonl")):
        for encoding, facts, answer in decisions(log):
            if encoding in RESTATED:
                table = by_name(facts)
                made[encoding] += 1
                same[encoding] += RESTATED[encoding](table) <= set(answer)
                for part, (about, restate) in PARTS.items() if encoding == "deciding" else ():
                    if about in table and not (part == "subgoal" and "halt" in table):
                        made[part] += 1
                        same[part] += restate(table) in answer
    print(f"{'program':>10}{'decisions':>11}{'the same':>10}")
    for name in (*RESTATED, *PARTS):
        print(f"{name:>10}{made[name]:11}{same[name]:10}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
