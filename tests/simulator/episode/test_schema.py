"""`utak schema`: real episodes and outputs have the form it prints; damaged ones it refuses just as our check does."""

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from utak.kb.body import DIRECTIONS
from utak.kb.evidence.reason import ReasonKind
from utak.kb.language.vocabulary import MAX_TABLE_SIDE, VERDICT_WORDS
from utak.simulator.cli.main import main
from utak.simulator.cli.table import SCHEMA_NAMES
from utak.simulator.episode.schema import EPISODE_LINES, EPISODE_VERSION, accepts, definitions
from utak.simulator.scenario.settings import PATH_CHOICES

pytestmark = pytest.mark.long

jsonschema = pytest.importorskip("jsonschema")
ROOT = Path(__file__).resolve().parents[3]
RUNS = (("push_square_next_room", "0.05"), ("go_northeast", "0"))  # scenario and noise


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> Any:
    """Return the JSON that a command prints."""
    capsys.readouterr()
    assert main(list(arguments)) in (0, 1, 75)
    return json.loads(capsys.readouterr().out)


@pytest.fixture(scope="module")
def validators() -> dict[str, Any]:
    """Return a validator for each name of `utak schema`."""
    found = {}
    for name in SCHEMA_NAMES:
        with pytest.MonkeyPatch.context() as patch:
            said: list[str] = []
            patch.setattr(
                "sys.stdout",
                type(
                    "Out", (), {"write": lambda self, text, said=said: said.append(text), "flush": lambda self: None}
                )(),
            )
            assert main(["schema", name]) == 0
        schema = json.loads("".join(said))
        jsonschema.Draft202012Validator.check_schema(schema)
        found[name] = jsonschema.Draft202012Validator(schema)
    return found


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    """Return the lines of real episodes: a header, steps and an end of each."""
    found = []
    for name, noise in RUNS:
        log = tmp_path_factory.mktemp("episodes") / "ep.jsonl"
        main(["run", str(ROOT / "examples" / name), "--noise", noise, "--max-steps", "5", "--log", str(log)])
        found += [json.loads(line) for line in log.read_text().splitlines()]
    return found


def form_of(line: dict[str, Any]) -> str:
    """Return the name of the form that a line should have."""
    return "header" if "utak" in line and "version" in line else "end" if "result" in line else "step"


def test_every_line_of_real_episodes_has_its_form(lines: list[dict[str, Any]], validators: dict[str, Any]) -> None:
    assert {form_of(line) for line in lines} == set(EPISODE_LINES)
    for line in lines:
        for name in ("episode", form_of(line)):
            assert [error.message for error in validators[name].iter_errors(line)] == []
        others = set(EPISODE_LINES) - {form_of(line)}
        assert not any(validators[name].is_valid(line) for name in others)


def test_every_key_of_a_real_belief_is_described(lines: list[dict[str, Any]], validators: dict[str, Any]) -> None:
    described = validators["step"].schema["$defs"]["belief"]["properties"]
    assert {key for line in lines if form_of(line) == "step" for key in line["belief"]} <= set(described)


