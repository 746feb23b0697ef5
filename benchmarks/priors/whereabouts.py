"""Measures of what may be besides what was seen, as kb/asp/chances.lp is given them, with what is true."""

from collections.abc import Iterator
from typing import NamedTuple

from benchmarks.calibration.runs import LookedAt
from benchmarks.calibration.whereabouts import TrueAlternatives
from utak.kb.language.atoms import atom_parts

CERTAIN_CASE = "sure"  # of a square that is not counted, for it is certain


class WhereaboutSeen(NamedTuple):
    """A place where a thing may be that the task names and nobody saw."""

    parameter: str
    place: str
    case: str
    measure: int
    against: int  # percent: of the surest claim that it is not there
    true: bool


class PieceSeen(NamedTuple):
    """Two pieces that touch."""

    felt: str
    share: int  # percent
    one: bool  # whether they are one thing


def whereabouts_seen(look: LookedAt) -> Iterator[WhereaboutSeen]:
    """Yield the places of things that the task names, where it is known which things these are."""
    given = _given(look)
    true = {x: _alternatives(look).place(x) for name, (x, *_) in given if name == "unbound"}
    claimed = [arguments for name, arguments in given if name == "claimed"]
    following = {arguments[0] for name, arguments in given if name == "next"}
    for name, arguments in given:
        if name == "place" and true[arguments[0]] is not None:
            x, place, case, measure = arguments
            said = [int(c) for y, room, c in claimed if x == y and _is_against(place, case, room, following)]
            yield WhereaboutSeen(x, place, case, int(measure), max(said, default=0), place == true[x])


def _is_against(place: str, case: str, room: str, following: set[str]) -> bool:
    """Return whether a claim that a thing is in a room, or in a next one, is against a place."""
    if room == "next":
        return case in ("open", "closed", "door") and place not in following
    return case in ("open", "closed") and place != room


def pieces_seen(look: LookedAt) -> Iterator[PieceSeen]:
    """Yield the pieces that touch and were not seen to move as one, where they are things."""
    given = _given(look)
    whole = {arguments[0] for name, arguments in given if name == "whole"}
    for name, arguments in given:
        if name == "touch" and arguments[0] not in whole:
            one, other, felt, share = arguments
            if (true := _alternatives(look).is_one_thing(one, other)) is not None:
                yield PieceSeen(felt, int(share), true)


class MeasuredSeen(NamedTuple):
    """Anything else that may be, as a case and a measure."""

    case: str
    measure: int
    true: bool


def joints_seen(look: LookedAt) -> Iterator[MeasuredSeen]:
    """Yield the parts of the floor with which others may be joined that no seen floor joins with the robot's."""
    between = [*_of(look, "between")]
    true = {apart: _alternatives(look).led_to(apart) for apart, *_ in between}
    yield from (MeasuredSeen(case, int(measure), true[apart] == other) for apart, other, case, measure in between)


def stretches_seen(look: LookedAt) -> Iterator[MeasuredSeen]:
    """Yield the stretches of what bounds the floor that were never felt."""
    for stretch, case, thickness in _of(look, "unfelt"):
        yield MeasuredSeen(case, int(thickness), _alternatives(look).is_plug(stretch))


def squares_seen(look: LookedAt) -> Iterator[MeasuredSeen]:
    """Yield the likeliest square in which the robot may stand, where that is not sure."""
    stands = [(int(share), int(east), int(north), case) for east, north, case, share in _of(look, "stands")]
    share, east, north, case = max(stands, default=(0, 0, 0, CERTAIN_CASE))
    if case != CERTAIN_CASE:
        yield MeasuredSeen(case, share, _alternatives(look).stands(east, north))


def _of(look: LookedAt, predicate: str) -> Iterator[tuple[str, ...]]:
    """Yield the arguments of the facts of a predicate that chances.lp was given at this moment."""
    yield from (arguments for name, arguments in _given(look) if name == predicate)


def _alternatives(look: LookedAt) -> TrueAlternatives:
    """Return the truth beside a moment of a run."""
    assert look.moment.alternatives is not None
    return look.moment.alternatives


def _given(look: LookedAt) -> list[tuple[str, tuple[str, ...]]]:
    """Return the facts that chances.lp was given at this moment, as name and arguments."""
    found = next((facts for name, facts in look.decisions if name == "chances"), ())
    return [atom_parts(fact) for fact in found]
