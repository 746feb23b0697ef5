"""A layer: the pathgraph, strips and landmarks of the free space of a body of one radius."""

from math import ceil, inf
from numbers import Real
from typing import NamedTuple

import numpy as np

from geometry.homotopy.landmarks import Landmarks, compute_landmarks
from geometry.homotopy.strips import Strips, find_strips
from geometry.kernels.arrays import SquaredDistances
from geometry.skeleton.chains import Chains
from geometry.skeleton.graph import SkeletonGraph, contract
from geometry.skeleton.skeleton import States, Words
from geometry.skeleton.sweep import grow_all

RADIUS_ROUNDING = 1e-12  # share of a squared radius; derived: a clearance, squared again, gives the level it came from
MAX_LEVEL = 2**31 - 1  # half squares, squared; derived: above every squared clearance of a screen


class Layer(NamedTuple):
    """All that a query reads of the free space of a body of one radius.

    Attributes
    ----------
    square : (rows + 2, columns + 2) int, squared clearances in squared half squares, padded by one cell on each side; 0
        on blocked cells.
    state : (rows + 2, columns + 2) uint8, links and flags of the skeleton, 0 off the skeleton (see skeleton.py).
    chains : the chains of the pathgraph: its edges, with their cells.
    runs : the strips and portals of the free space.
    landmarks : words and lengths of the chains, and distances from landmark nodes.
    body : False for a point, which may use whole squares; True for a body, whose centre keeps to the lines of centres.
    """

    square: SquaredDistances
    state: States
    chains: Chains
    runs: Strips
    landmarks: Landmarks
    body: bool


def new_state(shape: tuple[int, ...], words: Words | None = None) -> tuple[States, Words]:
    """Return a skeleton `state` of that padded shape, and the same memory as words of eight cells.

    Fresh memory is 0; memory that is given keeps its values.

    Parameters
    ----------
    shape : (rows + 2, columns + 2).
    words : memory to use, uint64, of at least an eighth as many entries as there are cells; None for fresh memory.

    Returns
    -------
    state : (rows + 2, columns + 2) uint8, a view of the words.
    words : ((cells + 7) // 8 or more,) uint64.
    """
    cells = shape[0] * shape[1]
    if words is None:
        words = np.zeros((cells + 7) // 8, np.uint64)
    return words.view(np.uint8)[:cells].reshape(shape), words


def find_pathgraph(square: SquaredDistances, level: int, state: States, words: Words) -> SkeletonGraph:
    """Return the pathgraph of the cells whose squared clearance is at least `level`; fill `state`.

    It holds the cells of the nodes (flat padded indices, ascending), and for each chain its two ends (4 times the node
    plus the direction in which it leaves), its lowest cell and its number of steps from square to square.
    The pathgraph has the junctions and ends of the skeleton as nodes, and the chains of cells between them, which never
    branch, as edges. A chain is such an edge. Without a cell at that level there are none.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int, padded squared clearances in squared half squares.
    level : the least squared clearance, in squared half squares.
    state : (rows + 2, columns + 2) uint8, written: links and flags of the skeleton, 0 elsewhere.
    words : the memory of `state` as words of eight cells.
    """
    grow_all(square, level, state, words)
    return contract(square, state, words)


def build_layer(square: SquaredDistances, level: int, body: bool, state: States, chains: Chains) -> Layer:
    """Return the layer of a pathgraph: find its strips and landmarks.

    It holds the arguments `square`, `state`, `chains` and `body`, not copied, the strips and portals of the cells at
    the level, and the words (signed portals), lengths (squares) and landmark distances of the chains.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells. A
    portal is the overlap of two strips (rows of free squares) in neighbouring rows.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int, squared clearances in squared half squares.
    level : the least squared clearance of a cell where the body may be, in squared half squares.
    body : True for a body, False for a point.
    state : (rows + 2, columns + 2) uint8, links and flags of the skeleton of the cells at that level, 0 off it.
    chains : the edges of the pathgraph of that skeleton, with their nodes and cells.
    """
    runs = find_strips(square, level)
    return Layer(square, state, chains, runs, compute_landmarks(square, chains, runs, body), body)


def least_squared_clearance(radius: float) -> int:
    """Return the least squared clearance, in squared half squares, of a cell at whose centre a body may be.

    It is 1 or more, 1 for a point, and at most MAX_LEVEL, which no cell reaches.

    The centres of squares decide for all places between them: seen from one coordinate, the distance to a blocked
    square only grows, only falls or is 0 between two neighbouring centres, because walls stand on whole numbers. So on
    the segment between two centres, and in the square between four, one of these centres is the nearest to every wall.

    Parameters
    ----------
    radius : of the body, in squares; 0 for a point.

    Raises
    ------
    ValueError
        When the radius is no finite number or negative.
    """
    if not (isinstance(radius, Real) and 0.0 <= radius < inf):
        raise ValueError(f"radius must be a finite number and not negative, but is {radius!r}")
    level = 4.0 * float(radius) ** 2 * (1.0 - RADIUS_ROUNDING)
    return max(1, ceil(level)) if level < MAX_LEVEL else MAX_LEVEL
