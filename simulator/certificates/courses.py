"""Courses that a run may have taken, by its impressions and commands alone, as docs/certificates.md says.

Of a certificate this is what its lines rest on, and `checker` is the rest. Both import nothing else of ours.
"""

import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import accumulate, product
from math import isqrt, lcm
from typing import Any, NamedTuple, NoReturn

FIELD_ZONES = ((4, 0, 1), (8, 4, 2), (16, 8, 4))  # of the retina: reach, reach of the one within, side of fields
FIELD_OFFSETS = [  # of the retina, in order: the offset (east, north) of the south-west square, and the side
    (east, north, side)
    for reach, inner, side in FIELD_ZONES
    for north, east in product(range(reach - side, -reach - 1, -side), range(-reach, reach, side))
    if min(east, north) < -inner or max(east, north) >= inner
]
SAMPLED_FIELDS = {*range(len(FIELD_OFFSETS))} - {FIELD_OFFSETS.index((0, 0, 1))}  # the robot always fills its square
LEVEL_RANGES: dict[tuple[int, int], list[int]] = {}  # (side, gray level): least and greatest count of occupied squares
for k, n in [(1, n) for n in range(2)] + [(2, n) for n in range(5)] + [(4, n) for n in range(17)]:
    LEVEL_RANGES.setdefault((k, (14 * n + k * k) // (2 * k * k)), [n, n])[1] = n
COMMAND_WORDS = ("move", "push", "turn", "grasp", "release")
TOUCH_NAMES = ("north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest")
TOUCH_OFFSETS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))  # (east, north), in this order
VERGE_LETTER = "b"  # the colour of what bounds the floor
PI_DECIMALS = Fraction("3.14159265358979323846264338327950288")
DIRECTION_SCALE = 10**18  # cosines and sines are whole numbers of so small parts
TIE_ERROR = DIRECTION_SCALE // 10**9  # so near to the middle between two squares either may be sampled (axiom 2)
PLACE_PARTS = 10**6  # of a square: one of them is more than a command may lead beside its way (axiom 4)
MILLION = 10**6  # a whole risk
LN_4 = Fraction("1.3863")  # the logarithm of 4, rounded up
MAX_SQUARES = 20000  # of one command, or in which a thing lies; a bound on time
MAX_EXPONENT_DIGITS = 4  # with the sign; a bound on time

Spot = tuple[int, int]
Spots = frozenset[Spot]
Span = tuple[int, int]  # least and greatest; or x and y of a vector
Zone = tuple[Span, Span]  # a range of x and a range of y, map frame; `Evidence.unit` is a square
Key = tuple[int, int, int]  # a square, and the step since which nothing was carried through it


class RefusedError(Exception):
    """The claim of a certificate does not follow by what the certificate says; the message tells why."""


def refuse(why: str) -> NoReturn:
    """Raise RefusedError."""
    raise RefusedError(why)


