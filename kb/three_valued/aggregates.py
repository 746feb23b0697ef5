"""The value of an aggregate, some tuples of which are certain and others only possible."""

import clingo

from utak.kb.language.integers import MAX_INT32, MIN_INT32
from utak.kb.three_valued.arithmetic import require_int32
from utak.kb.three_valued.uncertain_values import Unknown, Value, as_clingo, bounds

ValueTuple = tuple[Value, ...]  # a tuple of an aggregate


class Tally:
    """Collects the tuples of one aggregate; a tuple that is added twice counts once."""

    def __init__(self, function: str) -> None:
        self._function = function
        self._certain: dict[ValueTuple, None] = {}
        self._possible: dict[ValueTuple, None] = {}
        self._vague: list[ValueTuple] = []

    def add(self, values: ValueTuple, possible: bool) -> None:
        """Add a tuple of terms."""
        if not possible:
            self._certain[values] = None
        elif not any(isinstance(value, Unknown) for value in values):
            self._possible[values] = None
        else:
            self._vague.append(values)

    def value(self) -> Value:
        """Return the value of the aggregate; an `Unknown`, with bounds for a number, when it is not certain."""
        # Raises CalculationError for a value beyond 32 bits.
        new_possible = [values for values in self._possible if values not in self._certain]
        if self._function == "#count":
            return self._between(len(self._certain), len(new_possible), 0)
        if self._function in ("#sum", "#sum+"):
            return self._sum(new_possible)
        return self._least_or_greatest(new_possible)

    def _between(self, least: int, up: int, down: int) -> Value:
        """Return a number from `least` - `down` to `least` + `up`: an integer when both are 0, else an `Unknown`."""
        # Raises CalculationError for a `least` beyond 32 bits.
        require_int32(least)
        high = MAX_INT32 if self._vague else min(MAX_INT32, least + up)
        low = max(MIN_INT32, least - down)
        return least if low == high == least else Unknown(low, high)

    def _sum(self, new_possible: list[ValueTuple]) -> Value:
        """Return the sum of the weights, an integer; an `Unknown` with bounds when it is not certain."""
        # Raises CalculationError when the sum of the certain weights is beyond 32 bits.

        def weight(values: ValueTuple) -> int:
            """Return the number with which a tuple counts: its first value, 0 when that is no number."""
            value = values[0] if values else 0
            number = value if isinstance(value, int) else 0
            return max(0, number) if self._function == "#sum+" else number

        weights = [weight(values) for values in new_possible]
        vague_down = any((bounds(values[0]) or (MIN_INT32, MAX_INT32))[0] < 0 for values in self._vague if values)
        down = -sum(w for w in weights if w < 0)
        if vague_down and self._function == "#sum":
            down = MAX_INT32 - MIN_INT32
        return self._between(sum(map(weight, self._certain)), sum(w for w in weights if w > 0), down)

    def _least_or_greatest(self, new_possible: list[ValueTuple]) -> Value:
        """Return the least (for `#min`) or the greatest first value; for no tuples, the value beyond all others."""
        least = self._function == "#min"
        best = clingo.Supremum if least else clingo.Infimum
        for values in self._certain:
            if values and _is_beyond(values[0], best, least):
                best = as_clingo(values[0])
        open_ = any(values and _is_beyond(values[0], best, least) for values in new_possible) or any(
            _may_go_beyond(values[0], best, least) for values in self._vague if values
        )
        found: Value = best.number if best.type == clingo.SymbolType.Number else best
        if not open_:
            return found
        ends = [bounds(values[0]) for values in (*new_possible, *self._vague) if values]
        if bounds(found) is None or None in ends:
            return Unknown(anything=True)
        spans = [(found, found), *(end for end in ends if end is not None)]
        low = min(span[0] for span in spans) if least else found
        return Unknown(low, found if least else max(span[1] for span in spans))


def _is_beyond(value: Value, best: object, least: bool) -> bool:
    """Return whether a known value is less (for `least`), or greater, than the best one in clingo's order."""
    one = as_clingo(value)
    return bool(one < best) if least else bool(one > best)


def _may_go_beyond(value: Value, best: object, least: bool) -> bool:
    """Return whether a value, unknown or not, can be less (for `least`), or greater, than the best one."""
    ends = bounds(value)
    if ends is None:
        return True
    return _is_beyond(ends[0] if least else ends[1], best, least)
