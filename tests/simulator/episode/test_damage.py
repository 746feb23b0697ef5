"""Damaged episodes and scenarios: reported with file, line and column, never as a bug, never at great length."""

import copy
import io
import json
import re
import resource
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import scripted_robot
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_scenes import write_scene

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.run.story import recorded_story
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.terminal.action_in_words import describe

PLACE = re.compile(r"ep\.jsonl:\d+:\d+-\d+: error: ")


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    """Return the lines of a short episode."""
    place = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
        scripted_robot.install()
        assert main(["run", str(write_scene(place / "s", 1)), "--max-steps", "3", "--log", str(place / "e")]) == 75
    return [json.loads(line) for line in (place / "e").read_text().splitlines()]


def looked_through(path: Path) -> None:
    """Read an episode and do with every step what the prompt does."""
    story = recorded_story(str(path), read_episode(path))
    while True:
        assert isinstance(story.facts, list)
        assert story.picture()
        assert describe(story.line["action"]) + story.line["why"]
        if not story.advance():
            break
    assert story.result is None or {"verdict", "steps", "reason"} <= set(story.result)


def changed(lines: list[dict[str, Any]], number: int, *path: Any, to: Any) -> str:
    """Return the episode with one value changed; `...` removes it."""
    rows = copy.deepcopy(lines)
    at: Any = rows[number]
    for key in path[:-1]:
        at = at[key]
    if to is ...:
        del at[path[-1]]
    else:
        at[path[-1]] = to
    return "".join(json.dumps(row) + "\n" for row in rows)


