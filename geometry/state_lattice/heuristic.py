"""The least cost to go from every pose on the state lattice, without the robot's own body and its walks.

It never exceeds the true cost: an admissible heuristic.

# Strategy: Dijkstra's algorithm backwards from the goal, over poses and the direction in which the body is being pushed
# (none while it lies), so that going on in the same direction is no new command. Costs are small whole numbers: a ring
# of buckets holds the queue (kernels.bucket_queue).
"""

import numpy as np

from utak.geometry.kernels.arrays import Bools, Longs
from utak.geometry.kernels.bucket_queue import Queue, new_queue, put, take
from utak.geometry.kernels.jit import compiled
from utak.geometry.state_lattice.lattice import COMMAND_COST, Costs, StateLattice, place_after_turn, turn_cost

NO_DIRECTION = 8  # stands for the direction of a body that lies, in place of 0..7
COST_UNREACHABLE = 2**30  # above every cost to go
QUEUE_ENTRIES_PER_POSE = 64  # bounds the queue: far more than occur, and memory that is not touched costs nothing


@compiled
def cost_to_go(lattice: StateLattice, end_costs: Costs, redirect_cost: int) -> Costs:
    """Return the least cost to go from every pose, by quarter turn, direction of the push under way, and place."""
    squares = end_costs.shape[1]
    remaining = np.full((4, 9, squares), COST_UNREACHABLE, np.int32)
    size = QUEUE_ENTRIES_PER_POSE * 4 * squares
    queue = new_queue(size)
    for k in range(4):
        for p in range(squares):
            if not lattice.lies[k, p]:
                remaining[k, NO_DIRECTION, p] = -1
            elif end_costs[k, p] >= 0:
                remaining[k, NO_DIRECTION, p] = end_costs[k, p]
                put(queue, end_costs[k, p], (p << 8) + (NO_DIRECTION << 4) + k)
    now = 0
    while queue.used[1] > 0:
        node = take(queue, now)
        if node < 0:
            now += 1
            continue
        p, m, k = node >> 8, (node >> 4) & 15, node & 15
        if remaining[k, m, p] != now:
            continue
        if m < NO_DIRECTION:
            for d in range(8):
                if redirect_cost < COMMAND_COST and now + redirect_cost < remaining[k, d, p]:
                    remaining[k, d, p] = now + redirect_cost
                    put(queue, now + redirect_cost, (p << 8) + (d << 4) + k)
            _relax_push_step(lattice, remaining, queue, k, m, p, now)
            continue
        for d in range(8):
            if now < remaining[k, d, p]:
                remaining[k, d, p] = now
                _relax_push_step(lattice, remaining, queue, k, d, p, now)
        _relax_turns(lattice, remaining, queue, k, p, now + lattice.turn_price)
    return remaining


