"""The meanings of the predicates of the encodings, by the comments that declare them (`%*! name(A, B)   text *%`)."""

import re
from functools import cache
from pathlib import Path

from kb.reasoning.solver import ENCODING_FOLDERS

DECLARATION = re.compile(r"%\*!\s*(?P<name>[a-z_]\w*)(?:\((?P<arguments>[^)]*)\))?\s+(?P<text>.*?)\*%", re.DOTALL)

# A name of an argument; an A that begins a sentence is an article.
NAME_IN_TEXT = re.compile(r"(?<!\. )(?<!^)\b[A-Z]\w*\b|^(?!A )[A-Z]\w*\b|(?<=\. )(?!A )[A-Z]\w*\b")


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
    paths = [path for folder in ENCODING_FOLDERS if (path := folder / f"{encoding}.lp").exists()]
    known = _declarations(paths[0]) if paths else {}
    names, text = known.get((name, len(arguments)), ((), ""))
    values = dict(zip(names, arguments, strict=False))
    return NAME_IN_TEXT.sub(lambda match: values.get(match[0], match[0]), text)