@cache
def direction(angle: int) -> Span:
    """Return DIRECTION_SCALE times cosine and sine of whole degrees, from 0 to 90, rounded, by their series."""
    turn = PI_DECIMALS * angle / 180
    terms = [*accumulate(range(1, 30), lambda term, n: term * turn / n, initial=Fraction(DIRECTION_SCALE))]
    parts = [sum((-1) ** (n // 2) * term for n, term in enumerate(terms) if n % 2 == odd) for odd in (0, 1)]
    return round(parts[0]), round(parts[1])


def turned(east: int, north: int, angle: int) -> Span:
    """Return DIRECTION_SCALE times a vector of the robot frame in the map frame."""
    cosine, sine = direction(angle)
    return east * cosine - north * sine, east * sine + north * cosine


def under(east: int, north: int, angle: int) -> Spot | None:
    """Return the square under an offset, itself as an offset; None where that falls between two squares."""
    (i, a), (j, b) = (divmod(part + DIRECTION_SCALE // 2, DIRECTION_SCALE) for part in turned(east, north, angle))
    return (i, j) if min(a, b) > TIE_ERROR and max(a, b) < DIRECTION_SCALE - TIE_ERROR else None


@cache
def sampled(angle: int) -> list[tuple[dict[Spot, int], int]]:
    """Return of each field how often it samples each square, an offset, and how often it falls between two."""
    offsets = [product(range(east, east + side), range(north, north + side)) for east, north, side in FIELD_OFFSETS]
    fields = [[under(e, n, angle) for e, n in field] for field in offsets]
    return [(dict(Counter(square for square in field if square)), field.count(None)) for field in fields]


def parsed(text: str) -> Any:
    """Return the value of a JSON text, with exact numbers; raises ValueError."""

    def exact(number: str) -> Fraction:
        return Fraction(number if len(number.lower().partition("e")[2]) <= MAX_EXPONENT_DIGITS else "too long")

    return json.loads(text, parse_float=exact, parse_constant=Fraction)


class Evidence:
    """The impressions and commands of an episode, and its task: nothing else of it is read."""

    def __init__(self, text: str) -> None:
        head, *rows = (parsed(row) for row in text.split("\n")[:-1])
        if (head["utak"], head["version"]) != ("episode", 1):
            raise ValueError("it is no episode of version 1")
        self.goals, self.kinds = head["task"]["goals"], head["task"]["parameters"]
        self.claims = [str(fact) for fact, _ in head["task"]["claims"]]
        steps = rows[:-1] if rows and "result" in rows[-1] else rows
        self.actions, self.touches = [row["action"] for row in steps], [row["touch"] for row in steps]
        fields = product(range(len(steps)), SAMPLED_FIELDS)
        self.ranges = {(k, f): LEVEL_RANGES[FIELD_OFFSETS[f][2], steps[k]["retina"][f]] for k, f in fields}
        self.last = len(steps) - 1
        is_told = all(row["do"] in COMMAND_WORDS if k else row is None for k, row in enumerate(self.actions))
        numbers = [None if "result" in row else row["step"] for row in steps] == list(range(len(steps)))
        if not (steps and numbers and is_told and {*map(len, self.touches)} == {len(TOUCH_NAMES)}):
            raise ValueError("its steps are not whole")
        ways = [[Fraction((row or {}).get(part, 0)) for part in ("east", "north")] for row in self.actions]
        parts = 2 * PLACE_PARTS * lcm(*(number.denominator for way in ways for number in way))
        self.ways = [(int(east * parts), int(north * parts)) for east, north in ways]  # of commands, robot frame
        self.unit = DIRECTION_SCALE * parts  # a square: all lengths are whole numbers
        self.hindrance = [key for key in ("forked", "changes", "disturbed") if key in {*head}.union(*steps)]  # axiom 3
        self.hindrance += ["kb"] * (head["options"]["kb"] != [])
        noise = head["options"]["noise"]
        if isinstance(noise, bool) or noise < 0:
            raise ValueError("its noise is no number from 0 on")
        self.noise = Fraction(noise)

    def allow(self, risk: int, is_single: bool = False) -> None:
        """Take a risk, in millionths, that noise leads a command further beside its end than is worked out here.

        is_single : it is given, besides, that no two things are of one colour.
        """
        self.risk, self.errors, self.is_single = risk, [0] * len(self.ways), is_single
        for k, (east, north) in enumerate(self.ways if risk else ()):
            bits = (MILLION * k * (k + 1) // risk).bit_length()  # a chance of 2^-bits is less than this command's part
            way = Fraction(isqrt(int(self.noise**2 * bits * LN_4 * MILLION**2)) + 1, MILLION)  # of a way of 1
            self.errors[k] = int((isqrt(east**2 + north**2) + 1) * DIRECTION_SCALE * way * (1 + way / 5))


def cut(interval: Span, number: int, unit: int) -> Span:
    """Return the part of an interval within a row or column of squares; its ends are in reverse order where none is."""
    return max(interval[0], number * unit), min(interval[1], (number + 1) * unit)


def led(interval: Span, by: int, error: int) -> Span:
    """Return the interval through which an interval leads that is moved, longer by an error at both ends."""
    return interval[0] + min(by, 0) - error, interval[1] + max(by, 0) + error


def touched(box: Sequence[Span], unit: int) -> list[Spot]:
    """Return the squares in whose inside a box has a part."""
    columns, rows = (range(low // unit, -(-high // unit)) for low, high in box)
    return list(product(columns, rows)) if len(columns) * len(rows) <= MAX_SQUARES else refuse("it leads too far")


def sweep(box: Sequence[Span], vector: Span, unit: int) -> Spots:
    """Return the squares through whose inside a point leads that starts anywhere in a box."""
    dx, dy = vector
    lane, square = ([b * dx - a * dy for a, b in product(*sides)] for sides in (box, ((0, unit), (0, unit))))
    low, high = min(lane) - max(square), max(lane) - min(square)
    around = touched((led(box[0], dx, 0), led(box[1], dy, 0)), unit)
    return frozenset((i, j) for i, j in around if low < (j * dx - i * dy) * unit < high)


def spread(squares: Iterable[Spot], is_open: Callable[[Spot], bool]) -> Spots:
    """Return some squares and all that lead to them by edges over open squares, but ends once there are too many."""
    found, edge = {*squares}, [*squares]
    while edge and len(found) <= MAX_SQUARES:
        i, j = edge.pop()
        new = {at for at in {(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)} - found if is_open(at)}
        edge += new
        found |= new
    return frozenset(found)


class Course(NamedTuple):
    """A course that the run may have taken: how the grid lies, and where the robot stood after each command."""

    angle: int  # degrees by which the robot's north is turned against the grid, counter-clockwise positive
    occupied: dict[Key, bool]  # what is settled: occupied or free
    changes: dict[Spot, tuple[int, ...]]  # of squares through which something may have been carried: the steps
    places: tuple[Zone, ...]  # of the robot, at each step
    squares: tuple[Spot, ...] = ((0, 0),)  # of the robot, at each step
    swept: tuple[Spots, ...] = (frozenset(),)  # the squares through which each command may have led
    held: tuple[Spots, ...] = (frozenset(),)  # at each step: squares in which lies all that may be held

    @property
    def step(self) -> int:
        """The number of the newest impression."""
        return len(self.squares) - 1

    def key(self, square: Spot, step: int) -> Key:
        """Return the key of what a square is at a step."""
        return *square, next((k for k in reversed(self.changes.get(square, ())) if k <= step), 0)

    def at(self, square: Spot, step: int) -> bool | None:
        """Return whether a square is occupied at a step; None where that is not settled."""
        return self.occupied.get(self.key(square, step))

    def touch(self, step: int, touch: int) -> Spot | None:
        """Return the square of a touch; None where that falls between two squares."""
        (i, j), offset = self.squares[step], under(*TOUCH_OFFSETS[touch], self.angle)
        return offset and (i + offset[0], j + offset[1])

    def ends(self, episode: Evidence, only: Spot | None = None) -> dict[Spot, "Course"]:
        """Return the case after the next command, for each square in which that may have ended, or for one."""
        unit, error, here, place = episode.unit, episode.unit // PLACE_PARTS, self.squares[-1], self.places[-1]
        noise = episode.errors[self.step + 1]
        held = frozenset(square for square in self.held[-1] if self.at(square, self.step) is not False)
        word, found = episode.actions[self.step + 1]["do"], dict[Spot, list[Zone]]()
        is_led = word == ("push" if held else "move")
        vector = turned(*episode.ways[self.step + 1], self.angle) if is_led else (0, 0)  # map frame
        if held and word not in ("push", "release"):
            refuse(f"step {self.step + 1}: what may be held is not pushed or released")
        if not any(vector):
            if word == "grasp":
                held = self.piece(episode, self.step, TOUCH_NAMES.index(episode.actions[self.step + 1]["direction"]))
            return {here: self.after(here, place, Spots(), Spots() if word == "release" else held, Spots())}
        about = [led(side, 0, noise) for side in place]  # from here the vector leads over all squares that noise may
        swept = sweep(about, vector, unit)
        barred = {square for square in swept if self.at(square, self.step) is not False}
        ahead = list(product(*({0, (v > noise) - (v < noise), (v > -noise) - (v < -noise)} for v in vector)))
        boxes = [[led((p[0] + v, p[1] + v), 0, error) for p, v in zip(about, vector, strict=True)]]
        for square in swept:  # a motion may have been stopped where it would have gone on in an occupied square
            if held or any((square[0] + a, square[1] + b) in barred for a, b in ahead):
                ways = zip(about, vector, square, strict=True)
                boxes.append([led(cut(led(p, v, 0), k, unit), 0, 0 if v else error) for p, v, k in ways])
        for x, y in boxes:
            for square in touched((x, y), unit):
                found.setdefault(square, []).append((x, y))
        since = max(k for k, row in enumerate(episode.actions[: self.step + 1]) if not row or row["do"] == "grasp")
        taken = [square for square in self.held[since] if held and self.at(square, since) is not False]
        cases: dict[Spot, Course] = {}
        for square, ends in sorted(end for end in found.items() if only in (None, end[0])):
            low, high = ([side(end[n][k] for end in ends) for n in (0, 1)] for k, side in enumerate((min, max)))
            x, y = box = [cut((low[n], high[n]), square[n], unit) for n in (0, 1)]
            by = zip(box, self.places[since], strict=True)
            (a, b), (c, d) = ((now[0] - then[1] - error, now[1] - then[0] + error) for now, then in by)
            spans = [((i * unit + a, (i + 1) * unit + b), (j * unit + c, (j + 1) * unit + d)) for i, j in taken]
            after = frozenset(at for span in spans for at in touched(span, unit))
            cases[square] = self.after(square, (x, y), swept, after, held | after)
        return cases

    def after(self, end: Spot, box: Zone, swept: Spots, held: Spots, moved: Spots) -> "Course":
        """Return the case after one more command, which ended in a square, and carried something through others."""
        changes = {**self.changes, **{at: (*self.changes.get(at, ()), self.step + 1) for at in moved}}
        stays = {(*at, self.step + 1): True for at in moved - self.held[-1] if self.at(at, self.step)}
        rows = (*self.places, box), (*self.squares, end), (*self.swept, swept), (*self.held, held)
        return Course(self.angle, self.occupied | stays if stays else self.occupied, changes, *rows)

    def piece(self, episode: Evidence, step: int, touch: int) -> Spots:
        """Return the squares in which the thing lies that was felt: all about them are settled as free; () for none."""
        if episode.touches[step][touch] in (None, VERGE_LETTER):
            return frozenset()
        felt = self.touch(step, touch) or refuse("what was grasped was felt between two squares")
        within = Spots()
        for k, row in enumerate(episode.actions[1 : step + 1]):  # what was grasped before is as wide as it was
            one = (k, TOUCH_NAMES.index(row["direction"])) if row["do"] == "grasp" and not within else None
            if one and felt in self.covered(episode, one, step):
                within = self.extent(episode, one, step)[1]
        piece = spread([felt], within.__contains__) if within else self.unsettled([felt], step)
        return piece if len(piece) <= MAX_SQUARES else refuse(f"nothing bounds the thing felt at step {step}")

    def unsettled(self, squares: Iterable[Spot], step: int) -> Spots:
        """Return some squares and all that lead to them over squares that are not settled as free, if not too many."""
        return spread(squares, lambda at: self.at(at, step) is not False)

    def outline(self, episode: Evidence, felt: Spot) -> Spots:
        """Return the squares that the thing felt covers if nothing was held before; () where some are not settled."""
        is_early = felt[0] <= self.step and not any(self.held[: felt[0] + 1])
        piece = self.piece(episode, *felt) if is_early else frozenset[Spot]()
        return piece if all(self.at(square, felt[0]) for square in piece) else frozenset()

    def replayed(self, episode: Evidence) -> "Course | None":
        """Return the case with its places by all that is settled now; None where a command cannot have ended so."""
        again: Course | None = Course(self.angle, self.occupied, {}, self.places[:1])
        for square in self.squares[1:]:
            again = again and again.ends(episode, square).get(square)
        return again and again._replace(changes=self.changes, held=self.held)

    def settle(self, episode: Evidence, terms: list[tuple[int, int, int]]) -> bool:
        """Settle squares by a sum of counts, (step, field, multiplier) each; return whether no count fits it."""
        weights = Counter[Key]()
        least = most = 0  # of the sum over the squares that are sampled for sure
        for step, field, multiplier in terms:
            counts = episode.ranges.get((step, field)) if step <= self.step else None
            ends = [multiplier * n for n in counts or refuse("a count is of no field of an impression so far")]
            squares, slack = sampled(self.angle)[field]
            least += min(ends) - max(multiplier * slack, 0)
            most += max(ends) - min(multiplier * slack, 0)
            column, row = self.squares[step]
            for (i, j), weight in squares.items():
                weights[self.key((column + i, row + j), step)] += multiplier * weight
        low = sum(weight for key, weight in weights.items() if self.occupied.get(key, weight < 0))
        high = sum(weight for key, weight in weights.items() if self.occupied.get(key, weight > 0))
        for key, weight in [(key, weight) for key, weight in weights.items() if key not in self.occupied and weight]:
            is_least = low + abs(weight) > most  # it counts as little as it can, else as much
            if is_least or high - abs(weight) < least:
                self.occupied[key] = is_least == (weight < 0)
        return low > most or high < least

    def was_free(self, square: Spot) -> bool:
        """Return whether nothing covered a square at some step."""
        return any(self.occupied.get((*square, k)) is False for k in (0, *self.changes.get(square, ())))

    def grasps(self, episode: Evidence, felt: Spot, step: int) -> Iterator[tuple[int, int, Spot | None]]:
        """Yield of each grasp after a touch, up to a step, the last step with what it took in hand, and its square."""
        for k in range(felt[0] + 1, step + 1):
            if episode.actions[k]["do"] == "grasp":
                end = next((n for n in range(k, step) if not self.held[n + 1]), step)
                yield k, end, self.touch(k - 1, TOUCH_NAMES.index(episode.actions[k]["direction"]))

    def covered(self, episode: Evidence, felt: Spot | None, step: int) -> set[Spot]:
        """Return squares that the thing felt, or without a touch the robot, covers for sure at a step."""
        return self.followed(episode, felt, step)[0]

    def followed(self, episode: Evidence, felt: Spot | None, step: int) -> tuple[set[Spot], set[int]]:
        """Return what a thing, or the robot, covers for sure at a step, and the steps so far that moved it alone."""
        if felt is None:
            return {self.squares[step]}, set()
        own = [(felt[0], felt[1])]  # touches of it
        if episode.is_single:
            pairs, letter = product(range(step + 1), range(len(TOUCH_NAMES))), episode.touches[felt[0]][felt[1]]
            own += [(k, n) for k, n in pairs if episode.touches[k][n] == letter]
        moves, covered = set[int](), set[Spot]()
        for last, end, grasped in [*self.grasps(episode, felt, step), (step + 1, 0, None)]:
            spots = [(self.touch(k, n), k) for k, n in own if k < last]
            covered = {at for at, k in spots if at and self.key(at, k) == self.key(at, last - 1)}
            for square, changes in self.changes.items():  # what was free before covers what alone was moved since
                since = [0, *(k for k in changes if k < last)]
                free = [n for n, k in enumerate(since) if self.occupied.get((*square, k)) is False]
                if free and self.at(square, last - 1) and moves.issuperset(since[free[-1] + 1 :]):
                    covered.add(square)
            moves |= {*range(last + 1, end + 1)} if grasped in covered else set()
        return covered, moves

    def extent(self, episode: Evidence, felt: Spot | None, step: int) -> tuple[Spots, Spots]:
        """Return squares in which all lay of a thing, or the robot, on waking, and lies at a step; () where unknown."""
        if felt is None:
            return Spots([(0, 0)]), Spots([self.squares[step]])
        began = lies = self.piece(episode, *felt)
        if felt[0] > step or self.held[felt[0]] or any(self.key(at, felt[0])[2] for at in began):
            return Spots(), Spots()
        for _, end, spot in self.grasps(episode, felt, step):
            if spot in lies:  # where it covers a square that it did not, it was taken
                lies = self.held[end] | (Spots() if self.covered(episode, felt, end) - lies else lies)
        covered = self.covered(episode, felt, step)
        part = self.unsettled(covered, step)  # a thing is in one piece
        lies &= part if 0 < len(part) <= MAX_SQUARES else lies
        for n in (0, 1) if covered else ():  # it is as wide as it was
            size, numbers = 1 + max(at[n] for at in began) - min(at[n] for at in began), {at[n] for at in covered}
            lies = Spots(at for at in lies if max(numbers) - size <= at[n] <= min(numbers) + size)
        return began, Spots(at for at in lies if self.at(at, step) is not False)


def waking_case(angle: int, episode: Evidence) -> Course:
    """Return the case of waking with one orientation of the grid."""
    return Course(angle, {}, {}, (((0, episode.unit), (0, episode.unit)),))
