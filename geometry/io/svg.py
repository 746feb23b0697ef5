"""A screen drawn as SVG: squares, skeleton, pathgraph and routes, with a legend, a scale and the ends of the routes."""

from collections.abc import Callable, Sequence
from math import floor, isnan, log10

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools, Floats
from utak.geometry.raster.runs import runs_along_rows
from utak.geometry.routes.route import Route
from utak.geometry.screen import Screen

# Colours that colour-blind readers can tell apart (Okabe and Ito 2008).
ROUTE_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
# Dashes and gaps in line widths; convention: with the colours, each of 28 routes has a style of its own.
ROUTE_DASHES = ("", "3 2", "1 1.5", "5 1.5 1 1.5")
PICTURE_SIZE = 960.0  # pixels, of the longer side; convention
MAX_SCALE = 48.0  # pixels a square; convention
PICTURE_MARGIN, LEGEND_WIDTH, LEGEND_ROW_HEIGHT, SCALE_BAR_GAP = 16.0, 290.0, 20.0, 8.0  # pixels; layout
MAX_LISTED_ROUTES = 24  # in the legend; convention
TEXT_STYLE = "text{font:13px sans-serif;fill:#222}"


def place(point: XY) -> str:
    """Return a point (x, y) in words, "(x, y)", in squares east and north of the south-west corner."""
    return f"({point[0]:g}, {point[1]:g})"


def draw(
    screen: Screen,
    routes: Sequence[Route],
    ends: tuple[XY, XY],
    words: Callable[[XY], str] = place,
) -> str:
    """Return an SVG document, as text, that shows a screen, north up."""
    rows, columns = screen.shape
    scale = min(MAX_SCALE, PICTURE_SIZE / max(rows, columns))
    listed = _legend(routes, ends, words)
    bar = columns * scale * 0.25
    height = max(rows * scale + LEGEND_ROW_HEIGHT + SCALE_BAR_GAP, len(listed) * LEGEND_ROW_HEIGHT) + 2 * PICTURE_MARGIN
    width = max(columns * scale, bar + 90) + LEGEND_WIDTH + 3 * PICTURE_MARGIN
    parts = _squares(screen, width, height, scale)
    parts += draw_pathgraph(screen, 1.0 / scale)
    for number, route in reversed(list(enumerate(routes))):  # the first one last, on top
        parts.append(_line(number, route, route_line_width(number, len(routes), scale)))
    parts.append("</g>")
    parts += _marks([_pixel(end, rows, scale) for end in ends])
    parts += _scale_bar(bar / scale, scale, PICTURE_MARGIN, PICTURE_MARGIN + rows * scale + LEGEND_ROW_HEIGHT)
    left = width - LEGEND_WIDTH - PICTURE_MARGIN
    parts += [row(left, PICTURE_MARGIN + LEGEND_ROW_HEIGHT * (number + 0.7)) for number, row in enumerate(listed)]
    return "\n".join([*parts, "</svg>", ""])


def _squares(screen: Screen, width: float, height: float, scale: float) -> list[str]:
    """Return the beginning of the document: the page, and the free squares, blocked squares and skeleton on it."""
    rows, columns = screen.shape
    return [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" '
        f'height="{height:g}"><style>{TEXT_STYLE}</style>',
        f'<rect width="{width:g}" height="{height:g}" fill="#ffffff"/>',
        f'<g transform="translate({PICTURE_MARGIN:g} {PICTURE_MARGIN + rows * scale:g}) scale({scale:g} {-scale:g})" '
        'fill="none" stroke-linecap="round" stroke-linejoin="round">',
        f'<rect width="{columns}" height="{rows}" fill="#f7f7f7" stroke="#999999" stroke-width="{1 / scale:g}"/>',
        f'<path class="blocked" d="{rectangles_of(~screen.free)}" fill="#5c5c5c"/>',
        f'<path class="skeleton" d="{rectangles_of(screen.skeleton)}" fill="#d9d9d9"/>',
    ]


def route_line_width(number: int, count: int, scale: float) -> float:
    """Return the width at which a route is drawn, in squares: at most a quarter, as long as that can be seen."""
    thinnest = min(3.0, max(1.5, 0.125 * scale)) / scale
    return thinnest * (1.0 + number / max(1, count - 1))


