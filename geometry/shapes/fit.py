"""Shape fitting: the shape of each class that agrees best with the squares that an object occupies.

Geometry measures here and does not decide: for each class of shape it fits the one that agrees best with the image, at
any place and angle, and says how many squares are wrong. What to believe is the caller's decision.

# Strategy: shapes with whole corners and sides along the axes are tried exhaustively, since most objects are such and
their images are exact. For turned shapes a coarse set of angles, with sizes read off the image's extent in that
direction, gives starts. The best few descend on the sum of the wrong gaps (geometry.shapes.misfit), which has a slope
where the number of wrong squares is flat. Of classes that then agree equally well, the one comes first that makes such
an image most likely (geometry.shapes.shape_likelihood).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Bools, Floats
from utak.geometry.shapes import misfit
from utak.geometry.shapes.candidates import HAS_ARMS, HAS_HEIGHT, best_turned_shape, best_whole_shape
from utak.geometry.shapes.classes import CLASSES, DISC, TRIANGLE
from utak.geometry.shapes.shape_likelihood import parameter_volume

RIM = 2  # squares of known floor around the image that count; convention
DISC_CORNERS = 32  # corners of the polygon that stands for a disc; convention
MAX_SLIGHT_NOTCH = 0.3  # share of the sides; an L with a smaller notch counts as a disc; chosen


@dataclass(frozen=True)
class Fit:
    """The shape of one class that agrees best with an image.

    Attributes
    ----------
    shape : the name of the class, such as "brick".
    misfit : number of squares wrong: occupied and not covered, or free and covered.
    polygon : shapely Polygon, in squares, origin at the lower left corner of square (0, 0) of the array fitted to, x
        along its columns, y along its rows.
    whole : whether all sides lie along the axes, or all corners on whole squares, and the shape was found exhaustively.
    width : in squares, of the rectangle that holds the shape, in the shape's own frame; of a disc the diameter, of a
        triangle the longest side.
    height : in squares, of that rectangle; of a disc the diameter, of a triangle the height on its longest side.
    thick : in squares, of the arms or walls; 0 where there are none; of an L with arms of two widths that of its foot,
        the arm as long as the rectangle is wide.
    degrees : the angle by which the shape is turned, 0 to below 360, counter-clockwise; of a triangle the direction of
        its longest side, of a disc 0.
    """

    shape: str
    misfit: int
    polygon: Any
    whole: bool
    width: float
    height: float
    thick: float
    degrees: float


def fit_shapes(occupied: Bools, possible: Bools | None = None) -> list[Fit]:
    """Return the best shape of every class for the image of one object, the likeliest first.

    The order is by misfit, then whole corners before others, then fewer parameters. Of turned shapes that agree best,
    the one comes first of whose class most shapes agree. A disc comes before an L with a slight notch.

    Parameters
    ----------
    occupied : (rows, columns) bool. Squares that the object is known to occupy; row 0 in the south. At least one.
    possible : (rows, columns) bool, or None for nowhere. Squares of which it is not known whether the object occupies
        them. All others, and everything beyond the array, are known to be free of the object.

    Returns
    -------
    list of Fit : one for each class, in that order: its name, the number of squares it gets wrong, its
    polygon in squares from the lower left corner of square (0, 0) of the array, its sizes in squares, and its angle in
    degrees.

    Raises
    ------
    ValueError : when no square is occupied, or the arrays differ in shape.

    Examples
    --------
    >>> best = fit_shapes(np.ones((3, 3), bool))[0]
    >>> best.shape, best.misfit, best.width
    ('square', 0, 3.0)
    """
    image, west, south = _image(occupied, possible)
    best: dict[str, _Candidate] = {}  # several rows of one name are mirror images
    rows = (_best_of_row(kind, image) for kind in range(len(CLASSES)))
    for one in sorted(rows, key=lambda one: (one.wrong, not one.whole)):
        best.setdefault(CLASSES[one.kind].name, one)
    candidate = list(best.values())
    ties = sum(one.wrong == candidate[0].wrong for one in candidate)
    return [_fit(one, west, south) for one in (*_likeliest_first(candidate[:ties], image), *candidate[ties:])]


class _Candidate(NamedTuple):
    """The best shape of a class for an image, and the number of squares that it gets wrong."""

    kind: int  # the row of its class
    shape: Floats  # (PARAMETER_COUNT,) its numbers, as in misfit, in squares of the image
    wrong: int  # count of known squares that it gets wrong
    whole: bool  # whether it has whole corners, as Fit.whole.


def _best_of_row(kind: int, image: misfit.Image) -> _Candidate:
    """Return the best shape of a row of the table: the best whole one unless a turned one gets fewer squares wrong."""
    shape, wrong = best_whole_shape(kind, image)
    if wrong > 0:
        other, worse = best_turned_shape(kind, image)
        if worse < wrong:
            return _Candidate(kind, other, int(worse), False)
    return _Candidate(kind, shape, int(wrong), True)


def _likeliest_first(ties: Sequence[_Candidate], image: misfit.Image) -> list[_Candidate]:
    """Return shapes that agree equally well, whole ones first, then by likelihood; one for each of `ties`."""
    whole = [one for one in ties if one.whole]
    others = [one for one in ties if not one.whole]
    if len(others) > 1 or (others and not others[0].wrong):
        rooms = [(one, parameter_volume(one.kind, one.shape, image, one.wrong)) for one in others]
        rooms.sort(key=lambda pair: -pair[1].log_likelihood)
        others = [one if one.wrong else one._replace(shape=room.mean) for one, room in rooms]
    rounded = bool(whole) and _is_cut_square(whole[0]) and not (image == misfit.IMAGE_UNKNOWN).any()
    return sorted([*whole, *others], key=lambda one: not (rounded and misfit.FORM[one.kind] == DISC))


def _is_cut_square(candidate: _Candidate) -> bool:
    """Return whether a shape is an L with a notch as slight as the image of a small disc has."""
    width, height, thickness = candidate.shape[3:6]
    notch = max((width - _sizes_of(candidate.shape)[3]) / width, (height - thickness) / height)
    return CLASSES[candidate.kind].name == "l_shape" and bool(notch < MAX_SLIGHT_NOTCH)


def _image(occupied: Bools, possible: Bools | None) -> tuple[misfit.Image, int, int]:
    """Return the image cut to the squares that may be the object and a rim, and the column and row of its corner."""
    occupied = np.asarray(occupied, bool)
    unknown = np.zeros_like(occupied) if possible is None else np.asarray(possible, bool)
    if occupied.ndim != 2 or unknown.shape != occupied.shape or not occupied.any():
        raise ValueError("occupied must be a (rows, columns) array with a True square, possible of the same shape")
    unknown = unknown & ~occupied
    rows, columns = np.nonzero(occupied | unknown)
    south, west = int(rows.min()), int(columns.min())
    height, width = int(rows.max()) + 1 - south, int(columns.max()) + 1 - west
    image = np.zeros((height + 2 * RIM, width + 2 * RIM), np.int8)
    inner = image[RIM : RIM + height, RIM : RIM + width]
    inner[unknown[south : south + height, west : west + width]] = misfit.IMAGE_UNKNOWN
    inner[occupied[south : south + height, west : west + width]] = misfit.IMAGE_OCCUPIED
    return image, west - RIM, south - RIM


def _fit(candidate: _Candidate, west: int, south: int) -> Fit:
    """Return a candidate as a Fit, in the squares of the whole array."""
    polygon = shapely.Polygon(outline(candidate.kind, candidate.shape) + np.array([west, south], float))
    width, height, thickness = _sizes(candidate.kind, candidate.shape, polygon)
    degrees = 0.0 if misfit.FORM[candidate.kind] == DISC else _rotation(candidate.kind, candidate.shape)
    return Fit(
        CLASSES[candidate.kind].name, candidate.wrong, polygon, candidate.whole, width, height, thickness, degrees
    )


def _sizes_of(shape: Floats) -> Floats:
    """Return width, height, thickness and stem of a union of rectangles, (4,), in squares."""
    return np.array([*shape[3:6], shape[6] or shape[5]])


def outline(kind: int, shape: Floats) -> Floats:
    """Return the corners (n, 2) x, y of a shape, in order, in squares of the image, without the first one repeated."""
    if misfit.FORM[kind] == TRIANGLE:
        return shape[:6].reshape(3, 2)
    if misfit.FORM[kind] == DISC:
        angles = 2 * math.pi * (np.arange(DISC_CORNERS) + 0.5) / DISC_CORNERS
        return np.column_stack([shape[0] + shape[2] * np.cos(angles), shape[1] + shape[2] * np.sin(angles)])
    middle = np.array([shape[3], shape[4] if HAS_HEIGHT[kind] else shape[3]]) / 2
    corners = np.array(CLASSES[kind].corners) @ _sizes_of(shape) - middle
    quarters = shape[0] / (math.pi / 2)
    c, s = math.cos(shape[0]), math.sin(shape[0])
    if quarters == round(quarters):
        c, s = float(round(c)), float(round(s))
    x, y = corners.T
    return np.column_stack([shape[1] + c * x - s * y, shape[2] + s * x + c * y])


def _sizes(kind: int, shape: Floats, polygon: Any) -> tuple[float, float, float]:
    """Return the width, height and thickness of a shape, in squares; thickness 0.0 without arms."""
    if misfit.FORM[kind] == DISC:
        return 2 * float(shape[2]), 2 * float(shape[2]), 0.0
    if misfit.FORM[kind] == TRIANGLE:
        corners = shape[:6].reshape(3, 2)
        sides = np.hypot(*(corners - np.roll(corners, 1, axis=0)).T)
        return float(sides.max()), float(2 * polygon.area / sides.max()), 0.0
    height = shape[4] if HAS_HEIGHT[kind] else shape[3]
    return float(shape[3]), float(height), float(shape[5]) if HAS_ARMS[kind] else 0.0


def _rotation(kind: int, shape: Floats) -> float:
    """Return the angle by which a shape is turned, in degrees; of a triangle the direction of its longest side."""
    if misfit.FORM[kind] != TRIANGLE:
        return math.degrees(float(shape[0])) % 360.0
    corners = shape[:6].reshape(3, 2)
    sides = np.roll(corners, -1, axis=0) - corners
    side = sides[int(np.argmax(np.hypot(*sides.T)))]
    return math.degrees(math.atan2(side[1], side[0])) % 360.0
