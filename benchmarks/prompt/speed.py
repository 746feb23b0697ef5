"""The time until `utak repl` shows its prompt at a terminal, and the time of queries on a model of 1,000 facts.

python -m benchmarks.prompt.speed [EP.jsonl|SCENARIO]
"""

import os
import pty
import select
import statistics
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

from utak.kb.reasoning.query import QueryEngine

CHECKOUT_FOLDER = Path(__file__).resolve().parents[2]
MAX_READY_SECONDS = 0.5  # what is wanted of the prompt
MAX_QUERY_MILLISECONDS = 20.0  # what is wanted of a query
MAX_WAIT_SECONDS = 20  # seconds after which a prompt that does not come is an error
CONVERSATIONS_BEGUN = 7  # conversations begun; the median is told
QUERIES = (
    "object(X), shape(X, square, C), C > 97",
    "offset(o7, E, N)",
    "held(X)",
    "N = #count { X : object(X) }",
    "kind(X, object, C), not shape(X, square, _)",
    "offset(X, E, N), offset(Y, N, E)",
    "bound(P, N)",
)


def seconds_to_prompt(story: str, **environment: str) -> tuple[float, float]:
    """Return the wall-clock and the processor seconds that `utak repl STORY` takes at a terminal to its prompt."""
    master, slave = pty.openpty()
    begin, seen = time.monotonic(), b""
    command = [sys.executable, str(CHECKOUT_FOLDER / "utak" / "launcher.py"), "", "utak.simulator.cli", "repl", story]
    with subprocess.Popen(command, stdin=slave, stdout=slave, stderr=slave, env=os.environ | environment) as process:
        os.close(slave)
        try:
            while b"utak 0>" not in seen:
                if not select.select([master], [], [], MAX_WAIT_SECONDS)[0]:
                    raise RuntimeError(f"no prompt within {MAX_WAIT_SECONDS} seconds: {seen!r}")
                seen += os.read(master, 4096)
            lasted = time.monotonic() - begin, processor_seconds(process.pid)
        finally:
            process.kill()
    with suppress(OSError):
        os.close(master)
    return lasted


def processor_seconds(process: int) -> float:
    """Return the processor time of a process so far (Linux), in seconds."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def thousand_facts() -> list[str]:
    """Return a model of 1,000 facts about 240 objects."""
    facts = ["unseen(r1,40).", "room(r1).", "parameter(x).", "bound(x,o3)."]
    for number in range(249):
        name = f"o{number}"
        facts += [f"kind({name},object,{50 + number % 50}).", f"offset({name},{10 * number},{-7 * number})."]
        facts += [f"shape({name},square,{number % 100}).", f"in({name},r1)."]
    return facts


def query_milliseconds(repeats: int = 15) -> dict[str, tuple[float, float]]:
    """Return the median and the greatest milliseconds of each of QUERIES, once the first one has been answered."""
    facts, found = thousand_facts(), {}
    with QueryEngine() as engine:
        engine.ask(facts, "room(R)")
        for query in QUERIES:
            times = []
            for _ in range(repeats):
                begin = time.perf_counter()
                engine.ask(facts, query)
                times.append(1000 * (time.perf_counter() - begin))
            found[query] = statistics.median(times), max(times)
    return found


def main() -> int:
    """Print both; exit 1 when the medians are beyond what is wanted."""
    story = sys.argv[1] if len(sys.argv) > 1 else str(CHECKOUT_FOLDER / "examples" / "go_to_square_unseen")
    ready = {}
    for name, environment in (("with the extra", {}), ("with readline alone", {"UTAK_PLAIN_PROMPT": "1"})):
        wall, processor = zip(
            *(seconds_to_prompt(story, **environment) for _ in range(CONVERSATIONS_BEGUN)), strict=True
        )
        ready[name] = statistics.median(wall)
        used = statistics.median(processor)
        print(f"prompt {name}: {ready[name]:.2f} s, {used:.2f} s of processor time (medians of {CONVERSATIONS_BEGUN})")
    times = query_milliseconds()
    for query, (median, worst) in times.items():
        print(f"{median:6.1f} ms, at most {worst:.1f} ms: {query}")
    slow = max(median for median, _ in times.values()) > MAX_QUERY_MILLISECONDS
    return int(slow or max(ready.values()) > MAX_READY_SECONDS)


if __name__ == "__main__":
    sys.exit(main())
