"""The value of an aggregate, of which some tuples are counted for certain and others only may be."""

import clingo

from kb.language.integers import MAX_INT32, MIN_INT32
from kb.three_valued.arithmetic import checked
from kb.three_valued.uncertain_values import Unknown, Value, bounds, symbol

Tuple = tuple[Value, ...]


class Tally:
    """Collects the tuples of one aggregate; `value` is its value, or an Unknown with its bounds."""

    def __init__(self, function: str) -> None:
        self._function = function
        self._certain: dict[Tuple, None] = {}
        self._possible: dict[Tuple, None] = {}
        self._vague: list[Tuple] = []

    def add(self, values: Tuple, possible: bool) -> None:
        """Count a tuple. possible : it only may be there."""
        if not possible:
            self._certain[values] = None
        elif not any(isinstance(value, Unknown) for value in values):
            self._possible[values] = None
        else:
            self._vague.append(values)

    def value(self) -> Value:
        """Return the aggregate's value; raises CalculationError for one beyond 32 bits."""
        more = [values for values in self._possible if values not in self._certain]
        if self._function == "#count":
            return self._between(len(self._certain), len(more), 0)
        if self._function in ("#sum", "#sum+"):
            return self._sum(more)
        return self._extreme(more)

    def _between(self, least: int, up: int, down: int) -> Value:
        """A number from `least` - `down` to `least` + `up`; without an upper bound where there are vague tuples."""
        checked(least)
        high = MAX_INT32 if self._vague else min(MAX_INT32, least + up)
        low = max(MIN_INT32, least - down)
        return least if low == high == least else Unknown(low, high)

    def _sum(self, more: list[Tuple]) -> Value:
        def weight(values: Tuple) -> int:
            value = values[0] if values else 0
            number = value if isinstance(value, int) else 0
            return max(0, number) if self._function == "#sum+" else number

        weights = [weight(values) for values in more]
        vague_down = any((bounds(values[0]) or (MIN_INT32, MAX_INT32))[0] < 0 for values in self._vague if values)
        down = -sum(w for w in weights if w < 0)
        if vague_down and self._function == "#sum":
            down = MAX_INT32 - MIN_INT32
        return self._between(sum(map(weight, self._certain)), sum(w for w in weights if w > 0), down)

    def _extreme(self, more: list[Tuple]) -> Value:
        """The least or the greatest first value; that of no tuples is beyond all others."""
        least = self._function == "#min"
        best = clingo.Supremum if least else clingo.Infimum
        for values in self._certain:
            if values and _beyond(values[0], best, least):
                best = symbol(values[0])
        open_ = any(values and _beyond(values[0], best, least) for values in more) or any(
            _may_go_beyond(values[0], best, least) for values in self._vague if values
        )
        found: Value = best.number if best.type == clingo.SymbolType.Number else best
        if not open_:
            return found
        ends = [bounds(values[0]) for values in (*more, *self._vague) if values]
        if bounds(found) is None or None in ends:
            return Unknown(anything=True)
        spans = [(found, found), *(end for end in ends if end is not None)]
        low = min(span[0] for span in spans) if least else found
        return Unknown(low, found if least else max(span[1] for span in spans))


def _beyond(value: Value, best: object, least: bool) -> bool:
    one = symbol(value)
    return bool(one < best) if least else bool(one > best)


def _may_go_beyond(value: Value, best: object, least: bool) -> bool:
    ends = bounds(value)
    if ends is None:
        return True
    return _beyond(ends[0] if least else ends[1], best, least)
