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
from functools import cache
from typing import Any, NamedTuple

from utak.simulator.certificates.checker import (
    ALONG_GRID,
    BARRED_GOAL,
    OF_WALLS,
    RIGHT_ANGLE,
    SAMPLED_FIELDS,
    VERDICTS_SHOWN,
    VERGE_LETTER,
    CertificateCheck,
    Course,
    Evidence,
    RefusedError,
    Sampling,
    Spot,
    claims_taken,
    goal_of,
    waking_case,
)

MAX_CASES = 20000  # that are tried; a bound on time
GOAL_REACH = 2  # squares about a place: on what lies within it goals at that place rest; derived from the checker
StatedLine = list[Any]


class NoCertificateError(Exception):
    """There is no certificate; the message tells why."""


class TreatedBranch(NamedTuple):
    """A case that was shut or in which the goals hold."""

    lines: list[StatedLine]
    needed: set[Spot]  # the squares settled before it on which it rests


class UsefulCount(NamedTuple):
    """A sum of counts that settled something."""

    line: StatedLine
    sampled: frozenset[Spot]
    settled: frozenset[Spot]


def is_certificate(head: bytes) -> bool:
    """Return whether a file with these first bytes is a certificate."""
    return re.match(rb'\s*\{\s*"utak"\s*:\s*"certificate"', head) is not None


def certificate_of(lines: Iterable[str], verdict: str | None) -> str:
    """Return the certificate of the verdict of a run, as the text of its file, from the lines of its episode.

    Raises NoCertificateError where none is found.
    """
    if verdict not in VERDICTS_SHOWN:
        raise NoCertificateError(
            f"certificates show {' and '.join(VERDICTS_SHOWN)}, and the verdict is {verdict or 'open'}"
        )
    episode = Evidence("".join(lines))
    if verdict == "impossible" and not any(map(BARRED_GOAL.fullmatch, episode.goals)):
        raise NoCertificateError("that a goal is impossible is shown of in(utak,room(next)) and through(utak,D) alone")
    try:
        certificate = _likely(episode, verdict)
        search = _Search(episode, CertificateCheck(episode, certificate))
        if any(kind != "thing" for kind, _, _ in search.checker.goals):
            lines_found = search.lines(0)
            try:
                lines_found += [line for angle in range(1, RIGHT_ANGLE) for line in search.lines(angle)]
            except (RefusedError, NoCertificateError) as why:
                if ["holds"] not in lines_found:
                    raise NoCertificateError(str(why)) from None
                certificate["given"].append(ALONG_GRID)
            if ["holds"] not in lines_found:
                raise NoCertificateError("no course of events was found that agrees with the impressions")
            certificate["cases"] = lines_found
    except RefusedError as why:
        raise NoCertificateError(str(why)) from None
    return json.dumps(certificate, separators=(",", ":")) + "\n"


def _likely(episode: Evidence, claim: str) -> dict[str, Any]:
    """Return a certificate without cases: of several, one whose goals hold where all went as commanded."""
    refusal = RefusedError("the goals name nothing that was felt")
    candidates = list(_candidates(episode, claim))
    for certificate in candidates:
        try:
            checker = CertificateCheck(episode, certificate)
            has_order = any(order for _, _, order in checker.goals)
            if any(kind != "thing" for kind, _, _ in checker.goals) and (has_order or len(candidates) > 1):
                certificate["steps"] = _Search(episode, checker).likely_steps()
                CertificateCheck(episode, certificate)
        except RefusedError as why:
            refusal = why
        else:
            return certificate
    raise refusal


