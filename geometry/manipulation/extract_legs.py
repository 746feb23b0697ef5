"""From the nodes of a lattice search to legs: as few pushes as possible, the last ones straight to the goal."""

import math
from itertools import groupby, pairwise

import numpy as np

from utak.geometry.kernels.arrays import XY, Floats, Longs
from utak.geometry.manipulation.goals import At, shape_at_pose
from utak.geometry.manipulation.legs import Leg, PushSegment, direction_to_grasp, round_motion, with_pivots_at_robot
from utak.geometry.manipulation.query import ManipulationQuery
from utak.geometry.manipulation.workspace import padded_shape
from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.geometry.state_lattice.footprints import Footprints, quarter
from utak.geometry.state_lattice.lattice import Costs, Grid

MAX_END_SAMPLES = 300  # ends of a push that are tried; convention, for time
CENTRE_TOLERANCE = 1e-7  # squares; rounding: a robot this near to the centre of its square is at it
Step = tuple[int, int, int, int]  # grasp, quarter turn, direction, cell


class LegExtraction:
    """The translation of a search's nodes into legs."""

    def __init__(
        self, query: ManipulationQuery, before_nudge: ManipulationQuery, body: Footprints, grid: Grid, ends: Costs
    ) -> None:
        self.query, self.body, self.grid, self.ends = query, body, grid, ends
        self.holds = [quarter(body.holds, k) for k in range(4)]
        self.before_nudge = before_nudge
        self.shape = query.shape
        self.at = query.square

    def legs(self, nodes: Longs) -> list[Leg]:
        """Return the legs, one for each group of successive nodes with the same grasp, in order; [] without nodes."""
        count = (self.grid.rows + 2 * self.grid.pad) * self.grid.stride
        steps = [(n // count // 36, n // count // 9 % 4, n // count % 9, n % count) for n in nodes.tolist()]
        groups = [list(group) for _, group in groupby(steps, key=lambda step: step[0])]
        return [self._leg(group, group is groups[0], group is groups[-1]) for group in groups]

    def _robot_place(self, step: Step) -> XY:
        """Return the centre of the robot's square at a step, (x, y) in squares, table frame."""
        x, y = self.holds[step[1]][step[0]].tolist()
        column, row = self.grid.square(step[3])
        return column + x + 0.5, row + y + 0.5

    def _leg(self, group: list[Step], first: bool, last: bool) -> Leg:
        """Return the leg of a group of steps with the same grasp, and move the shape and the robot along."""
        middle = place = self._robot_place(group[0])
        taken = self.query.held and first and self._square(group[0]) == self.query.square
        walk = 0 if taken else abs(math.floor(place[0]) - self.at[0]) + abs(math.floor(place[1]) - self.at[1])
        if taken:
            place, self.shape = self.before_nudge.utak, self.before_nudge.shape
        square = direction_to_grasp(self.shape, place)
        assert taken or square is not None
        motions: list[Motion] = []
        quarters = group[0][1]
        for k, same_quarter in groupby(group, key=lambda step: step[1]):
            steps = list(same_quarter)
            if k != quarters:
                motions.append(self._turn((k - quarters) % 4, self._robot_place(steps[0])))
            quarters = k
            before = [place] if steps[0] is group[0] and math.dist(place, middle) > CENTRE_TOLERANCE else []
            motions += self._pushes(before, steps, last and steps[-1] is group[-1])
        x, y = self.body.holds[group[0][0]].tolist()
        hold = self.query.grasp_offset((x + self.body.home[0] + 0.5, y + self.body.home[1] + 0.5))
        self.at = self._square(group[-1])
        return Leg(place, square or (0, 0), with_pivots_at_robot(place, motions), hold, walk, taken)

    def _square(self, step: Step) -> tuple[int, int]:
        """Return (column, row) of the robot's square at a step, in the table."""
        x, y = self._robot_place(step)
        return math.floor(x), math.floor(y)

    def _turn(self, quarters: int, utak: XY) -> Motion:
        """Return the turn of the shape by quarters about the robot, and turn the shape."""
        ways = [90.0] if quarters == 1 else [-90.0] if quarters == 3 else [180.0, -180.0]
        turns = [Rotate(degrees, utak) for degrees in ways]
        with_margin = padded_shape(self.shape, self.query.margin)
        for shape in (with_margin, self.shape):
            for turn in turns:
                if self.query.workspace.lets(shape, utak, turn):
                    self.shape = turn.carry(self.shape)
                    return turn
        self.shape = turns[0].carry(self.shape)
        return turns[0]

    def _pushes(self, before: list[XY], steps: list[Step], last: bool) -> list[Motion]:
        """Return the pushes along the steps of one quarter turn, as few as possible, and move the shape along."""
        stops, corners = self._stops(before, steps)
        goal = self.query.goal
        if last and isinstance(goal, At):
            end, here = shape_at_pose(self.query.shape, goal.pose).centroid, self.shape.centroid
            final = stops[0] + np.array([end.x - here.x, end.y - here.y])
            if np.abs(final - stops[-1]).max() > 1e-9:
                corners = np.append(corners, len(stops))
                stops = np.vstack([stops, final])
        ends = self._ends(steps[0]) if last and not isinstance(goal, At) else np.empty((0, 2))
        push = PushSegment(self.shape, stops, corners, ends, self.query.margin, self.query.pull)
        motions: list[Motion] = []
        for (x, y), (u, v) in pairwise(push.pieces(self.query.workspace).tolist()):
            motions.append(round_motion(Translate(u - x, v - y)))
            self.shape = motions[-1].carry(self.shape)
        return motions

    def _ends(self, step: Step) -> Floats:
        """Return places of the robot at which the shape, held and turned as in a step, suits the goal (cost 0)."""
        hold, quarters, _, _ = step
        places = np.flatnonzero(self.ends[quarters] == 0)
        row, column = np.divmod(places[:: math.ceil(len(places) / MAX_END_SAMPLES) or 1], self.grid.stride)
        ends: Floats = np.column_stack([column, row]) - self.grid.pad + self.holds[quarters][hold] + 0.5
        return ends

    def _stops(self, before: list[XY], steps: list[Step]) -> tuple[Floats, Longs]:
        """Return the robot's places on the path, and the indices of those where it turns, ends included."""
        stops = [*before, self._robot_place(steps[0])]
        corners, direction = [0], 8
        for here, following in pairwise(steps):
            if following[3] == here[3]:
                continue
            if following[2] != direction and len(stops) > 1:
                corners.append(len(stops) - 1)
            direction = following[2]
            stops.append(self._robot_place(following))
        if len(stops) > 1:
            corners.append(len(stops) - 1)
        return np.array(stops), np.array(corners, dtype=np.int64)
