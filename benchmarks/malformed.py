"""Malformed texts: each must be accepted or refused with file:line:col, without a traceback or a hang.

    python -m benchmarks.malformed [N] [--seed S] [--what KIND] [--processes M]

The program changes N (default 10,000) good texts in their bytes, words, numbers, lines or files, one at a time, and
reads them. KIND is one of

    scenarios  read as `utak check` does; those that are accepted are also simulated for a moment (default)
    episodes   read step by step, as `utak query`, `utak repl` and pictures of the table read them
    imports    files of other formats, imported
    queries    asked
    rules      files of rules, tried out
    maps       Moving AI maps
    commands   episodes given to replay, explain, query --dump-asp and plan, as far as there are these commands
    all        of ten, four scenarios, three episodes, and one each of imports, commands and queries

Of all N, M (default 0) are given to commands in processes of their own besides. The program prints a table, and exits
with 1 when anything else happened than acceptance or a proper refusal.
"""

import argparse
import os
import random
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from benchmarks.malformations.commands import in_processes, in_this_process
from benchmarks.malformations.episodes import episodes
from benchmarks.malformations.imports import imports
from benchmarks.malformations.mutate import spoil
from benchmarks.malformations.outcomes import HANG_SECONDS, bound_memory, came_out
from benchmarks.malformations.written import written
from utak.geometry.io.movingai import MapError, parse_map
from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.query import QueryEngine
from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import read_tested_rules
from utak.simulator.scenario.scenario import Scenario, read_scenario
from utak.simulator.world.physics import Tabletop

GOOD_WORLD = """\
% A room with two things.
table(16, 12).
verge("POLYGON ((0 0, 16 0, 16 12, 0 12, 0 0), (1 1, 15 1, 15 11, 1 11, 1 1))").
object(t1, g, "POLYGON ((4 4, 7 4, 7 7, 4 7, 4 4))").
object(t2, c, "POLYGON ((9 3, 11.5 4.25, 10 8, 9 3))").
fixed(p1, h, "POLYGON ((12 8, 13 8, 13 10, 12 10, 12 8), (12.2 8.2, 12.2 9, 12.8 9, 12.2 8.2))").
utak("POINT (2.5 2.5)", 90).
"""
GOOD = {
    "world.lp": GOOD_WORLD,
    "start.lp": "object(x). shape(x, square).\nconfidence(colour(x, g), 80). %* two *% door(d). room(r).\n",
    "goal.lp": 'first(at(utak, x)). then(circled(utak, x)).\nnot_through(utak, d). pose(x, "POINT (3 4)", -90).\n',
    "expect.lp": 'near(utak, "POLYGON ((4 4, 7 4, 7 7, 4 4))", 2).\nunmoved(t1). within(40). circles(utak, t1).\n',
}
FACTS = [
    "room(r1).", "unseen(r1,9).", "node(o1).", "kind(o1,object,95).", "shape(o1,square,80).", "offset(o1,250,-50).",
    "in(o1,r1).", "colour(o1,g,99).", "corner(northeast,900,900).", "held(o1).", "rect(o1,0,0,300,300).",
]  # fmt: skip
GOOD_QUERIES = (
    "object(X), shape(X, square, C), C > 50, not held(X)", "#count{X : object(X), in(X, r1)} >= 2", "X = 1..9, Y = X*7",
    "offset(o1, E, N), D = E*E + N*N", "kind(X, (object; verge), C)", "in(X, r1) : object(X)", "1 { object(X) } 3",
    "rect(X, W, S, E, N), |E-W| < 400, not corner(_, E, N)", "C = #max{D,T : shape(o1, T, D)}, shape(o1, S, C)",
)  # fmt: skip
RULES = """\
% What is wide, and what is rather verge.
#const most = 40.
wide(X) :- rect(X, W, S, E, N), E-W > 10*most.
kind(R, verge, C/2) :- region(R, zero, C), C > most, not odd_one(R).
odd_one(R) :- region(R, _, C), C \\ 2 = 1. odd_one(x).
:- kind(R, object, 100), #count{Q : region(Q, _, _)} > 50.
:~ kind(R, verge, C). [C@2, R]
{ mine(R) : region(R, zero, _) } 1.
#show mine/1.
"""
MAP = "type octile\nheight 4\nwidth 5\nmap\n@@@@@\n@..T@\n@.SW@\n@@@@@\n"
PICTURE = "bbbbbbbb\nb..gg..b\nb.....cb\nb.U..ccb\nb......b\nbbbbbbbb\n"
SHARES_OF_TEN = {"scenarios": 4, "episodes": 3, "imports": 1, "commands": 1, "queries": 1}  # of `--what all`


def write_malformed(folder: Path, draw: random.Random) -> None:
    """Write one malformed scenario into a new folder."""
    folder.mkdir()
    files = dict(GOOD)
    if draw.random() < 0.2:
        del files["world.lp"], files["expect.lp"]
        files["world.txt"] = PICTURE
    spoilt = draw.sample(sorted(files), draw.choice([1, 1, 1, 2]))
    for name, text in files.items():
        if name not in spoilt:
            (folder / name).write_text(text)
        elif draw.random() < 0.04:
            _no_file(folder / name, draw)
        else:
            (folder / name).write_bytes(spoil(draw, text))


def _no_file(path: Path, draw: random.Random) -> None:
    """Put something that is no file in a file's place."""
    kind = draw.randrange(6)
    if kind == 0:
        path.mkdir()
    elif kind == 1:
        os.mkfifo(path)
    elif kind == 2:
        path.symlink_to(path.name)  # to itself
    elif kind == 3:
        path.symlink_to("/dev/zero")
    elif kind == 4:
        path.touch()
        os.truncate(path, 5_000_000_000)


