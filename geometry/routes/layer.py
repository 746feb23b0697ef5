"""A layer: everything known of the free space of a body of one radius."""

from math import ceil, inf
from numbers import Real
from typing import NamedTuple

import numpy as np

from geometry.homotopy.landmarks import Landmarks, find_ways
from geometry.homotopy.strips import Strips, find_runs
from geometry.kernels.arrays import SquaredDistances
from geometry.skeleton.chains import Chains
from geometry.skeleton.graph import SkeletonGraph, contract
from geometry.skeleton.skeleton import States, Words
from geometry.skeleton.sweep import grow_all

ROUNDING = 1e-12  # of a squared radius: a clearance that was told, squared again, is the level that it came from
HIGHEST = 2**31 - 1  # above any square


class Layer(NamedTuple):
    """What a query needs."""

    square: SquaredDistances
    """(rows + 2, columns + 2) squared clearances in half squares."""
    state: States
    """(rows + 2, columns + 2) links and flags of the skeleton."""
    chains: Chains
    runs: Strips
    ways: Landmarks
    body: bool
    """False for a point, which may use whole squares; True for a body, whose centre keeps to the lines of centres."""


def new_state(shape: tuple[int, ...], words: Words | None = None) -> tuple[States, Words]:
    """A ``state`` of that padded shape and the same memory by eights, fresh or as given."""
    cells = shape[0] * shape[1]
    if words is None:
        words = np.zeros((cells + 7) // 8, np.uint64)
    return words.view(np.uint8)[:cells].reshape(shape), words


def find_bones(square: SquaredDistances, level: int, state: States, words: Words) -> SkeletonGraph:
    """The pathgraph of the cells whose ``square`` is at least ``level``; fills ``state``."""
    grow_all(square, level, state, words)
    return contract(square, state, words)


def find_layer(square: SquaredDistances, level: int, body: bool, state: States, chains: Chains) -> Layer:
    """Strips and ways for a pathgraph."""
    runs = find_runs(square, level)
    return Layer(square, state, chains, runs, find_ways(square, chains, runs, body), body)


def level_of(radius: float) -> int:
    """Return the least ``square`` of a cell where the centre of a body of that radius may be.

    The centres of squares decide for all places between them: seen from one coordinate, the distance to a blocked
    square only grows, only falls or is 0 between two neighbouring centres, for walls stand on whole numbers. So on the
    segment between two centres, and in the square between four, one of these centres is the nearest to every wall.

    Raises
    ------
    ValueError
        When the radius is no finite number or negative.
    """
    if not (isinstance(radius, Real) and 0.0 <= radius < inf):
        raise ValueError(f"radius must be a finite number and not negative, but is {radius!r}")
    reach = 4.0 * float(radius) ** 2 * (1.0 - ROUNDING)
    return max(1, ceil(reach)) if reach < HIGHEST else HIGHEST
