"""The comparison of beliefs with the truth finds right and wrong beliefs at any orientation of the map frame."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from shapely import box
from shapely.affinity import rotate, translate

from benchmarks.harness.beliefs import beliefs, compare, under_fovea

WIDTH, HEIGHT = 20, 14
WOKE = (6.5, 4.5)
BRICK = box(9, 6, 13, 8)


def truth() -> np.ndarray:
    """Return the occupied squares of the table: a verge one square thick and the brick."""
    grid = np.ones((HEIGHT, WIDTH), bool)
    grid[1:-1, 1:-1] = False
    grid[6:8, 9:13] = True
    return grid


def robot(quarters: int, angle: int = 0, shape: str = "brick") -> tuple[Any, int]:
    """Return a robot that knows the whole table, with its map frame turned by quarters, and its heading."""
    about = (WOKE[0], WOKE[1])
    turned = rotate(BRICK, -90 * quarters, origin=about)
    frame = translate(turned, 0.5 - WOKE[0], 0.5 - WOKE[1])
    west = south = -24
    state = np.full((48, 48), -1, np.int8)
    grid = truth()
    for y in range(HEIGHT):
        for x in range(WIDTH):
            dx, dy = x - 6, y - 4
            for _ in range(-quarters % 4):
                dx, dy = -dy, dx
            state[dy - south, dx - west] = grid[y, x]
    node = SimpleNamespace(shape={shape: 90, "rectangle": 90, "polygon": 99}, polygon=frame, patch=None)
    view = SimpleNamespace(west=west, south=south, state=state)
    frame = SimpleNamespace(angle=angle)
    model = SimpleNamespace(frame=frame, objects=(node,), view=view, place=(0.5, 0.5), certain=state >= 0)
    return SimpleNamespace(model=model), (90 * quarters + angle) % 360


def brick_as_truth() -> dict[str, Any]:
    """Return the brick as `compare` expects it."""
    grid = np.zeros((HEIGHT, WIDTH), bool)
    grid[6:8, 9:13] = True
    return {"d1": ("brick", BRICK, grid)}


@pytest.mark.parametrize("angle", [0, 17, -40])
@pytest.mark.parametrize("quarters", range(4))
def test_true_beliefs_are_found_right(quarters: int, angle: int) -> None:
    mind, heading = robot(quarters, angle)
    held = beliefs(mind, WOKE, WOKE, heading)
    score = compare(held, brick_as_truth(), truth(), under_fovea([WOKE, (9.5, 5.5)], heading))
    assert (score.met, score.known, score.certain, score.wrong) == (1, 1, WIDTH * HEIGHT, 0)


def test_a_wrong_class_and_a_wrong_square_are_found() -> None:
    mind, heading = robot(1, shape="disc")
    mind.model.view.state[24, 24] = 1  # the robot's own square
    score = compare(beliefs(mind, WOKE, WOKE, heading), brick_as_truth(), truth(), under_fovea([WOKE], heading))
    assert (score.met, score.known, score.wrong) == (1, 0, 1)
    assert score.mistaken == ("d1: brick taken for disc",)


@pytest.mark.parametrize("quarters", range(4))
def test_beliefs_are_placed_by_where_the_robot_stands(quarters: int) -> None:
    mind, heading = robot(quarters)
    step = [(2, 1), (1, -2), (-2, -1), (-1, 2)][quarters]  # two squares east and one north on the table
    mind.model.place = (step[0] + 0.3, step[1] + 0.8)
    held = beliefs(mind, WOKE, (WOKE[0] + 2, WOKE[1] + 1), heading)
    assert held.drift == 0
    assert compare(held, brick_as_truth(), truth(), under_fovea([WOKE], heading)).wrong == 0
    assert beliefs(mind, (WOKE[0] + 3, WOKE[1]), (WOKE[0] + 2, WOKE[1] + 1), heading).drift == 3


def test_an_object_that_is_not_in_the_model_is_missed() -> None:
    mind, heading = robot(0)
    mind.model.objects = ()
    score = compare(beliefs(mind, WOKE, WOKE, heading), brick_as_truth(), truth(), under_fovea([WOKE], heading))
    assert score.mistaken == ("d1: brick taken for nothing",)


def test_squares_never_under_the_fovea_do_not_count() -> None:
    mind, heading = robot(0, shape="disc")
    score = compare(beliefs(mind, WOKE, WOKE, heading), brick_as_truth(), truth(), under_fovea([(2.5, 11.5)], heading))
    assert (score.met, score.whole) == (0, 0)


def test_a_robot_without_a_model_holds_nothing() -> None:
    assert beliefs(object(), WOKE, WOKE, 0) == ([], [], 0)


def test_the_fovea_is_four_squares_each_way() -> None:
    seen = under_fovea([(10.5, 10.5)], 0)
    assert seen == {(x, y) for x in range(6, 14) for y in range(6, 14)}
    assert under_fovea([(10.5, 10.5)], 90) == {(x, y) for x in range(7, 15) for y in range(6, 14)}