def _line_style(number: int, width: float) -> str:
    """Return the SVG attributes for the colour, dashes and width of a route's line, as text."""
    dashes = ROUTE_DASHES[number // len(ROUTE_COLOURS) % len(ROUTE_DASHES)]
    pattern = " ".join(f"{float(part) * width:g}" for part in dashes.split())
    dashed = f' stroke-dasharray="{pattern}"' if pattern else ""
    return f'stroke="{ROUTE_COLOURS[number % len(ROUTE_COLOURS)]}" stroke-width="{width:g}"{dashed}'


def _route_text(number: int, route: Route) -> str:
    """Return number (`number`, counted from 0, plus 1), length and clearance of a route in words, in squares."""
    clearance = "not known" if isnan(route.clearance) else f"{route.clearance:g}"
    return f"{number + 1}: length {route.length:.3f}, clearance {clearance}"


def _line(number: int, route: Route, width: float) -> str:
    """Return the SVG of a route, in squares (y to the north)."""
    points = "L".join(f"{x:g} {y:g}" for x, y in route.points.tolist())
    title = f"<title>route {_route_text(number, route)}</title>"
    return f'<path class="route" d="M{points}" {_line_style(number, width)}>{title}</path>'


def _pixel(point: XY, rows: int, scale: float) -> XY:
    """Return a point (x, y) in squares of the screen as (x, y) in pixels of the picture, from its top left corner."""
    return PICTURE_MARGIN + point[0] * scale, PICTURE_MARGIN + (rows - point[1]) * scale


def _marks(ends: Sequence[XY]) -> list[str]:
    """Return the SVG of a ring at the start and a diamond at the goal, as two elements."""
    (ax, ay), (bx, by) = ends
    return [
        f'<circle class="start" cx="{ax:g}" cy="{ay:g}" r="6" fill="#ffffff" stroke="#000000" stroke-width="2.5"/>',
        f'<path class="goal" d="M{bx:g} {by - 8:g}l8 8l-8 8l-8 -8z" fill="#ffe14d" stroke="#000000" stroke-width="2"/>',
    ]


def _scale_bar(longest: float, scale: float, x: float, y: float) -> list[str]:
    """Return the SVG of a bar of a round number of squares, at most `longest`, with its length in words."""
    power = 10.0 ** floor(log10(max(longest, 1.0)))
    squares = max(digit * power for digit in (1, 2, 5) if digit * power <= max(longest, 1.0))
    text = f"{squares:g} square" + "s" * (squares != 1)
    return [
        f'<path class="scale" d="M{x:g} {y - 5:g}v5h{squares * scale:g}v-5" fill="none" stroke="#222222" '
        'stroke-width="1.5"/>',
        f'<text x="{x + squares * scale + 8:g}" y="{y + 3:g}">{text}; north is up</text>',
    ]


LegendRow = Callable[[float, float], str]


def _legend(routes: Sequence[Route], ends: tuple[XY, XY], words: Callable[[XY], str]) -> list[LegendRow]:
    """Return the rows of the legend, from the top: functions that give a row's SVG at a place (x, y) in pixels."""
    ring, diamond = _marks([(0.0, 0.0), (0.0, 0.0)])
    rows = [_legend_row(ring, f"from {words(ends[0])}"), _legend_row(diamond, f"to {words(ends[1])}")]
    for number, route in list(enumerate(routes))[:MAX_LISTED_ROUTES]:
        rows.append(
            _legend_row(f'<path d="M-12 0h24" fill="none" {_line_style(number, 3.0)}/>', _route_text(number, route))
        )
    if len(routes) > MAX_LISTED_ROUTES:
        rows.append(_legend_row("", f"... and {len(routes) - MAX_LISTED_ROUTES} more"))
    rows.append(_legend_row('<rect x="-8" y="-6" width="16" height="12" fill="#5c5c5c"/>', "blocked"))
    rows.append(_legend_row('<rect x="-8" y="-6" width="16" height="12" fill="#d9d9d9"/>', "skeleton"))
    sample = '<path d="M-12 0h24" stroke="#888888"/><circle r="2.5" fill="#444444"/>'
    rows.append(_legend_row(sample, "pathgraph"))
    return rows


def _legend_row(sample: str, text: str) -> LegendRow:
    """Return the row of a sample and the text that explains it."""
    return lambda x, y: (
        f'<g class="legend" transform="translate({x + 12:g} {y:g})">{sample}<text x="22" y="4">{text}</text></g>'
    )


def draw_pathgraph(screen: Screen, pixel: float) -> list[str]:
    """Return the SVG of the pathgraph: chains as lines, then nodes as dots, an element each."""
    parts = []
    thin, dot = min(0.15, pixel), min(0.3, 2.5 * pixel)
    for _, _, edge in screen.pathgraph.edges(data=True):
        line = "L".join(f"{x:g} {y:g}" for x, y in without_straight_points(edge["points"]).tolist())
        parts.append(f'<path class="chain" d="M{line}" stroke="#888888" stroke-width="{thin:g}"/>')
    for _, node in screen.pathgraph.nodes(data=True):
        parts.append(f'<circle class="node" cx="{node["x"]:g}" cy="{node["y"]:g}" r="{dot:g}" fill="#444444"/>')
    return parts


def without_straight_points(points: Floats) -> Floats:
    """Return a polyline (n, 2) without the points between two equal steps; the first and last point stay."""
    if len(points) < 3:
        return points
    step = np.diff(points, axis=0)
    keep = np.ones(len(points), np.bool_)
    keep[1:-1] = (step[1:] != step[:-1]).any(axis=1)
    return points[keep]


def rectangles_of(mask: Bools) -> str:
    """Return SVG path data of the horizontal runs of True squares of a mask (rows, columns)."""
    return "".join(f"M{a} {row}h{b - a}v1h{a - b}z" for row, a, b in runs_along_rows(mask).each())
