"""The Gymnasium environment: its checker, seeds, rewards, ends, actions, pictures, and many tables together."""

import copy
import pickle
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.tables import few

gymnasium = pytest.importorskip("gymnasium")
env_checker = pytest.importorskip("gymnasium.utils.env_checker")

import utak  # noqa: E402
import utak.gym  # noqa: E402
from utak.gym.actions import STEP_VECTORS, action_form  # noqa: E402
from utak.gym.environment import TabletopEnv  # noqa: E402
from utak.kb.body import DIRECTIONS, Grasp, Move, Push, Release, Turn  # noqa: E402
from utak.simulator.run.embodiment import Embodiment  # noqa: E402
from utak.simulator.world.physics import Tabletop  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]
EXAMPLES = ROOT / "examples"
WORLD = "bbbbbbbbbb\nb........b\nb...gg...b\nb.U.gg...b\nb........b\nbbbbbbbbbb\n"
EAST = 'inside(utak, "POLYGON ((6 1, 9 1, 9 5, 6 5, 6 1))").'
ROOM = utak.Scenario.from_text(WORLD, "at(utak, corner(northeast)).", expect=f"{EAST} unmoved(g1). within(30).")
FORMS = ("dict", "box", "discrete")


def make(scenario: Any = ROOM, **options: Any) -> Any:
    return gymnasium.make("utak/Tabletop-v0", scenario=scenario, **options)


@pytest.mark.parametrize(("form", "render_mode"), few(product(FORMS, [None, "ansi", "rgb_array"]), 2))
def test_the_checker_of_gymnasium_finds_nothing(form: str, render_mode: str | None) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = make(actions=form, render_mode=render_mode)
        env_checker.check_env(env.unwrapped)
        env.reset(seed=1)
        env.step(env.action_space.sample())
        env.close()


def played(env: Any, seed: int | None, count: int = 40) -> Iterator[Any]:
    """Yield all that comes of random actions, as values that can be compared."""
    observation, info = env.reset(seed=seed)
    env.action_space.seed(5)
    yield [part.tolist() for part in observation.values()], info
    for _ in range(count):
        observation, *rest = env.step(env.action_space.sample())
        yield [part.tolist() for part in observation.values()], rest


@pytest.mark.parametrize("form", FORMS)
def test_the_same_seed_gives_the_same_play(form: str) -> None:
    plays = [list(played(make(actions=form, noise=0.1), seed)) for seed in (4, 4, 5)]
    assert plays[0] == plays[1]
    assert plays[0] != plays[2]
    env = make(actions=form, noise=0.1)
    first, second = list(played(env, 4)), list(played(env, None))  # without a seed the random numbers go on
    assert first == plays[0] != second
    assert list(played(env, 4)) == first


def test_an_impression_is_that_of_the_body() -> None:
    env = make(EXAMPLES / "push_l_next_room", noise=0.05)
    observation, _ = env.reset(seed=7)
    table = Tabletop(utak.Scenario.read(EXAMPLES / "push_l_next_room").content.world, 0.05, 7)
    body = Embodiment(table)
    impression = body.wake()
    form = action_form("dict", 4.0)
    env.action_space.seed(3)
    for _ in range(60):
        assert observation["retina"].tolist() == list(impression.retina)
        letters = [None if code == 0 else chr(ord("a") + code - 1) for code in observation["touch"].tolist()]
        assert letters == list(impression.touch)
        assert env.observation_space.contains(observation)
        action = env.action_space.sample()
        observation, *_ = env.step(action)
        impression = body.act(form.command(action))
    assert env.unwrapped.table.utak == table.utak


def test_rewards_and_the_end_follow_expect_lp() -> None:
    env = make(actions="discrete")
    _, info = env.reset()
    assert info == {"achieved": False, "share": 0.5}  # nothing was moved
    turns = [env.step(action) for action in (4, 2, 2, 2, 2)]  # south, then east below the square
    assert [turn[1] for turn in turns] == [0.0, 0.0, 0.0, 0.0, 0.5]
    assert [turn[2] for turn in turns] == [False, False, False, False, True]
    assert not any(turn[3] for turn in turns)
    assert turns[-1][4] == {"achieved": True, "share": 1.0}
    sparse = make(actions="discrete", reward="sparse")
    sparse.reset()
    assert [sparse.step(action)[1] for action in (4, 2, 2, 2, 2)] == [0.0, 0.0, 0.0, 0.0, 1.0]


