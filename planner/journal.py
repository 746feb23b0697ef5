"""The journal of a robot: what each step adds to the record of decisions and of places, ready for JSON.

What stood in an earlier step already is written as a reference to it, so that episodes stay small.
"""

from collections.abc import Sequence
from typing import Any

from utak.geometry.kernels.arrays import XY
from utak.kb.language.atoms import atom_parts
from utak.kb.localisation.known.state import TrackerState
from utak.kb.tracing.decisions import SolverCall
from utak.planner.question import DECIDING_ENCODING

JOURNAL_DIGITS = 6  # decimals of a square with which places are written, like `place` in an episode's line


class Journal:
    """Remembers what was written, and returns what a step adds; each robot has one of its own."""

    def __init__(self) -> None:
        self._written: dict[str, list[int]] = {}  # a decision as text -> [step, index] where it is written in full
        self._places: tuple[XY, ...] = ()
        self._step = 0

    def copy(self) -> "Journal":
        """Return a journal that goes on from here by itself."""
        other = Journal()
        other._written, other._places, other._step = dict(self._written), self._places, self._step
        return other

    def entry(self, decisions: Sequence[SolverCall], memory: TrackerState) -> dict[str, Any]:
        """Return what the next step adds to the `belief` of an episode's line."""
        places = tuple(_rounded(place) for place in (*memory.been, *(seen.place for seen in memory.observations)))
        found: dict[str, Any] = {"solved": [self._solved(n, call) for n, call in enumerate(decisions)]}
        found["map_from"] = len(memory.been)
        if places != (*self._places, _rounded(memory.frame.place_to_utak(*memory.place))):
            found["seen_from"] = [list(place) for place in places]
        routes = next(filter(None, map(_routes, reversed(decisions))), [])
        if routes:
            found["routes"] = routes
        self._places, self._step = places, self._step + 1
        return found

    def _solved(self, index: int, call: SolverCall) -> list[Any]:
        """Return the entry of one decision; remember where it is written in full."""
        where = self._written.setdefault(repr(call), [self._step, index])
        if where != [self._step, index]:
            return [call.encoding, where]
        answer = None if call.answer is None else list(call.answer)
        return [call.encoding, list(call.facts), answer, list(call.about)]


def _rounded(place: XY) -> XY:
    """Return a place with JOURNAL_DIGITS decimals, without a negative zero."""
    return round(place[0], JOURNAL_DIGITS) + 0.0, round(place[1], JOURNAL_DIGITS) + 0.0


def _routes(call: SolverCall) -> list[dict[str, Any]]:
    """Return the routes of a decision, each with its points and whether it was chosen; [] where none was offered."""
    facts = call.facts if call.encoding == DECIDING_ENCODING.stem and call.answer else ()
    numbers = [int(atom_parts(fact)[1][0]) for fact in facts if fact.startswith("tight(")]
    return [{"points": call.about[n], "chosen": f"walked({n})" in (call.answer or ())} for n in numbers]
