"""Records of tried scenarios as JUnit XML, as Jenkins, GitLab and other servers read it.

One `testsuite`, one `testcase` a scenario: `failure` for one that failed, `error` for one that could not be run. Only
elements and attributes are written that all those servers know. Times are written when the records have them.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import PurePath
from xml.sax.saxutils import escape, quoteattr

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
    counts = f'tests="{len(records)}" failures="{failed}" errors="{broken}"{_time(*records)}'
    lines = ['<?xml version="1.0" encoding="utf-8"?>', f'<testsuites name="{SUITE_NAME}" {counts}>']
    lines.append(f'  <testsuite name="{SUITE_NAME}" {counts} skipped="0">')
    lines += _properties(records)
    for record in records:
        lines += _case(record)
    return "\n".join([*lines, "  </testsuite>", "</testsuites>"]) + "\n"


def _properties(records: Sequence[TrialRecord]) -> Iterator[str]:
    """Yield the lines about the points of all scenarios together, where authors weighed them."""
    if any(record["weighed"] for record in records):
        total = total_score(records)
        yield "    <properties>"
        yield f'      <property name="points_earned" value="{total.earned}"/>'
        yield f'      <property name="points_possible" value="{total.possible}"/>'
        yield "    </properties>"


def _case(record: TrialRecord) -> Iterator[str]:
    """Yield the lines about one scenario."""
    place = PurePath(record["scenario"])
    group = ".".join(part for part in place.parent.parts if part not in (".", "..", place.anchor)) or SUITE_NAME
    yield f"    <testcase classname={_attribute(group)} name={_attribute(place.name or SUITE_NAME)}{_time(record)}>"
    if record["exit_code"] != exits.SUCCESS:
        kind = "failure" if record["exit_code"] == exits.NOT_REACHED else "error"
        said = (record["faults"] or record["error"].splitlines() or [record["outcome"]])[0]
        attributes = f"message={_attribute(said)} type={_attribute(record['outcome'])}"
        yield f"      <{kind} {attributes}>{_text(failure_report(record))}</{kind}>"
    if record["verdict"] is not None:
        end = f"{record['verdict']} in {record['steps']} steps: {record['reason']}"
        points = f"\n{record['points']['earned']} of {record['points']['possible']} points" if record["weighed"] else ""
        yield f"      <system-out>{_text(end + points)}</system-out>"
    yield "    </testcase>"


def _time(*records: TrialRecord) -> str:
    """Return the attribute with the seconds that scenarios took; '' where a record does not say it."""
    if not records or any("seconds" not in record for record in records):
        return ""
    return f' time="{sum(record["seconds"] for record in records):.3f}"'


def _clean(text: str) -> str:
    """Return a text with all characters that XML cannot hold written as JSON escapes."""
    return NOT_IN_XML.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def _text(text: str) -> str:
    """Return a text as the contents of an element."""
    return escape(_clean(text))


def _attribute(text: str) -> str:
    """Return a text as the quoted value of an attribute."""
    return quoteattr(_clean(text))
