"""Shape likelihood: how likely a class of shapes makes a digital image. It tells classes apart that agree equally well.

A class is the likelier the more of its shapes make the very image (Occam's factor: MacKay, Information Theory,
Inference, and Learning Algorithms, 2003, chapter 28). One in four of the images of turned Ts is that of an L, too, yet
of few Ls; a disc of radius 2 mostly has the image of a turned square, yet of few squares.

# Strategy: a random walk among the shapes that agree gives their mean and spread. Then shapes are drawn at random in
the box that these span, and the share of them that agree gives the volume.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Floats
from utak.geometry.kernels.jit import compiled
from utak.geometry.shapes.candidates import HAS_ARMS, HAS_HEIGHT, HAS_STEM, TURNS, initial_steps
from utak.geometry.shapes.classes import DISC, TRIANGLE
from utak.geometry.shapes.misfit import (
    FORM,
    PARAMETER_COUNT,
    Image,
    class_violation,
    count_wrong_squares,
)

SAMPLES_PER_STAGE = 2000  # shapes of the random walk, and as many in the box; chosen, no measurement on record
VOLUME_SEED = 1  # convention
STEP_SCALES = 5  # step lengths of the walk, each half of the one before; chosen
BOX_DEVIATIONS = 2.0  # standard deviations from the mean to the sides of the box; chosen
SIZE_RANGE, WIDTH_RANGE = 5.0, 2.0  # squares; prior: lengths and widths of arms are uniform over such ranges
CORNER_RANGE = 10.0  # squares; prior: offsets of a triangle's corners from its third are uniform over such a range


class ParameterVolume(NamedTuple):
    """The volume of a class's parameters that agree with an image."""

    # (PARAMETER_COUNT,), the mean of the shapes that agree, numbers as in misfit; the shape asked about if the mean
    # does not agree itself
    mean: Floats
    # The natural logarithm of the likelihood of the image; higher is likelier. Only differences between classes of one
    # image mean something.
    log_likelihood: float


def parameter_volume(kind: int, shape: Floats, image: Image, wrong: int) -> ParameterVolume:
    """Return the volume of the parameters about a shape that gets at most so many squares of an image wrong."""
    free = initial_steps(kind)
    if HAS_STEM[kind] and shape[6] != 0.0:
        free[6] = free[5]
    mean, volume = _sample_volume(kind, shape, image, wrong, free, _random_numbers())
    return ParameterVolume(mean, math.log(volume) + _log_density(kind, bool(free[6])))


def _log_density(kind: int, uneven: bool) -> float:
    """Return the log density of a class in its numbers, all that stand for one shape taken together."""
    if FORM[kind] == DISC:
        return -math.log(SIZE_RANGE / 2)
    if FORM[kind] == TRIANGLE:
        return math.log(6.0) - 4.0 * math.log(CORNER_RANGE)
    ranges = SIZE_RANGE ** (1 + HAS_HEIGHT[kind]) * WIDTH_RANGE ** (HAS_ARMS[kind] + uneven)
    return -math.log(2.0 * math.pi) - math.log(ranges * TURNS[kind] / 4.0)


@cache
def _random_numbers() -> Floats:
    """Return random numbers from -1 to 1, always the same, (2 SAMPLES_PER_STAGE, PARAMETER_COUNT)."""
    return np.random.default_rng(VOLUME_SEED).uniform(-1.0, 1.0, (2 * SAMPLES_PER_STAGE, PARAMETER_COUNT))


@compiled
def _sample_volume(
    kind: int, shape: Floats, image: Image, wrong: int, free: Floats, random: Floats
) -> tuple[Floats, float]:
    """Return the mean of the shapes about one that get no more squares wrong, and the volume that they fill."""
    count = len(random) // 2
    at, other = shape.copy(), shape.copy()
    total, squared = np.zeros(PARAMETER_COUNT), np.zeros(PARAMETER_COUNT)
    for n in range(count):
        for k in range(PARAMETER_COUNT):
            other[k] = at[k] + random[n, k] * free[k] / 2 ** (n % STEP_SCALES)
        if _agrees(kind, other, image, wrong):
            at[:] = other
        for k in range(PARAMETER_COUNT):
            total[k] += at[k] - shape[k]
            squared[k] += (at[k] - shape[k]) ** 2
    mean, half = shape.copy(), np.zeros(PARAMETER_COUNT)
    volume = 1.0
    for k in range(PARAMETER_COUNT):
        mean[k] += total[k] / count
        half[k] = BOX_DEVIATIONS * math.sqrt(max(squared[k] / count - (total[k] / count) ** 2, 0.0))
        volume *= max(2.0 * half[k], 1e-9) if free[k] > 0.0 else 1.0
    inside = 0
    for n in range(count, 2 * count):
        for k in range(PARAMETER_COUNT):
            other[k] = mean[k] + random[n, k] * half[k]
        inside += _agrees(kind, other, image, wrong)
    if not _agrees(kind, mean, image, wrong):
        mean[:] = shape
    return mean, volume * (inside + 0.5) / count


@compiled
def _agrees(kind: int, shape: Floats, image: Image, wrong: int) -> bool:
    """Return whether a shape is a proper one of its class and gets at most `wrong` squares wrong."""
    return class_violation(kind, shape) == 0.0 and count_wrong_squares(kind, shape, image, wrong + 1.0) <= wrong
