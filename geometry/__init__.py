"""Spatial reasoning: shapes, screens, skeletons, pathgraphs, ropes and rigid motion. Imports nothing else of Utak.

In reading order: ``distance`` (clearance), ``skeleton``, ``chains`` (the pathgraph in arrays), ``pathgraph`` (for
networkx), ``runs`` and ``rope`` (classes of paths and their tight ropes), ``ways``, ``search``, ``alternatives``
and ``itinerary`` (routes), ``passages`` and ``parts`` (necks and rooms), ``loops``, ``goals``, and ``screen``,
which brings all this together.
"""

from geometry.passages import Passage
from geometry.route import Route
from geometry.screen import Screen

__all__ = ["Passage", "Route", "Screen"]
