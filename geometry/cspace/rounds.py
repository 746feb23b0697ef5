"""Rounds of a search: find a channel, follow it, split what is to blame, until one is free or none is left."""

from utak.geometry.cspace.cell_tree import CellTree, leaf_at
from utak.geometry.cspace.channel import REGION_GOAL, ChannelSearch, find_channel
from utak.geometry.cspace.local_planner import HopContext
from utak.geometry.cspace.refine import HopSequence, follow_channel
from utak.geometry.kernels.jit import bare
from utak.geometry.motion.cell_clearance import NearbyEdges

SEARCH_EXHAUSTED, SEARCH_FOUND, SEARCH_UNFINISHED = 0, 1, 2  # outcomes of run_rounds


@bare
def run_rounds(
    tree: CellTree,
    context: HopContext,
    region: NearbyEdges,
    search: ChannelSearch,
    hops: HopSequence,
    round_number: int,
    last_round: int,
) -> tuple[int, int]:
    """Run the rounds from `round_number`, counted from 1, to `last_round` at most."""
    while True:
        length = next_channel(tree, context, region, search, hops, False)
        if length == 0:
            return SEARCH_EXHAUSTED, round_number
        if follow_channel(tree, context, search.channel, length, search.seen[1] != 0, hops) == 0:
            return SEARCH_FOUND, round_number
        if round_number >= last_round:
            return SEARCH_UNFINISHED, round_number
        round_number += 1


@bare
def next_channel(
    tree: CellTree,
    context: HopContext,
    region: NearbyEdges,
    search: ChannelSearch,
    hops: HopSequence,
    through_given_up: bool,
) -> int:
    """Find the next channel; return its number of cells, 0 if there is none or an end is outside the tree of cells."""
    start, goal = hops.poses[0], hops.goal
    first = leaf_at(tree, start[0], start[1], start[2])
    last = leaf_at(tree, goal[0], goal[1], goal[2]) if len(goal) > 0 else REGION_GOAL
    if first < 0 or last == -1:
        return 0
    return find_channel(tree, context.body, context.nearby, region, search, first, last, through_given_up)
