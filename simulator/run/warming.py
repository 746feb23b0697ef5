"""The first run of an installation compiles geometry's kernels; here that is said once, and done on both of two cores.

Later runs find them in numba's cache. Nothing depends on this: a kernel that is not compiled yet is compiled when it
is called.
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

import geometry
from geometry.kernels.jit import tell
from kb.language.operating_system import end_with_parent, read_lines_from_parent
from utak_command import beside

PACKAGES = [Path(geometry.__file__).parent.with_name(name) for name in ("geometry", "kb", "planner", "simulator")]


def warm(carrying: bool, paths: str = "skeleton") -> None:
    """Compile the kernels that a robot needs, if they are not in the cache; say so on stderr.

    carrying : whether anything is to be carried. paths : the path-finder, as `--paths` names it.
    """
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        return
    missing = uncompiled([search, *([carry] if carrying else []), *([sightlines] if paths == "visibility" else [])])
    if not missing:
        return
    tell()
    mine, others = PROCESS_SPLIT[carrying] if search in missing else ((), ())
    _compile_beside([*mine, *(use for use in missing if use not in (*mine, *others))], others)


def warm_all() -> None:
    """Compile the kernels for everything, in two processes; those that are in the cache are loaded."""
    mine, others = PROCESS_SPLIT[True]
    _compile_beside((*mine, move), (*others, sightlines, change))


def _compile_beside(mine: Sequence[Callable[[], None]], others: Sequence[Callable[[], None]]) -> None:
    """Compile for some uses here and for others in a process beside this one, which ends when this one does."""
    if not others:
        compile_for(mine)
        return
    command = beside("simulator.run.warming", *(use.__name__ for use in others))
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=quiet, stderr=quiet) as other:
        try:
            compile_for(mine)
            if sys.dont_write_bytecode:
                compile_modules()
            other.wait()
        except BaseException:
            other.kill()
            raise


def uncompiled(uses: Collection[Callable[[], None]]) -> list[Callable[[], None]]:
    """Return the uses whose kernels are not in the cache of this installation."""
    places = [place for place in _caches() if place.is_dir()]
    return [use for use in uses if not any(next(place.rglob(f"{LONGEST_KERNEL[use]}-*.nbi"), None) for place in places)]


def count_cached_kernels() -> int:
    """Return how many of our kernels are in the cache."""
    names = {path.stem for path in Path(geometry.__file__).parent.rglob("*.py")}
    found = {path.name.split("-")[0] for place in _caches() if place.is_dir() for path in place.rglob("*.nbi")}
    return sum(name.split(".")[0] in names for name in found)


def _caches() -> list[Path]:
    """Where numba keeps compiled kernels: the first of these that it can write to."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given:
        return [Path(given)]
    found = [Path(geometry.__file__).parent]
    users = [os.environ.get(name) for name in ("XDG_CACHE_HOME", "LOCALAPPDATA")]
    with suppress(RuntimeError):  # a user without a home
        users += [str(Path.home() / ".cache"), str(Path.home() / "Library" / "Caches")]
    return found + [Path(folder) / "numba" for folder in users if folder]


def compile_modules() -> None:
    """Keep the bytecode of our modules beside their kernels.

    Where Python was told to keep none (PYTHONDONTWRITEBYTECODE, as in many containers), a checkout would be compiled
    again at every start, which takes a third of the time to the first command.
    """
    for package in PACKAGES:
        compileall.compile_dir(package, quiet=2)


def compile_for(uses: Sequence[Callable[[], None]]) -> None:
    """Do some things once, for the kernels that they need."""
    gc.disable()  # a compiler makes millions of objects that live: looking for garbage among them takes a tenth of it
    try:
        for use in uses:
            use()
    finally:
        gc.enable()


def search() -> None:
    """Look for ways: half of it all."""
    import numpy as np

    from geometry.raster.geodesic import reach
    from geometry.routes.queries import rehearse

    rehearse()
    reach(np.ones((2, 2), np.bool_), 0, 0)


def see() -> None:
    """Find regions and their shapes, and draw pictures."""
    import numpy as np

    from geometry.counts.gibbs import DRAWN, Counts, pictures
    from geometry.counts.moments import blobs
    from geometry.raster.components import boxes, components

    boxes(components(np.ones((2, 2), np.bool_)).labels, 1)
    drawn, full = np.full((1, 1), DRAWN, np.int8), np.ones((1, 1), np.int8)
    one = np.ones(1, np.int16)
    counts = Counts(np.zeros((1, 1), np.int32), np.ones((1, 1), np.int16), one, one)
    blobs(pictures(drawn, counts, full[None], 1, 1)[0], drawn)
    tell_counts()


