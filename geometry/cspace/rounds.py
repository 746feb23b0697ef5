"""Rounds of a search: find a channel, follow it, split what is to blame, until one is free or none is left."""

from geometry.cspace.cell_tree import CellTree, leaf_at
from geometry.cspace.channel import REGION_GOAL, ChannelSearch, find_channel
from geometry.cspace.local_planner import HopContext
from geometry.cspace.refine import HopSequence, follow_channel
from geometry.kernels.jit import bare
from geometry.motion.cell_clearance import NearbyEdges

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
    """Run the rounds from `round_number`, counted from 1, to `last_round` at most.

    A round finds a channel (a chain of cells from start to goal), follows it and splits the cells to blame.

    Parameters
    ----------
    tree, search : the cells and the search among them; changed.
    context : the body among its obstacles.
    region : the complement of the goal region, as obstacles; not used for a goal pose.
    hops : start, goal and path; its poses are overwritten.
    round_number, last_round : number of the first round, counted from 1, and of the last one that is run.

    Returns
    -------
    The outcome, and the number of the round that it came in. SEARCH_FOUND (1) : the path in `hops` is free.
    SEARCH_EXHAUSTED (0) : no channel is left. SEARCH_UNFINISHED (2) : neither, so far.
    """
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
    """Find the next channel; return its number of cells, 0 if there is none or an end is outside the tree of cells.

    The cells are written to search.channel, the start's first.

    Parameters
    ----------
    tree, context : the cells, and the body among its obstacles.
    region : the complement of the goal region, as obstacles; not used for a goal pose.
    search : the search among the cells; changed.
    hops : start and goal are taken from it.
    through_given_up : whether the channel may run through cells given up.
    """
    start, goal = hops.poses[0], hops.goal
    first = leaf_at(tree, start[0], start[1], start[2])
    last = leaf_at(tree, goal[0], goal[1], goal[2]) if len(goal) > 0 else REGION_GOAL
    if first < 0 or last == -1:
        return 0
    return find_channel(tree, context.body, context.nearby, region, search, first, last, through_given_up)