def _candidates(episode: Evidence, claim: str) -> Iterator[dict[str, Any]]:
    """Yield certificates without cases, for each thing that each parameter may mean."""
    texts = [goal for goal in episode.goals if not goal.startswith("prefer(")]
    head = {"utak": "certificate", "version": 1, "claim": claim, "goals": episode.goals}
    if claim == "impossible":
        yield head | {"steps": [episode.last], "meaning": {}, "given": [*OF_WALLS], "cases": []}
        return
    goals = [goal_of(text) for text in texts]
    felt: dict[str, list[StatedLine]] = {}
    for kind, name, _ in goals:
        if kind in ("thing", "circled"):
            steps = [episode.last] if kind == "thing" else range(episode.last, -1, -1)
            places: dict[str, StatedLine] = {}  # the last touch of each colour
            for step in steps:
                for touch, letter in enumerate(episode.touches[step]):
                    if letter not in (None, VERGE_LETTER):
                        places.setdefault(letter, [step, touch])
            colours = [fact[-2] for fact in episode.claims if fact.startswith(f"colour({name},")]
            places = {letter: place for letter, place in places.items() if letter in (colours or places)}
            if kind == "thing" and len(places) > 1:
                raise NoCertificateError(f"several things are felt, and nothing tells which is {name}")
            if name not in felt or kind == "thing":
                felt[name] = list(places.values())
    for meaning in itertools.product(*felt.values()):
        means = dict(zip(felt, meaning, strict=True))
        taken = [
            fact for name, (step, n) in means.items() for fact in claims_taken(episode, name, episode.touches[step][n])
        ]
        steps = [episode.last] * len(goals)
        yield head | {"steps": steps, "meaning": means, "given": list(dict.fromkeys(taken)), "cases": []}


