"""Events of an episode: the steps at which something happened that a viewer wants to jump to."""

from typing import Any

from utak.simulator.episode.episode import Episode, EpisodeLine

# The kinds of events, in the order in which a viewer lists them, and what each means.
EVENT_KINDS = {
    "surprise": "fields of the retina are noise, or the motion is explained otherwise than as predicted",
    "refuted": "a fact says that a step of the plan is refuted",
    "replanned": "the plan is another one, not the rest of the former plan",
    "grasp": "the robot holds something that it did not hold before",
    "release": "the robot no longer holds what it held",
    "done": "the run ends",
}
NOISE_STATUS = "n"  # the letter in `belief.status` of a field that nothing explains


def episode_events(episode: Episode) -> dict[str, list[int]]:
    """Return the steps of each kind of event, in order; kinds without any are left out."""
    found: dict[str, list[int]] = {kind: [] for kind in EVENT_KINDS}
    before: EpisodeLine | None = None
    for number, line in enumerate(episode.steps):
        for kind in _events_of(before, line):
            found[kind].append(number)
        before = line
    if episode.result is not None and episode.steps:
        found["done"].append(len(episode.steps) - 1)
    return {kind: steps for kind, steps in found.items() if steps}


def _events_of(before: EpisodeLine | None, line: EpisodeLine) -> list[str]:
    """Return the kinds of events of one step, after the step before."""
    belief = line["belief"]
    kinds = ["surprise"] if _surprised(belief) else []
    if before is None:
        return kinds
    facts, earlier = (set(_facts_named("refuted", step["belief"])) for step in (line, before))
    if facts - earlier:
        kinds.append("refuted")
    old, new = _plan(before["belief"]), _plan(belief)
    if old and new != old[len(old) - len(new) :]:  # neither the former plan nor the rest of it
        kinds.append("replanned")
    if line["held"] != before["held"]:
        kinds += ["release"] * (before["held"] is not None) + ["grasp"] * (line["held"] is not None)
    return kinds


def _surprised(belief: dict[str, Any]) -> bool:
    """Return whether an impression has noise, or was explained otherwise than as predicted."""
    noise = belief.get("cells", {}).get("noise") or NOISE_STATUS in belief.get("status", "")
    return bool(noise) or belief.get("pose", "predicted") != "predicted"


def _plan(belief: dict[str, Any]) -> list[str]:
    """Return the steps of the plan in order, as text: what `plan(I, Step)` says."""
    steps = []
    for fact in _facts_named("plan", belief):
        number, _, step = fact[len("plan(") : -len(").")].partition(",")
        if number.strip().isdecimal() and step:
            steps.append((int(number), step))
    return [step for _, step in sorted(steps)]


def _facts_named(name: str, belief: dict[str, Any]) -> list[str]:
    """Return the facts of a predicate."""
    return [fact for fact in belief["facts"] if fact.startswith(f"{name}(")]
