"""Atoms as text, taken apart: their name and their arguments."""

from collections.abc import Iterator

from utak.kb.language.vocabulary import BELIEF_PREDICATES


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


def signature_of(atom: str) -> tuple[str, int]:
    """Return the name and the number of arguments of an atom.

    >>> signature_of("at(utak,corner(northeast))")
    ('at', 2)
    """
    name, arguments = atom_parts(atom)
    return name, len(arguments)


def short_form(fact: str) -> str:
    """Return the short form of a fact that is known, such as kind(o1,object) for kind(o1,object,100); "" for none.

    Examples
    --------
    >>> short_form("in(o1,r2,100)"), short_form("in(o1,r2,99)"), short_form("rect(o1,0,0,100,100)")
    ('in(o1,r2)', '', '')
    """
    name, _, arguments = fact.partition("(")
    declared = BELIEF_PREDICATES.get((name, arguments.count(",") + 1))
    if declared is None or not declared.short or not arguments.endswith(",100)"):
        return ""
    return f"{fact[: -len(',100)')]})"


def long_form(fact: str, confidence: str = "100") -> str:
    """Return the fact with a confidence of which a fact is the short form; "" for one that is no short form.

    >>> long_form("in(o1,r2)"), long_form("in(o1,r2)", "C"), long_form("in(o1,r2,99)")
    ('in(o1,r2,100)', 'in(o1,r2,C)', '')
    """
    name, arguments = atom_parts(fact)
    declared = BELIEF_PREDICATES.get((name, len(arguments)))
    is_short = declared is not None and declared.long is not None
    return f"{name}({','.join([*arguments, confidence])})" if is_short else ""
