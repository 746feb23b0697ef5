"""Measuring what shape an object may have from the squares that it occupies.

Geometry measures here and does not decide: for each class of shape it lays the one that agrees best over the image, at
any place and angle, and says how many squares are wrong. What to believe is for whoever asked.

# Strategy: shapes with whole corners and sides along the axes are tried one and all, since most things are so and their
# images are exact. For turned ones a coarse fan of angles, with sizes read off the image's extent in that direction,
# gives starts; the best few settle downhill on the sum of the wrong gaps (geometry.shapes.misfit), which tells the
# way where
# the number of wrong squares is flat. Of classes that then agree equally well the one comes first that makes such an
# image most likely (geometry.shapes.shape_likelihood).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import shapely

from geometry.kernels.arrays import Bools, Floats
from geometry.shapes import misfit
from geometry.shapes.candidates import settled_best, whole_best
from geometry.shapes.shape_likelihood import room_for

CLASSES = {
    "square": misfit.SQUARE,
    "brick": misfit.BRICK,
    "disc": misfit.DISC,
    "triangle": misfit.TRIANGLE,
    "l_shape": misfit.ELL,
    "t_shape": misfit.TEE,
    "u_shape": misfit.HORSESHOE,
}  # by the number of their parameters, then as the eye prefers them
PAD = 2  # squares of known floor that are looked at around the image
CORNERS = 32  # of the polygon that stands for a disc
SLIGHT = 0.3  # of its sides: such a notch an L hardly has


@dataclass(frozen=True)
class Fit:
    """The shape of one class that agrees best with an image.

    Attributes
    ----------
    shape : "square", "brick", "l_shape", "t_shape", "u_shape", "triangle" or "disc".
    misfit : number of squares wrong: occupied and not covered, or free and covered.
    polygon : shapely Polygon, in squares, origin at the corner of the image's square (0, 0).
    whole : all sides along the axes or corners on whole squares, tried exactly.
    width, height, thick : sizes in squares: of the rectangle that holds the shape, in the shape's own frame (a disc's
        diameter, a triangle's longest side and the height on it), and of its arms or walls (0 where there are none; of
        an L with arms of two widths that of its foot, the arm as long as the rectangle is wide).
    degrees : how far the shape is turned, 0 to 360.
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
    """Lay a shape of every class over the image of one object.

    Parameters
    ----------
    occupied : (rows, columns) bool. Squares that the object is known to occupy; row 0 in the south. At least one.
    possible : (rows, columns) bool, or None for nowhere. Squares of which it is not known. All others, and everything
        beyond the array, are known to be free of the object.

    Returns
    -------
    One Fit a class, the likeliest first: by misfit, then whole corners before others, then fewer parameters, but of
    others that agree best the one of whose class most shapes do. A disc comes before an L with a slight notch.

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
    laid = sorted(
        (_lay(name, kind, image) for name, kind in CLASSES.items()), key=lambda one: (one.wrong, not one.whole)
    )
    ties = sum(one.wrong == laid[0].wrong for one in laid)
    return [_fit(one, west, south) for one in (*_likeliest_first(laid[:ties], image), *laid[ties:])]


class _Laid(NamedTuple):
    """The best shape of a class for an image, as in geometry.shapes.misfit, with how many squares are wrong."""

    name: str
    kind: int
    shape: Floats
    wrong: int
    whole: bool


def _lay(name: str, kind: int, image: misfit.Image) -> _Laid:
    """The best of a class: the best whole one unless a turned one has fewer squares wrong."""
    shape, wrong = whole_best(kind, image)
    if wrong > 0:
        other, worse = settled_best(kind, image)
        if worse < wrong:
            return _Laid(name, kind, other, int(worse), False)
    return _Laid(name, kind, shape, int(wrong), True)


def _likeliest_first(ties: Sequence[_Laid], image: misfit.Image) -> list[_Laid]:
    """Shapes that agree equally well, whole ones before others; those that are all right are laid amid all such."""
    whole = [one for one in ties if one.whole]
    others = [one for one in ties if not one.whole]
    if len(others) > 1 or (others and not others[0].wrong):
        rooms = [(one, room_for(one.kind, one.shape, image, one.wrong)) for one in others]
        rooms.sort(key=lambda pair: -pair[1].log_likelihood)
        others = [one if one.wrong else one._replace(shape=room.mean) for one, room in rooms]
    rounded = bool(whole) and _is_cut_square(whole[0]) and not (image == misfit.UNKNOWN).any()
    return sorted([*whole, *others], key=lambda one: not (rounded and one.kind == misfit.DISC))


def _is_cut_square(laid: _Laid) -> bool:
    """Is it an L that is hardly one: with a notch less than SLIGHT of its sides, as a small disc leaves it?"""
    wide, high, thick = laid.shape[3:6]
    notch = max((wide - misfit.stem_of(laid.shape)) / wide, (high - thick) / high)
    return laid.kind == misfit.ELL and bool(notch < SLIGHT)


def _image(occupied: Bools, possible: Bools | None) -> tuple[misfit.Image, int, int]:
    """The image cut to what may be the object and a rim of PAD squares, and the place of its corner."""
    occupied = np.asarray(occupied, bool)
    unknown = np.zeros_like(occupied) if possible is None else np.asarray(possible, bool)
    if occupied.ndim != 2 or unknown.shape != occupied.shape or not occupied.any():
        raise ValueError("occupied must be a (rows, columns) array with a True square, possible of the same shape")
    unknown = unknown & ~occupied
    rows, columns = np.nonzero(occupied | unknown)
    south, west = int(rows.min()), int(columns.min())
    high, wide = int(rows.max()) + 1 - south, int(columns.max()) + 1 - west
    image = np.zeros((high + 2 * PAD, wide + 2 * PAD), np.int8)
    inner = image[PAD : PAD + high, PAD : PAD + wide]
    inner[unknown[south : south + high, west : west + wide]] = misfit.UNKNOWN
    inner[occupied[south : south + high, west : west + wide]] = misfit.WANTED
    return image, west - PAD, south - PAD


def _fit(laid: _Laid, west: int, south: int) -> Fit:
    """What was laid, in squares of what was asked for. west, south : of the image's corner."""
    polygon = shapely.Polygon(outline(laid.kind, laid.shape) + np.array([west, south], float))
    wide, high, thick = _sizes(laid.kind, laid.shape, polygon)
    degrees = 0.0 if laid.kind == misfit.DISC else _turn(laid.kind, laid.shape)
    return Fit(laid.name, laid.wrong, polygon, laid.whole, wide, high, thick, degrees)


