"""The summary of a sweep: its counts, its rates with intervals, its picture."""

import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from utak.simulator.sweep.carrying_out import problem_of
from utak.simulator.sweep.picture import log_ticks, sweep_picture
from utak.simulator.sweep.results import ResultRow
from utak.simulator.sweep.summary import counts_of, table_of, total_of, upper_percentile, wilson_interval

OPTIONS = {"paths": "grid", "max_steps": 9, "pull": True, "utak": "0.2.0", "code": "0a", "seconds": 0.5}
SVG = "{http://www.w3.org/2000/svg}"


def ended(scenario: str, noise: float, seed: int, steps: int, believed: bool, achieved: bool | None) -> ResultRow:
    """Return the row of a run with a result."""
    result = {"believed": believed, "achieved": achieved, "verdict": "done", "reason": "", "steps": steps, "unmet": []}
    passed = None if achieved is None else believed and achieved
    row = {
        "run": "0" * 16,
        "scenario": scenario,
        "seed": seed,
        "noise": noise,
        "result": result,
        "passed": passed,
        "failed": None,
    }
    assert problem_of(row | OPTIONS) == ""
    return row


def failed(scenario: str, noise: float, seed: int, how: str) -> ResultRow:
    """Return the row of a run without a result."""
    failure = {"how": how, "reason": "a reason"}
    row = {
        "run": "0" * 16,
        "scenario": scenario,
        "seed": seed,
        "noise": noise,
        "result": None,
        "passed": False,
        "failed": failure,
    }
    assert problem_of(row | OPTIONS) == ""
    return row


ROWS = [
    ended("a", 0.0, 0, 4, True, True),
    ended("a", 0.0, 1, 10, True, False),
    ended("a", 0.0, 2, 6, False, True),
    failed("a", 0.0, 3, "time"),
    ended("a", 0.5, 0, 200, False, False),
    ended("b", 0.0, 0, 1, True, None),
]


