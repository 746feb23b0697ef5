"""The account of each of the 160 cells of an impression: predicted by the map, explained by a fact, or noise."""

from utak.geometry.counts.retina import FIELDS, OWN_FIELD
from utak.geometry.kernels.arrays import Square
from utak.kb.evidence.beliefs import FactExplainer
from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.evidence.record import Record
from utak.kb.evidence.sightings import REACH, cells_by_offset, sightings
from utak.kb.evidence.witness import SHOWN_CELLS, command_reason, node_squares
from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan


def explain_cell(beliefs: FactExplainer, cell: int, step: int) -> Reason:
    """Return the account of a cell of the impression of a step."""
    if not 0 <= cell < len(FIELDS):
        what = f"there is no cell {cell}: an impression has the cells 0 to {len(FIELDS) - 1}"
        raise BadInputError([Problem("why", SourceSpan(1, 1, 1), what, f"cell {cell}")])
    now = beliefs.record.steps[step]
    field, level = FIELDS[cell], now.retina[cell]
    size = "1 square" if field.side == 1 else f"{field.side} x {field.side} squares"
    claim = f"cell {cell} of impression {step} shows level {level} of 7"
    where = f"it covers {size} from {field.east} east and {field.north} north of the robot's own square on"
    least, most = (int(digits[cell]) for digits in now.allowed)
    data = {"cell": cell, "impression": step, "level": level, "least": least, "most": most, "status": now.status[cell]}
    allowed = f"the map allowed level {least}" if least == most else f"the map allowed the levels {least} to {most}"
    status = now.status[cell]
    below: tuple[Reason, ...]
    if cell == OWN_FIELD:
        because, below = f"predicted: the robot fills its own square; {where}", (command_reason(now),)
    elif status == "p":
        because = f"predicted: {allowed}, and all its squares were settled; {where}"
        earlier = _earlier(beliefs.record, cell, step, "they showed its squares before")
        below = (*_moved_things(beliefs, cell, step), earlier, command_reason(now))
    elif status == "e":
        because, below = f"explained by what is new: {allowed}; {where}", _explaining(beliefs, cell, step)
    else:
        because = f"noise: {allowed}, so nothing that is believed explains it; {where}"
        below = (_earlier(beliefs.record, cell, step, "they showed its squares otherwise"), command_reason(now))
    return Reason(claim, because, ReasonKind.CELLS, f"impression {step}", below, data)


def _explaining(beliefs: FactExplainer, cell: int, step: int) -> tuple[Reason, ...]:
    """Return the reason of the fact to which an explained cell is laid."""
    for fact, cells in beliefs.record.steps[step].explained.items():
        if cell in cells:
            found = beliefs.reason(fact.removesuffix("."), step)
            return (found,) if found else ()
    return ()


def _moved_things(beliefs: FactExplainer, cell: int, step: int) -> tuple[Reason, ...]:
    """Return the reasons of the moved things that lie under a cell, by their outlines: that they were moved."""
    now = beliefs.record.steps[step]
    under = set(squares_under(beliefs.record, cell, step))
    there = [node for node in now.moved if under.intersection(node_squares(now, node))]
    facts = [fact for node in there for fact in now.facts if fact.startswith(f"kind({node},object,")]
    return tuple(reason for fact in facts if (reason := beliefs.reason(fact, step)) is not None)


def _earlier(record: Record, cell: int, step: int, how: str) -> Reason:
    """Return the reason that names cells of earlier impressions over the squares of a cell."""
    found = [one for one in sightings(record, step, squares_under(record, cell, step)) if one.impression < step]
    found.sort(key=lambda one: (one.side, -one.impression))
    shown = list({(one.impression, one.cell): one for one in found}.values())[:SHOWN_CELLS]
    cells = [[one.impression, one.cell, one.level, list(one.square)] for one in shown]
    if not shown:
        claim = "what the robot holds or moved covers its squares, or its own place settles them"
        return Reason(claim, "", ReasonKind.MEASURED, f"step {step}")
    claim = "cells of earlier impressions cover the same squares"
    return Reason(claim, f"{how}: {'; '.join(map(str, shown))}", ReasonKind.CELLS, "", (), {"cells": cells})


def squares_under(record: Record, cell: int, step: int) -> list[Square]:
    """Return the squares (column, row), map frame, that a cell of the impression of a step covers, as believed then."""
    now = record.steps[step]
    plan = cells_by_offset(now.frame.angle)
    x, y = now.square_of(now.places[step])
    span = range(-REACH, REACH + 1)
    return [(x + east, y + north) for north in span for east in span if plan[north + REACH, east + REACH] == cell]
