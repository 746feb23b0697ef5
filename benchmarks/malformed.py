"""Malformed texts: each must be accepted or refused with file:line:col, without a traceback or a hang.

    python -m benchmarks.malformed [N] [--seed S] [--what scenarios|queries|rules|maps]

The program changes N (default 10,000) good texts in their bytes, words, numbers, lines or files, one at a time, and
reads them: scenarios, of which those that are accepted are also simulated for a moment; queries; files of rules, which
are tried out; or Moving AI maps. It prints a table, and exits with 1 when anything else happened than acceptance or a
proper refusal.
"""

import argparse
import os
import random
import re
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import FrameType

from geometry.io.movingai import MapError, parse_map
from kb.language.diagnostics import BadInputError, CannotOpenError, Problem, SourceSpan
from kb.reasoning.query import QueryEngine, QueryLimitError
from kb.reasoning.solver import KB_ENCODINGS, solve
from kb.reasoning.user_rules import read_tested_rules
from simulator.scenario.scenario import Scenario, read_scenario
from simulator.world.physics import Tabletop

HANG_SECONDS = 20.0  # seconds until a file counts as hung
REFUSAL = re.compile(r"\A[^\n]*:\d+:\d+-\d+: error: [^\n]+")

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
STRAY_WORDS = (
    "2147483648", "-2147483648", "65536*65536", "X*X", "C+1", "not ", "-object(o1)", "#count{X : object(X)}", "1..",
    "#sum{C,X : shape(X,_,C)}", "banana", "_", "choose(1)", "#true", "@f(1)", "&diff{a}", "|", "**", "#inf", "{", "}",
    '"', "'", "(", ")", "((", "))", ".", "..", ",", ";", ":-", "%", "%*", "*%", "#include", '#include "/etc/passwd".',
    "#script (python)", "#const n=1.", "@f()", "X", "_", "-", "--1", "99999999999999999999", "-2147483649", "1e999",
    "nan", "inf", "1.5", "0x10", "\\", "\x00", "\x1b[31m", "\r", "\t", "\ufeff", "\u201c", "\u201d", "\u00a0",
    "gr\u00f6\u00dfe", "\U0001f916", "\u202e", "POLYGON", "POLYGON EMPTY", "POINT Z (1 2 3)",
    "MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)))",
    "GEOMETRYCOLLECTION (" * 300, "object(utak).", "object(start, next).", "utak", "verge", "square", "table(0, 0).",
    "table(4096, 4096).", "f(" * 70 + "x" + ")" * 70, "p" * 5000, "{a;b}.", "not a.", "1 2 3", "<xml/>", "asp 1 0 0\n",
)  # fmt: skip


def spoil(draw: random.Random, text: str) -> bytes:
    """Return a text after one to four mutations, as bytes."""
    raw = text.encode()
    for _ in range(draw.choice([1, 1, 1, 2, 4])):
        raw = draw.choice(MUTATIONS)(draw, raw)
    return raw


def _byte(draw: random.Random, raw: bytes) -> bytes:
    at = draw.randrange(len(raw) + 1)
    return raw[:at] + bytes([draw.randrange(256)]) + raw[at + draw.randrange(2) :]


def _cut(draw: random.Random, raw: bytes) -> bytes:
    start, end = sorted(draw.randrange(len(raw) + 1) for _ in range(2))
    return draw.choice([raw[:start], raw[end:], raw[:start] + raw[end:]])


def _repeat(draw: random.Random, raw: bytes) -> bytes:
    start, end = sorted(draw.randrange(len(raw) + 1) for _ in range(2))
    return raw[:end] + raw[start:end] * draw.choice([1, 1, 2, 50]) + raw[end:]


def _insert(draw: random.Random, raw: bytes) -> bytes:
    at = draw.randrange(len(raw) + 1)
    return raw[:at] + draw.choice(STRAY_WORDS).encode() + raw[at:]


def _replace_word(draw: random.Random, raw: bytes) -> bytes:
    words = list(re.finditer(rb"\w+|[^\w\s]", raw))
    if not words:
        return raw
    word = draw.choice(words)
    other = draw.choice([draw.choice(STRAY_WORDS).encode(), draw.choice(words).group(), b""])
    return raw[: word.start()] + other + raw[word.end() :]


