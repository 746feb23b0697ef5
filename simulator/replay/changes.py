"""Changes of the facts of a world model from one step to the next."""

import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import NamedTuple

OUTLINE_START = "segment("  # facts that begin so are counted by node: one more corner renumbers all edges behind it
WHOLE_ARGUMENT = re.compile(r"([(,])-?\d+(?=[,)])", re.ASCII)  # an argument that is a number


class Changes(NamedTuple):
    """The difference between the facts of two steps."""

    added: list[str]  # facts that are new, or gone
    removed: list[str]
    changed: list[tuple[str, str]]  # pairs of a former and a new fact that differ in numbers alone
    edges: dict[str, int]  # how many edges of each node's outline are new, or gone where none is new


def changes(before: Sequence[str], after: Sequence[str]) -> Changes:
    """Return what changed from the facts of a step to those of the next one.

    Examples
    --------
    >>> changes(["kind(o1,object,20)."], ["kind(o1,object,95).", "node(o2)."])
    Changes(added=['node(o2).'], removed=[], changed=[('kind(o1,object,20).', 'kind(o1,object,95).')], edges={})
    """
    old, new = set(before), set(after)
    gone, come = [fact for fact in before if fact not in new], [fact for fact in after if fact not in old]
    edges = Counter(map(outlined_node, filter(is_outline, come)))
    lost = Counter(map(outlined_node, filter(is_outline, gone)))
    edges.update({name: count for name, count in lost.items() if name not in edges})
    waiting: dict[str, list[str]] = defaultdict(list)
    for fact in gone:
        if not is_outline(fact):
            waiting[WHOLE_ARGUMENT.sub(r"\1#", fact)].append(fact)
    added, changed = [], []
    for fact in come:
        former = waiting.get(WHOLE_ARGUMENT.sub(r"\1#", fact))
        if former:
            changed.append((former.pop(0), fact))
        elif not is_outline(fact):
            added.append(fact)
    return Changes(added, [fact for rest in waiting.values() for fact in rest], changed, dict(edges))


def is_outline(fact: str) -> bool:
    """Return whether a fact is an edge of an outline; many of them change at every step."""
    return fact.startswith(OUTLINE_START)


def outlined_node(fact: str) -> str:
    """Return the node of which a fact states an edge of the outline."""
    return fact[len(OUTLINE_START) :].partition(",")[0]
