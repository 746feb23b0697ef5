"""The encodings: where they lie, which files each consists of, their text, and the constants that they state.

An encoding is a file `NAME.lp`, or a folder `NAME` of such files that stand for one program, in the order of their
names; and the files that it shares with others (SHARED_FILES). Rules, records and dumps know it by its name alone.
"""

from functools import cache
from pathlib import Path
from typing import NamedTuple

import clingo

KB_ENCODINGS = Path(__file__).resolve().parent.parent / "asp"  # the folder of the encodings of kb
ENCODING_FOLDERS = (KB_ENCODINGS, KB_ENCODINGS.parent.parent / "planner" / "asp")  # files elsewhere are rules of users
SUFFIX = ".lp"  # of the files of encodings
# By the name of an encoding: files beside it that are a part of it, and of others, too.
SHARED_FILES = {
    "interpretation": ("priors",),
    "shapes": ("priors",),
    "movable": ("priors",),
    "chances": ("priors_of_whereabouts",),
    "deciding": ("priors_of_walls",),
}
COUNTED_FACTS = ("priors_of_places", "priors_of_looks")  # files of facts alone, which Python reads
SHARED_PARTS = frozenset(
    [*COUNTED_FACTS, *(name for names in SHARED_FILES.values() for name in names)]
)  # they are no encodings by themselves
# Bounded searches look for the best answer from below first (unsatisfiable cores), which ends where branch and bound
# does not; measured by benchmarks.orders.strategies. Where it does not end, branch and bound tells the best so far.
CORE_GUIDED = ("--opt-strategy=usc,oll,stratify",)


class BoundedAnswer(NamedTuple):
    """The best answer set that a bounded search found."""

    # Its shown atoms, clingo symbols sorted by their text; None when none was found
    atoms: tuple[clingo.Symbol, ...] | None
    proved: bool  # whether the search ended: then no answer set is better, or there is none
    cost: tuple[tuple[int, int], ...] = ()  # its cost, pairs of level and amount, the highest level first
    applied: tuple[str, ...] = ()  # the users' rules that had an instance, each as `RULES.lp:LINE:COLUMN`.

    def cost_at(self, level: int) -> int:
        """Return the cost at one level; 0 where nothing costs anything there."""
        return dict(self.cost).get(level, 0)


def all_encodings() -> tuple[Path, ...]:
    """Return the paths of all our encodings, each a file or a folder, sorted by name."""
    paths = [path for folder in ENCODING_FOLDERS for path in folder.iterdir() if path.stem not in SHARED_PARTS]
    found = [path for path in paths if encoding_files(path)]
    return tuple(sorted(found, key=lambda path: path.stem))


def encoding_path(name: str) -> Path:
    """Return the path of one of our encodings, a file or a folder."""
    found = next((path for path in all_encodings() if path.stem == name), None)  # any text may be asked for
    if found is None:
        raise FileNotFoundError(f"there is no encoding {name}")
    return found


def encoding_files(encoding: Path) -> tuple[Path, ...]:
    """Return the files of an encoding: those of a folder sorted by name, or its own file; and then those it shares."""
    if not encoding.is_dir() and (encoding.suffix != SUFFIX or not encoding.is_file()):
        return ()
    own = sorted(encoding.glob(f"*{SUFFIX}")) if encoding.is_dir() else [encoding]
    shared = SHARED_FILES.get(encoding.stem, ()) if own and encoding.parent in ENCODING_FOLDERS else ()
    return (*own, *(encoding.with_name(f"{name}{SUFFIX}") for name in shared))


def encoding_text(encoding: Path) -> str:
    """Return the text of an encoding: that of its files, one after the other."""
    files = encoding_files(encoding) or (encoding,)
    return "\n".join(path.read_text(encoding="utf-8") for path in files)


@cache
def encoding_constant(encoding: Path, name: str) -> int:
    """Return the whole number that an encoding defines with `#const`."""
    control = clingo.Control()
    control.add("base", [], encoding_text(encoding))
    symbol = control.get_const(name)
    if symbol is None:
        raise KeyError(f"{encoding.name} defines no constant {name}")
    return symbol.number


@cache
def encoding_facts(path: Path, name: str, arity: int) -> tuple[tuple[str | int, ...], ...]:
    """Return the arguments of the facts of a predicate that a file states, names as text."""
    control = clingo.Control()
    control.add("base", [], path.read_text(encoding="utf-8"))
    control.ground([("base", [])])
    return tuple(
        tuple(a.number if a.type == clingo.SymbolType.Number else str(a) for a in atom.symbol.arguments)
        for atom in control.symbolic_atoms.by_signature(name, arity)
    )
