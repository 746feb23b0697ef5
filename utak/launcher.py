"""The starting point of the `utak` command and of the processes that it starts.

The package `utak` is imported from where this file lies, whatever folders users have on Python's path. As a program,
`python -I launcher.py PLACES MODULE ARGUMENT...` runs one of our modules. The option `-I` ignores the working
directory, PYTHONPATH and the user's start-up files.
"""

import os
import sys

TYPE_CHECKING = False  # not imported from typing: until main begins, Ctrl-C would print a traceback
if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType

# The folder of the package `utak`, and the one that holds it. Importing pathlib takes a third of the time to start.
PACKAGE_FOLDER = os.path.dirname(os.path.abspath(__file__))  # noqa: PTH100, PTH120
PROJECT_FOLDER = os.path.dirname(PACKAGE_FOLDER)  # noqa: PTH120
OUR_PACKAGES = frozenset({"utak", "benchmarks"})  # that are imported from that folder only
# The packages of others on which ours depend.
DEPENDENCIES = ("clingo", "numpy", "shapely", "networkx", "numba")


class OurPackageFinder:
    """An import finder for our packages where this file lies; it knows no other modules."""

    @staticmethod
    def find_spec(
        name: str, path: "Sequence[str] | None" = None, target: "ModuleType | None" = None
    ) -> "ModuleSpec | None":
        """Return the place of one of our packages; None for every other module, which Python then finds as usual."""
        from importlib.machinery import PathFinder  # loaded by install_package_finder, so nothing is searched here

        return PathFinder.find_spec(name, [PROJECT_FOLDER], target) if name in OUR_PACKAGES else None


def folder_of(package: str) -> str:
    """Return the folder of a package below `utak`: within it where it is installed, beside it in a checkout."""
    inner = os.path.join(PACKAGE_FOLDER, package)  # noqa: PTH118
    return inner if os.path.isdir(inner) else os.path.join(PROJECT_FOLDER, package)  # noqa: PTH112, PTH118


def install_package_finder() -> None:
    """Make every later import of one of our packages take the one where this file lies."""
    import importlib.machinery  # noqa: F401 (found in the usual way, before the finder is installed)

    if not any(getattr(finder, "__qualname__", "") == OurPackageFinder.__qualname__ for finder in sys.meta_path):
        sys.meta_path.insert(0, OurPackageFinder)


def isolated_command(module: str, *arguments: str) -> list[str]:
    """Return the command line that runs one of our modules in an isolated process with this Python.

    module : the name of the module. arguments : its command line.
    """
    return [sys.executable, "-I", os.path.join(PACKAGE_FOLDER, "launcher.py"), _places(), module, *arguments]  # noqa: PTH118


def _places() -> str:
    """Return the folders of the installed dependencies, joined by os.pathsep: an isolated process may not find them."""
    from importlib.util import find_spec

    origins = [spec.origin for spec in map(find_spec, DEPENDENCIES) if spec is not None and spec.origin]
    return os.pathsep.join(sorted({os.path.dirname(os.path.dirname(origin)) for origin in origins}))  # noqa: PTH120


def exit_at_ctrl_c() -> None:
    """Let Ctrl-C end this process at once with exit code 130, since nothing has begun yet.

    In a background job, where Ctrl-C is ignored, it stays ignored.
    """
    import signal

    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, lambda *_: os._exit(130))


def main() -> int:
    """Run `utak` with the arguments of this process and return its exit code."""
    exit_at_ctrl_c()
    install_package_finder()
    from importlib import import_module

    code: int = import_module("utak.simulator.cli.main").main()
    return code


def run_module(places: str, module: str, *arguments: str, dependencies: "Sequence[str]" = DEPENDENCIES) -> None:
    """Run one of our modules as a program.

    places : folders to search for dependencies that are not found otherwise, joined by os.pathsep. dependencies : the
    packages that the module needs.
    """
    from importlib.machinery import PathFinder
    from runpy import run_module as run

    install_package_finder()
    if any(PathFinder.find_spec(name) is None for name in dependencies):  # as with `pip install --user`
        sys.path += [place for place in places.split(os.pathsep) if place and place not in sys.path]
    sys.argv = [module, *arguments]
    run(module, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    run_module(*sys.argv[1:])
