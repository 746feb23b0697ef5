"""Compilation of geometry's kernels before the first run of an installation: announced, and done in two processes.

Later runs find the kernels in numba's cache. Nothing depends on this module: a kernel that is not compiled yet is
compiled when it is called. A *use* is a function that calls the kernels which one kind of work needs.
"""

import compileall
import gc
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from pathlib import Path

from utak.geometry import Screen
from utak.geometry.kernels.jit import announce_compiling
from utak.kb.language.operating_system import end_with_parent, read_lines_from_parent
from utak.launcher import folder_of, isolated_command

Use = Callable[[], None]
# The folders of our packages.
PACKAGES = [Path(folder_of(name)) for name in ("geometry", "kb", "planner", "simulator")]


class KernelCompiler:
    """The compiler of an installation: it finds the uses that are not compiled yet, and compiles them."""

    def __init__(self, packages: Sequence[Path] = PACKAGES) -> None:
        self.packages = packages

    def uncompiled(self, uses: Collection[Use]) -> list[Use]:
        """Return those uses whose kernels are not in the cache of this installation."""
        places = [place for place in _caches() if place.is_dir()]
        return [
            use for use in uses if not any(next(place.rglob(f"{LONGEST_KERNEL[use]}-*.nbi"), None) for place in places)
        ]

    def announce(self) -> None:
        """Print, once in a process, that kernels are being compiled."""
        announce_compiling()

    def compile_for(self, uses: Sequence[Use]) -> None:
        """Call each use once, which compiles its kernels."""
        gc.disable()  # a compiler makes millions of lasting objects; garbage collection would take a tenth of the time
        try:
            for use in uses:
                use()
        finally:
            gc.enable()

    def second_process_command(self, uses: Sequence[Use]) -> list[str]:
        """Return the command line of the process that compiles for some uses."""
        return isolated_command("utak.simulator.run.warming", *(use.__name__ for use in uses))

    def compile_in_two_processes(self, mine: Sequence[Use], others: Sequence[Use]) -> None:
        """Compile for some uses here, and for others in a second process, which ends when this one ends."""
        if not others:
            self.compile_for(mine)
            return
        command, quiet = self.second_process_command(others), subprocess.DEVNULL
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=quiet, stderr=quiet) as other:
            try:
                self.compile_for(mine)
                if sys.dont_write_bytecode:
                    self.compile_modules()
                other.wait()
            except BaseException:
                other.kill()
                raise

    def compile_modules(self) -> None:
        """Write the bytecode of our modules next to their sources."""
        for package in self.packages:
            compileall.compile_dir(package, quiet=2)


THIS_INSTALLATION = KernelCompiler()


def warm(carrying: bool, paths: str = "skeleton", compiler: KernelCompiler = THIS_INSTALLATION) -> None:
    """Compile the kernels that a robot needs, unless they are in the cache; announce it on the standard error."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        return
    needed = [search, *([carry] if carrying else []), *([sightlines] if paths == "visibility" else [])]
    missing = compiler.uncompiled(needed)
    if not missing:
        return
    compiler.announce()
    mine, others = PROCESS_SPLIT[carrying] if search in missing else ((), ())
    compiler.compile_in_two_processes([*mine, *(use for use in missing if use not in (*mine, *others))], others)


def warm_all() -> None:
    """Compile the kernels for all uses in two processes; kernels in the cache are loaded."""
    mine, others = PROCESS_SPLIT[True]
    THIS_INSTALLATION.compile_in_two_processes((*mine, move), (*others, *RARE_USES))


def count_cached_kernels() -> int:
    """Return the number of our kernels in the cache."""
    names = {path.stem for path in PACKAGES[0].rglob("*.py")}
    found = {path.name.split("-")[0] for place in _caches() if place.is_dir() for path in place.rglob("*.nbi")}
    return sum(name.split(".")[0] in names for name in found)


def _caches() -> list[Path]:
    """Return the folders in which numba may keep compiled kernels; it takes the first that it can write to."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given:
        return [Path(given)]
    found = [PACKAGES[0]]
    users = [os.environ.get(name) for name in ("XDG_CACHE_HOME", "LOCALAPPDATA")]
    with suppress(RuntimeError):  # a user without a home
        users += [str(Path.home() / ".cache"), str(Path.home() / "Library" / "Caches")]
    return found + [Path(folder) / "numba" for folder in users if folder]


