"""Kernels: plain loops over arrays, compiled by numba on their first call and cached on disk.

numba is imported when the first kernel is called, never at import. A kernel is also ordinary Python: with
``NUMBA_DISABLE_JIT=1`` it runs uncompiled, for debugging and coverage.
"""

import importlib
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from threading import Timer
from types import FunctionType
from typing import Any, Generic, ParamSpec, TypeVar, cast

Arguments = ParamSpec("Arguments")
Returned = TypeVar("Returned")
NOTICE_DELAY = 1.0  # seconds of compiling after which the user is informed; a convention
PROGRESS_INTERVAL = 5.0  # seconds between two lines of progress; a convention


class Kernel(Generic[Arguments, Returned]):
    """A function that compiles itself when it is first called; called like the function, it returns the same."""

    def __init__(self, function: Callable[Arguments, Returned], counts_references: bool) -> None:
        self.function = function
        self._counts_references = counts_references
        self.__doc__ = function.__doc__
        self.__name__ = function.__name__
        self.__module__ = function.__module__
        self.call_unchecked: Callable[Arguments, Returned] = self._first_unchecked
        self._compiled: Callable[Arguments, Returned] | None = None
        self._numba: Callable[Arguments, Returned] | None = None

    def __call__(self, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Returned:
        """Call the kernel and return what its function returns; compile it first if this is its first call."""
        # Arguments of other types than before make numba compile it once more, for these.
        if self._compiled is None:
            dispatcher = self.dispatcher()
            _compile(dispatcher, args)
            self._compiled = dispatcher
        return self._compiled(*args, **kwargs)

    def dispatcher(self) -> Callable[Arguments, Returned]:
        """Return numba's dispatcher, the object that picks compiled code by the types of arguments."""
        if self._numba is None:
            self._numba = _dispatcher(self.function, self._counts_references)
            if not hasattr(self._numba, "overloads"):
                _link(cast(FunctionType, self.function).__globals__)
        return self._numba

    def _first_unchecked(self, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Returned:
        """Compile for the types of these arguments, put the result in place of `call_unchecked`, and call it."""
        self.call_unchecked = self.entry(*args, **kwargs)
        return self.call_unchecked(*args, **kwargs)

    def entry(self, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Callable[Arguments, Returned]:
        """Compile for the types of these arguments, without running, and return the machine code as a function."""
        dispatcher: Any = self.dispatcher()
        _compile(dispatcher, args)
        if not hasattr(dispatcher, "overloads"):
            return self.function
        types = tuple(dispatcher.typeof_pyval(value) for value in args)
        return cast(Callable[Arguments, Returned], dispatcher.overloads[types].entry_point)


def compiled(function: Callable[Arguments, Returned]) -> Kernel[Arguments, Returned]:
    """Decorate a function: return the kernel that stands for it and compiles itself when first called."""
    return Kernel(function, True)


def bare(function: Callable[Arguments, Returned]) -> Kernel[Arguments, Returned]:
    """Decorate a function that makes no arrays but views, returns none, and calls only such kernels."""
    return Kernel(function, False)


def _dispatcher(function: Callable[Arguments, Returned], counts_references: bool) -> Callable[Arguments, Returned]:
    """Return numba's dispatcher of a function, set up for the cache on disk, linking to other kernels and notices."""
    import numba

    _skip_blas_lookup()
    from utak.geometry.kernels.cache import allow_reading, make_safe

    allow_reading()
    options: Any = {"error_model": "numpy", "_nrt": counts_references, "no_cfunc_wrapper": True}
    try:
        dispatcher = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # no directory to keep the cache in: compile anew in each process
        PROGRESS.has_cache = False
        dispatcher = numba.njit(**options)(function)
    if hasattr(dispatcher, "overloads"):
        PROGRESS.dispatchers.append(dispatcher)
        if PROGRESS.has_cache:
            make_safe(dispatcher, cast(FunctionType, function).__code__.co_filename)
        _load_without_compiler(dispatcher)
        _widen_integers(dispatcher)
        _link_when_compiling(dispatcher, cast(FunctionType, function).__globals__)
    return cast(Callable[Arguments, Returned], dispatcher)


def _skip_blas_lookup() -> None:
    """Import numba's array functions without its search for BLAS, which would import scipy where that is installed."""
    if "numba.np.arraymath" in sys.modules:
        return
    from numba.np import linalg

    ensure = linalg.ensure_blas
    linalg.ensure_blas = lambda: None
    try:
        importlib.import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = ensure


def _load_without_compiler(dispatcher: Any) -> None:
    """Make a dispatcher load from numba's cache without setting up the compiler: machine code does not need it."""
    store = dispatcher._cache
    if not (hasattr(store, "_load_overload") and hasattr(store, "_guard_against_spurious_io_errors")):
        return
    from numba.core.runtime.nrt import rtsys

    def load(signature: Any, target: Any) -> Any:
        rtsys.initialize(target)
        with store._guard_against_spurious_io_errors(), suppress(Exception):  # damaged code raises anything
            return store._load_overload(signature, target)

    save_now = store.save_overload

    def save(signature: Any, data: Any) -> None:
        try:
            save_now(signature, data)
        except OSError:  # a folder that cannot be written, or a full disk
            PROGRESS.has_cache = False

    store.load_overload, store.save_overload = load, save


def _widen_integers(dispatcher: Any) -> None:
    """Make a dispatcher, in place, compile one copy for all whole numbers, as int64."""
    # Else each constant and each width would get a copy of its own.
    from numba.core import types

    compile_exactly = dispatcher.compile

    def compile_wide(signature: tuple[Any, ...]) -> Any:
        return compile_exactly(tuple(types.int64 if isinstance(t, types.Integer) else t for t in signature))

    dispatcher.compile = compile_wide


def _link_when_compiling(dispatcher: Any, module_globals: dict[str, Any]) -> None:
    """Make a dispatcher, in place, link to other kernels before it compiles, and count and report what it compiles."""
    compiler = dispatcher._compiler
    compile_now = compiler.compile

    def compile_with_notice(*args: Any) -> Any:
        _link(module_globals)
        notice = Timer(PROGRESS.notice_delay, announce_compiling)
        notice.daemon = True
        notice.start()
        try:
            return compile_now(*args)
        finally:
            notice.cancel()
            PROGRESS.step()

    compiler.compile = compile_with_notice


def _link(module_globals: dict[str, Any]) -> None:
    """Replace kernels among a module's globals, `module_globals` (name to value), by their dispatchers, in place."""
    for name, value in list(module_globals.items()):
        if isinstance(value, Kernel):
            module_globals[name] = value.dispatcher()


def _compile(dispatcher: Any, args: tuple[Any, ...]) -> None:
    """Compile for the types of these arguments, without running; do nothing when given a plain function."""
    if hasattr(dispatcher, "typeof_pyval"):
        dispatcher.compile(tuple(dispatcher.typeof_pyval(value) for value in args))


class CompilingProgress:
    """The kernels that this process has compiled, reported on a terminal (standard error) every few seconds."""

    __slots__ = (
        "_reported_at",
        "compiled_count",
        "dispatchers",
        "has_cache",
        "interval",
        "notice_delay",
        "started_at",
    )

    def __init__(self) -> None:
        self.dispatchers: list[Any] = []
        self.has_cache = True
        self.compiled_count = 0
        self.started_at: float | None = None
        self._reported_at = 0.0
        self.notice_delay, self.interval = NOTICE_DELAY, PROGRESS_INTERVAL

    def step(self) -> None:
        """Count one more compiled kernel; report progress when reports have begun and it is time for one."""
        self.compiled_count += 1
        now = time.monotonic()
        if (
            self.started_at is None
            or now - self._reported_at < self.interval
            or not (sys.stderr and sys.stderr.isatty())
        ):
            return
        self._reported_at = now
        print(
            f"utak: kernels compiled so far: {self.compiled_count}, in {now - self.started_at:.0f} s",
            file=sys.stderr,
            flush=True,
        )

    def begin(self) -> None:
        """Start reporting from now on; the first report comes no sooner than five seconds later."""
        self.started_at = self._reported_at = time.monotonic()


PROGRESS = CompilingProgress()


def kernel_status() -> tuple[int, bool]:
    """Return how many kernels this process has ready, compiled or read from disk, and whether there is a cache."""
    return sum(bool(dispatcher.overloads) for dispatcher in PROGRESS.dispatchers), PROGRESS.has_cache


@cache
def announce_compiling() -> None:
    """Print on standard error, once in a process, that kernels are being compiled; start the reports of progress."""
    once = "once per installation, and when geometry was changed"
    if not PROGRESS.has_cache:
        once = "they cannot be kept for the next run: set NUMBA_CACHE_DIR to a folder that can be written"
    print(f"utak: compiling geometry kernels ({once}) ...", file=sys.stderr, flush=True)
    PROGRESS.begin()
