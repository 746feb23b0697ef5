"""The cheapest way to carry a body over a board of squares: pushes, quarter and half turns, letting go, taking again.

# Strategy: A* over nodes (hold, quarter turn, direction being pushed in, place) with geometry.guess for what is left.
# Walking round the body is dear to work out and seldom wanted: letting go is first queued at its least price, and the
# walk is measured only when that comes to the head of the queue. Each body of connected floor about a pose is walked
# once. Ties are broken by node number: the same question has the same answer.
"""

import heapq

import numpy as np

from geometry.board import (
    COMMAND,
    REGRASP,
    WALK,
    Board,
    Costs,
    shifted,
    turn_cost,
    turned_place,
)
from geometry.compiled import compiled
from geometry.guess import ACROSS, ALONG, NEVER
from geometry.stencil import Ints


@compiled
def haul(board: Board, left: Costs, ends: Costs, begin: Costs, place: int, most: int) -> Ints:
    """The nodes from the first grasp to the goal, in order; empty when there is none.

    left : geometry.guess.guess. ends : the price of ending at each pose, -1 off the goal. begin : (holds,) the price of
    having walked to each hold and taken the body, -1 where Utak cannot. place : where the body lies, unturned.
    A node is ((hold * 4 + quarter) * 9 + direction) * places + place, direction 8 when it lies still.
    most : so many nodes are settled at most.
    """
    places, holds = ends.shape[1], len(begin)
    total = holds * 36 * places
    cost = np.zeros(total, np.int32)  # one more than the price; 0 unknown
    parent = np.empty(total, np.int32)
    walked = np.zeros((4 * places, holds), np.bool_)  # which holds of a pose have been walked to or from
    final, final_cost = -1, NEVER
    heap = [(0, 0, 0)]
    heap.pop()
    for hold in range(holds):
        if begin[hold] >= 0 and left[0, 8, place] < NEVER:
            node = (hold * 36 + 8) * places + place
            cost[node], parent[node] = begin[hold] + 1, -1
            heapq.heappush(heap, (begin[hold] + left[0, 8, place], -begin[hold], node))
    around = np.empty(16, np.int64)
    price = np.empty(16, np.int64)
    walk = np.empty(holds, np.int64)
    seen = np.zeros(len(board.solid), np.int64)
    round_ = 0
    settled = 0
    while len(heap) > 0 and settled < most:
        total_cost, minus, node = heapq.heappop(heap)
        if total_cost >= final_cost:
            break
        letting_go = node >= total
        if letting_go:
            node -= total
        spent = cost[node] - 1
        if -minus != spent:
            continue
        settled += 1
        p, rest = node % places, node // places
        m, rest = rest % 9, rest // 9
        k, hold = rest % 4, rest // 4
        if letting_go:
            if walked[k * places + p, hold]:
                continue
            round_ += 1
            _walk(board, hold, k, p, walk, seen, round_)
            for other in range(holds):
                if walk[other] < 0:
                    continue
                walked[k * places + p, other] = True
                then = spent + REGRASP + walk[other] + board.grip[other]
                after = ((other * 4 + k) * 9 + 8) * places + p
                if other != hold and (cost[after] == 0 or then < cost[after] - 1):
                    cost[after], parent[after] = then + 1, node
                    heapq.heappush(heap, (then + left[k, 8, p], -then, after))
            continue
        if m == 8:
            if ends[k, p] >= 0 and spent + ends[k, p] < final_cost:
                final, final_cost = node, spent + ends[k, p]
            heapq.heappush(heap, (spent + REGRASP + COMMAND + left[k, 8, p], -spent, node + total))
        count = _nexts(board, hold, k, m, p, around, price)
        for n in range(count):
            after, then = around[n], spent + price[n]
            k1, m1, p1 = after // places // 9 % 4, after // places % 9, after % places
            if left[k1, m1, p1] >= NEVER:
                continue
            if cost[after] == 0 or then < cost[after] - 1:
                cost[after], parent[after] = then + 1, node
                heapq.heappush(heap, (then + left[k1, m1, p1], -then, after))
    way: Ints = _traced(parent, final)
    return way


