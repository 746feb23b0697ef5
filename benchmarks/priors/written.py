"""The files of priors: ASP facts, a group for each predicate, a row for each bin, with the number of things counted."""

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby

from benchmarks.priors.bins import Bin
from benchmarks.priors.count import Counted

Documented = Mapping[str, tuple[str, str, str]]
# By predicate: its arguments; what it says, as documentation; the same as words of explanations.
WORDS = {
    "counted_solid": (
        "K, L, U, W",
        "Of 1000 regions of case K with a mass of L to U tenths of squares, W were no floor.",
        "of 1000 regions of case {K} with {L/10} to {U/10} squares expected to be occupied, {W} were no floor",
    ),
    "counted_object": (
        "K, L1, L2, M1, M2, W",
        "Of 1000 regions of case K that are no floor, L1 to L2 squares long with a mass of M1 to M2 tenths of squares, "
        "W were objects.",
        "of 1000 regions of case {K} that are no floor, {L1} to {L2} squares long, with {M1/10} to {M2/10} squares "
        "expected to be occupied, {W} were objects",
    ),
    "counted_first": (
        "M1, M2, D1, D2, P1, P2, W",
        "Of 1000 things whose first class leaves M1 to M2 squares wrong and is D1 to D2 squares ahead, with P1 to P2 "
        "open squares for 100 sure ones, W were of that class.",
        "of 1000 things whose first class leaves {M1} to {M2} squares wrong and is {D1} to {D2} squares ahead, with "
        "{P1} to {P2} open squares for 100 sure ones, {W} were of that class",
    ),
    "counted_other": (
        "L, U, W",
        "Of 1000 classes that leave L to U squares more wrong than a first class that is not the true one, W were it.",
        "of 1000 classes that leave {L} to {U} squares more wrong than a first class that is not the true one, {W} "
        "were it",
    ),
    "counted_none": (
        "L, U, W",
        "Of 1000 things whose first class leaves L to U squares wrong and is not the true one, W were of no class.",
        "of 1000 things whose first class leaves {L} to {U} squares wrong and is not the true one, {W} were of none",
    ),
    "counted_movable": (
        "L, U, W",
        "Of 1000 objects that no motion had moved, and that were tried L to U ways, W could be moved.",
        "of 1000 objects that were tried {L} to {U} ways, and that no motion had moved, {W} could be moved",
    ),
    "counted_place": (
        "K, L, U, W",
        "Of 1000 places of case K with a measure of L to U, W were where the thing was that the task names.",
        "of 1000 places of case {K} with a measure of {L} to {U}, {W} were where the thing was",
    ),
    "counted_passage": (
        "K, L, U, W",
        "Of 1000 parts of the floor of case K with a measure of L to U, W were those to which unseen floor led first.",
        "of 1000 parts of the floor of case {K} with a measure of {L} to {U}, {W} were those to which unseen floor led",
    ),
    "counted_plug": (
        "K, L, U, W",
        "Of 1000 stretches of what bounds the floor of case K (slim, broad or wide), L to U squares thick, W were "
        "things.",
        "of 1000 stretches of what bounds the floor of case {K}, {L} to {U} squares thick, {W} were things",
    ),
    "counted_square": (
        "K, L, U, W",
        "Of 1000 likeliest squares of case K with L to U thousandths of the likelihood, W were that of the robot.",
        "of 1000 likeliest squares of case {K} with {L} to {U} thousandths, {W} were that of the robot",
    ),
    "counted_look": (
        "K, L, U, W",
        "Of 1000 looks of kind K (explore, settle or pass) for a thing that nobody saw, with L to U squares never seen "
        "in sight, W would have shown it.",
        "of 1000 looks of kind {K} with {L} to {U} squares never seen in sight, {W} would have shown what was missing",
    ),
    "counted_wall": (
        "K, S, W",
        "In W of 1000 places of walls of kind K that were never felt, a thing began as wide as a doorway, or smaller "
        "(S: doorway or square).",
        "in {W} of 1000 places of walls of kind {K} a thing of the width of a {S} began",
    ),
    "counted_joined": (
        "F, L, U, W",
        "Of 1000 pairs of parts of an outline that touch, with colours F (same or unfelt) and L to U percent for the "
        "class of the outline, W were one thing.",
        "of 1000 pairs of parts that touch, with colours {F} and {L} to {U} percent for the class of their outline, "
        "{W} were one thing",
    ),
}
COUNTED_OF_PLACES = {
    "counted_chance": (
        "K, L, U, W",
        "Of 1000 facts about places of case K (kb/world/chances.py) with a measure of L to U, W were true.",
        "of 1000 facts of case {K} about places with a measure of {L} to {U}, {W} were true",
    ),
}
PRIORS_LINE_WIDTH = 118


