"""Screens against the libraries one could use instead, side by side.

    python -m benchmarks.screens [FOLDER OF .map FILES] [--queries N] [--only build,query,...]

All times are the least of several, in milliseconds of the processor, warm, in this one process and thread. Nothing here
waits: on a quiet machine wall-clock time is the same, and on a busy one it measures how busy the machine is.
"""

import argparse
import time
import tracemalloc
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from benchmarks.engine import peers
from benchmarks.engine.movingai import Trip, read_map, read_trips
from benchmarks.engine.sightlines import Sightlines
from utak.geometry import Screen

MAPS = Path(__file__).resolve().parents[2] / "shared" / "data" / "movingai"
TIMED_ROUNDS = 6  # in which calls that are compared have their turns (a convention)
MAX_CALLS, TURN_SECONDS = 20, 0.02  # a turn ends after so many calls, or so many seconds and two calls (a convention)
LARGE_MAP = 512 * 512  # squares: maps of so many and more count for the median ratios (a convention)
RATIO_GOALS = (("built", 15, 7), ("as arrays", 30, 15), ("as networkx", 15, 1))
"""Ratios wanted of a screen built, its arrays and its networkx graph: median over large maps, least of all maps."""
SECTIONS = ("build", "growth", "query", "quality", "exact", "classes")


def least(call: Callable[[], object], times: int = 5, seconds: float = 2.0) -> float:
    """Return the least processor time of a call, in milliseconds; stop after so many calls or seconds."""
    best, begun = np.inf, time.process_time()
    for n in range(times):
        start = time.process_time()
        result = call()
        now = time.process_time()
        del result  # freeing it is not timed, ours as little as theirs
        best = min(best, now - start)
        if n and now - begun > seconds:
            break
    return 1e3 * best


def trips_of(path: Path, free: np.ndarray, count: int) -> list[Trip]:
    """Return problems of a map, drawn at random from its scenario file, or between random squares if it has none."""
    scenario = path.with_suffix(".map.scen")
    rng = np.random.default_rng(1)
    if scenario.exists():
        trips = [t for t in read_trips(scenario) if t.octile > 0]
        return [trips[k] for k in rng.permutation(len(trips))[:count]]
    squares = np.argwhere(free)
    ends = squares[rng.integers(len(squares), size=(count, 2))]
    return [Trip((b + 0.5, a + 0.5), (d + 0.5, c + 0.5), 1.0) for (a, b), (c, d) in ends.tolist()]


def topology(screen: Screen) -> tuple[int, int]:
    """Return the numbers of components and of independent cycles of the pathgraph."""
    import networkx as nx

    graph = screen.pathgraph
    components = nx.number_connected_components(graph)
    return components, graph.number_of_edges() - graph.number_of_nodes() + components


def warm_and_fresh(free: np.ndarray, times: int = 15) -> tuple[float, float]:
    """Return the least milliseconds of a build in the memory of a dead screen, and in memory that no screen has had.

    By turns, because the speed of the processor changes from second to second.
    """
    warm, fresh, kept = np.inf, np.inf, []
    for _ in range(times):
        Screen(free)
        warm = min(warm, least(lambda: Screen(free), 1))
        kept.append(Screen(free))  # takes the memory that the dead one left
        fresh = min(fresh, least(lambda: kept.append(Screen(free)), 1))
    return warm, fresh


def build(maps: dict[Path, np.ndarray], _: int) -> None:
    """Print times and memory of building, what they are beside the peer's, and whether the topology is right.

    The peer gives a networkx graph and clearances, so what it compares with is ``Screen(free).pathgraph`` (as
    networkx); beside it stand ``Screen(free).pathgraph_arrays`` (as arrays), which carries the same, and the build
    alone, without the points of edges (built).
    """
    print(
        f"{'build, milliseconds':32} {'size':>10} {'built':>8} {'arrays':>8} {'networkx':>9} {'peer':>9} | "
        f"times as fast: {'built':>6} {'as arrays':>9} {'as networkx':>11} | {'fresh':>6} {'bytes':>6}  topology"
    )
    ratios, most = [], 0.0
    for path, free in maps.items():
        times = paired_times(free)
        peak, right = peak_bytes(free), right_topology(free)
        most = max(most, peak)
        ratio = times[-1] / times[:-1]
        if np.isfinite(times[-1]):
            ratios.append((free.size >= LARGE_MAP, ratio))
        size, verdict = f"{free.shape[0]}x{free.shape[1]}", "right" if right else "wrong"
        print(
            f"{path.stem:32} {size:>10} {times[0]:8.2f} {times[1]:8.2f} {times[2]:9.2f} {times[3]:9.1f} | {'':14} "
            f"{ratio[0]:6.1f} {ratio[1]:9.1f} {ratio[2]:11.1f} | {fresh_ratio(free):6.2f} {peak:6.1f}  {verdict}",
            flush=True,
        )
    if any(large for large, _ in ratios):
        medians = np.median([ratio for large, ratio in ratios if large], axis=0)
        lowest = np.min([ratio for _, ratio in ratios], axis=0)
        for k, (name, median, least_of_all) in enumerate(RATIO_GOALS):
            print(
                f"{name}: median over maps of 512^2 and more {medians[k]:.1f} times as fast as the peer "
                f"({median} wanted), least of all maps {lowest[k]:.1f} ({least_of_all} wanted)"
            )
    print(f"most bytes a cell {most:.1f} (11 wanted); where sknw kills its process: nan")


