"""A layer: everything known of the free space of a body of one radius."""

from math import ceil, inf, isqrt
from numbers import Real
from typing import NamedTuple

import numpy as np

from geometry.bones import Bones, contract
from geometry.chains import Chains
from geometry.distance import Squares
from geometry.runs import Runs, find_runs
from geometry.skeleton import States, Words
from geometry.sweep import grow_all
from geometry.ways import Ways, find_ways


class Layer(NamedTuple):
    """What a query needs."""

    square: Squares
    """(rows + 2, columns + 2) squared clearances in half squares."""
    state: States
    """(rows + 2, columns + 2) links and flags of the skeleton."""
    chains: Chains
    runs: Runs
    ways: Ways
    body: bool
    """False for a point, which may use whole squares; True for a body, whose centre keeps to the lines of centres."""


def new_state(shape: tuple[int, ...], words: Words | None = None) -> tuple[States, Words]:
    """A ``state`` of that padded shape and the same memory by eights, fresh or as given."""
    cells = shape[0] * shape[1]
    if words is None:
        words = np.zeros((cells + 7) // 8, np.uint64)
    return words.view(np.uint8)[:cells].reshape(shape), words


def find_bones(square: Squares, level: int, state: States, words: Words) -> Bones:
    """The pathgraph of the cells whose ``square`` is at least ``level``; fills ``state``."""
    grow_all(square, level, state, words)
    return contract(square, state, words)


def find_layer(square: Squares, level: int, body: bool, state: States, chains: Chains) -> Layer:
    """Runs and ways for a pathgraph."""
    runs = find_runs(square, level)
    return Layer(square, state, chains, runs, find_ways(square, chains, runs, body), body)


def level_of(radius: float) -> int:
    """The least ``square`` of a cell where the centre of a body of that radius may be.

    Between the centres of two neighbouring squares a corner may stand half a square off both, nearer than to either.
    Where that would bring the body below its radius the next level is taken, so that a body never touches.

    Raises
    ------
    ValueError
        When the radius is no finite number or negative.
    """
    if not (isinstance(radius, Real) and 0.0 <= radius < inf):
        raise ValueError(f"radius must be a finite number and not negative, but is {radius!r}")
    level = max(1, ceil(4.0 * radius * radius - 1e-9))
    odd = isqrt(level - 1)
    return level + 1 if odd % 2 == 1 and odd * odd == level - 1 else level
