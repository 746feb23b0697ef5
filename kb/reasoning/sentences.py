r"""The plain sentences of rules: comments in rule files that say why a rule holds.

    %! because "Region {R} is isolated: floor {F} surrounds it."
    isolated(R) :- region(R, nonzero, _), surrounds(F, R), region(F, zero, _).

    %! says isolated(R) "region {R} stands isolated on the floor" else "no floor seen so far surrounds region {R}"

The first kind stands directly before a rule, a constraint or a weak constraint. Its placeholders are global variables
of that rule; `{N/10}` and `{N/100}` show a number in tenths or hundredths as a decimal number. The second kind puts a
predicate into words, where it holds and where it is not known to hold; it may stand anywhere between statements. A
string may go on in the next line: a line that begins with `%!` and a quote. The escapes are `\"` and `\\`.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from utak.kb.language.diagnostics import MAX_PROBLEMS_PER_FILE, Problem, SourceSpan, did_you_mean
from utak.kb.language.source_text import Source
from utak.kb.language.tokens import Token, tokenize

ANNOTATION_MARK = "%!"  # begins a comment that is an annotation
PLACEHOLDER = re.compile(r"\{(_*[A-Z][A-Za-z0-9_']*)(?:/(100?))?\}")  # a variable, and by what it is divided
STRING = re.compile(r'"(?:[^"\\]|\\.)*("?)')  # with its last quote, or up to the end where none closes it
PREDICATE_FORM = re.compile(r"(_*[a-z][A-Za-z0-9_']*)(?:\(([^()]*)\))?")
ONE_OF_SEVERAL = re.compile(r"(?<![\w.-])1 (square|field|command|impression|parameter|errand)s\b")  # a plural after 1
Place = tuple[int, int]  # line and column, from 1


class PredicateWords(NamedTuple):
    """The words of a predicate."""

    name: str  # its name
    variables: tuple[str, ...]  # the names of its arguments, which are placeholders in the texts
    holds: str  # the text where an atom holds
    absent: str  # the text where none is known to hold; '' when there is none


class RuleWords(NamedTuple):
    """The sentences of a file."""

    # The sentence of each rule that has one, by the line and column at which the rule begins
    sentences: Mapping[Place, str]
    predicates: Mapping[tuple[str, int], PredicateWords]  # how predicates read, by (name, number of arguments)


class _Annotation(NamedTuple):
    """An annotation: its text without the mark, and the place of its first character."""

    text: str
    span: SourceSpan


class _Stretch(NamedTuple):
    """A statement's place in a text, from its first token to its last one, and the annotations directly before it."""

    begin: Place
    end: Place
    before: tuple[_Annotation, ...]


def read_sentences(
    source: Source, statements: Iterable[tuple[Place, Sequence[str]]]
) -> tuple[RuleWords, tuple[Problem, ...]]:
    """Return the sentences of a rule file, and the problems of its annotations."""
    reader = _SentenceReader(source)
    known = dict(statements)
    for stretch in _stretches(source, reader):
        inside = {at: names for at, names in known.items() if stretch.begin <= at <= stretch.end}
        reader.read_before(stretch.before, inside)
    return RuleWords(reader.sentences, reader.predicates), tuple(reader.problems)


def fill(template: str, values: Mapping[str, str]) -> str:
    """Return a text with its placeholders replaced by values; a placeholder without a value reads `some`.

    Examples
    --------
    >>> fill("door {D} is {W/100} squares wide", {"D": "d1", "W": "250"})
    'door d1 is 2.5 squares wide'
    """
    text = PLACEHOLDER.sub(lambda match: _shown(values.get(match[1], "some"), match[2]), template)
    return ONE_OF_SEVERAL.sub(r"1 \1", text)


def placeholders(template: str) -> tuple[str, ...]:
    """Return the variables that the placeholders of a text name, in order."""
    return tuple(match[1] for match in PLACEHOLDER.finditer(template))


