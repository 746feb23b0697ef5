"""Spatial reasoning: shapes, screens, skeletons, pathgraphs, ropes and rigid motion. Imports nothing else of Utak.

In reading order: ``distance`` (clearance), ``skeleton``, ``chains`` (the pathgraph in arrays), ``pathgraph`` (for
networkx), ``runs`` and ``rope`` (classes of paths and their tight ropes), ``ways``, ``search``, ``alternatives``
and ``itinerary`` (routes), ``passages`` and ``parts`` (necks and rooms), ``loops``, ``goals``, and ``screen``,
which brings all this together. Then ``digital`` (images of shapes) and ``template`` (shapes of images), ``rigid`` and
``contact`` (motions and what stops them), ``floor``, ``problem`` and ``motion`` (how a body can be moved), and
``carrying`` (how Utak brings it there).
"""

from geometry.cspace.plan_motion import Inside, MotionPlan, plan_motion
from geometry.motion.se2 import Pose, Rotate, Translate
from geometry.passages.necks import Passage
from geometry.routes.route import Route
from geometry.screen import Screen

__all__ = ["Inside", "MotionPlan", "Passage", "Pose", "Rotate", "Route", "Screen", "Translate", "plan_motion"]