def test_a_loss_is_a_negative_reward() -> None:
    env = make(actions="discrete")
    env.reset()
    rewards = [env.step(action)[1] for action in (2, 22, 10)]  # to the square, grasp it, push it
    assert rewards == [0.0, 0.0, -0.5]


def test_a_play_is_truncated_after_the_commands_that_are_allowed() -> None:
    for options, most in (({}, 30), ({"max_steps": 7}, 7), ({"reward": None}, 200)):
        env = make(actions="discrete", **options)
        env.reset()
        ends = [env.step(28)[2:4] for _ in range(most)]
        assert ends == [(False, False)] * (most - 1) + [(False, True)]


def test_scenarios_without_rewards_need_reward_none() -> None:
    plain = ROOM.with_task("at(utak, corner(northeast)).")
    for scenario, message in ((plain, "has no expect.lp"), (EXAMPLES / "go_to_square_none", "expects failure")):
        with pytest.raises(ValueError, match=message):
            make(scenario)
        make(scenario, reward=None).reset()


def test_of_several_scenarios_one_is_drawn_or_named() -> None:
    env = make([ROOM, EXAMPLES / "go_next_room"])
    sizes = {ROOM.content.world.width, 44}
    env.reset(seed=1)
    drawn = []
    for _ in range(20):
        env.reset()
        drawn.append(env.unwrapped.table.world.width)
    assert set(drawn) == sizes
    for number, width in ((0, ROOM.content.world.width), (1, 44)):
        env.reset(options={"scenario": number})
        assert env.unwrapped.table.world.width == width
    with pytest.raises(ValueError, match="there is no scenario 2"):
        env.reset(options={"scenario": 2})


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"actions": "words"}, "no such form of actions"),
        ({"stride": 0.0}, "stride must be above 0"),
        ({"reward": "dense"}, "no such reward"),
        ({"max_steps": 0}, "max_steps must be 1 or greater"),
        ({"noise": 2.0}, "noise must be from 0 to 1"),
        ({"scenario": []}, "at least one scenario"),
    ],
)
def test_options_out_of_range_are_errors(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make(**options)


def test_there_is_no_window() -> None:
    with pytest.raises(ValueError, match="no such render mode"):
        TabletopEnv(ROOM, render_mode="human")


def test_actions_stand_for_commands() -> None:
    dictionary = action_form("dict", 4.0).command
    action = {"do": 0, "way": np.array([0.5, -1.0]), "turn": np.array([0.25]), "direction": 3}
    kinds = [Move(2.0, -4.0), Push(2.0, -4.0), Turn(45.0), Grasp("southeast"), Release()]
    assert [dictionary({**action, "do": do}) for do in range(5)] == kinds
    with pytest.raises(ValueError, match="`do` is a number from 0 to 4"):
        dictionary({**action, "do": 5})
    box = action_form("box", 4.0).command
    rows = [[*(float(kind == do) for kind in range(5)), 0.5, -1.0, 0.25] for do in range(5)]
    assert [box(np.array(row)) for row in rows] == [*kinds[:3], Grasp("southeast"), Release()]
    for direction, (east, north) in zip(DIRECTIONS, STEP_VECTORS, strict=True):
        assert box(np.array([0, 0, 0, 1, 0, east, north, 0])) == Grasp(direction)
    discrete = action_form("discrete", 4.0)
    commands = [discrete.command(number) for number in range(int(discrete.space.n))]
    assert commands[:2] == [Move(0.0, 1.0), Move(1.0, 1.0)]
    assert commands[8] == Push(0.0, 1.0)
    assert commands[16:20] == [Turn(90.0), Turn(-90.0), Turn(15.0), Turn(-15.0)]
    assert commands[20:] == [*map(Grasp, DIRECTIONS), Release()]
    for number in (-1, 29):
        with pytest.raises(ValueError, match="from 0 to 28"):
            discrete.command(number)


def test_the_table_is_drawn_as_text_and_as_an_image() -> None:
    env = make(actions="discrete", render_mode="ansi")
    env.reset()
    assert env.render() == WORLD
    env.step(2)
    assert env.render() == WORLD.replace("b.U.g", "b..Ug")
    pictures = make(actions="discrete", render_mode="rgb_array")
    pictures.reset()
    image = pictures.render()
    assert (image.shape, image.dtype) == ((60, 100, 3), np.uint8)
    squares = image[::10, ::10].tolist()
    assert squares[3][2] == [34, 170, 119]
    assert squares[0][0] == squares[5][9] == [212, 212, 212]
    assert squares[2][4] == squares[3][5] != squares[1][1] == [255, 255, 255]
    assert make().unwrapped.render() is None


def test_one_seed_for_many_tables_is_counted_on() -> None:
    tables = [gymnasium.make_vec("utak/Tabletop-v0", num_envs=3, scenario=ROOM, noise=0.2) for _ in range(2)]
    for envs, seed in zip(tables, (7, [7, 8, 9]), strict=True):
        envs.reset(seed=seed)
        envs.action_space.seed(1)
    for _ in range(5):
        action = tables[0].action_space.sample()
        found = [envs.step(action)[0]["retina"] for envs in tables]
        assert np.array_equal(*found)


def test_many_tables_are_drawn() -> None:
    envs = gymnasium.make_vec("utak/Tabletop-v0", num_envs=2, scenario=ROOM, render_mode="ansi")
    envs.reset()
    assert envs.render() == (WORLD, WORLD)


def test_gymnasium_finds_the_environment_by_the_name_of_its_package() -> None:
    program = (
        f"import sys; sys.path.insert(0, {str(ROOT)!r}); import gymnasium\n"
        f"env = gymnasium.make('utak.gym:utak/Tabletop-v0', scenario={str(EXAMPLES / 'go_next_room')!r})\n"
        "env.reset(seed=1); print(env.unwrapped.table.utak)\n"
    )
    done = subprocess.run(
        [sys.executable, "-I", "-c", program], capture_output=True, text=True, timeout=600, check=True
    )
    assert done.stdout.strip() == "(9.5, 15.5)"


@pytest.mark.parametrize(
    ("form", "action"),
    [
        ("dict", None),
        ("dict", {"do": 0}),
        ("dict", {"do": 0, "way": 1.0, "turn": [0.0], "direction": 0}),
        ("box", None),
        ("box", np.zeros(9, np.float32)),
        ("discrete", "3"),
        ("discrete", np.zeros(2)),
        ("discrete", None),
    ],
)
def test_what_is_no_action_is_refused_in_words(form: str, action: Any) -> None:
    env = TabletopEnv(ROOM, actions=form)
    env.reset(seed=1)
    with pytest.raises(ValueError, match="an action is "):
        env.step(action)
    with pytest.raises(ValueError, match="there is no scenario 'first'"):
        env.reset(options={"scenario": "first"})


@pytest.mark.parametrize("actions", ["dict", "box", "discrete"])
@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_copies_of_an_environment_are_independent(actions: str, copied: Callable[[TabletopEnv], TabletopEnv]) -> None:
    expected = (
        'visits(utak, "POLYGON ((9 6, 14 6, 14 9, 9 9, 9 6))"). circles(utak, o). near(utak, "POINT (3 3)", 1). '
        'avoids(utak, "POLYGON ((0 0, 3 0, 3 3, 0 3, 0 0))"). unmoved(o). within(40). '
        'pose(o, "POINT (6 6)", 0, 1). inside(utak, "POLYGON ((9 6, 14 6, 14 9, 9 9, 9 6))").'
    )
    world = (
        'table(16, 12). verge("POLYGON ((0 0, 16 0, 16 12, 0 12, 0 0), (1 1, 15 1, 15 11, 1 11, 1 1))"). '
        'object(o, g, "POLYGON ((5 5, 7 5, 7 7, 5 7, 5 5))"). utak("POINT (2.5 2.5)", 0).'
    )
    scenario = utak.Scenario.from_text(world, "at(utak, corner(northeast)).", expect=expected)
    env = TabletopEnv(scenario, actions=actions, noise=0.1)
    env.reset(seed=3)
    env.action_space.seed(7)
    first, second = ([env.action_space.sample() for _ in range(30)] for _ in range(2))
    for action in first:
        env.step(action)
    whole, again = copied(env), copied(env)

    def rewards(one: TabletopEnv) -> list[object]:
        return [one.step(action)[1:] for action in second]

    found = rewards(whole)
    assert rewards(env) == found
    assert rewards(again) == found
    assert len({str(step) for step in found}) > 1
