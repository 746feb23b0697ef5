"""Chances of what may be (chances.lp): where things and the robot are, which pieces are one, what joins floors.

Geometry measures; the encoding makes chances of it, by what was counted.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path

import numpy as np

from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.language.atoms import atom_parts
from utak.kb.mapping.occupancy import OPEN
from utak.kb.perception.frame import CENTRE
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.solver import solve
from utak.kb.task.apart import joints
from utak.kb.task.binding import Reconciliation
from utak.kb.task.described import claim_facts
from utak.kb.task.pieces import touching_pieces
from utak.kb.task.stretches import stretches
from utak.kb.task.task import Task
from utak.kb.world.facts import Places, facts_for_rules
from utak.kb.world.model import VERGE_NODE, Node, WorldModel, hundredths
from utak.kb.world.place_names import WAKING_ROOM
from utak.kb.world.rooms import NO_ROOM, Rooms

CHANCES = KB_ENCODINGS / "chances.lp"


def alternatives(
    task: Task, model: WorldModel, places: Places, reconciled: Reconciliation, rules: tuple[Path, ...] = ()
) -> tuple[str, ...]:
    """Return may_be/3, joined/3, hidden/3, plug/2, stretch/5 and loc/3 as facts without full stops."""
    facts = [*place_facts(task, model, places.rooms, reconciled)]
    facts += [fact for piece in touching_pieces(model) for fact in piece.facts]
    facts += [joint.fact for joint in joints(model)]
    unfelt = stretches(model)
    facts += [stretch.fact for stretch in unfelt]
    facts += standing_facts(model)
    facts += facts_for_rules(CHANCES.stem, rules, model, places) if facts else ()
    found = [str(atom) for atom in solve([CHANCES, *rules], facts) or ()] if facts else []
    return (*found, *(stretch.rectangle(model) for stretch in unfelt))


def may_be(facts: Iterable[str]) -> dict[str, dict[str, int]]:
    """Return, by parameter of the task that means nothing seen, the places where it may be with percent, of facts."""
    found: dict[str, dict[str, int]] = {}
    for fact in facts:
        name, parts = atom_parts(fact)
        if name == "may_be":
            found.setdefault(parts[0], {})[parts[1]] = int(parts[2])
    return found


def place_facts(task: Task, model: WorldModel, rooms: Rooms, reconciled: Reconciliation) -> Iterator[str]:
    """Yield where the objects may be that the task names and that mean nothing yet, for kb/asp/chances.lp."""
    bound = reconciled.binding
    unbound = [x for x, one in task.parameters.items() if one.kind == "object" and x not in bound]
    if not unbound:
        return
    places = [*_unseen_places(model, rooms)]
    places += [f"{VERGE_NODE},verge,0"] * bool(model.verge.any())
    may_turn_out = {*reconciled.doubtful, *reconciled.measurable}
    free = [node for node in model.objects if node.name not in bound.values()]
    for x in unbound:
        yield f"unbound({x})"
        yield from (f"place({x},{place})" for place in places)
        for node in free:
            case = "likely" if (x, node.name) in may_turn_out else "other"
            yield f"place({x},{node.name},{case},{_likeness(node, x, task, model)})"
    yield from _claimed_rooms(unbound, task, rooms, bound)


def standing_facts(model: WorldModel) -> Iterator[str]:
    """Yield the squares in which the robot may stand, for kb/asp/chances.lp."""
    standing = model.standing
    if standing is None or standing.case == "anew":  # from where it woke it stands anywhere
        return
    case = "unexplained" if model.contradicted else standing.case
    for (x, y), share in sorted(standing.shares.items()):
        east, north = standing.frame.place_to_utak(x + CENTRE[0], y + CENTRE[1])
        yield f"stands({hundredths(east)},{hundredths(north)},{case},{round(1000 * share)})"


def _likeness(node: Node, parameter: str, task: Task, model: WorldModel) -> int:
    """Return with how many percent map completions show that a node has the shape that the task claims."""
    # Where it claims none: with how many percent the node is an object.
    claimed = (claim.fact for claim in task.claims if claim.fact.name == "shape")
    shapes = sorted(str(fact.args[1]) for fact in claimed if str(fact.args[0]) == parameter)
    if not shapes:
        return node.confidence
    return round(100 * float(model.likely(shapes[0])[model.mask(node.patch)].max(initial=0.0)))


def _unseen_places(model: WorldModel, rooms: Rooms) -> Iterator[str]:
    """Yield the rooms with squares that were not seen or are not settled, and the doors behind which nothing was."""
    # A room is open where it goes on into what was not seen: its measure is the number of squares beside that.
    size = int(rooms.labels.max(initial=0)) + 1
    rim = np.bincount(rooms.labels[with_edge_neighbours(~model.view.seen)], minlength=size).tolist()
    unsettled = np.bincount(rooms.labels[model.view.state == OPEN], minlength=size).tolist()
    for room in range(1, size):
        if rim[room] or unsettled[room]:
            yield f"r{room},open,{rim[room]}" if rim[room] else f"r{room},closed,{unsettled[room]}"
    for door in rooms.doors:
        if not door.joins:
            yield f"{door.name},door,{door.confidence}"


def _claimed_rooms(unbound: Collection[str], task: Task, rooms: Rooms, bound: Mapping[str, str]) -> Iterator[str]:
    """Yield in which rooms the task says that things are, and which rooms are next to the first one."""
    said = False
    for fact in claim_facts(task):
        name, _, rest = fact.partition("(")
        parts = rest.removesuffix(")").split(",")
        if name == "claim" and parts[0] in unbound and parts[1:3] == ["in", "room(next)"]:
            said = True
            yield f"claimed({parts[0]},next,{parts[3]})"
        elif name == "related" and parts[0] == "in" and parts[1] in unbound and parts[2] in bound:
            yield f"claimed({parts[1]},{bound[parts[2]]},{parts[3]})"
    if said:
        doors = [door for door in rooms.doors if WAKING_ROOM in door.sides]
        near = {side for door in doors for side in door.sides} - {WAKING_ROOM, NO_ROOM}
        yield from (f"next(r{room})" for room in sorted(near))
        yield from (f"next({door.name})" for door in doors if not door.joins)