def text(counted: Sequence[Counted], told: Iterable[str], whole: str) -> str:
    """Return a file of priors. told : how it was made, a line each. whole : of which encodings it is a part."""
    what = (
        f"How often alternatives were true, counted: what confidences are made of (a part of {whole}). No number here "
        "is chosen: thousandths by Laplace's rule, (true + 1) / (counted + 2). After each row: true / counted."
    )
    lines = [
        *textwrap.wrap(what, PRIORS_LINE_WIDTH - 2, initial_indent="% ", subsequent_indent="% "),
        "",
        "% It was made so, and is made anew by the same command:",
        *(f"%     {line}" for line in told),
        "",
    ]
    lines += _facts(counted, WORDS)
    lines += ["% ---- Words (kb/reasoning/sentences.py): how each predicate reads in explanations ----", ""]
    for predicate in dict.fromkeys(row.predicate for row in counted):
        arguments, _, words = WORDS[predicate]
        lines += _wrapped(f"{predicate}({arguments})", words)
    return "\n".join(lines) + "\n"


def places_text(counted: Sequence[Counted], told: Iterable[str]) -> str:
    """Return the file of what was counted of places. told : how it was made, a line each."""
    lines = [
        "% How often facts about places were true, by what was measured of them: kb/world/chances.py makes confidences",
        "% of it. No number here is chosen: thousandths by Laplace's rule, (true + 1) / (counted + 2). After each row:",
        "% true / counted.",
        "",
        "% It was made so, and is made anew by the same command:",
        *(f"%     {line}" for line in told),
        "",
        *_facts(counted, COUNTED_OF_PLACES),
        "% ---- Words (kb/reasoning/sentences.py): how each predicate reads in explanations ----",
        "",
    ]
    for predicate, (arguments, _, words) in COUNTED_OF_PLACES.items():
        lines += _wrapped(f"{predicate}({arguments})", words)
    return "\n".join(lines) + "\n"


def _facts(counted: Sequence[Counted], words: Documented) -> list[str]:
    """Return the facts of predicates, a row each, with what documents them."""
    lines: list[str] = []
    for predicate, rows in groupby(counted, lambda row: row.predicate):
        facts = [*rows]
        lines += [*_documented(predicate, words), '%! because "It was counted by benchmarks.priors."', f"{predicate}("]
        lines += [
            f"    {_arguments(row)}{';' if row is not facts[-1] else ''}  % {row.true} / {row.of}" for row in facts
        ]
        lines += [").", ""]
    return lines


def _documented(predicate: str, words: Documented) -> list[str]:
    """Return the block that documents a predicate."""
    arguments, what, _ = words[predicate]
    return [
        f"%*! {predicate}({arguments})",
        *textwrap.wrap(f"{what} *%", PRIORS_LINE_WIDTH, initial_indent="    ", subsequent_indent="    "),
    ]


def _arguments(row: Counted) -> str:
    given = [f"{one.least}, {one.most}" if isinstance(one, Bin) else one for one in row.given]
    return ", ".join([*given, str(row.thousandths)])


def _wrapped(head: str, words: str) -> list[str]:
    """Return how a predicate reads as an annotation, in lines with a string each."""
    parts = textwrap.wrap(words, PRIORS_LINE_WIDTH - len(head) - len('%! says  " "'))
    lines = [f'%! says {head} "{parts[0]}', *(f'%!   "{part}' for part in parts[1:])]
    return [*(f'{line} "' for line in lines[:-1]), f'{lines[-1]}" else', '%!   "no such count is known"']
