"""The visibility graph that confirms shortest paths finds them, and nothing beyond its limit."""

import numpy as np
import pytest
from hypothesis import given, settings

from benchmarks.engine.sightlines import Sightlines
from tests.geometry import oracles
from tests.geometry.routes.test_routes import trips
from utak.geometry.pathfinders.visibility_graph import visibility_path


@pytest.mark.long
@settings(max_examples=80, deadline=None)
@given(trips(most=14))
def test_the_length_is_that_of_the_whole_visibility_graph(trip):
    free, start, goal = trip
    way, sight = visibility_path(free, start, goal), Sightlines(free)
    if way is None:
        assert sight.length(start, goal, 1e6) == np.inf
        return
    length = oracles.length(way)
    assert sight.length(start, goal, 1.5 * length + 1.0) == pytest.approx(length, abs=1e-9)
    assert sight.length(start, goal, length + 1e-9) == pytest.approx(length, abs=1e-9)
    assert sight.length(start, goal, length - 1e-6) == np.inf
