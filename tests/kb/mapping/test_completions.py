"""Scenes, and the completions that are drawn of them."""

import numpy as np
import pytest

from tests.kb.drawings import LARGE_ROOM, drawing, looked
from utak.geometry.counts.gibbs import DRAWN, OCCUPIED
from utak.kb.mapping.completions import (
    DRAWS_PER_COMPLETION,
    MAX_COMPLETIONS,
    NO_COMPLETIONS,
    Completions,
    _resample,
    draw_completions,
    given_squares,
    scenes,
)
from utak.kb.mapping.occupancy import MapView

LOOKS = [(20, 20), (22, 21), (23, 23)]
NEAR_THE_WALL = (34, 20, 6, 3)  # east, north, wide, high


ROOMS = (LARGE_ROOM, drawing(31, 30, 5, 5), drawing(*NEAR_THE_WALL), drawing(10, 33, 6, 2))


@pytest.fixture(scope="module", params=[(rows, count) for rows in ROOMS for count in (1, 3)])
def view(request: pytest.FixtureRequest) -> MapView:
    rows, count = request.param
    return looked(rows, LOOKS[:count]).view()


def test_a_square_and_a_field_belong_to_one_scene(view: MapView) -> None:
    ground = given_squares(view)
    owner = np.zeros(ground.shape, int)
    for number, scene in enumerate(scenes(view, ground), 1):
        part = owner[scene.rows, scene.columns]
        assert not part[scene.ground == DRAWN].any()
        part[scene.ground == DRAWN] = number
    assert ((owner > 0) == (ground == DRAWN)).all()
    beside = [(owner[1:], owner[:-1]), (owner[:, 1:], owner[:, :-1]), (owner[1:, 1:], owner[:-1, :-1])]
    assert not any(((a != b) & (a > 0) & (b > 0)).any() for a, b in beside)
    for where, weight in zip(view.counts.where, view.counts.weight, strict=True):
        assert len(set(owner.ravel()[where[weight > 0]].tolist()) - {0}) <= 1


def test_completions_agree_with_settled_squares_and_with_nearly_all_counts(view: MapView) -> None:
    ground = given_squares(view)
    images = draw_completions(view, ground, NO_COMPLETIONS).images
    assert images.shape == (MAX_COMPLETIONS, *ground.shape)
    settled = ground != DRAWN
    assert all((image[settled] == (ground[settled] == OCCUPIED)).all() for image in images)
    where, weight, low, high = view.counts
    for image in images:
        count = (image.ravel()[where] * weight).sum(1)
        assert ((low <= count) & (count <= high)).mean() > 0.9


def test_a_scene_keeps_its_key_when_only_others_change() -> None:
    plain = ["b" * 100, *["b" + "." * 98 + "b"] * 98, "b" * 100]
    rows = [row[:54] + "ggg" + row[57:] if n in (40, 41) else row for n, row in enumerate(plain)]
    found = []
    for observations in ([(50, 50)], [(50, 50), (50, 16)]):
        view = looked(rows, observations).view()
        places = {}
        for scene in scenes(view, given_squares(view)):
            corner = view.west + scene.columns.start, view.south + scene.rows.start
            places[corner] = list(scene.told(view))
        found.append(places)
    before, after = found
    assert len(after) > len(before)
    assert all(after[corner] == scene for corner, scene in before.items())


def by_square(pictures: Completions) -> dict[tuple[int, int], bytes]:
    """Return what the completions show of each drawn square, by its place in the map frame."""
    rows, columns = np.nonzero(pictures.ground == DRAWN)
    shown = pictures.images[:, rows, columns].T
    places = zip((columns + pictures.west).tolist(), (rows + pictures.south).tolist(), strict=True)
    return {place: part.tobytes() for place, part in zip(places, shown, strict=True)}


def test_samples_stay_while_no_impression_says_anything_new_of_them() -> None:
    rows = ["b" * 100, *["b" + "." * 98 + "b"] * 98, "b" * 100]
    rows = [row[:54] + "ggg" + row[57:] if n in (40, 41) else row for n, row in enumerate(rows)]
    observations = [(50, 50), (50, 16), (52, 20)]
    first, second, third = (looked(rows, observations[:count]).view() for count in (1, 2, 3))
    assert second.south < first.south
    before = draw_completions(first, given_squares(first), NO_COMPLETIONS)
    now = draw_completions(second, given_squares(second), before)
    assert by_square(before).items() <= by_square(now).items()
    then, alone = (draw_completions(third, given_squares(third), earlier) for earlier in (now, NO_COMPLETIONS))
    assert by_square(then) != by_square(alone)


def test_the_part_of_completions_over_a_scene_is_what_they_show_there(view: MapView) -> None:
    whole = draw_completions(view, given_squares(view), NO_COMPLETIONS)
    for scene in scenes(view, whole.ground):
        moved = view._replace(west=view.west - 3, south=view.south + 2)
        part = whole.over(scene, moved)
        assert (part.west, part.south) == (moved.west + scene.columns.start, moved.south + scene.rows.start)
        shown = {
            (part.west + column, part.south + row): part.images[:, row, column].tobytes()
            for row, column in np.argwhere(part.ground == DRAWN).tolist()
        }
        assert shown.items() <= by_square(whole).items()
        high, wide = part.ground.shape
        inside = {
            (x, y)
            for x, y in by_square(whole)
            if part.west <= x < part.west + wide and part.south <= y < part.south + high
        }
        assert inside == set(shown)


def test_samples_that_cost_less_are_kept_more_often() -> None:
    alike = _resample(np.full(DRAWS_PER_COMPLETION * MAX_COMPLETIONS, 7.0))
    assert len(set(alike.tolist())) == MAX_COMPLETIONS
    one = np.full(DRAWS_PER_COMPLETION * MAX_COMPLETIONS, 40.0)
    one[5] = 7.0
    assert _resample(one).tolist() == [5] * MAX_COMPLETIONS
    costs = np.arange(DRAWS_PER_COMPLETION * MAX_COMPLETIONS, dtype=float)
    kept = _resample(costs)
    assert (np.diff(costs[kept]) >= 0).all()
    assert costs[kept].mean() < costs.mean()
