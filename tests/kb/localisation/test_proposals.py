"""The table of proposals: which rows are asked, and that explaining changes nothing."""

import pytest

from tests.kb.drawings import walked
from tests.kb.eyes import impression, utak_in, world_of
from tests.kb.localisation.test_tracker import ROOM
from utak.kb.body import Command, Move, Turn
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.localisation.proposals import TABLE, explain
from utak.kb.localisation.propose import blocked, earlier_motion, frame, lifted, origin, others
from utak.kb.perception.retina import count_ranges


def after(command: Command, east: int, north: int) -> ObservedSituation:
    """Return the situation after a command, seen from some squares beside the place of waking."""
    (x, y), state = utak_in(ROOM), walked(ROOM, [(2, 0), (0, 3)]).knowledge.tracker.state
    return ObservedSituation(state, command, count_ranges(impression(world_of(ROOM), (x + east, y + north)).retina))


@pytest.mark.parametrize(
    ("residual", "asked"),
    [
        (0, [blocked.propose, frame.propose]),
        (
            1,
            [
                blocked.propose,
                blocked.propose_other_ends,
                frame.propose,
                earlier_motion.propose,
                origin.propose,
            ],
        ),
        (
            9,
            [
                blocked.propose,
                blocked.propose_other_ends,
                frame.propose,
                earlier_motion.propose,
                origin.propose,
                earlier_motion.propose_slips,
                others.propose,
                lifted.propose,
            ],
        ),
    ],
)
def test_more_is_asked_the_less_is_explained(residual: int, asked: list[object]) -> None:
    situation = after(Move(1.0, 0.0), 3, 3)
    whole = Explanation("predicted", (3.5, 3.5), situation.state.frame, residual, 0.0)
    situation = situation.having([whole])
    assert [propose for rows in TABLE for needed, propose in rows if needed(situation)] == asked


@pytest.mark.parametrize(
    ("command", "there", "how"),
    [(Move(0.0, 1.0), (2, 4), "predicted"), (Move(0.0, -9.0), (2, -3), "blocked"), (Turn(30.0), (2, 3), "predicted")],
)
def test_explaining_changes_nothing(command: Command, there: tuple[int, int], how: str) -> None:
    situation = after(command, *there)
    before = situation.state.occupancy.state.copy()
    first, again = explain(situation), explain(ObservedSituation(situation.state, command, situation.ranges))
    assert first == again and first[0].how == how
    assert situation.found == ()
    assert (situation.state.occupancy.state == before).all()
