"""Whether each command of recorded episodes is the first step of what was planned before it.

    python -m benchmarks.unchanged write FOLDER --count 100
    python -m benchmarks.episodes.planned FOLDER

Compared are the command of a step and the facts plan/2 and step/2 of the step before it; its reason and the subgoal
that the last answer of planner/asp/deciding chose; and, without the rules of planner/asp/deciding, whether the steps
can be done one after the other. Printed are what differs, how many commands each step of a plan gave, and how many were
reflexes of a robot that does not know where it is.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from utak.kb.language.atoms import atom_parts

REFLEXES = ("recover",)
HALF_A_HUNDREDTH = 0.0051  # squares and degrees: facts are rounded to hundredths


def planned(line: Mapping[str, Any]) -> tuple[list[str], list[str]]:
    """Return the present step of the plan of a line of an episode, in a list, and the steps of the robot."""
    parts = [
        atom_parts(fact.removesuffix(".")) for fact in line["belief"]["facts"] if fact.startswith(("plan(", "step("))
    ]
    steps = sorted((int(arguments[0]), arguments[1]) for name, arguments in parts if name == "step")
    return [a[1] for name, a in parts if name == "plan" and a[0] == "0"], [step for _, step in steps]


def differences(lines: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield in words where a command is not the first step of what was planned, or what is planned cannot be done."""
    for before, line in pairwise(lines):
        subgoal = _chosen(lines, before)
        if not line["why"].startswith(subgoal):
            yield f"step {line['step']}: {line['why']} is not for what was chosen: {subgoal}"
        plans, steps = planned(before)
        if len(plans) != 1 or not steps:
            yield f"step {line['step']}: planned were {plans} and {steps}"
            continue
        if not _is_first(line["action"], steps[0]):
            yield f"step {line['step']}: {line['action']} is not {steps[0]}"
        held = next(
            (atom_parts(f.removesuffix("."))[1][0] for f in before["belief"]["facts"] if f.startswith("held(")), None
        )
        yield from (f"step {line['step']}: {wrong}" for wrong in _not_possible(steps, held))


def _chosen(lines: Sequence[Mapping[str, Any]], line: Mapping[str, Any]) -> str:
    """Return in words the subgoal that the last decision of a line chose; "" where it chose none."""
    entries = [entry for entry in line["belief"]["solved"] if entry[0] == "deciding"]
    if not entries:
        return ""
    _, facts_or_place, *rest = entries[-1]
    if not rest:  # it stands in an earlier line
        step, index = facts_or_place
        _, _, *rest = lines[step]["belief"]["solved"][index]
    answer, about = rest
    numbers = [int(atom_parts(atom)[1][0]) for atom in answer or () if atom.startswith("choose(")]
    return str(about[numbers[0]]) if numbers else ""


def _is_first(action: Mapping[str, Any], step: str) -> bool:
    """Return whether a command does a step of the robot, or begins it where that is a walk."""
    name, arguments = atom_parts(step)
    if action["do"] == "grasp":
        return name == "grasp" and arguments[1] == action["direction"]
    if action["do"] in ("push", "turn"):
        done = [action["degrees"]] if action["do"] == "turn" else [action["east"], action["north"]]
        told = [int(argument) / 100 for argument in arguments[1:]]
        return name in (action["do"], {"push": "press"}.get(action["do"])) and all(
            abs(a - b) <= HALF_A_HUNDREDTH for a, b in zip(done, told, strict=True)
        )
    return name == {"move": "go", "release": "release"}[action["do"]]


def _not_possible(steps: Sequence[str], held: str | None) -> Iterator[str]:
    """Yield which steps cannot be done after those before them, in words."""
    for step in steps:
        name, arguments = atom_parts(step)
        if name in ("go", "grasp") and held is not None:
            yield f"{step} with {held} in hand"
        if name in ("push", "press", "turn", "release") and held != arguments[0]:
            yield f"{step} with {held} in hand"
        held = arguments[0] if name == "grasp" else None if name == "release" else held


def main(arguments: list[str] | None = None) -> int:
    """Print what differs in the episodes of some folders; return 1 where something does."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="folders with episodes, *.jsonl")
    counts: Counter[str] = Counter()
    wrong = 0
    for log in sorted(log for folder in parser.parse_args(arguments).folders for log in folder.rglob("*.jsonl")):
        lines = [line for line in map(json.loads, log.read_text().splitlines()) if "step" in line]
        counts.update(step.partition("(")[0] for line in lines[:-1] for step in planned(line)[0])
        for difference in differences(lines):
            wrong += 1
            print(f"{log}: {difference}")
    commands = sum(counts.values())
    reflexes = sum(counts[name] for name in REFLEXES)
    print(", ".join(f"{name} {count}" for name, count in counts.most_common()))
    print(f"{commands} commands, {wrong} differences, {reflexes} reflexes")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
