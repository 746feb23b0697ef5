"""Walks over links of the pathgraph: against geometry's own shortest routes, and with rules of users in whole runs."""

from collections.abc import Callable, Sequence
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
from utak.planner.navigation.walks import WalkChoice, WalkRules, choose_walk, find_walks
from utak.planner.question import Question
from utak.planner.screen.projection import CostMaps

ROOT = Path(__file__).resolve().parents[3]
RULES = ROOT / "docs" / "walk_rules"
FLOORS = arrays(
    np.bool_, st.tuples(st.integers(2, 14), st.integers(2, 14)), elements=st.sampled_from([True] * 4 + [False])
)


def beside_thing(utak_at: str, first: str, then: str) -> utak.Scenario:
    """Return a room with a brick near its north wall, and a robot that goes to two corners."""
    return utak.Scenario.from_text(
        world=f"""table(36, 24).
        verge("POLYGON ((0 0, 0 24, 36 24, 36 0, 0 0), (2 2, 34 2, 34 22, 2 22, 2 2))").
        object(a, c, "POLYGON ((14 12, 19 12, 19 19, 14 19, 14 12))").
        utak("POINT ({utak_at})", 0).""",
        start="",
        goal=f"first(at(utak, corner({first}))). then(at(utak, corner({then}))).",
    )


def four_rooms(door_ends: int, things: str = "") -> utak.Scenario:
    """Return four rooms in a ring; the door in the north, which begins at 24, ends at some y."""
    outside, north = "(0 0, 0 36, 44 36, 44 0, 0 0)", door_ends
    inside = (
        "(2 2, 20 2, 20 7, 22 7, 22 2, 42 2, 42 17, 35 17, 35 19, 42 19, 42 34, "
        f"22 34, 22 {north}, 20 {north}, 20 34, 2 34, 2 19, 9 19, 9 17, 2 17, 2 2)"
    )
    middle = "((20 12, 22 12, 22 24, 20 24, 20 12))"
    return utak.Scenario.from_text(
        world=f'table(44, 36).\nverge("MULTIPOLYGON (({outside}, {inside}), {middle})").\n{things}\n'
        'utak("POINT (6.5 6.5)", 0).',
        start="",
        goal="first(at(utak, corner(northeast))). then(at(utak, start)).",
    )


AROUND = beside_thing("6.5 19.5", "northeast", "northwest")
BELOW = beside_thing("6.5 4.5", "southeast", "southwest")
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


def chosen(files: tuple[Path, ...] = (), far: int = 17, floor: Sequence[str] = PILLAR) -> tuple[bool, float]:
    """Return whether the walk so far to the east leads north of the pillar, and how long it is."""
    model = known_model(list(floor))
    cost_maps = CostMaps(model)
    row, column = model.view.locate(model.place[0] + far, model.place[1])
    goal = np.array([row * model.labels.shape[1] + column])
    rules, walks = WalkRules(ruled=bool(files)), find_walks(cost_maps, 0, goal, "skeleton")
    found = choose_walk(walks, cost_maps, frozenset(), (), rules, Question(files))
    assert isinstance(found, WalkChoice)
    walk = found.route
    assert walk.squares[0] == cost_maps.here
    assert walk.squares[-1] == (column, row)
    assert cost_maps.free(0)[tuple(np.array(walk.squares).T[::-1])].all()
    beside = [y for x, y in walk.squares if abs(x - cost_maps.here[0] - 9) <= 2]
    return min(beside, default=0) > cost_maps.here[1], walk.length


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


def way_back(scenario: utak.Scenario, rules: tuple[str, ...] = ()) -> tuple[str, list[tuple[float, float]]]:
    """Return how a run ended, and where the robot stopped after it had attained its first goal."""
    episode = utak.Run(scenario, rules=rules, max_steps=30).finish()
    assert not episode.idle_rules
    stops = [(float(x), float(y)) for x, y in (step.line["utak"] for step in episode)]
    turned = max(range(len(stops)), key=lambda n: stops[n][0])  # the first goal lies in the east
    return str(episode.verdict), stops[turned + 1 :]


