"""Object names: the one state of the world model that lasts from one impression to the next.

A patch of squares keeps the name of the patch of the last impression with which it shares most squares.
"""

from collections import Counter
from collections.abc import Container, Mapping

from utak.geometry.kernels.arrays import Square
from utak.kb.mapping.patch import Patch

# Between the squares of a thing and those that it may cover where it is seen again, often from afar and off the grid
MAX_SIZE_RATIO = 3.0


class ObjectNames:
    """The names of patches: `o1`, `o2`, ... in the order in which they were first seen. No name is given twice."""

    def __init__(self) -> None:
        self._squares: dict[str, set[Square]] = {}
        self._missing: dict[str, int] = {}  # how many squares each thing had that is no longer where it lay
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
        for i, name in self._returned({i: len(own) for i, own in enumerate(squares) if i not in names}):
            names[i] = name
            del self._missing[name]
        for i in range(len(patches)):
            if i not in names:
                self._count += 1
                names[i] = f"o{self._count}"
        self._squares = {names[i]: own for i, own in enumerate(squares)}
        return [names[i] for i in range(len(patches))]

    @property
    def missing(self) -> tuple[str, ...]:
        """The names of things that are no longer where they lay, and were not seen since."""
        return tuple(sorted(self._missing))

    def miss(self, sizes: Mapping[str, int]) -> None:
        """Note that things of so many squares are no longer where they lay: a new patch as large is that thing."""
        self._missing |= sizes
        for name in sizes:
            self._squares.pop(name, None)

    def _returned(self, new: Mapping[int, int]) -> list[tuple[int, str]]:
        """Return which new patches are missing things, by how many squares they have; those most alike first."""
        ratios = sorted(
            (max(many, size) / min(many, size), int(name[1:]), i, name)
            for i, many in new.items()
            for name, size in self._missing.items()
        )
        found: dict[int, str] = {}
        for ratio, _, i, name in ratios:
            if ratio <= MAX_SIZE_RATIO and i not in found and name not in found.values():
                found[i] = name
        return list(found.items())

    def counted(self, other: "ObjectNames") -> "ObjectNames":
        """Return these names, so that those given on another map meanwhile are not given again."""
        self._count = max(self._count, other._count)
        return self

    def forget(self) -> None:
        """Forget all patches, so that each patch gets a new name from now on."""
        self._squares = {}
        self._missing = {}
