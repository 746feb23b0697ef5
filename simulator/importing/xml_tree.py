"""XML as a tree whose elements know their places in the file.

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
    parser = expat.ParserCreate()
    top = XmlElement("", {}, 0)
    opened, count = [top], 0

    def refuse(what: str, hint: str = "") -> None:
        raise BadInputError([source.problem(_place(source, parser.CurrentByteIndex), what, hint)])

    def declaration(version: str, encoding: str | None, standalone: int) -> None:
        if encoding is not None and encoding.lower() not in ALLOWED_ENCODINGS:
            refuse(f"the encoding {encoding[:20]} is not read", "save the file as UTF-8")

    def doctype(name: str, system: str | None, public: str | None, has_subset: int) -> None:
        if has_subset:
            refuse("declarations in a DOCTYPE are not read: they may define entities", "remove them")

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MAX_XML_ELEMENTS or len(opened) > MAX_XML_DEPTH:
            within = "" if count > MAX_XML_ELEMENTS else " within each other"
            refuse(f"more than {MAX_XML_DEPTH if within else MAX_XML_ELEMENTS} elements{within}")
        element = XmlElement(name.rpartition(":")[2], attributes, parser.CurrentByteIndex)
        opened[-1].children.append(element)
        opened.append(element)

    parser.XmlDeclHandler, parser.StartDoctypeDeclHandler = declaration, doctype
    parser.StartElementHandler, parser.EndElementHandler = start, lambda name: opened.pop()
    try:
        parser.Parse(source.text.encode("latin-1"), True)
    except expat.ExpatError as error:
        line, column = error.lineno, error.offset + 1
        what = f"this is no XML: {expat.ErrorString(error.code)}"
        raise BadInputError([source.problem(SourceSpan(line, column, column), what)]) from None
    return top.children[0]


def xml_error(source: Source, element: XmlElement, name: str, what: str) -> BadInputError:
    """Return the error `what` at the value of an attribute of an element, or at the element when it has none so."""
    tag = re.compile(r"(?:[^>\"']|\"[^\"]*\"|'[^']*')*").match(source.text, element.at)
    found = re.search(rf"\s{re.escape(name)}\s*=\s*[\"']", tag[0]) if tag and name in element.attributes else None
    place = _place(source, element.at + (found.end() if found else 0))
    return BadInputError([source.problem(place, what)])


def _place(source: Source, at: int) -> SourceSpan:
    """Return the place of a character of a text."""
    column = at - source.text.rfind("\n", 0, at)
    return SourceSpan(source.text.count("\n", 0, at) + 1, column, column)