def _shown(value: str, divisor: str | None) -> str:
    """Return a value as text, divided by 10 or 100 when it is an integer and there is a divisor."""
    if divisor is None or not re.fullmatch(r"-?\d+", value):
        return value
    number, digits = int(value), len(divisor) - 1
    whole, rest = divmod(abs(number), int(divisor))
    decimals = f"{rest:0{digits}}".rstrip("0")
    return ("-" if number < 0 else "") + str(whole) + (f".{decimals}" if decimals else "")


class _SentenceReader:
    """Reads annotations, and collects sentences, predicates' words and problems."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.sentences: dict[Place, str] = {}
        self.predicates: dict[tuple[str, int], PredicateWords] = {}
        self.problems: list[Problem] = []

    def complain(self, span: SourceSpan, what: str, hint: str = "") -> None:
        """Append a problem at a place of the file."""
        self.problems.append(self.source.problem(span, what, hint))

    def read_before(self, found: Sequence[_Annotation], inside: Mapping[Place, Sequence[str]]) -> None:
        """Read the annotations before a statement."""
        sentence: str | None = None
        for one in found:
            word = one.text.split(maxsplit=1)[0] if one.text.strip() else ""
            if word == "says":
                self._read_predicate(one)
            elif word != "because":
                what = f"this annotation begins with {word or 'nothing'}"
                self.complain(
                    one.span, what, did_you_mean(word, {"because", "says"}) or "it begins with because or says"
                )
            elif not inside:
                self.complain(one.span, "no rule stands behind this sentence", "put it directly before its rule")
            elif sentence is not None:
                self.complain(one.span, "this is the second sentence of one rule", "a rule has one sentence")
            else:
                sentence = self._read_sentence(one, {name for names in inside.values() for name in names})
        if sentence is not None:
            self.sentences |= dict.fromkeys(inside, sentence)

    def _read_sentence(self, one: _Annotation, names: set[str]) -> str:
        """Return the sentence of a rule with some global variables; problems are appended."""
        strings, rest = self._strings(one, one.text.index("because") + len("because"))
        if len(strings) != 1 or rest.strip():
            if not self._unclosed(one):
                self.complain(one.span, 'a sentence is one string: because "..."')
            return ""
        text, at = strings[0]
        self._check_placeholders(one, text, at, names, "the rule has no variable {} outside of its aggregates")
        return text

    def _read_predicate(self, one: _Annotation) -> None:
        """Read how a predicate reads; problems are appended."""
        begin = one.text.index("says") + len("says")
        form = PREDICATE_FORM.match(one.text, begin + len(one.text[begin:]) - len(one.text[begin:].lstrip()))
        strings, rest = self._strings(one, form.end() if form else begin)
        if form is None or len(strings) not in (1, 2) or rest.split() != ["else"] * (len(strings) - 1):
            if not self._unclosed(one):
                self.complain(one.span, 'words of a predicate are: says name(A, B) "..." else "..."')
            return
        variables = tuple(part.strip() for part in form[2].split(",")) if form[2] else ()
        for text, at in strings:
            self._check_placeholders(one, text, at, set(variables), f"{form[0]} has no argument {{}}")
        absent = strings[1][0] if len(strings) == 2 else ""
        self.predicates[form[1], len(variables)] = PredicateWords(form[1], variables, strings[0][0], absent)

    def _strings(self, one: _Annotation, begin: int) -> tuple[list[tuple[str, int]], str]:
        """Return the strings of an annotation from a character on, each with its index; and what stands beside them."""
        found: list[tuple[list[str], int]] = []
        rest, at = "", begin
        for match in STRING.finditer(one.text, begin):
            if not match[1]:
                break
            between = one.text[at : match.start()]
            text = re.sub(r"\\(.)", r"\1", match.group()[1:-1])
            if found and not between.strip():
                found[-1][0].append(text)
            else:
                rest += between
                found.append(([text], match.start()))
            at = match.end()
        return [("".join(texts), start) for texts, start in found], rest + one.text[at:]

    def _unclosed(self, one: _Annotation) -> bool:
        """Return whether an annotation has a quote that is not closed, after appending the problem."""
        quote = next((match.start() for match in STRING.finditer(one.text) if not match[1]), None)
        if quote is None:
            return False
        self.complain(self._place(one, quote, 1), "this quote is not closed", 'close it with "')
        return True

    def _check_placeholders(self, one: _Annotation, text: str, at: int, names: set[str], unknown: str) -> None:
        """Append a problem for each placeholder of a text that is not among `names`, and for each other brace."""
        for match in PLACEHOLDER.finditer(text):
            if len(self.problems) >= MAX_PROBLEMS_PER_FILE:
                return
            if match[1] not in names:
                span = self._place(one, max(0, one.text.find(match.group(), at)), len(match.group()))
                self.complain(span, unknown.format(match[1]), did_you_mean(match[1], names))
        if set(PLACEHOLDER.sub("", text)) & set("{}"):
            left = PLACEHOLDER.sub(lambda match: " " * len(match.group()), one.text)
            brace = next(index for index, char in enumerate(left) if index >= at and char in "{}")
            self.complain(self._place(one, brace, 1), "a brace encloses one variable, such as {X}")

    def _place(self, one: _Annotation, index: int, length: int) -> SourceSpan:
        """Return the place of some characters of an annotation, whose lines are joined by line ends."""
        before = one.text[: max(0, index)]
        breaks = before.count("\n")
        if not breaks:
            start = one.span.start + len(before)
            return SourceSpan(one.span.line, start, start + length - 1)
        line = one.span.line + breaks
        raw = self.source.lines[line - 1]
        start = raw.index(ANNOTATION_MARK) + len(ANNOTATION_MARK) + len(before) - before.rindex("\n")
        return SourceSpan(line, start, start + length - 1)


def _stretches(source: Source, reader: _SentenceReader) -> Iterable[_Stretch]:
    """Return the statements of a text in order, each with the annotations before it; the last one is the file's end."""
    found: list[_Stretch] = []
    waiting: list[_Annotation] = []
    statement: list[Token] = []
    for token in tokenize(source, [], comments=True):
        if token.kind == "comment":
            if token.text.startswith(ANNOTATION_MARK):
                if statement:
                    reader.complain(token.span, "this annotation stands within a rule", "put it before the rule")
                else:
                    _append_annotation(waiting, token)
            continue
        if token.kind == "end" and not statement:
            break
        statement.append(token)
        if token.text == "." or token.kind == "end":
            found.append(_stretch(statement, waiting))
            waiting, statement = [], []
        elif token.text == "]" and len(statement) > 1 and statement[0].text == "[" and found:
            weak = found.pop()  # the price of a weak constraint belongs to it
            found.append(weak._replace(end=(token.span.line, token.span.end)))
            statement = []
    found.append(_Stretch((0, 0), (0, 0), tuple(waiting)))
    return found


def _stretch(statement: Sequence[Token], waiting: Sequence[_Annotation]) -> _Stretch:
    """Return the place of a statement, from its tokens, with the annotations before it."""
    first, last = statement[0].span, statement[-1].span
    return _Stretch((first.line, first.start), (last.line, last.end), tuple(waiting))


def _append_annotation(waiting: list[_Annotation], token: Token) -> None:
    """Append an annotation; one that begins with a quote is joined to the one before it."""
    text = token.text[len(ANNOTATION_MARK) :].rstrip()
    if waiting and text.lstrip().startswith('"') and token.span.line == waiting[-1].span.line + _lines(waiting[-1]):
        waiting[-1] = waiting[-1]._replace(text=f"{waiting[-1].text}\n{text}")
        return
    start = token.span.start + len(ANNOTATION_MARK)
    waiting.append(_Annotation(text, SourceSpan(token.span.line, start, max(start, token.span.end))))


def _lines(one: _Annotation) -> int:
    """Return the number of lines of an annotation."""
    return one.text.count("\n") + 1
