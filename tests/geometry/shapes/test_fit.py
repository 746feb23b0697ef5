"""Shape fitting: shapes with whole corners are found exactly, turned ones nearly always."""

import math

import numpy as np
import pytest
import shapely
from shapely import affinity

from utak.geometry.raster.rasterize import squares
from utak.geometry.shapes.fit import fit_shapes

ELL = shapely.Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)])
TEE = shapely.Polygon([(0, 0), (6, 0), (6, 2), (4, 2), (4, 5), (2, 5), (2, 2), (0, 2)])
HORSESHOE = shapely.Polygon([(0, 0), (6, 0), (6, 5), (4, 5), (4, 2), (2, 2), (2, 5), (0, 5)])
WHOLE = [
    ("square", shapely.box(0, 0, 3, 3)),
    ("square", shapely.box(0, 0, 1, 1).buffer(1, join_style="mitre")),
    ("square", shapely.box(0, 0, 1, 1)),
    ("brick", shapely.box(0, 0, 1, 3)),
    ("brick", shapely.box(0, 0, 2, 4)),
    ("brick", shapely.box(0, 0, 6, 2)),
    ("brick", shapely.box(0, 0, 3, 4)),
    ("l_shape", ELL),
    ("l_shape", shapely.Polygon([(0, 0), (7, 0), (7, 1), (3, 1), (3, 5), (0, 5)])),
    ("l_shape", shapely.Polygon([(0, 0), (5, 0), (5, 3), (1, 3), (1, 6), (0, 6)])),
    ("t_shape", TEE),
    ("u_shape", HORSESHOE),
    ("triangle", shapely.Polygon([(0, 0), (4, 4), (4, 0)])),
    ("triangle", shapely.Polygon([(0, 0), (6, 0), (3, 5)])),
]


def image_of(shape: shapely.Geometry) -> np.ndarray:
    return squares(shape, 30, 30)


def same_area(a: shapely.Geometry, b: shapely.Geometry) -> bool:
    return a.symmetric_difference(b).area < 1e-9


@pytest.mark.parametrize(("name", "shape"), WHOLE)
@pytest.mark.parametrize("quarter", range(4))
def test_shapes_with_whole_corners_are_found_exactly(name: str, shape: shapely.Geometry, quarter: int) -> None:
    placed_shape = affinity.translate(affinity.rotate(shape, 90 * quarter, origin=(0, 0)), 12, 11)
    best = fit_shapes(image_of(placed_shape))[0]
    assert (best.shape, best.misfit, best.whole) == (name, 0, True)
    assert same_area(best.polygon, placed_shape)


@pytest.mark.parametrize("radius", [2, 2.5, 3.5, 4, 5])
def test_a_disc_is_found_as_a_disc(radius: float) -> None:
    """Smaller discs may occupy the very squares of a square: no method could tell, and the square comes first."""
    image = image_of(shapely.Point(12.3, 11.1).buffer(radius))
    best = fit_shapes(image)[0]
    assert (best.shape, best.misfit) == ("disc", 0)
    assert best.width / 2 == pytest.approx(radius, abs=0.4)


@pytest.mark.long
@pytest.mark.parametrize(("radius", "least"), [(1.5, 35), (2.0, 39), (2.5, 39)])
def test_small_discs_off_the_lattice_are_not_taken_for_turned_squares_or_ells(radius: float, least: int) -> None:
    rng = np.random.default_rng(int(2 * radius))
    there = (shapely.Point(*(12 + rng.random(2))).buffer(radius) for _ in range(40))
    assert sum(fit_shapes(image_of(disc))[0].shape == "disc" for disc in there) >= least


@pytest.mark.parametrize(
    ("rows", "name"), [(("###.", *["####"] * 3), "disc"), (("###..", "###..", *["#####"] * 3), "l_shape")]
)
def test_an_ell_with_a_slight_notch_is_a_disc(rows: tuple[str, ...], name: str) -> None:
    """Four squares by four without a corner are those of a disc."""
    image = np.array([[mark == "#" for mark in row] for row in reversed(rows)])
    assert fit_shapes(image)[0].shape == name
    beside = np.pad(image, ((0, 0), (0, 1)))
    seen_in_part = fit_shapes(beside, np.pad(np.zeros_like(image), ((0, 0), (0, 1)), constant_values=True))
    assert seen_in_part[0].shape == "l_shape"


@pytest.mark.long
@pytest.mark.parametrize(("turned", "least"), [(False, 40), (True, 34)])
def test_a_tee_off_the_lattice_is_not_taken_for_an_ell(turned: bool, least: int) -> None:
    """Its stem covers more squares on one side of the middle, as that of a slightly turned L does."""
    rng, right = np.random.default_rng(6), 0
    for _ in range(40):
        angle = rng.uniform(0, 360) if turned else 90 * rng.integers(4)
        tee = affinity.translate(affinity.rotate(TEE, angle), *(12 + rng.random(2)))
        right += fit_shapes(image_of(tee))[0].shape == "t_shape"
    assert right >= least


