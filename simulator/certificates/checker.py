"""The checker of certificates: whether what a verdict claims follows from what was seen, felt and commanded.

docs/certificates.md is the format, and all that is taken for granted. This module and `courses` import nothing else of
ours, search nothing, compare no floats, and read neither beliefs nor the truth of an episode.
"""

import re
from itertools import count, pairwise, product
from math import isqrt
from typing import Any

from utak.simulator.certificates import courses
from utak.simulator.certificates.courses import Course, Evidence, Span, Spot, Spots, refuse, spread

KEYS_IN_ORDER = ("utak", "version", "claim", "goals", "steps", "meaning", "given", "risk", "cases")
GOAL = re.compile(r"(?:(first|then)\()?(\w+)\((\w+),(?:corner\((\w+)\)|(room\(next\)|\w+))\)(?(1)\))")
BARRED_GOALS = {"at corner()": "corner", "in room(next)": "room", "through ": "room"}
OTHER_GOALS = {"at start": "start", "at ": "near", "beside ": "near", "circled ": "circled"}
GOAL_KINDS = {"done": BARRED_GOALS | OTHER_GOALS, "impossible": BARRED_GOALS}
OF_DOORS = ["verge(walls)", "isolated(things)", "parted(rooms)"]  # given, of `done` of such a goal
OF_WALLS, OF_THINGS = ["whole(squares)", "isolated(things)"], ["apart(things)"]  # given, of `impossible`
OF_COLOURS = ["single(colours)"]  # given, of `done` of a thing, perhaps: no two things are of one colour
ALONG_GRID = "along(grid)"  # given: the robot's axes lie along the squares, so only the angle 0 is treated
RIGHT_ANGLE = 90  # degrees: a quarter turn of the grid of squares is the same grid
CORNERS = {"northeast": (1, 1), "northwest": (-1, 1), "southwest": (-1, -1), "southeast": (1, -1)}
OWN_NAME = "utak"
Shown = tuple[str, str, str, str]  # corner, start, near, circled or room; of what; the corner or parameter; the order


def goal_of(text: str, claim: str) -> Shown:
    """Return a goal of the task."""
    order, word, what, corner, name = (GOAL.fullmatch(text) or refuse(f"nothing is shown of {text}")).groups()
    place = "corner()" if corner else name if name in ("start", "corner", "room(next)") else ""
    kind = GOAL_KINDS[claim].get(f"{word} {place}")
    if not kind or (kind == "circled" and what != OWN_NAME):
        refuse(f"nothing is shown of {text}")
    is_named = kind in ("near", "circled") or (claim == "done" and word == "through")
    return kind, what, corner or (name if is_named else ""), order or ""


def blocks(squares: Spots, size: int) -> Spots:
    """Return the south-west squares of all squares of so many by so many squares that some squares contain."""
    for _ in range(size - 1):
        squares = frozenset((i, j) for i, j in squares if {(i + 1, j), (i, j + 1), (i + 1, j + 1)} <= squares)
    return squares


def widest_block(squares: Spots) -> int:
    """Return the side of the largest square of squares among some; 1 at least."""
    return next(size for size in count(1) if not blocks(squares, size + 1))


def is_one_room(floor: Spots, size: int) -> bool:
    """Return whether no neck, as wide as a size at least, is at most half as wide as the floor on both sides."""
    for width in range(size, widest_block(floor)):  # of the neck, or up to 1 more: this holds up what is wider than it
        sides = blocks(floor, isqrt(2 * width**2 - 1) + 1)  # a disc that is twice as wide holds such a square
        if not sides <= spread(Spots([*sides][:1]), blocks(floor, width + 1).__contains__):
            return False
    return True


def reach(towards: Span, square: Span) -> int:
    """Return how far a square reaches in a direction, a vector."""
    return sum(part * (number + (part > 0)) for part, number in zip(towards, square, strict=True))


def claims_taken(episode: Evidence, name: str, letter: str) -> list[str]:
    """Return what the task claims of a thing and a touch of this colour does not show."""
    return [fact for fact in episode.claims if re.search(rf"\b{name}\b", fact) and fact != f"colour({name},{letter})"]


def are_whole(values: Any, number: int) -> bool:
    """Return whether a value is a list of so many whole numbers."""
    return isinstance(values, list) and len(values) == number and all(type(value) is int for value in values)


