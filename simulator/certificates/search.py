"""The certificate of a verdict, found by trying all that may have happened.

It is found from the impressions and commands of the episode alone, as the checker reads them. The search follows one
orientation of the grid after the other, and one end of each command after the other, until an impression contradicts it
or the goals hold.
"""

import itertools
import json
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from contextlib import nullcontext, suppress
from functools import cache
from typing import Any, NamedTuple

from utak.simulator.certificates.checker import (
    ALONG_GRID,
    GOAL_KINDS,
    OF_COLOURS,
    OF_DOORS,
    OF_THINGS,
    OF_WALLS,
    OWN_NAME,
    RIGHT_ANGLE,
    CertificateCheck,
    Shown,
    claims_taken,
    goal_of,
)
from utak.simulator.certificates.courses import (
    MILLION,
    SAMPLED_FIELDS,
    TOUCH_NAMES,
    VERGE_LETTER,
    Course,
    Evidence,
    Key,
    RefusedError,
    Spot,
    sampled,
    waking_case,
)
from utak.simulator.certificates.doors import door_shown
from utak.simulator.scenario.settings import MAX_RISK, MIN_RISK, USUAL_RISK

MAX_CASES = 20000  # that are tried; a bound on time
StatedLine = list[Any]


class NoCertificateError(Exception):
    """There is no certificate; the message tells why."""


class TreatedBranch(NamedTuple):
    """A case that was shut or in which the goals hold."""

    lines: list[StatedLine]
    needed: set[Key]  # what was settled before it on which it rests


class UsefulCount(NamedTuple):
    """A sum of counts that settled something."""

    line: StatedLine
    sampled: frozenset[Key]
    settled: frozenset[Key]


class ReadFacts(dict[Key, bool]):
    """Settled facts, which remember what was asked for."""

    def __init__(self, facts: dict[Key, bool]) -> None:
        super().__init__(facts)
        self.read: set[Key] = set()

    def get(self, key: Key, default: Any = None) -> Any:
        """Return whether a square is occupied, and remember that it was asked."""
        if key in self:
            self.read.add(key)
        return super().get(key, default)

    def items(self) -> Any:
        """Return all facts; who asks for all at once asks what is free."""
        self.read |= {key for key, is_occupied in super().items() if not is_occupied}
        return super().items()


def is_certificate(head: bytes) -> bool:
    """Return whether a file with these first bytes is a certificate."""
    return re.match(rb'\s*\{\s*"utak"\s*:\s*"certificate"', head) is not None


def certificate_of(lines: Iterable[str], verdict: str | None, risk: float = USUAL_RISK) -> str:
    """Return the certificate of the verdict of a run, as the text of its file, from the lines of its episode.

    risk : percent, taken where there is noise. Raises NoCertificateError where none is found.
    """
    if not MIN_RISK <= risk <= MAX_RISK:
        raise ValueError(f"a risk is {MIN_RISK:g} to {MAX_RISK:g} percent, not {risk:g}")
    if verdict not in GOAL_KINDS:
        raise NoCertificateError(
            f"certificates show {' and '.join(GOAL_KINDS)}, and the verdict is {verdict or 'open'}"
        )
    episode = Evidence("".join(lines))
    episode.allow(int(risk * MILLION / 100) if episode.noise else 0)
    try:
        return json.dumps(_certificate(episode, verdict), separators=(",", ":")) + "\n"
    except RefusedError as why:
        raise NoCertificateError(str(why)) from None


def _certificate(episode: Evidence, claim: str) -> dict[str, Any]:
    """Return the certificate of a claim; raises RefusedError or NoCertificateError where none is found."""
    refusal = RefusedError("the goals name nothing that was felt, or certificates show nothing of them")
    likely = _likely_course(episode, halts=True) if claim == "impossible" else None
    candidates = list(_candidates(episode, claim, likely.step if likely else episode.last))
    tried = set[tuple[Any, ...]]()  # goals that may be impossible, and the squares of the things that they name
    for certificate in candidates:
        checker = CertificateCheck(episode, certificate)
        if not checker.has_cases:
            return certificate
        try:
            if claim == "impossible" or len(candidates) > 1 or any(goal[3] for goal in checker.goals):
                likely = likely or _likely_course(episode)
                things = [likely.outline(episode, felt) for felt in checker.meaning.values()]
                if claim == "impossible" and (*checker.texts, *things) in tried:
                    continue
                tried.add((*checker.texts, *things))
                certificate["steps"] = _likely_steps(checker, likely, certificate["steps"])
            certificate["cases"] = _Search(episode, CertificateCheck(episode, certificate)).all_lines(certificate)
            certificate = _with_less_given(episode, certificate)
        except RefusedError as why:
            refusal = why
        else:
            return certificate
    raise refusal


