"""The text of a file of another format, in which an error names line and column."""

from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from pathlib import Path

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.kb.language.source_text import Source, lies_outside, read_bytes


def read_raw(path: Path | str, max_bytes: int, what: str, untrusted: bool = False) -> bytes:
    """Return the bytes of a file."""
    if untrusted and lies_outside(path):
        raise CannotOpenError(str(path), "it is a link out of its folder, which --untrusted refuses")
    raw = read_bytes(str(path), max_bytes)
    if len(raw) > max_bytes:
        source = Source(str(path), "")
        raise BadInputError([source.problem(source.start(), f"{what} has at most {max_bytes} bytes here")])
    return raw


def text_source(path: Path | str, raw: bytes) -> Source:
    """Return the text of a file's bytes, one letter a byte, so that columns count bytes."""
    source = Source(str(path), raw.removeprefix(BOM_UTF8).decode("latin-1"), lies_outside(path))
    if raw.startswith((BOM_UTF16_BE, BOM_UTF16_LE)):
        raise BadInputError([source.problem(source.start(), "the file is a text in UTF-16", "save it as UTF-8")])
    return source