def outline(kind: int, shape: Floats) -> Floats:
    """The corners (n, 2) of a shape, in order."""
    if kind == misfit.TRIANGLE:
        return shape[:6].reshape(3, 2)
    if kind == misfit.DISC:
        angles = 2 * math.pi * (np.arange(CORNERS) + 0.5) / CORNERS
        return np.column_stack([shape[0] + shape[2] * np.cos(angles), shape[1] + shape[2] * np.sin(angles)])
    wide, high, thick = shape[3], shape[3] if kind == misfit.SQUARE else shape[4], shape[5]
    corners = np.array(_corners(kind, wide, high, thick, misfit.stem_of(shape))) - np.array([wide, high]) / 2
    quarters = shape[0] / (math.pi / 2)
    c, s = math.cos(shape[0]), math.sin(shape[0])
    if quarters == round(quarters):
        c, s = float(round(c)), float(round(s))
    x, y = corners.T
    return np.column_stack([shape[1] + c * x - s * y, shape[2] + s * x + c * y])


def _corners(kind: int, wide: float, high: float, thick: float, stem: float) -> list[tuple[float, float]]:
    """The corners of a shape made of rectangles, not turned, lower left at the origin. stem : the width of an L's."""
    if kind <= misfit.BRICK:
        return [(0, 0), (wide, 0), (wide, high), (0, high)]
    if kind == misfit.ELL:
        return [(0, 0), (wide, 0), (wide, thick), (stem, thick), (stem, high), (0, high)]
    left, right = (wide - thick) / 2, (wide + thick) / 2
    foot = [(0, 0), (wide, 0)]
    if kind == misfit.TEE:
        return [*foot, (wide, thick), (right, thick), (right, high), (left, high), (left, thick), (0, thick)]
    inner = [(wide - thick, high), (wide - thick, thick), (thick, thick), (thick, high)]
    return [*foot, (wide, high), *inner, (0, high)]


def _sizes(kind: int, shape: Floats, polygon: Any) -> tuple[float, float, float]:
    """Width, height and thickness of a shape."""
    if kind == misfit.DISC:
        return 2 * float(shape[2]), 2 * float(shape[2]), 0.0
    if kind == misfit.TRIANGLE:
        corners = shape[:6].reshape(3, 2)
        sides = np.hypot(*(corners - np.roll(corners, 1, axis=0)).T)
        return float(sides.max()), float(2 * polygon.area / sides.max()), 0.0
    high = shape[3] if kind == misfit.SQUARE else shape[4]
    return float(shape[3]), float(high), float(shape[5]) if kind >= misfit.ELL else 0.0


def _turn(kind: int, shape: Floats) -> float:
    """The degrees that a shape is turned; of a triangle the direction of its longest side."""
    if kind != misfit.TRIANGLE:
        return math.degrees(float(shape[0])) % 360.0
    corners = shape[:6].reshape(3, 2)
    sides = np.roll(corners, -1, axis=0) - corners
    side = sides[int(np.argmax(np.hypot(*sides.T)))]
    return math.degrees(math.atan2(side[1], side[0])) % 360.0
