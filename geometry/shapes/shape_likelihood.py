"""How likely a class of shapes makes a digital image: what tells classes apart that agree with it equally well.

A class is the likelier the more of its shapes make the very image (Occam's factor: MacKay, Information Theory,
Inference, and Learning Algorithms, 2003, chapter 28). One in four of the images of turned Ts is that of an L, too, yet
of few Ls; a disc of radius 2 mostly has that of a turned square, yet of few squares.

# Strategy: a walk among the shapes that agree, from one of them, tells where they lie about: their mean and their
# spread. So many shapes at random in the box that these span, and how many of them agree, tell how much room there is.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Floats
from geometry.kernels.jit import compiled
from geometry.shapes.candidates import freedom
from geometry.shapes.misfit import BRICK, DISC, ELL, NUMBERS, SQUARE, TRIANGLE, Image, impropriety, misfit

DRAWS = 2000  # shapes of the walk, and at random in the box
SEED = 1
SCALES = 5  # lengths of the steps of the walk, each half of the one before
SPREAD = 2.0  # standard deviations from the mean to the sides of the box
SIZES, WIDTHS = 5.0, 2.0  # squares over which lengths and widths of arms are equally likely
REACH = 10.0  # squares, to the east and to the north, over which two corners of a triangle are, seen from the third


class ParameterVolume(NamedTuple):
    """The room that a class has for an image.

    mean : (NUMBERS,), in the middle of the shapes that agree. log_likelihood : of the image.
    """

    mean: Floats
    log_likelihood: float


def room_for(kind: int, shape: Floats, image: Image, wrong: int) -> ParameterVolume:
    """The room about a shape that gets so many squares of an image wrong. kind, shape, image : as in
    geometry.shapes.misfit.

    Shapes turned by any angle are equally likely, lengths and diameters over SIZES squares.
    """
    free = freedom(kind)
    if kind == ELL and shape[6] != 0.0:
        free[6] = free[5]
    mean, volume = _wander(kind, shape, image, wrong, free, _luck())
    return ParameterVolume(mean, math.log(volume) + _density(kind, bool(free[6])))


def _density(kind: int, uneven: bool) -> float:
    """The log density of a class in its numbers, all that stand for one shape taken together.

    uneven : an L with arms of two widths.
    """
    if kind == DISC:
        return -math.log(SIZES / 2)
    if kind == TRIANGLE:
        return math.log(6.0) - 4.0 * math.log(REACH)
    turned = -math.log(2.0 * math.pi)
    if kind == SQUARE:
        return turned + math.log(4.0 / SIZES)
    if kind == BRICK:
        return turned + math.log(4.0 / SIZES**2)
    return turned - math.log(SIZES**2 * WIDTHS ** (1 + uneven))


@cache
def _luck() -> Floats:
    """(2 DRAWS, NUMBERS): random numbers from -1 to 1, the same always."""
    return np.random.default_rng(SEED).uniform(-1.0, 1.0, (2 * DRAWS, NUMBERS))


@compiled
def _wander(kind: int, shape: Floats, image: Image, wrong: int, free: Floats, luck: Floats) -> tuple[Floats, float]:
    """The mean of the shapes about one that get no more squares wrong, and the volume that they fill.

    free : (NUMBERS,), how far the walk goes in each number at one step; 0 for those that stay.
    """
    draws = len(luck) // 2
    at, other = shape.copy(), shape.copy()
    total, squared = np.zeros(NUMBERS), np.zeros(NUMBERS)
    for n in range(draws):
        for k in range(NUMBERS):
            other[k] = at[k] + luck[n, k] * free[k] / 2 ** (n % SCALES)
        if _agrees(kind, other, image, wrong):
            at[:] = other
        for k in range(NUMBERS):
            total[k] += at[k] - shape[k]
            squared[k] += (at[k] - shape[k]) ** 2
    mean, half = shape.copy(), np.zeros(NUMBERS)
    volume = 1.0
    for k in range(NUMBERS):
        mean[k] += total[k] / draws
        half[k] = SPREAD * math.sqrt(max(squared[k] / draws - (total[k] / draws) ** 2, 0.0))
        volume *= max(2.0 * half[k], 1e-9) if free[k] > 0.0 else 1.0
    inside = 0
    for n in range(draws, 2 * draws):
        for k in range(NUMBERS):
            other[k] = mean[k] + luck[n, k] * half[k]
        inside += _agrees(kind, other, image, wrong)
    if not _agrees(kind, mean, image, wrong):
        mean[:] = shape
    return mean, volume * (inside + 0.5) / draws


@compiled
def _agrees(kind: int, shape: Floats, image: Image, wrong: int) -> bool:
    """Is it a proper shape of its class that gets no more squares wrong than that?"""
    return impropriety(kind, shape) == 0.0 and misfit(kind, shape, image, wrong + 1.0) <= wrong
