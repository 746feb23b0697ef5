"""Measures of what may be besides what was seen, as kb/asp/chances.lp is given them, with what is true."""

from collections.abc import Iterator
from itertools import groupby
from typing import NamedTuple

from benchmarks.calibration.runs import LookedAt
from benchmarks.calibration.whereabouts import TrueAlternatives
from benchmarks.priors.measures import given_to
from utak.kb.language.atoms import atom_parts
from utak.kb.task.alternatives import standing_facts
from utak.kb.task.apart import joints
from utak.kb.task.pieces import touching_pieces
from utak.kb.task.stretches import stretches

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
    given, stated = given_to(look, "chances"), {arguments[0] for arguments in look.moment.rows("may_be", 3)}
    true = {x: _alternatives(look).place(x) for name, (x, *_) in given if name == "unbound" and x in stated}
    claimed = [arguments for name, arguments in given if name == "claimed"]
    following = {arguments[0] for name, arguments in given if name == "next"}
    for name, arguments in given:
        if name == "place" and true.get(arguments[0]) is not None:
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
    for pair in touching_pieces(look.model):
        one = None if pair.whole else _alternatives(look).is_one_thing(pair.one, pair.other)
        if one is not None:
            yield PieceSeen("same" if pair.felt else "unfelt", pair.share, one)


class MeasuredSeen(NamedTuple):
    """Anything else that may be, as a case and a measure."""

    case: str
    measure: int
    true: bool


def joints_seen(look: LookedAt) -> Iterator[MeasuredSeen]:
    """Yield the parts of the floor with which others may be joined that no seen floor joins with the robot's."""
    for apart, those in groupby(joints(look.model), lambda joint: joint.apart):
        true = _alternatives(look).led_to(apart)
        yield from (MeasuredSeen(joint.case, joint.measure, joint.other == true) for joint in those)


def stretches_seen(look: LookedAt) -> Iterator[MeasuredSeen]:
    """Yield the stretches of what bounds the floor that were never felt."""
    for stretch in stretches(look.model):
        yield MeasuredSeen(stretch.case, stretch.thickness, _alternatives(look).is_plug(stretch.name))


def squares_seen(look: LookedAt) -> Iterator[MeasuredSeen]:
    """Yield the likeliest square in which the robot may stand, where that is not sure."""
    stands = (atom_parts(fact)[1] for fact in standing_facts(look.model))
    found = [(int(share), int(east), int(north), case) for east, north, case, share in stands]
    share, east, north, case = max(found, default=(0, 0, 0, CERTAIN_CASE))
    if case != CERTAIN_CASE:
        yield MeasuredSeen(case, share, _alternatives(look).stands(east, north))


def _alternatives(look: LookedAt) -> TrueAlternatives:
    """Return the truth beside a moment of a run."""
    assert look.moment.alternatives is not None
    return look.moment.alternatives
