"""Certificates in words: a tree of reasons, a sentence for each line, down to impressions, touches and commands."""

import json
from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from typing import Any

from utak.geometry.counts.retina import FIELDS, gray_level
from utak.kb.body import DIRECTIONS
from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.evidence.record import RecordedStep
from utak.kb.evidence.witness import command_reason
from utak.simulator.certificates.checker import verify
from utak.simulator.certificates.courses import RefusedError
from utak.simulator.episode.episode import EpisodeLine, encode

# What certificates take for granted besides claims of the task (docs/certificates.md), in words.
GRANTED = {
    "along(grid)": "the robot's axes lie along the squares",
    "whole(squares)": "where the robot woke one thing, or the verge, covers all of each occupied square",
    "isolated(things)": "no verge lies within a closed ring of squares that are floor or things",
    "verge(walls)": "the verge covers all of the squares beside the door",
    "parted(rooms)": "floors on both sides of a door that are at least twice as wide as it are two rooms",
    "single(colours)": "no two things are of one colour",
    "apart(things)": "where the robot woke, things whose squares share an edge or are the same are one thing",
}
CaseLine = Sequence[Any]  # of the cases of a certificate


def certificate_reason(
    header: EpisodeLine, steps: Sequence[RecordedStep], lines: Sequence[EpisodeLine], text: str
) -> Reason:
    """Return what a certificate shows of a run, or that it is refused; lines : the steps of the run's episode."""
    try:
        shown = verify("".join(map(encode, (header, *lines))), text)
    except (RefusedError, ValueError, RecursionError) as why:
        return Reason("the certificate is refused", str(why), ReasonKind.MEASURED, "certificate")
    stated = json.loads(text)
    below = [*_granted(stated["given"]), *_chanced(stated["risk"]), *_meaning(stated["meaning"], steps)]
    below += _orientations(stated["cases"], steps)
    if stated["cases"]:
        commands = tuple(command_reason(step) for step in steps[1:])
        below.append(
            Reason("the commands lead the robot on", f"there are {len(commands)}", ReasonKind.COMMAND, "", commands)
        )
    because = "it follows from what was seen, felt and commanded alone, as `utak verify` finds"
    return Reason(f"a certificate shows {shown}", because, ReasonKind.MEASURED, "certificate", tuple(below))


def _granted(given: Sequence[str]) -> Iterator[Reason]:
    """Yield what is taken for granted."""
    for claim in given:
        kind = ReasonKind.CONVENTION if claim in GRANTED else ReasonKind.TASK
        yield Reason(claim, f"taken for granted: {GRANTED.get(claim, 'the task says so')}", kind, "certificate")


def _chanced(risk: int) -> Iterator[Reason]:
    """Yield what is left to chance. risk : in millionths."""
    if risk:
        because = f"it does in at most {risk / 10**4:g} of 100 runs, as motions are disturbed (docs/certificates.md)"
        claim = "noise led no command further beside its end than is worked out"
        yield Reason(claim, because, ReasonKind.CONVENTION, "certificate")


def _meaning(meaning: Any, steps: Sequence[RecordedStep]) -> Iterator[Reason]:
    """Yield the touch by which each object of the goals is meant."""
    for name, (step, touch) in meaning.items():
        colour, direction = steps[step].touch[touch], DIRECTIONS[touch]
        data = {"impression": step, "direction": direction, "colour": colour}
        because = f"colour {colour} was felt in the {direction}"
        yield Reason(f"{name} means the thing felt there", because, ReasonKind.TOUCH, f"impression {step}", (), data)


def _orientations(cases: Sequence[CaseLine], steps: Sequence[RecordedStep]) -> Iterator[Reason]:
    """Yield what becomes of each orientation of the squares; several in a row that are shut are told together."""
    starts = [number for number, line in enumerate(cases) if line[0] == "angle"]
    parts = [cases[start:end] for start, end in pairwise([*starts, len(cases)])]
    for shows, run in groupby(parts, key=lambda part: any(line[0] == "holds" for line in part)):
        reasons = [_orientation(part, shows, steps) for part in run]
        if shows or len(reasons) == 1:
            yield from reasons
        else:
            between = f"{reasons[0].data['degrees']} to {reasons[-1].data['degrees']}"
            yield Reason(
                f"the robot's axes are not turned by {between} degrees against the squares",
                "no case agrees with what was seen, felt and commanded",
                ReasonKind.NEGATION,
                "certificate",
                tuple(reasons),
            )


