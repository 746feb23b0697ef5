"""Integers are checked wherever text enters, and all JSON that is printed is read by a strict parser."""

import argparse
import io
import json
import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path

import pytest
import scripted_robot
from hypothesis import given, settings
from hypothesis import strategies as st
from random_scenes import write_scene

from utak.geometry.io.movingai import MapError, parse_map
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.reader import facts_from_text
from utak.kb.language.wkt import WktError, parse_wkt
from utak.kb.reasoning.query import QueryEngine
from utak.kb.reasoning.user_rules import read_tested_rules
from utak.simulator.cli import parsing
from utak.simulator.cli.main import main
from utak.simulator.terminal.printing import as_json


@pytest.fixture(scope="module")
def engine():
    with QueryEngine(seconds=20.0) as running:
        yield running


WIDE = st.integers(2**31, 2**80) | st.integers(-(2**80), -(2**31) - 1)
NARROW = st.integers(-(2**31), 2**31 - 1)


@settings(max_examples=60, deadline=None)
@given(WIDE)
def test_no_integer_beyond_32_bits_enters(engine: QueryEngine, number: int) -> None:
    for text in (f"offset(o1, {number}, 50)", f"X = {number}", f"#count{{X : node(X)}} < {number}", f"X = 1..{number}"):
        with pytest.raises(BadInputError, match="beyond 32 bits"):
            engine.ask([], text)
    with pytest.raises(BadInputError, match="beyond 32 bits"):
        engine.ask([f"offset(o1,{number},50)."], "node(X)")  # as an episode may state it
    with pytest.raises(BadInputError, match="beyond 32 bits"):
        facts_from_text(f"p(f({number})).")


@settings(max_examples=60, deadline=None)
@given(NARROW)
def test_every_integer_of_32_bits_enters_as_it_is(engine: QueryEngine, number: int) -> None:
    assert engine.ask([f"offset(o1,{number},50)."], "offset(o1, X, _)").rows == ((number,),)
    assert engine.ask([f"offset(o1,{number},50)."], f"offset(o1, {number}, 50)").kind == "yes"
    assert engine.ask([], f"X = {number}").rows == ((number,),)
    assert [str(fact) for fact in facts_from_text(f"p({number}).")] == [f"p({number})"]


@pytest.mark.parametrize("number", ["2147483648", "-2147483649", "4294967546", "0x100000000", "9" * 200])
def test_rules_hold_no_integer_beyond_32_bits(tmp_path: Path, number: str) -> None:
    path = tmp_path / "rules.lp"
    for rules in (f"p({number}).", f"#const n={number}.\np(n).", f"p(X) :- q(X), X < {number}. q(1)."):
        path.write_text(rules)
        with pytest.raises(BadInputError, match="beyond 32 bits"):
            read_tested_rules([path])
    path.write_text(f'p("{number}"). % {number}\n%* {number} *%')
    read_tested_rules([path])


SPELT = ["99999999999999999999", "1_0", "\uff11", "1.0", "1e1", "0x1", "", " ", "--1", "nan", "inf", "1" * 5000]
OPTIONS: dict[str, list[str]] = {
    "--seed": ["run", "x", "--seed"],
    "--max-steps": ["run", "x", "--max-steps"],
    "--at": ["query", "x", "node(X)", "--at"],
    "-k": ["routes", "x", "--from", "1,1", "--to", "2,2", "-k"],
}


@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("text", SPELT)
def test_integers_on_the_command_line(option: str, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*OPTIONS[option][:-1], f"{option}={text}" if option.startswith("--") else f"{option}{text}"]) == 2
    assert "usage:" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["nan", "inf", "1e999", "0x1", "\uff11", "1_0", "", "2"])
def test_numbers_on_the_command_line(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "x", f"--noise={text}"]) == 2
    if text != "2":
        assert main(["routes", "x", f"--from={text},1", "--to=1,1"]) == 2
    assert main(["routes", "x", f"--from=1,1,{text}", "--to=1,1"]) == 2


@settings(max_examples=60, deadline=None)
@given(st.integers(10**7, 10**40))
def test_numbers_of_shapes_and_maps_are_bounded(number: int) -> None:
    with pytest.raises(WktError, match="beyond 1000000 squares"):
        parse_wkt(f"POINT (1 {number})")
    with pytest.raises(MapError):
        parse_map(f"height {number}\nwidth 1\nmap\n.\n".encode())


# ---- JSON ----


def strictly(text: str) -> object:
    def refuse(word: str) -> object:
        raise ValueError(f"{word} is no JSON")

    return json.loads(text, parse_constant=refuse)


def printing_commands() -> set[str]:
    """Return the subcommands that have --json."""
    (parts,) = (a for a in parsing.build_parser()._actions if isinstance(a, argparse._SubParsersAction))
    return {name for name, part in parts.choices.items() if "--json" in part._option_string_actions}


def run(scene: Path, tmp_path: Path) -> list[list[str]]:
    return [["run", str(scene), "--max-steps", "3"]]


def query(scene: Path, tmp_path: Path) -> list[list[str]]:
    texts = ("unseen(R, N)", "object(o9)", "#true", 'X = "a\\\\b"', "X = #inf", "X = f(1, (a, #sup))")
    return [["query", str(scene), text, "--max-steps", "1"] for text in texts]


def routes(scene: Path, tmp_path: Path) -> list[list[str]]:
    path = tmp_path / "a.map"
    path.write_text("type octile\nheight 3\nwidth 5\nmap\n.....\n.@.@.\n.....\n")
    ends = [("0.5,0.5", "4.5,2.5"), ("0.5,0.5", "0.5,0.5"), ("0,0", "4.9,2.9")]
    return [["routes", str(path), "--from", start, "--to", goal] for start, goal in ends]


def sweep(scene: Path, tmp_path: Path) -> list[list[str]]:
    return [["sweep", str(scene), "--max-steps", "1"]]


def explain(scene: Path, tmp_path: Path) -> list[list[str]]:
    log = str(tmp_path / "explained.jsonl")
    with redirect_stdout(io.StringIO()):
        assert main(["run", str(scene), "--max-steps", "1", "--log", log]) in (0, 1, 75)
    return [["explain", log, "--at", "0"]]


def suite(scene: Path, tmp_path: Path) -> list[list[str]]:
    return [["test", str(scene), "--max-steps", "1"]]


def plan(scene: Path, tmp_path: Path) -> list[list[str]]:
    return [["plan", str(scene), "--max-steps", "1"]]


PRINTED: dict[str, Callable[[Path, Path], list[list[str]]]] = {
    "run": run,
    "query": query,
    "routes": routes,
    "sweep": sweep,
    "explain": explain,
    "plan": plan,
    "test": suite,
}


def test_every_command_with_json_is_tried() -> None:
    assert printing_commands() == set(PRINTED)


@pytest.mark.long
@pytest.mark.parametrize("command", PRINTED)
def test_json_is_strict(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
    scripted_robot.install()
    for arguments in PRINTED[command](write_scene(tmp_path / "scene", 1), tmp_path):
        assert main([*arguments, "--json"]) in (0, 1, 75)
        assert isinstance(strictly(capsys.readouterr().out), dict)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), {"a": [1.0, -float("inf")]}])
def test_numbers_that_json_lacks_are_never_printed(value: object) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        as_json(value)
