"""Checks of trees of reasons, written by hand: they share no code with what makes the trees.

A tree is a dictionary as `utak explain --json` prints it. Every node is confirmed from the episode alone: facts are
looked up, rules are grounded again by themselves, cells and touches are read from the impressions.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import clingo

PROJECT = Path(__file__).resolve().parent.parent.parent
StepLine = Mapping[str, Any]
Tree = Mapping[str, Any]
TOUCH_DIRECTIONS = ("north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest")
PLAN_MEASURES = ("takes(", "verified(", "refuted(", "given(")  # what geometry said of steps of the task plan
ENDS = {"measured", "decided", "cells", "touch", "command", "task", "convention", "negation", "computed", "rejected"}


def complaints(lines: Sequence[StepLine], tree: Tree) -> Iterator[str]:
    """Yield what is wrong with a tree of reasons; nothing when every node is confirmed.

    Parameters
    ----------
    lines : the lines of the steps of the episode.
    tree : the tree.
    """
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        below = node.get("rests_on", [])
        waiting += below
        if not below and node["kind"] not in ENDS:
            yield f"{node['claim']} ends in nothing"
        check = NODE_CHECKS.get(node["kind"])
        if check is not None:
            yield from check(lines, node)


def _fact(lines: Sequence[StepLine], node: Tree) -> Iterator[str]:
    """Yield a complaint about a fact that its step does not state."""
    step = int(re.fullmatch(r"step (\d+)", node["source"])[1])  # type: ignore[index]
    if f"{node['claim']}." not in lines[step]["belief"]["facts"]:
        yield f"{node['claim']} is not believed at step {step}"


def _measured(lines: Sequence[StepLine], node: Tree) -> Iterator[str]:
    """Yield a complaint about a fact of the task plan that the step which is named as its source does not state."""
    if node["claim"].startswith(PLAN_MEASURES):
        yield from _fact(lines, node)


def _cells(lines: Sequence[StepLine], node: Tree) -> Iterator[str]:
    """Yield complaints about cells: wrong levels, cells that do not cover the square they are said to show."""
    data = node.get("data", {})
    if "cell" in data:
        if lines[data["impression"]]["retina"][data["cell"]] != data["level"]:
            yield f"{node['claim']}: it shows another level"
        return
    for impression, cell, level, _ in data.get("cells", []):
        if lines[impression]["retina"][cell] != level:
            yield f"cell {cell} of impression {impression} does not show level {level}"
        if f"cell {cell} of impression {impression} " not in node["because"]:
            yield f"cell {cell} of impression {impression} is not named"


def covers(lines: Sequence[StepLine], step: int, impression: int, cell: int, square: Sequence[int]) -> bool:
    """Return whether a cell of an impression covers a square of the map frame, as believed at a step (DESIGN 4).

    The square under an offset is the robot's square plus the rotated offset, rounded; both ways round for a half.
    """
    place, angle, origin = believed_place(lines, step, impression)
    x, y = rotated(place, angle)
    own = math.floor(x + origin[0] + 1e-9), math.floor(y + origin[1] + 1e-9)
    near = {own, (math.floor(x + origin[0] - 1e-9), math.floor(y + origin[1] - 1e-9))}
    for offset in offsets_of_cells()[cell]:
        east, north = rotated(offset, angle)
        for dx in (-1e-6, 1e-6):
            for dy in (-1e-6, 1e-6):
                there = round(east + dx), round(north + dy)
                if any((a + there[0], b + there[1]) == tuple(square) for a, b in near):
                    return True
    return False


def believed_place(
    lines: Sequence[StepLine], step: int, impression: int
) -> tuple[tuple[float, float], float, tuple[float, float]]:
    """Return where an impression was received as believed at a step (robot frame), the frame's angle and its origin."""
    places: list[tuple[float, float]] = []
    for line in lines[: step + 1]:
        belief = line["belief"]
        places = [tuple(p) for p in belief["seen_from"]] if "seen_from" in belief else [*places, tuple(belief["place"])]
    belief = lines[step]["belief"]
    return places[impression], belief["lattice"], tuple(belief["origin"])


