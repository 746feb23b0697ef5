"""New scenario folders: nothing that is there already is overwritten, unless that is wanted."""

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from utak.kb.language.diagnostics import CannotOpenError

WORLD_FILES = ("world.lp", "world.txt")  # of which a scenario has one


def write_folder(folder: Path, files: Mapping[str, str], force: bool = False) -> None:
    """Write the files of a scenario into a folder."""
    with whole_folder(folder, force) as part:
        for name, text in files.items():
            (part / name).write_text(text, encoding="ascii", newline="\n")
    for name in (*WORLD_FILES, "expect.lp"):
        if force and name not in files:
            (folder / name).unlink(missing_ok=True)


@contextmanager
def whole_folder(folder: Path, force: bool = False) -> Iterator[Path]:
    """Yield an empty folder whose files are moved into `folder` when the `with` block ends without a failure."""
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
    """Raise CannotOpenError unless files can be written into a folder, as far as can be told; nothing is made."""
    try:
        if not force and os.path.lexists(folder) and any(folder.iterdir()):
            raise CannotOpenError(str(folder), "it is there already, and not empty")
    except (OSError, ValueError) as error:
        raise CannotOpenError(str(folder), getattr(error, "strerror", None) or str(error)) from None
