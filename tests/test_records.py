"""What an episode records beside facts: checked from the episode alone, by code that shares nothing with its writer."""

import json
from pathlib import Path
from typing import Any

import clingo
import pytest

from tests.tables import few
from utak.kb.reasoning.encodings import all_encodings, encoding_text
from utak.simulator.cli.main import main

ROOT = Path(__file__).resolve().parent.parent
RUNS = [  # scenario and noise
    ("go_next_room_askew", "0"),
    ("push_square_next_room", "0"),
    ("push_l_tight_door", "0.05"),
    ("go_northeast_rooms", "0.05"),
]
Line = dict[str, Any]


@pytest.fixture(scope="module", params=few([(run,) for run in RUNS], 1), ids=lambda run: f"{run[0]}-{run[1]}")
def steps(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[Line]:
    name, noise = request.param
    log = tmp_path_factory.mktemp("records") / f"{name}.jsonl"
    options = ["--noise", noise, "--seed", "5", "--max-steps", "40", "--log", str(log)]
    assert main(["run", str(ROOT / "examples" / name), *options]) in (0, 1, 75)
    return [line for line in map(json.loads, log.read_text().splitlines()) if "step" in line]


def test_every_field_is_predicted_explained_or_noise(steps: list[Line]) -> None:
    for line in steps:
        belief = line["belief"]
        assert len(belief["status"]) == len(belief["least"]) == len(belief["most"]) == 160
        assert set(belief["status"]) <= set("pen")
        words = {"p": "predicted", "e": "explained", "n": "noise"}
        assert belief["cells"] == {words[s]: belief["status"].count(s) for s in sorted(set(belief["status"]))}


def test_noise_is_what_the_map_does_not_allow(steps: list[Line]) -> None:
    for line in steps:
        belief = line["belief"]
        for level, status, least, most in zip(
            line["retina"], belief["status"], belief["least"], belief["most"], strict=True
        ):
            allowed = int(least) <= level <= int(most)
            assert allowed == (status != "n"), (line["step"], level, status, least, most)


def test_each_explained_field_is_laid_to_one_believed_fact(steps: list[Line]) -> None:
    for line in steps:
        belief = line["belief"]
        named = sorted(field for fields in belief["explained"].values() for field in fields)
        assert named == [n for n, status in enumerate(belief["status"]) if status == "e"]
        assert set(belief["explained"]) <= set(belief["facts"])


def test_free_fields_are_laid_to_the_floor_and_full_ones_to_no_floor(steps: list[Line]) -> None:
    extreme = [
        (line["retina"][field], fact)
        for line in steps
        for fact, fields in line["belief"]["explained"].items()
        for field in fields
        if line["retina"][field] in (0, 7)
    ]
    wrong = [(level, fact) for level, fact in extreme if (level == 0) != fact.startswith("kind(floor,")]
    assert extreme
    assert len(wrong) <= len(extreme) // 100  # a motion that went otherwise may leave a field to squares seen before


def test_places_grow_by_the_newest_unless_all_are_given_anew(steps: list[Line]) -> None:
    places: list[list[float]] = []
    for line in steps:
        belief = line["belief"]
        given = belief.get("seen_from")
        places = [*places, belief["place"]] if given is None else given
        assert len(places) == line["step"] + 1
        assert 0 <= belief["map_from"] < len(places)


def test_every_decision_is_what_plain_clingo_finds(steps: list[Line]) -> None:
    written: dict[tuple[int, int], list[Any]] = {}
    texts = {path.stem: encoding_text(path) for path in all_encodings()}
    for line in steps:
        for index, entry in enumerate(line["belief"]["solved"]):
            if len(entry) == 2:
                assert entry[0] == written[tuple(entry[1])][0]
                continue
            written[line["step"], index] = entry
    for encoding, facts, answer, _ in written.values():
        control = clingo.Control(["--warn=none", "--opt-mode=opt"])
        control.add("base", [], texts[encoding] + "".join(f"{fact}.\n" for fact in facts))
        control.ground([("base", [])])
        best: list[str] | None = None
        cost: list[int] = []
        with control.solve(yield_=True) as models:
            for model in models:
                best, cost = sorted(str(atom) for atom in model.symbols(shown=True)), model.cost
        if best != answer:  # another optimum: the recorded one must cost as much
            assert answer is not None
            chosen = clingo.Control(["--warn=none"])
            forced = "".join(f":- not {atom}.\n" for atom in answer)
            chosen.add("base", [], texts[encoding] + "".join(f"{fact}.\n" for fact in facts) + forced)
            chosen.ground([("base", [])])
            found: list[list[int]] = []
            chosen.solve(on_model=lambda model, found=found: found.append(model.cost))
            assert found
            assert found[-1] == cost


def test_routes_name_at_most_one_that_was_chosen(steps: list[Line]) -> None:
    weighed = [route for line in steps for route in [line["belief"].get("routes", [])] if route]
    assert all(sum(route["chosen"] for route in routes) <= 1 for routes in weighed)
    assert all(len(route["points"]) >= 2 for routes in weighed for route in routes)
