"""Numba's cache on disk, made safe: a damaged file counts as missing, and what cannot be written is read all the same.

Files are as numba writes them, with a seal at their end: a digest of all bytes before it. A file without one counts as
damaged, too: the damage may be in the seal.
"""

import hashlib
import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from numba.core import caching as _caching

caching: Any = _caching  # it has no types
INSTALLATION = Path(__file__).resolve().parents[1]  # the folder of geometry: other kernels are not ours
SEAL = b"\nseal of utak: "  # what stands before the digest


class SealedFile(caching.IndexDataCacheFile):  # type: ignore[misc]
    """The cached code of one kernel: an index and a file for each signature."""

    def __init__(self, like: Any, elsewhere: str | None, stamp: Any) -> None:
        super().__init__(like._cache_path, like._index_name.removesuffix(".nbi"), stamp)
        self._elsewhere: Any = None
        if elsewhere is not None:
            self._elsewhere = SealedFile(like, None, stamp)
            self._elsewhere._cache_path = elsewhere
            self._elsewhere._index_path = str(Path(elsewhere, like._index_name))

    def load(self, key: Any) -> Any:
        """Return what is cached for a key; None for nothing, or for what is damaged."""
        found = super().load(key)
        return found if found is not None or self._elsewhere is None else self._elsewhere.load(key)

    def _load_index(self) -> Any:
        """Return the index; an empty one when it is missing, of other sources, or damaged."""
        try:
            return super()._load_index() if is_whole(self._index_path) else {}
        except Exception:  # unpickling may raise anything
            return {}

    def _load_data(self, name: str) -> Any:
        """Return the code in a file; raise OSError, which numba takes for a missing file, when it is damaged."""
        try:
            if is_whole(self._data_path(name)):
                return super()._load_data(name)
        except Exception as error:  # unpickling may raise anything
            raise OSError(str(error)) from None
        raise OSError(f"{name} is damaged")

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[io.BytesIO]:
        """Yield a stream whose bytes become the file, with the seal, at the end of the `with` block."""
        contents = io.BytesIO()
        yield contents
        with super()._open_for_write(filepath) as stream:
            stream.write(contents.getvalue() + SEAL + hashlib.sha256(contents.getvalue()).digest())


class _ReadOnlyLocator(caching.InTreeCacheLocator):  # type: ignore[misc]
    """The folder of an installation for users who can write to no folder at all."""

    @classmethod
    def from_function(cls, function: Any, file: str) -> Any:
        """Return the locator if the folder is there; else None."""
        locator = cls(function, file)
        is_ours = INSTALLATION in Path(file).resolve().parents
        return locator if is_ours and Path(locator.get_cache_path()).is_dir() else None


def is_whole(path: str) -> bool:
    """Return whether a file has a seal that fits. Raises OSError when it cannot be read."""
    contents, seal, digest = Path(path).read_bytes().rpartition(SEAL)
    return bool(seal) and hashlib.sha256(contents).digest() == digest


def allow_reading() -> None:
    """Let kernels of an installation be read where no folder can be written."""
    classes = caching.CacheImpl._locator_classes
    if _ReadOnlyLocator not in classes:
        classes.append(_ReadOnlyLocator)


def make_safe(dispatcher: Any, source: str) -> None:
    """Put safe files in the place of the cache files of a dispatcher."""
    store = dispatcher._cache
    beside = Path(source).with_name("__pycache__")
    is_elsewhere = "NUMBA_CACHE_DIR" not in os.environ and beside.resolve() != Path(store.cache_path).resolve()
    store._cache_file = SealedFile(
        store._cache_file, str(beside) if is_elsewhere else None, _stamp(Path(source).parent)
    )


@cache
def _stamp(folder: Path) -> list[tuple[str, float, int]]:
    """Return name, time and size of all sources of a room; a kernel holds the code and constants of others there."""
    return [(path.name, path.stat().st_mtime, path.stat().st_size) for path in sorted(folder.glob("*.py"))]