def north_of_thing(stops: list[tuple[float, float]]) -> bool:
    return all(y > 19 for x, y in stops if x < 34)


def south_of_thing(stops: list[tuple[float, float]]) -> bool:
    return any(y < 12 and 7 <= x <= 26 for x, y in stops)


def through_northwest_room(stops: list[tuple[float, float]]) -> bool:
    return any(x < 22 and y > 22 for x, y in stops)


def through_southeast_room(stops: list[tuple[float, float]]) -> bool:
    return any(x > 20 and y < 12 for x, y in stops)


Side = Callable[[list[tuple[float, float]]], bool]
WALKS_BACK: dict[str, tuple[utak.Scenario, Side, Side]] = {  # where the way back leads without the rule, and with it
    "01_wide_ways": (AROUND, north_of_thing, south_of_thing),
    "02_not_between_thing_and_wall": (AROUND, north_of_thing, south_of_thing),
    "03_no_squeezing": (AROUND, north_of_thing, south_of_thing),
    "04_not_past_bricks": (AROUND, north_of_thing, south_of_thing),
    "05_never_twice": (AROUND, north_of_thing, south_of_thing),
    "06_not_past_things": (
        four_rooms(29, 'object(a, c, "POLYGON ((10 24, 13 24, 13 27, 10 27, 10 24))").'),
        through_northwest_room,
        through_southeast_room,
    ),
    "07_south_is_cheap": (AROUND, north_of_thing, south_of_thing),
    "08_narrow_doors_are_dear": (four_rooms(27), through_northwest_room, through_southeast_room),
    "10_hug_the_walls": (
        BELOW,
        lambda stops: all(y < 12 for _, y in stops),
        lambda stops: any(y > 17 for _, y in stops),
    ),
}


@pytest.mark.parametrize("far", range(-2, 20))
def test_a_rule_that_changes_nothing_changes_no_walk(tmp_path: Path, far: int) -> None:
    """However far the goal is: also where no link lies between it and the robot."""
    rules = tmp_path / "rules.lp"
    rules.write_text("large(X) :- rect(X, W, S, E, N), E - W >= 30000.")
    without_pillar = [row[:9] + "." * 6 + row[15:] if 0 < n < len(PILLAR) - 1 else row for n, row in enumerate(PILLAR)]
    assert chosen((rules,), far, without_pillar) == chosen((), far, without_pillar)
    if not 7 <= far <= 11:  # within the pillar
        assert chosen((rules,), far) == chosen((), far)


@pytest.mark.long
@pytest.mark.parametrize("name", WALKS_BACK)
def test_a_rule_about_links_changes_the_walk_as_its_sentence_says(name: str) -> None:
    scenario, without, with_it = WALKS_BACK[name]
    verdict, stops = way_back(scenario)
    assert (verdict, without(stops), with_it(stops)) == ("done", True, False)
    verdict, stops = way_back(scenario, (str(RULES / f"{name}.lp"),))
    assert (verdict, with_it(stops)) == ("done", True)


@pytest.mark.long
def test_where_a_rule_leaves_no_walk_the_verdict_names_it() -> None:
    rule = RULES / "09_no_narrow_door.lp"
    scenario = utak.Scenario.read(ROOT / "examples" / "go_next_room")
    episode = utak.Run(scenario, rules=(str(rule),), max_steps=30).finish()
    assert episode.verdict == "limit"
    assert f"the rule at {rule}:2 forbids every way there" in episode.reason
    assert all(step.line["utak"][0] < 22 for step in episode)  # west of the door


def test_each_rule_about_links_is_tried() -> None:
    assert {path.stem for path in RULES.glob("*.lp")} == {*WALKS_BACK, "09_no_narrow_door"}
