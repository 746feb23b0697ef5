"""A screen drawn as SVG: squares, skeleton, pathgraph and routes."""

from collections.abc import Iterable

import numpy as np

from geometry.bones import Floats
from geometry.distance import Bools
from geometry.passages import Passage
from geometry.route import Route
from geometry.screen import Screen

COLOURS = ("#c0392b", "#2471a3", "#1e8449", "#b7950b", "#76448a", "#148f77", "#ba4a00", "#566573")


def draw(
    screen: Screen,
    routes: Iterable[Route] = (),
    passages: Iterable[Passage] = (),
    pathgraph: bool = True,
    scale: float = 8.0,
) -> str:
    """An SVG document; ``scale`` is the size of a square in pixels. North is up."""
    rows, columns = screen.shape
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {columns} {rows}" '
        f'width="{columns * scale:g}" height="{rows * scale:g}">',
        f'<g transform="translate(0 {rows}) scale(1 -1)" fill="none" stroke-linecap="round" stroke-linejoin="round">',
        f'<rect width="{columns}" height="{rows}" fill="#fdfefe"/>',
        f'<path class="blocked" d="{runs_of(~screen.free)}" fill="#515a5a"/>',
        f'<path class="skeleton" d="{runs_of(screen.skeleton)}" fill="#d6dbdf"/>',
    ]
    if pathgraph:
        parts += draw_pathgraph(screen)
    for passage in passages:
        (ax, ay), (bx, by) = passage.a, passage.b
        parts.append(f'<path class="passage" d="M{ax:g} {ay:g}L{bx:g} {by:g}" stroke="#8e44ad" stroke-width="0.3"/>')
    for number, route in reversed(list(enumerate(routes))):  # the shortest on top, the others wider: all can be seen
        colour = COLOURS[number % len(COLOURS)]
        line = "L".join(f"{x:g} {y:g}" for x, y in route.points.tolist())
        title = f"route {number + 1}: length {route.length:.3f}, clearance {route.clearance:g}"
        stroke = f'stroke="{colour}" stroke-width="{0.35 + 0.25 * number:g}"'
        parts.append(f'<path class="route" d="M{line}" {stroke}><title>{title}</title></path>')
    return "\n".join([*parts, "</g>", "</svg>", ""])


def draw_pathgraph(screen: Screen) -> list[str]:
    """Chains as lines and nodes as dots."""
    parts = []
    for _, _, edge in screen.pathgraph.edges(data=True):
        line = "L".join(f"{x:g} {y:g}" for x, y in corners(edge["points"]).tolist())
        parts.append(f'<path class="chain" d="M{line}" stroke="#7f8c8d" stroke-width="0.15"/>')
    for _, node in screen.pathgraph.nodes(data=True):
        parts.append(f'<circle class="node" cx="{node["x"]:g}" cy="{node["y"]:g}" r="0.3" fill="#2c3e50"/>')
    return parts


def corners(points: Floats) -> Floats:
    """A polyline without the points on straight stretches."""
    if len(points) < 3:
        return points
    step = np.diff(points, axis=0)
    keep = np.ones(len(points), np.bool_)
    keep[1:-1] = (step[1:] != step[:-1]).any(axis=1)
    return points[keep]


def runs_of(mask: Bools) -> str:
    """Path data of the horizontal runs of a mask."""
    edges = np.diff(np.pad(mask.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    starts, ends = np.argwhere(edges == 1).tolist(), np.argwhere(edges == -1).tolist()
    return "".join(f"M{a} {row}h{b - a}v1h{a - b}z" for (row, a), (_, b) in zip(starts, ends, strict=True))
