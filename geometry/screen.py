"""A screen: a grid of free and blocked squares, and what a point can do on it.

Building a screen measures all clearances and finds the skeleton and its graph. Everything else is computed when it is
first asked for, and kept: chains with their squares, and the layer of routing data.
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
from utak.geometry.routes.layer import build_layer
from utak.geometry.routes.queries import LayerQueries
from utak.geometry.routes.route import Route
from utak.geometry.skeleton.buffers import Tenant, take_buffers
from utak.geometry.skeleton.chains import find_chains
from utak.geometry.skeleton.graph import contract
from utak.geometry.skeleton.pathgraph_arrays import PathgraphArrays, build_pathgraph_arrays
from utak.geometry.skeleton.sweep import new_state, survey

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
        self._tenant = Tenant()
        padded = rows + 2, columns + 2
        self._square, memory = take_buffers(self._tenant, padded, smallest_distance_type(grid))
        state, words = new_state(padded, memory)
        survey(grid, self._square, state, words)
        self._bones = state, words, contract(self._square, state, words)

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

        return thin_skeleton(self._square, self._bones[0])

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
        from utak.geometry.skeleton.networkx_export import networkx_graph

        return networkx_graph(self._new_arrays())

    @cached_property
    def pathgraph_arrays(self) -> PathgraphArrays:
        """The pathgraph as arrays: the network of lines midway between the walls.

        Nodes are its n junctions and ends, edges the m chains of squares between them, which have p squares in all. The
        arrays are ``nodes`` (n, 2) and ``node_clearances`` (n,), ``edges`` (m, 2), the nodes at both ends, ``lengths``
        and ``edge_clearances`` (m,), ``points`` (p, 2), edge by edge, of which those of edge e are ``offsets[e]`` to
        ``offsets[e + 1]``. Read-only; places (x, y), lengths and clearances in squares, in the frame of the screen: x
        to the east, y to the north, (0, 0) at the south-west corner. Made when first asked for, and kept.
        """
        arrays = self._new_arrays()
        for array in arrays:
            array.flags.writeable = False
        return arrays

    def _new_arrays(self) -> PathgraphArrays:
        """Return the pathgraph in new, writable arrays."""
        return build_pathgraph_arrays(self._square, self._bones[0], self._bones[2])

    def routes(self, start: Point, goal: Point, k: int = 3) -> list[Route]:
        """Return topologically distinct routes, each the shortest of its class, the shortest first.

        Two routes are of one class when one can be deformed into the other over free space with its ends fixed.

        Parameters
        ----------
        start, goal : (x, y)
            Where every route begins and ends, in squares from the south-west corner of the screen.
        k : int
            How many routes at most. Their paths over the pathgraph pass no junction twice. Only the shortest of all,
            which for ``k`` of 2 or more comes first, may be of another class.

        Returns
        -------
        list of Route
            Empty when there is no route. Each has ``points`` ((n, 2) corners (x, y) from start to goal, squares, frame
            of the screen), ``length`` and ``clearance`` in squares, ``signature`` (the crossing numbers that name its
            class) and ``chains`` (numbers of the edges of the pathgraph that it follows).

        Raises
        ------
        ValueError
            When a point lies outside the screen or in a blocked square, or ``k`` is no positive whole number.

        Examples
        --------
        >>> import numpy as np
        >>> free = np.ones((5, 7), dtype=bool)
        >>> free[2, 3] = False
        >>> screen = Screen(free)
        >>> [round(route.length, 3) for route in screen.routes((0.5, 2.5), (6.5, 2.5), k=2)]
        [6.099, 6.099]
        """
        check_count(k)
        return self._queries.to_point(self._checked(start, "start"), self._checked(goal, "goal"), k)

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
        return self._queries.shortest(begin, end)

    def tighten(self, route: Route) -> Route:
        """Return the shortest route of the same class (all that can be deformed into it), between the same ends.

        Parameters
        ----------
        route : Route
            Any polyline over free space; only its ``points`` count, (x, y) in squares in the frame of this screen.

        Returns
        -------
        Route
            New: ``points``, corners (x, y) in squares in the frame of this screen, ``length`` and ``clearance`` in
            squares, ``signature`` (tuple of int that names the class: portals crossed from start to goal, negative
            southwards) and ``chains`` (tuple of int: numbers of the pathgraph's edges, in order).

        Raises
        ------
        ValueError
            When the route leaves free space.
        """
        word = word_of_line(self._queries.layer.strips, route.points.tolist())
        start, goal = (self._checked(route.points[k].tolist(), "the route's end") for k in (0, -1))
        return self._queries.of_word(start, goal, word)

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

    @cached_property
    def _queries(self) -> LayerQueries:
        """The object that answers questions about routes, with all that it reads."""
        state, _, bones = self._bones
        return LayerQueries(build_layer(self._square, state, find_chains(bones, state)))


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