def paired_times(free: np.ndarray) -> np.ndarray:
    """Return the least milliseconds of a build, the arrays and the networkx graph (builds included), and the peer.

    By turns, because the speed of the processor changes from second to second. All in a child process: where that dies
    with the peer, ours are measured once more and the peer's time is nan.
    """
    ours: list[Callable[[], object]] = [
        lambda: Screen(free),
        lambda: Screen(free).pathgraph_arrays,
        lambda: Screen(free).pathgraph,
    ]
    times = peers.in_child(lambda: least_by_turns([*ours, lambda: peers.skeleton_graph(free)]))
    return np.append(least_by_turns(ours), np.nan) if times is None else times


def least_by_turns(calls: Sequence[Callable[[], object]]) -> np.ndarray:
    """Return the least milliseconds of each call in some rounds, in each of which every call has its turn."""
    return np.min([[least(call, MAX_CALLS, TURN_SECONDS) for call in calls] for _ in range(TIMED_ROUNDS)], axis=0)


def fresh_ratio(free: np.ndarray) -> float:
    """Return the time of a build in memory that no screen has had, by that in the memory of a dead one."""
    warm, fresh = warm_and_fresh(free)
    return fresh / warm


def peak_bytes(free: np.ndarray) -> float:
    """Return the most memory allocated at any time of a build, in bytes a square."""
    taken = Screen(free)  # the memory that a dead screen has left
    tracemalloc.start()
    Screen(free)
    peak = tracemalloc.get_traced_memory()[1] / free.size
    tracemalloc.stop()
    del taken
    return peak


def right_topology(free: np.ndarray) -> bool:
    """Return whether the pathgraph has the components and holes of free space."""
    return topology(Screen(free)) == peers.components_and_holes(free)