def tell_counts() -> None:
    """Settle what counts settle."""
    import numpy as np

    from geometry.counts.contradictions import contradicting
    from geometry.counts.settle import misfits, residue, settle
    from geometry.counts.uncover import uncover

    where, one = np.zeros((1, 2), np.int32), np.ones(1, np.int16)
    fields = where, np.array([[1, 0]], np.int16), one, one
    settle(np.full(1, -1, np.int8), np.full(1, -1, np.int16), *fields, np.ones(1, np.bool_), 0)
    misfits(np.ones(1, np.int8), *fields, np.zeros(1, np.bool_))
    residue(np.ones(1, np.int8), *fields)
    field, ranges, mask = np.zeros((1, 1), np.int32), np.zeros((1, 1, 2), np.int16), np.ones((1, 1), np.bool_)
    weight = np.ones((1, 1), np.int16)
    contradicting(field, field, weight, one, np.zeros((1, 2), np.int64), ranges, np.zeros((0, 3)))
    uncover(field, field, weight, ranges[0], mask, mask, 0, 0, 0, 0)


def sightlines() -> None:
    """Look along straight lines, as `--paths visibility` does."""
    import numpy as np

    from geometry.pathfinders.visibility_graph import visibility_way

    free = np.ones((5, 5), np.bool_)
    free[2, 2] = False
    visibility_way(free, (0.5, 2.5), (4.5, 2.5))


def change() -> None:
    """Change a screen, and keep ways away from a place."""
    import numpy as np

    free = np.ones((9, 12), np.bool_)
    free[4, 3:9] = False
    screen = geometry.Screen(free).changed([4, 0, 1], [6, 5, 5], [True, False, False])
    screen.routes((0.5, 4.5), (11.5, 4.5), k=4)
    screen.shortest((0.5, 4.5), (11.5, 4.5))


def move() -> None:
    """Move a shape past another at any angle."""
    import shapely

    from geometry.cspace.plan_motion import plan_motion
    from geometry.motion.se2 import Pose

    plan_motion(shapely.box(0, 0, 3, 1), [shapely.box(4, -3, 5, 1.5)], Pose(0.0, 0.0, 0.0), Pose(6.0, 0.0, 90.0))


def tell_shapes() -> None:
    """Tell what shape a thing has."""
    import numpy as np

    from geometry.shapes.fit import fit_shapes

    fit_shapes(np.array([[1, 1, 1, 0], [1, 1, 1, 1], [0, 1, 1, 1]], np.bool_))


def survey() -> None:
    """Make a screen, and find its necks and parts."""
    import numpy as np

    free = np.ones((12, 20), np.bool_)
    free[:4, 9:11] = free[7:, 9:11] = False
    screen = geometry.Screen(free)
    screen.parts(screen.passages())


def walk() -> None:
    """Run against something, go straight, and go round something."""
    import numpy as np
    import shapely

    from geometry.motion.first_contact import ContactBody, Obstacles
    from geometry.motion.se2 import Translate
    from geometry.raster.line_of_sight import straight
    from geometry.raster.rasterize import squares
    from geometry.raster.winding import winding_way

    free = np.ones((3, 3), np.bool_)
    free[1, 1] = False
    straight(free, 0, 0, 2)
    winding_way(free, (0, 0), (0, 0), (1.5, 1.5), 1)
    squares(shapely.box(0, 0, 1, 1), 1, 1)
    Obstacles([shapely.box(10, 0, 11, 5)]).first_contact(ContactBody(None, [(4.0, 1.0)]), Translate(8.0, 0.0))


def carry() -> None:
    """Bring something somewhere, and turn it."""
    import numpy as np
    import shapely

    from geometry.manipulation.plan_carrying import Inside, plan_carrying
    from geometry.motion.first_contact import ContactBody, Obstacles
    from geometry.motion.se2 import Rotate

    body = ContactBody(shapely.box(1, 1, 3, 3), [(4.0, 1.0)])
    wall = Obstacles([shapely.box(10, 0, 11, 5)])
    wall.first_contact(body, Rotate(30.0, (4.0, 1.0)))
    wall.pushes(body, np.array([[1.0, 0.0]]))
    free = np.ones((6, 16), np.bool_)
    plan_carrying(shapely.box(3, 2, 5, 3), free, (1.5, 1.5), Inside(shapely.box(10, 0, 16, 6)))


PROCESS_SPLIT: dict[bool, tuple[tuple[Callable[[], None], ...], ...]] = {
    False: ((search, walk), (see, survey, tell_shapes)),
    True: ((search, see), (survey, tell_shapes, walk, carry)),
}


LONGEST_KERNEL = {search: "router.itineraries", carry: "astar.haul", sightlines: "visibility_graph.line_open"}
"""A kernel of each use by whose index in numba's cache the use is known to have been compiled: the longest."""


def main(names: Sequence[str]) -> None:
    """Compile for the uses of these names: the work of the other process."""
    uses = {use.__name__: use for use in (*(use for half in PROCESS_SPLIT[True] for use in half), sightlines, change)}
    compile_for([uses[name] for name in names])


if __name__ == "__main__":
    end_with_parent()
    threading.Thread(target=next, args=(read_lines_from_parent(),), daemon=True).start()
    main(sys.argv[1:])
