"""Interpretation: what each region is, and which shape an object has. Facts go in, answers of kb/asp come out."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from kb.perception.regions import Percept
from kb.reasoning.encodings import KB_ENCODINGS, encoding_constant
from kb.reasoning.solver import solve
from kb.reasoning.user_rules import rules_reach, world_facts_named
from kb.tracing.decisions import record_decisions

SHAPES = KB_ENCODINGS / "shapes.lp"
INTERPRETATION = KB_ENCODINGS / "interpretation.lp"
SHORTEST_WALL = encoding_constant(INTERPRETATION, "shortest_wall")  # squares: what is so long is surely verge
LONGEST_OBJECT = encoding_constant(INTERPRETATION, "longest_object")  # squares: what is longer is no object
FELT_OBJECT_CONFIDENCE = encoding_constant(INTERPRETATION, "felt_object")  # percent: of a thing felt not to be verge
SURELY_VERGE = (  # percent: the confidence that something undecided as long as the shortest wall is verge
    encoding_constant(INTERPRETATION, "verge_least")
    + encoding_constant(INTERPRETATION, "verge_per_square") * SHORTEST_WALL
)


class Kinds(NamedTuple):
    """The kinds that regions are taken for.

    Regions are named `part<n>` on the map, `cells<n>` or `own` in an impression.

    Attributes
    ----------
    kind : mapping of str to mapping of str to int
        Region -> {floor, verge, object or utak: confidence in percent}. A region of which nothing is derived is
        missing.
    hidden_passages : frozenset of (str, str)
        Pairs of free regions that must be connected by floor that is not seen.
    """

    kind: Mapping[str, Mapping[str, int]]
    hidden_passages: frozenset[tuple[str, str]]

    def of(self, region: str, kind: str) -> int:
        """Return the confidence that a region is of a kind, in percent; 0 when nothing supports it.

        `region` is the name of a region; `kind` is floor, verge, object or utak.
        """
        return self.kind.get(region, {}).get(kind, 0)


def percept_facts(percept: Percept, touched: Iterable[tuple[str, str]] = ()) -> list[str]:
    """Return the facts about regions for kb/asp/interpretation.lp, without full stops.

    Parameters
    ----------
    percept : Percept
        The regions of one impression or of the map.
    touched : iterable of (str, str)
        Pairs (name of a region, colour felt there).

    Returns
    -------
    list of str
        For each region R, in their order: `region(R,zero|nonzero,Certain)` (nonzero: occupied) with percent,
        `extent(R,N)` in squares, `mass(R,N)` in tenths of squares, `rim(R)` where it touches what was not seen, and
        `own(R)` for the robot's own cell. Then all `surrounds(Outer,Inner)`, sorted; then all `touched(R,Colour)`,
        sorted.
    """
    facts = []
    for region in percept.regions:
        facts.append(f"region({region.name},{'nonzero' if region.occupied else 'zero'},{region.certain})")
        facts += [f"extent({region.name},{region.extent})", f"mass({region.name},{region.mass})"]
        facts += [f"rim({region.name})"] * region.rim + [f"own({region.name})"] * region.own
    facts += [f"surrounds({outer},{inner})" for outer, inner in sorted(percept.surrounds)]
    facts += [f"touched({region},{colour})" for region, colour in sorted(set(touched))]
    return facts


def interpret_regions(percept: Percept, touched: Iterable[tuple[str, str]] = (), rules: tuple[Path, ...] = ()) -> Kinds:
    """Decide what every region is: floor, verge, object or utak (the robot itself).

    Parameters
    ----------
    percept : Percept
        The regions of one impression or of the map.
    touched : iterable of (str, str)
        Pairs (name of a region, colour felt there).
    rules : tuple of Path
        Files with the user's own encodings, solved together with kb/asp/interpretation.lp.

    Returns
    -------
    Kinds
        For each region, by name, the confidence in percent in each kind that is derived for it, and the pairs of free
        regions that must be connected by unseen floor; both empty when the encodings have no answer. Where one kind is
        derived several times, the greatest confidence counts.

    Raises
    ------
    BadInputError
        The user's encodings are wrong.
    """
    kind: dict[str, dict[str, int]] = {}
    passages = set()
    for atom in solve([INTERPRETATION, *rules], percept_facts(percept, touched)) or ():
        args = [str(a) for a in atom.arguments]
        if atom.match("kind", 3):
            known = kind.setdefault(args[0], {})
            known[args[1]] = max(known.get(args[1], 0), int(args[2]))
        elif atom.match("hidden_passage", 2):
            passages.add((args[0], args[1]))
    return Kinds(kind, frozenset(passages))


def classify_shapes(
    facts: Iterable[str], rules: tuple[Path, ...] = (), world: Iterable[str] = ()
) -> Mapping[str, Mapping[str, int]]:
    """Decide which shapes objects have.

    Parameters
    ----------
    facts : iterable of str
        The facts fit/4, open_squares/2 and full_squares/2 of kb/asp/shapes.lp, without full stops, as of
        `kb.world.objects.shape_facts`.
    rules : tuple of Path
        The user's own encodings, solved together with kb/asp/shapes.lp. What they state of an object and a class counts
        in place of what the encoding derives; of several confidences the greatest.
    world : iterable of str
        What else is known of the objects, as facts without full stops; used where users' rules name it.

    Returns
    -------
    mapping of str to mapping of str to int
        Name of a node -> {shape class: confidence in percent}; nodes of which no shape is derived are missing.

    Raises
    ------
    BadInputError
        The user's encodings are wrong.
    """
    answer: dict[str, dict[str, int]] = {}
    given = list(facts)
    named = [fact for fact in world if fact.partition("(")[0] in world_facts_named(SHAPES.stem, rules)]
    atoms = solve([SHAPES, *rules], [*given, *named]) or []
    if rules_reach(SHAPES.stem, rules):
        with record_decisions():  # what rules change is asked, not decided
            usual = solve([SHAPES], given) or []
        stated = [atom for atom in atoms if atom not in usual]
        replaced = {tuple(atom.arguments[:2]) for atom in stated}
        atoms = [*(atom for atom in usual if tuple(atom.arguments[:2]) not in replaced), *stated]
    for atom in atoms:
        if atom.match("shape", 3):
            node, shape, confidence = (str(a) for a in atom.arguments)
            known = answer.setdefault(node, {})
            known[shape] = max(known.get(shape, 0), int(confidence))
    return answer
