"""Chances by independent components are those of all answer sets together, and of ProbLog."""

import math
import random
from collections import Counter
from collections.abc import Iterable
from typing import Any

import clingo
import pytest

from utak.kb.tracing.possible_worlds import NoWorldError, PossibleWorlds, possible_worlds

DIFFERENCE = 1e-9  # by which two exact ways to count may differ: rounding alone


def weighed(program: str) -> dict[frozenset[clingo.Symbol], float]:
    """All answer sets, and the share of each by what its weak constraints weigh."""
    control = clingo.Control(["--warn=none", "--opt-mode=enum,2000000000", "0"])
    control.add("base", [], program)
    control.ground([("base", [])])
    with control.solve(yield_=True) as handle:
        found = {frozenset(m.symbols(atoms=True)): math.exp(-sum(m.cost) / 1000) for m in handle}
    whole = math.fsum(found.values())
    return {world: share / whole for world, share in found.items()}


def chance_in(worlds: dict[frozenset[clingo.Symbol], float], atoms: Iterable[clingo.Symbol]) -> float:
    wanted = frozenset(atoms)
    return math.fsum(share for world, share in worlds.items() if wanted <= world)


def drawn_program(seed: int) -> str:
    """A small program with choices, rules that may be recursive, bounds, constraints and weights on two levels."""
    draw = random.Random(seed)
    size = draw.randint(2, 7)
    free, derived = [f"a({n})" for n in range(size)], [f"b({n})" for n in range(size)]

    def body(least: int, most: int) -> str:
        return ", ".join(
            draw.choice(["", "not "]) + draw.choice(free + derived) for _ in range(draw.randint(least, most))
        )

    lines = [f"{{ {atom} }}." for atom in free if draw.random() < 0.8]
    lines += [f"{draw.choice(free + derived)} :- {body(1, 3)}." for _ in range(draw.randint(0, 5))]
    for _ in range(draw.randint(0, 3)):
        some = " ; ".join(draw.sample(free, min(size, draw.randint(2, 3))))
        lines.append(f"{draw.randint(0, 1)} {{ {some} }} {draw.randint(1, 2)} :- {body(1, 1)}.")
    lines += [f":- {body(1, 3)}." for _ in range(draw.randint(0, 2))]
    for _ in range(draw.randint(1, 6)):
        lines.append(f":~ {body(1, 2)}. [{draw.randint(0, 3000)}@{draw.randint(1, 2)}, t{draw.randint(0, 6)}]")
    return "\n".join(lines)


def check(seed: int) -> int:
    """Compare the chances of all atoms, and of pairs; return the number of components, 0 where there is no world."""
    program = drawn_program(seed)
    worlds = weighed(program)
    if not worlds:
        with pytest.raises(NoWorldError):
            possible_worlds(program)
        return 0
    found = possible_worlds(program)
    atoms = sorted(frozenset().union(*worlds), key=str)
    assert found.known == frozenset.intersection(*worlds)
    assert found.open == frozenset(atoms) - found.known
    pairs = [(one, other) for number, one in enumerate(atoms) for other in atoms[number:]]
    for pair in pairs:
        least, greatest = found.chance(*pair)
        assert least == greatest
        assert abs(least - chance_in(worlds, pair)) < DIFFERENCE, (seed, pair)
    return len(found.components)


@pytest.mark.parametrize("first", range(0, 100, 20))
def test_chances_are_those_of_all_worlds(first: int) -> None:
    components = Counter(min(check(seed), 2) for seed in range(first, first + 20))
    assert components[2]


@pytest.mark.long
@pytest.mark.parametrize("first", range(100, 1100, 100))
def test_chances_are_those_of_all_worlds_of_many_programs(first: int) -> None:
    assert sum(check(seed) > 1 for seed in range(first, first + 100)) > 10


def test_the_likeliest_worlds_come_first() -> None:
    program = "{ a }. :~ a. [1000] { b }. :~ not b. [2000] 1 { c ; d } 1. :~ c. [300]"
    found = possible_worlds(program)
    worlds = sorted(weighed(program).values(), reverse=True)
    assert [chance for _, chance in found.likeliest(100)] == pytest.approx(worlds)
    assert [chance for _, chance in found.likeliest(3)] == pytest.approx(worlds[:3])


