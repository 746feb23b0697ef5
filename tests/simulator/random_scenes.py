"""Small random scenarios for the tests of physics, senses and episodes: two rooms, turned objects, any heading."""

from pathlib import Path

import numpy as np
import shapely
from shapely.affinity import rotate, translate

OUTLINES = [
    [(0, 0), (3, 0), (3, 3), (0, 3)],
    [(0, 0), (4, 0), (4, 2), (0, 2)],
    [(0, 0), (5, 0), (5, 2), (2, 2), (2, 5), (0, 5)],
    [(0, 0), (4, 0), (0, 4)],
    [(0, 0), (6, 0), (6, 2), (4, 2), (4, 4), (2, 4), (2, 2), (0, 2)],
]


def write_scene(folder: Path, seed: int, goal: str = "at(utak, corner(northeast)).") -> Path:
    """Write a random scenario into a new folder, and return the folder."""
    draw = np.random.default_rng(seed)
    width, height = (int(n) for n in draw.integers(24, 40, 2))
    wall = int(draw.integers(8, width - 9))
    door = int(draw.integers(3, height - 8))
    floor = shapely.box(2, 2, width - 2, height - 2)
    walls = shapely.box(wall, 2, wall + 1, door).union(shapely.box(wall, door + 5, wall + 1, height - 2))
    verge = shapely.box(0, 0, width, height).difference(floor).union(walls)
    taken, facts = verge, []
    for number in range(int(draw.integers(1, 6))):
        shape = _place(draw, taken, width, height)
        if shape is not None:
            taken = taken.union(shape.buffer(0.05))
            kind = "fixed" if number == 4 else "object"
            facts.append(f'{kind}(o{number}, {draw.choice(list("acdg"))}, "{shape.wkt}").')
    while True:
        point = shapely.Point(draw.uniform(2, width - 2), draw.uniform(2, height - 2))
        if not taken.buffer(0.01).contains(point):
            break
    heading = int(draw.choice([0, 90, 180, 270, int(draw.integers(0, 360))]))
    facts += [f"table({width}, {height}).", f'verge("{verge.wkt}").', f'utak("{point.wkt}", {heading}).']
    folder.mkdir(parents=True)
    (folder / "world.lp").write_text("\n".join(facts) + "\n")
    (folder / "start.lp").write_text("")
    (folder / "goal.lp").write_text(goal + "\n")
    expect = 'inside(utak, "POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0))"). within(20). near(utak, "POINT (5 5)", 9).\n'
    names = [fact.partition("(")[2].partition(",")[0] for fact in facts if fact.startswith("object")]
    expect += "".join(f"unmoved({name}). circles(utak, {name}).\n" for name in names)
    (folder / "expect.lp").write_text(expect)
    return folder


def _place(draw: np.random.Generator, taken: shapely.Geometry, width: int, height: int) -> shapely.Polygon | None:
    for _ in range(60):
        shape = shapely.Polygon(OUTLINES[int(draw.integers(len(OUTLINES)))])
        if draw.random() < 0.6:
            shape = rotate(shape, draw.uniform(0, 360))
            shape = translate(shape, draw.uniform(2, width - 4), draw.uniform(2, height - 4))
        else:
            shape = translate(shape, int(draw.integers(2, width - 4)), int(draw.integers(2, height - 4)))
        if not shape.intersects(taken):
            return shape
    return None
