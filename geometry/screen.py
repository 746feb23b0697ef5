"""A screen: a grid of free and blocked squares, and what a point or a round body can do on it.

Building a screen measures all clearances and finds the skeleton and its graph. Everything else is computed when it is
first asked for, and kept: chains with their squares, and one layer of routing data for each radius.
"""

from collections.abc import Iterable, Sequence
from functools import cached_property
from numbers import Integral
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from utak.geometry.homotopy.portals import word_of_line
from utak.geometry.kernels.arrays import Bools, Labels
from utak.geometry.passages.narrow_stretches import narrow_squares
from utak.geometry.passages.necks import DOOR_RATIO, Passage, find_passages
from utak.geometry.passages.partition import find_parts
from utak.geometry.passages.walls import Walls, find_walls
from utak.geometry.raster.distance_transform import smallest_distance_type
from utak.geometry.routes.layer import Layer, build_layer, find_pathgraph, least_squared_clearance, new_state
from utak.geometry.routes.queries import LayerQueries
from utak.geometry.routes.route import Route
from utak.geometry.routes.tighten import word_of_crossings
from utak.geometry.skeleton.buffers import Tenant, take_buffers
from utak.geometry.skeleton.chains import Chains, find_chains
from utak.geometry.skeleton.graph import SkeletonGraph, contract
from utak.geometry.skeleton.pathgraph_arrays import PathgraphArrays, build_pathgraph_arrays
from utak.geometry.skeleton.skeleton import States, Words
from utak.geometry.skeleton.sweep import survey

if TYPE_CHECKING:
    import networkx

Point = Sequence[float]
MAX_SIDE = 32766  # squares: with its frame a column of them can be counted in 16 bits with a sign (derived)


