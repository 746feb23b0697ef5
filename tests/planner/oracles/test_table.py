"""The table of oracles names the facts of the task plan that come from geometry, and the modules that compute them."""

import importlib
import re
from pathlib import Path

from kb.reasoning.encodings import encoding_text
from planner.oracles.table import ORACLES
from planner.tasking.search import TASK_ENCODING

ROOT = Path(__file__).resolve().parents[3]
# Inputs of the encoding that do not come from geometry, but from the task and from what is believed; or questions.
FROM_ELSEWHERE = {"horizon/1", "thing/1", "goal/1", "fulfils/3", "rank/2", "bound/2", "shape/3", "colour/3", "asked/1"}
FROM_ELSEWHERE |= {
    "wish/2",
    "size/2",
    "may_mean/2",
    "meant_before/2",
    "about/2",
    "order/2",
    "missing/1",
    "unclear/1",
    "waits/1",
}
FROM_ELSEWHERE |= {"stuck/2", "came_to/2", "holds/1", "price/2"}


def test_each_input_of_the_encoding_comes_from_one_place() -> None:
    text = encoding_text(TASK_ENCODING)
    inputs = set(re.findall(r"^#defined (\w+/\d+)\.", text, re.MULTILINE))
    answers = {fact for oracle in ORACLES for fact in oracle.facts}
    assert answers | FROM_ELSEWHERE == inputs
    assert not answers & FROM_ELSEWHERE


def test_each_oracle_has_a_name_of_its_own_and_a_module_that_exists() -> None:
    assert len({oracle.name for oracle in ORACLES}) == len(ORACLES)
    for oracle in ORACLES:
        importlib.import_module(oracle.module)


def test_the_architecture_lists_each_oracle() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text()
    assert all(f"`{oracle.name}`" in text for oracle in ORACLES)