@compiled
def _traced(parent, final):  # type: ignore[no-untyped-def]
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
def _nexts(board, hold, k, m, p, around, price):  # type: ignore[no-untyped-def]
    """The nodes to which one step with the body in hand leads, and its price; how many."""
    places = board.lies.shape[1]
    columns = board.frame[0]
    base = (hold * 4 + k) * 9
    ux, uy = p % columns + board.holds[k, hold, 0], p // columns + board.holds[k, hold, 1]
    own = uy * columns + ux
    if m < 8:
        around[0], price[0] = (base + 8) * places + p, 0
        if board.push[k, m, p] == 0 or not board.utak[m, own]:
            return 1
        around[1] = (base + m) * places + shifted(board, p, ACROSS[m], ALONG[m])
        price[1] = board.push[k, m, p]
        return 2
    count = 0
    for d in range(8):
        if board.allowed[k, hold, d] and board.push[k, d, p] > 0 and board.utak[d, own]:
            around[count] = (base + d) * places + shifted(board, p, ACROSS[d], ALONG[d])
            price[count] = COMMAND + board.push[k, d, p]
            count += 1
    for way in (1, -1):
        extra = turn_cost(board, hold, k, p, way)
        if extra < 0:
            continue
        p1, k1 = turned_place(board, hold, k, p, way), (k + way) % 4
        around[count], price[count] = ((hold * 4 + k1) * 9 + 8) * places + p1, COMMAND + extra
        count += 1
        more = turn_cost(board, hold, k1, p1, way)
        if more >= 0:
            p2, k2 = turned_place(board, hold, k1, p1, way), (k + 2) % 4
            around[count], price[count] = ((hold * 4 + k2) * 9 + 8) * places + p2, COMMAND + max(extra, more)
            count += 1
    return count


@compiled
def _walk(board, hold, k, p, walk, seen, round_):  # type: ignore[no-untyped-def]
    """What it costs to walk from a hold to each of the others while the body lies: (holds,), -1 where no way leads."""
    columns, pad, stride = board.frame[0], board.frame[2], board.frame[3]
    at = (p // columns + pad) * stride + p % columns + pad
    for n in range(board.image_first[k], board.image_first[k + 1]):
        seen[at + board.image[n]] = round_
    holds = len(walk)
    wanted = np.empty(holds, np.int64)
    waiting = 0
    for n in range(holds):
        wanted[n] = at + board.holds[k, n, 1] * stride + board.holds[k, n, 0]
        walk[n] = -1
        if board.grip[n] >= 0 and board.walk[wanted[n]] and seen[wanted[n]] != round_:
            waiting += 1
    _spread(board, wanted, wanted[hold], walk, waiting, seen, round_)


@compiled
def _spread(board, wanted, start, walk, waiting, seen, round_):  # type: ignore[no-untyped-def]
    """Write the price of walking from a padded square to each wanted one; squares marked with the round are closed."""
    stride = board.frame[3]
    queue = [start]
    seen[start] = round_
    way, head = 0, 0
    while head < len(queue) and waiting > 0:
        tail = len(queue)
        for n in range(head, tail):
            here = queue[n]
            for h in range(len(wanted)):
                if wanted[h] == here and board.grip[h] >= 0:
                    walk[h] = way * WALK + (COMMAND if way > 0 else 0)
                    waiting -= 1
            for step in (1, stride, -1, -stride):
                there = here + step
                if board.walk[there] and seen[there] != round_:
                    seen[there] = round_
                    queue.append(there)
        head, way = tail, way + 1


@compiled
def first_walk(board: Board, place: int, column: int, row: int) -> Costs:
    """The price of walking from a square to each hold of the body where it lies unturned and taking it; -1 if none."""
    pad, stride = board.frame[2], board.frame[3]
    holds = board.holds.shape[1]
    walk = np.empty(holds, np.int64)
    seen = np.zeros(len(board.solid), np.int64)
    at = (place // board.frame[0] + pad) * stride + place % board.frame[0] + pad
    for n in range(board.image_first[0], board.image_first[1]):
        seen[at + board.image[n]] = 1
    wanted = np.empty(holds, np.int64)
    for n in range(holds):
        wanted[n] = at + board.holds[0, n, 1] * stride + board.holds[0, n, 0]
        walk[n] = -1
    _spread(board, wanted, (row + pad) * stride + column + pad, walk, holds + 1, seen, 1)
    begin = np.empty(holds, np.int32)
    for n in range(holds):
        begin[n] = walk[n] + board.grip[n] if walk[n] >= 0 and not board.solid[wanted[n]] else -1
    return begin
