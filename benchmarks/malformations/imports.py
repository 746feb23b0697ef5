"""Malformed files of other formats, imported: what is accepted must be a scenario that `utak check` accepts."""

import random
import shutil
import sys
from collections import Counter
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from benchmarks.malformations.mutate import spoil_bytes
from benchmarks.malformations.outcomes import came_out
from benchmarks.malformations.samples import HOSTILE_ELEMENTS, HOSTILE_HEADS, SAMPLES, TEXT_PGM, WIDE_PGM
from utak.simulator.cli.commands.files.import_scenario import FORMATS, scenario_files
from utak.simulator.importing.imported import ImportOptions
from utak.simulator.scenario.folder_writer import write_folder
from utak.simulator.scenario.scenario import read_scenario

HOSTILE_ELEMENT_SHARE = 0.3  # of the pictures that hold an element that is hostile, and are whole otherwise
HOSTILE_SHARE = 0.05  # of the files that begin with, or hold, something that an attacker would write


def write_malformed_file(folder: Path, draw: random.Random) -> Path:
    """Write one malformed file of another format into a new folder, and return its path."""
    folder.mkdir()
    end = draw.choice(sorted(SAMPLES))
    good = SAMPLES[end] if end != ".pgm" else draw.choice([SAMPLES[end], TEXT_PGM, WIDE_PGM])
    path = folder / f"sample{end}"
    raw = spoil_bytes(draw, good)
    if end == ".svg" and draw.random() < HOSTILE_ELEMENT_SHARE:
        raw = good.replace(b"</svg>", draw.choice(HOSTILE_ELEMENTS) + b"</svg>")
    if draw.random() < HOSTILE_SHARE:
        at = draw.choice([0, draw.randrange(len(raw) + 1)])
        raw = raw[:at] + draw.choice(HOSTILE_HEADS) + raw[at:]
    path.write_bytes(raw)
    if end == ".yaml":
        (folder / "map.pgm").write_bytes(draw.choice([SAMPLES[".pgm"], TEXT_PGM, spoil_bytes(draw, TEXT_PGM)]))
    return path


def read_imported(path: Path) -> None:
    """Import a file of another format, and check the scenario as an outcome of its own; raise what goes wrong."""
    reader = import_module(f"utak.simulator.importing.{FORMATS[path.suffix].module}")
    imported = reader.read(path, ImportOptions(untrusted=True))
    folder = path.parent / "scenario"
    write_folder(folder, scenario_files(imported, path.name))
    read_scenario(folder)


def imports(count: int, seed: int, keep: Path, read: Callable[[Path], None] = read_imported) -> Counter[str]:
    """Count the outcomes of `count` malformed files of other formats; faulty ones are kept in `keep`.

    read : imports a file.
    """
    outcomes: Counter[str] = Counter()
    for number in range(count):
        folder = keep / f"import-{seed}-{number}"
        path = write_malformed_file(folder, random.Random(f"{seed}-{number}"))
        result = came_out(lambda path=path: read(path))  # type: ignore[misc]
        outcomes[result] += 1
        if result.startswith("!"):
            print(f"{path}: {result}", file=sys.stderr)
        else:
            shutil.rmtree(folder)
    return outcomes
