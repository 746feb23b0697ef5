"""Embedded things: objects that stand in a wall, and how they lie there if they fill it to the floor behind.

Of a thing that fills a doorway only the face is seen. To plan with it, it is supposed to go on straight behind its
face, through what seems to be wall, to the floor that is seen there.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import shapely

from utak.geometry.kernels.arrays import Bools, Square
from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.propose.larger_object import MAX_HIDDEN_DEPTH, SIDE_DIRECTIONS
from utak.kb.mapping.patch import patch_of
from utak.kb.world.model import Node
from utak.planner.goals.placement import possible_extension
from utak.planner.situation import Situation


@dataclass(frozen=True)
class Supposition:
    """An object as it lies if it goes on in what seems to be wall."""

    node: Node  # the object, with the squares and the outline that it has then
    side: Square  # the direction (columns, rows) along the axes of the map in which it goes on, one of SIDE_DIRECTIONS
    depth: int  # by how many squares it goes on
    situation: Situation  # what is believed, with this object in place of the one that was seen


def supposed_in_walls(node: Node, situation: Situation, opens: Callable[[Bools], bool]) -> Iterator[Supposition]:
    """Yield how an object lies if it goes on in a wall, for each side on which its removal would open a way then."""
    # For each side it goes on first up to the floor that is seen behind it, then just so far that a way would open, if
    # these differ. Nothing is yielded for an object that was moved, for it was seen to end, nor while its outline is
    # not known.
    mask = situation.model.mask(node.patch)
    for side in SIDE_DIRECTIONS:
        parts = [possible_extension(node, side, depth, situation.model) for depth in range(MAX_HIDDEN_DEPTH + 2)]
        sizes = [int(part.sum()) for part in parts]
        whole = sizes.index(sizes[-1])
        depths = range(1, min(whole, MAX_HIDDEN_DEPTH) + 1)
        least = next((depth for depth in depths if opens(mask | parts[depth])), None)
        if least is None:
            continue
        for depth in [whole] * (least < whole <= MAX_HIDDEN_DEPTH) + [least]:
            supposed = suppose(node, side, depth, situation)
            if supposed is not None:
                yield supposed


def suppose(node: Node, side: Square, depth: int, situation: Situation) -> Supposition | None:
    """Return the supposition that an object goes on to one side by `depth` squares; None when it was seen to end."""
    if node.moved or node.polygon is None:
        return None
    model = situation.model
    mask = model.mask(node.patch) | possible_extension(node, side, depth, model)
    steps = (Translate(step * side[0], step * side[1]) for step in range(depth + 1))
    polygon = shapely.union_all([step.carry(node.polygon) for step in steps])
    larger = replace(node, patch=patch_of(mask, model.view), polygon=polygon)
    objects = tuple(larger if other.name == node.name else other for other in model.objects)
    return Supposition(larger, side, depth, replace(situation, model=replace(model, objects=objects)))
