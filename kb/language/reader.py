r"""The reader of fact files.

A fact file holds facts and comments, nothing else: no rule, no directive, no variable. Reading executes nothing. The
text never reaches clingo: a stray byte can crash clingo, and clingo wraps great integers and accepts misspelt
predicates without a message.

    fact  = name [ "(" term { "," term } ")" ] "."
    term  = ["-"] digits | '"' characters '"' | name [ "(" term { "," term } ")" ]

A name is a word of letters, digits, `_` and `'` that begins with a lower-case letter (after any `_`), except `not`.
Strings have the escapes `\"`, `\\` and `\n`. Comments run from `%` to the end of the line, or from `%*` to `*%`; the
latter can be nested.
"""

import re
from pathlib import Path

from utak.kb.language.diagnostics import MAX_PROBLEMS_PER_FILE, BadInputError, Problem, SourceSpan
from utak.kb.language.source_text import Source, read_source, source_from_bytes
from utak.kb.language.terms import Fact, Number, Symbol, Term, Text
from utak.kb.language.tokens import Token, tokenize

MAX_TERM_DEPTH = 64  # terms nested in each other (docs/files.md)
INT32_RANGE = range(-(2**31), 2**31)  # the range of clingo's integers
MAX_FACTS = 100_000  # facts of one file (docs/files.md)
ASP_KEYWORDS = frozenset({"not"})  # words of the ASP language that cannot be names
ESCAPE_SEQUENCE = re.compile(r"\\.")  # a backslash and the character after it
ESCAPED_CHARACTERS = {"\\n": "\n", '\\"': '"', "\\\\": "\\"}  # the valid escapes


def read_facts(path: Path | str) -> tuple[Source, tuple[Fact, ...]]:
    """Read a fact file."""
    source = read_source(path)
    return source, parse_facts(source)


def facts_from_text(text: str, file: str = "input") -> tuple[Fact, ...]:
    """Return the facts that a text states.

    Examples
    --------
    >>> [str(fact) for fact in facts_from_text('object(x). shape(x, square).  % a claim')]
    ['object(x)', 'shape(x,square)']
    """
    return parse_facts(source_from_bytes(file, text.encode("utf-8", errors="surrogateescape")))


def parse_facts(source: Source) -> tuple[Fact, ...]:
    """Return the facts of a source text, in order."""
    reader = _Reader(source)
    facts = reader.facts()
    if reader.problems:
        raise BadInputError(reader.problems)
    return facts


class _RefusedError(Exception):
    """A fact with a syntax error, which is recorded; the reader continues after the next full stop."""


