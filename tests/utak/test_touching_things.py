"""Whole runs in worlds in which things touch walls, islands of wall and each other."""

import pytest

from utak import Run, Scenario

BESIDE_A_PILLAR = """
bbbbbbbbbbbbbbbbbbbbbb
b....................b
b....................b
b.......bbbccc.......b
b.......bbbccc.......b
b.......bbbccc.......b
b....................b
b....................b
b.....U..............b
b....................b
b....................b
b....................b
bbbbbbbbbbbbbbbbbbbbbb
"""
BEHIND_ANOTHER = """
bbbbbbbbbbbbbbb
bbb.........bbb
bbb.........bbb
bbb...aaa...bbb
bbb...aaa...bbb
bbb...aaa...bbb
bbb......bbbbbb
bbb......bbbbbb
bbb......bbbbbb
bbb...ccc...bbb
bbb...ccc...bbb
bbb...ccc...bbb
bbbbbb......bbb
bbbbbb..U...bbb
bbbbbb......bbb
bbbbbbbbbbbbbbb
"""
THROUGH_A_WALL = """
bbbbbbbbbbbbbbbbbbbbbb
b....................b
b....................b
b....................b
b.......ccc..........b
b.......ccc..........b
bbbbbbbbcccbbbbbbbbbbb
bbbbbbbbcccbbbbbbbbbbb
bbbbbbbbcccbbbbbbbbbbb
b.......ccc..........b
b.......ccc..........b
b....................b
b....................b
b.............U......b
b....................b
b....................b
bbbbbbbbbbbbbbbbbbbbbb
"""


@pytest.mark.parametrize(
    ("world", "thing", "goal", "place"),
    [
        pytest.param(BESIDE_A_PILLAR, "c", "11 -1", "17.5 3.5", marks=pytest.mark.long),
        (BEHIND_ANOTHER, "a", "2 11", "10.5 13.5"),
        (THROUGH_A_WALL, "c", "-5 3", "9.5 6.5"),
    ],
    ids=["beside a pillar of the verge", "behind another thing", "through a wall"],
)
def test_a_thing_that_touches_others_is_brought_to_its_place(world: str, thing: str, goal: str, place: str) -> None:
    scenario = Scenario.from_text(
        world=world,
        start=f"object(x). colour(x, {thing}).",
        goal=f'pose(x, "POINT ({goal})", 0).',
        expect=f'pose({thing}1, "POINT ({place})", 0, "0.3").',
    )
    episode = Run(scenario, max_steps=60).finish()
    assert episode.verdict == "done"
    assert episode.achieved
