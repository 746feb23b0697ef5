"""The checker of certificates: whether what a verdict claims follows from what was seen, felt and commanded.

docs/certificates.md is the format, and all that is taken for granted. The checker imports nothing of ours, searches
nothing, compares no floats, and reads neither beliefs nor the truth of an episode.
"""

import json
import re
from fractions import Fraction
from functools import cache
from itertools import product
from math import lcm
from typing import Any, NamedTuple, NoReturn

VERDICTS_SHOWN = ("done", "impossible")
KEYS_IN_ORDER = ("utak", "version", "claim", "goals", "steps", "meaning", "given", "cases")
SHOWN_GOAL = re.compile(
    r"(?P<order>(?:first|then)\()?(?:at\(utak,corner\((?P<corner>\w+)\)\)|(?:at|beside)\(utak,(?P<thing>\w+)\)"
    r"|circled\(utak,(?P<circled>\w+)\))(?(order)\))"
)
BARRED_GOAL = re.compile(r"(?:(?:first|then)\()?(?:in\(utak,room\(next\)\)|through\(utak,\w+\))\)?")
OF_WALLS = ["whole(squares)", "isolated(things)"]  # given, of `impossible`
ALONG_GRID = "along(grid)"  # given: the robot's axes lie along the squares, so only the angle 0 is treated
RIGHT_ANGLE = 90  # degrees: a quarter turn of the grid of squares is the same grid
FIELD_ZONES = ((4, 0, 1), (8, 4, 2), (16, 8, 4))  # of the retina: reach, reach of the one within, side of fields
FIELD_OFFSETS = [  # of the retina, in order: the offset (east, north) of the south-west square, and the side
    (east, north, side)
    for reach, inner, side in FIELD_ZONES
    for north in range(reach - side, -reach - 1, -side)
    for east in range(-reach, reach, side)
    if not (-inner <= east < inner and -inner <= north < inner)
]
SAMPLED_FIELDS = {*range(len(FIELD_OFFSETS))} - {FIELD_OFFSETS.index((0, 0, 1))}  # the robot always fills its square
LEVEL_RANGES: dict[tuple[int, int], list[int]] = {}  # (side, gray level): least and greatest count of occupied squares
for k, n in [(1, n) for n in range(2)] + [(2, n) for n in range(5)] + [(4, n) for n in range(17)]:
    LEVEL_RANGES.setdefault((k, (14 * n + k * k) // (2 * k * k)), [n, n])[1] = n
TOUCH_NAMES = ("north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest")
TOUCH_OFFSETS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))  # (east, north), in this order
CORNERS = {"northeast": (1, 1), "northwest": (-1, 1), "southwest": (-1, -1), "southeast": (1, -1)}
VERGE_LETTER = "b"  # the colour of what bounds the floor
PI_DECIMALS = Fraction("3.14159265358979323846264338327950288")
DIRECTION_SCALE = 10**18  # cosines and sines are whole numbers of so small parts
TIE_ERROR = DIRECTION_SCALE // 10**9  # so near to the middle between two squares either may be sampled (axiom 2)
PLACE_PARTS = 10**6  # of a square: by one of them the robot may stand beside where its commands lead (axiom 4)
MAX_SWEPT_SQUARES = 10**5  # of one command; a bound on time
MAX_EXPONENT_DIGITS = 4  # with the sign; a bound on time

Spot = tuple[int, int]
Span = tuple[int, int]  # least and greatest; or x and y of a vector
Zone = tuple[Span, Span]  # a range of x and a range of y, map frame; `Evidence.unit` is a square
Shown = tuple[str, str, str]  # corner, start, thing or circled; the corner or parameter; first, then or ""


class RefusedError(Exception):
    """The claim of a certificate does not follow by what the certificate says; the message tells why."""


def refuse(why: str) -> NoReturn:
    """Raise RefusedError."""
    raise RefusedError(why)


