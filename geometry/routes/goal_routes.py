"""Routes to the nearest of many squares: the shortest of every class that ends in a goal set (see goal_sets.py)."""

from itertools import pairwise
from math import hypot, inf, nan

from geometry.homotopy.portals import join_words, word_of_line
from geometry.kernels.arrays import XY, Bools, Ints
from geometry.passages.necks import Passage
from geometry.routes.barrier import Barrier
from geometry.routes.goal_sets import GoalRegion, candidate_cells, goal_regions, word_of_cells
from geometry.routes.lifting import cells_of_word
from geometry.routes.queries import EXTRA_PATHS, LENGTH_TOLERANCE, LayerQueries
from geometry.routes.route import Route
from geometry.routes.tighten import tight_route


def routes_to_area(
    queries: LayerQueries, start: XY, goal: Bools, k: int, avoid: tuple[Passage, ...] = ()
) -> list[Route]:
    """Return at most k routes to squares of a set, each the shortest of its class, shortest first.

    Routes are of one class when one can be deformed into the other while its end moves within the set. A route holds
    its corners (x, y) in squares from the screen's south-west corner, both ends included, its length and clearance in
    squares, its signature (the crossing numbers that name its class), and the chains that it follows.

    Empty when the body cannot be at the start, or no square of the set can be reached.

    Parameters
    ----------
    queries : what answers for the layer: the free space of a body of one radius, with its pathgraph and strips.
    start : (x, y) in squares from the screen's south-west corner.
    goal : (rows, columns) bool, True on squares of the set, row 0 in the south. Squares in which the body cannot be do
        not count.
    k : how many routes at most.
    avoid : passages through which no route may lead.
    """
    if not queries.admits(start):
        return []
    area = GoalArea(queries, start, goal, avoid)
    best: dict[tuple[int, ...], Route] = {}
    for route, number, cell in [*area.to_nearest_square(), *area.to_representatives(k)]:
        word = word_of_line(queries.layer.runs, route.points.tolist())
        key = (number, *area.regions[number].class_of(word, cell))
        if key not in best or route.length < best[key].length - LENGTH_TOLERANCE:
            best[key] = route
    return [queries.with_skeleton_path(route) for route in sorted(best.values(), key=lambda route: route.length)[:k]]


SetRoute = tuple[Route, int, int]  # a route, the number of the part of the set in which it ends, and the cell


