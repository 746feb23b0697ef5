"""What the predicates of the encodings mean, by the comments that declare them (`%*! name(A, B)   text *%`)."""

import re
from functools import cache
from pathlib import Path

from kb.reasoning.solver import ENCODING_FOLDERS

DECLARATION = re.compile(r"%\*!\s*(?P<name>[a-z_]\w*)(?:\((?P<arguments>[^)]*)\))?\s+(?P<text>.*?)\*%", re.DOTALL)


@cache
def _declarations(path: Path) -> dict[tuple[str, int], tuple[tuple[str, ...], str]]:
    """Return for each declared predicate of an encoding the names of its arguments, and the first sentence on it."""
    found = {}
    for match in DECLARATION.finditer(path.read_text(encoding="utf-8")):
        names = tuple(part.strip() for part in (match["arguments"] or "").split(",") if part.strip())
        text = " ".join(match["text"].split("Args:")[0].split())
        found[match["name"], len(names)] = names, text
    return found


def meaning(encoding: str, name: str, arguments: tuple[str, ...]) -> str:
    """Return what an input of an encoding says, with its arguments in the place of their names; '' when undeclared.

    Parameters
    ----------
    encoding : the name of the encoding, without `.lp`.
    name, arguments : the predicate and the arguments of the atom.
    """
    for folder in ENCODING_FOLDERS:
        path = folder / f"{encoding}.lp"
        if path.exists() and (name, len(arguments)) in _declarations(path):
            names, text = _declarations(path)[name, len(arguments)]
            values = dict(zip(names, arguments, strict=True))
            return re.sub(r"\b[A-Z]\w*\b", lambda match: values.get(match[0], match[0]), text)
    return ""
