"""A tree of reasons: a claim, why it holds, and the reasons of what that rests on."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

MAX_LEVELS = 150  # levels of a tree that are written at most; a convention, well below Python's limit on recursion
SHOWN_RIVALS = 3  # other choices that the depth `mid` lists for one choice; a convention
MID_LEVELS = 3  # levels of a tree that the depth `mid` shows: the claim, what it rests on, and what that rests on


class ReasonKind(StrEnum):
    """The kind of a reason."""

    FACT = "fact"
    """A fact of the world model."""
    RULE = "rule"
    """An atom that a rule derived or chose."""
    NEGATION = "negation"
    """Something of which nothing is known."""
    COMPUTED = "computed"
    """A comparison, a sum or a condition in a rule."""
    REJECTED = "rejected"
    """Another choice, and why it was not made."""
    INPUT = "input"
    """What an encoding was given."""
    MEASURED = "measured"
    """What geometry measured or verified: a witness."""
    DECIDED = "decided"
    """What the robot decided or did before, such as a bound on steps, a place that it offers, or what an activity came
    to: a leaf."""
    CELLS = "cells"
    """Cells of impressions: a leaf."""
    TOUCH = "touch"
    """A colour that was felt: a leaf."""
    COMMAND = "command"
    """A command that was given: a leaf."""
    TASK = "task"
    """What start.lp or goal.lp says: a leaf."""
    CONVENTION = "convention"
    """What holds by definition, such as that the robot is the root of the world model: a leaf."""


class Depth(StrEnum):
    """The part of a tree that is shown."""

    SHORT = "short"
    MID = "mid"
    LONG = "long"


@dataclass(frozen=True)
class Reason:
    """A claim with its reason."""

    claim: str  # what holds: a fact or an atom as text, or a statement in words
    because: str  # why, in words; '' where the claim says it all
    kind: ReasonKind  # the kind of the reason
    # Where the reason stands, such as `kb/asp/rooms.lp:26` or `impression 3`; '' where it stands nowhere.
    source: str = ""
    rests_on: tuple["Reason", ...] = ()  # the reasons of what it rests on
    data: dict[str, Any] = field(default_factory=dict)  # the values behind it, ready for JSON: cells, places, widths

    def as_dict(self) -> dict[str, Any]:
        """Return the tree as JSON values; keys without a value are left out."""
        return self._entry(MAX_LEVELS)

    def _entry(self, levels: int) -> dict[str, Any]:
        """Return some levels of the tree as JSON values."""
        entry: dict[str, Any] = {"claim": self.claim, "kind": str(self.kind)}
        for key in ("because", "source", "data"):
            if getattr(self, key):
                entry[key] = getattr(self, key)
        if self.rests_on and levels > 1:
            entry["rests_on"] = [reason._entry(levels - 1) for reason in self.rests_on]
        elif self.rests_on:
            entry["cut"] = True
        return entry

    def walk(self) -> Iterator["Reason"]:
        """Yield this reason and all below it, each object once, before what it rests on."""
        waiting, seen = [self], set[int]()
        while waiting:
            reason = waiting.pop()
            if id(reason) not in seen:
                seen.add(id(reason))
                yield reason
                waiting += reversed(reason.rests_on)

    def text(self, depth: Depth = Depth.MID) -> str:
        """Return the tree as indented lines."""
        levels = {Depth.SHORT: 1, Depth.MID: MID_LEVELS, Depth.LONG: MAX_LEVELS}[depth]
        return "\n".join(_lines(self, levels, "", set()))


def _lines(reason: Reason, levels: int, indent: str, written: set[tuple[str, str]]) -> Iterator[str]:
    """Yield the lines of a tree: `levels` levels of it."""
    because = f": {reason.because}" if reason.because else ""
    source = f"  [{reason.source}]" if reason.source else ""
    key = (reason.claim, reason.because)
    if key in written:
        yield f"{indent}{reason.claim} (as above)"
        return
    yield f"{indent}{reason.claim}{because}{source}"
    written.add(key)
    if levels > 1:
        rivals = [one for one in reason.rests_on if "costs" in one.data]  # those that come nearest first
        far = rivals[SHOWN_RIVALS:] if levels <= MID_LEVELS else []
        for below in reason.rests_on:
            if not any(below is one for one in far):
                yield from _lines(below, levels - 1, f"{indent}  ", written)
        if far:
            yield f"{indent}  not chosen: {len(far)} more, which come less near (depth long lists them)"
    elif reason.rests_on and levels == 1 and indent:
        yield f"{indent}  ..."
