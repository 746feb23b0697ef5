"""The process that tries scenarios for another one: it reads one JSON line a wish and writes one a record.

`utak.simulator.testing.handle` starts it. It ends when its input does.
"""

import json
import os
import sys

from utak.kb.language.operating_system import read_lines_from_parent
from utak.simulator.terminal.printing import as_json
from utak.simulator.testing.record import Wish, try_scenario
from utak.simulator.testing.wording import failure_report

READY_LINE = "ready"  # the first line of the process


def main() -> None:
    """Answer wishes until the input ends."""
    with os.fdopen(os.dup(1), "w", encoding="ascii") as answers:
        os.dup2(2, 1)  # what anything prints must not come between the answers
        sys.stdout = sys.stderr
        print(READY_LINE, file=answers, flush=True)
        for line in read_lines_from_parent():
            record = try_scenario(Wish(**json.loads(line)))
            print(as_json(record | {"report": failure_report(record)}), file=answers, flush=True)


if __name__ == "__main__":
    main()
