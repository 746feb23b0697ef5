"""What may have happened when a look contradicts what is believed and something is in hand."""

import shapely

from kb.body import Push
from kb.evidence import Evidence
from kb.heading import Hypothesis, Look, search
from kb.lattice import CENTRE, Lattice
from kb.loads import Load
from kb.retina import count_ranges
from kb.supposing import Surprise
from tests.kb.eyes import retina, world_of

ROOM = ["b" * 40, *["b" + "." * 38 + "b"] * 24, "b" * 40]
NEARLY = tuple(Hypothesis(angle, CENTRE + CENTRE) for angle in (0, -1, 1))


def test_lattices_are_not_given_up_for_a_push_that_was_cut_short() -> None:
    room = world_of(ROOM)
    with_thing = [world_of(_with_thing(east)) for east in (12, 16)]
    before, after = (count_ranges(retina(world, (east, 10))) for world, east in zip(with_thing, (10, 14), strict=True))
    evidence = Evidence()
    evidence.look(Lattice().samples(), count_ranges(retina(room, (10, 10))), 0, 0, 0)
    thing = shapely.box(2, 0, 5, 3)
    surprise = Surprise(
        Push(10.0, 0.0),
        after,
        Lattice(),
        CENTRE,
        evidence,
        [Look(before, (0.0, 0.0))],
        {"o1": Load("o1", thing, thing)},
        "o1",
        NEARLY,
    )
    assert search(surprise._recent, NEARLY, surprise._unsettled) == ()  # by where the whole push would have led
    assert surprise._left() == NEARLY


def _with_thing(east: int) -> list[str]:
    """The room, and a thing 3 squares wide and high whose lower left square is (east, 10)."""
    rows = [list(row) for row in ROOM]
    for row in range(10, 13):
        rows[len(rows) - 1 - row][east : east + 3] = "ggg"
    return ["".join(row) for row in rows]