DAMAGE: dict[str, Callable[[list[dict[str, Any]]], str]] = {
    "a table of 100,000 squares": lambda rows: changed(rows, 0, "world", "table", to=[100_000, 100_000]),
    "a table of no squares": lambda rows: changed(rows, 0, "world", "table", to=[0, 5]),
    "a table of text": lambda rows: changed(rows, 0, "world", "table", to="wide"),
    "a colour that is a list": lambda rows: changed(rows, 0, "world", "movable", to={"x": {"colour": [], "rings": []}}),
    "a ring of two points": lambda rows: changed(rows, 0, "world", "verge", to=[[[[0, 0], [1, 1]]]]),
    "a ring far away": lambda rows: changed(rows, 0, "world", "verge", to=[[[[0, 0], [1e308, 1], [3, 3]]]]),
    "no world": lambda rows: changed(rows, 0, "world", to=...),
    "options of text": lambda rows: changed(rows, 0, "options", to="none"),
    "a seed of text": lambda rows: changed(rows, 0, "options", "seed", to="abc"),
    "a noise of 7": lambda rows: changed(rows, 0, "options", "noise", to=7),
    "another path-finder": lambda rows: changed(rows, 0, "options", "paths", to="magic"),
    "version true": lambda rows: changed(rows, 0, "version", to="1"),
    "no step": lambda rows: changed(rows, 2, "step", to=...),
    "a step twice": lambda rows: changed(rows, 2, "step", to=0),
    "a step of text": lambda rows: changed(rows, 2, "step", to="1"),
    "no action": lambda rows: changed(rows, 2, "action", to=...),
    "an action of text": lambda rows: changed(rows, 2, "action", to="move"),
    "an action of null": lambda rows: changed(rows, 2, "action", "do", to=None),
    "a far action": lambda rows: changed(rows, 2, "action", to={"do": "move", "east": 10**400, "north": 0}),
    "utak nowhere": lambda rows: changed(rows, 2, "utak", to=None),
    "utak not a number": lambda rows: changed(rows, 2, "utak", to=[float("nan"), 1.0]),
    "utak far away": lambda rows: changed(rows, 2, "utak", to=[1e300, 1.0]),
    "no objects": lambda rows: changed(rows, 2, "objects", to=...),
    "objects in a list": lambda rows: changed(rows, 2, "objects", to=[[1]]),
    "levels of 9": lambda rows: changed(rows, 2, "retina", to=[9] * 160),
    "few levels": lambda rows: changed(rows, 2, "retina", to=[1]),
    "touch of numbers": lambda rows: changed(rows, 2, "touch", to=[1] * 8),
    "no belief": lambda rows: changed(rows, 2, "belief", to=...),
    "belief in a list": lambda rows: changed(rows, 2, "belief", to=["node(o1)."]),
    "facts of numbers": lambda rows: changed(rows, 2, "belief", "facts", to=[1]),
    "facts that are rules": lambda rows: changed(rows, 2, "belief", "facts", to=["node(X) :- kind(X)."]),
    "facts with a variable": lambda rows: changed(rows, 2, "belief", "facts", to=["node(X)."]),
    "facts beyond 32 bits": lambda rows: changed(rows, 2, "belief", "facts", to=["offset(o1,3000000000,1)."]),
    "facts with a control character": lambda rows: changed(rows, 2, "belief", "facts", to=["node(\x1b)."]),
    "why a number": lambda rows: changed(rows, 2, "why", to=7),
    "a result of text": lambda rows: changed(rows, -1, "result", to="done"),
    "a reason of null": lambda rows: changed(rows, -1, "result", "reason", to=None),
    "no verdict": lambda rows: changed(rows, -1, "result", "verdict", to=...),
    "steps of text": lambda rows: changed(rows, -1, "result", "steps", to="3"),
    "a key twice": lambda rows: changed(rows, 2, "why", to="x").replace('"why": "x"', '"why": "x", "why": "y"'),
    "a number too long": lambda rows: changed(rows, 2, "utak", to=[1, 1]).replace("[1, 1]", f"[1, {'9' * 5000}]"),
    "too many brackets": lambda rows: changed(rows, 2, "why", to="x").replace('"x"', "[" * 200_000),
    "infinity": lambda rows: changed(rows, 2, "utak", to=[1, 1]).replace("[1, 1]", "[1, -Infinity]"),
    "a result amid": lambda rows: "".join(json.dumps(rows[n]) + "\n" for n in (0, 1, -1, 2)),
    "two headers": lambda rows: "".join(json.dumps(rows[n]) + "\n" for n in (0, 0, 1, 2)),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_damage_is_reported_at_its_place(name: str, lines: list[dict[str, Any]], tmp_path: Path) -> None:
    path = tmp_path / "ep.jsonl"
    path.write_text(DAMAGE[name](lines))
    with pytest.raises(BadInputError, match=PLACE):
        looked_through(path)


BYTES = {
    "not UTF-8": b'{"utak": "episode", "version": 1, "x": "\xff"}\n',
    "UTF-16": '{"utak": "episode"}\n'.encode("utf-16"),
    "binary": bytes(range(256)) * 10,
    "nothing": b"",
    "empty lines": b"\n\n\n",
}


@pytest.mark.parametrize("name", BYTES)
def test_bytes_that_are_no_text_are_reported(name: str, tmp_path: Path) -> None:
    path = tmp_path / "ep.jsonl"
    path.write_bytes(BYTES[name])
    with pytest.raises(BadInputError, match=PLACE):
        looked_through(path)


def test_the_column_is_that_of_the_key(lines: list[dict[str, Any]], tmp_path: Path) -> None:
    path = tmp_path / "ep.jsonl"
    path.write_text(changed(lines, 2, "retina", to=[9] * 160))
    with pytest.raises(BadInputError) as caught:
        read_episode(path)
    problem = caught.value.problems[0]
    assert problem.span.line == 3
    assert path.read_text().splitlines()[2][problem.span.start - 1 :].startswith('"retina"')


@pytest.mark.parametrize(
    "name", ["a table of 100,000 squares", "belief in a list", "a seed of text", "facts with a variable"]
)
def test_every_command_reports_damage_with_its_exit_code(
    name: str,
    lines: list[dict[str, Any]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "ep.jsonl"
    path.write_text(DAMAGE[name](lines))
    assert main(["query", str(path), "node(X)", "--at", "1"]) == 65
    scene = str(write_scene(tmp_path / "s", 1))
    if name != "facts with a variable":  # read only by queries
        assert main(["run", scene, "--log", str(path), "--resume"]) == 65
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"show\nstep\nfacts\n?- node(X).\nshow\n")))
    code = main(["repl", str(path)])
    seen = capsys.readouterr()
    assert code == 65 or PLACE.search(seen.err)
    assert "bug" not in seen.out + seen.err


VALUES = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5), st.just([]), st.just({}),
    st.lists(st.floats(), max_size=4), st.lists(st.lists(st.integers(-9, 99), max_size=3), max_size=4),
    st.just(10**400),
)  # fmt: skip


