"""Which state of Utak's code this is, and the versions of the libraries that decide what a run gives."""

import hashlib
import re
import sys
from collections.abc import Sequence
from functools import cache
from importlib import metadata
from pathlib import Path

from utak.launcher import DEPENDENCIES, PROJECT_FOLDER, folder_of

DECIDING_PACKAGES = ("geometry", "kb", "planner", "simulator")  # all of ours that take part in a run
DIGEST_LENGTH = 16  # hexadecimal digits: two states of the code differ in them for all that is likely; a convention


@cache
def code_identity() -> dict[str, str]:
    """Return the versions by name: `utak`, `code` (a digest of its programs and encodings), `python`, and libraries."""
    return {
        "utak": utak_version(),
        "code": code_digest([Path(folder_of(name)) for name in DECIDING_PACKAGES]),
        "python": ".".join(map(str, sys.version_info[:2])),
        **{name: metadata.version(name) for name in DEPENDENCIES},
    }


def utak_version() -> str:
    """Return the version of this code: that of the checkout, else that of the installed package; "?" for neither."""
    project = Path(PROJECT_FOLDER) / "pyproject.toml"
    if project.is_file():
        found = re.search(r'^name = "utak"\nversion = "([^"]+)"', project.read_text(encoding="utf-8"), re.MULTILINE)
        if found:
            return found[1]
    try:
        return metadata.version("utak")
    except metadata.PackageNotFoundError:
        return "?"


def code_digest(folders: Sequence[Path]) -> str:
    """Return a digest of all programs and encodings in some packages' folders, wherever these lie."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted(folder.rglob("*")):
            if path.suffix in (".py", ".lp") and path.is_file():
                contents = path.read_bytes().replace(b"\r\n", b"\n")
                digest.update(f"{path.relative_to(folder.parent).as_posix()} {len(contents)}\n".encode())
                digest.update(contents)
    return digest.hexdigest()[:DIGEST_LENGTH]


def difference(theirs: dict[str, str], ours: dict[str, str]) -> str:
    """Return in words how two identities differ; "" when they do not.

    >>> difference({"utak": "0.1"}, {"utak": "0.2"})
    'utak 0.1, not 0.2'
    """
    parts = [
        f"{name} {theirs.get(name, 'absent')}, not {ours.get(name, 'absent')}"
        for name in {**ours, **theirs}
        if theirs.get(name) != ours.get(name)
    ]
    return ", ".join(parts)
