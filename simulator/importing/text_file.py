"""The text of a file of another format, in which an error names line and column."""

from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from pathlib import Path

from kb.language.diagnostics import BadInputError, CannotOpenError
from kb.language.source_text import Source, lies_outside, read_bytes


def read_raw(path: Path | str, max_bytes: int, what: str, untrusted: bool = False) -> bytes:
    """Return the bytes of a file.

    Parameters
    ----------
    path : the file.
    max_bytes : the most bytes that it may have.
    what : what it should be, with its article, for messages.
    untrusted : whether a link that leads out of the file's folder is refused.

    Returns
    -------
    All its bytes.

    Raises
    ------
    CannotOpenError : it cannot be read, or it is a refused link.
    BadInputError : it is larger.
    """
    if untrusted and lies_outside(path):
        raise CannotOpenError(str(path), "it is a link out of its folder, which --untrusted refuses")
    raw = read_bytes(str(path), max_bytes)
    if len(raw) > max_bytes:
        source = Source(str(path), "")
        raise BadInputError([source.problem(source.start(), f"{what} has at most {max_bytes} bytes here")])
    return raw


def text_source(path: Path | str, raw: bytes, folder: Path | None = None) -> Source:
    """Return the text of a file's bytes, one letter a byte, so that columns count bytes.

    Parameters
    ----------
    path : the file.
    raw : its bytes; a byte order mark of UTF-8 before them is left out.
    folder : the folder in which the file should lie; None for the one in which it is named.

    Returns
    -------
    The text, with the file's name; hidden in messages when the file lies outside of the folder, all links followed.

    Raises
    ------
    BadInputError : the text is in UTF-16.
    """
    source = Source(str(path), raw.removeprefix(BOM_UTF8).decode("latin-1"), lies_outside(path, folder))
    if raw.startswith((BOM_UTF16_BE, BOM_UTF16_LE)):
        raise BadInputError([source.problem(source.start(), "the file is a text in UTF-16", "save it as UTF-8")])
    return source
