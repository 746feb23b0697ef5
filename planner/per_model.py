"""Answers that depend on a world model: computed once for it, and forgotten with the next one."""

from collections.abc import Callable
from typing import Any, Generic, TypeVar

from utak.kb.language.terms import Fact
from utak.planner.situation import Situation

Answer = TypeVar("Answer")


class PerModel(Generic[Answer]):
    """Remembers what a function of the situation, such as of a goal in it, returned for the present world model."""

    def __init__(self, function: Callable[..., Answer]) -> None:
        """Make a memory of a function, which is called with the situation as its last argument."""
        self._function = function
        self._model: Any = None
        self._known: dict[Any, Answer] = {}

    def __call__(self, *arguments: Any) -> Answer:
        """Return what the function returns; from memory where it was asked the same of the same world model."""
        *others, situation = arguments
        assert isinstance(situation, Situation)
        if self._model is not situation.model:
            self._model, self._known = situation.model, {}
        key = tuple(str(one) if isinstance(one, Fact) else getattr(one, "name", one) for one in others)
        if key not in self._known:
            self._known[key] = self._function(*arguments)
        return self._known[key]