def _with_less_given(episode: Evidence, certificate: dict[str, Any]) -> dict[str, Any]:
    """Return a certificate, without what is given of colours where it shows the same."""
    less = certificate | {"given": [claim for claim in certificate["given"] if claim not in OF_COLOURS]}
    with suppress(RefusedError):
        CertificateCheck(episode, less).check()
        return less
    return certificate


def _likely_course(episode: Evidence, halts: bool = False) -> Course:
    """Return a course that agrees with all impressions, or `halts` before a refused command; raises RefusedError."""
    for angle in range(RIGHT_ANGLE):
        left = [waking_case(angle, episode)]
        for _ in range(MAX_CASES):
            if not left:
                break
            case = left.pop()
            case = case._replace(occupied=dict(case.occupied))
            if settle_all(case, episode)[1] is not None:
                continue
            if case.step == episode.last:
                return case
            try:
                ends = case.ends(episode)
            except RefusedError:
                if halts:
                    return case
                raise
            whole = max(ends, key=lambda end: sum(abs(a - b) for a, b in zip(end, case.squares[-1], strict=True)))
            left += [ends[end] for end in sorted(ends, key=lambda end: end == whole)]
    raise RefusedError("no course of events was found that agrees with the impressions")


def _likely_steps(checker: CertificateCheck, case: Course, stated: list[int]) -> list[int]:
    """Return the steps at which the goals hold in a case, or cannot hold at once; raises RefusedError for none."""
    if checker.claim == "impossible":
        with suppress(RefusedError):  # the floor goes on where no verge was felt
            if checker.is_barred(case):
                return stated
        raise RefusedError(f"nothing shows that {' and '.join(checker.texts)} is impossible")
    steps: list[int] = []
    last, earliest = checker.episode.last, 0
    ordered = [number for number, goal in enumerate(checker.goals) if goal[3]]
    for number, goal in enumerate(checker.goals):
        tried = range(earliest, last) if number in ordered[:-1] else range(0)
        for found in (*tried, last):
            if door_shown(checker, case, step=found) if goal[0] == "room" else checker.holds(goal, case, found, []):
                break
        else:
            raise RefusedError(f"nothing shows {checker.texts[number]}")
        earliest = found if number in ordered else earliest
        steps.append(found)
    return steps


def _candidates(episode: Evidence, claim: str, last: int) -> Iterator[dict[str, Any]]:
    """Yield certificates without cases, for each thing that each parameter may mean; last : the step at which."""
    texts = [goal for goal in episode.goals if not goal.startswith("prefer(")]
    goals: dict[int, Shown] = {}
    for number, text in enumerate(texts):
        with suppress(RefusedError) if claim == "impossible" else nullcontext():
            goals[number] = goal_of(text, claim)
    choices = [len(goals)] if claim == "done" else [2, 1]
    for chosen in itertools.chain.from_iterable(itertools.combinations(goals, count) for count in choices):
        steps = [last if number in chosen else None for number in range(len(texts))]
        yield from _meanings(episode, claim, steps, [goals[number] for number in chosen])


