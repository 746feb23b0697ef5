"""ROS maps (.yaml with .pgm) as scenarios: walls and floor, without objects and without a task."""

import math
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.kb.language.diagnostics import CannotOpenError, SourceSpan
from utak.kb.language.source_text import MAX_FILE_BYTES, Source, lies_outside
from utak.simulator.importing.imported import Imported, ImportOptions
from utak.simulator.importing.movingai_map import scenario_of_walls
from utak.simulator.importing.pgm import GreyImage, parse_pgm
from utak.simulator.importing.ros_yaml import MapHead, parse_head
from utak.simulator.importing.text_file import read_raw, text_source

MAX_PGM_BYTES = 100_000_000  # bytes of an image; a convention
DEFAULT_SQUARE_METRES = (
    0.1  # metres a square: as in floor plans of 10 squares a metre, doors have 8 to 10; a convention
)
MAX_RAW_OCCUPANCY = 100  # by the format: greater values of `raw` say nothing
# What an image without .yaml is taken for: the values that the map savers of ROS write.
DEFAULT_HEAD = MapHead("", SourceSpan(1, 1, 1), 0.05, (0.0, 0.0, 0.0), False, 0.65, 0.196, "trinary")


class Occupancy(NamedTuple):
    """Two masks of a map, (rows, columns) bool, row 0 in the south; a pixel in neither is unknown."""

    occupied: Bools
    free: Bools


def read(path: Path | str, options: ImportOptions) -> Imported:
    """Return the scenario of a ROS map."""
    path = Path(path)
    notes: tuple[str, ...] = ()
    if path.suffix.lower() == ".pgm":
        beside = next((path.with_suffix(end) for end in (".yaml", ".yml") if path.with_suffix(end).exists()), None)
        head = DEFAULT_HEAD if beside is None else _head(beside, options)
        if beside is None:
            notes = ("Without a .yaml the map is taken to have 0.05 metres a pixel, and thresholds 0.65 and 0.196.",)
        source = text_source(path, read_raw(path, MAX_PGM_BYTES, "an image", options.untrusted))
    else:
        head = _head(path, options)
        source = _image(path, head, options)
    occupancy = occupancy_of(parse_pgm(source), head)
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
    return parse_head(text_source(path, read_raw(path, MAX_FILE_BYTES, "the head of a ROS map", options.untrusted)))


def _image(path: Path, head: MapHead, options: ImportOptions) -> Source:
    """Return the image that a head names, relative to its own folder."""
    image = path.parent / head.image
    if options.untrusted and lies_outside(image, path.parent):
        raise CannotOpenError(str(image), f"{path} names an image out of its folder, which --untrusted refuses")
    return text_source(image, read_raw(image, MAX_PGM_BYTES, "an image", options.untrusted), path.parent)


def occupancy_of(image: GreyImage, head: MapHead) -> Occupancy:
    """Return which pixels are occupied and which are free."""
    known = np.arange(image.greatest + 1)  # each value that a pixel may have
    if head.mode == "raw":
        share = known / MAX_RAW_OCCUPANCY
        occupied = (share > head.occupied_thresh) & (share <= 1)
    else:
        share = (known if head.negate else image.greatest - known) / image.greatest
        occupied = share > head.occupied_thresh
    return Occupancy(occupied[image.values], (share < head.free_thresh)[image.values])


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
