"""Records of tried scenarios as JUnit XML, as Jenkins, GitLab and other servers read it.

One `testsuite`, one `testcase` a scenario: `failure` for one that failed, `error` for one that could not be run. Only
elements and attributes are written that all those servers know. Times are written when the records have them.
"""

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from pathlib import PurePath

from utak.simulator.terminal import exits
from utak.simulator.testing.record import TrialRecord
from utak.simulator.testing.wording import failure_report, total_score

SUITE_NAME = "utak"  # of the one test suite
# What XML 1.0 cannot hold, not even as a reference; and marks that turn the direction of text.
NOT_IN_XML = re.compile(
    r"[^\t\n\r\x20-\x7e\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"
    r"|[\u200e\u200f\u202a-\u202e\u2066-\u2069]"
)


def as_junit(records: Sequence[TrialRecord]) -> str:
    """Return records as the text of a JUnit XML file, encoded as UTF-8."""
    failed = sum(record["exit_code"] == exits.NOT_REACHED for record in records)
    broken = sum(record["exit_code"] not in (exits.SUCCESS, exits.NOT_REACHED) for record in records)
    counts = {"name": SUITE_NAME, "tests": str(len(records)), "failures": str(failed), "errors": str(broken)}
    root = ElementTree.Element("testsuites", counts | _time(*records))
    suite = ElementTree.SubElement(root, "testsuite", counts | _time(*records), skipped="0")
    if any(record["weighed"] for record in records):
        properties = ElementTree.SubElement(suite, "properties")
        for name, value in total_score(records)._asdict().items():
            ElementTree.SubElement(properties, "property", name=f"points_{name}", value=str(value))
    for record in records:
        _add_case(suite, record)
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{ElementTree.tostring(root, "unicode")}\n'


def _add_case(suite: ElementTree.Element, record: TrialRecord) -> None:
    """Append the element of one scenario."""
    place = PurePath(record["scenario"])
    group = ".".join(part for part in place.parent.parts if part not in (".", "..", place.anchor)) or SUITE_NAME
    names = {"classname": _clean(group), "name": _clean(place.name or SUITE_NAME)}
    case = ElementTree.SubElement(suite, "testcase", names | _time(record))
    if record["exit_code"] != exits.SUCCESS:
        said = (record["faults"] or record["error"].splitlines() or [record["outcome"]])[0]
        kind = "failure" if record["exit_code"] == exits.NOT_REACHED else "error"
        ElementTree.SubElement(case, kind, message=_clean(said), type=record["outcome"]).text = _clean(
            failure_report(record)
        )
    if record["verdict"] is not None:
        points = f"\n{record['points']['earned']} of {record['points']['possible']} points" if record["weighed"] else ""
        end = f"{record['verdict']} in {record['steps']} steps: {record['reason']}"
        ElementTree.SubElement(case, "system-out").text = _clean(end + points)


def _time(*records: TrialRecord) -> dict[str, str]:
    """Return the attribute with the seconds that scenarios took; none where a record does not say it."""
    if not records or any("seconds" not in record for record in records):
        return {}
    return {"time": f"{sum(record['seconds'] for record in records):.3f}"}


def _clean(text: str) -> str:
    """Return a text with all characters that XML cannot hold written as JSON escapes."""
    return NOT_IN_XML.sub(lambda match: f"\\u{ord(match[0]):04x}", text)
