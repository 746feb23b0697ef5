"""Compile kernels with numba when one is first called, not when a module is imported."""

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Mark a kernel: its first call compiles it, and the kernels that it calls, with numba's cache."""
    return cast(Callable[P, R], _Kernel(function))


class _Kernel:
    """A kernel not yet compiled."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.__doc__ = function.__doc__
        self.__wrapped__ = function

    def __call__(self, *args: Any) -> Any:
        return self.build()(*args)

    def build(self) -> Callable[..., Any]:
        """Compile, and take the kernel's own place in its module."""
        import numba

        space = self.function.__globals__
        for name in self.function.__code__.co_names:
            if isinstance(space.get(name), _Kernel):
                space[name].build()
        kernel: Callable[..., Any] = numba.njit(cache=True)(self.function)
        space[self.function.__name__] = kernel
        self.build = lambda: kernel  # type: ignore[method-assign]
        return kernel
