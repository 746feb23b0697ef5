"""JUnit XML: well-formed whatever the texts, and no more than the schema of Jenkins' xUnit plugin allows."""

import xml.etree.ElementTree as ElementTree
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from utak.simulator.testing.junit import as_junit
from utak.simulator.testing.record import Wish, without_run

# By element: the attributes that must stand, those that may, and the elements in it. After the schema that Jenkins'
# xUnit plugin checks; GitLab reads a part of it.
SCHEMA: dict[str, tuple[set[str], set[str], set[str]]] = {
    "testsuites": (set(), {"name", "time", "tests", "failures", "errors"}, {"testsuite"}),
    "testsuite": (
        {"name", "tests"},
        {"failures", "errors", "time", "skipped", "timestamp", "hostname", "id", "package"},
        {"properties", "testcase", "system-out", "system-err"},
    ),
    "properties": (set(), set(), {"property"}),
    "property": ({"name"}, {"value"}, set()),
    "testcase": ({"name"}, {"classname", "time", "group"}, {"skipped", "error", "failure", "system-out", "system-err"}),
    "failure": (set(), {"message", "type"}, set()),
    "error": (set(), {"message", "type"}, set()),
    "system-out": (set(), set(), set()),
}
TEXTS = st.text(max_size=40)


@st.composite
def records(draw: st.DrawFn) -> dict[str, Any]:
    """Return a record with arbitrary texts."""
    folder, text = draw(TEXTS), draw(TEXTS)
    code = draw(st.sampled_from([0, 1, 65, 66, 70]))
    record = without_run(Wish(folder, folder, {}), code, "" if code < 2 else text)
    if code < 2:
        faults = [f"not met: within(0): {text}"] if code else []
        outcome = {"expected": "within(0)", "met": not code, "came": text if code else "", "points": 3}
        record |= {"verdict": "done", "steps": 4, "reason": text, "faults": faults, "expectations": [outcome]}
        record |= {"points": {"earned": 0 if code else 3, "possible": 3}, "weighed": draw(st.booleans())}
        record |= {"last_steps": [{"step": 4, "action": "move(1, 2)", "why": text}]}
    return record | ({"seconds": 1.5} if draw(st.booleans()) else {})


def check(element: ElementTree.Element) -> None:
    """Assert that an element and those in it are as the schema says."""
    needed, allowed, inside = SCHEMA[element.tag]
    assert needed <= set(element.attrib) <= needed | allowed
    for inner in element:
        assert inner.tag in inside, inner.tag
        check(inner)


@given(st.lists(records(), max_size=4))
def test_every_record_becomes_valid_xml(made: list[dict[str, Any]]) -> None:
    root = ElementTree.fromstring(as_junit(made).encode("utf-8"))
    check(root)
    suite = root[0]
    cases = suite.findall("testcase")
    assert int(suite.attrib["tests"]) == len(cases) == len(made)
    assert int(suite.attrib["failures"]) == sum(case.find("failure") is not None for case in cases)
    assert int(suite.attrib["errors"]) == sum(case.find("error") is not None for case in cases)
    for record, case in zip(made, cases, strict=True):
        assert (len([part for part in case if part.tag in ("failure", "error")]) == 0) == (record["exit_code"] == 0)
    timed = bool(made) and all("seconds" in record for record in made)
    assert ("time" in suite.attrib) == timed


def test_texts_and_points_survive() -> None:
    record = without_run(Wish("class/anna/01", "class", {}), 1, "")
    record |= {"verdict": "done", "steps": 4, "reason": "<b> & \x1b[31m", "faults": ['not met: "x" < 3']}
    record |= {"points": {"earned": 2, "possible": 5}, "weighed": True}
    root = ElementTree.fromstring(as_junit([record]).encode("utf-8"))
    case = root[0].find("testcase")
    assert case is not None
    assert (case.attrib["classname"], case.attrib["name"]) == ("class.anna", "01")
    assert case.findtext("system-out") == "done in 4 steps: <b> & \\u001b[31m\n2 of 5 points"
    failure = case.find("failure")
    assert failure is not None
    assert failure.attrib["message"] == 'not met: "x" < 3'
    assert [one.attrib for one in root.iter("property")] == [
        {"name": "points_earned", "value": "2"},
        {"name": "points_possible", "value": "5"},
    ]
