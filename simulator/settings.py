"""The options of a run that decide what happens in it."""

from dataclasses import dataclass
from pathlib import Path

from kb.source import read_source


@dataclass(frozen=True)
class Settings:
    """The options of a run that decide what happens in it."""

    seed: int = 0
    noise: float = 0.0
    paths: str = "skeleton"
    max_steps: int = 200
    kb_files: tuple[str, ...] = ()
    pull: bool = True


def kb_files_named(paths: list[str]) -> tuple[str, ...]:
    """Return the rule files of --kb, each read once to make sure that it can be."""
    for path in paths:
        read_source(Path(path))
    return tuple(paths)
