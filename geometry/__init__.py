"""Spatial reasoning: rasters, skeletons, routes, rigid motion and manipulation. Imports nothing else of Utak.

Points are (x, y) in squares, table frame; the centre of square (i, j) is (i + 0.5, j + 0.5). Rasters are indexed
[row, column], row 0 in the south. Angles are in degrees, counter-clockwise positive.

Rooms in reading order:

    screen           the entry for routes: a raster of free squares, and all that is computed of it
    kernels          compiled loops (numba), heaps, queues, types of arrays
    raster           what shapes cover, distance transforms, components, contours, lines of sight
    skeleton         the thin, connected middle of free space, and the pathgraph on it
    homotopy         classes of paths: strips, landmarks, and the shortest path of a class (funnel)
    routes           topologically distinct routes, shortest first
    pathfinders      other path-finders for comparison: any-angle search, visibility graph, grid A*
    passages         necks between walls, and the partition of free space into rooms
    motion           poses, rigid motions, exact first contact
    cspace           motion planning of a polygon among polygons: ``plan_motion``
    state_lattice    carrying by whole squares and quarter turns
    manipulation     plans of carrying: walks, grasps, pushes and turns
    counts           what counts in windows say of single squares
    shapes           shapes that fit the squares seen
    io               maps of Moving AI, pictures as SVG

Public names: ``Screen`` and ``Route`` (routes), ``Passage``; ``plan_motion``, ``MotionPlan``, ``Inside``; ``Pose``,
``Translate``, ``Rotate``.
"""

from utak.geometry.cspace.plan_motion import Inside, MotionPlan, plan_motion
from utak.geometry.motion.se2 import Pose, Rotate, Translate
from utak.geometry.passages.necks import Passage
from utak.geometry.routes.route import Route
from utak.geometry.screen import Screen

__all__ = ["Inside", "MotionPlan", "Passage", "Pose", "Rotate", "Route", "Screen", "Translate", "plan_motion"]
