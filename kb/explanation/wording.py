"""Claims in plain words: atoms, what is not known, comparisons, aggregates."""

import re
from collections.abc import Iterable, Mapping, Sequence

from utak.kb.explanation.support import CountedElement, LiteralValue, aggregate_value
from utak.kb.language.atoms import atom_parts
from utak.kb.reasoning.sentences import PredicateWords, fill
from utak.kb.three_valued.values import MIRRORED_SIGNS
from utak.kb.tracing.syntax import ANY_NAME, JsonValues

WordsByPredicate = Mapping[tuple[str, int], PredicateWords]
SIGN_WORDS = {
    "=": "is", "!=": "is not", "<": "is less than", "<=": "is at most", ">": "is more than", ">=": "is at least",
}  # fmt: skip
AGGREGATE_WORDS = {
    "#count": "the number of", "#sum": "the sum of", "#sum+": "the sum of the positive ones of",
    "#min": "the least of", "#max": "the greatest of",
}  # fmt: skip
VARIABLE = re.compile(r""""(?:[^"\\]|\\.)*"|\b_*[A-Z][A-Za-z0-9_']*""")  # or a string, in which nothing is one
ARITHMETIC_SIGNS = tuple("+-*/\\&?^~")
FACTOR = r"(?:\w+|\(-\w+\)|-\w+)"
PRODUCT = re.compile(
    rf"(?<![*/\\\w])(?<!^-)(?<![-+*/\\(]-)\(({FACTOR}(?:[*/\\]{FACTOR})+)\)(?![*/\\])"
)  # in brackets to spare
MAX_MEMBERS_SHOWN = 6  # members of an aggregate that its words list; a convention


def atom_words(atom: str, words: WordsByPredicate) -> str:
    """Return an atom that holds in plain words: as its predicate reads, or else the atom itself."""
    name, arguments = atom_parts(atom)
    found = words.get((name, len(arguments)))
    return fill(found.holds, dict(zip(found.variables, arguments, strict=True))) if found else atom


def absent_words(atom: str, words: WordsByPredicate) -> str:
    """Return in plain words that an atom is not known to hold; `any__` among its arguments stands for any value."""
    name, arguments = atom_parts(atom)
    found = words.get((name, len(arguments)))
    if found:
        values = dict(zip(found.variables, arguments, strict=True))
        free = [name for name, value in values.items() if value == ANY_NAME]
        if found.absent and not free:
            return fill(found.absent, values)
        known = fill(found.holds, values | dict(zip(free, free, strict=True)))
        return f"for no {' and '.join(free)} is it known that {known}" if free else f"it is not known that {known}"
    return f"no {atom_pattern(atom)} is known"


def atom_pattern(atom: str) -> str:
    """Return a negated atom as rules write it, `_` for any value."""
    return re.sub(rf"\b{ANY_NAME}\b", "_", atom)


def comparison_claim(info: JsonValues, sides: Sequence[str], values: Mapping[str, str] | None) -> str:
    """Return a comparison with values in the place of its variables."""
    # None when some are not known, then the computed sides stand in the claim.
    texts = list(sides) if values is None else [_unwrapped(substituted(text, values)) for text in info["sides"]]
    parts = [texts[0]]
    for sign, text in zip(info["signs"], texts[1:], strict=True):
        parts += [sign, text]
    return ("not " if info["negated"] else "") + " ".join(parts)


def comparison_words(info: JsonValues, sides: Sequence[str], values: Mapping[str, str] | None) -> str:
    """Return a comparison in plain words; parameters as of `comparison_claim`."""
    written = list(sides) if values is None else [_unwrapped(substituted(text, values)) for text in info["sides"]]
    texts = [
        text if text in (side, f'"{side}"') or ".." in text or _is_quoted(side) else f"{text} = {side}"
        for text, side in zip(written, sides, strict=True)
    ]
    if info["signs"] == ["="] and sides[0] == sides[1]:
        texts = written
    parts = [
        f"{left} {_compared(sign, right)}" for left, sign, right in zip(texts, info["signs"], texts[1:], strict=False)
    ]
    return ("it is not so that " if info["negated"] else "") + " and ".join(parts)