def _replace_number(draw: random.Random, raw: bytes) -> bytes:
    numbers = list(re.finditer(rb"-?\d+(\.\d+)?", raw))
    if not numbers:
        return raw
    number = draw.choice(numbers)
    other = draw.choice(
        ["0", "-1", "1e-12", "1e12", "4.0000000001", str(draw.uniform(-5, 20)), str(draw.randrange(20))]
    )
    return raw[: number.start()] + other.encode() + raw[number.end() :]


def _swap_letters(draw: random.Random, raw: bytes) -> bytes:
    at = draw.randrange(max(1, len(raw) - 1))
    return raw[:at] + raw[at : at + 2][::-1] + raw[at + 2 :]


def _lines(draw: random.Random, raw: bytes) -> bytes:
    lines = raw.splitlines(keepends=True) or [b""]
    line = draw.choice(lines)
    if draw.random() < 0.5:
        lines.remove(line)
    else:
        lines.insert(draw.randrange(len(lines) + 1), line)
    return b"".join(lines)


def _encoding(draw: random.Random, raw: bytes) -> bytes:
    text = raw.decode("latin-1")
    return draw.choice(
        [text.encode("utf-16"), text.encode("utf-16-be"), text.encode("utf-8-sig"), raw.replace(b"\n", b"\r\n")]
    )


MUTATIONS: tuple[Callable[[random.Random, bytes], bytes], ...] = (
    _byte, _cut, _repeat, _insert, _insert, _replace_word, _replace_word, _replace_number, _replace_number,
    _swap_letters, _lines, _encoding,
)  # fmt: skip


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


class _HungError(Exception):
    """Reading a scenario took too long."""


def _hung(number: int, frame: FrameType | None) -> None:
    raise _HungError


def outcome(folder: Path, read: Callable[[Path], Scenario] = read_scenario, seconds: float = HANG_SECONDS) -> str:
    """Return the outcome of reading a scenario, as `came_out` does.

    read : the reader of the folder. seconds : of wall-clock time after which it hangs.
    """
    return came_out(lambda: _simulated(read(folder)), seconds)


def _simulated(scenario: Scenario) -> None:
    table = Tabletop(scenario.world)
    table.look()
    table.move(3.0, -40.0)


def came_out(read: Callable[[], object], seconds: float = HANG_SECONDS) -> str:
    """Return `accepted`, `refused`, `given up`, `cannot open`, or a fault that begins with an exclamation mark."""
    signal.signal(signal.SIGALRM, _hung)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        read()
    except BadInputError as bad:
        faulty = [str(p) for p in bad.problems if not REFUSAL.match(str(p)) or "ended the process" in p.what]
        return f"! a refusal without place: {faulty[0]}" if faulty or not bad.problems else "refused"
    except CannotOpenError:
        return "cannot open"
    except QueryLimitError as limit:
        return f"! {limit}" if "ended the process" in str(limit) else "given up"
    except _HungError:
        return "! hung"
    except Exception as error:
        return f"! {type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    return "accepted"


def campaign(count: int, seed: int, keep: Path) -> Counter[str]:
    """Count the outcomes of `count` malformed scenarios; faulty ones are kept in `keep`."""
    outcomes: Counter[str] = Counter()
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
    with QueryEngine(seconds=5.0) as engine:
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


def main() -> int:
    """Run the campaign that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.malformed", description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--what", choices=("scenarios", "queries", "rules", "maps"), default="scenarios")
    options = parser.parse_args()
    start, keep = time.monotonic(), Path(tempfile.mkdtemp(prefix="malformed-"))
    outcomes = {
        "scenarios": lambda: campaign(options.count, options.seed, keep),
        "queries": lambda: queries(options.count, options.seed),
        "rules": lambda: rules(options.count, options.seed, keep),
        "maps": lambda: maps(options.count, options.seed),
    }[options.what]()
    for result, number in outcomes.most_common():
        print(f"{number:8d}  {result}")
    print(f"{time.monotonic() - start:8.1f}  seconds")
    return 1 if any(result.startswith("!") for result in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main())