class _Search:
    """Goes through all cases of an episode."""

    def __init__(self, episode: Evidence, checker: CertificateCheck) -> None:
        self.episode, self.checker = episode, checker
        self.samples = Sampling(0)
        self.cases = 0

    def likely_steps(self) -> list[int]:
        """Return the steps at which the goals hold where all went as commanded; raises RefusedError for none."""
        unmet = self.checker.texts[0]
        for angle in range(RIGHT_ANGLE):
            self.samples = Sampling(angle)
            case = self.likely_case(angle)
            steps = [] if case is None else self.steps_of(case)
            if len(steps) == len(self.checker.goals):
                return steps
            unmet = unmet if case is None else self.checker.texts[len(steps)]
        raise RefusedError(f"nothing shows {unmet}")

    def likely_case(self, angle: int) -> Course | None:
        """Return the case in which all went as commanded from the middle of a square; None where it cannot be."""
        unit, case = self.episode.unit, waking_case(angle, self.episode)
        place = [unit // 2, unit // 2]
        while settle_all(case, self.episode, self.samples)[1] is None:
            if case.step == self.episode.last:
                return case.replayed(self.episode)
            motion = self.episode.motion(case.step + 1, angle)
            place = [p + v for p, v in zip(place, motion, strict=True)]
            end = case.ends(self.episode).get((place[0] // unit, place[1] // unit))
            if end is None:
                return None
            case = end
        return None

    def steps_of(self, case: Course) -> list[int]:
        """Return the steps at which the goals hold in a case, up to the first that does not."""
        steps: list[int] = []
        ordered = [number for number, (_, _, order) in enumerate(self.checker.goals) if order]
        for number, goal in enumerate(self.checker.goals):
            earliest = max((steps[other] for other in ordered if other < number), default=0)
            tried = range(earliest, self.episode.last) if number in ordered[:-1] else []
            found = [k for k in (*tried, self.episode.last) if self.checker.holds(goal, case, k, self.samples)]
            if not found:
                break
            steps.append(found[0])
        return steps

    def lines(self, angle: int) -> list[StatedLine]:
        """Return the lines that treat all cases of one orientation of the grid."""
        self.samples = Sampling(angle)
        return [["angle", angle], *self.branch(waking_case(angle, self.episode)).lines]

    def branch(self, case: Course) -> TreatedBranch:
        """Return the lines that treat a case; raises NoCertificateError where it may be and the goals may not hold."""
        self.cases += 1
        if self.cases > MAX_CASES:
            raise NoCertificateError("too much may have happened for the search of a certificate")
        counts, shut = settle_all(case, self.episode, self.samples)
        lines: list[StatedLine] = []
        needed: set[Spot] = set()
        if shut is not None:
            lines, needed = [shut.line], set(shut.sampled)
        else:
            again: Course | None = case
            if any(low != high for way in case.ways for low, high in way):
                again = case.replayed(self.episode)
                if again is None or (again.waking, again.ways) != (case.waking, case.ways):
                    lines, needed = [["replay"]], _free(case, set[Spot]().union(*case.swept))
                else:
                    again = case
            if again is not None:
                treated = self.shown(again) if again.step == self.episode.last else self.branches(again)
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
        needed: set[Spot] = set()
        for square, one in case.ends(self.episode).items():
            treated = self.branch(one)
            lines += [["end", *square], *treated.lines]
            needed |= treated.needed | _free(case, one.swept[-1])
        return TreatedBranch(lines, needed)

    def shown(self, case: Course) -> TreatedBranch:
        """Return the line that shows the goals; raises RefusedError where they may not hold."""
        needed: set[Spot] = set()
        for text, goal, step in zip(self.checker.texts, self.checker.goals, self.checker.steps, strict=True):
            if not self.checker.holds(goal, case, step, self.samples):
                raise RefusedError(f"nothing shows that {text} holds in all that may have happened")
            if goal[0] == "shut_in":
                needed |= _free(case, case.occupied)
            needed |= {square for square in case.occupied if _are_near(square, case.squares[step])}
        return TreatedBranch([["holds"]], needed)


def settle_all(case: Course, episode: Evidence, samples: Sampling) -> tuple[list[UsefulCount], UsefulCount | None]:
    """Settle all squares that single fields settle; return how, and the count that contradicts the case."""
    places = {square: step for step, square in reversed([*enumerate(case.squares)])}  # the first visit of each
    before = places[case.squares[-1]]
    fields = [(case.step, field) for field in sorted(SAMPLED_FIELDS)]
    if before < case.step:  # the robot saw the same squares before, and tells nothing new of them
        fields = [
            (step, field) for step, field in fields if episode.ranges[before, field] != episode.ranges[step, field]
        ]
    for step, field in fields if before < case.step else ():
        terms = [(step, field, 1), (before, field, -1)]
        if case.settle(episode, samples, terms):
            return [], UsefulCount(["count", *map(list, terms)], frozenset(), frozenset())
    counts: list[UsefulCount] = []
    while fields:
        fresh: set[Spot] = set()
        for step, field in fields:
            if not _tells(case, episode, samples, step, field):
                continue
            column, row = case.squares[step]
            sampled = frozenset((column + i, row + j) for i, j in samples.weights[field])
            unknown = sampled - case.occupied.keys()
            contradicts = case.settle(episode, samples, [(step, field, 1)])
            count = UsefulCount(["count", [step, field, 1]], sampled, unknown & case.occupied.keys())
            if contradicts:
                return counts, count
            if count.settled:
                counts.append(count)
                fresh |= count.settled
        holding, holders = _holders(samples.angle), set[tuple[int, int]]()
        for (column, row), step in places.items():
            for i, j in fresh:
                holders.update((step, field) for field in holding.get((i - column, j - row), ()))
        fields = sorted(holders)
    return counts, None


@cache
def _holders(angle: int) -> dict[Spot, list[int]]:
    """Return the fields that sample each square, which is an offset from that of the robot."""
    found: dict[Spot, list[int]] = defaultdict(list)
    samples = Sampling(angle)
    for field in sorted(SAMPLED_FIELDS):
        for square in samples.weights[field]:
            found[square].append(field)
    return found


def _tells(case: Course, episode: Evidence, samples: Sampling, step: int, field: int) -> bool:
    """Return whether a single field may settle a square or contradict the case."""
    (column, row), occupied = case.squares[step], case.occupied
    least, most = episode.ranges[step, field]
    low = high = heaviest = 0
    for (i, j), weight in samples.weights[field].items():
        state = occupied.get((column + i, row + j))
        if state is not False:
            high += weight
            if state:
                low += weight
            elif weight > heaviest:
                heaviest = weight
    least -= samples.slack[field]
    return low + heaviest > most or high - heaviest < least


def _free(case: Course, squares: Iterable[Spot]) -> set[Spot]:
    """Return those of some squares that are settled to be free."""
    return {square for square in squares if not case.occupied.get(square, True)}


def _are_near(one: Spot, other: Spot) -> bool:
    return max(abs(one[0] - other[0]), abs(one[1] - other[1])) <= GOAL_REACH