def _compared(sign: str, right: str) -> str:
    """Return what a comparison says of its left side."""
    first, interval, last = right.partition("..")
    return f"is one of {first} to {_unwrapped(last)}" if interval and sign == "=" else f"{SIGN_WORDS[sign]} {right}"


def aggregate_claim(info: JsonValues, bounds: Sequence[str], elements: Sequence[CountedElement]) -> str:
    """Return an aggregate over what counts in it, such as `10 = #max { 10; 7 }`."""
    members = "; ".join(dict.fromkeys(member_text(one.terms) for one in elements))
    terms = iter(bounds)
    left, right = (f"{next(terms)} {sign}" if sign else "" for sign in info["signs"])
    if right:
        bound, _, sign = right.rpartition(" ")
        right = f"{sign} {bound}"
    text = " ".join(part for part in (left, f"{info['function']} {{ {members} }}", right) if part)
    return ("not " if info["negated"] else "") + text


def aggregate_words(info: JsonValues, bounds: Sequence[str], elements: Sequence[CountedElement]) -> str:
    """Return an aggregate in plain words, such as `the greatest of 10, 7 is 10`."""
    members = list(dict.fromkeys(member_text(one.terms) for one in elements))
    value = aggregate_value(info, elements)
    if not members and info["function"] in ("#max", "#min"):
        return f"nothing is known of which it could be {AGGREGATE_WORDS[info['function']].removesuffix(' of')}"
    listed = ", ".join(members[:MAX_MEMBERS_SHOWN]) or "what is known of this kind (nothing)"
    more = len(members) - MAX_MEMBERS_SHOWN
    listed += f" and {more} more" if more > 0 else ""
    terms = iter(bounds)
    limits = []
    for side, sign in enumerate(info["signs"]):
        if sign:
            bound, word = next(terms), MIRRORED_SIGNS[sign] if side == 0 else sign
            limits += [] if (word, bound) == ("=", value) else [f"which {SIGN_WORDS[word]} {bound}"]
    text = f"{AGGREGATE_WORDS[info['function']]} {listed} is {value}"
    return ("not so: " if info["negated"] else "") + ", ".join([text, *limits])


def member_text(terms: Iterable[LiteralValue]) -> str:
    """Return the tuple of an element as text, without brackets when it has one member."""
    texts = [one if isinstance(one, str) else f"({','.join(one)})" for one in terms]
    return ",".join(texts)


def substituted(text: str, values: Mapping[str, str]) -> str:
    """Return a text of the program with values in the place of variables; a variable without a value stays."""

    def value(match: re.Match[str]) -> str:
        """Return what stands in the place of a variable or a string."""
        found = values.get(match.group(), match.group())
        signed = text[: match.start()].endswith(ARITHMETIC_SIGNS) or text.startswith("**", match.end())
        return f"({found})" if found.startswith("-") and signed else found

    return VARIABLE.sub(value, text)


def variables_in(text: str) -> set[str]:
    """Return the names of the variables in a text of the program, strings in it left out."""
    return {found for found in VARIABLE.findall(text) if not found.startswith('"')}


def _unwrapped(text: str) -> str:
    """Return arithmetic without brackets around all of it, and around products where what stands beside needs none."""
    text = PRODUCT.sub(r"\1", text)
    if text.startswith("(") and text.endswith(")"):
        depth = 0
        for index, char in enumerate(text):
            depth += (char == "(") - (char == ")")
            if depth == 0 and index < len(text) - 1:
                return text
        return text[1:-1]
    return text


def _is_quoted(text: str) -> bool:
    """Return whether a text is a string of the program."""
    return text.startswith('"')
