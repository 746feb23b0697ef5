"""The volume of a class's parameters for an image: counted again with shapes placed at random."""

import math
from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest
import shapely
from shapely import affinity

from utak.geometry.raster.rasterize import squares
from utak.geometry.shapes import misfit
from utak.geometry.shapes.candidates import best_turned_shape
from utak.geometry.shapes.classes import CLASSES, MIN_BRICK_RATIO
from utak.geometry.shapes.shape_likelihood import SIZE_RANGE, parameter_volume

PAD = 2
SQUARE, BRICK, DISC = ([one.name for one in CLASSES].index(name) for name in ("square", "brick", "disc"))
Draw = Callable[[np.random.Generator], shapely.Polygon]


def square(rng: np.random.Generator) -> shapely.Polygon:
    return shapely.box(0, 0, *([rng.uniform(2, 2 + SIZE_RANGE)] * 2))


def brick(rng: np.random.Generator) -> shapely.Polygon:
    while True:
        wide, high = rng.uniform(2, 2 + SIZE_RANGE, 2)
        if max(wide, high) >= MIN_BRICK_RATIO * min(wide, high):
            return shapely.box(0, 0, wide, high)


def disc(rng: np.random.Generator) -> shapely.Polygon:
    return shapely.Point(0, 0).buffer(rng.uniform(1, 1 + SIZE_RANGE / 2), quad_segs=32)


def image_of(shape: shapely.Polygon) -> np.ndarray:
    """Return the squares of a shape, with a rim of PAD squares."""
    covered = squares(shape, 30, 30)
    rows, columns = np.nonzero(covered)
    cut = covered[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
    return np.pad(cut, PAD).astype(np.int8)


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "draw"),
    [(SQUARE, square), (BRICK, brick), (DISC, disc)],
    ids=["square", "brick", "disc"],
)
def test_the_likelihood_of_an_image_is_its_frequency(kind: int, draw: Draw) -> None:
    """Among shapes of many sizes, turned and moved at random."""
    rng, number = np.random.default_rng(1), 4000
    seen: Counter[tuple[tuple[int, ...], bytes]] = Counter()
    for _ in range(number):
        turned = affinity.rotate(draw(rng), rng.uniform(0, 360), origin=(0, 0))
        image = image_of(affinity.translate(turned, *(15 + rng.random(2))))
        seen[image.shape, image.tobytes()] += 1
    differences = []
    for (shape, image_bytes), count in seen.most_common(12):
        image = np.frombuffer(image_bytes, np.int8).reshape(shape)
        laid, wrong = best_turned_shape(kind, image)
        if wrong:
            continue
        differences.append(parameter_volume(kind, laid, image, 0).log_likelihood - math.log(count / number))
    assert len(differences) >= 8
    assert abs(np.median(differences)) < 0.7
    assert np.abs(differences).max() < 2.0


@pytest.mark.long
def test_the_mean_of_the_shapes_that_agree_is_nearer_than_the_descended_shape() -> None:
    """A descent stops as soon as all squares agree."""
    rng, settled, of_mean = np.random.default_rng(4), [], []
    for _ in range(30):
        angle, x, y, side = rng.uniform(0, math.pi / 2), *(15 + rng.random(2)), rng.uniform(4, 6)
        turned = affinity.rotate(shapely.box(-side / 2, -side / 2, side / 2, side / 2), angle, use_radians=True)
        image = squares(affinity.translate(turned, x, y), 30, 30).astype(np.int8)
        laid, wrong = best_turned_shape(SQUARE, image)
        if wrong == 0:
            mean = parameter_volume(SQUARE, laid, image, 0).mean
            assert misfit.count_wrong_squares(SQUARE, mean, image, math.inf) == 0
            settled.append(abs(laid[3] - side))
            of_mean.append(abs(mean[3] - side))
    assert len(of_mean) >= 25
    assert np.mean(of_mean) < np.mean(settled)


def test_unknown_squares_make_an_image_likelier() -> None:
    image = np.pad(np.ones((4, 4), np.int8), PAD)
    laid, _ = best_turned_shape(DISC, image)
    known = parameter_volume(DISC, laid, image, 0).log_likelihood
    image[PAD:-PAD, -PAD - 1] = misfit.IMAGE_UNKNOWN
    assert parameter_volume(DISC, laid, image, 0).log_likelihood > known
