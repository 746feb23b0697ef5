"""A layer: the pathgraph, strips and landmarks of the free space of a body of one radius."""

from math import ceil, inf
from numbers import Real
from typing import NamedTuple

import numpy as np

from utak.geometry.homotopy.landmarks import Landmarks, compute_landmarks
from utak.geometry.homotopy.strips import Strips, find_strips
from utak.geometry.kernels.arrays import SquaredDistances
from utak.geometry.skeleton.chains import Chains
from utak.geometry.skeleton.graph import SkeletonGraph, contract
from utak.geometry.skeleton.skeleton import States, Words
from utak.geometry.skeleton.sweep import grow_all

RADIUS_ROUNDING = 1e-12  # share of a squared radius; derived: a clearance, squared again, gives the level it came from
MAX_LEVEL = 2**31 - 1  # half squares, squared; derived: above every squared clearance of a screen


class Layer(NamedTuple):
    """All that a query reads of the free space of a body of one radius."""

    # (rows + 2, columns + 2) int, squared clearances in squared half squares, padded by one cell on each side; 0 on
    # blocked cells
    square: SquaredDistances
    # (rows + 2, columns + 2) uint8, links and flags of the skeleton, 0 off the skeleton (see skeleton.py).
    state: States
    chains: Chains  # the chains of the pathgraph: its edges, with their cells
    runs: Strips  # the strips and portals of the free space
    landmarks: Landmarks  # words and lengths of the chains, and distances from landmark nodes
    # False for a point, which may use whole squares; True for a body, whose centre keeps to the lines of centres
    body: bool


def new_state(shape: tuple[int, ...], words: Words | None = None) -> tuple[States, Words]:
    """Return a skeleton `state` of that padded shape, and the same memory as words of eight cells."""
    cells = shape[0] * shape[1]
    if words is None:
        words = np.zeros((cells + 7) // 8, np.uint64)
    return words.view(np.uint8)[:cells].reshape(shape), words


def find_pathgraph(square: SquaredDistances, level: int, state: States, words: Words) -> SkeletonGraph:
    """Return the pathgraph of the cells whose squared clearance is at least `level`; fill `state`."""
    grow_all(square, level, state, words)
    return contract(square, state, words)


def build_layer(square: SquaredDistances, level: int, body: bool, state: States, chains: Chains) -> Layer:
    """Return the layer of a pathgraph: find its strips and landmarks."""
    runs = find_strips(square, level)
    return Layer(square, state, chains, runs, compute_landmarks(square, chains, runs, body), body)


def least_squared_clearance(radius: float) -> int:
    """Return the least squared clearance, in squared half squares, of a cell at whose centre a body may be."""
    # The centres of squares decide for all places between them: seen from one coordinate, the distance to a blocked
    # square only grows, only falls or is 0 between two neighbouring centres, because walls stand on whole numbers.
    if not (isinstance(radius, Real) and 0.0 <= radius < inf):
        raise ValueError(f"radius must be a finite number and not negative, but is {radius!r}")
    level = 4.0 * float(radius) ** 2 * (1.0 - RADIUS_ROUNDING)
    return max(1, ceil(level)) if level < MAX_LEVEL else MAX_LEVEL