def test_outputs_of_commands_have_the_forms(
    validators: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario, log = str(ROOT / "examples" / "go_northeast"), str(tmp_path / "ep.jsonl")
    outputs = {
        "run": [printed(capsys, "run", scenario, "--json", "--max-steps", "2", "--log", log)],
        "query": [
            printed(capsys, "query", log, query, "--json", "--at", "1")
            for query in ("kind(X, K, C)", "node(org)", "node(X), shape(X, disc, 100)", "held(org)", "X = 1..3")
        ],
        "routes": [
            printed(capsys, "routes", scenario, "--from", "3.5,3.5", "--to", to, "--json")
            for to in ("9.5,8.5", "3.5,3.5")
        ],
    }
    for name, values in outputs.items():
        for value in values:
            assert [error.message for error in validators[name].iter_errors(value)] == []
            assert accepts(name, value)
            for key in value:
                assert not validators[name].is_valid({k: v for k, v in value.items() if k != key})


def test_trees_of_reasons_and_sweeps_have_the_forms(
    validators: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario, log, rows = str(ROOT / "examples" / "go_northeast"), str(tmp_path / "ep.jsonl"), tmp_path / "rows.jsonl"
    printed(capsys, "run", scenario, "--json", "--max-steps", "2", "--log", log)
    questions = ([], ["verdict(V)"], ["kind(floor, K, C)"], ["--whynot", "held(o1)"], ["--cell", "3"])
    trees = [printed(capsys, "explain", log, "--json", *words) for words in questions]
    for tree in trees:
        assert [error.message for error in validators["explain"].iter_errors(tree)] == []
        assert accepts("explain", tree)
    deep = next(tree for tree in trees if any("rests_on" in below for below in tree.get("rests_on", ())))
    lower = next(below for below in deep["rests_on"] if "rests_on" in below)["rests_on"][0]
    for damage in ({"kind": "guess"}, {"claim": None}, {"rests_on": {}}, {"rests_on": [{}]}):
        kept = {key: lower.get(key) for key in damage}
        lower |= damage
        assert not validators["explain"].is_valid(deep) and not accepts("explain", deep)
        lower |= kept
        for key in (key for key, value in kept.items() if value is None):
            del lower[key]
    assert accepts("explain", deep)
    sweep = ["sweep", scenario, "--seeds", "0:2", "--max-steps", "1", "-o", str(rows), "--json"]
    summary = printed(capsys, *sweep)
    lines = [json.loads(line) for line in rows.read_text().splitlines()]
    assert len(lines) == 2
    for name, value in (("sweep", summary), ("sweep_row", lines[0]), ("sweep_row", {**lines[1], "result": None})):
        assert [error.message for error in validators[name].iter_errors(value)] == []
        assert accepts(name, value)
        for key in value:
            assert not validators[name].is_valid({k: v for k, v in value.items() if k != key})


VALUES = st.one_of(
    st.none(), st.booleans(), st.integers(-3, 200), st.integers(), st.floats(allow_nan=False, allow_infinity=False),
    st.text(max_size=4), st.sampled_from(["done", "move", "node(o1).", "node(o1).\n", "7" * 160, "e" * 159, "grasp"]),
    st.just([]), st.just({}), st.lists(st.integers(0, 9), max_size=4), st.just({"do": "turn"}), st.just({"rotate": 1}),
    st.just(10**400), st.just(["x", [0, 0]]), st.just([[0, 0], [1, 1], [0, 1]]),
)  # fmt: skip


def places(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the paths to the values inside a value; of long lists, to the first three."""
    inner = value.items() if isinstance(value, dict) else enumerate(value[:3]) if isinstance(value, list) else ()
    return [at, *(path for key, one in inner for path in places(one, (*at, key)))]


def has_whole_floats(value: Any) -> bool:
    """Return whether a value holds a number such as 1.0, which for JSON Schema is an integer."""
    if isinstance(value, dict | list):
        return any(map(has_whole_floats, value.values() if isinstance(value, dict) else value))
    return isinstance(value, float) and value.is_integer()


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_schema_and_check_agree_about_damaged_lines(
    data: st.DataObject, lines: list[dict[str, Any]], validators: dict[str, Any]
) -> None:
    line = copy.deepcopy(lines[data.draw(st.sampled_from([0, 1, 2, 3, len(lines) - 2, len(lines) - 1]))])
    name = form_of(line)
    *path, key = data.draw(st.sampled_from([where for where in places(line) if where]))
    holder: Any = line
    for step in path:
        holder = holder[step]
    if data.draw(st.booleans()) and isinstance(holder, dict):
        del holder[key]
    else:
        value = data.draw(VALUES.filter(lambda one: not has_whole_floats(one)))
        holder[key] = value
    assert validators[name].is_valid(line) == accepts(name, line)


def test_further_keys_are_accepted_by_both(lines: list[dict[str, Any]], validators: dict[str, Any]) -> None:
    line = copy.deepcopy(lines[1])
    line["newer"] = line["belief"]["newer"] = {"anything": [1.5, None]}
    assert validators["step"].is_valid(line)
    assert accepts("step", line)
    for key in set(line["belief"]) - {"facts"}:
        del line["belief"][key]  # an older episode
        assert validators["step"].is_valid(line)
        assert accepts("step", line)


def test_words_of_the_schema_are_those_of_the_code() -> None:
    known = definitions()
    assert known["result"]["properties"]["verdict"]["enum"] == list(VERDICT_WORDS)
    assert known["options"]["properties"]["paths"]["enum"] == list(PATH_CHOICES)
    assert known["explain"]["properties"]["kind"]["enum"] == list(map(str, ReasonKind))
    assert known["header"]["properties"]["version"]["enum"] == [EPISODE_VERSION]
    assert known["world"]["properties"]["table"]["items"]["maximum"] == MAX_TABLE_SIDE
    grasp = next(one["then"] for one in known["action"]["allOf"] if "direction" in one["then"].get("properties", {}))
    assert grasp["properties"]["direction"]["enum"] == list(DIRECTIONS)


def test_an_unknown_name_is_misuse() -> None:
    assert main(["schema", "banana"]) == 2
