"""Whether a turn ended short is told by what seems to stand right about the thing since: eyes.py tells what is seen."""

import math
from dataclasses import replace

import pytest
import shapely
from shapely.affinity import rotate, translate

from geometry.motion.se2 import Rotate
from kb.body import Turn
from kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES, Observation
from kb.localisation.hypotheses.remap import object_pose, remap
from kb.localisation.hypotheses.what_if import Surprise
from kb.localisation.propose.contradicted_motion import shortened_turn
from kb.mapping.occupancy import OPEN
from kb.mapping.patch import covered
from kb.objects.held_object import HeldObject
from kb.perception.frame import CENTRE, Frame
from kb.perception.retina import count_ranges
from tests.kb.eyes import retina, world_of
from tests.kb.localisation.hypotheses.test_remap import around

ELL = shapely.Polygon([(0, 0), (6, 0), (6, 6), (4, 6), (4, 2), (0, 2)])
HOLD = (2.5, 2.5)  # in the nook of it
HERE, FAR = (60.5, 15.5), 40.0  # of the table; how far he has brought it east
HALL = world_of(["b" * 90, *["b" + "." * 88 + "b"] * 30, "b" * 90])


def turned_by(commanded: float, truly: float) -> tuple[Surprise, HeldObject, Rotate]:
    """One who turned a thing the other way and brought it to where he was never before, and is commanded to turn it
    back; and what he sees of it. It lies exactly where he believes, which he does not know.
    """
    frame = Frame()
    thing = translate(ELL, HERE[0] - HOLD[0], HERE[1] - HOLD[1])
    lies = translate(thing, CENTRE[0] - HERE[0], CENTRE[1] - HERE[1])
    first = translate(rotate(lies, commanded, origin=CENTRE), -FAR)
    taken = HeldObject("o1", first, first, since=1)
    load = replace(taken, polygon=lies, turned=-commanded, proven=True, astray=0.4)
    began = around(translate(rotate(thing, commanded, origin=HERE), -FAR), HALL)
    observation = Observation(
        count_ranges(retina(began, (math.floor(HERE[0] - FAR), math.floor(HERE[1])))), (-FAR, 0.0)
    )
    here = math.floor(HERE[0]), math.floor(HERE[1])
    brought = Observation(count_ranges(retina(around(thing, HALL), here)), (0.0, 0.0), (object_pose(load, frame),))
    observations = [observation, observation._replace(moved=(object_pose(taken, frame),)), brought]
    occupancy, loads = remap(frame, frame, observations, [load]).occupancy, {"o1": load}
    for square in covered(rotate(lies, commanded, origin=CENTRE).buffer(1.5)).squares():
        occupancy.state[occupancy.index(*square)] = OPEN  # nothing told of them before
    after = count_ranges(retina(around(rotate(thing, truly, origin=HERE), HALL), here))
    surprise = Surprise(
        Turn(commanded), after, frame, CENTRE, occupancy, observations, loads, "o1", CENTRED_HYPOTHESES[:1]
    )
    return surprise, load, Rotate(commanded, CENTRE)


@pytest.mark.parametrize(("commanded", "truly"), [(-90.0, -82.0), (-90.0, -85.0), (90.0, 83.0), (180.0, 173.0)])
def test_what_stands_about_a_thing_since_it_was_turned_is_the_thing_itself(commanded: float, truly: float) -> None:
    end = shortened_turn(*turned_by(commanded, truly))
    assert end is not None
    assert abs(end.degrees - truly) < 10.0  # about it all is hidden: no more than that can be told


@pytest.mark.parametrize("commanded", [-90.0, 90.0, 180.0])
def test_a_turn_that_was_not_stopped_is_not_told_to_be(commanded: float) -> None:
    assert shortened_turn(*turned_by(commanded, commanded)) is None


@pytest.mark.parametrize("turned", [0.0, 360.0, -720.0])
def test_a_thing_that_lies_as_it_was_taken_may_be_turned(turned: float) -> None:
    surprise, load, motion = turned_by(90.0, 90.0)
    load = replace(load, turned=turned)
    assert shortened_turn(replace(surprise, loads={"o1": load}), load, motion) is None
