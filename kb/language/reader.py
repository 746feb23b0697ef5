r"""Our own reader for fact files.

A fact file holds facts and comments, nothing else: no rule, no directive, no variable. Reading executes nothing, and
the text never reaches clingo (which a stray byte can kill, and which wraps big numbers and accepts misspelt predicates
in silence).

    fact  = name [ "(" term { "," term } ")" ] "."
    term  = ["-"] digits | '"' characters '"' | name [ "(" term { "," term } ")" ]

A name is any word of letters, digits, `_` and `'` that begins with a small letter (after any `_`), except `not`.
Strings know the escapes `\"`, `\\` and `\n`; comments run from `%` to the end of the line, or from `%*` to `*%`, which
nest.
"""

import re
from pathlib import Path

from kb.language.diagnostics import ENOUGH, BadInputError, Problem, Span
from kb.language.source_text import Source, decode, read_source
from kb.language.terms import Fact, Number, Symbol, Term, Text
from kb.language.tokens import Token, tokens

DEEPEST = 64  # how far terms may be nested
BITS = range(-(2**31), 2**31)
MOST_FACTS = 100_000
KEYWORDS = frozenset({"not"})  # names that the grammar of answer set programs keeps for itself
ESCAPE = re.compile(r"\\.")
ESCAPES = {"\\n": "\n", '\\"': '"', "\\\\": "\\"}


def read_facts(path: Path | str) -> tuple[Source, tuple[Fact, ...]]:
    """Read the facts of a file, in order.

    Raises CannotOpenError when it cannot be read and BadInputError with every problem of form that it has.
    """
    source = read_source(path)
    return source, parse_facts(source)


def facts_of(text: str, file: str = "input") -> tuple[Fact, ...]:
    """Return the facts that a piece of text states (what a user typed); raises BadInputError.

    >>> [str(fact) for fact in facts_of('object(x). shape(x, square).  % a claim')]
    ['object(x)', 'shape(x,square)']
    """
    return parse_facts(decode(file, text.encode("utf-8", errors="surrogateescape")))


def parse_facts(source: Source) -> tuple[Fact, ...]:
    """Return the facts of a text; raises BadInputError with every problem of form that it has."""
    reader = _Reader(source)
    facts = reader.facts()
    if reader.problems:
        raise BadInputError(reader.problems)
    return facts


class _RefusedError(Exception):
    """The fact being read is none; the reader goes on after the next full stop."""