def search() -> None:
    """Call the kernels that find routes; about half of all kernels."""
    import numpy as np

    from utak.geometry.raster.geodesic import reach
    from utak.geometry.routes.queries import compile_route_kernels

    compile_route_kernels()
    reach(np.ones((2, 2), np.bool_), 0, 0)


def see() -> None:
    """Call the kernels that find regions and their shapes, and sample completions."""
    import numpy as np

    from utak.geometry.counts.gibbs import DRAWN, Counts, pictures
    from utak.geometry.counts.moments import blobs
    from utak.geometry.raster.components import bounding_boxes, components

    bounding_boxes(components(np.ones((2, 2), np.bool_)).labels, 1)
    drawn, full = np.full((1, 1), DRAWN, np.int8), np.ones((1, 1), np.int8)
    one = np.ones(1, np.int16)
    counts = Counts(np.zeros((1, 1), np.int32), np.ones((1, 1), np.int16), one, one)
    blobs(pictures(drawn, counts, full[None], 1, 1)[0], drawn)
    tell_counts()


def tell_counts() -> None:
    """Call the kernels that derive squares from counts."""
    import numpy as np

    from utak.geometry.counts.contradictions import total_contradictions
    from utak.geometry.counts.settle import misfits, remaining_counts, settle
    from utak.geometry.counts.uncover import remove_covered_squares

    where, one = np.zeros((1, 2), np.int32), np.ones(1, np.int16)
    fields = where, np.array([[1, 0]], np.int16), one, one
    settle(np.full(1, -1, np.int8), np.full(1, -1, np.int16), *fields, np.ones(1, np.bool_), 0)
    misfits(np.ones(1, np.int8), *fields, np.zeros(1, np.bool_))
    remaining_counts(np.ones(1, np.int8), *fields)
    field, ranges, mask = np.zeros((1, 1), np.int32), np.zeros((1, 1, 2), np.int16), np.ones((1, 1), np.bool_)
    weight = np.ones((1, 1), np.int16)
    total_contradictions(field, field, weight, one, np.zeros((1, 2), np.int64), ranges, np.zeros((0, 3)))
    remove_covered_squares(field, field, weight, ranges[0], mask, mask, 0, 0, 0, 0)


def sightlines() -> None:
    """Call the kernels that follow lines of sight, as `--paths visibility` does."""
    import numpy as np

    from utak.geometry.pathfinders.visibility_graph import visibility_path

    free = np.ones((5, 5), np.bool_)
    free[2, 2] = False
    visibility_path(free, (0.5, 2.5), (4.5, 2.5))


def many_routes() -> None:
    """Call the kernels that find several routes and the shortest of all, and those of a skeleton that is a ring."""
    import numpy as np

    free = np.ones((9, 12), np.bool_)
    free[4, 3:6] = free[4, 7:9] = free[0:2, 5] = False
    screen = Screen(free)
    screen.routes((0.5, 4.5), (11.5, 4.5), k=4)
    screen.shortest((0.5, 4.5), (11.5, 4.5))
    free[1:8, 1:11], free[2:7, 2:10] = True, False
    free[[0, 8]], free[:, [0, 11]] = False, False
    assert Screen(free).pathgraph_arrays and Screen(free).skeleton.any()


def move() -> None:
    """Call the kernels that plan a motion of a shape past another at any angle."""
    import shapely

    from utak.geometry.cspace.plan_motion import plan_motion
    from utak.geometry.motion.se2 import Pose

    plan_motion(shapely.box(0, 0, 3, 1), [shapely.box(4, -3, 5, 1.5)], Pose(0.0, 0.0, 0.0), Pose(6.0, 0.0, 90.0))