@given(st.integers(1, 400).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_the_wilson_interval_is_where_the_score_test_rejects(numbers: tuple[int, int]) -> None:
    successes, trials = numbers
    low, high = wilson_interval(successes, trials)
    rate = successes / trials
    assert 0 <= low <= rate <= high <= 1
    for end in (low, high):
        if 0 < end < 1:  # there the standardized distance of the rate is the quantile 1.96
            assert abs(rate - end) / math.sqrt(end * (1 - end) / trials) == pytest.approx(1.959964, abs=1e-4)


@given(st.lists(st.integers(0, 300), min_size=1, max_size=60))
def test_the_percentile_is_that_of_numpy(steps: list[int]) -> None:
    assert upper_percentile(sorted(steps)) == np.percentile(steps, 95, method="inverted_cdf")


def test_runs_are_counted() -> None:
    first, second, third = counts_of(ROWS)
    assert (first.scenario, first.noise, first.runs, first.done, first.achieved) == ("a", 0.0, 4, 2, 2)
    assert [row["seed"] for row in first.false_claims] == [1]
    assert [row["seed"] for row in first.failed] == [3]
    assert (first.passed, first.judged, first.success_rate) == (1, 4, 0.25)
    assert first.steps == [4, 6, 10]
    assert second.success_rate == 0.0
    assert (third.achieved, third.success_rate, third.success_interval) == (None, None, None)
    every = total_of(counts_of(ROWS)).as_values
    assert (every["runs"], every["judged"], every["passed"], every["failed"]) == (6, 5, 1, {"time": 1})
    assert (every["steps_median"], every["steps_95_percentile"], every["false_claims"]) == (6, 200, 1)


def test_the_table_shows_counts_and_names_what_to_look_at() -> None:
    lines = table_of(counts_of(ROWS)).splitlines()
    assert " ".join(lines[0].split()) == "scenario noise runs done achieved false failed success % steps 95 %"
    assert lines[1].split() == ["a", "0", "4", "2", "2", "1", "1", "25", "(5", "to", "70)", "6", "10"]
    assert lines[3].split() == ["b", "0", "1", "1", "-", "0", "0", "-", "1", "1"]
    assert lines[4].split()[:2] == ["all", "6"]
    assert lines[5:] == [
        "believed done, but not achieved: a --seed 1 --noise 0",
        "took too long: a --seed 3 --noise 0: a reason",
    ]
    assert len(table_of(counts_of(ROWS[:4])).splitlines()) == 4, "one group needs no row for all"
    many = [failed("a", 0.0, seed, "died") for seed in range(30)]
    assert table_of(counts_of(many)).splitlines()[-1] == "died: 20 more"


@pytest.mark.parametrize(
    "damage",
    [
        {"result": None},
        {"failed": {"how": "time", "reason": "x"}},
        {"result": None, "failed": {"how": "bored", "reason": "x"}},
        {"result": None, "failed": {"how": "time"}},
        {"result": {}},
        {"passed": 1.5},
        {"result": {**ROWS[0]["result"], "steps": True}},
        {"result": {**ROWS[0]["result"], "achieved": "yes"}},
    ],
)
def test_damaged_rows_are_noticed(damage: ResultRow) -> None:
    assert problem_of({**ROWS[0], **OPTIONS, **damage})


def marks(picture: str, kind: str) -> dict[str, float]:
    """Return the titles of marks of one kind, and how far each is from the left."""
    found = {}
    for mark in ET.fromstring(picture).iter(SVG + kind):
        title = mark.find(SVG + "title")
        if title is not None and kind == "circle":
            found[str(title.text)] = float(mark.attrib["cx"])
    return found


def test_the_picture_has_a_mark_where_the_numbers_are() -> None:
    picture = sweep_picture(counts_of(ROWS))
    tree = ET.fromstring(picture)
    texts = {text.text or text[0].tail or "": float(text.attrib["x"]) for text in tree.iter(SVG + "text")}
    found = marks(picture, "circle")
    rate = next(x for title, x in found.items() if "1 of 4 as expected (5 to 70 %)" in title)
    assert rate == pytest.approx(texts["0"] + (texts["40"] - texts["0"]) * 25 / 40, abs=0.2)
    commands = next(x for title, x in found.items() if "6 commands in the median, 10 at the 95th" in title)
    assert commands == pytest.approx(texts["5"] + (texts["10"] - texts["5"]) * math.log(6 / 5, 2), abs=0.2)
    assert {"noise 0", "noise 0.5", "scenario", "a", "b"} <= set(texts)
    assert any("percent" in text for text in texts) and any("commands, logarithmic" in text for text in texts)
    assert 'fill="#fff"' in picture


def test_the_picture_survives_strange_names_many_noises_and_nothing_at_all() -> None:
    name = "a<&>\x1b\n" + "long" * 30
    rows = [ended(name, noise / 100, 0, 1000 * noise, True, True) for noise in range(40)]
    picture = sweep_picture(counts_of(rows))
    tree = ET.fromstring(picture)
    width = float(tree.attrib["width"])
    assert all(0 <= float(text.attrib["x"]) <= width for text in tree.iter(SVG + "text"))
    assert "\x1b" not in picture and "..." in picture
    assert len({mark.tag + mark.attrib["fill"] for mark in tree if "fill" in mark.attrib}) > 7
    ET.fromstring(sweep_picture([]))
    ET.fromstring(sweep_picture(counts_of([failed("a", 0.0, 0, "died")])))


@given(st.floats(0, 1e6))
def test_ticks_reach_the_greatest_value_and_are_1_2_and_5_times_powers_of_ten(most: float) -> None:
    ticks = log_ticks(most)
    assert ticks[-1] >= most and (len(ticks) == 2 or ticks[-2] < most)
    assert ticks == sorted(digit * 10**power for digit in (1, 2, 5) for power in range(7))[: len(ticks)]