def growth(maps: dict[Path, np.ndarray], _: int) -> None:
    """Print how the time of a build grows with the number of squares of one map, tiled."""
    name = min(maps, key=lambda path: (maps[path].size < 256 * 256, maps[path].size))  # one texture at every size
    free = maps[name]
    print(f"{'growth of ' + name.stem + ', tiled':40} ms and ns a cell")
    floors = []
    for n in (256, 512, 1024, 2048, 4096):
        tiles = -(-n // free.shape[0]), -(-n // free.shape[1])
        floors.append(np.tile(free, tiles)[:n, :n])
    rounds = [[least(lambda big=big: Screen(big), 3) for big in floors] for _ in range(6)]  # by turns, as above
    sizes, times = [big.size for big in floors], np.min(rounds, axis=0)
    for big, took in zip(floors, times, strict=True):
        print(f"{len(big):>6}^2 {took:10.2f} {1e6 * took / big.size:8.2f}")
    slope = np.polyfit(np.log(sizes[1:]), np.log(times[1:]), 1)[0]
    print(f"exponent from 512^2 to 4096^2: {slope:.3f} (at most 1.05 wanted)")


def query(maps: dict[Path, np.ndarray], count: int) -> None:
    """Print median times of queries for routes beside those of w9-pathfinding and scipy."""
    heads = ("k=1", "k=4", "shortest", "w9 A*", "scipy", "w9/k1", "scipy/k1")
    print(f"{'query, microseconds (median)':32} " + " ".join(f"{head:>9}" for head in heads))
    ratios = []
    for path, free in maps.items():
        screen, trips = Screen(free), trips_of(path, free, count)
        w9, sparse = peers.w9_astar(free), peers.scipy_dijkstra(free)
        calls = [
            lambda t, s=screen: s.routes(t.start, t.goal, 1),
            lambda t, s=screen: s.routes(t.start, t.goal, 4),
            lambda t, s=screen: s.shortest(t.start, t.goal),
        ]
        ours = [np.median([1e3 * least(lambda c=c, t=t: c(t), 9, 0.2) for t in trips]) for c in calls]
        slow = [
            np.median([1e3 * least(lambda c=c, t=t: c(t.start, t.goal), 3, 0.2) for t in trips[:m]])
            for c, m in ((w9, count), (sparse, 8))
        ]
        ratios.append((slow[0] / ours[0], slow[1] / ours[0]))
        row = (*ours, *slow, *ratios[-1])
        print(f"{path.stem:32} " + " ".join(f"{v:9.1f}" for v in row))
    w9_ratio, scipy_ratio = np.median(ratios, axis=0)
    print(f"median over maps: w9 / k=1 {w9_ratio:.0f} (35 wanted), scipy / k=1 {scipy_ratio:.0f} (110 wanted)")


def quality(maps: dict[Path, np.ndarray], count: int) -> None:
    """Print mean ratios of the lengths of first routes, and of octile grid paths, to the shortest at any angle."""
    print(f"{'length / any-angle optimum':32} {'k=1':>8} {'k=4':>8} {'k=8':>8} {'octile grid':>12}")
    table = []
    for path, free in maps.items():
        screen, rows = Screen(free), []
        for trip in trips_of(path, free, 2 * count):
            best = screen.shortest(trip.start, trip.goal)
            if best is None or best.length == 0.0:
                continue
            lengths = [screen.routes(trip.start, trip.goal, k)[0].length for k in (1, 4, 8)]
            rows.append([v / best.length for v in (*lengths, trip.octile)])
        table.append(np.mean(rows, axis=0))
        print(f"{path.stem:32} " + " ".join(f"{v:8.4f}" for v in table[-1]))
    mean, worst = np.mean(table, axis=0), np.max(table, axis=0)
    print(
        f"mean over maps: k=1 {mean[0]:.4f} (1.010 wanted), k=4 {mean[1]:.4f} (1.005 wanted); "
        f"worst map for k=4 {worst[1]:.4f} (1.03 wanted)"
    )


def exact(maps: dict[Path, np.ndarray], count: int) -> None:
    """Print ratios of the lengths of shortest routes to those of an exact visibility graph."""
    print(f"{'shortest / visibility graph':32} {'queries':>8} {'least':>12} {'most':>12}")
    whole: list[float] = []
    for path, free in maps.items():
        screen, sight, ratios = Screen(free), Sightlines(free), []
        for trip in trips_of(path, free, count):
            best = screen.shortest(trip.start, trip.goal)
            if best is None or best.length == 0.0:
                continue
            truth = sight.length(trip.start, trip.goal, best.length * (1.0 + 1e-9) + 1e-6)
            ratios.append(best.length / truth)  # 0 when no way up to that length exists
        whole += ratios
        print(f"{path.stem:32} {len(ratios):8} {min(ratios):12.9f} {max(ratios):12.9f}", flush=True)
    right = sum(abs(ratio - 1.0) < 1e-7 for ratio in whole)
    print(f"{right} of {len(whole)} queries are 1.000 (all of at least 300 wanted)")


def classes(maps: dict[Path, np.ndarray], _: int) -> None:
    """Print times of eight distinct routes beside those of networkx's shortest simple paths."""
    print(f"{'k=8 routes, milliseconds':32} {'ours':>8} {'networkx':>9} {'ratio':>7}  distinct")
    ratios = []
    for path, free in maps.items():
        screen = Screen(free)
        graph = screen.pathgraph
        if graph.number_of_edges() > 4000:
            continue
        simple, rng = peers.simple_graph(graph), np.random.default_rng(3)
        for _ in range(3):
            a, b = (int(n) for n in rng.integers(0, graph.number_of_nodes(), 2))
            start, goal = ((graph.nodes[n]["x"], graph.nodes[n]["y"]) for n in (a, b))
            routes = screen.routes(start, goal, 8)
            if len(routes) < 8:  # in a maze there is but one way: nothing to compare
                continue
            ours = least(lambda s=start, g=goal, screen=screen: screen.routes(s, g, 8), 5)
            theirs = least(lambda a=a, b=b, g=simple: peers.networkx_ways(g, a, b, 8), 1)
            ratios.append(theirs / ours)
            distinct = len({route.signature for route in routes}) == len(routes)
            print(f"{path.stem:32} {ours:8.3f} {theirs:9.1f} {theirs / ours:7.0f}  {len(routes)} {distinct}")
    print(f"median ratio {np.median(ratios):.0f} (150 wanted)")


def main() -> None:
    """Measure the chosen sections on all maps of a folder."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, default=MAPS)
    parser.add_argument("--queries", type=int, default=30)
    parser.add_argument("--only", default=",".join(SECTIONS))
    options = parser.parse_args()
    maps = {path: read_map(path) for path in sorted(options.folder.glob("*.map"))}
    if not maps:
        parser.error(f"no .map files in {options.folder}")
    sections = options.only.split(",")
    if not set(sections) <= set(SECTIONS):
        parser.error(f"sections are {', '.join(SECTIONS)}")
    for section in sections:
        globals()[section](maps, options.queries)
        print(flush=True)


if __name__ == "__main__":
    main()