def tell_shapes() -> None:
    """Call the kernels that fit shape classes to a thing."""
    import numpy as np

    from utak.geometry.shapes.fit import fit_shapes

    fit_shapes(np.array([[1, 1, 1, 0], [1, 1, 1, 1], [0, 1, 1, 1]], np.bool_))


def survey() -> None:
    """Call the kernels that make a screen and find its passages and parts."""
    import numpy as np

    free = np.ones((12, 20), np.bool_)
    free[:4, 9:11] = free[7:, 9:11] = False
    screen = Screen(free)
    screen.parts(screen.passages())


def walk() -> None:
    """Call the kernels that move to the first contact, straight, and around a place."""
    import numpy as np
    import shapely

    from utak.geometry.motion.first_contact import ContactBody, Obstacles
    from utak.geometry.motion.se2 import Translate
    from utak.geometry.raster.line_of_sight import straight
    from utak.geometry.raster.rasterize import squares, window_of
    from utak.geometry.raster.surroundings import survey_square
    from utak.geometry.raster.winding import shortest_path_with_crossing_number

    free = np.ones((3, 3), np.bool_)
    free[1, 1] = False
    straight(free, 0, 0, 2)
    shortest_path_with_crossing_number(free, (0, 0), (0, 0), (1.5, 1.5), 1)
    squares(shapely.box(0, 0, 1, 1), 1, 1)
    window_of(np.array([[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0]]))
    one, offsets = np.zeros(1, np.uint8), np.zeros((1, 3), np.int64)
    survey_square(one[:, None], 0, 0, offsets, offsets[:, :2].copy(), 0, one, one.copy())
    Obstacles([shapely.box(10, 0, 11, 5)]).first_contact(ContactBody(None, [(4.0, 1.0)]), Translate(8.0, 0.0))


def carry() -> None:
    """Call the kernels that plan to carry an object and to turn it."""
    import numpy as np
    import shapely

    from utak.geometry.manipulation.plan_carrying import Inside, plan_carrying
    from utak.geometry.motion.first_contact import ContactBody, Obstacles
    from utak.geometry.motion.se2 import Rotate

    body = ContactBody(shapely.box(1, 1, 3, 3), [(4.0, 1.0)])
    wall = Obstacles([shapely.box(10, 0, 11, 5)])
    wall.first_contact(body, Rotate(30.0, (4.0, 1.0)))
    wall.pushes(body, np.array([[1.0, 0.0]]))
    free = np.ones((6, 16), np.bool_)
    plan_carrying(shapely.box(3, 2, 5, 3), free, (1.5, 1.5), Inside(shapely.box(10, 0, 16, 6)))


# Without and with carrying: the uses that this process compiles, and those that the second process compiles meanwhile.
PROCESS_SPLIT: dict[bool, tuple[tuple[Use, ...], ...]] = {
    False: ((search, walk), (see, survey, tell_shapes)),
    True: ((search, see), (survey, tell_shapes, walk, carry)),
}


# What few runs need: compiled by `utak warm`, else when it is called.
RARE_USES: tuple[Use, ...] = (sightlines, many_routes)
# The kernel of each use that takes longest to compile, as numba's cache names it. When it is in the cache, the use is
# taken for compiled.
LONGEST_KERNEL = {
    search: "router.itineraries",
    carry: "astar.find_carrying_path",
    sightlines: "visibility_graph.line_open",
}


def main(names: Sequence[str], compiler: KernelCompiler = THIS_INSTALLATION) -> None:
    """Compile for the uses with these names: the work of the second process."""
    uses = {use.__name__: use for use in (*(use for half in PROCESS_SPLIT[True] for use in half), *RARE_USES)}
    compiler.compile_for([uses[name] for name in names])


if __name__ == "__main__":
    end_with_parent()
    threading.Thread(target=next, args=(read_lines_from_parent(),), daemon=True).start()
    main(sys.argv[1:])