class Screen:
    """Free space on a grid of squares.

    Points are (x, y) in squares, x to the east and y to the north, from the south-west corner; the square in column i
    and row j has its centre at (i + 0.5, j + 0.5). A point passes between squares that share an edge. It may touch the
    corners of blocked squares, but never passes between two blocked squares that touch at a corner.

    Parameters
    ----------
    free : (rows, columns) array of bool
        True where a point may be; row 0 is the southernmost. Everything outside is blocked. The array is copied.

    Attributes
    ----------
    shape : (int, int)
        Numbers of rows and columns.

    Raises
    ------
    ValueError
        When ``free`` is not a two-dimensional array of bool of at most 32766 squares a side with at least one free
        square.

    Examples
    --------
    Two routes lead around a blocked square, one on each side:

    >>> import numpy as np
    >>> free = np.ones((3, 5), dtype=bool)
    >>> free[1, 2] = False
    >>> [route.points.tolist() for route in Screen(free).routes((0.5, 1.5), (4.5, 1.5), k=2)]
    [[[0.5, 1.5], [2.0, 2.0], [3.0, 2.0], [4.5, 1.5]], [[0.5, 1.5], [2.0, 1.0], [3.0, 1.0], [4.5, 1.5]]]
    """

    def __init__(self, free: ArrayLike) -> None:
        grid = checked_grid(free)
        rows, columns = grid.shape
        self.shape = (rows, columns)
        self._rent(smallest_distance_type(grid))
        self._skeletons: dict[int, tuple[States, Words, SkeletonGraph]] = {1: self._survey(grid)}
        self._chains: dict[int, Chains] = {}
        self._layers: dict[tuple[int, bool], Layer] = {}
        self._questions: dict[float, LayerQueries] = {}

    @property
    def free(self) -> Bools:
        """The free squares: a new (rows, columns) array of bool, True where a point may be; row 0 in the south."""
        return self._square[1:-1, 1:-1] > 0

    @cached_property
    def clearance(self) -> NDArray[np.float64]:
        """The clearance of each square: (rows, columns) float64, in squares, row 0 in the south.

        The Euclidean distance from the centre of the square to the nearest point of a square that is not free,
        everything outside included; 0 on squares that are not free. Exact but for the rounding of one square root.

        Examples
        --------
        >>> import numpy as np
        >>> Screen(np.ones((3, 4), dtype=bool)).clearance.tolist()
        [[0.5, 0.5, 0.5, 0.5], [0.5, 1.5, 1.5, 0.5], [0.5, 0.5, 0.5, 0.5]]
        """
        return 0.5 * np.sqrt(self._square[1:-1, 1:-1], dtype=np.float64)

    @cached_property
    def skeleton(self) -> Bools:
        """The skeleton of the free squares: (rows, columns) bool, True on its squares, row 0 in the south.

        Thin, with as many edge-connected components and as many holes as the free squares. It follows the ridges of
        the clearance from each of its saddles up to the maxima.
        """
        from utak.geometry.skeleton.thinning import thin_skeleton

        return thin_skeleton(self._square, self._skeleton_at(1)[0])

    @cached_property
    def pathgraph(self) -> "networkx.MultiGraph[int]":
        """The pathgraph: an ordinary networkx.MultiGraph with the components and independent cycles of free space.

        Nodes are the junctions and ends of the skeleton, numbered from 0, with the attributes ``x``, ``y`` and
        ``clearance``. Edges are the chains between them, with ``length`` (of the polyline through their squares),
        ``clearance`` (the least on the chain) and ``points`` ((k, 2) float64, from one end to the other); the key of an
        edge is its number. All in squares, in the frame of the screen: x to the east, y to the north, (0, 0) at the
        south-west corner. ``pathgraph_arrays`` gives the same, sooner, without networkx.

        Examples
        --------
        >>> import numpy as np
        >>> free = np.ones((3, 3), dtype=bool)
        >>> free[1, 1] = False
        >>> graph = Screen(free).pathgraph
        >>> graph.nodes[0], graph.number_of_edges(), graph.edges[0, 0, 0]["length"]
        ({'x': 0.5, 'y': 0.5, 'clearance': 0.5}, 1, 8.0)
        """
        return self.pathgraph_for(0.0)

    def pathgraph_for(self, radius: float) -> "networkx.MultiGraph[int]":
        """Return the pathgraph of a round body.

        Parameters
        ----------
        radius : float
            Radius of the body, in squares.

        Returns
        -------
        networkx.MultiGraph
            As ``pathgraph`` (nodes with ``x``, ``y``, ``clearance``, edges with ``length``, ``clearance``, ``points``,
            all in squares), of the squares whose clearance is at least the radius; empty when there are none. A new
            graph at each call.

        Raises
        ------
        ValueError
            When the radius is negative or no finite number.
        """
        from utak.geometry.skeleton.networkx_export import networkx_graph

        return networkx_graph(self._new_arrays(radius))

    @cached_property
    def pathgraph_arrays(self) -> PathgraphArrays:
        """The pathgraph of a point as arrays: the network of lines midway between the walls.

        Nodes are its n junctions and ends, edges the m chains of squares between them, which have p squares in all. The
        arrays are ``nodes`` (n, 2) and ``node_clearances`` (n,), ``edges`` (m, 2), the nodes at both ends, ``lengths``
        and ``edge_clearances`` (m,), ``points`` (p, 2), edge by edge, of which those of edge e are ``offsets[e]`` to
        ``offsets[e + 1]``, ``narrowest`` (m,), a row of ``points``, and ``adjacency_offsets``, ``incident_edges`` and
        ``neighbours``, which list the edges at each node. Read-only; places (x, y), lengths and clearances in squares,
        in the frame of the screen: x to the east, y to the north, (0, 0) at the south-west corner. Made when first
        asked for, and kept.
        """
        return self.pathgraph_arrays_for(0.0)

    def pathgraph_arrays_for(self, radius: float) -> PathgraphArrays:
        """Return the pathgraph of a round body as arrays.

        Nodes are the junctions and ends of the skeleton (places and clearances), edges the chains of squares between
        them (end nodes, lengths, least clearances, points); further arrays tell which edges meet at each node.

        Parameters
        ----------
        radius : float
            Radius of the body, in squares.

        Returns
        -------
        PathgraphArrays
            Of the squares whose clearance is at least the radius: new, read-only arrays, of no rows when there is no
            such square. Coordinates (x, y) are from the screen's south-west corner, y to the north. Coordinates,
            lengths and clearances are in squares; the radius is not taken off the clearances. The points of edge e are
            ``points[offsets[e]:offsets[e + 1]]``, the edges at node v
            ``incident_edges[adjacency_offsets[v]:adjacency_offsets[v + 1]]``; see `PathgraphArrays`.

        Raises
        ------
        ValueError
            When the radius is negative or no finite number.
        """
        arrays = self._new_arrays(radius)
        for array in arrays:
            array.flags.writeable = False
        return arrays

    def _new_arrays(self, radius: float) -> PathgraphArrays:
        """Return the pathgraph of a body of that radius (squares; 0 for a point) in new, writable arrays."""
        # Raises ValueError when the radius is negative or no finite number.
        state, _, bones = self._skeleton_at(least_squared_clearance(radius))
        return build_pathgraph_arrays(self._square, state, bones)

    def routes(
        self,
        start: Point,
        goal: Point,
        k: int = 3,
        radius: float = 0.0,
        avoid: Iterable[Passage] = (),
        word: Sequence[int] | None = None,
    ) -> list[Route]:
        """Return topologically distinct routes, each the shortest of its class, the shortest first.

        Two routes are of one class when one can be deformed into the other over free space with its ends fixed.

        Parameters
        ----------
        start, goal : (x, y)
            Where every route begins and ends, in squares from the south-west corner of the screen.
        k : int
            How many routes at most. Their paths over the pathgraph pass no junction twice. Only the shortest of all,
            which for ``k`` of 2 or more comes first, may be of another class.
        radius : float
            Radius of a round body about the point, in squares. It moves from centre to centre of squares whose
            clearance is at least the radius, and straight between start or goal and the centre of its square. There
            is no route when start or goal have no room for that.
        avoid : iterable of Passage
            Passages through which routes must not lead: there are routes exactly between squares of one part of
            ``parts(avoid)``.
        word : sequence of int, optional
            A signature: the signed crossing numbers of a route of this screen and radius, in order (see ``Route``).
            Only the route of this class is returned, however it winds; ``k`` and ``avoid`` do not count.

        Returns
        -------
        list of Route
            Empty when there is no route. Each has ``points`` ((n, 2) corners (x, y) from start to goal, squares, frame
            of the screen), ``length`` and ``clearance`` in squares, ``signature`` (the crossing numbers that name its
            class) and ``chains`` (numbers of the edges of the pathgraph that it follows).

        Raises
        ------
        ValueError
            When a point lies outside the screen or in a blocked square, when the word is not one of this screen, ``k``
            no positive whole number, or the radius negative or not finite.

        Examples
        --------
        >>> import numpy as np
        >>> free = np.ones((5, 7), dtype=bool)
        >>> free[2, 3] = False
        >>> screen = Screen(free)
        >>> [round(route.length, 3) for route in screen.routes((0.5, 2.5), (6.5, 2.5), k=2)]
        [6.099, 6.099]
        >>> screen.routes((1.5, 2.5), (5.5, 2.5), k=1, radius=1.0)
        []
        """
        check_count(k)
        questions = self._ask(radius)
        begin, end = self._checked(start, "start"), self._checked(goal, "goal")
        if not (questions.admits(begin) and questions.admits(end)):
            return []
        if word is None:
            return questions.to_point(begin, end, k, tuple(avoid))
        symbols = word_of_crossings(questions.layer.runs, (*begin, *end), word)
        return [] if symbols is None else [questions.of_word(begin, end, symbols)]

    def shortest(self, start: Point, goal: Point) -> Route | None:
        """Return the shortest route of all for a point, at any angle.

        Found exactly, without the pathgraph (Polyanya: Cui, Harabor and Grastien 2017).

        Parameters
        ----------
        start, goal : (x, y)
            Its ends, in squares from the south-west corner of the screen.

        Returns
        -------
        Route or None
            None when there is no route. Its ``points``, corners (x, y) from start to goal in the frame of the screen,
            and its ``length`` are in squares; its ``signature`` names its class. Of several as short one is returned.
            The ``clearance`` of the route is nan and its ``chains`` are empty; ``tighten`` finds both.

        Raises
        ------
        ValueError
            When a point lies outside the screen or in a blocked square.
        """
        begin, end = self._checked(start, "start"), self._checked(goal, "goal")
        return self._ask(0.0).shortest(begin, end)

    def tighten(self, route: Route, radius: float = 0.0) -> Route:
        """Return the shortest route of the same class (all that can be deformed into it), between the same ends.

        Parameters
        ----------
        route : Route
            Any polyline over free space; only its ``points`` count, (x, y) in squares in the frame of this screen.
        radius : float
            Radius of a round body, in squares: it moves from centre to centre of squares whose
            clearance is at least the radius. 0 for a point.

        Returns
        -------
        Route
            New: ``points``, corners (x, y) in squares in the frame of this screen, ``length`` and ``clearance`` in
            squares (the radius is not taken off the clearance), ``signature`` (tuple of int that names the class:
            portals crossed from start to goal, negative southwards) and ``chains`` (tuple of int: numbers of the
            pathgraph's edges, in order).

        Raises
        ------
        ValueError
            When the route leaves free space (of a body: the squares whose clearance is at least the radius), or the
            radius is negative or not finite.
        """
        questions = self._ask(radius)
        word = word_of_line(questions.layer.runs, route.points.tolist())
        start, goal = (self._checked(route.points[k].tolist(), "the route's end") for k in (0, -1))
        return questions.of_word(start, goal, word)

    def passages(self, pinch: float = DOOR_RATIO) -> list[Passage]:
        """Return the necks of free space, ordered by place: by row from the south, then by column from the west.

        A neck is a straight line from wall to wall that is shorter than all near it.

        Parameters
        ----------
        pinch : float
            Only necks on both sides of which the floor is at least so many times as wide; more than 1. The default, 2,
            is the definition of a door.

        Returns
        -------
        list of Passage
            All measures and places in squares, in the frame of the screen; empty when there is none. Each has its
            ``width``, the greatest clearance on either side (``sides``), the lines from wall to wall where it opens
            (``mouths``), a free square's centre beyond each (``gates``), and the squares ``between`` the mouths.
        """
        return find_passages(self._walls, pinch)

    def narrows(self, passage: Passage, spare: float) -> set[tuple[int, int]]:
        """Return the squares around a passage where the floor is nearly as narrow as there.

        Parameters
        ----------
        passage : Passage
            One of ``passages()`` of this screen; for another the set is empty or means nothing.
        spare : float
            How much longer than the width of the passage a line from wall to wall may be, in squares; 0 or more.

        Returns
        -------
        set of (column, row)
            Squares of which a part lies between two such lines, as far as these follow each other without a gap from
            the passage on; empty when no second line is near. Row 0 is in the south.
        """
        return narrow_squares(self._walls, passage, spare)

    @cached_property
    def _walls(self) -> Walls:
        """The floor as triangles between the corners of its walls, found when it is first asked for."""
        return find_walls(self.free)

    def parts(self, passages: Iterable[Passage]) -> Labels:
        """Return the parts of the floor when it is cut along the mouths of passages.

        A mouth is the straight line from wall to wall where a passage opens to one side.

        Parameters
        ----------
        passages : iterable of Passage
            Mostly some of ``passages()``, in the frame of the screen; their ``mouths`` are the cuts. Without any, parts
            are the components by shared edges.

        Returns
        -------
        (rows, columns) array of int32
            The number of the part of each square, from 1 in the order of the parts' first squares (row by row from the
            south). 0 on blocked squares, on squares whose centre lies on a mouth, and on the floor between the two
            mouths of a passage with all that can be reached from there alone.
        """
        return find_parts(self.free, passages)

    def _checked(self, point: Point, name: str) -> tuple[float, float]:
        """Return a point as two floats; raise ValueError when it is no (x, y) in a free square of the screen."""
        try:
            x, y = map(float, point)
        except (TypeError, ValueError):
            raise ValueError(f"{name} must be a point (x, y), not {point!r}") from None
        if not (0.0 <= x <= self.shape[1] and 0.0 <= y <= self.shape[0]):
            raise ValueError(f"{name} ({x}, {y}) lies outside the screen of {self.shape[1]} x {self.shape[0]} squares")
        if self._square.item(int(y) + 1, int(x) + 1) == 0:
            raise ValueError(f"{name} ({x}, {y}) lies in a blocked square")
        return x, y

    def _rent(self, kind: type[np.int16] | type[np.int32]) -> None:
        """Take memory for squared clearances of that type of integers, and for the states of the skeleton."""
        self._tenant = Tenant()
        self._square, self._words = take_buffers(self._tenant, (self.shape[0] + 2, self.shape[1] + 2), kind)

    def _survey(self, grid: Bools) -> tuple[States, Words, SkeletonGraph]:
        """Measure all clearances of free squares; return the skeleton (twice: by cells, by words) and its graph."""
        state, words = new_state(self._square.shape, self._words)
        survey(grid, self._square, state, words)
        return state, words, contract(self._square, state, words)

    def _skeleton_at(self, level: int) -> tuple[States, Words, SkeletonGraph]:
        """Return the skeleton and graph of the squares whose squared clearance is at least ``level``; keep them."""
        found = self._skeletons.get(level)
        if found is None:
            state, words = new_state(self._square.shape)
            found = state, words, find_pathgraph(self._square, level, state, words)
            self._skeletons[level] = found
        return found

    def _chains_at(self, level: int) -> Chains:
        """Return the graph of that level with the cells of its chains (flat indices, padded); keep it."""
        found = self._chains.get(level)
        if found is None:
            state, _, bones = self._skeleton_at(level)
            found = self._chains[level] = find_chains(bones, state)
        return found

    def _ask(self, radius: float) -> LayerQueries:
        """Return the object that answers questions for a body of that radius (squares; 0 for a point); keep it."""
        # Raises ValueError when the radius is negative or no finite number.
        found = self._questions.get(radius)
        if found is None:
            key = least_squared_clearance(radius), radius > 0.0
            if key not in self._layers:
                state, chains = self._skeleton_at(key[0])[0], self._chains_at(key[0])
                self._layers[key] = build_layer(self._square, key[0], key[1], state, chains)
            found = self._questions[radius] = LayerQueries(self._layers[key], key[0], radius)
        return found


def checked_grid(free: ArrayLike) -> Bools:
    """Return the free squares as a (rows, columns) array of bool; raise ValueError when they are none."""
    grid = np.asarray(free)
    if grid.ndim != 2:
        raise ValueError(f"free must have two dimensions (rows, columns), not {grid.ndim}")
    if grid.dtype != np.bool_:
        raise ValueError(f"free must be an array of bool, not of {grid.dtype}")
    if max(grid.shape) > MAX_SIDE:
        raise ValueError(f"free must not be larger than {MAX_SIDE} squares a side, not {grid.shape}")
    if not grid.any():
        raise ValueError("free has no free square")
    return grid


def check_count(k: int) -> None:
    """Raise ValueError unless k is a positive whole number (of Python or numpy); return nothing."""
    if not isinstance(k, Integral) or k < 1:
        raise ValueError(f"k must be a whole number and at least 1, but is {k!r}")
