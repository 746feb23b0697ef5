"""XML as a tree whose elements and attributes know their places in the file.

Documents that declare entities are refused, and none is ever fetched: a document is no larger than it looks.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from utak.kb.language.diagnostics import BadInputError, SourceSpan
from utak.kb.language.source_text import Source

MAX_XML_DEPTH = 64  # elements within each other; a convention
MAX_XML_ELEMENTS = 100_000  # elements of a document; a convention
ATTRIBUTE = re.compile(r"([^\s=\"'<>/]+)\s*=\s*(\"[^\"]*\"|'[^']*')")
ALLOWED_ENCODINGS = (None, "utf-8", "us-ascii", "ascii")


@dataclass
class XmlElement:
    """An element of a document, under construction until the document was read whole."""

    tag: str  # its name without a prefix, such as `path` for `svg:path`
    attributes: dict[str, str]  # its attributes, by their names as they stand (`inkscape:label`)
    at: int  # the index in the text of the `<` that begins it
    children: list["XmlElement"] = field(default_factory=list)  # its elements in order

    def descendants(self) -> Iterator["XmlElement"]:
        """Yield this element and all in it, in the order of the document."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting += reversed(element.children)


def parse_xml(source: Source) -> XmlElement:
    """Return the root of a document."""
    builder = _Builder(source)
    try:
        builder.parser.Parse(source.text.encode("latin-1"), True)
    except expat.ExpatError as error:
        line, column = error.lineno, error.offset + 1
        what = f"this is no XML: {expat.ErrorString(error.code)}"
        raise BadInputError([source.problem(SourceSpan(line, column, column), what)]) from None
    assert builder.root is not None
    return builder.root


class _Builder:
    """Builds the tree of one document as expat reads it."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.root: XmlElement | None = None
        self._open: list[XmlElement] = []
        self._count = 0
        self.parser = expat.ParserCreate()
        self.parser.XmlDeclHandler = self._declaration
        self.parser.StartDoctypeDeclHandler = self._doctype
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end

    def _refuse(self, what: str, hint: str = "") -> BadInputError:
        """Return the error `what` at the place that is being read."""
        place = span_of(self.source, self.parser.CurrentByteIndex)
        return BadInputError([self.source.problem(place, what, hint)])

    def _declaration(self, version: str, encoding: str | None, standalone: int) -> None:
        """Refuse encodings other than UTF-8."""
        if encoding is not None and encoding.lower() not in ALLOWED_ENCODINGS:
            raise self._refuse(f"the encoding {encoding[:20]} is not read", "save the file as UTF-8")

    def _doctype(self, name: str, system: str | None, public: str | None, has_subset: int) -> None:
        """Refuse a document type with declarations of its own."""
        if has_subset:
            raise self._refuse("declarations in a DOCTYPE are not read: they may define entities", "remove them")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        """Append an element to the open one."""
        self._count += 1
        if self._count > MAX_XML_ELEMENTS:
            raise self._refuse(f"more than {MAX_XML_ELEMENTS} elements")
        if len(self._open) >= MAX_XML_DEPTH:
            raise self._refuse(f"more than {MAX_XML_DEPTH} elements within each other")
        element = XmlElement(name.rpartition(":")[2], attributes, self.parser.CurrentByteIndex)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, name: str) -> None:
        """Close the open element."""
        self._open.pop()


def span_of(source: Source, start: int, end: int | None = None) -> SourceSpan:
    """Return the place of the characters of a text from `start` up to `end`; of one without `end`."""
    start = min(max(start, 0), len(source.text))
    line = source.text.count("\n", 0, start) + 1
    begin = source.text.rfind("\n", 0, start) + 1
    stop = source.text.find("\n", start)
    last = min(
        start + 1 if end is None else max(end, start + 1), len(source.text) if stop < 0 else max(stop, start + 1)
    )
    return SourceSpan(line, start - begin + 1, max(start - begin + 1, last - begin))


def attribute_span(
    source: Source, element: XmlElement, name: str, start: int = 0, end: int | None = None
) -> SourceSpan:
    """Return the place of characters of an attribute's value."""
    at = element.at + 1 + len(element.tag)
    while element.at >= 0 and name in element.attributes:
        found = ATTRIBUTE.search(source.text, at)
        if found is None:
            break
        if found[1] == name:
            first = found.start(2) + 1
            return span_of(source, first + start, found.end(2) - 1 if end is None else first + end)
        at = found.end()
    return span_of(source, element.at)