def places(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Yield the paths to all values inside a value."""
    inner = value.items() if isinstance(value, dict) else enumerate(value[:3]) if isinstance(value, list) else ()
    return [at, *(path for key, one in inner for path in places(one, (*at, key)))]


@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_changed_episode_is_read_or_refused(data: st.DataObject, lines: list[dict[str, Any]], tmp_path: Path) -> None:
    number = data.draw(st.sampled_from([0, 0, 1, 2, len(lines) - 1]))
    path = data.draw(st.sampled_from([where for where in places(lines[number]) if where]))
    text = changed(lines, number, *path, to=data.draw(VALUES | st.just(...)))
    for _ in range(data.draw(st.sampled_from([0, 0, 1]))):
        at = data.draw(st.integers(0, len(text) - 1))
        text = text[:at] + data.draw(st.text(max_size=2)) + text[at + data.draw(st.integers(0, 40)) :]
    file = tmp_path / "ep.jsonl"
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        looked_through(file)
    except BadInputError as bad:
        assert PLACE.search(str(bad))


@pytest.mark.long
@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_changed_scenario_is_read_or_refused(data: st.DataObject, tmp_path: Path) -> None:
    shutil.rmtree(tmp_path / "s", ignore_errors=True)
    folder = write_scene(tmp_path / "s", data.draw(st.integers(1, 4)))
    (folder / "start.lp").write_text("object(x). door(d).\nshape(x, square). confidence(colour(x, g), 60).\n")
    (folder / "goal.lp").write_text("first(at(utak, x)). then(in(x, room(next))).\nnot_through(utak, d).\n")
    for _ in range(data.draw(st.integers(1, 3))):
        file = folder / data.draw(st.sampled_from(["world.lp", "start.lp", "goal.lp", "expect.lp"]))
        text = file.read_text() if file.exists() else "fails."
        at = data.draw(st.integers(0, len(text)))
        bit = data.draw(
            st.sampled_from(["(", ")", ".", '"', ",", "99999999999", "-", "1e309", "%*", "\x00", "x", "nan", ""])
        )
        text = text[:at] + bit + text[at + data.draw(st.integers(0, 30)) :]
        file.write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        read_scenario(folder)
    except BadInputError as bad:
        assert re.search(r":\d+:\d+-\d+: error: ", str(bad))
    except CannotOpenError:
        pass


def test_a_table_is_bounded_in_worlds_and_episodes(lines: list[dict[str, Any]], tmp_path: Path) -> None:
    """A table of 100,000 squares a side would take 10 GB."""
    folder = write_scene(tmp_path / "s", 1)
    (folder / "world.lp").write_text((folder / "world.lp").read_text().replace("table(", "table(100000, 100000). %"))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for command in (["show"], ["check"], ["run"], ["query"]):
        assert main([*command, str(folder), *(["node(X)"] if command == ["query"] else [])]) == 65
    (tmp_path / "ep.jsonl").write_text(DAMAGE["a table of 100,000 squares"](lines))
    assert main(["query", str(tmp_path / "ep.jsonl"), "node(X)"]) == 65
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # kilobytes


def test_an_episode_without_steps_is_not_explained(lines: list[dict[str, Any]], tmp_path: Path) -> None:
    path = tmp_path / "ep.jsonl"
    path.write_text(json.dumps(lines[0]) + "\n")
    for question in ([], ["--cell", "40"], ["node(o1)"]):
        assert main(["explain", str(path), *question]) == 65


def test_nothing_is_quoted_of_what_a_link_leads_to(tmp_path: Path, lines: list[dict[str, Any]]) -> None:
    """Neither of the header nor of keys further on; a link within its folder is read like the file itself."""
    home = tmp_path / "home"
    home.mkdir()
    bad_version = [{**lines[0], "version": "secret"}]
    twice = [lines[0], {**lines[1], "utak": {"secret": 1}}]
    for number, rows in enumerate((bad_version, twice)):
        for place, is_told in ((tmp_path / f"far{number}", False), (home / f"near{number}", True)):
            text = "".join(json.dumps(row) + "\n" for row in rows)
            place.write_text(text.replace('{"secret": 1}', '{"secret": 1, "secret": 2}'))
            link = home / f"link-{place.name}"
            link.symlink_to(place)
            with pytest.raises(BadInputError) as caught:
                read_episode(link)
            assert ("secret" in str(caught.value)) == is_told
            assert ("leads out of its folder" in str(caught.value)) != is_told
