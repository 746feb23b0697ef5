"""Starts the `utak` command, and the processes that it starts beside itself.

Our packages have plain names, such as `planner`. Here they are found beside this file alone, whatever folders of users
stand on Python's path. As a program, `python -I utak_command.py PLACES MODULE ARGUMENT...` runs one of our modules:
`-I` keeps the working directory, PYTHONPATH and the user's start-up files out.
"""

import os
import sys

TYPE_CHECKING = False  # typing's own is not imported: until main begins, Ctrl-C shows where Python was
if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType

HOME = os.path.dirname(os.path.abspath(__file__))  # noqa: PTH100, PTH120 (pathlib takes a third of the time to start)
OURS = frozenset({"geometry", "kb", "planner", "simulator", "benchmarks"})
OTHERS = ("clingo", "numpy", "shapely", "networkx", "numba")


class Beside:
    """Finds our packages beside this file; of all other modules it knows nothing."""

    @staticmethod
    def find_spec(
        name: str, path: "Sequence[str] | None" = None, target: "ModuleType | None" = None
    ) -> "ModuleSpec | None":
        """Return where one of our packages is; None for everything else, which Python then finds as it always does."""
        from importlib.machinery import PathFinder  # loaded by find_ours_here: nothing is looked for to get it

        return PathFinder.find_spec(name, [HOME], target) if name in OURS else None


def find_ours_here() -> None:
    """Make every later import of one of our packages take the one beside this file."""
    import importlib.machinery  # noqa: F401 (which is looked for in the usual way)

    if not any(getattr(finder, "__qualname__", "") == Beside.__qualname__ for finder in sys.meta_path):
        sys.meta_path.insert(0, Beside)


def beside(module: str, *arguments: str) -> list[str]:
    """Return the command line that runs one of our modules in an isolated process of this Python."""
    return [sys.executable, "-I", os.path.join(HOME, "utak_command.py"), _places(), module, *arguments]  # noqa: PTH118


def _places() -> str:
    """The folders in which this process finds the packages of others, for a process that would not find them alone."""
    from importlib.util import find_spec

    origins = [spec.origin for spec in map(find_spec, OTHERS) if spec is not None and spec.origin]
    return os.pathsep.join(sorted({os.path.dirname(os.path.dirname(origin)) for origin in origins}))  # noqa: PTH120


def exit_at_ctrl_c() -> None:
    """End at once when Ctrl-C is pressed: nothing has begun yet. A background job, for which it is ignored, goes on."""
    import signal

    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, lambda *_: os._exit(130))


def main() -> int:
    """Run `utak` with the arguments of this process and return its exit code."""
    exit_at_ctrl_c()
    find_ours_here()
    from simulator.cli.main import main as run

    return run()


def run_module(places: str, module: str, *arguments: str) -> None:
    """Run one of our modules as a program. places : where to look for what is not found otherwise."""
    from importlib.machinery import PathFinder
    from runpy import run_module as run

    find_ours_here()
    if any(PathFinder.find_spec(name) is None for name in OTHERS):  # as with `pip install --user`
        sys.path += [place for place in places.split(os.pathsep) if place and place not in sys.path]
    sys.argv = [module, *arguments]
    run(module, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    run_module(*sys.argv[1:])