def rotated(point: Sequence[float], degrees: float) -> tuple[float, float]:
    """Return a point turned about the origin, counter-clockwise."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return point[0] * c - point[1] * s, point[0] * s + point[1] * c


@lru_cache(maxsize=1)
def offsets_of_cells() -> list[list[tuple[int, int]]]:
    """Return the offsets (east, north) under each of the 160 cells: three zones, north row first, west to east."""
    cells = []
    for reach, side, hole in ((4, 1, 0), (8, 2, 4), (16, 4, 8)):
        for top in range(reach - side, -reach - 1, -side):
            for left in range(-reach, reach, side):
                if -hole <= left < hole and -hole <= top < hole:
                    continue
                cells.append([(left + i, top + j) for i in range(side) for j in range(side)])
    return cells


def _touch(lines: Sequence[StepLine], node: Tree) -> Iterator[str]:
    """Yield a complaint about a touch that was another one."""
    data = node["data"]
    if lines[data["impression"]]["touch"][TOUCH_DIRECTIONS.index(data["direction"])] != data["colour"]:
        yield f"{node['claim']}: impression {data['impression']} felt something else"


def _command(lines: Sequence[StepLine], node: Tree) -> Iterator[str]:
    """Yield a complaint about a command that was not given."""
    action = lines[node["data"]["step"]]["action"]
    word = "woke" if action is None else action["do"]
    if word not in node["claim"]:
        yield f"{node['claim']}: the command of step {node['data']['step']} was {word}"


def _rule(lines: Sequence[StepLine], node: Tree) -> Iterator[str]:
    """Yield a complaint about a rule that does not give its head from what the node rests on."""
    match = re.fullmatch(r"(.*\.lp):(\d+)", node.get("source", ""))
    if match is None:
        if not node["claim"].startswith("verdict("):
            yield f"{node['claim']}: no rule is named"
        return
    path = PROJECT / match[1]
    rule = node["data"]["rule"]
    written = " ".join(" ".join(path.read_text().splitlines()[int(match[2]) - 1 :]).split())
    if not written.startswith(rule):
        yield f"{node['claim']}: {match[0]} does not say {rule}"
    atoms = tuple(sorted(_atoms_below(node)))
    if node["claim"] not in _derived(rule, atoms, _constants(path)):
        yield f"{node['claim']} does not follow by {rule} from {', '.join(atoms)}"


def _atoms_below(node: Tree) -> Iterator[str]:
    """Yield the atoms on which a rule rests: those of its own body, also within aggregates and conditions."""
    for child in node.get("rests_on", []):
        if child["kind"] in ("computed",):
            yield from _atoms_below(child)
        elif child["kind"] not in ("negation", "rejected"):
            yield child["claim"]


@lru_cache(maxsize=100_000)
def _derived(rule: str, atoms: tuple[str, ...], constants: str) -> frozenset[str]:
    """Return the atoms that some answer set of a rule and some facts holds, all of them together."""
    control = clingo.Control(["0", "--warn=none", "--enum-mode=brave"])
    control.add("base", [], constants + rule + "\n" + "".join(f"{atom}.\n" for atom in atoms))
    control.ground([("base", [])])
    found: set[str] = set()
    control.solve(on_model=lambda model: found.update(str(atom) for atom in model.symbols(atoms=True)))
    return frozenset(found)


@lru_cache(maxsize=32)
def _constants(path: Path) -> str:
    """Return the `#const` statements of an encoding, and of the counts beside it."""
    files = {path, *path.parent.glob("priors*.lp")}
    lines = (line for file in sorted(files) for line in file.read_text().splitlines())
    return "\n".join(line for line in lines if line.startswith("#const")) + "\n"


NODE_CHECKS = {
    "fact": _fact,
    "measured": _measured,
    "cells": _cells,
    "touch": _touch,
    "command": _command,
    "rule": _rule,
}
