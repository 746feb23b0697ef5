"""Events: the steps that a viewer jumps to."""

from typing import Any

from utak.simulator.episode.episode import Episode
from utak.simulator.replay.events import episode_events


def line(held: str | None = None, facts: tuple[str, ...] = (), **belief: Any) -> dict[str, Any]:
    """Return the part of a step's line that events depend on."""
    return {"held": held, "belief": {"facts": list(facts), **belief}}


def test_each_kind_of_event() -> None:
    plan = ("plan(1,go(a)).", "plan(2,look(b)).")
    steps = (
        line(facts=plan, pose="predicted", cells={"predicted": 160}),
        line("g1", plan[1:], pose="slipped"),
        line("g1", ("plan(1,look(b)).",), cells={"noise": 1, "predicted": 159}),
        line("g2", ("plan(1,go(c)).", "refuted(go(a),d)."), status="p" * 159 + "n"),
        line(None, ("plan(1,go(c)).", "refuted(go(a),d).")),
    )
    assert episode_events(Episode({}, steps, {"verdict": "done"})) == {
        "surprise": [1, 2, 3],
        "refuted": [3],
        "replanned": [3],
        "grasp": [1, 3],
        "release": [3, 4],
        "done": [4],
    }


def test_an_episode_without_events_or_end_has_none() -> None:
    assert episode_events(Episode({}, (line(), line()), None)) == {}
