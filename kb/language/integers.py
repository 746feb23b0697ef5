"""Integers in texts that clingo is to read: it wraps any to 32 bits in silence, so they are checked before."""

import re
from collections.abc import Iterator

from kb.language.diagnostics import Problem, Span
from kb.language.source_text import Source
from kb.language.tokens import tokens

LOW, HIGH = -(2**31), 2**31 - 1
BASES = {"0x": 16, "0o": 8, "0b": 2}
LITERAL = re.compile(r"0x[0-9A-Fa-f]+|0o[0-7]+|0b[01]+|[0-9]+")
BEFORE_A_TERM = frozenset("(,;=<>+*/\\&?^|{:[@") | {"<=", ">=", "!=", "..", "**", ":-", ":~", "not", "#count"}
LONGEST = 40  # digits of a number that are worked out


def wide_integers(source: Source) -> Iterator[Problem]:
    """Yield a problem for each integer of a program's text that has more than 32 bits, wherever it stands.

    Those in texts and comments are none. -2147483648 is one where its sign belongs to it.
    """
    ahead, before = "(", "("
    for token in tokens(source, []):
        if token.kind == "number":
            line = source.lines[token.span.line - 1]
            match = LITERAL.match(line, token.span.start - 1)
            assert match is not None
            lowest = before == "-" and (ahead in BEFORE_A_TERM or ahead.startswith("#"))
            if _magnitude(match.group()) > HIGH + lowest:
                span = Span(token.span.line, token.span.start, match.end())
                yield source.problem(span, "a number beyond 32 bits", "-2147483648 .. 2147483647")
        ahead, before = before, token.text


def _magnitude(text: str) -> int:
    base = BASES.get(text[:2], 10)
    digits = (text[2:] if base != 10 else text).lstrip("0")
    return int(digits or "0", base) if len(digits) <= LONGEST else HIGH + 2
