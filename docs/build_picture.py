"""docs/run.svg: three moments of a real run, drawn from its episode alone.

    utak run examples/go_to_square_unseen --log run.jsonl
    python docs/build_picture.py run.jsonl

Grey: the table as it is. Fields: what the retina shows, the darker the fuller. Lines: what Utak believes, the stronger
the surer; blue for floor and verge, red for objects. The dotted line is the robot's way.
"""

import argparse
import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from utak.simulator.episode.output_files import is_svg, write_whole

ZONES = ((4, 1), (8, 2), (16, 4))
SCALE = 8  # pixels a square
GAP = 16
STYLE = (
    "text{font:13px sans-serif;fill:#333}.table{fill:#e4e4e4}.floor{fill:#fff}.thing{fill:#c9c9c9}"
    ".track{fill:none;stroke:#2a7;stroke-width:2;stroke-dasharray:2 3}.utak{fill:#2a7;stroke:#fff}"
)
Line = dict[str, Any]
Point = tuple[float, float]


class Frame:
    """Convert points from the robot's frame, in hundredths of squares, to the table's frame, in squares."""

    def __init__(self, heading: float, origin: Point) -> None:
        self.cosine, self.sine = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        self.origin = origin

    def turned(self, east: float, north: float) -> Point:
        """Return a vector of the robot's frame in the table's frame, in squares."""
        return east * self.cosine - north * self.sine, east * self.sine + north * self.cosine

    def point(self, east: str, north: str) -> Point:
        """Return a point, given in hundredths of squares as text, in squares of the table."""
        x, y = self.turned(int(east) / 100, int(north) / 100)
        return x + self.origin[0], y + self.origin[1]


def fields() -> list[tuple[int, int, int]]:
    """Return east, north and side of the 160 fields, in the order of an impression, in squares."""
    found, inner = [], 0
    for reach, side in ZONES:
        for north in range(reach - side, -reach - 1, -side):
            found += [
                (east, north, side)
                for east in range(-reach, reach, side)
                if not (-inner <= east < inner and -inner <= north < inner)
            ]
        inner = reach
    return found


def path(rings: Iterable[Sequence[Sequence[float]]], height: int) -> str:
    """Return the SVG path data of rings, given in squares of the table."""
    moves = [" L".join(f"{x * SCALE:.1f} {(height - y) * SCALE:.1f}" for x, y in ring) for ring in rings]
    return " ".join(f"M{move} Z" for move in moves)


def truth(header: Line, step: Line) -> list[str]:
    """Draw the table, and where things are."""
    width, height = header["world"]["table"]
    parts = [f'<rect class="floor" width="{width * SCALE}" height="{height * SCALE}"/>']
    for rings in header["world"]["verge"]:
        parts.append(f'<path class="table" fill-rule="evenodd" d="{path(rings, height)}"/>')
    things = [*step["objects"].values(), *(thing["rings"][0] for thing in header["world"]["fixed"].values())]
    return [*parts, *(f'<path class="thing" d="{path([ring], height)}"/>' for ring in things)]


def impression(step: Line, frame: Frame, height: int) -> list[str]:
    """Draw the fields of the retina that show something."""
    parts = []
    x, y = (math.floor(v) + 0.5 for v in step["utak"])
    for (east, north, side), level in zip(fields(), step["retina"], strict=True):
        corners = [(east, north), (east + side, north), (east + side, north + side), (east, north + side)]
        ring = [[v + w for v, w in zip((x, y), frame.turned(e - 0.5, n - 0.5), strict=True)] for e, n in corners]
        fill = f'fill="#333" fill-opacity="{level / 7 * 0.5:.2f}" stroke="#999" stroke-width="0.3"'
        parts.append(f'<path {fill} d="{path([ring], height)}"/>')
    return parts


def belief(step: Line, frame: Frame, height: int) -> list[str]:
    """Draw the boundaries that are believed."""
    parts = []
    for fact in step["belief"]["facts"]:
        if fact.startswith("segment("):
            name, _, *ends, sure = fact[len("segment(") : -2].split(",")
            (ax, ay), (bx, by) = frame.point(*ends[:2]), frame.point(*ends[2:])
            colour = "#27c" if name in ("floor", "verge") else "#d33"
            parts.append(
                f'<path stroke="{colour}" stroke-width="2" stroke-opacity="{0.15 + int(sure) / 120:.2f}" '
                f'd="{path([[(ax, ay), (bx, by)]], height)}"/>'
            )
    return parts


def panel(lines: Sequence[Line], number: int) -> str:
    """Draw one moment of a run."""
    header, steps = lines[0], lines[1:-1]
    step, height = steps[number], header["world"]["table"][1]
    frame = Frame(header["world"]["heading"], tuple(steps[0]["utak"]))
    track = " ".join(f"{x * SCALE:.1f},{(height - y) * SCALE:.1f}" for x, y in (s["utak"] for s in steps[: number + 1]))
    x, y = step["utak"]
    done = f": {lines[-1]['result']['verdict']}" if number == len(steps) - 1 else ""
    parts = [*truth(header, step), *impression(step, frame, height), *belief(step, frame, height)]
    parts.append(f'<polyline class="track" points="{track}"/>')
    parts.append(f'<circle class="utak" cx="{x * SCALE:.1f}" cy="{(height - y) * SCALE:.1f}" r="5"/>')
    parts.append(f'<text y="{height * SCALE + 16}">step {number}{done}</text>')
    return "".join(parts)


def picture(lines: Sequence[Line]) -> str:
    """Return the SVG of an episode: its first step, one in the middle, and its last."""
    width, height = (side * SCALE for side in lines[0]["world"]["table"])
    last = len(lines) - 3
    panels = [
        f'<svg x="{i * (width + GAP)}" width="{width}" height="{height + 24}">{panel(lines, number)}</svg>'
        for i, number in enumerate((0, last // 2, last))
    ]
    size = f'width="{3 * width + 2 * GAP}" height="{height + 24}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}><style>{STYLE}</style>{"".join(panels)}</svg>\n'


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the picture of an episode."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("episode", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).with_name("run.svg"))
    options = parser.parse_args(arguments)
    drawn = picture([json.loads(line) for line in options.episode.read_text().splitlines()])
    write_whole(options.output, drawn.encode(), is_svg, "SVG picture")


if __name__ == "__main__":
    main()
