"""The first run of an installation compiles geometry's kernels; here that is said once, and done on both of two cores.

Later runs find them in numba's cache. Nothing depends on this: a kernel that is not compiled yet is compiled when it
is called.
"""

import compileall
import gc
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import geometry
from geometry.compiled import tell

PACKAGES = [Path(geometry.__file__).parent.with_name(name) for name in ("geometry", "kb", "planner", "simulator")]
INDEX = "itinerary.itineraries-*.nbi"  # numba's index of the kernel that takes longest


def warm(carrying: bool) -> None:
    """Compile the kernels that a robot needs, if they are not in the cache; say so on stderr.

    carrying : whether anything is to be carried.
    """
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0" or not cold():
        return
    tell()
    mine, others = HALVES[carrying]
    command = [sys.executable, "-m", "simulator.warming", *(use.__name__ for use in others)]
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL):
        compile_for(mine)
        if sys.dont_write_bytecode:
            compile_modules()


def cold() -> bool:
    """Is there no compiled kernel in the cache of this installation?"""
    elsewhere = os.environ.get("NUMBA_CACHE_DIR")
    places = (
        [Path(elsewhere)] if elsewhere else [Path(geometry.__file__).parent / "__pycache__", Path.home() / ".cache"]
    )
    return not any(place.is_dir() and next(place.rglob(INDEX), None) for place in places)


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

    from geometry.questions import rehearse
    from geometry.reach import reach

    rehearse()
    reach(np.ones((2, 2), np.bool_), 0, 0)


def see() -> None:
    """Find regions and their shapes, and draw pictures."""
    import numpy as np

    from geometry.blobs import blobs
    from geometry.components import boxes, components
    from geometry.sketch import DRAWN, Counts, pictures

    boxes(components(np.ones((2, 2), np.bool_)).labels, 1)
    drawn, full = np.full((1, 1), DRAWN, np.int8), np.ones((1, 1), np.int8)
    one = np.ones(1, np.int16)
    counts = Counts(np.zeros((1, 1), np.int32), np.ones((1, 1), np.int16), one, one)
    blobs(pictures(drawn, counts, full[None], 1, 1)[0], drawn)
    tell_counts()


def tell_counts() -> None:
    """Settle what counts settle."""
    import numpy as np

    from geometry.settling import misfits, residue, settle

    where, one = np.zeros((1, 2), np.int32), np.ones(1, np.int16)
    fields = where, np.array([[1, 0]], np.int16), one, one
    settle(np.full(1, -1, np.int8), np.full(1, -1, np.int16), *fields, np.ones(1, np.bool_), 0)
    misfits(np.ones(1, np.int8), *fields, np.zeros(1, np.bool_))
    residue(np.ones(1, np.int8), *fields)


def tell_shapes() -> None:
    """Tell what shape a thing has."""
    import numpy as np

    from geometry.template import fit_shapes

    fit_shapes(np.array([[1, 1, 1, 0], [1, 1, 1, 1], [0, 1, 1, 1]], np.bool_))


def survey() -> None:
    """Make a screen, and find its necks and parts."""
    import numpy as np

    free = np.ones((12, 20), np.bool_)
    free[:4, 9:11] = free[7:, 9:11] = False
    screen = geometry.Screen(free)
    screen.parts(screen.passages())


def walk() -> None:
    """Run against something."""
    import shapely

    from geometry.contact import Body, Obstacles
    from geometry.digital import squares
    from geometry.rigid import Translate

    squares(shapely.box(0, 0, 1, 1), 1, 1)
    Obstacles([shapely.box(10, 0, 11, 5)]).first_contact(Body(None, [(4.0, 1.0)]), Translate(8.0, 0.0))


def carry() -> None:
    """Bring something somewhere, and turn it."""
    import numpy as np
    import shapely

    from geometry.carrying import Inside, plan_carrying
    from geometry.contact import Body, Obstacles
    from geometry.rigid import Rotate

    body = Body(shapely.box(1, 1, 3, 3), [(4.0, 1.0)])
    Obstacles([shapely.box(10, 0, 11, 5)]).first_contact(body, Rotate(30.0, (4.0, 1.0)))
    free = np.ones((6, 16), np.bool_)
    plan_carrying(shapely.box(3, 2, 5, 3), free, (1.5, 1.5), Inside(shapely.box(10, 0, 16, 6)))


HALVES: dict[bool, tuple[tuple[Callable[[], None], ...], ...]] = {
    False: ((search, walk), (see, survey, tell_shapes)),
    True: ((search, see), (survey, tell_shapes, walk, carry)),
}


def main(names: Sequence[str]) -> None:
    """Compile for the uses of these names: the work of the other process."""
    compile_for([use for half in HALVES[True] for use in half if use.__name__ in names])


if __name__ == "__main__":
    main(sys.argv[1:])
