"""The answer in words and as JSON values.

In words all places are in the robot's frame, as in its own reasons: (east, north) of where it woke, in squares, north
being the way it faced then. The JSON values have them in the table's frame as well.
"""

from typing import Any

import numpy as np

from utak.geometry.kernels.arrays import XY
from utak.geometry.motion.se2 import direction
from utak.kb.evidence.reason import Depth
from utak.simulator.explaining.fixing.changes import Away, Dropped, Led, MoreCommands, Wider, WorldChange
from utak.simulator.explaining.fixing.gaps import WIDTH_STEP, Gap, GapSide
from utak.simulator.explaining.fixing.proving import Outcome
from utak.simulator.explaining.fixing.search import Fix, FixReport, WorldChanges
from utak.simulator.terminal.action_in_words import truth_in_words
from utak.simulator.world.world import World

COMPASS_WORDS = ("east", "northeast", "north", "northwest", "west", "southwest", "south", "southeast")
FRAME_NOTE = (
    "places are (east, north) of where the robot woke, in squares, north being the way it faced; "
    f"widths are in squares, in steps of {WIDTH_STEP:g}"
)


def report_text(report: FixReport, depth: Depth) -> str:
    """Return the answer in words."""
    world = report.run.scenario.world
    if report.is_needless:
        return "nothing needs to be changed: the run, repeated as it is recorded, ends in done"
    lines = [
        f"{changes_in_words(fix.changes, world)}: {outcome_in_words(fix.outcome)}{_proof_in_words(fix, report)}"
        for fix in report.fixes
    ]
    failed = _failed(report)
    if depth == Depth.LONG:
        lines += [
            f"tried: {changes_in_words(changes, world)}: {outcome_in_words(outcome)}" for changes, outcome in failed
        ]
    if depth != Depth.SHORT:
        refuted = sum(bool(outcome.refuted) for _, outcome in failed)
        geometry = f", {refuted} of them by geometry alone" if refuted else ""
        count = len(failed) + sum(outcome.works for changes, outcome in report.tried if changes)
        ran = f"{count} changes tried in {report.runs} runs, {report.commands} commands"
        lines += [f"{ran}; {len(failed)} failed{geometry}", FRAME_NOTE]
    return "\n".join(lines if report.fixes else ["no change was found with which it works", *lines])


def report_values(report: FixReport) -> dict[str, Any]:
    """Return the answer as JSON values: all that was found and tried."""
    world = report.run.scenario.world
    before = report.before
    return {
        "before": None if before is None else before.line["result"],
        "repeated": None if before is None else is_repeated(report),
        "needless": report.is_needless,
        "fixes": [
            {
                "changes": [change_values(change, world) for change in fix.changes],
                "words": changes_in_words(fix.changes, world),
                **_outcome_values(fix.outcome),
                "smallest": fix.is_smallest,
                "least": fix.is_least,
            }
            for fix in report.fixes
        ],
        "failed": [
            {"changes": [change_values(change, world) for change in changes], **_outcome_values(outcome)}
            for changes, outcome in _failed(report)
        ],
        "width_step": WIDTH_STEP,
        "runs": report.runs,
        "commands": report.commands,
        "ended": report.ended,
    }


def is_repeated(report: FixReport) -> bool:
    """Return whether the run ended as it is recorded, when it was repeated; true for a record without an end."""
    # A run that was ended by a limit of time has none: it would have gone on.
    recorded, before = report.run.episode.result, report.before
    return recorded is None or "seconds" in recorded or (before is not None and before.line["result"] == recorded)


def changes_in_words(changes: WorldChanges, world: World) -> str:
    """Return changes in words, places in the robot's frame."""
    return " and ".join(_in_words(change, world) for change in changes)


def change_values(change: WorldChange, world: World) -> dict[str, Any]:
    """Return a change as JSON values; `table` and `robot` have its places in both frames, (x, y) in squares."""
    match change:
        case Away(name):
            return {"change": "away", "thing": name, **_places(world, place=_place_of(name, world))}
        case Wider(gap, side, _):
            kind = "new_door" if gap.is_new else "wider"
            values = {"change": kind, "by": change.by, "from": gap.width, "to": change.width, "side": side.value}
            return values | _places(world, left=gap.left, right=gap.right)
        case Dropped(_, goal, is_constraint):
            return {"change": "constraint_dropped" if is_constraint else "goal_dropped", "goal": goal}
        case Led(place, what):
            return {"change": "seen_first", "what": what, **_places(world, place=place)}
        case MoreCommands(max_steps):
            return {"change": "more_commands", "max_steps": max_steps}


