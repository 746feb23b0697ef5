"""The benchmark of the screens of a run: it counts them all, and leaves Screen as it was."""

import numpy as np
import pytest

from benchmarks.timing import screens_in_a_run
from geometry import Screen


def test_all_screens_and_questions_are_counted_and_screen_is_left_as_it_was():
    methods = {name: Screen.__dict__[name] for name in ("__init__", *screens_in_a_run.SCREEN_QUESTIONS)}
    free = np.ones((4, 6), bool)
    with screens_in_a_run.watched_screens() as (seconds, made):
        Screen(free).passages()
        free[1, 2] = False
        Screen(free).routes((0.5, 0.5), (5.5, 3.5))
        with pytest.raises(ValueError, match="no free square"):
            Screen(np.zeros((2, 2), bool))
    grids = made[__name__]
    assert len(made) == 1 and len(grids) == 3 and grids[0].all() and not grids[1].all()
    assert seconds["building"] >= 0.0 and seconds["asking"] >= 0.0
    assert all(Screen.__dict__[name] is method for name, method in methods.items())


def test_a_replay_says_which_share_of_squares_differs():
    free = np.ones((4, 5), bool)
    other = free.copy()
    other[1, 1:3] = False
    wider = np.ones((4, 6), bool)
    again = screens_in_a_run.replay({"one": [free, other, wider], "two": [wider, wider]})
    assert again.shares == [0.1, 0.0]
    assert again.anew >= 0.0 and again.by_change >= 0.0
