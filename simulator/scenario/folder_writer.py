"""New scenario folders: nothing that is there already is overwritten, unless that is wanted."""

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
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
    with whole_folder(folder, force) as part:
        for name, text in files.items():
            (part / name).write_text(text, encoding="ascii", newline="\n")
    for name in (*WORLD_FILES, "expect.lp"):
        if force and name not in files:
            (folder / name).unlink(missing_ok=True)


@contextmanager
def whole_folder(folder: Path, force: bool = False) -> Iterator[Path]:
    """Yield an empty folder whose files are moved into `folder` at the end of the `with` block, if nothing fails in it.

    folder : it is made, with those above it. force : whether it may hold something; files of the same names are
    replaced. Raises CannotOpenError when it is not empty, or cannot be written; then nothing is left behind.
    """
    made: list[Path] = []
    part = folder.with_name(f".{os.getpid()}.part")
    try:
        check_folder(folder, force)
        made = [one for one in (folder, *folder.parents) if not one.exists()]
        folder.parent.mkdir(parents=True, exist_ok=True)
        part.mkdir()
        yield part
        folder.mkdir(exist_ok=True)
        for file in sorted(part.iterdir()):
            file.replace(folder / file.name)
        made = []
    except (OSError, ValueError) as error:
        raise CannotOpenError(str(folder), getattr(error, "strerror", None) or str(error)) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
        for one in made:
            with suppress(OSError, ValueError):
                one.rmdir()


def check_folder(folder: Path, force: bool = False) -> None:
    """Raise CannotOpenError unless files can be written into a folder, as far as can be told; nothing is made.

    force : whether it may hold something.
    """
    try:
        if not force and os.path.lexists(folder) and any(folder.iterdir()):
            raise CannotOpenError(str(folder), "it is there already, and not empty")
    except (OSError, ValueError) as error:
        raise CannotOpenError(str(folder), getattr(error, "strerror", None) or str(error)) from None
