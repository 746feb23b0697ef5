"""The summary of a sweep as an SVG picture: a row a scenario, a mark a noise; success rates and numbers of commands."""

import math
from collections.abc import Callable, Iterator, Sequence
from statistics import median
from xml.sax.saxutils import escape

from utak.simulator.sweep.summary import SweepCount, upper_percentile
from utak.simulator.terminal.streams import one_line

# Colours that colour-blind readers can tell apart (Okabe and Ito 2008), without the yellow, which is pale on white.
MARK_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
MARK_SHAPES = ("circle", "square", "diamond", "triangle")  # with the colours, each of 28 noises has a mark of its own
# Pixels; layout.
PANEL_WIDTH, PANEL_GAP, MARGIN, MARK_GAP, SCENARIO_PADDING, MARK_RADIUS = 300.0, 40.0, 16.0, 13.0, 12.0, 4.0
TITLE_HEIGHT, NOISES_ROW_HEIGHT, AXIS_HEIGHT, TICK_LENGTH = 28.0, 18.0, 44.0, 4.0
CHARACTER_WIDTH = 7.0  # pixels of a character in the text's size, about
MAX_NAME_LENGTH = 40  # characters of a scenario's name
TICK_DIGITS = (1, 2, 5)  # of the ticks of the logarithmic axis
STYLE = (
    "text{font:12px sans-serif;fill:#222}.title{font-weight:bold}.grid{stroke:#ddd}.axis{stroke:#444}"
    ".bar{stroke-width:1.6}.band{fill:#f5f5f5}"
)

Scale = Callable[[float], float]  # a value to pixels from the left


def sweep_picture(counts: Sequence[SweepCount]) -> str:
    """Return an SVG document, as text, that shows the counts of a sweep on a white ground."""
    scenarios = list(dict.fromkeys(count.scenario for count in counts))
    noises = list(dict.fromkeys(count.noise for count in counts if count.noise is not None))
    name_width = CHARACTER_WIDTH * max((len(_short_name(name)) for name in scenarios), default=0)
    left = MARGIN + name_width + MARGIN
    legend = list(_legend(noises, left))
    top = TITLE_HEIGHT + NOISES_ROW_HEIGHT * (1 + max((row for row, _ in legend), default=0)) + MARGIN
    row_height = MARK_GAP * len(noises) + SCENARIO_PADDING
    bottom = top + row_height * len(scenarios)
    right = left + PANEL_WIDTH + PANEL_GAP
    width, height = right + PANEL_WIDTH + 2 * MARGIN, bottom + AXIS_HEIGHT + MARGIN
    most = max((upper_percentile(count.steps) for count in counts if count.steps), default=1)
    ticks = log_ticks(most)
    percent, commands = _linear_scale(left, 100.0), _log_scale(right, ticks[-1])
    what = f"success rates and numbers of commands of {len(scenarios)} scenarios at {len(noises)} noises"
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="{what}">',
        f"<style>{STYLE}</style>",
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#fff"/>',
        svg_text(left, TITLE_HEIGHT - 8, "runs as expected, and their commands", "title"),
        *(part for _, part in legend),
    ]
    for number, name in enumerate(scenarios):
        y = top + number * row_height
        if number % 2 == 0:
            size = f'width="{right + PANEL_WIDTH - left:.1f}" height="{row_height:.1f}"'
            parts.append(f'<rect class="band" x="{left:.1f}" y="{y:.1f}" {size}/>')
        parts.append(svg_text(left - 8, y + row_height / 2 + 4, _short_name(name), anchor="end", title=name))
    parts += _axis(percent, [0, 20, 40, 60, 80, 100], top, bottom, "success rate, percent (bar: 95 % Wilson interval)")
    parts += _axis(commands, ticks, top, bottom, "commands, logarithmic: median (bar: to the 95th percentile)")
    parts.append(svg_text(left - 8, top - 6, "scenario", anchor="end"))
    for count in counts:
        if count.noise is not None:
            number = noises.index(count.noise)
            y = top + scenarios.index(count.scenario) * row_height + SCENARIO_PADDING / 2 + MARK_GAP * (number + 0.5)
            parts += _marks(count, number, y, percent, commands)
    return "\n".join([*parts, "</svg>"]) + "\n"


