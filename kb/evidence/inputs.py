"""Reasons for what encodings were given: regions, necks, corners and fits to cells; properties of nodes to facts."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from utak.geometry.kernels.arrays import XY, Square
from utak.kb.evidence.proving import words_of
from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.evidence.record import Record, RecordedStep
from utak.kb.evidence.witness import command_reason, felt_reason, line_squares, node_squares, seen_reason
from utak.kb.language.atoms import atom_parts
from utak.kb.language.goal_words import ROBOT
from utak.kb.tracing.decisions import SolverCall
from utak.kb.world.model import FACT_UNITS_PER_SQUARE, FLOOR_NODE, ROOT_NODE, VERGE_NODE

FactReason = Callable[[str, int], Reason | None]  # from a fact and a step to its reason; None when it is not believed
TASK_INPUTS = frozenset({"wanted", "named", "claim", "claimed", "carried", "kept"})  # what start.lp and goal.lp say
NODE_INPUTS = {  # what reconciliation.lp and shapes.lp are given of a node: the fact that says it, as arguments
    "candidate": "kind({0},object,{1})",
    "fixed": "movable({0},0)",
}
FACT_OF_PLACE = {"o": "kind(", "r": "unseen(", "d": "door("}  # by the letter of a place: the fact that tells of it
AGENDA_INPUTS = ("stage_goal", "came_to", "open_fact")  # the record says what goals and facts, and why it came so
# What encodings of the planner are given that was not measured: bounds, what is offered, asked, or came of something.
DECIDED_INPUTS = frozenset({
    "horizon", "place", "aside", "asked", "rank", "wish", "fulfils", "about", "order", "meant_before", "may_mean",
    "waits", "holds", "kept", "offered", "thing", "goal", "bound_before", "planned",
    "given_up", "not_through", "due", "telling", "other_way", "looks_away", "lets_go", "vain",
    "stage_goal", "missing", "unclear", "own_goals", "regions_forbidden", "stages_attained", "constraints_doubtful",
    "hand_unsure", "robot_lost", "unplanned", "map_contradicted", "begun", "undid", "came_to",
})  # fmt: skip
PARAMETER_INPUTS = frozenset({"bound_before", "planned", "given_up"})  # a parameter and a node, decided before
WORLD_INPUTS = frozenset({"bound", "shape", "colour", "width", "connects", "goal"})  # given to `task` as facts


class Given(NamedTuple):
    """An input of an encoding, in the decision of some step."""

    atom: str  # the input, as text
    call: SolverCall  # the decision
    step: int  # the step whose beliefs the decision was about


def input_reason(record: Record, given: Given, fact_reason: FactReason) -> Reason:
    """Return the reason why an encoding was given an atom, down to cells, touches, commands or the task."""
    name, arguments = atom_parts(given.atom)
    says = words_of(given.call.encoding, given.atom)
    if name in AGENDA_INPUTS:
        why = next((about for about in given.call.about if _names(about, arguments)), "")
        says = f"{says}: {why.partition(': ')[2]}" if why else says
    if name in TASK_INPUTS:
        return Reason(given.atom, says, ReasonKind.TASK, "the task")
    below = [*_below(record, given, name, arguments, fact_reason)]
    decided = name in DECIDED_INPUTS | WORLD_INPUTS  # no fact: it is supposed
    kind = ReasonKind.INPUT if below else ReasonKind.DECIDED if decided else ReasonKind.MEASURED
    return Reason(given.atom, says, kind, f"step {given.step}", tuple(below), _data(given, arguments))


def _data(given: Given, arguments: tuple[str, ...]) -> dict[str, Any]:
    """Return what the record says of the candidate that an input is about; {} for nothing."""
    number = arguments[0] if arguments else ""
    if number.isdigit() and int(number) < len(given.call.about):
        return {"about": given.call.about[int(number)]}
    return {}


def _below(
    record: Record, given: Given, name: str, arguments: tuple[str, ...], fact_reason: FactReason
) -> list[Reason]:
    """Return the reasons of an input; [] when it rests on nothing that is recorded."""
    step, encoding = given.step, given.call.encoding
    if encoding == "interpretation":
        return _region_reasons(record, step, name, arguments)
    if encoding in ("shapes", "movable"):
        return [squares_reason(record, step, arguments[0])]
    if encoding == "rooms":
        return _neck_reasons(record, given, arguments)
    if encoding == "corners":
        return _corner_reasons(record, step, arguments)
    if encoding == "chances":
        return _chance_reasons(record, step, name, arguments, fact_reason)
    if encoding == "accommodation":
        return [command_reason(record.steps[step])]
    if encoding == "reconciliation":
        return _property_reasons(record, step, name, arguments, fact_reason)
    if encoding == "task":
        return _plan_reasons(record, given, name, arguments, fact_reason)
    return []


def _region_reasons(record: Record, step: int, name: str, arguments: tuple[str, ...]) -> list[Reason]:
    """Return the reasons of a fact about regions: the cells that show their squares, or a touch."""
    node = _node_of(record, step, arguments[0])
    if name == "touched":
        squares = node_squares(record.steps[step], node)
        felt = felt_reason(record, step, squares, arguments[1], _named(node))
        return [felt] if felt else []
    if name == "surrounds":
        inner = _node_of(record, step, arguments[1])
        return [squares_reason(record, step, other) for other in dict.fromkeys((node, inner))]
    return [squares_reason(record, step, node)]


def _node_of(record: Record, step: int, region: str) -> str:
    """Return the node that a region is; the verge or the floor for regions that are no objects."""
    known = next((node for node, other in record.steps[step].regions.items() if other == region), None)
    if known is not None:
        return known
    facts = (fact for _, call in record.answers(step, "interpretation", step) for fact in call.facts)
    return FLOOR_NODE if any(fact.startswith(f"region({region},zero,") for fact in facts) else VERGE_NODE


def _named(node: str) -> str:
    """Return a node in words."""
    return {FLOOR_NODE: "the floor", VERGE_NODE: "the verge"}.get(node, node)


def squares_reason(record: Record, step: int, node: str) -> Reason:
    """Return the reason why the squares of a node are believed to be occupied, or free for the floor."""
    squares = node_squares(record.steps[step], node)
    return seen_reason(record, step, squares, node != FLOOR_NODE, f"the squares of {_named(node)}")


def stretch_reason(record: Record, step: int, arguments: Sequence[str]) -> Reason:
    """Return the cells that show a stretch of what bounds the floor. arguments : those of its fact."""
    now, (west, south, east, north) = record.steps[step], (int(value) for value in arguments[1:])
    squares = []
    for column, row in node_squares(now, VERGE_NODE):
        x, y = (FACT_UNITS_PER_SQUARE * value for value in now.frame.place_to_utak(column + 0.5, row + 0.5))
        if west <= x <= east and south <= y <= north:
            squares.append((column, row))
    return seen_reason(record, step, squares, True, f"the squares of stretch {arguments[0]}")


def _neck_reasons(record: Record, given: Given, arguments: tuple[str, ...]) -> list[Reason]:
    """Return the reasons of a neck: the two walls at its ends, and the floor between them."""
    now, ends = record.steps[given.step], given.call.about[int(arguments[0])]
    (west, south), (east, north) = ends
    between = _both_sides(now, (west, south), (east, north))
    walls = [_beyond(record, given.step, near, far) for near, far in (ends, ends[::-1])]
    width = int(arguments[1]) / FACT_UNITS_PER_SQUARE
    passage = Reason(
        f"the passage from ({west:g}, {south:g}) to ({east:g}, {north:g}) is {width:.2f} squares wide",
        "measured between the two walls",
        ReasonKind.MEASURED,
        f"step {given.step}",
        (),
        {"ends": [list(end) for end in ends], "width": width},
    )
    floor = seen_reason(record, given.step, between, False, "the floor between the walls")
    ends_seen = [
        seen_reason(record, given.step, wall, True, f"the {which} wall")
        for which, wall in zip(("first", "second"), walls, strict=True)
    ]
    return [passage, *ends_seen, floor]


def _beyond(record: Record, step: int, near: list[float], far: list[float]) -> list[Square]:
    """Return the squares just beyond an end of a line, seen from its other end, map frame."""
    dx, dy = near[0] - far[0], near[1] - far[1]
    length = max((dx * dx + dy * dy) ** 0.5, 1e-9)
    end = near[0] + dx / length, near[1] + dy / length
    return _both_sides(record.steps[step], (near[0], near[1]), end)


def _both_sides(now: RecordedStep, start: XY, end: XY) -> list[Square]:
    """Return the squares on both sides of a line, which may run between two rows of squares, map frame."""
    return list(dict.fromkeys(square for side in (-0.1, 0.1) for square in line_squares(now, start, end, side)))


def _corner_reasons(record: Record, step: int, arguments: tuple[str, ...]) -> list[Reason]:
    """Return the reason of a corner of the known floor: the cells that show the floor at it."""
    east, north = (int(value) / FACT_UNITS_PER_SQUARE for value in arguments[1:3])
    x, y = record.steps[step].frame.place_from_utak(east, north)
    column, row = round(x), round(y)
    around = [(column + dx, row + dy) for dx in (-1, 0) for dy in (-1, 0)]
    floor = set(node_squares(record.steps[step], FLOOR_NODE))
    inside = [square for square in around if square in floor] or around
    return [seen_reason(record, step, inside, False, f"the floor at the corner ({east:g}, {north:g})")]


def _plan_reasons(
    record: Record, given: Given, name: str, arguments: tuple[str, ...], fact_reason: FactReason
) -> list[Reason]:
    """Return the reasons of a fact that `task` is given: facts of the world model; [] for what geometry measured."""
    facts: list[str] = []
    if name in WORLD_INPUTS:
        facts = _believed(record, given.step, given.atom)
    elif name == "thing":
        facts = [fact for fact in record.steps[given.step].long_facts if fact.startswith(f"movable({arguments[0]},")]
    elif name == "lies" and arguments[1] == "here":
        node = ROOT_NODE if arguments[0] == ROBOT else arguments[0]
        facts = _believed(record, given.step, f"in({node},{arguments[2]})")
    found = [fact_reason(fact, given.step) for fact in facts]
    if name == "goal" and not any(found):  # no plan attains all goals, so the facts name none
        stated = [about for about in given.call.about if _names(about, arguments)]
        return [Reason(about, "", ReasonKind.TASK, "the task") for about in stated]
    return [reason for reason in found if reason is not None]


def _believed(record: Record, step: int, atom: str) -> list[str]:
    """Return the believed fact that says what an atom says, with its confidence if it has one; [] for none."""
    facts = record.steps[step].long_facts if record.steps else ()
    return [fact for fact in facts if fact == atom or fact.startswith(f"{atom[:-1]},")][:1]


def _names(about: Any, arguments: tuple[str, ...]) -> bool:
    """Return whether what the record says of a candidate begins with the name of a goal, such as `g1: ...`."""
    return isinstance(about, str) and about.startswith(f"{arguments[0]}: ")


def _chance_reasons(
    record: Record, step: int, name: str, arguments: tuple[str, ...], fact_reason: FactReason
) -> list[Reason]:
    """Return the reasons of what chances.lp is given: facts about places, and the cells that show pieces."""
    if name in ("touch", "whole"):
        nodes = dict.fromkeys(piece.partition("_")[0] for piece in arguments[: 2 if name == "touch" else 1])
        return [squares_reason(record, step, node) for node in nodes]
    if name == "between":
        return [squares_reason(record, step, FLOOR_NODE)]
    if name == "unfelt":
        facts = [fact for fact in record.steps[step].facts if fact.startswith(f"stretch({arguments[0]},")]
        return [stretch_reason(record, step, atom_parts(fact)[1]) for fact in facts]
    if name == "stands":
        return [command_reason(record.steps[step])]
    place = arguments[1] if name == "place" else arguments[0]
    facts = [fact for fact in record.steps[step].long_facts if fact.startswith(FACT_OF_PLACE.get(place[:1], "-"))]
    about = [fact for fact in facts if atom_parts(fact)[1][0] == place]
    return [reason for fact in about[:1] if (reason := fact_reason(fact, step)) is not None]


def _property_reasons(
    record: Record, step: int, name: str, arguments: tuple[str, ...], fact_reason: FactReason
) -> list[Reason]:
    """Return the reasons of what reconciliation.lp is given of a node: facts of the world model, or cells."""
    node = arguments[1] if name in PARAMETER_INPUTS else arguments[0]
    fact = NODE_INPUTS[name].format(*arguments) if name in NODE_INPUTS else ""
    if name == "has":
        fact = f"{arguments[1]}({node},{arguments[2]},{arguments[3]})"
    found = fact_reason(fact, step) if fact else None
    if found is not None:
        return [found]
    if name in PARAMETER_INPUTS and step > 0:
        return [command_reason(record.steps[step])]
    return [squares_reason(record, step, node)]
