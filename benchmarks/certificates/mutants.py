"""Certificates changed in one place: a number, an index, a word, a key, a line left out, told twice or exchanged."""

from collections.abc import Iterator
from copy import deepcopy
from typing import Any

import numpy as np


def mutants(certificate: dict[str, Any], count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Yield some certificates that differ from one in one place each."""
    random = np.random.default_rng(seed)
    while count > 0:
        mutant = deepcopy(certificate)
        places = list(_places(mutant))
        holder, key = places[int(random.integers(len(places)))]
        _change(holder, key, random)
        if mutant != certificate:
            count -= 1
            yield mutant


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Yield each (holder, key or index) of a JSON value."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in list(items):
        yield value, key
        yield from _places(part)


def _change(holder: Any, key: Any, random: np.random.Generator) -> None:
    """Change what a holder has at a key."""
    part = holder[key]
    if isinstance(part, int) and random.random() < 0.8:
        holder[key] = part + int(random.choice([-90, -8, -2, -1, 1, 2, 8, 160]))
    elif isinstance(part, str) and random.random() < 0.5:
        holder[key] = str(random.choice(["count", "end", "holds", "angle", "replay", "along(grid)", "done", ""]))
    elif isinstance(holder, list) and random.random() < 0.5:
        other = int(random.integers(len(holder)))
        holder[key], holder[other] = holder[other], holder[key]
    elif isinstance(holder, list) and random.random() < 0.3:
        holder.insert(key, deepcopy(part))
    else:
        del holder[key]
