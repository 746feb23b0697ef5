"""Walks over links of the pathgraph: against geometry's own shortest routes, and with rules of users in whole runs."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import utak
from tests.kb.drawings import known_model
from utak.geometry import Screen
from utak.planner.navigation.network import network
from utak.planner.navigation.walks import WalkRules, choose_walk, find_walks
from utak.planner.screen.projection import CostMaps

ROOT = Path(__file__).resolve().parents[3]
FLOORS = arrays(
    np.bool_, st.tuples(st.integers(2, 14), st.integers(2, 14)), elements=st.sampled_from([True] * 4 + [False])
)
AROUND = utak.Scenario.from_text(
    world="""table(36, 24).
verge("POLYGON ((0 0, 0 24, 36 24, 36 0, 0 0), (2 2, 34 2, 34 22, 2 22, 2 2))").
object(a, c, "POLYGON ((14 12, 19 12, 19 19, 14 19, 14 12))").
utak("POINT (6.5 19.5)", 0).""",
    start="",
    goal="first(at(utak, corner(northeast))). then(at(utak, corner(northwest))).",
)
PILLAR = [
    "b" * 24,
    "b......................b",
    "b......................b",
    "b..U......bbbbb........b",
    "b.........bbbbb........b",
    "b.........bbbbb........b",
    "b.........bbbbb........b",
    "b......................b",
    "b......................b",
    "b......................b",
    "b......................b",
    "b" * 24,
]


@given(FLOORS, st.integers(0, 195), st.integers(0, 195))
@settings(max_examples=150, deadline=None)
def test_the_shortest_way_over_links_is_the_shortest_route(free: np.ndarray, one: int, other: int) -> None:
    squares = np.argwhere(free)
    if len(squares) < 2:
        return
    start, goal = (tuple(squares[n % len(squares)][::-1].tolist()) for n in (one, other))
    screen = Screen(free)
    routes = screen.routes((start[0] + 0.5, start[1] + 0.5), (goal[0] + 0.5, goal[1] + 0.5), k=3)
    if not routes:
        return
    found = network(screen, start, goal)
    ways = found.ways(20)
    assert len(set(ways)) == len(ways)
    tight = [found.tight(way) for way in ways]
    assert len({route.signature for route in tight}) == len(tight)
    assert min(route.length for route in tight) <= routes[0].length + 1e-9
    assert all(
        route.length >= screen.shortest(routes[0].points[0], routes[0].points[-1]).length - 1e-9 for route in tight
    )


def chosen(files: tuple[Path, ...] = ()) -> tuple[bool, float]:
    """Return whether the walk to the east leads north of the pillar, and how long it is."""
    model = known_model(PILLAR)
    cost_maps = CostMaps(model)
    row, column = model.view.locate(model.place[0] + 17, model.place[1])
    goal = np.array([row * model.labels.shape[1] + column])
    walk = choose_walk(find_walks(cost_maps, 0, goal, "skeleton"), cost_maps, frozenset(), (), WalkRules(files=files))
    assert walk is not None
    assert walk.squares[0] == cost_maps.here
    assert walk.squares[-1] == (column, row)
    assert cost_maps.free(0)[tuple(np.array(walk.squares).T[::-1])].all()
    beside = [y for x, y in walk.squares if abs(x - cost_maps.here[0] - 9) <= 2]
    return min(beside) > cost_maps.here[1], walk.length


def test_rules_of_users_lead_over_other_links(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    north, length = chosen()
    for text in (
        "avoid_link(L) :- link(L, _, _, _, C), C < 100.",
        "link_price(L, 50 * N) :- link(L, _, _, N, C), C < 100.",
    ):
        rules.write_text(text)
        otherwise, more = chosen((rules,))
        assert otherwise != north
        assert more > length
    rules.write_text("avoid_link(L) :- link(L, _, _, _, _).")  # where all are avoided the shortest way remains
    assert chosen((rules,)) == (north, length)


@pytest.mark.long
@pytest.mark.parametrize("name", ["01_wide_ways", "02_not_between_thing_and_wall"])
def test_a_rule_about_links_leads_round_the_other_side_of_a_thing(name: str) -> None:
    rule = str(ROOT / "docs" / "walk_rules" / f"{name}.lp")
    without, with_it = (utak.Run(AROUND, rules=rules, max_steps=20).finish() for rules in ((), (rule,)))
    assert (without.verdict, with_it.verdict) == ("done", "done")
    assert not with_it.idle_rules
    back = [[step.line["utak"] for step in episode][4:] for episode in (without, with_it)]
    assert min(y for _, y in back[0]) > 19  # between the thing and the north wall
    assert min(y for _, y in back[1]) < 12  # south of the thing
