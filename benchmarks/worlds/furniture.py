"""Objects of all shape classes that the robot tells apart, as polygons about the origin.

Rotated objects are larger: the few squares of a small square at 40 degrees could be those of a disc. A disc of radius 3
fills 6 x 6 squares as a square does. One of radius 4 leaves out one square at each corner, as does a square of side 7
at 10 degrees. From 5 on a disc leaves out three, which no square of its size does.
"""

import math

import numpy as np
from shapely import Point, Polygon
from shapely.affinity import rotate, translate

OUTLINE_SHAPES = ("square", "brick", "l_shape", "t_shape", "u_shape", "triangle", "disc")
THING_COLOURS = "acdefghijklmnopqrstuvwxyz"  # b is the verge's


def outline(rng: np.random.Generator, shape: str, turned: bool) -> Polygon:
    """Return a polygon of the named shape class with sides along the axes.

    Its lower left corner is at the origin, and all corners (but a disc's) are at whole squares.
    turned : whether it must be large enough to be recognised after a rotation.
    """
    grow = 2 if turned else 0
    if shape == "square":
        return rectangle(side := 3 + grow + int(rng.integers(0, 4)), side)
    if shape == "brick":
        thin = 2 + grow + int(rng.integers(0, 3))
        return rectangle(thin + 2 + grow // 2 + int(rng.integers(0, 4)) + thin // 3, thin)
    if shape == "l_shape":
        return ell(5 + grow + int(rng.integers(0, 4)), 5 + grow + int(rng.integers(0, 4)), 2 + int(rng.integers(0, 2)))
    if shape == "t_shape":
        return tee(1 + grow // 2 + int(rng.integers(1, 3)), 2 + grow // 2, 3 + grow + int(rng.integers(0, 3)))
    if shape == "u_shape":
        return horseshoe(2 + int(grow > 0), 2 + grow + int(rng.integers(0, 3)), 3 + grow + int(rng.integers(0, 3)))
    if shape == "triangle":
        return triangle(rng, 5 + grow)
    if shape == "disc":
        return disc(5 + int(rng.integers(0, 2)))
    raise ValueError(f"no such shape: {shape}")


def rectangle(width: int, height: int) -> Polygon:
    """Return a square or a brick."""
    return Polygon([(0, 0), (width, 0), (width, height), (0, height)])


def ell(width: int, height: int, thick: int) -> Polygon:
    """Return an L: a foot of `width`, a stem of `height`, both `thick`."""
    return Polygon([(0, 0), (width, 0), (width, thick), (thick, thick), (thick, height), (0, height)])


def tee(arm: int, thick: int, stem: int) -> Polygon:
    """Return an upside-down T: a bar of twice the arm and the stem's thickness, a stem `stem` long on its middle."""
    bar, top = 2 * arm + thick, thick + stem
    left, right = arm, arm + thick
    return Polygon(
        [(0, 0), (bar, 0), (bar, thick), (right, thick), (right, top), (left, top), (left, thick), (0, thick)]
    )


def horseshoe(thick: int, gap: int, depth: int) -> Polygon:
    """Return a U that opens to the north: walls `thick`, `gap` between its legs, which are `depth` deep."""
    width, top = 2 * thick + gap, thick + depth
    inner = [(width - thick, top), (width - thick, thick), (thick, thick), (thick, top)]
    return Polygon([(0, 0), (width, 0), (width, top), *inner, (0, top)])


def triangle(rng: np.random.Generator, least: int) -> Polygon:
    """Return a right-angled triangle or one with its tip above the base."""
    base, height = least + int(rng.integers(0, 4)), least + int(rng.integers(0, 4))
    tip = 0 if rng.random() < 0.5 else int(rng.integers(1, base))
    return Polygon([(0, 0), (base, 0), (tip, height)])


def disc(radius: int, corners: int = 32) -> Polygon:
    """Return a regular polygon with so many corners, its lower left at the origin."""
    angles = [2 * math.pi * (k + 0.5) / corners for k in range(corners)]
    return Polygon([(radius + radius * math.cos(a), radius + radius * math.sin(a)) for a in angles])


def laid(rng: np.random.Generator, polygon: Polygon, centre: Point, turned: bool) -> Polygon:
    """Return the polygon at a place: at any angle, or at a quarter turn with its corners on whole squares."""
    if turned:
        spun = rotate(polygon, float(rng.uniform(0, 360)), origin="center")
        middle = spun.envelope.centroid
        return rounded(translate(spun, centre.x - middle.x, centre.y - middle.y))
    spun = rotate(polygon, 90.0 * int(rng.integers(4)), origin=(0, 0))
    west, south, east, north = spun.bounds
    x, y = round(centre.x - (east - west) / 2), round(centre.y - (north - south) / 2)
    return rounded(translate(spun, x - west, y - south))


def rounded(polygon: Polygon) -> Polygon:
    """Return the polygon with corners of six decimals: the world file then says exactly what the truth is."""
    return Polygon([(round(x, 6) + 0.0, round(y, 6) + 0.0) for x, y in polygon.exterior.coords[:-1]])
