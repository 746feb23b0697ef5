"""Rounds of a search: a chain is found and followed, what is to blame split, until one is free or none is left."""

from geometry.cspace.cell_tree import CellTree, leaf_at
from geometry.cspace.channel import REGION, ChannelSearch, find_chain
from geometry.cspace.local_planner import HopContext
from geometry.cspace.refine import HopSequence, follow
from geometry.kernels.jit import bare
from geometry.motion.cell_clearance import NearbyEdges

NONE, FOUND, MORE = 0, 1, 2


@bare
def pursue(
    tree: CellTree, scene: HopContext, region: NearbyEdges, hunt: ChannelSearch, way: HopSequence, nth: int, last: int
) -> tuple[int, int]:
    """Go on from the round `nth`, counted from 1, up to the round `last`: the outcome and the round it came to.

    FOUND: the way is free; NONE: no chain is left; MORE: neither, so far.
    """
    while True:
        length = next_chain(tree, scene, region, hunt, way, nth, False)
        if length == 0:
            return NONE, nth
        if follow(tree, scene, hunt.chain, length, hunt.seen[1] != 0, way) == 0:
            return FOUND, nth
        if nth >= last:
            return MORE, nth
        nth += 1


@bare
def next_chain(
    tree: CellTree, scene: HopContext, region: NearbyEdges, hunt: ChannelSearch, way: HopSequence, nth: int, dead: bool
) -> int:
    """The length of the chain of a round; 0 when there is none, dead: not even through cells given up."""
    start, goal = way.poses[0], way.goal
    first = leaf_at(tree, start[0], start[1], start[2])
    last = leaf_at(tree, goal[0], goal[1], goal[2]) if len(goal) > 0 else REGION
    if first < 0 or last == -1:
        return 0
    return find_chain(tree, scene.mover, scene.ground, region, hunt, first, last, nth, dead)
