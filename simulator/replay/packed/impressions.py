"""Impressions with few characters: what 160 fields observe, what was predicted for them, and how it was explained.

Digits are written as what they are above others: the greatest level above the least, what is observed above the
greatest. `status` is told by these but for exceptions, and `cells` by `status`. `explained` is told by a letter for
each explained field. What has not the form that an episode of ours has stays as it is.
"""

import re
from collections import Counter
from typing import Any

from simulator.episode.episode import EpisodeLine

FIELD_COUNT = 160
DIGIT_KEYS = ("least", "most", "retina")  # each is written as what it is above the one before, in this order
STATUS_WORDS = {"p": "predicted", "e": "explained", "n": "noise"}
MAX_LETTERS = 26  # facts that can explain fields of one impression, by a letter each


def pack_impression(line: EpisodeLine) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the impression of a step's line, packed, and its belief without what is told by that.

    Parameters
    ----------
    line : the line of a step.

    Returns
    -------
    A dictionary with the keys `least`, `most`, `retina`, `status` and `explained`, as far as they can be packed, of
    which `explained` is [facts, letters]; and the rest of the belief.
    """
    belief = dict(line["belief"])
    packed: dict[str, Any] = {}
    below = ""
    for key in DIGIT_KEYS:
        text = "".join(map(str, line["retina"])) if key == "retina" else belief.get(key)
        if isinstance(text, str) and re.fullmatch(f"[0-7]{{{FIELD_COUNT}}}", text):
            packed[key] = _above(text, below) if below else text
            belief.pop(key if key != "retina" else "", None)
            below = text
        else:
            below = ""
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
    """Return the status that each field most likely has, by what is observed and what was predicted.

    It is `n` where the level is out of bounds, `p` where the bounds are one, else `e`. Without bounds it is `p`.
    """
    least, most = (line["belief"].get(key) for key in ("least", "most"))
    if not all(isinstance(text, str) and re.fullmatch(f"[0-7]{{{FIELD_COUNT}}}", text) for text in (least, most)):
        return "p" * FIELD_COUNT
    levels = map(str, line["retina"])
    return "".join(
        "e" if low <= level <= high and low != high else "p" if low == level == high else "n"
        for low, level, high in zip(least, levels, most, strict=True)
    )


def _above(digits: str, below: str) -> str:
    """Return by how much each of some digits is above another one, modulo 8, as digits."""
    return "".join(str((int(a) - int(b)) % 8) for a, b in zip(digits, below, strict=True))


def _exceptions(status: str, expected: str) -> str:
    """Return where a status is another one than expected, such as `12p40e`."""
    pairs = enumerate(zip(status, expected, strict=True))
    return "".join(f"{field}{letter}" for field, (letter, told) in pairs if letter != told)


def _letters(explained: Any, status: str) -> list[Any] | None:
    """Return `explained` as its facts and, for each explained field in order, the letter of its fact.

    Returns None where it does not name each field of status `e` just once, in ascending order, by at most 26 facts.
    """
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
