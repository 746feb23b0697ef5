"""Preconditions: what is open of what a step rests on, and what of it is seen or felt first.

Geometry says here what is open and from where it is told; planner/asp/deciding/senses.lp chooses.
"""

from collections.abc import Collection, Iterable, Iterator
from typing import NamedTuple

from utak.kb.mapping.occupancy import OPEN
from utak.kb.world.model import MAX_FREE_PROBABILITY, Node, WorldModel
from utak.planner.carrying.manipulation_oracle import ManipulationPlan
from utak.planner.question import Atoms, Question, argument
from utak.planner.screen.moves import orientation_is_uncertain
from utak.planner.screen.projection import dilate
from utak.planner.sights.frontiers import Viewpoint, rim_viewpoint, touch_viewpoint, viewpoint_of
from utak.planner.sights.viewpoints import TO_TAKE, inspection
from utak.planner.situation import Situation

PLACE_SLACK = 0.02  # squares by which the robot may stand elsewhere in its square before a turn needs more room; tuned
TURN_COST_OPEN_FRAME = 2.5  # commands that a turn counts for while the orientation of the frame is open; tuned
TURN_COST_OPEN_PLACE = 1.5  # commands that it counts for while the place within the square is open; tuned
DETOUR_ROOM = 2  # squares beside the way of a long plan within which more room would help; tuned


class Doubt(NamedTuple):
    """Something open that steps rest on, and that a look or a touch may tell."""

    name: str  # as senses.lp calls it, such as way(o1)
    look: Viewpoint  # from where it is seen or felt
    facts: tuple[str, ...] = ()  # of what it is open, without full stops
    must: bool = False  # whether nothing is done that rests on it where no way leads there


class Sense(NamedTuple):
    """The doubt that is told next."""

    doubt: Doubt
    question: Question  # what was given, with the choice kept


def sensed_first(doubts: Iterable[Doubt], situation: Situation) -> Sense | None:
    """Return which doubt is told first; None for no need."""
    told = {doubt.name: doubt for doubt in doubts if len(doubt.look.squares)}
    if not told:
        return None
    question = _asked(told.values(), situation)
    name = str(argument(question.answer("senses") or (), "sense"))
    return Sense(told[name], question.keeping(f"sense({name})")) if name in told else None


def rules_that_leave_untold(doubts: Iterable[Doubt], situation: Situation) -> tuple[str, ...]:
    """Return the users' rules, as `rules.lp:3`, because of which nothing is told that goals rest on; () for none."""

    def is_untold(atoms: Atoms) -> bool:
        """Return whether something is left untold in an answer."""
        return any(atom.name == "untold" for atom in atoms)

    claimed = [doubt for doubt in doubts if len(doubt.look.squares) and f"claimed({doubt.name})" in doubt.facts]
    if not claimed or not situation.question.rules:
        return ()
    question = _asked(claimed, situation)
    return question.blamed(is_untold) if is_untold(question.answer("senses") or ()) else ()


def _asked(doubts: Collection[Doubt], situation: Situation) -> Question:
    """Return the question which of some doubts is told first."""
    facts = [fact for doubt in doubts for fact in doubt.facts]
    return situation.question.adding([*facts, *(f"unsure({one.name},{number})" for number, one in enumerate(doubts))])


def doubts_of_thing(node: Node, facts: tuple[str, ...], situation: Situation, must: bool = False) -> Iterator[Doubt]:
    """Yield what is open of a thing. must : whether nothing is done with it while its outline cannot be looked at."""
    if node.polygon is None or node.open:
        vague = (f"vague({node.name})",) if node.polygon is None or node.vague else ()
        look = inspection(situation.cost_maps, node, chance=1.0, to=TO_TAKE)
        yield Doubt(f"outline({node.name})", look, (*facts, *vague), must)
    yield from _doubt_of_extent(node, facts, situation)


def doubt_of_kind(node: Node, situation: Situation) -> Iterator[Doubt]:
    """Yield whether a thing is a piece of wall, where that is felt before it is moved."""
    if node.felt_first:
        yield Doubt(f"kind({node.name})", touch_viewpoint(situation.cost_maps, node))


def _doubt_of_extent(node: Node, facts: tuple[str, ...], situation: Situation) -> Iterator[Doubt]:
    """Yield how far a thing goes on, where that is to be felt."""
    rim = rim_viewpoint(situation.cost_maps, node)
    if rim is not None:
        yield Doubt(f"extent({node.name})", rim, facts)


def doubts_of_way(found: ManipulationPlan, node: Node, situation: Situation) -> Iterator[Doubt]:
    """Yield what is open of the way of a plan, and beside it."""
    model, name = situation.model, node.name
    if found.hopes:
        return
    apart = ~model.mask(node.patch)
    unsure = found.swept & ~situation.cost_maps.free(0) & apart
    hardly_free = (model.view.state == OPEN) & (model.view.probability > MAX_FREE_PROBABILITY)
    beside = dilate(found.swept, DETOUR_ROOM) & hardly_free & apart
    facts = (f"commands({name},{found.plan.commands})", *[f"goes_on({name})"] * found.plan.goes_on)
    what = f"it is not clear whether the way for {name} is free"
    for doubt, mask in (("way", unsure), ("surroundings", unsure | beside)):
        if mask.any():
            yield Doubt(f"{doubt}({name})", viewpoint_of(situation.cost_maps, mask, what), facts)


def doubts_of_obstacles(found: ManipulationPlan, situation: Situation) -> Iterator[Doubt]:
    """Yield what is open of the things that a plan needs moved aside: whether they are walls, and how far they go."""
    things = [thing for thing in situation.model.objects if thing.name in found.aside]
    for thing in things:
        yield from doubt_of_kind(thing, situation)
    for thing in things:
        yield from _doubt_of_extent(thing, (f"in_way({thing.name})",), situation)


def doubts_of_barriers(found: ManipulationPlan, situation: Situation) -> Iterator[Doubt]:
    """Yield what is open of things that a plan needs moved aside, where no way to do so is known."""
    for thing in filter(None, map(situation.model.object, found.aside)):
        yield from doubts_of_thing(thing, (f"bars({thing.name})",), situation)


def doubt_of_frame(node: Node, turns: bool, situation: Situation) -> Iterator[Doubt]:
    """Yield how the squares of the map lie, where that counts for a grasp. turns : whether the thing is turned next."""
    model = situation.model
    if orientation_is_uncertain(model):
        facts = (f"looked(frame,{len(model.looked_from)})", *[f"turned_next({node.name})"] * turns, *resistance(node))
        what = "it is not clear how the squares of the map lie"
        yield Doubt("frame", viewpoint_of(situation.cost_maps, model.mask(node.patch), what), facts, must=True)


def resistance(node: Node) -> tuple[str, ...]:
    """Return by how many pushes and turns a thing did not move, as a fact; () where it moved last."""
    return (f"resists({node.name},{node.stuck})",) if node.stuck else ()


def turn_cost(model: WorldModel) -> float:
    """Return how many commands a turn of a held object counts for: 1.0 or more."""
    if orientation_is_uncertain(model):
        return TURN_COST_OPEN_FRAME
    return TURN_COST_OPEN_PLACE if max(model.leeway) > PLACE_SLACK else 1.0
