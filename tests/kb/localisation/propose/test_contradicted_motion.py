"""A shortened turn is recognised by what seems to stand right beside the object; eyes.py makes the impressions."""

import math
from dataclasses import replace

import pytest
import shapely
from shapely.affinity import rotate, translate

from tests.kb.eyes import retina, world_of
from tests.kb.localisation.hypotheses.test_remap import around
from utak.kb.body import Turn
from utak.kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES, Observation
from utak.kb.localisation.hypotheses.remap import object_pose, remap
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.localisation.known.state import TrackerState
from utak.kb.localisation.propose.contradicted_motion import shortened_turn
from utak.kb.mapping.occupancy import OPEN
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.frame import CENTRE, Frame
from utak.kb.perception.retina import count_ranges

ELL = shapely.Polygon([(0, 0), (6, 0), (6, 6), (4, 6), (4, 2), (0, 2)])
HOLD = (2.5, 2.5)  # in its inner corner
HERE, FAR = (60.5, 15.5), 40.0  # table frame; how far east the object was brought
HALL = world_of(["b" * 90, *["b" + "." * 88 + "b"] * 30, "b" * 90])


def turned_by(commanded: float, truly: float) -> ObservedSituation:
    """Return the situation after a turn.

    The object was turned the other way before and brought to an unknown part of the table. It lies exactly where it is
    believed to, though that is uncertain.
    """
    frame = Frame()
    thing = translate(ELL, HERE[0] - HOLD[0], HERE[1] - HOLD[1])
    lies = translate(thing, CENTRE[0] - HERE[0], CENTRE[1] - HERE[1])
    first = translate(rotate(lies, commanded, origin=CENTRE), -FAR)
    taken = HeldObject("o1", first, first, since=1)
    held = replace(taken, polygon=lies, turned=-commanded, proven=True, astray=0.4)
    began = around(translate(rotate(thing, commanded, origin=HERE), -FAR), HALL)
    observation = Observation(
        count_ranges(retina(began, (math.floor(HERE[0] - FAR), math.floor(HERE[1])))), (-FAR, 0.0)
    )
    here = math.floor(HERE[0]), math.floor(HERE[1])
    brought = Observation(count_ranges(retina(around(thing, HALL), here)), (0.0, 0.0), (object_pose(held, frame),))
    observations = [observation, observation._replace(moved=(object_pose(taken, frame),)), brought]
    occupancy, held_objects = remap(frame, frame, observations, [held]).occupancy, {"o1": held}
    for square in patch_of_polygon(rotate(lies, commanded, origin=CENTRE).buffer(1.5)).squares():
        occupancy.state[occupancy.index(*square)] = OPEN  # no earlier observation shows them
    after = count_ranges(retina(around(rotate(thing, truly, origin=HERE), HALL), here))
    state = TrackerState(
        occupancy,
        frame,
        CENTRE,
        tuple(observations),
        CENTRED_HYPOTHESES[:1],
        held_objects=held_objects,
        in_hand="o1",
    )
    return ObservedSituation(state, Turn(commanded), after)


@pytest.mark.parametrize(("commanded", "truly"), [(-90.0, -82.0), (-90.0, -85.0), (90.0, 83.0), (180.0, 173.0)])
def test_what_seems_to_stand_beside_a_turned_object_is_the_object(commanded: float, truly: float) -> None:
    end = shortened_turn(turned_by(commanded, truly))
    assert end is not None
    assert abs(end.degrees - truly) < 10.0  # everything beside it is hidden: it cannot be told more exactly


@pytest.mark.parametrize("commanded", [-90.0, 90.0, 180.0])
def test_a_whole_turn_is_not_taken_for_a_shortened_one(commanded: float) -> None:
    assert shortened_turn(turned_by(commanded, commanded)) is None


@pytest.mark.parametrize("turned", [0.0, 360.0, -720.0])
def test_an_object_turned_all_the_way_round_may_be_turned(turned: float) -> None:
    situation = turned_by(90.0, 90.0)
    held = replace(situation.state.held_objects["o1"], turned=turned)
    assert shortened_turn(situation.supposing(held_objects={"o1": held})) is None
