"""Moving AI maps (.map) as scenarios: walls and floor, without objects and without a task."""

from fractions import Fraction
from math import floor
from pathlib import Path

from utak.geometry.io.movingai import MapError, parse_map
from utak.geometry.kernels.arrays import Bools
from utak.kb.language.diagnostics import BadInputError, SourceSpan
from utak.kb.language.source_text import Source
from utak.simulator.importing.imported import Imported, ImportOptions
from utak.simulator.importing.raster import CellWorld, RasterCell, RasterError, roomy_place, scaled_walls, world_text
from utak.simulator.importing.text_file import read_raw, text_source

DEFAULT_GOAL = "at(utak, corner(northeast))."  # the goal of a format that has none
MAX_MAP_FILE_BYTES = 20_000_000  # bytes; derived: the largest table of cells of one square has 16.8 million


def read(path: Path | str, options: ImportOptions) -> Imported:
    """Return the scenario of a Moving AI map."""
    raw = read_raw(path, MAX_MAP_FILE_BYTES, "a Moving AI map", options.untrusted)
    source = text_source(path, raw)
    try:
        walls = ~parse_map(raw)
    except MapError as error:
        raise BadInputError([source.problem(SourceSpan(error.line, error.column, error.end), error.what)]) from None
    start = options.start
    if start is not None and options.from_top:
        start = start[0], len(walls) - start[1]
    return scenario_of_walls(source, "Moving AI map", walls, options.scale or Fraction(1), start)


def scenario_of_walls(
    source: Source,
    title: str,
    walls: Bools,
    scale: Fraction,
    start: tuple[float, float] | None,
    notes: tuple[str, ...] = (),
    offset: tuple[float, float] = (0.0, 0.0),
) -> Imported:
    """Return the scenario of walls and floor."""
    try:
        squares = scaled_walls(walls, scale)
        place = roomy_place(squares) if start is None else _square(source, squares, scale, start, offset)
        if place is None:
            what = f"the map has no floor at {scale} square{'s' * (scale > 1)} a cell"
            hint = "--scale 1 keeps floor that is narrow" if scale < 1 else ""
            raise BadInputError([source.problem(source.start(), what, hint)])
        drawn = world_text(CellWorld(squares, (), place), 1)
    except RasterError as error:
        hint = "--scale 1/N makes one square of N x N cells"
        raise BadInputError([source.problem(source.start(), str(error), hint)]) from None
    return Imported(title, drawn.file, drawn.text, (), (DEFAULT_GOAL,), (), notes)


def _square(
    source: Source, squares: Bools, scale: Fraction, start: tuple[float, float], offset: tuple[float, float]
) -> RasterCell:
    """Return the square (column, row) of a place in cells; raise BadInputError when the robot cannot wake there."""
    column, row = (floor((value - left) * scale) for value, left in zip(start, offset, strict=True))
    if not (0 <= row < squares.shape[0] and 0 <= column < squares.shape[1]):
        what = f"the start is not on the map, at ({start[0]:g}, {start[1]:g})"
    elif squares[row, column]:
        what = f"the start is no floor, at ({start[0]:g}, {start[1]:g})"
    else:
        return column, row
    hint = "--start counts from the south-west corner; without it the robot wakes at a free place"
    raise BadInputError([source.problem(source.start(), f"{what} in cells", hint)])
