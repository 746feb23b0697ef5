"""Reliability as an SVG picture: for each predicate the share of true statements by the confidence of their bin."""

from collections.abc import Sequence

from benchmarks.calibration.table import Reliability
from utak.simulator.sweep.picture import STYLE, svg_line, svg_mark, svg_text

PANEL_SIDE, LEFT, TOP, LEGEND = 300.0, 56.0, 28.0, 190.0  # pixels; layout
MIN_SHOWN = 10  # statements: a bin with fewer is not drawn, for its share says little
TICKS = (0, 20, 40, 60, 80, 100)  # percent


def picture(found: Sequence[Reliability]) -> str:
    """Return an SVG document, as text, on a white ground; on the diagonal confidences are what they say."""
    width, height = LEFT + PANEL_SIDE + LEGEND, TOP + PANEL_SIDE + 56
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="statements that were true, by confidence">',
        f"<style>{STYLE}</style>",
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#fff"/>',
        svg_text(LEFT, TOP - 10, "statements that were true, percent", "title"),
    ]
    for tick in TICKS:
        parts += [
            svg_line(*_point(0, tick), *_point(100, tick), "grid"),
            svg_line(*_point(tick, 0), *_point(tick, 100), "grid"),
        ]
        x, y = _point(0, tick)
        parts.append(svg_text(x - 8, y + 4, f"{tick}", anchor="end"))
        x, y = _point(tick, 0)
        parts.append(svg_text(x, y + 18, f"{tick}", anchor="middle"))
    parts += [svg_line(*_point(0, 0), *_point(100, 100), "axis")]
    parts.append(svg_text(LEFT + PANEL_SIDE / 2, TOP + PANEL_SIDE + 40, "confidence, percent", anchor="middle"))
    for number, one in enumerate(found):
        y = TOP + 20 * (number + 0.5)
        parts.append(svg_mark(number, LEFT + PANEL_SIDE + 24, y))
        parts.append(svg_text(LEFT + PANEL_SIDE + 36, y + 4, f"{one.predicate} ({one.number})"))
        for row in one.rows.values():
            if row.number >= MIN_SHOWN:
                title = f"{one.predicate}: {100 * row.true:.0f} percent of {row.number} were true"
                parts.append(svg_mark(number, *_point(100 * row.confidence, 100 * row.true), title))
    return "\n".join([*parts, "</svg>"]) + "\n"


def _point(confidence: float, true: float) -> tuple[float, float]:
    """Return the pixels of a point, both of its values in percent."""
    return LEFT + PANEL_SIDE * confidence / 100, TOP + PANEL_SIDE * (1 - true / 100)
