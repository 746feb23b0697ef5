"""The vocabulary page is what the encodings say, and the world model states the facts that they declare."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.kb.drawings import known_model
from utak.geometry.shapes.classes import CLASSES
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import source_from_bytes
from utak.kb.language.vocabulary import (
    BELIEF_PREDICATES,
    GOAL_VOCABULARY,
    OUTLINE_CLASSES,
    SETTLING_STEPS,
    SHAPE_CLASSES,
)
from utak.kb.world.corners import corners
from utak.kb.world.facts import Places, model_facts
from utak.kb.world.rooms import rooms_of

ROOT = Path(__file__).resolve().parent.parent
SCRIPT = ROOT / "docs" / "build_vocabulary.py"
BELIEF = ROOT / "kb" / "asp" / "belief.lp"
spec = importlib.util.spec_from_file_location("build_vocabulary", SCRIPT)
assert spec is not None
assert spec.loader is not None
build = importlib.util.module_from_spec(spec)
spec.loader.exec_module(build)


def test_the_page_is_not_stale_and_every_interface_is_documented() -> None:
    found = subprocess.run([sys.executable, str(SCRIPT), "--check"], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr


def test_what_is_not_documented_is_found() -> None:
    text = "% Title.\n%*! p(A, B)   Text. *%\n#defined p/2.\n#defined q/1.\nr :- p(_, _).\n#show r/0.\n"
    assert build.undocumented(text) == {("q", 1), ("r", 0)}
    (entry,) = build.entries(text)
    assert entry == ("p(A, B)", ("p", 2), "Text.", (), "in")


def test_arguments_are_told_apart() -> None:
    block = "%*! p(A, B)\n    What it\n    says.\n    Args:\n      - A: one\n        thing\n      - B: other *%\n"
    text = f"{block}p(1, 2).\n#show p/2.\n"
    assert build.entries(text) == [("p(A, B)", ("p", 2), "What it says.", ("A: one thing", "B: other"), "out")]


def declared() -> set[tuple[str, int]]:
    """The documented predicates, with the short forms of those that have one."""
    long = {entry.signature for entry in build.entries(BELIEF.read_text())}
    return long | {(name, arity - 1) for name, arity in long if BELIEF_PREDICATES[name, arity].short}


def test_queries_know_the_declared_facts() -> None:
    assert set(BELIEF_PREDICATES) - {("object", 1)} == declared()


def test_each_step_that_settles_something_has_its_rules() -> None:
    texts = [file.read_text() for file in (ROOT / "planner" / "asp" / "task").glob("*.lp")]
    assert {name for text in texts for name in re.findall(r"^settles\((\w+)\(", text, re.MULTILINE)} == set(
        SETTLING_STEPS
    )


def test_tasks_can_claim_each_class_of_shapes() -> None:
    assert {one.name for one in CLASSES} == set(OUTLINE_CLASSES)


@pytest.mark.parametrize(
    ("page", "words"),
    [
        ("files", {*SHAPE_CLASSES, *GOAL_VOCABULARY}),
        ("planning", set(SETTLING_STEPS)),
        ("architecture", set(SETTLING_STEPS)),
    ],
)
def test_pages_have_each_word_of_the_tables(page: str, words: set[str]) -> None:
    text = re.sub("```.*?```", "", (ROOT / "docs" / f"{page}.md").read_text(), flags=re.DOTALL)
    code = re.findall("`[^`]+`", text)
    assert words <= set(re.findall(r"\w+", " ".join(code)))


def test_the_world_model_writes_declared_facts_alone() -> None:
    left, right, wall = "b" + "." * 14 + "bb", "." * 14 + "b", "b" * 32
    rows = [wall, *[left + right] * 5, *["b" + "." * 30 + "b"] * 4, *["b..ggg" + left[6:] + right] * 2]
    rows += ["b.....U" + left[7:] + right, left + right, wall]
    model = known_model(rows)
    facts = parse_facts(
        source_from_bytes("facts", "".join(f"{fact}.\n" for fact in model_facts(model, places(model))).encode())
    )
    written = {fact.signature for fact in facts}
    assert written <= declared()
    assert {("door", 2), ("connects", 4), ("width", 3), ("segment", 7), ("corner", 4), ("in", 3)} <= written
    assert {("adjacent", 3), ("region", 3), ("region", 2), ("part_of", 2)} <= written


def places(model) -> Places:  # type: ignore[no-untyped-def]
    return Places(rooms_of(model), corners(model))
