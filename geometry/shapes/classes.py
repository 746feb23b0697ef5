"""The classes of shapes: one row for each, from which all that geometry knows about a class is made.

A class is a union of rectangles whose sides are linear in four sizes, in squares: the width W and the height H of the
rectangle that holds the shape, the thickness F of its foot, and the thickness S of its stem. S is for rows whose arms
may have two thicknesses, as those of an L; all others have F alone. Turns of a shape are tried, its mirror image is
not: a class that has one of its own has two rows of one name. A triangle (three corners) and a disc (centre, radius)
have forms of their own.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Floats

Size = Floats  # (4,) coefficients of W, H, F, S
W, H, F, S = np.eye(4)
O = np.zeros(4)  # noqa: E741 - the origin
RECTANGLES, TRIANGLE, DISC = 0, 1, 2  # forms of the numbers of a shape
MIN_BRICK_RATIO = 1.15  # length by width; convention: a brick is at least so much longer than wide


class ShapeClass(NamedTuple):
    """A class of shapes."""

    name: str
    form: int = RECTANGLES
    # Rectangles (west, south, east, north) that together are the shape, about the middle of the one that holds it
    pieces: tuple[tuple[Size, Size, Size, Size], ...] = ()
    corners: tuple[tuple[Size, Size], ...] = ()  # of the outline, counter-clockwise, lower left at the origin
    # Lengths that vanish where it would be of another class: sides, arms, gaps and notches; each at least MIN_FEATURE
    features: tuple[Size, ...] = ()
    min_ratio: float = 0.0  # the longer side by the shorter one, at least
    turns: int = 4  # quarter turns that look different: 1 where one looks the same, 2 where two do (whatever the sizes)

    def depends_on(self, size: Size) -> bool:
        """Return whether the rectangles of the class depend on one of the four sizes: W, H, F or S."""
        return bool(np.any(np.reshape(self.pieces, (-1, 4)) @ size))


_FOOT = (-W / 2, -H / 2, W / 2, F - H / 2)
# Of rows that agree equally well with whole squares, the first one counts: those with fewer parameters stand first,
# then as the eye prefers them (convention).
CLASSES = (
    ShapeClass("square", RECTANGLES, ((-W / 2, -W / 2, W / 2, W / 2),), ((O, O), (W, O), (W, W), (O, W)), (W,), 0.0, 1),
    ShapeClass(
        "brick",
        RECTANGLES,
        ((-W / 2, -H / 2, W / 2, H / 2),),
        ((O, O), (W, O), (W, H), (O, H)),
        (W, H),
        MIN_BRICK_RATIO,
        1,
    ),
    ShapeClass("disc", DISC, turns=1),
    ShapeClass("triangle", TRIANGLE),
    ShapeClass(
        "l_shape",
        RECTANGLES,
        (_FOOT, (-W / 2, -H / 2, S - W / 2, H / 2)),
        ((O, O), (W, O), (W, F), (S, F), (S, H), (O, H)),
        (W, H, F, H - F, W - S, S),
    ),
    ShapeClass(
        "t_shape",
        RECTANGLES,
        (_FOOT, (-F / 2, -H / 2, F / 2, H / 2)),
        (
            *((O, O), (W, O), (W, F), ((W + F) / 2, F)),
            *(((W + F) / 2, H), ((W - F) / 2, H), ((W - F) / 2, F), (O, F)),
        ),
        (W, H, F, H - F, (W - F) / 2, (W - F) / 2, F),
    ),
    ShapeClass(
        "u_shape",
        RECTANGLES,
        (_FOOT, (-W / 2, -H / 2, F - W / 2, H / 2), (W / 2 - F, -H / 2, W / 2, H / 2)),
        ((O, O), (W, O), (W, H), (W - F, H), (W - F, F), (F, F), (F, H), (O, H)),
        (W, H, F, H - F, W - 2 * F, F),
    ),
)