def _meanings(episode: Evidence, claim: str, steps: list[int | None], goals: list[Shown]) -> Iterator[dict[str, Any]]:
    """Yield certificates of some goals, without cases, for each thing that each parameter may mean."""
    felt: dict[str, list[StatedLine]] = {}
    for kind, what, name, _ in goals:
        if what != OWN_NAME:
            touches = _touches(episode, what, "grasp" if claim == "done" else "any")
            is_led = claim == "done" and kind in ("corner", "room")
            felt.setdefault(what, touches[::-1] if is_led else touches)  # of what was led: from where it began
        if kind in ("near", "circled"):
            is_near = kind == "near" and what == OWN_NAME
            if is_near or name not in felt:
                felt[name] = _touches(episode, name, "last" if is_near else "any")
    for meaning in itertools.product(*felt.values()):
        means = dict(zip(felt, meaning, strict=True))
        letters = {name: episode.touches[step][touch] for name, (step, touch) in means.items()}
        if len(set(letters.values())) < len(letters):
            continue
        named = letters | {door: "" for kind, _, door, _ in goals if kind == "room" and door}
        taken = [fact for name, letter in named.items() for fact in claims_taken(episode, name, letter)]
        given = list(dict.fromkeys(taken))
        if claim == "done" and any(goal[0] == "room" for goal in goals):
            given += OF_DOORS
        if claim == "done" and any(goal[1] != OWN_NAME for goal in goals):
            given += OF_COLOURS
        if claim == "impossible" and len(goals) == 1:
            given += OF_WALLS + (OF_THINGS if means else [])
        risk = episode.risk if any(goal[:2] != ("near", OWN_NAME) for goal in goals) else 0
        head = {"utak": "certificate", "version": 1, "claim": claim, "goals": episode.goals}
        yield head | {"steps": steps, "meaning": means, "given": given, "risk": risk, "cases": []}


def _touches(episode: Evidence, name: str, which: str) -> list[StatedLine]:
    """Return touches [step, touch], newest first, that may be of a thing: at the `last` step, before a `grasp`."""
    colours = [fact[-2] for fact in episode.claims if fact.startswith(f"colour({name},")]
    found: list[StatedLine] = []
    for step in range(episode.last, -1 if which != "last" else episode.last - 1, -1):
        for touch, letter in enumerate(episode.touches[step]):
            grasp = {"do": "grasp", "direction": TOUCH_NAMES[touch]}
            is_grasped = step < episode.last and episode.actions[step + 1] == grasp
            if (
                letter not in (None, VERGE_LETTER)
                and letter in (colours or letter)
                and (which != "grasp" or is_grasped)
            ):
                found.append([step, touch])
    if which == "last" and len({episode.touches[step][touch] for step, touch in found}) > 1:
        raise NoCertificateError(f"several things are felt, and nothing tells which is {name}")
    return found[:1] if which == "last" else found


class _Search:
    """Goes through all cases of an episode."""

    def __init__(self, episode: Evidence, checker: CertificateCheck) -> None:
        self.episode, self.checker = episode, checker
        self.door: list[Any] = []  # that was shown last, with its rooms
        self.cases = 0

    def all_lines(self, certificate: dict[str, Any]) -> list[StatedLine]:
        """Return the lines of a certificate, which is given that the grid lies along the axes where that is needed."""
        found = self.lines(0)
        try:
            found += [line for angle in range(1, RIGHT_ANGLE) for line in self.lines(angle)]
        except (RefusedError, NoCertificateError) as why:
            if not any(line[0] == "holds" for line in found):
                raise NoCertificateError(str(why)) from None
            certificate["given"].append(ALONG_GRID)
        return found

    def lines(self, angle: int) -> list[StatedLine]:
        """Return the lines that treat all cases of one orientation of the grid."""
        return [["angle", angle], *self.branch(waking_case(angle, self.episode)).lines]

    def branch(self, case: Course) -> TreatedBranch:
        """Return the lines that treat a case; raises NoCertificateError where it may be and the goals may not hold."""
        self.cases += 1
        if self.cases > MAX_CASES:
            raise NoCertificateError("too much may have happened for the search of a certificate")
        case = case._replace(occupied=dict(case.occupied))
        counts, shut = settle_all(case, self.episode)
        lines: list[StatedLine] = []
        needed: set[Key] = set()
        if shut is not None:
            lines, needed = [shut.line], set(shut.sampled)
        else:
            facts = ReadFacts(case.occupied)
            again = case._replace(occupied=facts).replayed(self.episode)
            if again is None or (again.places, again.swept) != (case.places, case.swept):
                lines, needed = [["replay"]], facts.read
            if again is not None:
                again = again._replace(occupied=case.occupied)
                treated = self.shown(again) if again.step == self.checker.last else self.branches(again)
                lines, needed = lines + treated.lines, needed | treated.needed
        kept: list[StatedLine] = []
        for count in reversed(counts):
            if count.settled & needed:
                kept.append(count.line)
                needed = (needed - count.settled) | (count.sampled - count.settled)
        return TreatedBranch([*reversed(kept), *lines], needed)

    def branches(self, case: Course) -> TreatedBranch:
        """Return the lines that treat each end of the next command."""
        lines: list[StatedLine] = []
        facts = ReadFacts(case.occupied)
        needed = facts.read
        for square, one in case._replace(occupied=facts).ends(self.episode).items():
            treated = self.branch(one)
            lines += [["end", *square], *treated.lines]
            needed = needed | treated.needed
        return TreatedBranch(lines, needed)

    def shown(self, case: Course) -> TreatedBranch:
        """Return the line that shows the goals; raises RefusedError where they may not hold."""
        if self.checker.has_door:
            self.door = door_shown(self.checker, case, self.door) or []
        facts = ReadFacts(case.occupied)
        case = case._replace(occupied=facts)
        if not self.checker.is_shown(case, self.door):
            raise RefusedError(
                f"nothing shows the claim of {' and '.join(self.checker.texts)} in all that may have happened"
            )
        return TreatedBranch([["holds", *self.door]], facts.read)


