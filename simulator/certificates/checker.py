"""The checker of certificates: whether what a verdict claims follows from what was seen, felt and commanded.

docs/certificates.md is the format, and all that is taken for granted. This module and `courses` import nothing else of
ours, search nothing, compare no floats, and read neither beliefs nor the truth of an episode.
"""

import re
from itertools import pairwise, product
from typing import Any

from utak.simulator.certificates import courses
from utak.simulator.certificates.courses import Course, Evidence, Spot, Spots, parsed, refuse, touched, turned

VERDICTS_SHOWN = ("done", "impossible")
KEYS_IN_ORDER = ("utak", "version", "claim", "goals", "steps", "meaning", "given", "cases")
SHOWN_GOAL = re.compile(r"(?:(first|then)\()?(at|beside|circled)\((\w+),(?:corner\((\w+)\)|(\w+))\)(?(1)\))")
BARRED_GOAL = re.compile(r"(?:(first|then)\()?(?:in\((\w+),room\(next\)\)|through\((\w+),(\w+)\))(?(1)\))")
OF_DOORS = ["verge(walls)", "isolated(things)", "parted(rooms)"]  # given, of `done` of such a goal
OF_WALLS, OF_THINGS = ["whole(squares)", "isolated(things)"], ["apart(things)"]  # given, of `impossible`
ALONG_GRID = "along(grid)"  # given: the robot's axes lie along the squares, so only the angle 0 is treated
RIGHT_ANGLE = 90  # degrees: a quarter turn of the grid of squares is the same grid
CORNERS = {"northeast": (1, 1), "northwest": (-1, 1), "southwest": (-1, -1), "southeast": (1, -1)}
OWN_NAME = "utak"
Shown = tuple[str, str, str, str]  # corner, start, near, circled, room or shut; of what; corner or parameter; order


def goal_of(text: str, claim: str) -> Shown:
    """Return a goal of the task."""
    if barred := BARRED_GOAL.fullmatch(text):
        what = barred[2] or barred[3]
        return ("room", what, barred[4] or "", barred[1] or "") if claim == "done" else ("shut", what, "", "")
    found = SHOWN_GOAL.fullmatch(text) or refuse(f"nothing is shown of {text}")
    order, word, what, corner, name = found.groups()
    kind = "corner" if corner else "start" if name == "start" else "near" if word != "circled" else word
    if (word != "at" and kind in ("corner", "start")) or (kind in ("corner", "circled") and what != OWN_NAME):
        refuse(f"nothing is shown of {text}")
    return kind, what, corner or name, order or ""


def claims_taken(episode: Evidence, name: str, letter: str) -> list[str]:
    """Return what the task claims of a thing and a touch of this colour does not show."""
    own = f"colour({name},{letter})"
    return [fact for fact in episode.claims if re.search(rf"\b{name}\b", fact) and fact != own]


def are_whole(values: Any, number: int) -> bool:
    """Return whether a value is a list of so many whole numbers."""
    return isinstance(values, list) and len(values) == number and all(type(value) is int for value in values)


