"""100 runaway queries and rules: each must be stopped within its limit and half a second, and the next query answered.

python -m benchmarks.prompt.runaways [--seconds S]     exit 1 when one was stopped too late, or not reported
"""

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.kb.reasoning.assumptions import read_assumptions
from utak.kb.reasoning.query import QueryEngine, QueryLimitError
from utak.kb.reasoning.user_rules import RuleLimits, read_tested_rules

GRACE_SECONDS = 0.5  # seconds beyond the limit within which everything must be stopped
RUNAWAY_FACTS = [f"{text}." for n in range(250) for text in (f"kind(o{n},object,90)", f"offset(o{n},{n},{-n})",
         f"shape(o{n},square,{n % 100})", f"colour(o{n},r,99)")]  # fmt: skip


def runaway_queries() -> Iterator[str]:
    """Yield queries that would take very long, need too much memory, or try to reach files and scripts."""
    for size in (10**6, 10**7, 10**8, 10**9, 2 * 10**9):
        yield f"X = 1..{size}"
        yield f"X = 1..{size}, Y = 1..{size}"
        yield f"N = #count{{ X : X = 1..{size} }}"
        yield f"N = #sum{{ X,Y : X = 1..{size}, Y = 1..{size} }}"
        yield f"X = 1..{size}, not X = 1..{size}"
    for joined in range(3, 11):
        atoms = ", ".join(f"shape(X{n}, S{n}, C{n})" for n in range(joined))
        yield atoms
        yield f"{atoms}, {', '.join(f'X{n} != X{n + 1}' for n in range(joined - 1))}, C0 < -1"
        yield f"#count{{ {', '.join(f'X{n}' for n in range(joined))} : {atoms} }} > 1"
        yield f"not X0 = X1, {', '.join(f'offset(X{n}, E{n}, N{n})' for n in range(joined))}, E0 = 7000"
    for depth in (50, 400, 1500, 4000):
        yield "object(" + "f(" * depth + "1" + ")" * depth + ")"
        yield "X = " + "(" * depth + "1" + ")" * depth
        yield "X = " + "-" * depth + "1"
    yield from ('#include "/dev/zero".', "#script (python) while True: pass #end.", "#include <incmode>", "X = @loop()")


def runaway_rules() -> Iterator[str]:
    """Yield files of rules that never end, explode, are nested without end, or reach for files and scripts."""
    yield "n(0). n(X+1) :- n(X)."
    yield "n(0). n(X+1) :- n(X). kind(R, verge, 60) :- region(R, nonzero, _), n(7)."
    yield "t(0). t(f(X)) :- t(X)."
    yield "t(0). t((X,X)) :- t(X)."
    yield "{ a(1..30) }. :- #sum { X : a(X) } != 400. b :- a(1)."
    for size in (10**6, 10**8, 10**9):
        yield f"p(1..{size})."
        yield f"p(X) :- X = 1..{size}."
        yield f"p(X,Y) :- X = 1..{size}, Y = 1..{size}."
    for joined in (3, 4, 5, 6, 8):
        body = ", ".join(f"q(X{n})" for n in range(joined))
        yield f"q(1..400). r({', '.join(f'X{n}' for n in range(joined))}) :- {body}."
    for depth in (100, 5000, 400_000):
        yield "p(" + "f(" * depth + "1" + ")" * depth + ")."
    yield '#include "/dev/zero".'
    yield '#include "/dev/stdin".'
    yield "#script (python)\nwhile True: pass\n#end."
    yield "#script (lua) while true do end #end."
    yield "p(@loop())."
    yield "%*" + "x" * 100_000
    yield "p(" + "1," * 200_000 + "1)."


def took(work: Callable[[], object]) -> tuple[float, str]:
    """Return the seconds that some work took, and how it ended in one line."""
    begin = time.monotonic()
    try:
        work()
        how = "answered"
    except (BadInputError, CannotOpenError, QueryLimitError) as stopped:
        how = str(stopped).split("\n")[0]
    return time.monotonic() - begin, how[-90:]


def cases(engine: QueryEngine, seconds: float, folder: Path) -> Iterator[tuple[str, Callable[[], object]]]:
    """Yield a name and the work of each runaway."""
    for query in runaway_queries():
        yield f"?- {query}", lambda query=query: engine.ask(RUNAWAY_FACTS, query)  # type: ignore[misc]
    for number, rules in enumerate(runaway_rules()):
        path = folder / f"{number}.lp"
        path.write_text(rules)
        limits = RuleLimits(seconds=seconds)
        yield f"rules: {rules}", lambda path=path, limits=limits: read_tested_rules([path], limits)  # type: ignore[misc]
    for text in ('#include "/dev/zero".', "p(" * 5000 + ")" * 5000 + ".", "shape(o1, square, 9999999999999)."):
        yield f"assume {text}", lambda text=text: read_assumptions(text)  # type: ignore[misc]


def main() -> int:
    """Run all runaways, print the slowest and those that were stopped too late; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=1.0, help="the limit of each (default 1)")
    seconds = parser.parse_args().seconds
    late, times = 0, []
    with tempfile.TemporaryDirectory() as folder, QueryEngine(seconds=seconds) as engine:
        engine.ask(RUNAWAY_FACTS, "object(o1)")
        for name, work in cases(engine, seconds, Path(folder)):
            lasted, how = took(work)
            times.append(lasted)
            alive, answer = took(lambda: engine.ask(RUNAWAY_FACTS, "object(o1)"))
            bad = lasted > seconds + GRACE_SECONDS or answer != "answered" or alive > seconds
            late += bad
            if bad or lasted > seconds:
                print(f"{'LATE ' if bad else ''}{lasted:.2f} s  {name[:70]!r}  {how}")
    print(f"{len(times)} runaways, limit {seconds:g} s: slowest {max(times):.2f} s, {late} too late or not survived")
    return int(late > 0)


if __name__ == "__main__":
    sys.exit(main())
