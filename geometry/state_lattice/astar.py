"""The cheapest path of carrying on the state lattice: pushes, quarter and half turns, letting go, grasping again.

# Strategy: A* over nodes (hold, quarter turn, direction being pushed in, place), with the heuristic module for the cost
to go. Walking round the body is costly to compute and seldom wanted: letting go is first queued at its least cost, and
the walk is measured only when that comes to the head of the queue. The floor about a pose is walked once from each
side. Ties are broken by node number: the same question has the same answer. Of millions of nodes a search comes to some
hundreds, mostly, so they are kept in a hash table with open addressing (Knuth 1973, section 6.4).
"""

import heapq
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Longs
from utak.geometry.kernels.jit import compiled
from utak.geometry.state_lattice.heuristic import COST_UNREACHABLE, NO_DIRECTION
from utak.geometry.state_lattice.lattice import (
    COMMAND_COST,
    REGRASP_COST,
    WALK_COST,
    Costs,
    StateLattice,
    place_after_turn,
    turn_cost,
)

ADMISSIBLE_WEIGHT = 4  # the weight of the heuristic, in quarters, with which A* finds the cheapest path
FIRST_CAPACITY = 4096  # slots of an empty table of nodes, a power of two; a convention
HASH_MULTIPLIER, HASH_SHIFT = 2654435769, 16  # multiplicative hashing: 2^32 by the golden ratio (Knuth 1973)
MOST_SUCCESSORS = 16  # nodes to which one step leads: eight pushes, or pushes on and the end of a push, and four turns


class Opened(NamedTuple):
    """The nodes that a search has come to, in slots by their numbers, at most half of them taken."""

    node: Longs  # (slots,) int64, the node in each slot; -1 for none. There are a power of two of them.
    cost: Costs  # (slots,) int32, the least cost at which it was come to
    parent: Longs  # (slots,) int64, the node before it then; -1 for a first grasp
    number: Longs  # (1,) int64, how many slots are taken


