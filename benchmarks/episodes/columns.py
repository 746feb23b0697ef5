"""Which columns of a packed episode need the bytes of its page.

A column's bytes are those by which the first block, or the index, would be shorter without it.
"""

from typing import Any

from simulator.episode.episode import Episode
from simulator.replay.packed.events import episode_events
from simulator.replay.packed.packing import packed_episode
from simulator.replay.packed.short_texts import short_text, values_of

MAX_REPORTED = 12  # columns of a block that are reported


def column_report(episode: Episode) -> tuple[str, list[str]]:
    """Return what a page keeps of decisions, such as "6,60", and lines with the bytes of each column for each step."""
    index, first, *_ = map(values_of, packed_episode(episode, episode_events(episode)))
    kept = ",".join(map(str, index[0]["detail"]))
    steps = min(index[0]["steps"], index[0]["block"])
    rows = [(_less(first, n), ".".join(path)) for n, (path, _) in enumerate(first)]
    told = index[0]["columns"]
    for name in told:
        without = {**index[0], "columns": {key: value for key, value in told.items() if key != name}}
        rows.append(
            ((len(short_text(index)) - len(short_text([without]))) * steps // index[0]["steps"], f"index.{name}")
        )
    rows.sort(reverse=True)
    return kept, [f"    {size / steps:>6.1f}  {name}" for size, name in rows[:MAX_REPORTED]]


def _less(values: list[Any], number: int) -> int:
    """Return by how many bytes a text is shorter without one of its values."""
    return len(short_text(values)) - len(short_text(values[:number] + values[number + 1 :]))
