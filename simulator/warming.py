"""The first run of an installation compiles geometry's kernels; here that is said once, and done on both of two cores.

Later runs find them in numba's cache. Nothing depends on this: a kernel that is not compiled yet is compiled when it
is called.
"""

import gc
import os
import subprocess
import sys
from pathlib import Path

import geometry
from geometry.compiled import tell

INDEX = "itinerary.itineraries-*.nbi"  # numba's index of the kernel that takes longest


def warm() -> None:
    """Compile the kernels that a robot needs, if they are not in the cache; say so on stderr."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0" or not cold():
        return
    tell()
    command = [sys.executable, "-m", "simulator.warming"]
    gc.disable()  # a compiler makes millions of objects that live: looking for garbage among them takes a tenth of it
    try:
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL):
            compile_longest()
    finally:
        gc.enable()


def cold() -> bool:
    """Is there no compiled kernel in the cache of this installation?"""
    elsewhere = os.environ.get("NUMBA_CACHE_DIR")
    places = (
        [Path(elsewhere)] if elsewhere else [Path(geometry.__file__).parent / "__pycache__", Path.home() / ".cache"]
    )
    return not any(place.is_dir() and next(place.rglob(INDEX), None) for place in places)


def compile_longest() -> None:
    """The searches for ways, which take half of the time and share much of their code."""
    import numpy as np

    from geometry.questions import rehearse
    from geometry.reach import reach

    rehearse()
    reach(np.ones((2, 2), np.bool_), 0, 0)


def compile_others() -> None:
    """Use what else a run needs: screens, necks, contacts, pictures and the shapes of images."""
    import numpy as np
    import shapely

    from geometry.components import boxes, components
    from geometry.contact import Body, Obstacles
    from geometry.rigid import Rotate, Translate
    from geometry.sketch import DRAWN, Counts, blobs, pictures
    from geometry.template import fit_shapes

    free = np.ones((12, 20), np.bool_)
    free[:4, 9:11] = free[7:, 9:11] = False
    screen = geometry.Screen(free)
    screen.parts(screen.passages())
    walls = Obstacles([shapely.box(10, 0, 11, 5)])
    for body in (Body(shapely.box(1, 1, 3, 3), [(4.0, 1.0)]), Body(None, [(4.0, 1.0)])):
        walls.first_contact(body, Translate(8.0, 0.0))
        walls.first_contact(body, Rotate(30.0, (4.0, 1.0)))
    boxes(components(np.ones((2, 2), np.bool_)).labels, 1)
    drawn, full = np.full((1, 1), DRAWN, np.int8), np.ones((1, 1), np.int8)
    one = np.ones(1, np.int16)
    counts = Counts(np.zeros((1, 1), np.int32), np.ones((1, 1), np.int16), one, one)
    blobs(pictures(drawn, counts, full, 1, 1)[0], drawn)
    fit_shapes(np.array([[1, 1, 1, 0], [1, 1, 1, 1], [0, 1, 1, 1]], np.bool_))


if __name__ == "__main__":
    gc.disable()
    compile_others()