@compiled
def find_carrying_path(
    lattice: StateLattice,
    remaining: Costs,
    end_costs: Costs,
    grasp_costs: Costs,
    place: int,
    redirect_cost: int,
    weight: int,
    max_settled: int,
) -> Longs:
    """Return the nodes of the cheapest path from the first grasp to the goal, in order; empty if there is none."""
    squares, holds = end_costs.shape[1], len(grasp_costs)
    total = 36 * holds * squares
    opened = _new_table(FIRST_CAPACITY)  # `total` is added to nodes that have been walked to or from
    walk_cost, seen = np.empty(holds, np.int32), np.zeros(squares, np.int32)
    successor, step_cost = np.empty(MOST_SUCCESSORS, np.int64), np.empty(MOST_SUCCESSORS, np.int64)
    final, final_cost = -1, COST_UNREACHABLE
    heap = [(0, 0, 0)]
    heap.pop()
    opened = _with_room(opened, holds)
    for hold in range(holds):
        if grasp_costs[hold] >= 0 and remaining[0, NO_DIRECTION, place] < COST_UNREACHABLE:
            node = (hold * 36 + NO_DIRECTION) * squares + place
            _come_to(opened, node, grasp_costs[hold], -1)
            heapq.heappush(
                heap,
                (
                    grasp_costs[hold] + remaining[0, NO_DIRECTION, place] * weight // ADMISSIBLE_WEIGHT,
                    -grasp_costs[hold],
                    node,
                ),
            )
    settled = 0
    while len(heap) > 0 and settled < max_settled:
        whole, minus, node = heapq.heappop(heap)
        if whole >= final_cost:
            break
        letting_go = node >= total
        node -= total if letting_go else 0
        spent = opened.cost[_slot_of(opened, node)]
        if -minus != spent:
            continue
        settled += 1
        opened = _with_room(opened, 2 * holds + MOST_SUCCESSORS)
        p, m, k, hold = node % squares, node // squares % 9, node // squares // 9 % 4, node // squares // 36
        if letting_go:
            if opened.node[_slot_of(opened, node + total)] >= 0:
                continue
            _write_walk_costs(lattice, hold, k, p, walk_cost, seen, settled)
            for other in range(holds):
                if walk_cost[other] >= 0:
                    after = ((other * 4 + k) * 9 + NO_DIRECTION) * squares + p
                    _come_to(opened, after + total, 0, -1)
                    then = spent + REGRASP_COST + walk_cost[other] + lattice.grasp_cost[other]
                    if _come_to(opened, after, then, node):
                        heapq.heappush(
                            heap, (then + remaining[k, NO_DIRECTION, p] * weight // ADMISSIBLE_WEIGHT, -then, after)
                        )
            continue
        if m == NO_DIRECTION:
            if end_costs[k, p] >= 0 and spent + end_costs[k, p] < final_cost:
                final, final_cost = node, spent + end_costs[k, p]
            ahead = remaining[k, NO_DIRECTION, p] * weight // ADMISSIBLE_WEIGHT
            heapq.heappush(heap, (spent + REGRASP_COST + COMMAND_COST + ahead, -spent, node + total))
        count = _write_successors(lattice, hold, k, m, p, redirect_cost, successor, step_cost)
        for n in range(count):
            after, then = successor[n], spent + step_cost[n]
            ahead = remaining[after // squares // 9 % 4, after // squares % 9, after % squares]
            if ahead < COST_UNREACHABLE and _come_to(opened, after, then, node):
                heapq.heappush(heap, (then + ahead * weight // ADMISSIBLE_WEIGHT, -then, after))
    return _path_to(opened, final)


@compiled
def _new_table(slots: int) -> Opened:
    """Return a table without nodes."""
    number = np.zeros(1, np.int64)
    return Opened(np.full(slots, -1, np.int64), np.empty(slots, np.int32), np.empty(slots, np.int64), number)


@compiled
def _with_room(opened: Opened, more: int) -> Opened:
    """Return a table of the same nodes in which there is room for some more: the same one where it has room."""
    slots = len(opened.node)
    while 2 * (opened.number[0] + more) > slots:
        slots *= 2
    if slots == len(opened.node):
        return opened
    larger = _new_table(slots)
    for slot in range(len(opened.node)):
        if opened.node[slot] >= 0:
            _come_to(larger, opened.node[slot], opened.cost[slot], opened.parent[slot])
    return larger


@compiled
def _slot_of(opened: Opened, node: int) -> int:
    """Return the slot in which a node lies, or would lie."""
    last = len(opened.node) - 1
    slot = (node * HASH_MULTIPLIER >> HASH_SHIFT) & last
    while opened.node[slot] != node and opened.node[slot] >= 0:
        slot = (slot + 1) & last
    return slot


@compiled
def _come_to(opened: Opened, node: int, cost: int, parent: int) -> bool:
    """Note that a search came to a node; return False, and change nothing, where it did at no greater cost before."""
    slot = _slot_of(opened, node)
    known = opened.node[slot] >= 0
    if known and opened.cost[slot] <= cost:
        return False
    opened.node[slot], opened.cost[slot], opened.parent[slot] = node, cost, parent
    opened.number[0] += 0 if known else 1
    return True


@compiled
def _path_to(opened: Opened, final: int) -> Longs:
    """Return the nodes that lead to `final`, in order, itself the last: (n,) int64; empty if it is -1."""
    nodes = [final]
    nodes.pop()
    node = final
    while node >= 0:
        nodes.append(node)
        node = opened.parent[_slot_of(opened, node)]
    return np.array(nodes[::-1], np.int64)


@compiled
def _write_successors(
    lattice: StateLattice, hold: int, k: int, m: int, p: int, redirect_cost: int, successor: Longs, step_cost: Longs
) -> int:
    """Write the nodes to which one step with the body in hand leads, and their costs; return how many."""
    squares = len(lattice.solid)
    base = (hold * 4 + k) * 9
    robot = p + lattice.holds[k, hold]
    if m < NO_DIRECTION:
        successor[0], step_cost[0] = (base + NO_DIRECTION) * squares + p, 0
        count = 1
        for d in range(8):
            if d != m and (redirect_cost == COMMAND_COST or not lattice.push_allowed[k, hold, d]):
                continue
            if lattice.push_cost[k, d, p] > 0 and lattice.robot_can_step[d, robot]:
                successor[count] = (base + d) * squares + p + lattice.steps[d]
                step_cost[count] = lattice.push_cost[k, d, p] + (redirect_cost if d != m else 0)
                count += 1
        return count
    count = 0
    for d in range(8):
        if lattice.push_allowed[k, hold, d] and lattice.push_cost[k, d, p] > 0 and lattice.robot_can_step[d, robot]:
            successor[count] = (base + d) * squares + p + lattice.steps[d]
            step_cost[count] = COMMAND_COST + lattice.push_cost[k, d, p]
            count += 1
    for sense in (1, -1):
        extra = turn_cost(lattice, hold, k, p, sense)
        if extra < 0:
            continue
        p1, k1 = place_after_turn(lattice, hold, k, p, sense), (k + sense) % 4
        successor[count], step_cost[count] = (
            ((hold * 4 + k1) * 9 + NO_DIRECTION) * squares + p1,
            lattice.turn_price + extra,
        )
        count += 1
        more = turn_cost(lattice, hold, k1, p1, sense)
        if more >= 0:
            p2, k2 = place_after_turn(lattice, hold, k1, p1, sense), (k + 2) % 4
            successor[count] = ((hold * 4 + k2) * 9 + NO_DIRECTION) * squares + p2
            step_cost[count] = lattice.turn_price + max(extra, more)
            count += 1
    return count


@compiled
def _write_walk_costs(
    lattice: StateLattice, hold: int, k: int, p: int, walk_cost: Costs, seen: Costs, mark: int
) -> None:
    """Write the cost of walking from a hold to each of the others while the body lies; -1 without a path."""
    for n in range(lattice.covered.first[k], lattice.covered.first[k + 1]):
        seen[p + lattice.covered.items[n]] = mark
    _flood_walk_costs(lattice, p + lattice.holds[k], p + lattice.holds[k, hold], walk_cost, seen, mark)


@compiled
def _flood_walk_costs(
    lattice: StateLattice, targets: Longs, start: int, walk_cost: Costs, seen: Costs, mark: int
) -> None:
    """Write the cost of walking from a square to each of the targets. Squares whose `seen` equals `mark` are closed."""
    waiting = 0
    for n in range(len(targets)):
        walk_cost[n] = -1
        waiting += 1 if lattice.grasp_cost[n] >= 0 and lattice.walkable[targets[n]] and seen[targets[n]] != mark else 0
    stride = lattice.steps[2]
    queue = [start]
    seen[start] = mark
    steps_walked, head = 0, 0
    while head < len(queue) and waiting > 0:
        tail = len(queue)
        for n in range(head, tail):
            here = queue[n]
            for h in range(len(targets)):
                if targets[h] == here and lattice.grasp_cost[h] >= 0 and not lattice.solid[here]:
                    walk_cost[h] = steps_walked * WALK_COST + (COMMAND_COST if steps_walked > 0 else 0)
                    waiting -= 1
            for step in (1, stride, -1, -stride):
                if lattice.walkable[here + step] and seen[here + step] != mark:
                    seen[here + step] = mark
                    queue.append(here + step)
        head, steps_walked = tail, steps_walked + 1


@compiled
def costs_to_first_grasp(lattice: StateLattice, place: int, start: int) -> Costs:
    """Return the cost of walking from square `start` to each hold of the body as it lies, and grasping it."""
    grasp_costs, seen = np.empty(len(lattice.grasp_cost), np.int32), np.zeros(len(lattice.solid), np.int32)
    for n in range(lattice.covered.first[0], lattice.covered.first[1]):
        seen[place + lattice.covered.items[n]] = 1
    _flood_walk_costs(lattice, place + lattice.holds[0], start, grasp_costs, seen, 1)
    for n in range(len(grasp_costs)):
        grasp_costs[n] += lattice.grasp_cost[n] if grasp_costs[n] >= 0 else 0
    return grasp_costs
