"""Explanations as text of three depths, and as nested dictionaries of JSON values."""

from collections.abc import Iterator
from typing import Any

from kb.explanation.values import Absence, Proof, ProofNode, RivalChoice

MAX_LEVELS = 200  # levels below the claim that are shown at most; a convention, well below Python's limit of calls
LEVELS_BY_DEPTH = {"short": 0, "mid": 2, "long": MAX_LEVELS}  # levels below the claim that a text shows, by its depth
RIVALS_SHOWN = {"short": 1, "mid": 3, "long": 1_000}  # other ways to choose that a text names, by its depth


def render(found: Proof | Absence, depth: str = "mid") -> str:
    """Return an explanation as text.

    Parameters
    ----------
    found : why an atom holds or does not.
    depth : short (one sentence), mid (two levels of the proof) or long (the whole proof).

    Returns
    -------
    Lines without a line end at the end. A claim is followed by its reason and the place of its rule; what it rests on
    stands below it, indented. A claim that stands above already, with all it rests on, is marked `(see above)`.

    Raises
    ------
    KeyError : there is no such depth.
    """
    if isinstance(found, Absence):
        lines = [found.sentence]
        if depth != "short":
            lines += [f"  {found.rival.sentence}"] if found.rival else []
            if found.proof is not None:
                lines += [
                    "Then it would hold:",
                    *_lines(found.proof.root, LEVELS_BY_DEPTH[depth], RIVALS_SHOWN[depth], 1, set()),
                ]
        return "\n".join(lines)
    if depth == "short":
        return short_sentence(found.root)
    return "\n".join(_lines(found.root, LEVELS_BY_DEPTH[depth], RIVALS_SHOWN[depth], 0, set()))


def short_sentence(node: ProofNode) -> str:
    """Return a proof in one sentence: the claim and its reason, and for a choice the rival that comes nearest."""
    if node.kind == "given":
        text = f"{node.claim}: it is given." if node.words == node.claim else f"{node.claim}: {node.words}, as given."
    else:
        text = f"{node.claim}: {node.sentence}"
    return f"{text} {node.rivals[0].sentence}" if node.rivals else text


def proof_dict(node: ProofNode, levels: int | None = None) -> dict[str, Any]:
    """Return a proof as nested dictionaries of JSON values.

    Parameters
    ----------
    node : the claim.
    levels : how many levels below the claim are included; None for all, up to MAX_LEVELS.

    Returns
    -------
    The keys are "kind", "claim", "words", "sentence", "rule" (file, line, column, rule, values and sentence; None when
    no rule derives the claim), "rivals" and "children". Where a claim stands again whose parts were listed before it,
    "again" is True and "children" is empty; it is False elsewhere.
    """
    return _dict(node, MAX_LEVELS if levels is None else min(levels, MAX_LEVELS), set())


def proof_as_dict(proof: Proof, levels: int | None = None) -> dict[str, Any]:
    """Return a proof with its encoding as JSON values: "encoding" and "proof" (see `proof_dict`)."""
    return {"encoding": proof.encoding, "proof": proof_dict(proof.root, levels)}


def absence_as_dict(found: Absence, levels: int | None = None) -> dict[str, Any]:
    """Return why an atom does not hold as JSON values, under the names of the attributes of `Absence`."""
    return {
        "encoding": found.encoding,
        "atom": found.atom,
        "missing": list(found.missing),
        "in_way": list(found.in_way),
        "partial": found.partial,
        "found": found.found,
        "sentence": found.sentence,
        "rival": found.rival.as_dict() if found.rival else None,
        "proof": proof_dict(found.proof.root, levels) if found.proof else None,
    }


def _dict(node: ProofNode, levels: int, seen: set[int]) -> dict[str, Any]:
    """Return a node as a dictionary; `seen` holds the identities of the nodes whose children were listed."""
    again = id(node) in seen and bool(node.children)
    children: list[dict[str, Any]] = []
    if not again and levels > 0:
        seen.add(id(node))
        children = [_dict(child, levels - 1, seen) for child in node.children]
    return {
        "kind": node.kind,
        "claim": node.claim,
        "words": node.words,
        "sentence": node.sentence,
        "rule": node.instance.as_dict() if node.instance else None,
        "rivals": [rival.as_dict() for rival in node.rivals] if not again else [],
        "children": children,
        "again": again,
    }


def _lines(node: ProofNode, levels: int, rivals: int, indent: int, seen: set[int]) -> Iterator[str]:
    """Yield the lines of a node and of as many levels below it."""
    blank = "  " * indent
    again = id(node) in seen and bool(node.children)
    yield blank + _line(node) + (" (see above)" if again else "")
    if again:
        return
    for rival in node.rivals[:rivals]:
        yield f"{blank}    not {_rival_name(rival)}: {rival.sentence}"
    if len(node.rivals) > rivals:
        yield f"{blank}    and {len(node.rivals) - rivals} other ways to choose"
    if levels > 0:
        seen.add(id(node))
        for child in node.children:
            yield from _lines(child, levels - 1, rivals, indent + 1, seen)


def _line(node: ProofNode) -> str:
    """Return a node in one line: its claim, the reason, and the place of the rule."""
    if node.instance is not None:
        return f"{node.claim}: {node.sentence} [{node.instance.rule.file}:{node.instance.rule.line}]"
    if node.kind in ("given", "assumed"):
        return f"{node.claim}: {node.kind}" if node.words == node.claim else f"{node.claim}: {node.words} ({node.kind})"
    return node.words if node.words == node.claim else f"{node.claim}: {node.words}"


def _rival_name(rival: RivalChoice) -> str:
    """Return what another way to choose would choose."""
    return rival.atom or "none of them"