def outcome(folder: Path, read: Callable[[Path], Scenario] = read_scenario, seconds: float = HANG_SECONDS) -> str:
    """Return the outcome of reading a scenario, as `came_out` does.

    read : the reader of the folder. seconds : of processor time after which it hangs.
    """
    return came_out(lambda: _simulated(read(folder)), seconds)


def _warm_up(keep: Path) -> None:
    """Simulate a good scenario, so that no malformed one waits for the compilation of geometry's kernels."""
    folder = keep / "good"
    folder.mkdir()
    for name, text in GOOD.items():
        (folder / name).write_text(text)
    _simulated(read_scenario(folder))
    shutil.rmtree(folder)


def _simulated(scenario: Scenario) -> None:
    table = Tabletop(scenario.world)
    table.look()
    table.move(3.0, -40.0)


def campaign(count: int, seed: int, keep: Path) -> Counter[str]:
    """Count the outcomes of `count` malformed scenarios; faulty ones are kept in `keep`."""
    outcomes: Counter[str] = Counter()
    _warm_up(keep)
    for number in range(count):
        folder = keep / f"{seed}-{number}"
        write_malformed(folder, random.Random(f"{seed}-{number}"))
        result = outcome(folder)
        outcomes[result] += 1
        if result.startswith("!"):
            print(f"{folder}: {result}", file=sys.stderr)
        else:
            shutil.rmtree(folder)
    return outcomes


def queries(count: int, seed: int) -> Counter[str]:
    """Count the outcomes of `count` malformed queries."""
    outcomes: Counter[str] = Counter()
    with QueryEngine(seconds=2.0) as engine:
        for number in range(count):
            draw = random.Random(f"{seed}-{number}")
            text = spoil(draw, draw.choice(GOOD_QUERIES)).decode("utf-8", errors="surrogateescape")
            _count(outcomes, came_out(lambda text=text: engine.ask(FACTS, text)), text)  # type: ignore[misc]
    return outcomes


def rules(count: int, seed: int, keep: Path) -> Counter[str]:
    """Count the outcomes of `count` malformed files of rules, by themselves and beside our encodings."""
    outcomes: Counter[str] = Counter()
    for number in range(count):
        draw = random.Random(f"{seed}-{number}")
        raw, path = spoil(draw, RULES), keep / f"{seed}-{number}.lp"
        path.write_bytes(raw)

        def tried(path: Path = path) -> None:
            read_tested_rules([path])
            solve(
                [KB_ENCODINGS / "interpretation.lp", path], ["region(a,zero,90)", "region(c,nonzero,80)", "extent(c,3)"]
            )

        _count(outcomes, came_out(tried), repr(raw))
        path.unlink()
    return outcomes


def maps(count: int, seed: int, parse: Callable[[bytes], object] = parse_map) -> Counter[str]:
    """Count the outcomes of `count` malformed maps. parse : the reader of their text."""
    outcomes: Counter[str] = Counter()
    for number in range(count):
        raw = spoil(random.Random(f"{seed}-{number}"), MAP)

        def read(raw: bytes = raw) -> None:
            try:
                parse(raw)
            except MapError as error:
                span = SourceSpan(error.line, error.column, error.end)
                raise BadInputError([Problem("map", span, error.what)]) from None

        _count(outcomes, came_out(read), repr(raw))
    return outcomes


def _count(outcomes: Counter[str], result: str, text: str) -> None:
    outcomes[result] += 1
    if result.startswith("!"):
        print(f"{result}: {text!r}", file=sys.stderr)


def kinds(count: int, seed: int, keep: Path) -> dict[str, Callable[[], Counter[str]]]:
    """Return for each kind the function that counts the outcomes of `count` malformed texts.

    count, seed : how many, and the seed. keep : a folder for files that are faulty.
    """
    return {
        "scenarios": lambda: campaign(count, seed, keep),
        "episodes": lambda: episodes(count, seed, keep),
        "imports": lambda: imports(count, seed, keep),
        "commands": lambda: in_this_process(count, seed, keep),
        "queries": lambda: queries(count, seed),
        "rules": lambda: rules(count, seed, keep),
        "maps": lambda: maps(count, seed),
        "written": lambda: written(count, seed, keep),
    }


def main() -> int:
    """Run the campaign that the command line asks for."""
    what = (__doc__ or "").partition("\n")[0]
    parser = argparse.ArgumentParser(prog="python -m benchmarks.malformed", description=what)
    parser.add_argument("count", type=int, nargs="?", default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--what", choices=(*kinds(0, 0, Path()), "all"), default="scenarios")
    parser.add_argument("--processes", type=int, default=0)
    options = parser.parse_args()
    start, keep = time.monotonic(), Path(tempfile.mkdtemp(prefix="malformed-"))
    bound_memory()
    shares = SHARES_OF_TEN if options.what == "all" else {options.what: 10}
    faults = 0
    for kind, share in shares.items():
        faults += _table(kind, kinds(options.count * share // 10, options.seed, keep)[kind]())
    if options.processes:
        outcomes = in_processes(
            options.processes, options.seed, keep, lambda folder, draw: write_malformed(folder, draw)
        )
        faults += _table("in processes of their own", outcomes)
    print(f"{time.monotonic() - start:8.1f}  seconds")
    return 1 if faults else 0


def _table(kind: str, outcomes: Counter[str]) -> int:
    """Print the outcomes of one kind and return how many are faults."""
    print(f"{kind}:")
    for result, number in outcomes.most_common():
        print(f"{number:8d}  {result}", flush=True)
    return sum(number for result, number in outcomes.items() if result.startswith("!"))


if __name__ == "__main__":
    sys.exit(main())