def _orientation(part: Sequence[CaseLine], shows: bool, steps: Sequence[RecordedStep]) -> Reason:
    """Return what becomes of one orientation: the cases, each with what was counted in it."""
    (_, degrees), *lines = part
    cases: list[list[CaseLine]] = [[["woke"]]]
    for line in lines:
        if line[0] == "end":
            cases.append([])
        cases[-1].append(line)
    below = tuple(_case(case, steps) for case in cases)
    found = "cases that agree with the run show the goals, all others are shut" if shows else "every case is shut"
    kind = ReasonKind.MEASURED if shows else ReasonKind.NEGATION
    turned = f"turned by {degrees} degree{'s' * (degrees != 1)} against the squares"
    claim = f"the robot's axes {'may be' if shows else 'are not'} {turned}"
    return Reason(claim, found, kind, "certificate", below, {"degrees": degrees})


def _case(case: Sequence[CaseLine], steps: Sequence[RecordedStep]) -> Reason:
    """Return a case: where the robot is, and what else is said of it."""
    first, *others = case
    below = tuple(_line(line, steps) for line in others)
    if first[0] == "woke":
        return Reason(
            "the robot woke in square (0, 0)", "squares are counted from there", ReasonKind.CONVENTION, "step 0", below
        )
    claim = f"a command may have ended in square ({first[1]}, {first[2]})"
    return Reason(claim, "the case is looked into" if below else "", ReasonKind.MEASURED, "certificate", below)


def _line(line: CaseLine, steps: Sequence[RecordedStep]) -> Reason:
    """Return a line that says something of a case."""
    if line[0] == "count":
        return _count(line[1:], steps)
    rooms = [f"({w}, {s}) to ({e}, {n})" for w, s, e, n in (part for part in line if isinstance(part, list))]
    if rooms:
        because = f"between the rooms of squares {rooms[1]} and {rooms[2]} the door has the squares {rooms[0]}"
        return Reason("every goal holds here", because, ReasonKind.MEASURED, "certificate")
    told = {
        "replay": ("the ways of the commands are worked out again", "by what is settled now"),
        "holds": ("it is as claimed here", "the commands up to the step of the claim are taken"),
    }
    claim, because = told.get(line[0], (json.dumps(line), ""))
    return Reason(claim, because, ReasonKind.MEASURED, "certificate")


def _count(terms: Sequence[Sequence[int]], steps: Sequence[RecordedStep]) -> Reason:
    """Return a sum of counts: the cells, and between what their counts lie."""
    told, cells, least, most = "", [], 0, 0
    for step, field, times in terms:
        level, side = steps[step].retina[field], FIELDS[field].side
        counts = [times * n for n in range(side * side + 1) if gray_level(n, side) == level]
        least, most = least + min(counts), most + max(counts)
        sign = " less " if told and times < 0 else " and " if told else "less " if times < 0 else ""
        told += f"{sign}{f'{abs(times)} times ' * (abs(times) != 1)}cell {field} of impression {step}"
        cells.append([step, field, level])
    numbers = sorted({step for step, _, _ in cells})
    counted = str(least) if least == most else f"{least} to {most}"
    source = f"impression{'s' * (len(numbers) > 1)} {', '.join(map(str, numbers))}"
    because = f"level{'s' * (len(cells) > 1)} {', '.join(str(level) for _, _, level in cells)} of 7"
    of = f"of its {FIELDS[terms[0][1]].side ** 2} squares" if len(terms) == 1 else "squares in sum"
    return Reason(f"{told}: {counted} {of} are occupied", because, ReasonKind.CELLS, source, (), {"cells": cells})
