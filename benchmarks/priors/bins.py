"""Into which bins measures fall: the least and the greatest value of each, whole numbers, the bins without gaps.

The bins are a convention: narrow where what is counted changes quickly, and wide enough that each holds many things.
"""

from typing import NamedTuple

ANY = 1_000_000  # above all measures


class Bin(NamedTuple):
    """The values from `least` to `most`."""

    least: int
    most: int

    def holds(self, value: int) -> bool:
        """Return whether a value falls into the bin."""
        return self.least <= value <= self.most


def bins(*begin: int) -> tuple[Bin, ...]:
    """Return the bins that begin at some values, the last one open.

    >>> bins(0, 3)
    (Bin(least=0, most=2), Bin(least=3, most=1000000))
    """
    ends = [*(value - 1 for value in begin[1:]), ANY]
    return tuple(map(Bin, begin, ends))


def bin_of(value: int, among: tuple[Bin, ...]) -> Bin:
    """Return the bin into which a value falls."""
    return next(one for one in among if one.holds(value))


WHOLE = bins(0)
# By case of a region (kb/asp/interpretation.lp): bins of its mass, tenths of squares, for whether it is floor.
MASS = {"undecided": bins(0, 5, 15, 30, 60, 120), "isolated": bins(0, 5, 15, 30, 60, 120)}
# For whether it is an object: bins of its extent, squares, and of its mass. An island of the verge is small mostly.
EXTENT = {"undecided": bins(0, 3, 5, 7, 9, 13, 17, 25)}
OBJECT_MASS = {"isolated": bins(0, 30, 60)}
CASES = (
    *("bounding", "island", "own_colour", "isolated", "felt_verge", "felt_long", "undecided"),
    "cut",
)
# Of a thing: squares of misfit of its first class, how far that is ahead, open squares for each 100 sure ones.
MISFIT = bins(0, 1, 3)
# By the bin of misfit: those of the lead and of the open squares, fewer where few things fall.
LEAD = dict(zip(MISFIT, (bins(0, 1, 3), WHOLE, WHOLE), strict=True))
OPENNESS = dict(zip(MISFIT, (bins(0, 26, 101, 301), bins(0, 101), bins(0, 26, 101)), strict=True))
# Of a place where a thing may be (kb/asp/chances.lp), by its case: bins of its measure.
WHEREABOUT_MEASURE = {
    "likely": bins(0, 10, 20, 50),
    "other": WHOLE,
    "open": bins(0, 5, 15, 30),
    "closed": WHOLE,
    "door": WHOLE,
    "verge": WHOLE,
}
# Of pieces that touch, by what was felt on them: bins of the confidence in the class of their outline, percent.
JOINED = {"unfelt": bins(0, 75), "same": WHOLE}
# Of parts of the floor that unseen floor may join, by case: bins of its measure (kb/task/apart.py).
PASSAGE = {"near": bins(0, 2, 3), "further": WHOLE, "wall": bins(0, 30), "open": bins(0, 2, 3, 5), "shut": bins(0, 5)}
# Of stretches of what bounds the floor, by case: bins of their thickness, squares.
PLUG = {"slim": bins(0, 2, 3, 5), "broad": bins(0, 3, 5), "wide": bins(0, 3, 5)}
# Of the likeliest square in which the robot may stand, by case: bins of its share of the likelihood, thousandths.
STANDING = {"unsure": bins(0, 600, 900), "slips": bins(0, 600, 900), "unexplained": bins(0, 900)}
UNMOVED = bins(0, 1, 2)  # ways in which an object was tried that no motion has moved
# Of looks for what nobody saw, by their kind: bins of the squares never seen that come into sight.
LOOK = {"explore": bins(0, 50, 100, 200, 400), "settle": WHOLE, "pass": WHOLE}
NONE_MISFIT = bins(0, 3)  # squares of misfit of the first class, where that is not the true one
BEHIND = bins(0, 3)  # squares that another class leaves wrong beyond the first one
# Of facts about places, by case (kb/world/chances.py): bins of what was measured.
TOUCHING, ROOM = bins(0, 5, 20, 40, 60, 90), bins(0, 50, 60, 80, 95)
PLACES = {
    "adjacent_robot": bins(0, 20, 60),
    "adjacent_robot_unsure": bins(0, 20, 60),
    "adjacent_verge": TOUCHING,
    "adjacent_verge_unsure": TOUCHING,
    "adjacent_things": bins(0, 20, 60),
    "adjacent_things_unsure": bins(0, 20, 60),
    "in_robot": ROOM,
    "in_thing": ROOM,
    "door_walled": bins(0, 20, 60, 100, 200),
    "door_unwalled": bins(0, 20, 60, 100),
    "door_anew": bins(0, 60),
    "door_alone": bins(0, 4),
    "corner": bins(0, 10, 20, 50, 90),
    "corner_unsure": bins(0, 10, 20, 50, 90),
}