class _Reader:
    """A recursive-descent parser over the tokens of one text."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.problems: list[Problem] = []
        self._coming = tokenize(source, self.problems)
        self.peek = next(self._coming)
        self.ended = False  # whether the full stop of the refused fact has been read

    def facts(self) -> tuple[Fact, ...]:
        """Return all valid facts in order; problems are collected in `self.problems`."""
        found = []
        while self.peek.kind != "end" and len(self.problems) < MAX_PROBLEMS_PER_FILE:
            try:
                found.append(self.fact())
            except _RefusedError:
                self.skip()
            if len(found) > MAX_FACTS:
                self.refuse(self.peek, f"more than {MAX_FACTS} facts")
                break
        return tuple(found)

    def take(self) -> Token:
        """Return the next token and move on to the one after it; the token `end` is returned again and again."""
        token = self.peek
        self.peek = next(self._coming, token)
        return token

    def skip(self) -> None:
        """Continue after the next full stop, or where a fact begins in the first column of a new line."""
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
        """Record a problem at a token, and return the exception that the caller raises."""
        self.problems.append(self.source.problem(token.span, what, hint))
        return _RefusedError()

    def fact(self) -> Fact:
        """Read one fact with its full stop, and return it: a name with its arguments and its place."""
        # Raises _RefusedError, after recording a problem, where something else stands.
        token = self.peek
        if token.kind != "name":
            raise self.not_a_fact(token)
        fact = self.symbol(0)
        if self.peek.text != ".":
            raise self.not_the_end(fact, self.peek)
        self.take()
        return fact

    def term(self, depth: int) -> Term:
        """Read one term, and return it: a number, a text, or a name with its arguments."""
        # Raises _RefusedError, after recording a problem, where something else stands or the terms are nested too deep.
        token = self.peek
        if depth > MAX_TERM_DEPTH:
            raise self.refuse(token, f"terms are nested more than {MAX_TERM_DEPTH} deep")
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
        """Read a name with its arguments, if there are any, and return it."""
        # Raises _RefusedError, after recording a problem, for a syntax error.
        name = self.take()
        if name.text in ASP_KEYWORDS and (depth or self.peek.kind not in ("name", "variable")):
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
        return Symbol(name.text, tuple(args), SourceSpan(name.span.line, name.span.start, end))

    def string(self) -> Text:
        """Read a quoted string, replace its escapes, and return it; raise _RefusedError for an unknown escape."""
        token = self.take()
        unknown = [piece for piece in ESCAPE_SEQUENCE.findall(token.text) if piece not in ESCAPED_CHARACTERS]
        if unknown:
            raise self.refuse(token, f"unknown escape {unknown[0]} in a string", 'strings know \\", \\\\ and \\n')
        return Text(ESCAPE_SEQUENCE.sub(lambda match: ESCAPED_CHARACTERS[match[0]], token.text[1:-1]), token.span)

    def number(self) -> Number:
        """Read an integer with its sign, and return it; raise _RefusedError beyond 32 bits and for a fraction."""
        sign = self.take() if self.peek.text == "-" else None
        token = self.take()
        if token.kind != "number":
            raise self.refuse(token, "a minus sign must be followed by a number")
        span = SourceSpan(token.span.line, sign.span.start if sign else token.span.start, token.span.end)
        digits = token.text.lstrip("0") or "0"
        value = int(digits) if len(digits) <= 10 else 2**31
        value = -value if sign else value
        if value not in INT32_RANGE or len(digits) > 10:
            raise self.refuse(Token("number", token.text, span), "a number beyond 32 bits", "-2147483648 .. 2147483647")
        if self.peek.text == ".":  # a fraction, or a fact that ends inside a term
            stop = self.take()
            self.ended = self.peek.kind != "number"
            if self.ended:
                raise self.not_closed(stop)
            whole = f"{'-' * (value < 0 or sign is not None)}{token.text}.{self.peek.text}"
            raise self.refuse(
                token, "a number with a fraction; facts know integers alone", f'quoted where one may stand: "{whole}"'
            )
        return Number(value, span)

    def not_a_fact(self, token: Token) -> _RefusedError:
        """Return, not raise, the error for a token with which no fact begins; its problem is recorded."""
        if token.kind == "directive":
            return self.refuse(token, f"{token.text} is a directive; a fact file holds facts alone")
        if token.kind == "variable":
            return self.refuse(
                token, f"a fact cannot begin with the variable {token.text}", f"write {_lower_case_name(token.text)}"
            )
        if token.text in (":-", ":~"):
            return self.refuse(token, "a constraint; a fact file holds facts alone")
        if token.text == "-":
            return self.refuse(token, "a negated fact; state only what holds")
        if token.text == "{":
            return self.refuse(token, "a choice; a fact file holds facts alone")
        return self.refuse(token, f"a fact was expected, {token.in_words} found")

    def not_the_end(self, fact: Fact, token: Token) -> _RefusedError:
        """Return, not raise, the error for a token where the full stop of `fact` belongs; its problem is recorded."""
        if token.text == ":-":
            return self.refuse(token, "a rule; a fact file holds facts alone", "remove everything from :- on")
        if token.text in (",", ";", "|", ":"):
            return self.refuse(token, f"one fact at a time, and no {token.in_words} after it", "end it in a full stop")
        if token.kind == "name" and fact.name == "not":
            return self.refuse(token, "a negated fact; state only what holds")
        return self.refuse(token, f"a full stop was expected after the fact, {token.in_words} found")

    def not_a_term(self, token: Token) -> _RefusedError:
        """Return, not raise, the error for a token with which no term begins; its problem is recorded."""
        if token.kind == "variable":
            what = f"{token.text} is a variable; facts have none"
            return self.refuse(token, what, f'write {_lower_case_name(token.text)}, or "{token.text}" for a text')
        if token.text == ")":
            return self.refuse(token, "an argument is missing before ')'")
        return self.refuse(token, f"a term was expected, {token.in_words} found")

    def not_closed(self, token: Token) -> _RefusedError:
        """Return, not raise, the error for a token where ',' or ')' belongs; its problem is recorded."""
        if token.text in ("..", ";", "+", "-", "*", "/", "**", "|", "&", "?", "^", "\\", "@"):
            return self.refuse(token, f"{token.in_words}: intervals, pools and sums are not facts", "write them out")
        return self.refuse(token, f"',' or ')' was expected, {token.in_words} found")


def _lower_case_name(name: str) -> str:
    """Return the name that a variable suggests, for a hint: X1 becomes x1, _ becomes x."""
    return name.strip("_").lower() or "x"