def outcome_in_words(outcome: Outcome) -> str:
    """Return in words how changes ended."""
    if outcome.refuted:
        return f"{outcome.refuted} cannot hold: no motion leads there"
    if outcome.result is None:
        return "the robot could not be led there" if outcome.led_commands else "this cannot be made"
    result = outcome.result
    return f"{result.verdict} in {result.steps} steps{truth_in_words(result.achieved)}"


def _failed(report: FixReport) -> list[tuple[WorldChanges, Outcome]]:
    return [
        (changes, outcome)
        for changes, outcome in report.tried
        if changes and not outcome.works and (outcome.result is not None or outcome.refuted or outcome.led_commands)
    ]


def _outcome_values(outcome: Outcome) -> dict[str, Any]:
    values = {name: getattr(outcome.result, name, None) for name in ("verdict", "steps", "achieved", "reason")}
    return values | {"refuted": outcome.refuted or None}


def _proof_in_words(fix: Fix, report: FixReport) -> str:
    """Return in words how far it is shown that less does not suffice; "" for changes that have no smaller ones."""
    if not fix.is_smallest:
        return f" (whether less suffices was not tried: {report.ended})"
    if not any(isinstance(change, Wider) for change in fix.changes):
        return ""
    return " (with every smaller step it fails)" if fix.is_least else " (with one step less it fails)"


def _in_words(change: WorldChange, world: World) -> str:
    match change:
        case Away(name):
            kind = "" if any(thing.name == name for thing in world.movable) else "fixed "
            return f"the {kind}thing {name} at {_point(world, _place_of(name, world))} away"
        case Wider(gap, _, _) if gap.is_new:
            return f"a new door at {_point(world, _middle(change))}, {change.width:.2f} wide"
        case Wider(gap, side, _):
            name = "door" if gap.room >= gap.width else "passage"
            ends = f"{_point(world, gap.left)}-{_point(world, gap.right)}"
            widths = f"wider by {change.by:.2f} ({gap.width:.2f} to {change.width:.2f})"
            return f"the {name} at {ends} {widths}{_side_in_words(gap, side, world)}"
        case Dropped(_, goal, is_constraint):
            return f"the {'constraint' if is_constraint else 'goal'} {goal} dropped"
        case Led(place, what):
            return f"{what} seen first, from {_point(world, place)}"
        case MoreCommands(max_steps):
            return f"{max_steps} commands allowed (--max-steps {max_steps})"


def _side_in_words(gap: Gap, side: GapSide, world: World) -> str:
    """Return in words at which end a gap gives way, as a point of the compass in the robot's frame."""
    if side == GapSide.BOTH:
        return ", half of it at each end"
    sign = 1.0 if side == GapSide.LEFT else -1.0
    east, north = _turned(world, (sign * gap.along[0], sign * gap.along[1]))
    return f", at its {COMPASS_WORDS[round(np.degrees(np.arctan2(north, east)) / 45.0) % 8]} end"


def _middle(change: Wider) -> XY:
    (x, y), (dx, dy) = change.gap.place, change.gap.along
    return x + dx * change.by / 2, y + dy * change.by / 2


def _place_of(name: str, world: World) -> XY:
    """Return the middle of a thing, (x, y) in the table frame."""
    thing = next(thing for thing in (*world.movable, *world.fixed) if thing.name == name)
    return float(thing.polygon.centroid.x), float(thing.polygon.centroid.y)


def _places(world: World, **places: XY) -> dict[str, Any]:
    robot = {name: [round(value, 6) for value in _in_robot_frame(world, place)] for name, place in places.items()}
    return {"table": {name: list(place) for name, place in places.items()}, "robot": robot}


def _point(world: World, place: XY) -> str:
    east, north = (round(value, 2) + 0.0 for value in _in_robot_frame(world, place))
    return f"({east:g}, {north:g})"


def _in_robot_frame(world: World, place: XY) -> XY:
    """Return a place of the table frame as (east, north) of where the robot woke."""
    return _turned(world, (place[0] - world.utak[0], place[1] - world.utak[1]))


def _turned(world: World, offset: XY) -> XY:
    """Return an offset of the table frame as (east, north) in the robot's frame."""
    cosine, sine = direction(world.heading)
    dx, dy = offset
    return dx * cosine + dy * sine, dy * cosine - dx * sine
