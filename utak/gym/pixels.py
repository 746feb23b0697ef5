"""The table as an image: one block of pixels a square, north above."""

import colorsys
import string

import numpy as np
import numpy.typing as npt

from utak.simulator.replay.drawing import LETTER_HUES
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import VERGE_COLOUR

MAX_BLOCK_PIXELS = 10  # pixels along the side of a square; a convention
MAX_FRAME_PIXELS = 640  # pixels along the longer side of an image, where squares are not smaller than one; a convention
FLOOR_RGB, VERGE_RGB, UTAK_RGB = (255, 255, 255), (212, 212, 212), (34, 170, 119)
Image = npt.NDArray[np.uint8]  # (rows, columns, 3)


def image(table: Tabletop) -> Image:
    """Return the table as an image, (rows, columns, 3) uint8; row 0 is in the north."""
    colours = table.colours
    height, width = colours.shape
    pixels = _PALETTE[colours]
    x, y = table.utak
    pixels[min(int(y), height - 1), min(int(x), width - 1)] = UTAK_RGB
    block = max(1, min(MAX_BLOCK_PIXELS, MAX_FRAME_PIXELS // max(height, width)))
    return np.ascontiguousarray(pixels[::-1].repeat(block, axis=0).repeat(block, axis=1))


def _letter_rgb(letter: str) -> tuple[int, int, int]:
    """Return red, green and blue, 0 to 255, of what has a colour letter."""
    if letter == VERGE_COLOUR:
        return VERGE_RGB
    hue = LETTER_HUES.get(letter, (ord(letter) - ord("a")) * 360 // 26)
    red, green, blue = colorsys.hls_to_rgb(hue / 360, 0.6, 0.5)
    return round(255 * red), round(255 * green), round(255 * blue)


_PALETTE = np.array([FLOOR_RGB, *map(_letter_rgb, string.ascii_lowercase)], np.uint8)
