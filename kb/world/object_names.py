"""Object names: the one state of the world model that lasts from one impression to the next.

A patch of squares keeps the name of the patch of the last impression with which it shares most squares.
"""

from collections import Counter
from collections.abc import Container

from utak.geometry.kernels.arrays import Square
from utak.kb.mapping.patch import Patch


class ObjectNames:
    """The names of patches: `o1`, `o2`, ... in the order in which they were first seen. No name is given twice."""

    def __init__(self) -> None:
        self._squares: dict[str, set[Square]] = {}
        self._count = 0

    def assign(self, patches: list[Patch], reserved: Container[str] = ()) -> list[str]:
        """Return a name for each patch: that of the known patch it overlaps most, else a new one."""
        squares = [patch.squares() for patch in patches]
        owner = {square: name for name, known in self._squares.items() if name not in reserved for square in known}
        shared = Counter((owner[square], i) for i, own in enumerate(squares) for square in own if square in owner)
        names: dict[int, str] = {}
        taken = set()
        for name, i in sorted(shared, key=lambda share: (-shared[share], int(share[0][1:]), share[1])):
            if i not in names and name not in taken:
                names[i] = name
                taken.add(name)
        for i in range(len(patches)):
            if i not in names:
                self._count += 1
                names[i] = f"o{self._count}"
        self._squares = {names[i]: own for i, own in enumerate(squares)}
        return [names[i] for i in range(len(patches))]

    def forget(self) -> None:
        """Forget all patches, so that each patch gets a new name from now on."""
        self._squares = {}
