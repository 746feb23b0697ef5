"""Routes to the nearest of many squares: of every class that ends in a goal set, the shortest (see goal_sets.py)."""

from itertools import pairwise
from math import hypot, inf, nan

from geometry.homotopy.portals import join_words, word_of_line
from geometry.kernels.arrays import XY, Bools, Ints
from geometry.passages.necks import Passage
from geometry.routes.barrier import Barrier
from geometry.routes.goal_sets import GoalRegion, edge_cells, regions, word_of_cells
from geometry.routes.lifting import cells_of_word
from geometry.routes.queries import CLOSE, SPARE, LayerQueries
from geometry.routes.route import Route
from geometry.routes.tighten import tight_route


def routes_to_area(
    questions: LayerQueries, start: XY, goal: Bools, k: int, avoid: tuple[Passage, ...] = ()
) -> list[Route]:
    """Return at most so many routes to squares of a set, each the shortest of its class, shortest first.

    Parameters
    ----------
    goal : (rows, columns) bool. Squares in which the body cannot be count for nothing.
    """
    if not questions.admits(start):
        return []
    area = GoalArea(questions, start, goal, avoid)
    best: dict[tuple[int, ...], Route] = {}
    for route, number, cell in [*area.nearest(), *area.by_representatives(k)]:
        word = word_of_line(questions.layer.runs, route.points.tolist())
        key = (number, *area.places[number].class_of(word, cell))
        if key not in best or route.length < best[key].length - CLOSE:
            best[key] = route
    return [questions.lifted(route) for route in sorted(best.values(), key=lambda route: route.length)[:k]]


Ending = tuple[Route, int, int]  # a route, the number of the part of the set in which it ends, and the cell


class GoalArea:
    """A goal set and what is asked of it."""

    def __init__(self, questions: LayerQueries, start: XY, goal: Bools, avoid: tuple[Passage, ...]) -> None:
        self.questions, self.start, self.avoid = questions, start, avoid
        self.layer = questions.layer
        self.width: int = self.layer.square.shape[1]
        self.goal = goal & (self.layer.square[1:-1, 1:-1] >= questions.level)
        self.barrier: Barrier | None = questions.barrier(avoid) if avoid else None
        self.places: list[GoalRegion] = regions(self.layer.square, questions.level, self.layer.runs, goal)
        self.owner = {cell: number for number, place in enumerate(self.places) for cell in place.vertex}

    def nearest(self) -> list[Ending]:
        """Return the route to the nearest square of all, if there is one.

        Squares are asked in the order of their distances as the crow flies, as long as these are less than the best.
        """
        ask, (x, y) = self.questions, self.start
        exact = not self.avoid and not self.layer.body
        cells = edge_cells(self.layer.square, ask.level, self.goal, ask.cell(self.start))
        centres = {cell: ask.centre(cell) for cell in cells}
        least, best, found = inf, -1, None
        for away, cell in sorted((hypot(u - x, v - y), cell) for cell, (u, v) in centres.items()):
            if away >= least - CLOSE:
                break
            routes = [] if exact else ask.to_point(self.start, centres[cell], 2, self.avoid)
            length = ask.measure(self.start, centres[cell], least) if exact else routes[0].length if routes else inf
            if length < least - CLOSE:
                least, best, found = length, cell, routes[0] if routes else None
        if best < 0:
            return []
        route = ask.shortest(self.start, centres[best]) if exact else found
        return [] if route is None else [(route, self.owner[best], best)]

    def by_representatives(self, k: int) -> list[Ending]:
        """Return routes to the representatives of all parts, cut where they enter the set, and then shortened."""
        found: list[Ending] = []
        for place in self.places:
            centre = self.questions.centre(place.cell)
            for route in self.questions.to_point(self.start, centre, k + SPARE, self.avoid):
                found.append(self.shortened(*self.cut(route, place)))
        return found

    def cut(self, route: Route, place: GoalRegion) -> tuple[Ints, int]:
        """Return the word of a route to a representative up to the first cell of the set, and that cell.

        The whole of it where the way from square to square, unlike the route, leads through what is to be avoided.
        """
        runs, goal = self.layer.runs, self.questions.centre(place.cell)
        word = word_of_line(runs, route.points.tolist())
        cells = cells_of_word(self.layer, (*self.questions.snap(self.start), *goal), word)
        size = next(n for n, cell in enumerate(cells, 1) if cell in self.owner)
        if self.barrier is not None and any(self.barrier.is_shut(*step) for step in pairwise(cells[:size])):
            return word, place.cell
        return join_words(word_of_cells(runs, cells[:size], self.width)), cells[size - 1]

    def shortened(self, word: Ints, cell: int) -> Ending:
        """Return the route of a word to a cell with its end moved on within the set as long as that shortens it."""
        tight = self.to_cell(word, cell)
        while True:
            nearer = [self.beside(word, cell, step) for step in (1, self.width, -1, -self.width)]
            better = min((n for n in nearer if n is not None), key=lambda n: n[0].length, default=None)
            if better is None or better[0].length >= tight.length - CLOSE:
                return tight, self.owner[cell], cell
            tight, word, cell = better

    def beside(self, word: Ints, cell: int, step: int) -> tuple[Route, Ints, int] | None:
        """Return the route to the next square instead; None when that is not in the set or the step is cut."""
        other = cell + step
        if other not in self.owner or (self.barrier is not None and self.barrier.is_shut(cell, other)):
            return None
        longer = join_words(word, word_of_cells(self.layer.runs, [cell, other], self.width))
        return self.to_cell(longer, other), longer, other

    def to_cell(self, word: Ints, cell: int) -> Route:
        """Return the tight route of a word to the centre of a cell."""
        end = self.questions.centre(cell)
        tight = tight_route(self.layer, (*self.questions.snap(self.start), *end), word, nan, ())
        return self.questions.with_ends(tight, self.start, end)