class CertificateCheck:
    """One certificate, held against its episode."""

    def __init__(self, episode: Evidence, certificate: Any) -> None:
        if not isinstance(certificate, dict) or set(certificate) != set(KEYS_IN_ORDER):
            refuse(f"a certificate has the keys {', '.join(KEYS_IN_ORDER)}, and no others")
        *head, self.steps, self.meaning, self.given, self.lines = (certificate[key] for key in KEYS_IN_ORDER)
        self.episode, self.claim = episode, head[2]
        texts = [goal for goal in episode.goals if not goal.startswith("prefer(")]
        self.texts = texts if self.claim == "done" else [text for text in texts if BARRED_GOAL.fullmatch(text)][:1]
        is_form = repr(head) == repr(["certificate", 1, self.claim, episode.goals])  # of all 1s the whole number alone
        if not is_form or self.claim not in VERDICTS_SHOWN or not self.texts:
            refuse("it is no certificate of version 1, of goals of the episode that certificates show")
        self.goals = [goal_of(text, self.claim) for text in self.texts]
        if not are_whole(self.steps, len(self.goals)) or not all(0 <= k <= self.episode.last for k in self.steps):
            refuse("it has not one step for each goal")
        self.has_frame = any(goal[0] in ("room", "shut") for goal in self.goals)
        self.timed = list(zip(self.steps, self.goals, strict=True))
        ordered = [k for k, goal in self.timed if goal[3]]
        if ordered != sorted(ordered) or any(k != self.episode.last for k, goal in self.timed if not goal[3]):
            refuse("its steps are not in the order of the task, or a goal does not hold at the end")
        taken = self.check_meaning() + (OF_WALLS + OF_THINGS * bool(self.meaning)) * (self.claim == "impossible")
        if self.given not in (taken, [*taken, ALONG_GRID]):
            refuse(f"what it is given must be {taken}, and perhaps {ALONG_GRID}")

    def check_meaning(self) -> list[str]:
        """Return the claims of the task about things that are taken to be so; refuse unless each thing was felt."""
        names = dict.fromkeys(name for _, *names, _ in self.goals for name in names if name in self.episode.kinds)
        named, doors = ([name for name in names if (self.episode.kinds[name] == "door") == k] for k in (0, 1))
        if not isinstance(self.meaning, dict) or list(self.meaning) != named:
            refuse("it must say what was felt of each thing that the goals name, and of no other")
        letters = dict.fromkeys(names, "")  # that were felt of things
        for name, felt in self.meaning.items():
            if self.episode.kinds.get(name) != "object" or not are_whole(felt, 2) or min(felt) < 0:
                refuse(f"{name} is no object of the task, or what was felt is not named by a step and a touch")
            letters[name] = self.episode.touches[felt[0]][felt[1]] or refuse(f"nothing was felt of {name}")
        taken = {fact: name for name in named + doors for fact in claims_taken(self.episode, name, letters[name])}
        is_other = any(fact.startswith(f"colour({name},") for fact, name in taken.items())
        if is_other or len({courses.VERGE_LETTER, *map(letters.get, named)}) <= len(named):
            refuse("things of one colour may be one, or one is of another colour than the task claims, or verge")
        if any(goal[:2] == ("near", OWN_NAME) and self.meaning[goal[2]][0] != k for k, goal in self.timed):
            refuse("a thing was not felt at the step of its goal")
        return [*taken, *(OF_DOORS if self.has_frame and self.claim == "done" else ())]

    def check(self) -> str:
        """Return what is shown, in words; refuse when the claim does not follow."""
        if any(goal[:2] != ("near", OWN_NAME) for goal in self.goals):
            self.check_cases()
        elif self.lines != []:
            refuse("its goals need no cases, and it has some")
        shown = [f"{text} at step {step}" for text, step in zip(self.texts, self.steps, strict=True)]
        means = [f"{name} is the thing felt at step {k}, touch {n}" for name, (k, n) in self.meaning.items()]
        return f"{self.claim}: {', '.join([*shown, *means])}" + "; given " * bool(self.given) + ", ".join(self.given)

    def check_cases(self) -> None:
        """Refuse unless each orientation of the grid and each end of each command is shut or shows the goals."""
        if self.episode.hindrance or not isinstance(self.lines, list):
            refuse(f"nothing is said of where the robot is in an episode with {', '.join(self.episode.hindrance)}")
        angle, angles, shown = -1, 1 if ALONG_GRID in self.given else RIGHT_ANGLE, 0
        left: list[dict[Spot, Course]] = []  # of each step: the ends of the command that are still to be treated
        case: Course | None = None  # the one that is treated now; None where the next line must begin one
        for number, line in enumerate(self.lines):
            word, args = (line[0], line[1:]) if isinstance(line, list) and line else ("", [])
            if word == "count" and case and all(are_whole(term, 3) for term in args):
                case = None if case.settle(self.episode, args) else case
            elif word == "replay" and case and not args:
                case = case.replayed(self.episode)
            elif word == "holds" and case and case.step == self.episode.last and bool(args) == self.has_frame:
                if not all(self.holds(goal, case, step, args) for step, goal in self.timed):
                    refuse(f"line {number}: a goal may not hold")
                case, shown = None, shown + 1
            elif word == "angle" and not case and not left and repr(args) == f"[{angle + 1}]" and angle + 1 < angles:
                angle, case = angle + 1, courses.waking_case(angle + 1, self.episode)
            elif word == "end" and are_whole(args, 2) and (left if case is None else case.step < self.episode.last):
                if case:
                    left.append(case.ends(self.episode))
                case = left[-1].pop((args[0], args[1]), None) or refuse(f"line {number}: the command cannot end there")
                case = case._replace(occupied=dict(case.occupied))
            else:
                refuse(f"line {number}: it is no line that may stand here")
            while not case and left and not left[-1]:
                left.pop()
        if case or left or angle != angles - 1 or not shown:
            refuse("it ends before all cases are treated, or the episode agrees with no world")

    def holds(self, goal: Shown, case: Course, step: int, frame: list[Any]) -> bool:
        """Return whether a goal holds at a step of a case for sure, or is barred by a frame of squares."""
        kind, what, name, _ = goal
        if kind == "shut":
            return are_whole(frame, 4) and self.is_shut_in(what, case, frame)
        if kind == "room":
            return len(frame) == 3 and all(are_whole(one, 4) for one in frame) and self.is_next(what, case, step, frame)
        if kind == "circled":
            return self.is_circled(name, case, step)
        covered, other = (case.covered(self.episode, self.meaning.get(one), step) for one in (what, name))
        if kind == "near":
            pairs = product(covered, other)
            return what == OWN_NAME or any(max(abs(i - a), abs(j - b)) <= 1 for (i, j), (a, b) in pairs)
        return (0, 0) in covered if kind == "start" else self.is_corner(name, case, step)

    def is_next(self, what: str, case: Course, step: int, frames: list[list[int]]) -> bool:
        """Return whether what began in one of two rectangles of floor that a door joins lies in the other."""
        began, lies = case.extent(self.episode, self.meaning.get(what), step)
        door, *rooms = (Spots(touched(((w, e + 1), (s, n + 1)))) for w, s, e, n in frames)
        floor = door.union(*rooms)
        unseen = {at for at in floor - began - {*case.squares[: step + 1]} if not case.was_free(at)}
        way = 1 if frames[0][0] - 1 in (frames[1][2], frames[2][2]) else -1  # it leads along the rows, or the columns
        (w, s, e, n), *sides = frames if way > 0 else [[s, w, n, e] for w, s, e, n in frames]
        beside = [[(i, j) if way > 0 else (j, i) for j in (s - 1, n + 1)] for i in range(w, e + 1)]
        walls = {at for pair in beside for at in pair if at not in began and case.occupied.get((*at, 0))}
        walls |= {at for pair in beside for at in pair if at not in lies and case.at(at, step)}
        walled = [walls.issuperset(pair) for pair in beside]  # each column or row of the door
        is_joined = any(low[2] + 1 == w <= e == high[0] - 1 for low, high in (sides, sides[::-1]))
        fits = all(one[1] <= s <= n <= one[3] and min(one[2] - one[0], one[3] - one[1]) > 2 * (n - s) for one in sides)
        is_floor = len(floor) <= courses.MAX_SQUARES and case.spread(unseen, step) <= floor
        is_led = began and lies and any(began <= one and lies <= other for one, other in (rooms, rooms[::-1]))
        return bool(is_joined and fits and is_floor and is_led and len(walled) > walled.count(False) < 2 * (n - s + 1))

    def is_corner(self, name: str, case: Course, step: int) -> bool:
        """Return whether the robot is in the corner square of the known floor that is furthest towards a corner."""
        (u, v), (i, j) = turned(*CORNERS[name], case.angle), case.squares[step]  # where the corner is, map frame
        ahead = (i + (1 if u > 0 else -1), j), (i, j + (1 if v > 0 else -1))
        is_shut = all(case.at(at, step) and at not in case.held[step] for at in ahead)
        if not (u and v and is_shut and case.was_free((i, j))):
            return False

        def is_further(p: int, q: int) -> bool:
            return u * (p + (u > 0)) + v * (q + (v > 0)) > u * (i + (u > 0)) + v * (j + (v > 0))

        for (k, field), (_, most) in self.episode.ranges.items():  # does it show floor further on?
            (p, q), squares = case.squares[min(k, step)], courses.sampled(case.angle)[field][0]
            if k <= step and sum(n for (c, d), n in squares.items() if is_further(p + c, q + d)) > most:
                return False
        return not any(is_further(*square) for square in case.squares[: step + 1])

    def is_circled(self, name: str, case: Course, step: int) -> bool:
        """Return whether the track ends in the square where it began, which is free, and winds about a thing."""
        thing = case.touch(*self.meaning[name])
        passed = frozenset(case.squares[: step + 1]).union(*case.swept[: step + 1])
        if thing is None or thing in passed or thing in case.changes or case.squares[step] != (0, 0):
            return False  # the track may lead through the square in which the thing was felt
        track = [(x[0] + x[1], y[0] + y[1]) for x, y in case.places[: step + 1]]
        x, y = ((2 * number + 1) * self.episode.unit for number in thing)
        winding = 0
        for (x0, y0), (x1, y1) in pairwise([*track, track[0]]):
            left = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
            winding += (y0 <= y < y1 and left > 0) - (y1 <= y < y0 and left < 0)
        return winding != 0 and case.at((0, 0), step) is False

    def is_shut_in(self, what: str, case: Course, frame: list[int]) -> bool:
        """Return whether the robot or a thing is in a rectangle of floor and things, with no gap that lets it out."""
        (w, s, e, n), felt, size = frame, dict[Spot | None, str | None](), 0
        within = solid = Spots([(0, 0)])
        if what != OWN_NAME:
            within = case.piece(self.episode, *self.meaning[what])
            solid = within if all(case.at(square, 0) for square in within) else Spots()
        if max(map(abs, frame)) > courses.MAX_SQUARES or (
            what != OWN_NAME and any(case.held[: self.meaning[what][0] + 1])
        ):
            return False  # what was carried may lie beside it
        while any(solid >= {*product(range(i, i + size + 1), range(j, j + size + 1))} for i, j in solid):
            size += 1  # of the largest square of squares in it
        for k, touches in enumerate(self.episode.touches):
            felt.update({case.touch(k, number): letter for number, letter in enumerate(touches)})
        sides = [[(i, j) for j in range(s + 1, n)] for i in (w, e)]
        sides += [[(i, j) for i in range(w + 1, e)] for j in (s, n)]
        walls = ["".join("#" if felt.get(at) == courses.VERGE_LETTER else "." for at in side) for side in sides]
        rim = {*product((w + 1, e - 1), range(s + 1, n)), *product(range(w + 1, e), (s + 1, n - 1))}
        is_rim = all(felt.get(at, courses.VERGE_LETTER) != courses.VERGE_LETTER or case.was_free(at) for at in rim)
        is_within = size > 0 and all(w < i < e and s < j < n for i, j in within)
        return is_within and is_rim and all(re.fullmatch(rf"(#\.{{0,{size - 1}}})*#", wall) for wall in walls)


def verify(episode: str, certificate: str) -> str:
    """Return what a certificate shows of an episode, in words, from the texts of both files.

    Raises RefusedError when the claim does not follow, ValueError when a text is no JSON or no episode.
    """
    try:
        return CertificateCheck(Evidence(episode), parsed(certificate)).check()
    except (LookupError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        raise ValueError(f"it is damaged: {type(error).__name__}: {error}") from None
