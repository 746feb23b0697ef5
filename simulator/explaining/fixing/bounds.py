"""Proofs by geometry alone: that no run can succeed, and that a thing cannot pass a gap.

The robot, and all that can be moved beside the thing in question, are left out: what is impossible without them is
impossible with them.
"""

from typing import Any

import shapely
from shapely import affinity

from utak.geometry.cspace.plan_motion import Inside, plan_motion
from utak.geometry.motion.se2 import Pose
from utak.simulator.explaining.fixing.gaps import Gap, floor_of, solid_of
from utak.simulator.scenario.expectation import grown_region
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.world.physics import table_edge
from utak.simulator.world.world import Thing, World

GAP_MARGIN = 1e-6  # squares by which a gap is closed on paper; below what the physics resolves
# Relative resolution and cells of a proof: enough for widths that differ by a step; what is not decided is run instead.
PROOF_RESOLUTION, PROOF_CELLS = 1e-3, 20_000
MIN_SIDE_AREA = 1.0  # square squares; smaller parts of the floor are no side of a gap; a convention


def refutation(scenario: Scenario) -> str:
    """Return the expectation `inside(T, Region)` of a thing that no motion fulfils, as text; "" when there is none."""
    things = {thing.name: thing for thing in scenario.world.movable}
    for fact in scenario.expectations or ():
        thing = things.get(str(fact.args[0])) if fact.name == "inside" else None
        if thing is not None and _cannot_come(scenario.world, thing, grown_region(fact)):
            return str(fact)
    return ""


def cannot_pass(before: World, world: World, gap: Gap, thing: Thing) -> bool:
    """Return whether a thing cannot be brought to the other side of a gap."""
    wall = shapely.from_wkt(gap.wall)
    closed = floor_of(before).difference(wall.buffer(GAP_MARGIN))
    parts = [part for part in shapely.get_parts(closed) if part.area >= MIN_SIDE_AREA]
    here = [part for part in parts if part.buffer(GAP_MARGIN).covers(thing.polygon)]
    if len(here) != 1 or here[0].distance(wall) > 2 * GAP_MARGIN or len(parts) < 2:
        return False
    return _cannot_come(world, thing, floor_of(world).difference(here[0].buffer(GAP_MARGIN)))


def _cannot_come(world: World, thing: Thing, region: Any) -> bool:
    """Return whether it is proved that a thing cannot be brought into a region, (multi)polygon in the table frame."""
    middle = thing.polygon.centroid
    body = affinity.translate(thing.polygon, -middle.x, -middle.y)
    inside = Inside([part for part in shapely.get_parts(region) if part.geom_type == "Polygon"])
    obstacles = shapely.union_all([solid_of(world), table_edge(world.width, world.height)])
    bounds = (0.0, 0.0, float(world.width), float(world.height))
    start = Pose(middle.x, middle.y, 0.0)
    plan = plan_motion(body, obstacles, start, inside, bounds, PROOF_RESOLUTION, cells=PROOF_CELLS)
    return plan.status == "impossible"
