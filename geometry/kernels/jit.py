"""Kernels: plain loops over arrays, compiled by numba on their first call and cached on disk.

numba is imported when the first kernel is called, never at import. A kernel is also ordinary Python: with
``NUMBA_DISABLE_JIT=1`` it runs uncompiled, for debugging and coverage.
"""

import importlib
import sys
import time
from collections.abc import Callable
from functools import cache
from threading import Timer
from types import FunctionType
from typing import Any, Generic, ParamSpec, TypeVar, cast

P = ParamSpec("P")
R = TypeVar("R")
PATIENCE = 1.0  # seconds of compiling before the user is told
OFTEN = 5.0  # seconds between two lines that tell how far it is


class Kernel(Generic[P, R]):
    """A function that compiles itself when it is first called.

    ``swift`` is the same for callers whose arguments always have the very types of the first call it gets: it looks at
    no types again, which for short, frequent calls takes most of the time.
    """

    def __init__(self, function: Callable[P, R], counting: bool) -> None:
        self.function = function
        self._counting = counting
        self.__doc__ = function.__doc__
        self.__name__ = function.__name__
        self.__module__ = function.__module__
        self.swift: Callable[P, R] = self._first
        self._ready: Callable[P, R] | None = None
        self._machine: Callable[P, R] | None = None

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        if self._ready is None:
            machine = self.machine()
            _compile(machine, args)
            self._ready = machine
        return self._ready(*args, **kwargs)

    def machine(self) -> Callable[P, R]:
        """The numba dispatcher (or the bare function when numba is told not to compile)."""
        if self._machine is None:
            self._machine = _dispatcher(self.function, self._counting)
            if not hasattr(self._machine, "overloads"):
                _link(cast(FunctionType, self.function).__globals__)
        return self._machine

    def _first(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """``swift`` before it is ready."""
        self.swift = self.entry(*args, **kwargs)
        return self.swift(*args, **kwargs)

    def entry(self, *args: P.args, **kwargs: P.kwargs) -> Callable[P, R]:
        """The machine code for arguments of these types, which skips looking at types again: for short, frequent calls.

        Later arguments must have the very same types.
        """
        machine: Any = self.machine()
        _compile(machine, args)
        if not hasattr(machine, "overloads"):
            return self.function
        types = tuple(machine.typeof_pyval(value) for value in args)
        return cast(Callable[P, R], machine.overloads[types].entry_point)


def compiled(function: Callable[P, R]) -> Kernel[P, R]:
    """Decorate a kernel. Its arguments are arrays and numbers; it may call other kernels, also of other modules."""
    return Kernel(function, True)


def bare(function: Callable[P, R]) -> Kernel[P, R]:
    """Decorate a kernel that makes no arrays but views, returns none, and calls only such kernels.

    Numba then counts no references to arrays, which in kernels of many small calls takes most of the time.
    """
    return Kernel(function, False)


def _dispatcher(function: Callable[P, R], counting: bool) -> Callable[P, R]:
    import numba

    _look_for_no_blas()
    options: Any = {"error_model": "numpy", "_nrt": counting, "no_cfunc_wrapper": True}
    try:
        machine = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # no directory to keep the cache in: compile anew in each process
        _progress.kept = False
        machine = numba.njit(**options)(function)
    if hasattr(machine, "overloads"):
        _progress.machines.append(machine)
        _load_lightly(machine)
        _compile_wide(machine)
        _compile_linked(machine, cast(FunctionType, function).__globals__)
    return cast(Callable[P, R], machine)


def _look_for_no_blas() -> None:
    """Kernels multiply no matrices; numba, to know whether it might, would import scipy where that is installed.

    That takes as long as all else of a cold start. Who multiplies matrices with numba finds scipy when he does.
    """
    if "numba.np.arraymath" in sys.modules:
        return
    from numba.np import linalg

    look = linalg.ensure_blas
    linalg.ensure_blas = lambda: None
    try:
        importlib.import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = look


def _load_lightly(machine: Any) -> None:
    """Load from numba's cache without first getting ready to compile: machine code needs the run time only."""
    store = machine._cache
    if not (hasattr(store, "_load_overload") and hasattr(store, "_guard_against_spurious_io_errors")):
        return
    from numba.core.runtime.nrt import rtsys

    def load(signature: Any, target: Any) -> Any:
        rtsys.initialize(target)
        with store._guard_against_spurious_io_errors():
            return store._load_overload(signature, target)

    store.load_overload = load


def _compile_wide(machine: Any) -> None:
    """One copy for all whole numbers: else every constant and every width of integer would get a copy of its own."""
    from numba.core import types

    compile_exactly = machine.compile

    def compile_wide(signature: tuple[Any, ...]) -> Any:
        return compile_exactly(tuple(types.int64 if isinstance(t, types.Integer) else t for t in signature))

    machine.compile = compile_wide


def _compile_linked(machine: Any, names: dict[str, Any]) -> None:
    """Link to other kernels and say so when compiling takes long: only what numba does not find in its cache."""
    compiler = machine._compiler
    compile_it = compiler.compile

    def compile_telling(*args: Any) -> Any:
        _link(names)
        notice = Timer(PATIENCE, tell)
        notice.daemon = True
        notice.start()
        try:
            return compile_it(*args)
        finally:
            notice.cancel()
            _progress.step()

    compiler.compile = compile_telling


def _link(names: dict[str, Any]) -> None:
    """Let kernels call each other directly: numba resolves only dispatchers among a module's globals."""
    for name, value in list(names.items()):
        if isinstance(value, Kernel):
            names[name] = value.machine()


def _compile(machine: Any, args: tuple[Any, ...]) -> None:
    """Compile for these arguments without running."""
    if hasattr(machine, "typeof_pyval"):
        machine.compile(tuple(machine.typeof_pyval(value) for value in args))


class _Progress:
    """What this process has compiled, told on a terminal every few seconds."""

    def __init__(self) -> None:
        self.machines: list[Any] = []
        self.kept = True  # is there a directory to keep kernels in?
        self.made = 0
        self.began: float | None = None
        self._told = 0.0

    def step(self) -> None:
        """One more is compiled."""
        self.made += 1
        now = time.monotonic()
        if self.began is None or now - self._told < OFTEN or not (sys.stderr and sys.stderr.isatty()):
            return
        self._told = now
        print(f"utak: kernels compiled so far: {self.made}, in {now - self.began:.0f} s", file=sys.stderr, flush=True)

    def begin(self) -> None:
        """It is told of from now on."""
        self.began = self._told = time.monotonic()


_progress = _Progress()


def ready() -> tuple[int, bool]:
    """Return how many kernels this process can call, compiled or loaded, and whether they are kept for the next one."""
    return sum(bool(machine.overloads) for machine in _progress.machines), _progress.kept


@cache
def tell() -> None:
    """Say it once in a process."""
    once = "once per installation"
    if not _progress.kept:
        once = "they cannot be kept for the next run: set NUMBA_CACHE_DIR to a folder that can be written"
    print(f"utak: compiling geometry kernels ({once}) ...", file=sys.stderr, flush=True)
    _progress.begin()
