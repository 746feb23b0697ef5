"""ROS maps (.yaml with an image) as scenarios: walls and floor, without objects and without a task."""

import io
import math
import warnings
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image

from utak.geometry.kernels.arrays import Bools
from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.kb.language.source_text import Source, lies_outside
from utak.simulator.importing.imported import Imported, ImportOptions
from utak.simulator.importing.movingai_map import scenario_of_walls
from utak.simulator.importing.ros_head import MAX_HEAD_BYTES, MapHead, parse_head
from utak.simulator.importing.text_file import read_raw, text_source

IMAGE_FORMATS = ("PPM", "PNG", "BMP")  # as Pillow calls them; PPM is .pgm, too
MAX_IMAGE_BYTES = 40_000_000  # bytes of an image; a convention
MAX_IMAGE_PIXELS = 1 << 25  # pixels of an image that is read: 8192 x 4096; a convention
MAX_TEXT_IMAGE_BYTES = 8_000_000  # bytes of an image with numbers as text, seconds of reading; a convention
DEFAULT_SQUARE_METRES = (
    0.1  # metres a square: as in floor plans of 10 squares a metre, doors have 8 to 10; a convention
)
MAX_RAW_OCCUPANCY = 100 / 255  # by the format: greater shares of `raw` say nothing


class Occupancy(NamedTuple):
    """Two masks of a map, (rows, columns) bool, row 0 in the south; a pixel in neither is unknown."""

    occupied: Bools
    free: Bools


def read(path: Path | str, options: ImportOptions) -> Imported:
    """Return the scenario of a ROS map."""
    path = Path(path)
    notes: tuple[str, ...] = ()
    if path.suffix.lower() not in (".yaml", ".yml"):
        beside = next((path.with_suffix(end) for end in (".yaml", ".yml") if path.with_suffix(end).exists()), None)
        head = MapHead() if beside is None else _head(beside, options)
        if beside is None:
            notes = ("Without a .yaml the map is taken to have 0.05 metres a pixel, and thresholds 0.65 and 0.196.",)
        image = path
    else:
        head = _head(path, options)
        image = path.parent / head.image
        if options.untrusted and lies_outside(image, path.parent):
            raise CannotOpenError(str(image), f"{path} names an image out of its folder, which --untrusted refuses")
    source = Source(str(image), "")
    occupancy = occupancy_of(grey_image(source, read_raw(image, MAX_IMAGE_BYTES, "an image", options.untrusted)), head)
    walls = occupancy.occupied | (~occupancy.free & (not options.unknown_is_floor))
    unknown = int((~occupancy.occupied & ~occupancy.free).sum())
    if unknown:
        word = "floor" if options.unknown_is_floor else "verge"
        notes = (*notes, f"{unknown} pixels are neither occupied nor free; they are {word} (--unknown).")
    walls, offset = _without_margin(walls)
    start = None if options.start is None else cell_of(options.start, head)
    scale = options.scale or default_scale(head.resolution)
    return scenario_of_walls(source, "ROS map", walls, scale, start, notes, offset)


def _head(path: Path, options: ImportOptions) -> MapHead:
    """Return the head in a .yaml file."""
    return parse_head(text_source(path, read_raw(path, MAX_HEAD_BYTES, "the head of a ROS map", options.untrusted)))


class GreyImage(NamedTuple):
    """A grey image."""

    values: npt.NDArray[np.int32]  # (rows, columns) int32, row 0 in the SOUTH
    greatest: int  # the greatest value that a pixel may have


def grey_image(source: Source, raw: bytes) -> GreyImage:
    """Return the image in the bytes of a file; colours count by the mean of red, green and blue, as in ROS."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of large images, which are refused here
            image = Image.open(io.BytesIO(raw), formats=IMAGE_FORMATS)
            pixels = image.width * image.height
            problem = f"an image of {pixels} pixels, more than {MAX_IMAGE_PIXELS}" if pixels > MAX_IMAGE_PIXELS else ""
            if raw[:2] in (b"P1", b"P2", b"P3") and len(raw) > MAX_TEXT_IMAGE_BYTES:
                problem = f"an image as text of more than {MAX_TEXT_IMAGE_BYTES} bytes"
            if not problem:
                deep = image.mode.startswith("I")
                if image.has_transparency_data and image.convert("RGBA").getchannel(3).getextrema() != (255, 255):
                    problem = "the image is transparent in places: save it without transparency"
                values = np.asarray(image if deep else image.convert("RGB"))
    except (OSError, ValueError, SyntaxError, ArithmeticError, Image.DecompressionBombError) as error:
        problem = f"the image cannot be read: {str(error).partition('<')[0][:80]}"
    if problem:
        raise BadInputError([source.problem(source.start(), problem, "ROS maps are .pgm, .png or .bmp images")])
    values = values.astype(np.int32) if deep else values.sum(axis=2, dtype=np.int32)
    return GreyImage(np.ascontiguousarray(values[::-1]), 65535 if deep else 3 * 255)


def occupancy_of(image: GreyImage, head: MapHead) -> Occupancy:
    """Return which pixels are occupied and which are free."""
    share = np.arange(image.greatest + 1) / image.greatest  # of each value that a pixel may have
    occupied = share if head.negate else np.arange(image.greatest, -1, -1) / image.greatest
    known = np.ones(len(share), bool)
    if head.mode == "raw":
        known, occupied = share <= MAX_RAW_OCCUPANCY, share / MAX_RAW_OCCUPANCY
    return Occupancy(
        (known & (occupied > head.occupied_thresh))[image.values], (occupied < head.free_thresh)[image.values]
    )


def _without_margin(walls: Bools) -> tuple[Bools, tuple[float, float]]:
    """Return walls with at most one cell about the floor, and the cells left out in the west and in the south."""
    rows, columns = (np.flatnonzero(np.asarray((~walls).any(axis=axis))) for axis in (1, 0))
    if not len(rows):
        return walls, (0.0, 0.0)
    south, west = max(0, int(rows[0]) - 1), max(0, int(columns[0]) - 1)
    return walls[south : rows[-1] + 2, west : columns[-1] + 2], (float(west), float(south))


def cell_of(place: tuple[float, float], head: MapHead) -> tuple[float, float]:
    """Return a place of the map's frame, in metres, in pixels (x, y) from the image's south-west corner."""
    x, y, yaw = head.origin
    east, north = place[0] - x, place[1] - y
    cos, sin = math.cos(yaw), math.sin(yaw)
    return (cos * east + sin * north) / head.resolution, (cos * north - sin * east) / head.resolution


def default_scale(resolution: float) -> Fraction:
    """Return the squares for one pixel so that a square has about `DEFAULT_SQUARE_METRES`.

    >>> default_scale(0.05), default_scale(0.1), default_scale(0.25)
    (Fraction(1, 2), Fraction(1, 1), Fraction(2, 1))
    """
    if resolution < DEFAULT_SQUARE_METRES:
        return Fraction(1, max(1, round(DEFAULT_SQUARE_METRES / resolution)))
    return Fraction(max(1, round(resolution / DEFAULT_SQUARE_METRES)))
