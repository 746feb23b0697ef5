"""Worlds of cells: walls, objects and the robot, drawn as a picture, or as outlines where that would be too large.

Cells are (column, row), row 0 in the south.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Bools
from utak.geometry.raster.components import components
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.language.vocabulary import MAX_TABLE_SIDE
from utak.simulator.importing.imported import COLOUR_LETTERS, MAX_CELL_SCALE, DrawnObject, region_text
from utak.simulator.scenario.picture import FLOOR_MARK, MAX_PICTURE_SIDE, UTAK_MARK, outline_of_cells
from utak.simulator.world.world import VERGE_COLOUR

RasterCell = tuple[int, int]  # (column, row), row 0 in the south
MAX_OUTLINE_CORNERS = 60_000  # corners of a verge that is stated as an outline: seconds of work; a convention


class RasterError(ValueError):
    """A world of cells cannot be made; the message says why."""


@dataclass(frozen=True)
class CellWorld:
    """A world of cells."""

    walls: Bools  # (rows, columns) bool, row 0 in the south
    objects: tuple[frozenset[RasterCell], ...]  # the cells of each movable object
    robot: RasterCell  # the cell in which the robot wakes, in its middle


@dataclass(frozen=True)
class WorldText:
    """The world file of a scenario."""

    file: str  # its name, world.txt or world.lp.
    text: str  # its text
    objects: tuple[DrawnObject, ...]  # in the order of those of the world of cells
    utak: tuple[float, float]  # where the robot wakes (x, y), squares, table frame


def world_text(world: CellWorld, scale: int, border: int = 0) -> WorldText:
    """Return the world file that states a world of cells."""
    if not world.walls.any() and max(world.walls.shape) * scale > MAX_PICTURE_SIDE:
        border = max(border, 1)  # facts state a verge, however small
    check_size(world.walls.shape, Fraction(scale), border)
    walls = np.pad(np.kron(world.walls, np.ones((scale, scale), bool)), border, constant_values=True)
    column, row = world.robot
    utak = (border + column * scale + scale // 2 + 0.5, border + row * scale + scale // 2 + 0.5)
    colours = _colours(world.objects)
    outlines = (outline_of_cells(cells, scale, border) for cells in world.objects)
    is_unique = [colours.count(colour) == 1 for colour in colours]
    drawn = tuple(map(DrawnObject, _names(world.objects, colours), colours, outlines, is_unique))
    if max(walls.shape) > MAX_PICTURE_SIDE:
        corners = count_corners(walls)
        if corners > MAX_OUTLINE_CORNERS:
            what = f"walls with {corners} corners, more than {MAX_OUTLINE_CORNERS}"
            raise RasterError(f"{what}: a table of more than {MAX_PICTURE_SIDE} squares a side needs simpler ones")
        return WorldText("world.lp", _as_facts(walls, drawn, utak), drawn, utak)
    letters = np.where(walls, VERGE_COLOUR, FLOOR_MARK)
    for cells, colour in zip(world.objects, colours, strict=True):
        for i, j in cells:
            south, west = border + j * scale, border + i * scale
            letters[south : south + scale, west : west + scale] = colour
    letters[int(utak[1]), int(utak[0])] = UTAK_MARK
    text = "".join("".join(letters_of_row) + "\n" for letters_of_row in letters[::-1].tolist())
    return WorldText("world.txt", text, drawn, utak)


def check_size(shape: tuple[int, ...], scale: Fraction, border: int = 0) -> None:
    """Raise RasterError when the table for cells would be too large."""
    side = max(shape) * scale + 2 * border
    if side > MAX_TABLE_SIDE:
        raise RasterError(f"the table would have {float(side):g} squares a side, more than {MAX_TABLE_SIDE}")


def scaled_walls(walls: Bools, scale: Fraction) -> Bools:
    """Return walls with larger or smaller cells, row 0 in the south."""
    if not Fraction(1, MAX_CELL_SCALE) <= scale <= MAX_CELL_SCALE:
        raise RasterError(f"{scale} squares a cell: from 1/{MAX_CELL_SCALE} to {MAX_CELL_SCALE} are possible")
    check_size(walls.shape, scale)
    if scale >= 1:
        larger: Bools = np.kron(walls, np.ones((int(scale), int(scale)), bool))
        return larger
    count = scale.denominator
    rows, columns = (-(-side // count) * count for side in walls.shape)
    whole = np.ones((rows, columns), bool)
    whole[: walls.shape[0], : walls.shape[1]] = walls
    blocks = whole.reshape(rows // count, count, columns // count, count)
    smaller: Bools = np.asarray(blocks.any(axis=(1, 3)), bool)
    return smaller


def roomy_place(walls: Bools) -> RasterCell | None:
    """Return the cell in which a robot wakes that may wake anywhere; None when all is wall."""
    parts = components(~walls)
    if not parts.number:
        return None
    part = parts.labels == 1 + int(np.argmax(np.bincount(parts.labels.ravel())[1:]))
    around = np.pad(part, 1)
    roomy = part.copy()
    for north in range(3):
        for east in range(3):
            roomy &= around[north : north + part.shape[0], east : east + part.shape[1]]
    rows, columns = (roomy if roomy.any() else part).nonzero()
    first = min(range(len(rows)), key=lambda n: (rows[n] + columns[n], columns[n]))
    return int(columns[first]), int(rows[first])


def _colours(objects: Sequence[frozenset[RasterCell]]) -> tuple[str, ...]:
    """Return the colour of each object: the letters in turn, and then the least used that no neighbour has."""
    owner = {cell: number for number, cells in enumerate(objects) for cell in cells}
    colours: list[str] = []
    for number, cells in enumerate(objects):
        touching = {
            owner[other]
            for i, j in cells
            for other in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1))
            if owner.get(other, number) < number
        }
        taken = {colours[other] for other in touching}
        used = Counter(colours)
        free = [letter for letter in COLOUR_LETTERS if letter not in taken] or list(COLOUR_LETTERS)
        colours.append(min(free, key=lambda letter: used[letter]))
    return tuple(colours)


def _names(objects: Sequence[frozenset[RasterCell]], colours: Sequence[str]) -> tuple[str, ...]:
    """Return the names that a picture gives objects: colour and number, counted from the west, then from the south."""
    names = [""] * len(objects)
    counts: Counter[str] = Counter()
    for number in sorted(range(len(objects)), key=lambda n: min(objects[n])):
        counts[colours[number]] += 1
        names[number] = f"{colours[number]}{counts[colours[number]]}"
    return tuple(names)


def _as_facts(walls: Bools, objects: Iterable[DrawnObject], utak: tuple[float, float]) -> str:
    """Return the text of world.lp. walls : (rows, columns) bool in squares, row 0 in the south."""
    verge = region_text(shapely.normalize(mask_to_polygon(walls).simplify(0)))
    facts = [f"table({walls.shape[1]}, {walls.shape[0]}).", f'verge("{verge}").']
    facts += [f'object({one.name}, {one.colour}, "{region_text(one.outline)}").' for one in objects]
    return "\n".join([*facts, f'utak("POINT ({utak[0]:g} {utak[1]:g})", 0).', ""])


def count_corners(mask: Bools) -> int:
    """Return the number of corners of the boundary of the True squares. mask : (rows, columns) bool."""
    framed = np.pad(mask, 1)
    a, b, c, d = framed[:-1, :-1], framed[:-1, 1:], framed[1:, :-1], framed[1:, 1:]
    odd = (a ^ b ^ c ^ d).sum()  # one or three of the four squares about a point
    crossing = ((a == d) & (b == c) & (a != b)).sum()  # two that meet at the point alone: a corner of both
    return int(odd + 2 * crossing)
