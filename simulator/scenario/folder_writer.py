"""New scenario folders: nothing that is there already is overwritten, unless that is wanted."""

from collections.abc import Mapping
from pathlib import Path

from kb.language.diagnostics import CannotOpenError

WORLD_FILES = ("world.lp", "world.txt")  # of which a scenario has one


def write_folder(folder: Path, files: Mapping[str, str], force: bool = False) -> None:
    """Write the files of a scenario into a folder.

    Parameters
    ----------
    folder : the folder; it is made, with those above it.
    files : their texts, ASCII, by name.
    force : whether to write into a folder that is not empty, too. Then the scenario in it is replaced: files that the
        new one does not have are removed; what is no file of a scenario is left alone.

    Raises
    ------
    CannotOpenError : the folder is not empty, or cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not force and any(folder.iterdir()):
            raise CannotOpenError(str(folder), "it is there already, and not empty")
        for name in (*WORLD_FILES, "expect.lp"):
            if force and name not in files:
                (folder / name).unlink(missing_ok=True)
        for name, text in files.items():
            if force:
                (folder / name).unlink(missing_ok=True)  # a link is replaced, not followed
            with (folder / name).open("x", encoding="ascii", newline="\n") as stream:
                stream.write(text)
    except (OSError, ValueError) as error:
        raise CannotOpenError(str(folder), getattr(error, "strerror", None) or str(error)) from None
