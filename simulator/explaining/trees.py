"""Trees of reasons for the steps of a whole episode, cut to what a page can hold."""

from collections.abc import Sequence
from typing import Any

from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.language.diagnostics import BadInputError
from utak.simulator.episode.episode import Episode
from utak.simulator.explaining.questions import questions_of_episode

TREE_LEVELS = 4  # levels of a tree that a page holds; a convention, for the size of the page
MAX_EXPLAINED_STEPS = 100  # steps of an episode whose commands are explained in a page: bounds the time to write it
MAX_SENTENCE_CHARACTERS = 240  # characters of the text of a claim; a convention

TreeEntry = dict[str, Any]  # {"text": str, "children": [...]}, or without children


def trees_of_episode(
    episode: Episode, rule_files: Sequence[str] = (), certificate: str = ""
) -> dict[int, list[TreeEntry]]:
    """Return trees of reasons by step: why its command was given, and at the last step why the verdict is so."""
    questions, last = questions_of_episode(episode, rule_files, certificate), len(episode.steps) - 1
    stride = max(1, -(-last // MAX_EXPLAINED_STEPS))
    trees: dict[int, list[TreeEntry]] = {}
    try:
        for step in range(last, 0, -stride):
            trees[step] = [_entry(questions.why_step(step), TREE_LEVELS)]
        if episode.result is not None:
            trees.setdefault(last, []).append(_entry(questions.why("verdict(V)"), TREE_LEVELS))
    except BadInputError:
        return {}
    return trees


def _entry(reason: Reason, levels: int) -> TreeEntry:
    text = ": ".join(part for part in (reason.claim, reason.because) if part)
    entry: TreeEntry = {"text": text[:MAX_SENTENCE_CHARACTERS]}
    told = [one for one in reason.rests_on if one.kind != ReasonKind.COMPUTED and levels > 1]
    below = [_entry(one, levels - 1) for one in told]
    return entry | {"children": below} if below else entry
