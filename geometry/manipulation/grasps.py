"""Where Utak can take a body as it lies, and what may be hoped of each such place."""

import math
from dataclasses import dataclass

import numpy as np
import shapely

from geometry.cspace.fewest_motions import evenly
from geometry.kernels.arrays import XY, Floats
from geometry.manipulation.query import ManipulationQuery
from geometry.raster.geodesic import reach
from geometry.raster.rasterize import squares
from geometry.state_lattice.footprints import DIRECTIONS

SAMPLES = 60  # of a track
FIFTHS = 5  # of a square: the unit of geometry.raster.geodesic


@dataclass(frozen=True)
class Grasp:
    """A place where Utak can take the body where it lies: (x, y), the middle of a square, and the squares to walk.

    taken : he is there and has hold of it.
    """

    place: XY
    walk: int
    taken: bool = False


def holds_about(errand: ManipulationQuery) -> list[Grasp]:
    """The hold that he has, then those that he can walk to, the nearest first, without those refuted."""
    shape, utak = errand.shape, errand.utak
    rows, columns = errand.walk.shape
    lying = squares(shape, columns, rows)
    walk = errand.walk & ~lying
    at = (min(max(math.floor(utak[0]), 0), columns - 1), min(max(math.floor(utak[1]), 0), rows - 1))
    walk[at[1], at[0]] = True
    ways = reach(walk, *at)
    beside = np.zeros_like(lying)
    framed = np.pad(lying, 1)
    for dx, dy in DIRECTIONS:
        beside |= framed[1 + dy : 1 + dy + rows, 1 + dx : 1 + dx + columns]
    found = np.argwhere(beside & ~lying & errand.yard.free & (ways >= 0))
    holds = [Grasp((column + 0.5, row + 0.5), int(ways[row, column]) // FIFTHS) for row, column in found.tolist()]
    fit = [hold for hold in holds if not errand.avoids(*errand.hold_from(hold.place))]
    own = [Grasp(utak, 0, True)] if errand.held else []
    return own + sorted(fit, key=lambda hold: (hold.walk, hold.place))


def promise(errand: ManipulationQuery, hold: Grasp, track: Floats) -> tuple[bool, int, float, int, XY]:
    """How good a hold is likely to be, the least the best: the hold that he has before all others.

    Then: how often the track would bring Utak into a wall; how far the furthest corner is; how far he has to walk.
    """
    inside = 0
    if len(track):
        way = evenly(track, 1.0, SAMPLES)
        away = np.array(hold.place) - way[0, :2]
        turn = way[:, 2] - way[0, 2]
        x = way[:, 0] + np.cos(turn) * away[0] - np.sin(turn) * away[1]
        y = way[:, 1] + np.sin(turn) * away[0] + np.cos(turn) * away[1]
        inside = int(shapely.contains_xy(shapely.union_all(errand.yard.walls), x, y).sum())
    far = round(float(shapely.hausdorff_distance(errand.shape, shapely.Point(hold.place))), 6)
    return not hold.taken, inside, far, hold.walk, hold.place