@compiled
def can_reach_end(lattice: StateLattice, end_costs: Costs, place: int) -> bool:
    """Return whether any end can be reached from a place, unturned: what `cost_to_go` would tell, much sooner."""
    squares = end_costs.shape[1]
    if not lattice.lies[0, place]:
        return False
    known = np.zeros((2, 4 * squares), np.bool_)  # by flood and pose, quarter turn * squares + place
    poses = np.empty((2, 4 * squares), np.int64)  # those that a flood has reached, in order
    numbers = np.zeros((2, 3), np.int64)  # of these: how many there are, were pushed from, were turned from
    poses[0, 0], known[0, place], numbers[0, 0] = place, True, 1
    for pose in range(4 * squares):
        if end_costs[pose // squares, pose % squares] >= 0 and lattice.lies[pose // squares, pose % squares]:
            poses[1, numbers[1, 0]], known[1, pose] = pose, True
            numbers[1, 0] += 1
    if known[1, place]:
        return True
    while True:
        for flood in range(2):
            before = numbers[flood, 0]
            if not _flood_on(lattice, known[flood], poses[flood], numbers[flood], flood == 1):
                return False
            for n in range(before, numbers[flood, 0]):
                if known[1 - flood, poses[flood, n]]:
                    return True


@compiled
def _flood_on(lattice: StateLattice, known: Bools, poses: Longs, numbers: Longs, backwards: bool) -> bool:
    """Add the poses that one pose of a flood leads to; return False when all have led wherever they lead."""
    squares = lattice.lies.shape[1]
    if numbers[1] < numbers[0]:
        k, p = poses[numbers[1]] // squares, poses[numbers[1]] % squares
        numbers[1] += 1
        for d in range(8):
            to = p - lattice.steps[d] if backwards else p + lattice.steps[d]
            if lattice.push_cost[k, d, to if backwards else p] > 0 and not known[k * squares + to]:
                known[k * squares + to] = True
                poses[numbers[0]] = k * squares + to
                numbers[0] += 1
        return True
    if numbers[2] == numbers[0]:
        return False
    k, p = poses[numbers[2]] // squares, poses[numbers[2]] % squares
    numbers[2] += 1
    for hold in range(len(lattice.grasp_cost)):
        if lattice.grasp_cost[hold] < 0 or lattice.solid[p + lattice.holds[k, hold]]:
            continue
        for sense in (1, -1):  # a turn is as free as the one back
            to, k1 = place_after_turn(lattice, hold, k, p, sense), (k + sense) % 4
            if not known[k1 * squares + to] and turn_cost(lattice, hold, k, p, sense) >= 0:
                known[k1 * squares + to] = True
                poses[numbers[0]] = k1 * squares + to
                numbers[0] += 1
    return True


@compiled
def _relax_turns(lattice: StateLattice, remaining: Costs, queue: Queue, k: int, p: int, cost_before: int) -> None:
    """Relax backwards the quarter and half turns, about every hold, that end at a pose."""
    for hold in range(len(lattice.grasp_cost)):
        if lattice.grasp_cost[hold] < 0 or lattice.solid[p + lattice.holds[k, hold]]:
            continue
        for sense in (1, -1):
            p1, p2 = place_after_turn(lattice, hold, k, p, sense), place_after_turn(lattice, hold, k, p, 2 * sense)
            k1, k2 = (k + sense) % 4, (k + 2) % 4
            if cost_before >= remaining[k1, NO_DIRECTION, p1] and cost_before >= remaining[k2, NO_DIRECTION, p2]:
                continue
            extra = turn_cost(lattice, hold, k, p, sense)
            if extra < 0:
                continue
            if cost_before + extra < remaining[k1, NO_DIRECTION, p1]:
                remaining[k1, NO_DIRECTION, p1] = cost_before + extra
                put(queue, cost_before + extra, (p1 << 8) + (NO_DIRECTION << 4) + k1)
            if cost_before + extra < remaining[k2, NO_DIRECTION, p2]:
                more = turn_cost(lattice, hold, k1, p1, sense)
                if more >= 0 and cost_before + max(extra, more) < remaining[k2, NO_DIRECTION, p2]:
                    remaining[k2, NO_DIRECTION, p2] = cost_before + max(extra, more)
                    put(queue, cost_before + max(extra, more), (p2 << 8) + (NO_DIRECTION << 4) + k2)


@compiled
def _relax_push_step(lattice: StateLattice, remaining: Costs, queue: Queue, k: int, m: int, p: int, now: int) -> None:
    """Relax backwards one step of a push: to the same push under way, and to where it began."""
    place_before = p - lattice.steps[m]
    price = lattice.push_cost[k, m, place_before]
    if price == 0:
        return
    cost_before = now + price
    if cost_before < remaining[k, m, place_before]:
        remaining[k, m, place_before] = cost_before
        put(queue, cost_before, (place_before << 8) + (m << 4) + k)
    if cost_before + COMMAND_COST < remaining[k, NO_DIRECTION, place_before]:
        remaining[k, NO_DIRECTION, place_before] = cost_before + COMMAND_COST
        put(queue, cost_before + COMMAND_COST, (place_before << 8) + (NO_DIRECTION << 4) + k)
