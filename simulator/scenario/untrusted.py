"""Untrusted scenarios: with `--untrusted`, no file is read through a link that leads out of the scenario's folder."""

import argparse
from pathlib import Path

from utak.kb.language.diagnostics import CannotOpenError
from utak.kb.language.source_text import lies_outside

SCENARIO_FILES = ("world.lp", "world.txt", "start.lp", "goal.lp", "expect.lp", "trial.lp")  # all files of a scenario


def refuse_links(options: argparse.Namespace, place: Path | str, root: Path | str | None = None) -> None:
    """Raise CannotOpenError when `--untrusted` is given and a link leads out of the scenario's folder."""
    if options.untrusted:
        refuse_outside_links(place, root)


def refuse_outside_links(place: Path | str, root: Path | str | None = None) -> None:
    """Raise CannotOpenError when a link leads out of the scenario's folder."""
    place = Path(place)
    files = [place / name for name in SCENARIO_FILES] if place.is_dir() else [place]
    if place.is_dir():
        files += sorted(path for path in place.glob("*.lp") if path.name not in SCENARIO_FILES)
    within = [place] if root is not None and place != Path(root) else []
    for path in [*within, *files]:
        if path.exists() and lies_outside(path, root if path in within else None):
            raise CannotOpenError(str(path), "it is a link out of its folder, which --untrusted refuses")
