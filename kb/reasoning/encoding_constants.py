"""Constants of encodings for Python: a number that an encoding states with `#const` is read from there."""

from functools import cache
from pathlib import Path

import clingo


@cache
def encoding_constant(encoding: Path, name: str) -> int:
    """Return the whole number that an encoding defines with `#const`.

    Parameters
    ----------
    encoding : Path
        The encoding's file; a file that does not exist raises OSError.
    name : str
        The constant's name, as in `#const name = 13.`

    Raises
    ------
    KeyError
        The encoding defines no such constant.
    """
    control = clingo.Control()
    control.add("base", [], encoding.read_text(encoding="utf-8"))
    symbol = control.get_const(name)
    if symbol is None:
        raise KeyError(f"{encoding.name} defines no constant {name}")
    return symbol.number
