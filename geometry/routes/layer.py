"""A layer: the pathgraph, strips and landmarks of free space, in arrays as the kernels read them."""

from typing import NamedTuple

from utak.geometry.homotopy.landmarks import Landmarks, compute_landmarks
from utak.geometry.homotopy.strips import Strips, find_strips
from utak.geometry.kernels.arrays import SquaredDistances
from utak.geometry.skeleton.chains import Chains
from utak.geometry.skeleton.skeleton import Flags, Heights, States


class Layer(NamedTuple):
    """All that a query reads of free space. What is read by cell is flat."""

    heights: Heights  # (cells,) squared clearances in squared half squares, flat and padded; 0 on blocked cells
    states: Flags  # (cells,) links and flags of the skeleton, 0 off it
    width: int  # columns of the padded grid; a cell's index is (row + 1) * width + column + 1
    chains: Chains  # the chains of the pathgraph: its edges, with their cells
    strips: Strips  # maximal horizontal rows of free squares, and the portals between neighbouring ones
    landmarks: Landmarks  # words and lengths of the chains, and distances from some nodes


def build_layer(square: SquaredDistances, state: States, chains: Chains) -> Layer:
    """Return the layer of a pathgraph: find its strips and landmarks. Arrays by cell are views."""
    strips, width = find_strips(square), square.shape[1]
    landmarks = compute_landmarks(width, chains, strips)
    return Layer(square.reshape(-1), state.reshape(-1), width, chains, strips, landmarks)
