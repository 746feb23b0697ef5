"""An episode as a moving picture (GIF): on the left the table as it is, on the right what the robot believes.

This is the only module that uses pillow.
"""

import io
import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from PIL import Image, ImageDraw, ImageFont

from utak.kb.language.vocabulary import MAX_TABLE_SIDE
from utak.simulator.episode.episode import Episode, EpisodeLine
from utak.simulator.replay.drawing import PlacedFrame, segments
from utak.simulator.terminal.action_in_words import describe
from utak.simulator.terminal.streams import one_line

PANEL_PIXELS = 420  # the width or height of each of the two pictures, whichever is greater
GAP_PIXELS = 12  # between and around the two pictures
TEXT_PIXELS = 14  # the height of a line of text
MAX_CAPTION_CHARACTERS = 400  # of a text, of which a line shows as many as fit
TEXT_LINES = 3  # below the pictures
STEP_MILLISECONDS = 700  # how long a step is shown
END_MILLISECONDS = 3000  # how long the last one is shown
# Colours by the numbers with which they are drawn; blue, vermillion, green and purple of Okabe and Ito.
PALETTE = {
    "ground": (255, 255, 255),
    "ink": (17, 17, 17),
    "verge": (207, 207, 202),
    "thing": (185, 216, 234),
    "fixed": (150, 150, 145),
    "robot": (0, 122, 88),
    "place": (168, 67, 124),
    "beyond": (238, 238, 235),
    "edge 0": (200, 220, 235),
    "edge 1": (110, 170, 212),
    "edge 2": (0, 114, 178),
    "object 0": (240, 205, 185),
    "object 1": (224, 140, 90),
    "object 2": (194, 74, 0),
}
COLOURS = {name: number for number, name in enumerate(PALETTE)}
Pixels = list[tuple[float, float]]


class GifScale(NamedTuple):
    """Places squares of the table, and hundredths of squares of the robot frame, on a picture."""

    width: int  # of the table, in squares
    height: int
    pixels: float  # the side of a square
    robot: PlacedFrame  # the robot frame on the table

    @property
    def size(self) -> tuple[int, int]:
        """The size of a picture of the table, in pixels."""
        return math.ceil(self.width * self.pixels), math.ceil(self.height * self.pixels)

    def table(self, x: float, y: float) -> tuple[float, float]:
        """Return the pixel of a point of the table."""
        return x * self.pixels, (self.height - y) * self.pixels

    def believed(self, east: float, north: float) -> tuple[float, float]:
        """Return the pixel of a point of the robot frame, in squares."""
        return self.table(*self.robot.place(east, north))


def animation(episode: Episode) -> bytes:
    """Return an episode as a GIF picture."""
    frames = _frames(episode)
    first = next(frames)
    times = [STEP_MILLISECONDS] * (len(episode.steps) - 1) + [END_MILLISECONDS]
    stream = io.BytesIO()
    first.save(stream, "GIF", save_all=True, append_images=frames, duration=times, loop=0, disposal=1, optimize=False)
    return stream.getvalue()


def _frames(episode: Episode) -> Iterator[Any]:
    """Yield the frame of each step."""
    width, height = episode.header["world"]["table"]
    pixels = PANEL_PIXELS / max(width, height)
    x, y = episode.steps[0]["utak"]
    scale = GifScale(width, height, pixels, PlacedFrame(x, y, float(episode.header["world"]["heading"])))
    panel = scale.size[0] + GAP_PIXELS
    size = 2 * panel + GAP_PIXELS, scale.size[1] + 2 * GAP_PIXELS + TEXT_LINES * (TEXT_PIXELS + 4)
    font = ImageFont.load_default(TEXT_PIXELS)
    places: Pixels = []
    for line in episode.steps:
        places.append(scale.table(*line["utak"]))
        image = _picture(size, "ground")
        image.paste(_true(episode, line, scale, places), (GAP_PIXELS, GAP_PIXELS))
        image.paste(_believed(line, scale), (panel + GAP_PIXELS, GAP_PIXELS))
        on = ImageDraw.Draw(image)
        for row, text in enumerate(_words(episode, line)):
            at = GAP_PIXELS, size[1] - (TEXT_LINES - row) * (TEXT_PIXELS + 4) - 4
            on.text(at, _fitting(text, font, 2 * panel - GAP_PIXELS), COLOURS["ink"], font=font)
        yield image


def _words(episode: Episode, line: EpisodeLine) -> list[str]:
    words = [f"step {line['step']}: {describe(line['action'])}", line["why"]]
    if episode.result is not None and line is episode.steps[-1]:
        words.append(f"{episode.result['verdict']}: {episode.result['reason']}")
    return words


def _picture(size: tuple[int, int], colour: str) -> Any:
    """Return an empty picture with our colours."""
    image = Image.new("P", size, COLOURS[colour])
    image.putpalette([part for rgb in PALETTE.values() for part in rgb])
    return image


def _true(episode: Episode, line: EpisodeLine, scale: GifScale, places: Pixels) -> Any:
    """Return the left picture: the table as it is, and the robot's places so far."""
    image = _picture(scale.size, "ground")
    on, world = ImageDraw.Draw(image), episode.header["world"]
    for rings in world["verge"]:
        for number, ring in enumerate(rings):
            _fill(on, ring, scale, "ground" if number else "verge")
    for thing in world["fixed"].values():
        for number, ring in enumerate(thing["rings"]):
            _fill(on, ring, scale, "ground" if number else "fixed")
    for name, ring in line["objects"].items():
        _fill(on, ring, scale, "thing", 3 if name == line["held"] else 1)
    if len(places) > 1:
        on.line(places, COLOURS["robot"], 1)
    _dot(on, places[-1], COLOURS["robot"])
    return image


def _fill(on: ImageDraw.ImageDraw, ring: Sequence[Any], scale: GifScale, colour: str, outline: int = 0) -> None:
    """Draw a filled ring of points of the table, with an outline of so many pixels."""
    points = [scale.table(x, y) for x, y in ring]
    on.polygon(points, COLOURS[colour], COLOURS["ink"] if outline else None, outline or 1)


def _believed(line: EpisodeLine, scale: GifScale) -> Any:
    """Return the right picture: the believed outlines, the surer, the stronger, and the robot's believed place."""
    image = _picture(scale.size, "beyond")
    on = ImageDraw.Draw(image)
    for one in segments(line["belief"]["facts"]):
        if max(map(abs, (*one.start, *one.end))) <= MAX_TABLE_SIDE:
            kind, strength = "edge" if one.node in ("floor", "verge") else "object", min(2, one.confidence * 3 // 100)
            ends = [scale.believed(*one.start), scale.believed(*one.end)]
            on.line(ends, COLOURS[f"{kind} {strength}"], 1 + strength // 2)
    if place := line["belief"].get("place"):
        _dot(on, scale.believed(*place), COLOURS["place"])
    return image


def _dot(on: ImageDraw.ImageDraw, at: tuple[float, float], colour: int) -> None:
    """Draw a disc of eight pixels."""
    on.ellipse([at[0] - 4, at[1] - 4, at[0] + 4, at[1] + 4], colour, COLOURS["ground"])


def _fitting(text: str, font: Any, width: int) -> str:
    """Return a text without control characters, cut to a width in pixels."""
    clean = one_line(text)[:MAX_CAPTION_CHARACTERS]
    if font.getlength(clean) <= width:
        return clean
    fits = bisect_right(range(len(clean)), width, key=lambda size: font.getlength(clean[:size] + "..."))
    return clean[: max(fits - 1, 0)] + "..."