def test_a_component_that_is_too_large_has_intervals() -> None:
    found = possible_worlds("{ a(1..6) }. :- not a(_). { b }. :~ b. [700]", most=10)
    (a,), (b,) = ([atom for atom in found.open if str(atom) == name] for name in ("a(1)", "b"))
    assert found.chance(a) == (0.0, 1.0)
    assert found.chance(b)[0] == found.chance(b)[1] == pytest.approx(math.exp(-0.7) / (1 + math.exp(-0.7)))
    assert found.chance(a, b) == (0.0, found.chance(b)[1])


def test_what_holds_nowhere_has_no_chance() -> None:
    found = possible_worlds("{ a }. b.")
    assert found.chance(clingo.Function("c")) == (0.0, 0.0)
    assert found.chance(clingo.Function("b")) == (1.0, 1.0)


def drawn_belief(seed: int) -> tuple[str, str]:
    """One belief for clingo and for ProbLog: weighed facts and answers, rules without cycles, and evidence."""
    draw = random.Random(seed)
    ours, theirs, atoms = [], [], []
    for n in range(draw.randint(1, 4)):
        true, false = draw.randint(0, 3000), draw.randint(0, 3000)
        chance = math.exp(-true / 1000) / (math.exp(-true / 1000) + math.exp(-false / 1000))
        ours.append(f"{{ a{n} }}. :~ a{n}. [{true}, a{n}] :~ not a{n}. [{false}, a{n}]")
        theirs.append(f"{chance!r}::a{n}.")
        atoms.append(f"a{n}")
    for n in range(draw.randint(0, 2)):
        weights = [draw.randint(0, 3000) for _ in range(draw.randint(2, 3))]
        whole = math.fsum(math.exp(-weight / 1000) for weight in weights)
        names = [f"k{n}_{m}" for m in range(len(weights))]
        ours.append(f"1 {{ {' ; '.join(names)} }} 1.")
        ours += [f":~ {name}. [{weight}, k{n}]" for name, weight in zip(names, weights, strict=True)]
        parts = (f"{math.exp(-weight / 1000) / whole!r}::{name}" for name, weight in zip(names, weights, strict=True))
        theirs.append("; ".join(parts) + ".")
        atoms += names
    for n in range(draw.randint(1, 4)):
        signs = [(draw.random() < 0.7, draw.choice(atoms)) for _ in range(draw.randint(1, 3))]
        ours.append(f"r{n} :- {', '.join(('' if yes else 'not ') + atom for yes, atom in signs)}.")
        theirs.append(f"r{n} :- {', '.join(('' if yes else chr(92) + '+') + atom for yes, atom in signs)}.")
        atoms.append(f"r{n}")
    for _ in range(draw.randint(0, 2)):
        yes, atom = draw.random() < 0.5, draw.choice(atoms)
        ours.append(f":- {'not ' if yes else ''}{atom}.")
        theirs.append(f"evidence({atom}, {'true' if yes else 'false'}).")
    theirs += [f"query({atom})." for atom in atoms]
    return "\n".join(ours), "\n".join(theirs)


def compare_with_problog(problog: Any, seed: int) -> int:
    """Compare the chances of one drawn belief; return how many were compared, 0 where the evidence cannot be."""
    ours, theirs = drawn_belief(seed)
    try:
        found: PossibleWorlds = possible_worlds(ours)
    except NoWorldError:
        return 0
    chances = problog.get_evaluatable().create_from(problog.program.PrologString(theirs)).evaluate()
    for atom, chance in chances.items():
        assert abs(found.chance(clingo.Function(str(atom)))[0] - float(chance)) < DIFFERENCE, (seed, atom)
    return len(chances)


@pytest.mark.filterwarnings("ignore")
def test_chances_are_those_of_problog() -> None:
    problog = pytest.importorskip("problog", reason="ProbLog is installed on Linux alone")
    pytest.importorskip("problog.program")
    assert sum(compare_with_problog(problog, seed) > 3 for seed in range(50)) > 30


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_chances_are_those_of_problog_for_many_beliefs() -> None:
    problog = pytest.importorskip("problog", reason="ProbLog is installed on Linux alone")
    pytest.importorskip("problog.program")
    assert sum(compare_with_problog(problog, seed) > 3 for seed in range(50, 1050)) > 600