class CertificateCheck:
    """One certificate, held against its episode."""

    def __init__(self, episode: Evidence, certificate: Any) -> None:
        if not isinstance(certificate, dict) or set(certificate) != set(KEYS_IN_ORDER):
            refuse(f"a certificate has the keys {', '.join(KEYS_IN_ORDER)}, and no others")
        *head, self.steps, self.meaning, self.given, self.risk, self.lines = (certificate[key] for key in KEYS_IN_ORDER)
        self.episode, self.claim = episode, head[2]
        texts = [goal for goal in episode.goals if not goal.startswith("prefer(")]
        is_form = repr(head) == repr(["certificate", 1, self.claim, episode.goals])  # of all 1s the whole number alone
        if not is_form or not isinstance(self.steps, list) or len(self.steps) != len(texts):
            refuse("it is no certificate of version 1, of goals of the episode, with a step for each goal")
        told = [(k, text) for k, text in zip(self.steps, texts, strict=True) if k is not None or self.claim == "done"]
        self.steps, self.texts = [k for k, _ in told], [text for _, text in told]
        self.goals = [goal_of(text, self.claim) for text in self.texts]
        if not told or not are_whole(self.steps, len(told)) or not {*self.steps} <= {*range(episode.last + 1)}:
            refuse("it shows nothing, or at a step that the episode does not have")
        self.last = episode.last if self.claim == "done" else self.steps[0]
        self.timed = list(zip(self.steps, self.goals, strict=True))
        ordered = [k for k, goal in self.timed if goal[3]]
        if ordered != sorted(ordered) or any(k != self.last for k, goal in self.timed if not goal[3]):
            refuse("its steps are not in the order of the task, or a goal does not hold at the end")
        self.has_door = self.claim == "done" and any(goal[0] == "room" for goal in self.goals)
        taken, walls = self.check_meaning() + OF_DOORS * self.has_door, OF_WALLS + OF_THINGS * bool(self.meaning)
        is_carried = any(goal[1] != OWN_NAME for goal in self.goals)
        more = walls if self.claim == "impossible" else OF_COLOURS * is_carried
        granted = [taken, taken + more]
        if self.given not in [one + grid for one in granted for grid in ([], [ALONG_GRID])]:
            refuse(f"what it is given must be {granted[-1]}, and perhaps {ALONG_GRID}")
        self.has_cases = any(goal[:2] != ("near", OWN_NAME) for goal in self.goals)
        if self.has_cases and episode.hindrance:
            refuse(f"nothing is said of where the robot is in an episode with {', '.join(episode.hindrance)}")
        risks = range(1, courses.MILLION) if self.has_cases and episode.noise else range(1)
        if type(self.risk) is not int or self.risk not in risks:
            refuse(f"its risk must be {risks[0]} to {risks[-1]} millionths")
        episode.allow(self.risk, OF_COLOURS[0] in self.given)

    def check_meaning(self) -> list[str]:
        """Return the claims of the task about things that are taken to be so; refuse unless each thing was felt."""
        doors = dict.fromkeys(name for kind, _, name, _ in self.goals if kind == "room" and name)
        others = [goal[1 : 3 if goal[0] in ("near", "circled") else 2] for goal in self.goals]
        things = dict.fromkeys(name for names in others for name in names if name != OWN_NAME)
        if not isinstance(self.meaning, dict) or list(self.meaning) != list(things):
            refuse("it must say what was felt of each thing that the goals name, and of no other")
        letters = dict.fromkeys([*things, *doors], "")  # that were felt of things
        for name, felt in self.meaning.items():
            if not are_whole(felt, 2) or min(felt) < 0:
                refuse(f"what was felt of {name} is not named by a step and a touch")
            letters[name] = self.episode.touches[felt[0]][felt[1]] or refuse(f"nothing was felt of {name}")
        if any(self.episode.kinds.get(name) != ("door" if name in doors else "object") for name in letters):
            refuse("a goal names something that is no object, or no door, of the task")
        taken = {fact: name for name, letter in letters.items() for fact in claims_taken(self.episode, name, letter)}
        is_other = any(fact.startswith(f"colour({name},") for fact, name in taken.items())
        if is_other or len({courses.VERGE_LETTER, *map(letters.get, things)}) <= len(things):
            refuse("two things of one colour may be one, or one is of another colour than the task claims, or verge")
        if any(goal[:2] == ("near", OWN_NAME) and self.meaning[goal[2]][0] != k for k, goal in self.timed):
            refuse("a thing was not felt at the step of its goal")
        return list(taken)

    def check(self) -> str:
        """Return what is shown, in words; refuse when the claim does not follow."""
        if self.has_cases:
            self.check_cases()
        elif self.lines != []:
            refuse("its goals need no cases, and it has some")
        shown = [f"{text} at step {step}" for text, step in zip(self.texts, self.steps, strict=True)]
        means = [f"{name} is the thing felt at step {k}, touch {n}" for name, (k, n) in self.meaning.items()]
        given = "; given " * bool(self.given) + ", ".join(self.given)
        risk = f", at a risk of {self.risk / 10**4:g} percent" * bool(self.risk)
        return f"{self.claim}{risk}: {', '.join([*shown, *means])}{given}"

    def check_cases(self) -> None:
        """Refuse unless each orientation of the grid and each end of each command is shut or shows the goals."""
        angle, angles, shown = -1, 1 if ALONG_GRID in self.given else RIGHT_ANGLE, 0
        left: list[dict[Spot, Course]] = []  # of each step: the ends of the command that are still to be treated
        case: Course | None = None  # the one that is treated now; None where the next line must begin one
        for number, line in enumerate(self.lines if isinstance(self.lines, list) else refuse("its cases are no list")):
            word, args = (line[0], line[1:]) if isinstance(line, list) and line else ("", [])
            if word == "count" and case and all(are_whole(term, 3) for term in args):
                case = None if case.settle(self.episode, args) else case
            elif word == "replay" and case and not args:
                case = case.replayed(self.episode)
            elif word == "holds" and case and case.step == self.last and self.is_shown(case, args):
                case, shown = None, shown + 1
            elif word == "angle" and not case and not left and repr(args) == f"[{angle + 1}]" and angle + 1 < angles:
                angle, case = angle + 1, courses.waking_case(angle + 1, self.episode)
            elif word == "end" and are_whole(args, 2) and (left if case is None else case.step < self.last):
                if case:
                    left.append(case.ends(self.episode))
                case = left[-1].pop((args[0], args[1]), None) or refuse(f"line {number}: the command cannot end there")
                case = case._replace(occupied=dict(case.occupied))
            else:
                refuse(f"line {number}: it is no line that may stand here, or a goal may not hold")
            while not case and left and not left[-1]:
                left.pop()
        if case or left or angle != angles - 1 or not shown:
            refuse("it ends before all cases are treated, or the episode agrees with no world")

    def is_shown(self, case: Course, door: list[Any]) -> bool:
        """Return whether a case shows that the goals hold, those of rooms by a door, or that they cannot."""
        if self.claim == "impossible":
            return door == [] and self.is_barred(case)
        return bool(door) == self.has_door and all(self.holds(goal, case, step, door) for step, goal in self.timed)

    def felt(self, what: str) -> Spot | None:
        """Return the touch that felt what a goal is about; None for the robot."""
        return None if what == OWN_NAME else self.meaning[what]

    def holds(self, goal: Shown, case: Course, step: int, door: list[Any]) -> bool:
        """Return whether a goal holds at a step of a case for sure, one of rooms by a door and the rooms beside it."""
        kind, what, name, _ = goal
        if kind == "room":
            return len(door) == 3 and all(are_whole(one, 4) for one in door) and self.is_next(what, case, step, door)
        if kind == "circled":
            return self.is_circled(name, case, step)
        if kind == "near" and what == OWN_NAME:
            return True
        covered = case.covered(self.episode, self.felt(what), step)
        if kind == "near":
            pairs = product(covered, case.covered(self.episode, self.meaning[name], step))
            return any(max(abs(i - a), abs(j - b)) <= 1 for (i, j), (a, b) in pairs)
        return (0, 0) in covered if kind == "start" else self.is_corner(what, name, case, step)

    def is_next(self, what: str, case: Course, step: int, frames: list[list[int]]) -> bool:
        """Return whether what began in one of two rectangles of floor that a door joins lies in the other."""
        began, lies = case.extent(self.episode, self.felt(what), step)
        door, *rooms = (Spots(courses.touched(((w, e + 1), (s, n + 1)), 1)) for w, s, e, n in frames)
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
        is_floor = len(floor) <= courses.MAX_SQUARES and case.unsettled(unseen, step) <= floor
        is_led = began and lies and any(began <= one and lies <= other for one, other in (rooms, rooms[::-1]))
        return bool(is_joined and fits and is_floor and is_led and len(walled) > walled.count(False) < 2 * (n - s + 1))

    def is_corner(self, what: str, name: str, case: Course, step: int) -> bool:
        """Return whether what the robot or a thing covers ends in the corner of the known floor that is furthest."""
        towards, felt = courses.turned(*CORNERS[name], case.angle), self.felt(what)  # map frame
        (covered, moves), (_, lies) = case.followed(self.episode, felt, step), case.extent(self.episode, felt, step)
        if not (all(towards) and covered and lies):
            return False
        a, b = ways = [1 if part > 0 else -1 for part in towards]
        least, most = ([way * max(way * at[n] for at in lot) for n, way in enumerate(ways)] for lot in (covered, lies))
        columns, rows = (range(one, two + way, way) for one, two, way in zip(least, most, ways, strict=True))
        if not 0 < len(columns) * len(rows) <= courses.MAX_SQUARES:
            return False
        spots = list(product(columns, rows))
        backs = {0, 1} if felt else {0}  # the last row or column that a thing covers may be one of the wall, too
        ahead = {at for i, j in spots for n in backs for at in ((i + a, j - b * n), (i - a * n, j + b))}
        if not all(case.at(at, step) and (felt or at not in case.held[step]) for at in ahead):
            return False
        limit = reach(towards, (least[0], least[1]))
        for (k, field), (_, shown) in self.episode.ranges.items():  # does it show floor further on?
            (p, q), squares = case.squares[min(k, step)], courses.sampled(case.angle)[field][0]
            further = {(p + c, q + d): n for (c, d), n in squares.items() if reach(towards, (p + c, q + d)) > limit}
            if k <= step and sum(further.values()) > shown:
                since = {at: {n for n in case.changes.get(at, ()) if k < n <= step} for at in further}
                if not all(case.at(at, step) and moves.issuperset(since[at]) for at in further):  # it lies there now
                    return False
        floor = (at for at in case.squares[: step + 1] if at in case.changes or not case.at(at, 0))  # not within a wall
        return bool(felt or case.was_free(spots[0])) and all(reach(towards, at) <= limit for at in floor)

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

    def is_barred(self, case: Course) -> bool:
        """Return whether the goals cannot hold at once, wherever what they are about may come to."""
        kinds, (what, *others), _, orders = zip(*self.goals, strict=True)
        within = frozenset([(0, 0)]) if what == OWN_NAME else case.outline(self.episode, self.meaning[what])
        if not within or (others and ({*others} != {what} or any(orders))):
            return False
        size = widest_block(within)
        floor = self.shut_in(case, within, size) if OF_WALLS[0] in self.given else Spots()
        is_shut = kinds == ("room",) and bool(floor) and is_one_room(floor, size)
        return is_shut or ({*kinds} == {"corner"} and self.is_too_far(case, floor, within))

    def shut_in(self, case: Course, within: Spots, size: int) -> Spots:
        """Return the floor that what holds a square of a size never leaves; none where it may."""
        touches = enumerate(self.episode.touches[: case.step + 1])
        felt = {case.touch(k, touch): letter for k, row in touches for touch, letter in enumerate(row)}
        verge = {at for at, letter in felt.items() if at and letter == courses.VERGE_LETTER}
        ways = [(i, j, a, b, n) for i, j in verge for a, b in ((1, 0), (0, 1)) for n in range(1, size + 1)]
        gaps = [(i, j, a, b, n) for i, j, a, b, n in ways if (i + a * n, j + b * n) in verge]
        barred = verge.union((i + a * k, j + b * k) for i, j, a, b, n in gaps for k in range(n))
        floor = spread(within, lambda at: at not in barred)
        if len(floor) > courses.MAX_SQUARES:
            refuse("nothing bounds the floor")
        known = {at for at in floor if felt.get(at, courses.VERGE_LETTER) != courses.VERGE_LETTER or case.was_free(at)}
        deep = blocks(floor, 3)
        return floor if all((i - 1, j - 1) in deep for i, j in floor - known) else Spots()

    def is_too_far(self, case: Course, floor: Spots, covered: Spots) -> bool:
        """Return whether what covers some squares is too far from corners, wherever it is on a floor, if on one."""
        towards = [courses.turned(*CORNERS[name], case.angle) for _, _, name, _ in self.goals]
        known = [(i, j) for (i, j, _), is_occupied in case.occupied.items() if not is_occupied]
        size = sum(len({at[n] for at in covered}) for n in (0, 1))  # no two points of it are further apart
        least = sum(max((reach(way, at) for at in known), default=0) for way in towards)
        least -= (len(towards) * (2 + size) + size * bool(floor)) * courses.DIRECTION_SCALE
        way = sum(x for x, _ in towards), sum(y for _, y in towards)
        return least > max((reach(way, at) for at in floor), default=least if any(way) else 0)


def verify(episode: str, certificate: str) -> str:
    """Return what a certificate shows of an episode, in words, from the texts of both files.

    Raises RefusedError when the claim does not follow, ValueError when a text is no JSON or no episode.
    """
    try:
        return CertificateCheck(Evidence(episode), courses.parsed(certificate)).check()
    except (LookupError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        raise ValueError(f"it is damaged: {type(error).__name__}: {error}") from None
