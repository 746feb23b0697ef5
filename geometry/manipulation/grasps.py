"""Grasp candidates: places from which the robot can grasp a body as it lies, and the order in which to try them."""

import math
from dataclasses import dataclass

import numpy as np
import shapely

from utak.geometry.cspace.fewest_motions import resample_evenly
from utak.geometry.kernels.arrays import XY, Floats
from utak.geometry.manipulation.query import ManipulationQuery
from utak.geometry.raster.geodesic import FIFTHS_PER_SQUARE, reach
from utak.geometry.raster.rasterize import squares
from utak.geometry.state_lattice.footprints import PUSH_DIRECTIONS

MAX_TRACK_SAMPLES = 60  # poses of a track that are looked at; convention, for time


@dataclass(frozen=True)
class GraspCandidate:
    """A place from which the robot can grasp the body where it lies."""

    place: XY  # (x, y) in squares, table frame, the centre of a square, or the robot's own place
    walk: int  # squares to walk to it, rounded down
    taken: bool = False  # whether the robot is there and holds the body already


def grasp_candidates(query: ManipulationQuery) -> list[GraspCandidate]:
    """Return the present grasp if there is one, then those that the robot can walk to, nearest first."""
    shape, utak = query.shape, query.utak
    rows, columns = query.walk.shape
    covered = squares(shape, columns, rows)
    walk = query.walk & ~covered
    at = (min(max(math.floor(utak[0]), 0), columns - 1), min(max(math.floor(utak[1]), 0), rows - 1))
    walk[at[1], at[0]] = True
    distances = reach(walk, *at)
    beside = np.zeros_like(covered)
    framed = np.pad(covered, 1)
    for dx, dy in PUSH_DIRECTIONS:
        beside |= framed[1 + dy : 1 + dy + rows, 1 + dx : 1 + dx + columns]
    found = np.argwhere(beside & ~covered & query.workspace.free & (distances >= 0))
    candidates = [
        GraspCandidate((column + 0.5, row + 0.5), int(distances[row, column]) // FIFTHS_PER_SQUARE)
        for row, column in found.tolist()
    ]
    allowed = [candidate for candidate in candidates if not query.is_avoided(*query.grasp_offset(candidate.place))]
    present = [GraspCandidate(utak, 0, True)] if query.held else []
    return present + sorted(allowed, key=lambda candidate: (candidate.walk, candidate.place))


def grasp_rank(query: ManipulationQuery, candidate: GraspCandidate, track: Floats) -> tuple[bool, int, float, int, XY]:
    """Return a sort key for grasps: the most promising has the least. Keys are compared part by part."""
    # Its parts are: whether it is not the present grasp; how often the track would bring the robot into a wall, in
    # MAX_TRACK_SAMPLES poses; the distance from the robot's place at the grasp to the body's furthest corner, in
    # squares; the squares to walk; that place, (x, y) in squares, table frame.
    in_walls = 0
    if len(track):
        way = resample_evenly(track, 1.0, MAX_TRACK_SAMPLES)
        away = np.array(candidate.place) - way[0, :2]
        turn = way[:, 2] - way[0, 2]
        x = way[:, 0] + np.cos(turn) * away[0] - np.sin(turn) * away[1]
        y = way[:, 1] + np.sin(turn) * away[0] + np.cos(turn) * away[1]
        in_walls = int(shapely.contains_xy(shapely.union_all(query.workspace.walls), x, y).sum())
    far = round(float(shapely.hausdorff_distance(query.shape, shapely.Point(candidate.place))), 6)
    return not candidate.taken, in_walls, far, candidate.walk, candidate.place
