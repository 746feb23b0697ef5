"""Impressions with few characters: what 160 fields observe, what was predicted for them, and how it was explained.

The least and the greatest level that were predicted for a field and the one observed are mostly one sign: see
`level_signs`. `status` is told by these but for exceptions, and `cells` by `status`. `explained` is told by a letter
for each explained field. What has not the form that an episode of ours has stays as it is.
"""

import re
import string
from collections import Counter
from typing import Any

from simulator.episode.episode import EpisodeLine

FIELD_COUNT = 160
LEVELS = 8  # that a field can show
# The bounds that can be predicted for a field, least and most, each with its number: those that agree come first.
BOUNDS = {
    (least, least + more): n for n, (more, least) in enumerate((m, k) for m in range(LEVELS) for k in range(LEVELS - m))
}
LEVEL_SIGNS = (
    string.digits + string.ascii_letters + "!#"
)  # for each bounds with the greatest level, then with the least
BETWEEN = "'"  # before the sign of bounds with the greatest level, and the level, where it is neither
STATUS_WORDS = {"p": "predicted", "e": "explained", "n": "noise"}
MAX_LETTERS = 26  # facts that can explain fields of one impression, by a letter each


def pack_impression(line: EpisodeLine) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the impression of a step's line, packed, and its belief without what is told by that."""
    belief = dict(line["belief"])
    packed: dict[str, Any] = {}
    retina = "".join(map(str, line["retina"]))
    signs = level_signs(belief.get("least"), belief.get("most"), retina)
    if signs is None:
        packed["retina"] = retina
    else:
        packed["levels"] = signs
        del belief["least"], belief["most"]
    status = belief.get("status")
    if isinstance(status, str) and re.fullmatch(f"[pen]{{{FIELD_COUNT}}}", status):
        packed["status"] = _exceptions(status, expected_status(line))
        del belief["status"]
        if belief.get("cells") == {STATUS_WORDS[letter]: count for letter, count in Counter(status).items()}:
            del belief["cells"]
        letters = _letters(belief.get("explained"), status)
        if letters is not None:
            packed["explained"] = letters
            del belief["explained"]
    return packed, belief


def expected_status(line: EpisodeLine) -> str:
    """Return the status that each field most likely has, by what is observed and what was predicted."""
    least, most = (line["belief"].get(key) for key in ("least", "most"))
    if not all(isinstance(text, str) and re.fullmatch(f"[0-7]{{{FIELD_COUNT}}}", text) for text in (least, most)):
        return "p" * FIELD_COUNT
    levels = map(str, line["retina"])
    return "".join(
        "e" if low <= level <= high and low != high else "p" if low == level == high else "n"
        for low, level, high in zip(least, levels, most, strict=True)
    )


def level_signs(least: Any, most: Any, retina: str) -> str | None:
    """Return a text that tells, for each field, the least and the greatest predicted level and the one observed."""
    texts = (least, most, retina)
    if not all(isinstance(text, str) and re.fullmatch(f"[0-7]{{{FIELD_COUNT}}}", text) for text in texts):
        return None
    signs = []
    for low, high, level in zip(*texts, strict=True):
        number = BOUNDS.get((int(low), int(high)))
        if number is None:
            return None
        if level == high:
            signs.append(LEVEL_SIGNS[number])
        elif level == low:
            signs.append(LEVEL_SIGNS[len(BOUNDS) + number - LEVELS])
        else:
            signs.append(BETWEEN + LEVEL_SIGNS[number] + level)
    return "".join(signs)


def _exceptions(status: str, expected: str) -> str:
    """Return where a status is another one than expected, such as `12p40e`."""
    pairs = enumerate(zip(status, expected, strict=True))
    return "".join(f"{field}{letter}" for field, (letter, told) in pairs if letter != told)


def _letters(explained: Any, status: str) -> list[Any] | None:
    """Return `explained` as its facts and, for each explained field in order, the letter of its fact."""
    # Returns None where it does not name each field of status `e` just once, in ascending order, by at most 26 facts.
    if not isinstance(explained, dict) or len(explained) > MAX_LETTERS:
        return None
    letter_of: dict[int, str] = {}
    for number, fields in enumerate(explained.values()):
        if not isinstance(fields, list) or not all(type(field) is int for field in fields) or fields != sorted(fields):
            return None
        letter_of |= {field: chr(ord("a") + number) for field in fields}
    marked = [field for field, letter in enumerate(status) if letter == "e"]
    if sorted(letter_of) != marked or sum(map(len, explained.values())) != len(marked):
        return None
    return [list(explained), "".join(letter_of[field] for field in marked)]
