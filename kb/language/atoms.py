"""Atoms as text, taken apart: their name and their arguments."""

from collections.abc import Iterator


def atom_parts(atom: str) -> tuple[str, tuple[str, ...]]:
    """Return the name and the arguments of an atom, each as text.

    >>> atom_parts("shape(o1,square,95)")
    ('shape', ('o1', 'square', '95'))
    >>> atom_parts("at(utak,corner(northeast))")
    ('at', ('utak', 'corner(northeast)'))
    >>> atom_parts("stands")
    ('stands', ())
    """
    name, bracket, rest = atom.strip().removesuffix(".").partition("(")
    return name.strip(), tuple(_arguments(rest[: rest.rfind(")")])) if bracket else ()


def _arguments(text: str) -> Iterator[str]:
    """Yield the parts of a text between commas outside of brackets and quotes."""
    depth, start, quoted = 0, 0, False
    for at, char in enumerate(text):
        if char == '"' and text[at - 1 : at] != "\\":
            quoted = not quoted
        elif not quoted:
            depth += (char == "(") - (char == ")")
            if char == "," and depth == 0:
                yield text[start:at].strip()
                start = at + 1
    yield text[start:].strip()
