"""The memory of the prompt over 100,000 queries: that of its process and of the process that answers.

python -m benchmarks.prompt.memory [N]      N queries (default 100,000); some minutes; exit 1 when it grows
"""

import sys
from pathlib import Path

from benchmarks.prompt.speed import thousand_facts
from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.query import QueryEngine

LOOKS = 20  # how often the memory is looked at
MAX_GROWTH_MEGABYTES = 20.0  # from the fourth part of the queries to the end, of both processes together


def megabytes(process: int | str) -> float:
    """Return the resident memory of a process (Linux)."""
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return 0.0


def main() -> int:
    """Ask, print the memory now and then, and return the exit code."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    facts = thousand_facts()
    other = [*facts, "held(o1)."]
    seen: list[float] = []
    with QueryEngine() as engine:
        for number in range(count):
            model = other if number % 1000 < 3 else facts  # another step now and then
            try:
                engine.ask(model, f"offset(o{number % 250}, E, N), E > {number}, X = f({number})")
                if number % 10 == 0:
                    engine.ask(model, f'shape(o{number % 250}, sqare{number}, C), X = "{number}"')
            except BadInputError:
                pass
            if number % (count // LOOKS) == 0:
                worker = engine.process_id
                both = (megabytes("self"), megabytes(worker) if worker is not None else 0.0)
                seen.append(sum(both))
                print(f"{number:7d} queries: {both[0]:6.1f} MB here, {both[1]:6.1f} MB in the process that answers")
    growth = max(seen[LOOKS // 4 :]) - seen[LOOKS // 4]
    print(f"growth since a quarter of the queries: {growth:.1f} MB")
    return int(growth > MAX_GROWTH_MEGABYTES)


if __name__ == "__main__":
    sys.exit(main())