class _Reader:
    """A recursive-descent reader over the tokens of one text."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.problems: list[Problem] = []
        self._coming = tokens(source, self.problems)
        self.peek = next(self._coming)
        self.ended = False  # the full stop of the fact that is refused has been taken

    def facts(self) -> tuple[Fact, ...]:
        found = []
        while self.peek.kind != "end" and len(self.problems) < ENOUGH:
            try:
                found.append(self.fact())
            except _RefusedError:
                self.skip()
            if len(found) > MOST_FACTS:
                self.refuse(self.peek, f"more than {MOST_FACTS} facts")
                break
        return tuple(found)

    def take(self) -> Token:
        token = self.peek
        self.peek = next(self._coming, token)
        return token

    def skip(self) -> None:
        """Go on after the next full stop, or where a fact plainly begins on a new line."""
        if self.ended:
            self.ended = False
            return
        line = self.peek.span.line
        while self.peek.kind != "end":
            if self.take().text == ".":
                return
            if self.peek.kind == "name" and self.peek.span.start == 1 and self.peek.span.line > line:
                return

    def refuse(self, token: Token, what: str, hint: str = "") -> _RefusedError:
        self.problems.append(self.source.problem(token.span, what, hint))
        return _RefusedError()

    def fact(self) -> Fact:
        token = self.peek
        if token.kind != "name":
            raise self.not_a_fact(token)
        fact = self.symbol(0)
        if self.peek.text != ".":
            raise self.not_the_end(fact, self.peek)
        self.take()
        return fact

    def term(self, depth: int) -> Term:
        token = self.peek
        if depth > DEEPEST:
            raise self.refuse(token, f"terms are nested more than {DEEPEST} deep")
        if token.kind == "name":
            return self.symbol(depth)
        if token.kind == "string":
            return self.string()
        if token.kind == "number" or token.text == "-":
            return self.number()
        if token.kind == "open":
            raise _RefusedError  # already reported
        raise self.not_a_term(token)

    def symbol(self, depth: int) -> Symbol:
        name = self.take()
        if name.text in KEYWORDS and (depth or self.peek.kind not in ("name", "variable")):
            what = f"{name.text} is a word of the language and cannot name anything"
            raise self.refuse(name, what, "take another name")
        if self.peek.text != "(":
            return Symbol(name.text, (), name.span)
        self.take()
        args = [self.term(depth + 1)]
        while self.peek.text == ",":
            self.take()
            args.append(self.term(depth + 1))
        close = self.peek
        if close.text != ")":
            raise self.not_closed(close)
        self.take()
        end = close.span.end if close.span.line == name.span.line else name.span.end
        return Symbol(name.text, tuple(args), Span(name.span.line, name.span.start, end))

    def string(self) -> Text:
        token = self.take()
        unknown = [piece for piece in ESCAPE.findall(token.text) if piece not in ESCAPES]
        if unknown:
            raise self.refuse(token, f"unknown escape {unknown[0]} in a string", 'strings know \\", \\\\ and \\n')
        return Text(ESCAPE.sub(lambda match: ESCAPES[match[0]], token.text[1:-1]), token.span)

    def number(self) -> Number:
        sign = self.take() if self.peek.text == "-" else None
        token = self.take()
        if token.kind != "number":
            raise self.refuse(token, "a minus sign must be followed by a number")
        span = Span(token.span.line, sign.span.start if sign else token.span.start, token.span.end)
        digits = token.text.lstrip("0") or "0"
        value = int(digits) if len(digits) <= 10 else 2**31
        value = -value if sign else value
        if value not in BITS or len(digits) > 10:
            raise self.refuse(Token("number", token.text, span), "a number beyond 32 bits", "-2147483648 .. 2147483647")
        if self.peek.text == ".":  # a fact cannot end inside of a term
            stop = self.take()
            self.ended = self.peek.kind != "number"
            if self.ended:
                raise self.not_closed(stop)
            raise self.refuse(token, "a number with a fraction; facts know integers alone")
        return Number(value, span)

    def not_a_fact(self, token: Token) -> _RefusedError:
        if token.kind == "directive":
            return self.refuse(token, f"{token.text} is a directive; a fact file holds facts alone")
        if token.kind == "variable":
            return self.refuse(
                token, f"a fact cannot begin with the variable {token.text}", f"write {lower(token.text)}"
            )
        if token.text in (":-", ":~"):
            return self.refuse(token, "a constraint; a fact file holds facts alone")
        if token.text == "-":
            return self.refuse(token, "a negated fact; state only what holds")
        if token.text == "{":
            return self.refuse(token, "a choice; a fact file holds facts alone")
        return self.refuse(token, f"a fact was expected, {token.named} found")

    def not_the_end(self, fact: Fact, token: Token) -> _RefusedError:
        if token.text == ":-":
            return self.refuse(token, "a rule; a fact file holds facts alone", "remove everything from :- on")
        if token.text in (",", ";", "|", ":"):
            return self.refuse(token, f"a fact ends in a full stop, not in {token.named}", "write one fact at a time")
        if token.kind == "name" and fact.name == "not":
            return self.refuse(token, "a negated fact; state only what holds")
        return self.refuse(token, f"a full stop was expected after the fact, {token.named} found")

    def not_a_term(self, token: Token) -> _RefusedError:
        if token.kind == "variable":
            what = f"{token.text} is a variable; facts have none"
            return self.refuse(token, what, f'write {lower(token.text)}, or "{token.text}" for a text')
        if token.text == ")":
            return self.refuse(token, "an argument is missing before ')'")
        return self.refuse(token, f"a term was expected, {token.named} found")

    def not_closed(self, token: Token) -> _RefusedError:
        if token.text in ("..", ";", "+", "-", "*", "/", "**", "|", "&", "?", "^", "\\", "@"):
            return self.refuse(token, f"{token.named}: intervals, pools and sums are not facts", "write them out")
        return self.refuse(token, f"',' or ')' was expected, {token.named} found")


def lower(name: str) -> str:
    """Return a variable's name as the name of a thing: X1 becomes x1, _ becomes x."""
    return name.strip("_").lower() or "x"
