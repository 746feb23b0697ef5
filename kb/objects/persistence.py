"""The chance that things which are out of sight still lie where they lay (kb/asp/persistence.lp), by counted looks."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from utak.geometry.counts.retina import RETINA_REACH
from utak.geometry.kernels.arrays import XY
from utak.kb.objects.movability import decided_of_things
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.user_rules import rules_reach

PERSISTENCE = KB_ENCODINGS / "persistence.lp"


class ChangesByOthers(NamedTuple):
    """The changes of the table by others that the robot saw."""

    removed: int  # how many things were taken away that the robot knew
    since: int | None  # the number of looks since the last that showed a change; None for none on this map


class Persistence(NamedTuple):
    """Whether a thing still lies where it lay."""

    percent: int = 100  # of belief that it does
    again: bool = False  # whether it is looked at again before a task is done that is about it


def persistences(
    things: Mapping[str, XY],
    looks: Iterable[XY],
    changes: ChangesByOthers,
    rules: tuple[Path, ...] = (),
    world: Iterable[str] = (),
) -> Mapping[str, Persistence]:
    """Return by name whether things still lie at their places; looks: from where, oldest first, the same own frame."""
    if not things or not (changes.removed or rules_reach(PERSISTENCE.stem, rules)):
        return {}
    away = np.array(list(things.values()))[:, None] - np.array(list(looks))
    in_sight = ((away >= -RETINA_REACH) & (away < RETINA_REACH)).all(2)
    unseen = np.argmax(np.pad(in_sight, ((0, 0), (1, 0)), constant_values=True)[:, ::-1], axis=1)
    checks = int(np.maximum(in_sight.sum(1) - 1, 0).sum()) + changes.removed
    facts = [f"removed({changes.removed})", f"checked({checks})", *(f"thing({name})" for name in things)]
    facts += [f"out_of_sight({name},{many})" for name, many in zip(things, unseen.tolist(), strict=True) if many]
    facts += [] if changes.since is None else [f"since_change({changes.since})"]
    percents, marks = decided_of_things(PERSISTENCE, facts, rules, world, ("by_count", "persists"))
    return {name: Persistence(percent, f"looked_at_again({name})" in marks) for name, percent in percents.items()}
