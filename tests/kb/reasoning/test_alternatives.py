"""The chances in the possible worlds of a step are those that its facts state; users' rules add evidence."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.query import Alternatives, QueryEngine, worlds_request
from utak.kb.tracing.possible_worlds import likeliest_worlds

STEP = ["node(o1).", "kind(o1,object,80).", "kind(o1,verge,20).", "shape(o1,square,60).", "shape(o1,brick,30).",
        "shape(o1,disc,0).", "shape(o1,rectangle,90).", "shape(o1,polygon,100).", "movable(o1,50).",
        "colour(o1,g,100).", "segment(o1,0,0,0,1,1,40)."]  # fmt: skip
ROUNDED = 0.0006  # of a chance: weights are whole thousandths of nats


def worlds_of(facts: Sequence[str], tmp_path: Path | None = None, rules: str = "", number: int = 100) -> Alternatives:
    with QueryEngine() as engine:
        if tmp_path is not None:
            path = tmp_path / "rules.lp"
            path.write_text(rules)
            engine.use_rules([str(path)])
        return engine.worlds(facts, number)


def test_chances_are_those_that_are_stated() -> None:
    found = worlds_of(STEP)
    chances = {fact: least for fact, least, _, _ in found.open}
    stated = {
        "kind(o1,object)": 0.8,
        "kind(o1,verge)": 0.2,
        "shape(o1,square)": 0.6,
        "shape(o1,brick)": 0.3,
        "movable(o1)": 0.5,
    }
    assert chances == pytest.approx(stated, abs=ROUNDED)
    assert all(least == greatest for _, least, greatest, _ in found.open)
    assert {fact: acts for fact, _, _, acts in found.open}["kind(o1,verge)"] == ("feel(o1)",)


def test_all_worlds_are_one_together() -> None:
    found = worlds_of(STEP)
    assert len(found.worlds) == 2 * 3 * 2
    assert sum(world.chance for world in found.worlds) == pytest.approx(1.0)
    chances = [world.chance for world in found.worlds]
    assert chances == sorted(chances, reverse=True)
    assert {"kind(o1,object)", "shape(o1,square)"} <= set(found.worlds[0].facts)


def test_what_is_settled_leaves_one_world() -> None:
    found = worlds_of(["node(o1).", "kind(o1,object,100).", "movable(o1,0).", "room(r1)."])
    assert [world.chance for world in found.worlds] == [1.0]
    assert not found.open


@given(st.lists(st.integers(1, 100), min_size=1, max_size=6), st.lists(st.integers(0, 100), max_size=5))
@settings(max_examples=40, deadline=None)
def test_any_statements_keep_their_chances(parts: list[int], single: list[int]) -> None:
    """Classes of shapes that share 100 percent, and facts that stand by themselves."""
    classes = ["square", "brick", "l_shape", "t_shape", "u_shape", "triangle"][: len(parts)]
    percents = [100 * part // sum(parts) for part in parts]
    stated = {f"shape(o1,{name})": percent for name, percent in zip(classes, percents, strict=True)}
    stated |= {f"movable(o{number})": percent for number, percent in enumerate(single, 1)}
    facts = [f"{fact[:-1]},{percent})." for fact, percent in stated.items()]
    found = likeliest_worlds(**worlds_request(facts, (), 1))
    chances = {fact: chance for fact, chance, _, _ in found["open"]}
    expected = {fact: percent / 100 for fact, percent in stated.items() if 0 < percent < 100}
    assert chances == pytest.approx(expected, abs=ROUNDED)


def test_a_rule_of_a_user_is_evidence(tmp_path: Path) -> None:
    found = worlds_of(STEP, tmp_path, ":- true(shape(o1, square)), not true(kind(o1, verge)).")
    chances = {fact: least for fact, least, _, _ in found.open}
    # Of what was likely, all worlds with a square that is no verge are gone: 0.8 * 0.6 of them.
    assert chances["kind(o1,object)"] == pytest.approx(0.8 * 0.4 / (1 - 0.8 * 0.6), abs=2 * ROUNDED)
    assert chances["movable(o1)"] == pytest.approx(0.5, abs=ROUNDED)


def test_a_weight_of_a_user_counts(tmp_path: Path) -> None:
    found = worlds_of(STEP, tmp_path, ":~ true(movable(N)). [693@1, N]")
    assert {fact: least for fact, least, _, _ in found.open}["movable(o1)"] == pytest.approx(1 / 3, abs=ROUNDED)


def test_rules_that_leave_no_world_are_told(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="no world agrees"):
        worlds_of(STEP, tmp_path, ":- true(kind(N, object)). :- true(kind(N, verge)), stated(kind(N, object), _).")


def test_rules_cannot_speak_of_facts_that_there_are_not(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="unknown fact"):
        worlds_of(STEP, tmp_path, ":- true(shap(o1, square)).")
