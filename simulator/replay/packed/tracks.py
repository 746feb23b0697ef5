"""Places and motions of an episode, written with few digits: of the robot, of things, of impressions.

The true places that a page keeps are rounded: those of the robot and its motions to TRACK_DIGITS decimals of a square,
the outlines of things to within KEPT_OUTLINE_TOLERANCE. What the robot believes is kept exactly.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from simulator.episode.episode import EpisodeLine
from simulator.replay.packed.delta import SAME, difference

TRACK_DIGITS = 6  # decimals of a square
PARTS = 10.0**TRACK_DIGITS  # of a square
POSE_DIGITS = 5  # decimals of a square and of a degree, in the poses of things
KEPT_OUTLINE_TOLERANCE = 1e-4  # squares by which the outline of a thing may be off; a convention, far below a pixel
TrackedRing = Sequence[Sequence[float]]


def track_columns(lines: Sequence[EpisodeLine]) -> dict[str, list[Any]]:
    """Return what a page needs of all steps at once, each as a list over the steps."""
    found: dict[str, list[Any]] = {name: [] for name in ("action", "motion", "utak", "place", "seen_from")}
    before: EpisodeLine | None = None
    seen: list[Any] = []
    for line in lines:
        place, anew = believed_place(line), places_anew(line)
        predicted = None if before is None else predicted_place(believed_place(before), line["action"])
        seen = [*seen, place]
        found["action"].append(line["action"])
        found["utak"].append([_rounded(v) for v in line["utak"]])
        found["motion"].append(_motion(line["motion"], before, line))
        found["place"].append(SAME if place is not None and place == predicted else place)
        found["seen_from"].append(SAME if anew is None else difference(seen, anew) or [anew])
        seen = seen if anew is None else anew
        before = line
    return found


def believed_place(line: EpisodeLine) -> list[float] | None:
    """Return where the robot believes it is, in squares, robot frame; None when the line states no point."""
    place = line["belief"].get("place")
    return place if _is_point(place) else None


def places_anew(line: EpisodeLine) -> list[Any] | None:
    """Return where impressions were received as believed anew at a step, robot frame; None if it is not stated."""
    places = line["belief"].get("seen_from")
    return places if isinstance(places, list) and all(map(_is_point, places)) else None


def offset_facts(place: Sequence[float]) -> tuple[str, str]:
    """Return the facts that say where the robot and, from there, the floor have their origins: what `place` tells."""
    east, north = (math.floor(100 * v + 0.5) for v in place)
    return f"offset(org,{east},{north}).", f"offset(floor,{-east},{-north})."


def predicted_place(before: list[float] | None, action: EpisodeLine | None) -> list[float] | None:
    """Return where a command leads from a believed place, in squares of the robot frame, rounded like that place."""
    if before is None:
        return None
    way = (action.get("east", 0), action.get("north", 0)) if action else (0, 0)
    return [_rounded(v + w) for v, w in zip(before, way, strict=True)]


def posed(ring: TrackedRing, first: TrackedRing) -> list[Any]:
    """Return the pose of a thing: where its first corner is, and how it is turned against its outline at first."""
    if len(ring) == len(first):
        (x, y), far = first[0], max(first, key=lambda point: math.dist(point, first[0]))
        now = ring[list(first).index(far)]
        turn = math.atan2(now[1] - ring[0][1], now[0] - ring[0][0]) - math.atan2(far[1] - y, far[0] - x)
        degrees = round(math.degrees(turn) % 360, POSE_DIGITS)
        pose = [round(ring[0][0], POSE_DIGITS), round(ring[0][1], POSE_DIGITS), degrees]
        if all(math.dist(a, b) < KEPT_OUTLINE_TOLERANCE for a, b in zip(placed(pose, first), ring, strict=True)):
            return pose
    return [[_rounded(v) for v in point] for point in ring]


def placed(pose: Sequence[float], first: TrackedRing) -> list[list[float]]:
    """Return the outline of a thing with a pose; `first` is that in the header, in squares, table frame."""
    cosine, sine = math.cos(math.radians(pose[2])), math.sin(math.radians(pose[2]))
    ways = ((x - first[0][0], y - first[0][1]) for x, y in first)
    return [[pose[0] + dx * cosine - dy * sine, pose[1] + dx * sine + dy * cosine] for dx, dy in ways]


def poses(objects: Mapping[str, TrackedRing], movable: Mapping[str, EpisodeLine]) -> dict[str, list[Any]]:
    """Return the poses of things by name; the outline of a thing that the header's `movable` does not name."""
    return {name: posed(ring, movable[name]["rings"][0] if name in movable else ()) for name, ring in objects.items()}


def _motion(motion: EpisodeLine | None, before: EpisodeLine | None, line: EpisodeLine) -> Any:
    """Return a true motion as `track_columns` writes it."""
    if motion is None or before is None:
        return motion
    if "rotate" in motion:
        return motion if motion["about"] != line["utak"] else {"rotate": _rounded(motion["rotate"])}
    way = [b - a for a, b in zip(before["utak"], line["utak"], strict=True)]
    return SAME if math.dist(way, motion["translate"]) < 1 / PARTS else motion


def _rounded(value: float) -> float:
    """Return a number rounded to TRACK_DIGITS decimals, by a rule that every browser repeats exactly."""
    return math.floor(value * PARTS + 0.5) / PARTS


def _is_point(value: Any) -> bool:
    """Return whether a value is a pair of numbers."""
    return (
        isinstance(value, list)
        and len(value) == 2
        and all(isinstance(v, int | float) and not isinstance(v, bool) and abs(v) < 1e9 for v in value)
    )