def settle_all(case: Course, episode: Evidence) -> tuple[list[UsefulCount], UsefulCount | None]:
    """Settle all squares that single fields settle; return how, and the count that contradicts the case."""
    carried = sorted({step for steps in case.changes.values() for step in steps})
    since = [max((k for k in carried if k <= step), default=0) for step in range(case.step + 1)]
    places = {place: step for step, place in reversed([*enumerate(zip(case.squares, since, strict=True))])}
    before = places[case.squares[-1], since[-1]]  # the first visit while all lay as it lies now
    fields = [(case.step, field) for field in sorted(SAMPLED_FIELDS)]
    if before < case.step:  # the robot saw the same squares before, and is told nothing new of them
        fields = [(k, field) for k, field in fields if episode.ranges[before, field] != episode.ranges[k, field]]
    for step, field in fields if before < case.step else ():
        terms = [(step, field, 1), (before, field, -1)]
        if case.settle(episode, terms):
            return [], UsefulCount(["count", *map(list, terms)], frozenset(), frozenset())
    counts: list[UsefulCount] = []
    while fields:
        fresh: set[Key] = set()
        for step, field in fields:
            keys = _keys(case, step, field)
            if not _tells(case, episode, keys, step, field):
                continue
            unknown = keys.keys() - case.occupied.keys()
            contradicts = case.settle(episode, [(step, field, 1)])
            settled = frozenset(unknown & case.occupied.keys())
            count = UsefulCount(["count", [step, field, 1]], frozenset(keys), settled)
            if contradicts:
                return counts, count
            if settled:
                counts.append(count)
                fresh |= settled
        holding, holders = _holders(case.angle), set[tuple[int, int]]()
        for ((column, row), _), step in places.items():
            for i, j, k in fresh:
                found = holding.get((i - column, j - row))
                if found and (not carried or case.key((i, j), step)[2] == k):
                    for field in found:
                        holders.add((step, field))
        fields = sorted(holders)
    return counts, None


@cache
def _holders(angle: int) -> dict[Spot, list[int]]:
    """Return the fields that sample each square, which is an offset from that of the robot."""
    found: dict[Spot, list[int]] = defaultdict(list)
    for field in sorted(SAMPLED_FIELDS):
        for square in sampled(angle)[field][0]:
            found[square].append(field)
    return found


def _keys(case: Course, step: int, field: int) -> dict[Key, int]:
    """Return what a field samples at a step, and how often."""
    (column, row), squares = case.squares[step], sampled(case.angle)[field][0]
    if not case.changes:
        return {(column + i, row + j, 0): weight for (i, j), weight in squares.items()}
    return {case.key((column + i, row + j), step): weight for (i, j), weight in squares.items()}


def _tells(case: Course, episode: Evidence, keys: dict[Key, int], step: int, field: int) -> bool:
    """Return whether a single field may settle a square or contradict the case."""
    least, most = episode.ranges[step, field]
    low = high = heaviest = 0
    for key, weight in keys.items():
        state = case.occupied.get(key)
        if state is not False:
            high += weight
            if state:
                low += weight
            else:
                heaviest = max(heaviest, weight)
    least -= sampled(case.angle)[field][1]
    return low + heaviest > most or high - heaviest < least
