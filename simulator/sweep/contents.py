"""The texts of a scenario's files: they travel to workers that have no such files."""

import hashlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from utak.kb.language.source_text import read_source

EXPECTATIONS_FILE = "expect.lp"
# The files of a scenario that a run reads. trial.lp is no part of a run: it says how `utak test` runs and what it asks.
RUN_FILES = ("world.lp", "world.txt", "start.lp", "goal.lp", EXPECTATIONS_FILE)


class ScenarioContents(NamedTuple):
    """The files of a scenario."""

    name: str  # the scenario's name within a sweep
    files: tuple[tuple[str, str], ...]  # (file name, text) of each file that there is

    @property
    def digest(self) -> str:
        """A digest of the files, hexadecimal."""
        digest = hashlib.sha256()
        for name, text in self.files:
            digest.update(f"{name} {len(text)}\n{text}".encode())
        return digest.hexdigest()


def read_contents(folder: Path, name: str) -> ScenarioContents:
    """Return the files of a scenario folder."""
    # Raises CannotOpenError when a file cannot be read, BadInputError when it is no ASCII text.
    found = [(file, read_source(folder / file).text) for file in RUN_FILES if (folder / file).exists()]
    return ScenarioContents(name, tuple(found))


def names_of(folders: Sequence[Path]) -> list[str]:
    """Return a name for each folder: as many of the last parts of its path as distinguish it from the others.

    >>> names_of([Path("/a/x"), Path("/a/y"), Path("/b/y")])
    ['x', 'a/y', 'b/y']
    """
    parts = [folder.parts for folder in folders]
    names = []
    for own in parts:
        length = 1
        while length < len(own) and sum(other[-length:] == own[-length:] for other in parts) > 1:
            length += 1
        names.append(Path(*own[-length:]).as_posix())
    return names


@contextmanager
def written(files: Sequence[Sequence[str]]) -> Iterator[Path]:
    """Write files into a temporary folder, and yield the folder; it is removed at the end of the `with` block."""
    with TemporaryDirectory(prefix="utak-sweep-", ignore_cleanup_errors=True) as made:
        for name, text in files:
            # Surrogate escapes stand for bytes that are not UTF-8; newline="" keeps line ends as they are.
            with (Path(made) / name).open("w", encoding="utf-8", errors="surrogateescape", newline="") as stream:
                stream.write(text)
        yield Path(made)
