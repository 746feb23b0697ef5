"""The check for integers beyond 32 bits in texts that clingo will read.

clingo's integers have 32 bits, and it wraps greater ones without a message. So all integers are checked before.
"""

import re
from collections.abc import Iterable, Iterator

from utak.kb.language.diagnostics import Problem, SourceSpan
from utak.kb.language.source_text import Source
from utak.kb.language.tokens import Token, tokenize

MIN_INT32, MAX_INT32 = -(2**31), 2**31 - 1  # the range of clingo's integers
INTEGER_BASES = {"0x": 16, "0o": 8, "0b": 2}  # by the prefix of a literal of gringo's language
INTEGER_LITERAL = re.compile(r"0x[0-9A-Fa-f]+|0o[0-7]+|0b[01]+|[0-9]+")  # integers as clingo reads them
# A minus sign after one of these tokens, or after a directive, is a sign and no subtraction.
TOKENS_BEFORE_A_TERM = frozenset("(,;=<>+*/\\&?^|{:[@") | {"<=", ">=", "!=", "..", "**", ":-", ":~", "not", "#count"}
MAX_DIGITS_CONVERTED = 40  # a literal with more digits is beyond 32 bits in every base; its value is not computed


def integers_beyond_32_bits(source: Source, tokens: Iterable[Token] | None = None) -> Iterator[Problem]:
    """Yield a problem for each integer of a program's text that does not fit in 32 bits."""
    ahead, before = "(", "("
    for token in tokenize(source, []) if tokens is None else tokens:
        if token.kind == "number":
            line = source.lines[token.span.line - 1]
            match = INTEGER_LITERAL.match(line, token.span.start - 1)
            assert match is not None
            lowest = before == "-" and (ahead in TOKENS_BEFORE_A_TERM or ahead.startswith("#"))
            if _magnitude(match.group()) > MAX_INT32 + lowest:
                span = SourceSpan(token.span.line, token.span.start, match.end())
                yield source.problem(span, "a number beyond 32 bits", "-2147483648 .. 2147483647")
        ahead, before = before, token.text


def _magnitude(text: str) -> int:
    """Return the value of an integer literal without a sign, or any value beyond 32 bits for one of too many digits."""
    base = INTEGER_BASES.get(text[:2], 10)
    digits = (text[2:] if base != 10 else text).lstrip("0")
    return int(digits or "0", base) if len(digits) <= MAX_DIGITS_CONVERTED else MAX_INT32 + 2