class GoalArea:
    """A goal set and the searches for routes to it.

    Points are (x, y) in squares from the screen's south-west corner. A cell is a square given by its index in the flat
    padded grid, (row + 1) * width + column + 1.

    Attributes
    ----------
    queries : what answers for the layer: the free space of a body of one radius, with its pathgraph and strips.
    layer : that free space alone, without the scratch of searches.
    width : columns of the padded grid.
    start : (x, y) in squares.
    avoid : passages through which no route may lead.
    goal : (rows, columns) bool, the squares of the set in which the body may be.
    barrier : the floor cut along the passages to avoid; None when there are none.
    regions : the connected parts of the set.
    region_of : by cell of the set, the number of its part: its index in `regions`.
    """

    def __init__(self, queries: LayerQueries, start: XY, goal: Bools, avoid: tuple[Passage, ...]) -> None:
        """Find the parts of a goal set.

        Parameters
        ----------
        queries : what answers for the layer: the free space of a body of one radius, with its pathgraph and strips.
        start : (x, y) in squares from the screen's south-west corner.
        goal : (rows, columns) bool, True on squares of the set; those in which the body cannot be do not count.
        avoid : passages through which no route may lead; may be empty.
        """
        self.queries, self.start, self.avoid = queries, start, avoid
        self.layer = queries.layer
        self.width: int = self.layer.square.shape[1]
        self.goal = goal & (self.layer.square[1:-1, 1:-1] >= queries.level)
        self.barrier: Barrier | None = queries.barrier(avoid) if avoid else None
        self.regions: list[GoalRegion] = goal_regions(self.layer.square, queries.level, self.layer.runs, goal)
        self.region_of = {cell: number for number, region in enumerate(self.regions) for cell in region.vertex}

    def to_nearest_square(self) -> list[SetRoute]:
        """Return the route to the nearest square of all as a list of one; an empty list when none can be reached.

        The entry is (route, number of the part of the set in which it ends, last cell). Of squares as near that tried
        first counts. The route's points (x, y), from the south-west corner of the screen, and its length are in
        squares; clearance and chains may not be known (nan, empty).

        Squares are tried in the order of their straight distances, as long as these are less than the best length.
        """
        queries, (x, y) = self.queries, self.start
        exact = not self.avoid and not self.layer.body
        cells = candidate_cells(self.layer.square, queries.level, self.goal, queries.cell(self.start))
        centres = {cell: queries.centre(cell) for cell in cells}
        least, best, found = inf, -1, None
        for away, cell in sorted((hypot(u - x, v - y), cell) for cell, (u, v) in centres.items()):
            if away >= least - LENGTH_TOLERANCE:
                break
            routes = [] if exact else queries.to_point(self.start, centres[cell], 2, self.avoid)
            length = (
                queries.shortest_length(self.start, centres[cell], least)
                if exact
                else routes[0].length
                if routes
                else inf
            )
            if length < least - LENGTH_TOLERANCE:
                least, best, found = length, cell, routes[0] if routes else None
        if best < 0:
            return []
        route = queries.shortest(self.start, centres[best]) if exact else found
        return [] if route is None else [(route, self.region_of[best], best)]

    def to_representatives(self, k: int) -> list[SetRoute]:
        """Return routes to the representatives of all parts, cut where they enter the set, and then shortened.

        The representative of a part is its cell of greatest clearance. Each entry is (route, number of the part of the
        set, last cell); the routes stand part by part, not by length, and several may be of one class. Empty when no
        part can be reached. Points and lengths are in squares, clearances are nan and chains empty.

        Parameters
        ----------
        k : how many routes are wanted in the end; of each part at most k + EXTRA_PATHS are tried.
        """
        found: list[SetRoute] = []
        for region in self.regions:
            centre = self.queries.centre(region.cell)
            for route in self.queries.to_point(self.start, centre, k + EXTRA_PATHS, self.avoid):
                found.append(self.shortened(*self.cut_at_set(route, region)))
        return found

    def cut_at_set(self, route: Route, region: GoalRegion) -> tuple[Ints, int]:
        """Return the word of a route to a representative up to the first cell of the set, and that cell.

        The whole word, and the representative, are returned where the path from square to square, unlike the route,
        leads through a passage to avoid. A word is reduced when no symbol stands next to its negative. A portal is the
        overlap of two strips (rows of free squares) in neighbouring rows.

        Parameters
        ----------
        route : a route from the start to the representative of the part; its points alone count.
        region : the part of the set: its representative, and the vertex and steps of its cells.

        Returns
        -------
        word : (n,) int32, reduced: the signed portals (index plus 1, negative when crossed southwards) from the start's
            strip to that of the cell.
        cell : index in the flat padded grid, (row + 1) * width + column + 1.
        """
        strips, goal = self.layer.runs, self.queries.centre(region.cell)
        word = word_of_line(strips, route.points.tolist())
        cells = cells_of_word(self.layer, (*self.queries.snap(self.start), *goal), word)
        size = next(n for n, cell in enumerate(cells, 1) if cell in self.region_of)
        if self.barrier is not None and any(self.barrier.is_closed(*step) for step in pairwise(cells[:size])):
            return word, region.cell
        return join_words(word_of_cells(strips, cells[:size], self.width)), cells[size - 1]

    def shortened(self, word: Ints, cell: int) -> SetRoute:
        """Return the route of a word to a cell, with its end moved on within the set as long as that shortens it.

        The end moves from square to square, to the edge neighbour that shortens it most. Returned is (route, number of
        the part of the set, last cell); the route's points and length are in squares, its clearance is nan and its
        chains are empty. A word is reduced when no symbol stands next to its negative. A portal is the overlap of two
        strips (rows of free squares) in neighbouring rows.

        Parameters
        ----------
        word : the reduced word of signed portals (index plus 1, negative when crossed southwards) from the start to the
            cell.
        cell : a cell of the set, an index in the flat padded grid, (row + 1) * width + column + 1.
        """
        tight = self.to_cell(word, cell)
        while True:
            nearer = [self.moved_end(word, cell, step) for step in (1, self.width, -1, -self.width)]
            better = min((n for n in nearer if n is not None), key=lambda n: n[0].length, default=None)
            if better is None or better[0].length >= tight.length - LENGTH_TOLERANCE:
                return tight, self.region_of[cell], cell
            tight, word, cell = better

    def moved_end(self, word: Ints, cell: int, step: int) -> tuple[Route, Ints, int] | None:
        """Return the route, word and cell with the end moved by a step; None when the end may not move so.

        The route's points and length are in squares, its clearance is nan and its chains are empty; the word is
        reduced. The new cell must be in the set, and the step must not be cut. A word is reduced when no symbol stands
        next to its negative. A portal is the overlap of two strips (rows of free squares) in neighbouring rows.

        Parameters
        ----------
        word : the reduced word of signed portals (index plus 1, negative when crossed southwards) from the start to the
            cell.
        cell : the cell at which the route ends, an index in the flat padded grid, (row + 1) * width + column + 1.
        step : what is added to it: 1 east, width north, -1 west, -width south.
        """
        other = cell + step
        if other not in self.region_of or (self.barrier is not None and self.barrier.is_closed(cell, other)):
            return None
        longer = join_words(word, word_of_cells(self.layer.runs, [cell, other], self.width))
        return self.to_cell(longer, other), longer, other

    def to_cell(self, word: Ints, cell: int) -> Route:
        """Return the tight route from the start to the centre of a cell, of the class of a word.

        Its points (x, y), from the south-west corner of the screen, and its length are in squares, its signature names
        its class. Its clearance is nan and its chains are empty, since its path over the skeleton is not looked for. A
        chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells. A
        word is reduced when no symbol stands next to its negative. A portal is the overlap of two strips (rows of free
        squares) in neighbouring rows.

        Parameters
        ----------
        word : the reduced word of signed portals (index plus 1, negative when crossed southwards) from the start to the
            cell.
        cell : index in the flat padded grid, (row + 1) * width + column + 1.
        """
        end = self.queries.centre(cell)
        tight = tight_route(self.layer, (*self.queries.snap(self.start), *end), word, nan, ())
        return self.queries.with_ends(tight, self.start, end)