def random_shape_of(rng: np.random.Generator, name: str) -> shapely.Geometry:
    """Return a random shape of a class with sizes from 2 to 6."""
    a, b = sorted(rng.uniform(2.0, 4.5, 2))
    if name == "square":
        return shapely.box(0, 0, a + 1, a + 1)
    if name == "brick":
        return shapely.box(0, 0, a, 1.4 * a + b - 1.5)
    if name == "triangle":
        return shapely.Polygon([(0, 0), (a + 2.5, 0), (rng.uniform(0, a), b + 2)])
    if name == "disc":
        return shapely.Point(0, 0).buffer(a + 1.2)
    base = {"l_shape": ELL, "t_shape": TEE, "u_shape": HORSESHOE}[name]
    return affinity.scale(base, *rng.uniform(0.9, 1.1, 2))


@pytest.mark.long
@pytest.mark.parametrize("name", ["square", "brick", "l_shape", "t_shape", "u_shape", "triangle", "disc"])
def test_turned_shapes_are_found_in_their_class(name: str) -> None:
    """All but a few of the small squares, which have the images of discs."""
    rng = np.random.default_rng(len(name))
    right = 0
    for _ in range(40):
        shape = affinity.rotate(random_shape_of(rng, name), rng.uniform(0, 360))
        shape = affinity.translate(shape, *(15 + rng.random(2)))
        fits = fit_shapes(image_of(shape))
        right += fits[0].shape == name
    assert right >= 36


def test_turned_ells_with_arms_of_two_widths_are_found_as_ells() -> None:
    rng = np.random.default_rng(3)
    right, kept = 0, 0
    for _ in range(40):
        long, high = rng.uniform(5.0, 8.0, 2)
        foot, stem = rng.permutation([rng.uniform(1.0, 1.5), rng.uniform(2.0, 3.0)])
        ell = shapely.Polygon([(0, 0), (long, 0), (long, foot), (stem, foot), (stem, high), (0, high)])
        there = affinity.translate(affinity.rotate(ell, rng.uniform(0, 360)), *(15 + rng.random(2)))
        best = fit_shapes(image_of(there))[0]
        right += best.shape == "l_shape"
        kept += best.polygon.symmetric_difference(there).area < 0.3 * there.area
    assert right >= 38
    assert kept >= 30


def test_the_misfit_is_that_of_the_polygon() -> None:
    """Counted again with the digital representation of the polygon."""
    rng = np.random.default_rng(8)
    for _ in range(10):
        shape = affinity.translate(affinity.rotate(random_shape_of(rng, "triangle"), rng.uniform(0, 360)), 15.2, 14.9)
        image = image_of(shape)
        for fit in fit_shapes(image):
            if fit.shape != "disc":
                assert abs(int((image_of(fit.polygon) != image).sum()) - fit.misfit) <= 1


def test_unknown_squares_do_not_count() -> None:
    rng = np.random.default_rng(3)
    placed_shape = affinity.translate(ELL, 12, 11)
    image = image_of(placed_shape)
    unknown = (rng.random(image.shape) < 0.15) | (np.arange(30) > 16)
    fits = fit_shapes(image & ~unknown, unknown & (np.abs(np.arange(30) - 15) < 6))
    assert next(fit for fit in fits if fit.shape == "l_shape").misfit == 0


def test_sizes_and_angle_are_measured() -> None:
    best = fit_shapes(image_of(affinity.translate(ELL, 4, 5)))[0]
    assert (best.width, best.height, best.thick, best.degrees) == (6, 6, 2, 0)
    turned = affinity.rotate(shapely.box(10, 10, 16, 13), 33)
    best = fit_shapes(image_of(turned))[0]
    assert best.shape == "brick"
    assert max(best.width, best.height) == pytest.approx(6, abs=0.5)
    assert math.cos(math.radians(2 * (best.degrees - 33))) == pytest.approx(1, abs=0.1) or best.width < best.height


@pytest.mark.parametrize(
    ("occupied", "possible"),
    [(np.zeros((3, 3), bool), None), (np.ones((2, 2), bool), np.ones((3, 2), bool)), (np.ones(4, bool), None)],
)
def test_an_empty_or_mismatched_image_is_an_error(occupied: np.ndarray, possible: np.ndarray | None) -> None:
    with pytest.raises(ValueError, match="occupied"):
        fit_shapes(occupied, possible)


def test_a_wide_disc_off_the_lattice_is_not_taken_for_a_turned_square() -> None:
    rows = ["..######..", "#########.", *["##########"] * 6, ".#########", "..#######."]
    fits = fit_shapes(np.array([[mark == "#" for mark in row] for row in reversed(rows)]))
    assert fits[0].shape == "disc"
    assert fits[0].misfit <= 1
    assert fits[0].width == pytest.approx(10, abs=0.3)
