"""The nodes of a search by whole squares told as legs: as few pushes as can be, the last ones right to the goal."""

import math
from itertools import groupby, pairwise

import numpy as np

from geometry.kernels.arrays import XY, Floats, Longs
from geometry.manipulation.goals import At, placed
from geometry.manipulation.legs import Leg, PushSegment, at_utak, grip_square, rounded
from geometry.manipulation.query import ManipulationQuery
from geometry.manipulation.workspace import padded
from geometry.motion.se2 import Motion, Rotate, Translate
from geometry.state_lattice.footprints import Footprints, quarter
from geometry.state_lattice.lattice import Costs, Grid

ENDS = 300  # of a push that are looked at
MIDDLE = 1e-7  # squares: who is no further from the middle of his square is there
Step = tuple[int, int, int, int]  # hold, quarter, direction, place


class LegExtraction:
    """The nodes of a search told as legs.

    errand : what was searched for. begun : the errand as it was before Utak, with hold of the shape, was thought to
    have pushed it so that he stands in the middle of a square. ends : the price of ending at each pose.
    """

    def __init__(
        self, errand: ManipulationQuery, begun: ManipulationQuery, body: Footprints, grid: Grid, ends: Costs
    ) -> None:
        self.errand, self.body, self.grid, self.ends = errand, body, grid, ends
        self.holds = [quarter(body.holds, k) for k in range(4)]
        self.begun = begun
        self.shape = errand.shape
        self.at = errand.square

    def legs(self, nodes: Longs) -> list[Leg]:
        """The legs, one for each run of nodes with the same hold."""
        count = (self.grid.rows + 2 * self.grid.pad) * self.grid.stride
        steps = [(n // count // 36, n // count // 9 % 4, n // count % 9, n % count) for n in nodes.tolist()]
        runs = [list(run) for _, run in groupby(steps, key=lambda step: step[0])]
        return [self._leg(run, run is runs[0], run is runs[-1]) for run in runs]

    def _utak(self, step: Step) -> XY:
        """The middle of Utak's square at a step."""
        x, y = self.holds[step[1]][step[0]].tolist()
        column, row = self.grid.square(step[3])
        return column + x + 0.5, row + y + 0.5

    def _leg(self, run: list[Step], first: bool, last: bool) -> Leg:
        middle = place = self._utak(run[0])
        taken = self.errand.held and first and self._square(run[0]) == self.errand.square
        walk = 0 if taken else abs(math.floor(place[0]) - self.at[0]) + abs(math.floor(place[1]) - self.at[1])
        if taken:
            place, self.shape = self.begun.utak, self.begun.shape
        square = grip_square(self.shape, place)
        assert taken or square is not None
        motions: list[Motion] = []
        quarters = run[0][1]
        for k, group in groupby(run, key=lambda step: step[1]):
            steps = list(group)
            if k != quarters:
                motions.append(self._turned((k - quarters) % 4, self._utak(steps[0])))
            quarters = k
            before = [place] if steps[0] is run[0] and math.dist(place, middle) > MIDDLE else []
            motions += self._pushed(before, steps, last and steps[-1] is run[-1])
        x, y = self.body.holds[run[0][0]].tolist()
        hold = self.errand.hold_from((x + self.body.home[0] + 0.5, y + self.body.home[1] + 0.5))
        self.at = self._square(run[-1])
        return Leg(place, square or (0, 0), at_utak(place, motions), hold, walk, taken)

    def _square(self, step: Step) -> tuple[int, int]:
        """Utak's square at a step."""
        x, y = self._utak(step)
        return math.floor(x), math.floor(y)

    def _turned(self, quarters: int, utak: XY) -> Motion:
        """Turn the shape; half a turn the way that has more room."""
        ways = [90.0] if quarters == 1 else [-90.0] if quarters == 3 else [180.0, -180.0]
        turns = [Rotate(degrees, utak) for degrees in ways]
        roomy = padded(self.shape, self.errand.margin)
        for shape in (roomy, self.shape):
            for turn in turns:
                if self.errand.yard.lets(shape, utak, turn):
                    self.shape = turn.carry(self.shape)
                    return turn
        self.shape = turns[0].carry(self.shape)
        return turns[0]

    def _pushed(self, before: list[XY], steps: list[Step], last: bool) -> list[Motion]:
        """The pushes along the steps of one quarter turn, as few as can be; the last ones right to the goal.

        before : where Utak is before he comes to the first of the steps.
        """
        stops, corners = self._stops(before, steps)
        goal = self.errand.goal
        if last and isinstance(goal, At):
            end, here = placed(self.errand.shape, goal.pose).centroid, self.shape.centroid
            final = stops[0] + np.array([end.x - here.x, end.y - here.y])
            if np.abs(final - stops[-1]).max() > 1e-9:
                corners = np.append(corners, len(stops))
                stops = np.vstack([stops, final])
        ends = self._ends(steps[0]) if last and not isinstance(goal, At) else np.empty((0, 2))
        push = PushSegment(self.shape, stops, corners, ends, self.errand.margin, self.errand.pull)
        motions: list[Motion] = []
        for (x, y), (u, v) in pairwise(push.pieces(self.errand.yard).tolist()):
            motions.append(rounded(Translate(u - x, v - y)))
            self.shape = motions[-1].carry(self.shape)
        return motions

    def _ends(self, step: Step) -> Floats:
        """Where Utak is when the shape, held and turned as in a step, lies well at the goal: (n, 2), some of them."""
        hold, quarters, _, _ = step
        places = np.flatnonzero(self.ends[quarters] == 0)
        row, column = np.divmod(places[:: math.ceil(len(places) / ENDS) or 1], self.grid.stride)
        ends: Floats = np.column_stack([column, row]) - self.grid.pad + self.holds[quarters][hold] + 0.5
        return ends

    def _stops(self, before: list[XY], steps: list[Step]) -> tuple[Floats, Longs]:
        """Where Utak is at each place on the way (n, 2), and at which of them the way turns, both ends among them."""
        stops = [*before, self._utak(steps[0])]
        corners, heading = [0], 8
        for here, after in pairwise(steps):
            if after[3] == here[3]:
                continue
            if after[2] != heading and len(stops) > 1:
                corners.append(len(stops) - 1)
            heading = after[2]
            stops.append(self._utak(after))
        if len(stops) > 1:
            corners.append(len(stops) - 1)
        return np.array(stops), np.array(corners, dtype=np.int64)
