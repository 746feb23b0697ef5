"""The cheapest way to carry a body over a board of squares: pushes, quarter and half turns, letting go, taking again.

# Strategy: A* over nodes (hold, quarter turn, direction being pushed in, place) with
# geometry.state_lattice.heuristic for what is left.
# Walking round the body is dear to work out and seldom wanted: letting go is first queued at its least price, and the
# walk is measured only when that comes to the head of the queue. The floor about a pose is walked once from each side.
# Ties are broken by node number: the same question has the same answer.
"""

import heapq

import numpy as np

from geometry.kernels.arrays import Longs
from geometry.kernels.jit import compiled
from geometry.state_lattice.heuristic import NEVER, STILL
from geometry.state_lattice.lattice import COMMAND, REGRASP, WALK, Costs, StateLattice, turn_cost, turned_place

CALM = 4  # the haste of a search that takes the time it needs


@compiled
def haul(
    board: StateLattice,
    left: Costs,
    ends: Costs,
    begin: Costs,
    place: int,
    bend: int,
    haste: int,
    most: int,
    cost: Costs,
    parent: Costs,
) -> Longs:
    """The nodes from the first grasp to the goal, in order; empty when there is none.

    left : geometry.state_lattice.heuristic.guess. ends : the price of ending at each pose, -1 off the goal. begin
    : (holds,) the price of
    having walked to each hold and taken the body, -1 where Utak cannot. place : where the body lies, unturned.
    bend : the price of going on in another direction in the same push, as told to guess.
    A node is ((hold * 4 + quarter) * 9 + direction) * squares + place, direction STILL when it lies.
    haste : CALM for the cheapest way; above it ways are found sooner that may be dearer by the same factor.
    most : so many nodes are settled at most. cost, parent : a number for each node, all of cost 0.
    """
    squares, holds = ends.shape[1], len(begin)
    total = len(cost)
    # cost is one more than the price, 0 unknown. It comes from numpy, which leaves untouched memory alone.
    walked = np.zeros((4 * squares, holds), np.bool_)  # which holds of a pose have been walked to or from
    walk, seen = np.empty(holds, np.int32), np.zeros(squares, np.int32)
    around, price = np.empty(16, np.int64), np.empty(16, np.int64)
    final, final_cost = -1, NEVER
    heap = [(0, 0, 0)]
    heap.pop()
    for hold in range(holds):
        if begin[hold] >= 0 and left[0, STILL, place] < NEVER:
            node = (hold * 36 + STILL) * squares + place
            cost[node], parent[node] = begin[hold] + 1, -1
            heapq.heappush(heap, (begin[hold] + left[0, STILL, place] * haste // CALM, -begin[hold], node))
    settled = 0
    while len(heap) > 0 and settled < most:
        whole, minus, node = heapq.heappop(heap)
        if whole >= final_cost:
            break
        letting_go = node >= total
        node -= total if letting_go else 0
        spent = cost[node] - 1
        if -minus != spent:
            continue
        settled += 1
        p, m, k, hold = node % squares, node // squares % 9, node // squares // 9 % 4, node // squares // 36
        if letting_go:
            if walked[k * squares + p, hold]:
                continue
            _walk(board, hold, k, p, walk, seen, settled)
            for other in range(holds):
                if walk[other] >= 0:
                    walked[k * squares + p, other] = True
                    after = ((other * 4 + k) * 9 + STILL) * squares + p
                    then = spent + REGRASP + walk[other] + board.grip[other]
                    if cost[after] == 0 or then < cost[after] - 1:
                        cost[after], parent[after] = then + 1, node
                        heapq.heappush(heap, (then + left[k, STILL, p] * haste // CALM, -then, after))
            continue
        if m == STILL:
            if ends[k, p] >= 0 and spent + ends[k, p] < final_cost:
                final, final_cost = node, spent + ends[k, p]
            ahead = left[k, STILL, p] * haste // CALM
            heapq.heappush(heap, (spent + REGRASP + COMMAND + ahead, -spent, node + total))
        count = _nexts(board, hold, k, m, p, bend, around, price)
        for n in range(count):
            after, then = around[n], spent + price[n]
            ahead = left[after // squares // 9 % 4, after // squares % 9, after % squares]
            if ahead < NEVER and (cost[after] == 0 or then < cost[after] - 1):
                cost[after], parent[after] = then + 1, node
                heapq.heappush(heap, (then + ahead * haste // CALM, -then, after))
    return _traced(parent, final)


@compiled
def _traced(parent: Costs, final: int) -> Longs:
    """The nodes that lead to one, in order."""
    length, node = 0, final
    while node >= 0:
        length, node = length + 1, parent[node]
    way = np.empty(length, np.int64)
    node = final
    for n in range(length - 1, -1, -1):
        way[n] = node
        node = parent[node]
    return way


@compiled
def _nexts(board: StateLattice, hold: int, k: int, m: int, p: int, bend: int, around: Longs, price: Longs) -> int:
    """The nodes to which one step with the body in hand leads, and its price; how many."""
    squares = len(board.solid)
    base = (hold * 4 + k) * 9
    own = p + board.holds[k, hold]
    if m < STILL:
        around[0], price[0] = (base + STILL) * squares + p, 0
        count = 1
        for d in range(8):
            if d != m and (bend == COMMAND or not board.allowed[k, hold, d]):
                continue
            if board.push[k, d, p] > 0 and board.utak[d, own]:
                around[count] = (base + d) * squares + p + board.steps[d]
                price[count] = board.push[k, d, p] + (bend if d != m else 0)
                count += 1
        return count
    count = 0
    for d in range(8):
        if board.allowed[k, hold, d] and board.push[k, d, p] > 0 and board.utak[d, own]:
            around[count], price[count] = (base + d) * squares + p + board.steps[d], COMMAND + board.push[k, d, p]
            count += 1
    for way in (1, -1):
        extra = turn_cost(board, hold, k, p, way)
        if extra < 0:
            continue
        p1, k1 = turned_place(board, hold, k, p, way), (k + way) % 4
        around[count], price[count] = ((hold * 4 + k1) * 9 + STILL) * squares + p1, board.turn + extra
        count += 1
        more = turn_cost(board, hold, k1, p1, way)
        if more >= 0:
            p2, k2 = turned_place(board, hold, k1, p1, way), (k + 2) % 4
            around[count], price[count] = ((hold * 4 + k2) * 9 + STILL) * squares + p2, board.turn + max(extra, more)
            count += 1
    return count


@compiled
def _walk(board: StateLattice, hold: int, k: int, p: int, walk: Costs, seen: Costs, mark: int) -> None:
    """Write what it costs to walk from a hold to each of the others while the body lies: (holds,), -1 without a way."""
    for n in range(board.image.first[k], board.image.first[k + 1]):
        seen[p + board.image.items[n]] = mark
    _spread(board, p + board.holds[k], p + board.holds[k, hold], walk, seen, mark)


@compiled
def _spread(board: StateLattice, wanted: Longs, start: int, walk: Costs, seen: Costs, mark: int) -> None:
    """Write the price of walking from a square to each of those wanted. Squares seen with the mark are closed."""
    waiting = 0
    for n in range(len(wanted)):
        walk[n] = -1
        waiting += 1 if board.grip[n] >= 0 and board.walk[wanted[n]] and seen[wanted[n]] != mark else 0
    stride = board.steps[2]
    queue = [start]
    seen[start] = mark
    way, head = 0, 0
    while head < len(queue) and waiting > 0:
        tail = len(queue)
        for n in range(head, tail):
            here = queue[n]
            for h in range(len(wanted)):
                if wanted[h] == here and board.grip[h] >= 0 and not board.solid[here]:
                    walk[h] = way * WALK + (COMMAND if way > 0 else 0)
                    waiting -= 1
            for step in (1, stride, -1, -stride):
                if board.walk[here + step] and seen[here + step] != mark:
                    seen[here + step] = mark
                    queue.append(here + step)
        head, way = tail, way + 1


@compiled
def first_walk(board: StateLattice, place: int, start: int) -> Costs:
    """The price of walking from a square to each hold of the body where it lies unturned and taking it; -1 if none."""
    begin, seen = np.empty(len(board.grip), np.int32), np.zeros(len(board.solid), np.int32)
    for n in range(board.image.first[0], board.image.first[1]):
        seen[place + board.image.items[n]] = 1
    _spread(board, place + board.holds[0], start, begin, seen, 1)
    for n in range(len(begin)):
        begin[n] += board.grip[n] if begin[n] >= 0 else 0
    return begin