@cache
def direction(angle: int) -> Span:
    """Return DIRECTION_SCALE times cosine and sine of whole degrees, from 0 to 90, rounded, by their series."""
    terms = [Fraction(1)]
    for n in range(1, 30):
        terms.append(terms[-1] * PI_DECIMALS * angle / (180 * n))
    parts = [sum((-1) ** (n // 2) * term for n, term in enumerate(terms) if n % 2 == odd) for odd in (0, 1)]
    return round(parts[0] * DIRECTION_SCALE), round(parts[1] * DIRECTION_SCALE)


def turned(vector: Span, angle: int) -> Span:
    """Return DIRECTION_SCALE times a vector of the robot frame in the map frame."""
    (east, north), (cosine, sine) = vector, direction(angle)
    return east * cosine - north * sine, east * sine + north * cosine


class Sampling:
    """The squares that each field samples at one orientation: offsets from the robot's square, map frame."""

    def __init__(self, angle: int) -> None:
        self.angle = angle
        self.weights: list[dict[Spot, int]] = []  # of each field: how often it samples each square
        self.slack: list[int] = []  # of each field: how many of its samples fall between two squares
        for east, north, side in FIELD_OFFSETS:
            squares = [self.under(e, n) for e in range(east, east + side) for n in range(north, north + side)]
            sure = [square for square in squares if square is not None]
            self.weights.append({square: sure.count(square) for square in sure})
            self.slack.append(len(squares) - len(sure))

    def under(self, east: int, north: int) -> Spot | None:
        """Return the square under an offset, itself as an offset; None where that falls between two squares."""
        x, y = turned((east, north), self.angle)
        (i, a), (j, b) = (
            divmod(x + DIRECTION_SCALE // 2, DIRECTION_SCALE),
            divmod(y + DIRECTION_SCALE // 2, DIRECTION_SCALE),
        )
        return (i, j) if min(a, b) > TIE_ERROR and max(a, b) < DIRECTION_SCALE - TIE_ERROR else None


def parsed(text: str) -> Any:
    """Return the value of a JSON text, with exact numbers; raises ValueError, also when a key occurs twice."""

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        if len(dict(pairs)) < len(pairs):
            raise ValueError("a key occurs twice")
        return dict(pairs)

    def exact(number: str) -> Fraction:
        if len(number.lower().partition("e")[2]) > MAX_EXPONENT_DIGITS:
            raise ValueError("a number is too long")
        return Fraction(number)

    return json.loads(text, parse_float=exact, parse_constant=Fraction, object_pairs_hook=unique)


class Evidence:
    """The impressions and commands of an episode, and its task: nothing else of it is read."""

    def __init__(self, text: str) -> None:
        head, *rows = (parsed(row) for row in text.split("\n")[:-1])
        if (head["utak"], head["version"]) != ("episode", 1):
            raise ValueError("it is no episode of version 1")
        self.goals, self.kinds = head["task"]["goals"], head["task"]["parameters"]
        self.claims = [str(fact) for fact, _ in head["task"]["claims"]]
        steps = [row for row in rows if "result" not in row]
        self.actions, self.touches = [row["action"] for row in steps], [row["touch"] for row in steps]
        self.ranges: dict[tuple[int, int], list[int]] = {}  # of each (step, field): least and greatest count
        for k, f in product(range(len(steps)), SAMPLED_FIELDS):
            self.ranges[k, f] = LEVEL_RANGES[FIELD_OFFSETS[f][2], steps[k]["retina"][f]]
        self.last = len(steps) - 1
        moves = [action for action in self.actions if action and action["do"] == "move"]
        self.parts = lcm(*(Fraction(move[part]).denominator for move in moves for part in ("east", "north")))
        self.unit = 2 * self.parts * DIRECTION_SCALE * PLACE_PARTS  # a square: all lengths are whole numbers
        self.error = self.unit // PLACE_PARTS
        if [row["step"] for row in steps] != list(range(len(steps))) or {*map(len, self.touches)} != {len(TOUCH_NAMES)}:
            raise ValueError("its steps are not whole")
        altered = [key for key in ("forked", "changes") if key in head]  # axiom 3
        altered += ["noise"] * (head["options"]["noise"] != 0) + ["rules"] * (head["options"]["kb"] != [])
        altered += ["disturbances"] * any("disturbed" in row for row in steps)
        self.hindrance = ", ".join(altered)  # why nothing is said of where the robot is; "" for no reason

    def motion(self, step: int, angle: int) -> Span:
        """Return the vector, map frame, by which the command of a step was to move a robot with empty hands."""
        action = self.actions[step]
        if action["do"] == "grasp" and self.touches[step - 1][TOUCH_NAMES.index(action["direction"])] is not None:
            refuse(f"step {step}: the robot may have grasped something; where it is then no certificate says")
        if action["do"] != "move":
            return 0, 0
        east, north = (int(Fraction(action[part]) * self.parts) for part in ("east", "north"))
        x, y = turned((east, north), angle)
        return 2 * PLACE_PARTS * x, 2 * PLACE_PARTS * y


def sum_of(one: Span, other: Span) -> Span:
    """Return the interval of all sums."""
    return one[0] + other[0], one[1] + other[1]


def common(one: Span, other: Span) -> Span:
    """Return the common part of two intervals; its ends are in reverse order where there is none."""
    return max(one[0], other[0]), min(one[1], other[1])


def grown(interval: Span, by: int) -> Span:
    """Return an interval made longer at both ends."""
    return interval[0] - by, interval[1] + by


def side_of(number: int, unit: int) -> Span:
    """Return the range of the coordinates of a row or column of squares."""
    return number * unit, (number + 1) * unit


def stretched(interval: Span, by: int) -> Span:
    """Return the interval through which an interval leads that is moved."""
    return interval[0] + min(by, 0), interval[1] + max(by, 0)


def touched(interval: Span, unit: int) -> range:
    """Return the rows or columns of squares in whose inside an interval has a part."""
    return range(interval[0] // unit, -(-interval[1] // unit))


def sweep(x: Span, y: Span, vector: Span, unit: int) -> frozenset[Spot]:
    """Return the squares through whose inside a point leads that starts anywhere in a box."""
    (dx, dy), columns, rows = vector, touched(stretched(x, vector[0]), unit), touched(stretched(y, vector[1]), unit)
    if len(columns) * len(rows) > MAX_SWEPT_SQUARES:
        refuse("a command leads further than the checker looks")
    lane, square = ([b * dx - a * dy for a, b in product(*sides)] for sides in ((x, y), ((0, unit), (0, unit))))
    low, high = min(lane) - max(square), max(lane) - min(square)
    return frozenset((i, j) for i, j in product(columns, rows) if low < (j * dx - i * dy) * unit < high)


class Course(NamedTuple):
    """A course that the run may have taken: how the grid lies, and where the robot stood after each command."""

    angle: int  # degrees by which the robot's north is turned against the grid, counter-clockwise positive
    waking: Zone  # the point of waking
    occupied: dict[Spot, bool]  # the squares that are settled: occupied or free
    squares: tuple[Spot, ...] = ((0, 0),)  # the square of the robot, at each step
    ways: tuple[Zone, ...] = (((0, 0), (0, 0)),)  # at each step, from the point of waking
    swept: tuple[frozenset[Spot], ...] = ()  # the squares through which each command may have led

    @property
    def step(self) -> int:
        """The number of the newest impression."""
        return len(self.squares) - 1

    def ends(self, episode: Evidence) -> dict[Spot, "Course"]:
        """Return the case after the next command, for each square in which that may have ended."""
        unit, error, vector = episode.unit, episode.error, episode.motion(self.step + 1, self.angle)
        if not any(vector):
            return {self.squares[-1]: self.after(self.squares[-1], [self.ways[-1]], frozenset(), episode)}
        sums = [sum_of(w, d) for w, d in zip(self.waking, self.ways[-1], strict=True)]
        place = [common(grown(p, 2 * error), side_of(q, unit)) for p, q in zip(sums, self.squares[-1], strict=True)]
        swept = sweep(place[0], place[1], vector, unit)
        barred = {square for square in swept if self.occupied.get(square, True)}
        found: dict[Spot, list[Zone]] = {}
        whole = zip(place, self.ways[-1], vector, strict=True)
        ends = [[(sum_of(p, (v, v)), sum_of(d, (v, v)), error) for p, d, v in whole]]
        steps = [sorted({0, (v > 0) - (v < 0)}) for v in vector]
        for square in swept:  # a motion may have been stopped where it would have gone on in an occupied square
            if any((square[0] + a, square[1] + b) in barred for a, b in product(*steps)):
                parts = []
                for p, q, v, d, w in zip(place, square, vector, self.ways[-1], self.waking, strict=True):
                    at = common(stretched(p, v), side_of(q, unit))
                    way = common(stretched(d, v), grown((at[0] - w[1], at[1] - w[0]), error))
                    parts.append((at, way, 0 if v else error))
                ends.append(parts)
        for (x, dx, ex), (y, dy, ey) in ends:
            for square in product(touched(grown(x, ex), unit), touched(grown(y, ey), unit)):
                found.setdefault(square, []).append((dx, dy))
        return {square: self.after(square, ways, swept, episode) for square, ways in sorted(found.items())}

    def after(self, end: Spot, ways: list[Zone], swept: frozenset[Spot], episode: Evidence) -> "Course":
        """Return the case after one more command, which ended in a square by one of some ways."""
        sides = [grown(side_of(number, episode.unit), episode.error) for number in end]
        x, y = (self.axis(n, sides[n], [way[n] for way in ways]) for n in (0, 1))
        squares, all_ways = (*self.squares, end), (*self.ways, (x[0], y[0]))
        return Course(self.angle, (x[1], y[1]), dict(self.occupied), squares, all_ways, (*self.swept, swept))

    def axis(self, n: int, within: Span, ways: list[Span]) -> Zone:
        """Return the way, which is one of some, and the point of waking, along one axis, by where the way ends."""
        waking = self.waking[n]
        way = common((min(ways)[0], max(way[1] for way in ways)), (within[0] - waking[1], within[1] - waking[0]))
        return way, common(waking, (within[0] - way[1], within[1] - way[0]))

    def replayed(self, episode: Evidence) -> "Course | None":
        """Return the case with its ways by all that is settled now; None where a command cannot have ended so."""
        again: Course | None = Course(self.angle, self.waking, self.occupied)
        for square in self.squares[1:]:
            again = again and again.ends(episode).get(square)
        return again

    def settle(self, episode: Evidence, samples: Sampling, terms: list[tuple[int, int, int]]) -> bool:
        """Settle squares by a sum of counts, (step, field, multiplier) each; return whether no count fits it."""
        weights: dict[Spot, int] = {}
        least = most = 0  # of the sum over the squares that are sampled for sure
        for step, field, multiplier in terms:
            counts = episode.ranges.get((step, field)) if step <= self.step else None
            ends = [multiplier * n for n in counts or refuse("a count is of no field of an impression so far")]
            least += min(ends) - max(multiplier * samples.slack[field], 0)
            most += max(ends) - min(multiplier * samples.slack[field], 0)
            for (i, j), weight in samples.weights[field].items():
                square = self.squares[step][0] + i, self.squares[step][1] + j
                weights[square] = weights.get(square, 0) + multiplier * weight
        low = sum(weight for square, weight in weights.items() if self.occupied.get(square, weight < 0))
        high = sum(weight for square, weight in weights.items() if self.occupied.get(square, weight > 0))
        for square, weight in [(at, weight) for at, weight in weights.items() if at not in self.occupied and weight]:
            if low + abs(weight) > most:  # it counts as little as it can
                self.occupied[square] = weight < 0
            elif high - abs(weight) < least:  # as much as it can
                self.occupied[square] = weight > 0
        return low > most or high < least


def waking_case(angle: int, episode: Evidence) -> Course:
    """Return the case of waking with one orientation of the grid."""
    return Course(angle, (side_of(0, episode.unit),) * 2, {})


def goal_of(text: str) -> Shown:
    """Return a goal of the task."""
    found = SHOWN_GOAL.fullmatch(text) or refuse(f"certificates show nothing of {text}")
    kind = next(kind for kind in ("corner", "circled", "thing") if found[kind])
    return "start" if found[kind] == "start" else kind, found[kind], (found["order"] or "").rstrip("(")


def claims_taken(episode: Evidence, name: str, letter: str) -> list[str]:
    """Return what the task claims of a thing and a touch of this colour does not show."""
    about = [fact for fact in episode.claims if re.search(rf"\b{name}\b", fact)]
    return [fact for fact in about if fact != f"colour({name},{letter})"]


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
        self.texts = [goal for goal in episode.goals if not goal.startswith("prefer(")]
        if self.claim == "impossible":
            self.texts = [text for text in self.texts if BARRED_GOAL.fullmatch(text)][:1]
        if head != ["certificate", 1, self.claim, episode.goals] or self.claim not in VERDICTS_SHOWN or not self.texts:
            refuse("it is no certificate of version 1, of goals of the episode that certificates show")
        self.goals = [goal_of(text) if self.claim == "done" else ("shut_in", "", "") for text in self.texts]
        if not are_whole(self.steps, len(self.goals)) or not all(0 <= k <= self.episode.last for k in self.steps):
            refuse("it has not one step for each goal")
        ordered = [k for k, goal in zip(self.steps, self.goals, strict=True) if goal[2]]
        others = {k for k, goal in zip(self.steps, self.goals, strict=True) if not goal[2]}
        if ordered != sorted(ordered) or others - {self.episode.last}:
            refuse("its steps are not in the order of the task, or a goal does not hold at the end")
        taken = self.check_meaning() + OF_WALLS * (self.claim == "impossible")
        if self.given not in (taken, [*taken, ALONG_GRID]):
            refuse(f"what it is given must be {json.dumps(taken)}, and perhaps {ALONG_GRID}")

    def check_meaning(self) -> list[str]:
        """Return the claims of the task about things that are taken to be so; refuse unless each thing was felt."""
        named = [name for kind, name, _ in self.goals if kind in ("thing", "circled")]
        if not isinstance(self.meaning, dict) or list(self.meaning) != list(dict.fromkeys(named)):
            refuse("it must say what was felt of each thing that the goals name, and of no other")
        taken, letters = dict[str, str](), list[str]()  # a claim: the name of the thing; colours
        for name, felt in self.meaning.items():
            if not are_whole(felt, 2) or not (0 <= felt[0] <= self.episode.last and 0 <= felt[1] < len(TOUCH_NAMES)):
                refuse("what was felt is named by a step and a touch")
            letters.append(self.episode.touches[felt[0]][felt[1]] or VERGE_LETTER)
            if self.episode.kinds.get(name) != "object" or letters[-1] == VERGE_LETTER:
                refuse(f"{name} is no object of the task, or no thing was felt")
            taken.update(dict.fromkeys(claims_taken(self.episode, name, letters[-1]), str(name)))
        if len(set(letters)) < len(letters) or any(fact.startswith(f"colour({name},") for fact, name in taken.items()):
            refuse("two things of one colour may be one, or a thing is of another colour than the task claims")
        things = [(k, name) for k, (kind, name, _) in zip(self.steps, self.goals, strict=True) if kind == "thing"]
        if any(self.meaning[name][0] != k for k, name in things):
            refuse("a thing was not felt at the step of its goal")
        return list(taken)

    def check(self) -> str:
        """Return what is shown, in words; refuse when the claim does not follow."""
        if any(kind != "thing" for kind, _, _ in self.goals):
            self.check_cases()
        elif self.lines != []:
            refuse("its goals need no cases, and it has some")
        shown = [f"{text} at step {step}" for text, step in zip(self.texts, self.steps, strict=True)]
        means = [f"{name} is the thing felt at step {k}, touch {n}" for name, (k, n) in self.meaning.items()]
        return f"{self.claim}: {', '.join([*shown, *means])}" + "; given " * bool(self.given) + ", ".join(self.given)

    def check_cases(self) -> None:
        """Refuse unless each orientation of the grid and each end of each command is shut or shows the goals."""
        if self.episode.hindrance or not isinstance(self.lines, list):
            refuse(f"nothing is said of where the robot is in an episode with {self.episode.hindrance}")
        angle, angles, samples, shown = -1, 1 if ALONG_GRID in self.given else RIGHT_ANGLE, Sampling(0), 0
        left: list[dict[Spot, Course]] = []  # of each step: the ends of the command that are still to be treated
        case: Course | None = None  # the one that is treated now; None where the next line must begin one
        for number, line in enumerate(self.lines):
            word, args = (line[0], line[1:]) if isinstance(line, list) and line else ("", [])
            if word == "count" and case and all(are_whole(term, 3) for term in args):
                case = None if case.settle(self.episode, samples, args) else case
            elif word == "replay" and case and not args:
                case = case.replayed(self.episode)
            elif word == "holds" and case and not args and case.step == self.episode.last:
                for text, goal, step in zip(self.texts, self.goals, self.steps, strict=True):
                    if not self.holds(goal, case, step, samples):
                        refuse(f"line {number}: {text} may not hold")
                case, shown = None, shown + 1
            elif word == "angle" and not case and not left and args == [angle + 1] and angle + 1 < angles:
                angle, samples, case = angle + 1, Sampling(angle + 1), waking_case(angle + 1, self.episode)
            elif word == "end" and are_whole(args, 2) and (left if case is None else case.step < self.episode.last):
                if case:
                    left.append(case.ends(self.episode))
                case = left[-1].pop((args[0], args[1]), None) or refuse(f"line {number}: the command cannot end there")
            else:
                refuse(f"line {number}: it is no line that may stand here")
            while not case and left and not left[-1]:
                left.pop()
        if case or left or angle != angles - 1 or not shown:
            refuse("it ends before all cases are treated, or the episode agrees with no world")

    def holds(self, goal: Shown, case: Course, step: int, samples: Sampling) -> bool:
        """Return whether a goal holds at a step of a case for sure."""
        kind, name, _ = goal
        if kind == "start":
            return case.squares[step] == (0, 0) or all(
                abs(d) <= self.episode.unit for way in case.ways[step] for d in way
            )
        if kind == "shut_in":
            return self.is_shut_in(case, samples)
        if kind == "circled":
            return self.is_circled(name, case, step, samples)
        return kind == "thing" or self.is_corner(name, case, step, samples)

    def is_corner(self, name: str, case: Course, step: int, samples: Sampling) -> bool:
        """Return whether the robot is in the corner square of the known floor that is furthest towards a corner."""
        (u, v), square = turned(CORNERS[name], case.angle), case.squares[step]  # the direction of the corner, map frame
        ahead = (square[0] + 2 * (u > 0) - 1, square[1]), (square[0], square[1] + 2 * (v > 0) - 1)

        def reach(at: Spot) -> int:
            return u * (at[0] + (u > 0)) + v * (at[1] + (v > 0))

        is_furthest = all(reach(at) <= reach(square) for at in case.squares[: step + 1])
        if not (u and v and is_furthest and all(map(case.occupied.get, ahead))) or case.occupied.get(square, True):
            return False
        for (k, field), (_, most) in self.episode.ranges.items():
            (i, j), squares = case.squares[min(k, step)], samples.weights[field] if k <= step else {}
            beyond = [weight for (a, b), weight in squares.items() if reach((i + a, j + b)) > reach(square)]
            if sum(beyond) > most:
                return False  # not all of these are occupied: floor is known further on
        return True

    def is_circled(self, name: str, case: Course, step: int, samples: Sampling) -> bool:
        """Return whether the track ends where it began and winds about a thing."""
        felt, touch = self.meaning[name]
        offset, track = samples.under(*TOUCH_OFFSETS[touch]), [(x[0], y[0]) for x, y in case.ways[: step + 1]]
        is_exact = all(low == high for way in case.ways[: step + 1] for low, high in way)
        if offset is None or not is_exact or any(track[-1]):
            return False
        thing = case.squares[felt][0] + offset[0], case.squares[felt][1] + offset[1]
        if any(thing in swept for swept in (*case.swept[:step], case.squares[: step + 1])):
            return False  # the track may lead through the square in which the thing was felt
        unit = self.episode.unit
        x, y = ((2 * t + 1) * unit // 2 - sum(w) // 2 for t, w in zip(thing, case.waking, strict=True))
        winding = 0
        for (x0, y0), (x1, y1) in zip(track, [*track[1:], track[0]], strict=True):
            if (y0 <= y) != (y1 <= y):
                left = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
                winding += (left > 0 and y1 > y0) - (left < 0 and y1 < y0)
        return winding != 0

    def is_shut_in(self, case: Course, samples: Sampling) -> bool:
        """Return whether verge was felt on all sides of a rectangle of floor and things about the square of waking."""
        felt: dict[Spot, str | None] = {}
        for (i, j), touches in zip(case.squares, self.episode.touches, strict=True):
            for offset, letter in zip(TOUCH_OFFSETS, touches, strict=True):
                if under := samples.under(*offset):
                    felt[i + under[0], j + under[1]] = letter
        walls = {square for square, letter in felt.items() if letter == VERGE_LETTER} or {(0, 0)}
        (w, e), (s, n) = ((min(line), max(line)) for line in zip(*walls, strict=True))
        edge = {*product((w, e), range(s + 1, n)), *product(range(w + 1, e), (s, n))}
        rim = {*product((w + 1, e - 1), range(s + 1, n)), *product(range(w + 1, e), (s + 1, n - 1))}
        is_rim = all(square in felt or not case.occupied.get(square, True) for square in rim)
        return edge <= walls <= {*edge, *product((w, e), (s, n))} and is_rim and w < 0 < e and s < 0 < n


def verify(episode: str, certificate: str) -> str:
    """Return what a certificate shows of an episode, in words, from the texts of both files.

    Raises RefusedError when the claim does not follow, ValueError when a text is no JSON or no episode.
    """
    try:
        return CertificateCheck(Evidence(episode), parsed(certificate)).check()
    except (LookupError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        raise ValueError(f"it is damaged: {type(error).__name__}: {error}") from None
