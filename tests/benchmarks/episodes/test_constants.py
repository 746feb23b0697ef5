"""The benchmark of constants: each is found, replaced in the solver, and its row tells what came of it."""

from benchmarks.episodes.constants import WithConstant, constants, neighbours, replacing, table
from utak.planner.question import Question, argument

TWO_MISSES = ("to_bring(o1)", "has_end(o1)", "end_open(o1)", "misses(o1,2)", "vain(examine)")


def brought(constant: str) -> str:
    with replacing(constant):
        return str(argument(Question(facts=TWO_MISSES).answer("bring") or (), "bring"))


def test_a_constant_is_replaced_in_what_is_solved() -> None:
    assert brought("") == "search"
    assert brought(f"most_misses={neighbours(constants()['most_misses'])[1]}") == "carry"
    assert brought("") == "search"


def test_each_constant_of_the_planner_has_a_value() -> None:
    known = constants()
    assert {"long_plan", "most_contacts", "price_of_measure"} <= known.keys()
    assert all(low < value < high for value in known.values() for low, high in [neighbours(value)])


def test_commands_are_compared_in_worlds_that_both_achieve() -> None:
    found = {"": WithConstant({"5:0": 8, "5:1": 10}, 0), "few_looks=8": WithConstant({"5:1": 12}, 1)}
    *_, row = table(found, {"few_looks": 4}, 2).splitlines()
    assert row.split() == ["few_looks", "4", "->", "8", "1", "1", "12", "10"]