def log_ticks(most: float) -> list[int]:
    """Return 1, 2, 5, 10, 20, ... to the first one that is not below `most`, at least two.

    >>> log_ticks(37)
    [1, 2, 5, 10, 20, 50]
    """
    ticks = [1, 2]
    while ticks[-1] < most:
        ticks.append(TICK_DIGITS[len(ticks) % 3] * 10 ** (len(ticks) // 3))
    return ticks


def _linear_scale(left: float, most: float) -> Scale:
    """Return the scale of a panel: 0 at its left, `most` at its right."""
    return lambda value: left + PANEL_WIDTH * value / most


def _log_scale(left: float, most: float) -> Scale:
    """Return the logarithmic scale of a panel: 1 and all below at its left, `most` at its right."""
    return lambda value: left + PANEL_WIDTH * math.log(max(1.0, value)) / math.log(most)


def _legend(noises: Sequence[float], left: float) -> Iterator[tuple[int, str]]:
    """Yield (row, SVG) of each noise in the legend; a full row is followed by another one."""
    x, row, end = left, 0, left + 2 * PANEL_WIDTH + PANEL_GAP
    for number, noise in enumerate(noises):
        label = f"noise {noise:g}"
        width = 3 * MARK_RADIUS + CHARACTER_WIDTH * len(label) + MARGIN
        if x + width > end and x > left:
            x, row = left, row + 1
        y = TITLE_HEIGHT + NOISES_ROW_HEIGHT * (row + 0.5)
        yield row, svg_mark(number, x + MARK_RADIUS, y) + svg_text(x + 3 * MARK_RADIUS, y + 4, label)
        x += width


def _axis(scale: Scale, ticks: Sequence[float], top: float, bottom: float, label: str) -> list[str]:
    """Return the grid, the ticks and the label of a panel."""
    left, right = scale(ticks[0]), scale(ticks[-1])
    parts = []
    for value in ticks:
        parts.append(svg_line(scale(value), top, scale(value), bottom, "grid"))
        parts.append(svg_line(scale(value), bottom, scale(value), bottom + TICK_LENGTH, "axis"))
        parts.append(svg_text(scale(value), bottom + 18, f"{value:g}", anchor="middle"))
    parts.append(svg_line(left, bottom, right, bottom, "axis"))
    parts.append(svg_text((left + right) / 2, bottom + 38, label, anchor="middle"))
    return parts


def _marks(count: SweepCount, number: int, y: float, percent: Scale, commands: Scale) -> Iterator[str]:
    """Yield the marks of a count in both panels; none where there is nothing to show."""
    rate, interval, steps = count.success_rate, count.success_interval, count.steps
    where = f"{count.scenario}, noise {count.noise:g}"
    if rate is not None and interval is not None:
        ends = f"{100 * interval[0]:.0f} to {100 * interval[1]:.0f} %"
        title = f"{where}: {count.passed} of {count.judged} as expected ({ends})"
        yield _bar(percent(100 * interval[0]), percent(100 * interval[1]), y, number)
        yield svg_mark(number, percent(100 * rate), y, title)
    if steps:
        upper = upper_percentile(steps)
        title = f"{where}: {median(steps):g} commands in the median, {upper} at the 95th percentile"
        yield _bar(commands(median(steps)), commands(upper), y, number)
        yield svg_mark(number, commands(median(steps)), y, title)


def svg_mark(number: int, x: float, y: float, title: str = "") -> str:
    """Return the mark of a noise at (x, y). number : of the noise."""
    colour = MARK_COLOURS[number % len(MARK_COLOURS)]
    shape = MARK_SHAPES[number % len(MARK_SHAPES)]
    r = MARK_RADIUS
    corners = {
        "square": [(-r, -r), (r, -r), (r, r), (-r, r)],
        "diamond": [(0, -1.3 * r), (1.3 * r, 0), (0, 1.3 * r), (-1.3 * r, 0)],
        "triangle": [(0, -1.2 * r), (1.2 * r, r), (-1.2 * r, r)],
    }
    inner = f"<title>{_escaped(title)}</title>" if title else ""
    if shape == "circle":
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r:g}" fill="{colour}">{inner}</circle>'
    points = " ".join(f"{x + dx:.1f},{y + dy:.1f}" for dx, dy in corners[shape])
    return f'<polygon points="{points}" fill="{colour}">{inner}</polygon>'


def _bar(start: float, end: float, y: float, number: int) -> str:
    """Return the bar of a noise from `start` to `end`, with short lines across its ends."""
    colour = MARK_COLOURS[number % len(MARK_COLOURS)]
    path = f"M{start:.1f} {y:.1f}H{end:.1f}M{start:.1f} {y - 3:.1f}v6M{end:.1f} {y - 3:.1f}v6"
    return f'<path class="bar" d="{path}" stroke="{colour}" fill="none"/>'


def svg_line(x1: float, y1: float, x2: float, y2: float, kind: str) -> str:
    """Return a line between two points, in pixels; `kind` is its class in the style sheet."""
    return f'<line class="{kind}" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"/>'


def svg_text(x: float, y: float, text: str, kind: str = "", anchor: str = "start", title: str = "") -> str:
    """Return a text; the title is shown when the pointer rests on it."""
    marked = f' class="{kind}"' if kind else ""
    inner = f"<title>{_escaped(title)}</title>" if title else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{marked}>{inner}{_escaped(text)}</text>'


def _escaped(text: str) -> str:
    return escape(one_line(text))


def _short_name(name: str) -> str:
    """Return the end of a name that is too long."""
    return name if len(name) <= MAX_NAME_LENGTH else "..." + name[3 - MAX_NAME_LENGTH :]
