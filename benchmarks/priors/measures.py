"""Measures that confidences are conditioned on, taken at one moment of a run, with what is true of each."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from benchmarks.calibration.runs import LookedAt
from benchmarks.calibration.statements import statements
from utak.kb.language.atoms import atom_parts
from utak.kb.perception.interpretation import LONGEST_OBJECT
from utak.kb.world.chances import Chances
from utak.kb.world.facts import place_facts

FIRST_NOTE = 1_000  # above all confidences
PLACES_TOLD = ("offset(org,", "threshold(")


class RegionSeen(NamedTuple):
    """A region that is not floor, as kb/asp/interpretation.lp is given it."""

    situation: str
    extent: int  # squares
    mass: int  # tenths of squares
    node: str  # the object of the world model that it is; "" for none
    truth: str  # object, verge or floor


class FitSeen(NamedTuple):
    """An object with its fits, as kb/asp/shapes.lp is given them."""

    node: str
    fits: tuple[tuple[str, int], ...]  # class and misfit, the first of the order first
    open: int  # squares of its patch that are not settled
    full: int  # squares that it surely covers
    kind: str  # in truth
    shape: str | None  # in truth


class PlaceSeen(NamedTuple):
    """A fact about a place that is not certain, as kb/world/chances.py measures it."""

    case: str
    measure: int  # percent
    true: bool


class TriedSeen(NamedTuple):
    """An object that no motion has moved, as kb/asp/movable.lp is given it."""

    unmoved: int  # in how many ways it was tried, none of which moved it
    movable: bool  # in truth


def regions_seen(look: LookedAt) -> Iterator[RegionSeen]:
    """Yield the regions of the map that are not floor."""
    given = given_to(look, "interpretation")
    solid = {a[0] for name, a in given if name == "region" and a[1] == "nonzero"}
    empty = {a[0] for name, a in given if name == "region" and a[1] == "zero"}
    numbers = {name: {a[0]: int(a[1]) for told, a in given if told == name} for name in ("extent", "mass")}
    colours: dict[str, set[str]] = {}
    around: dict[str, set[str]] = {}
    for name, arguments in given:
        if name == "touched":
            colours.setdefault(arguments[0], set()).add(arguments[1])
        if name == "surrounds":
            around.setdefault(arguments[0], set()).add(arguments[1])
    isolated = {inner for outer in empty for inner in around.get(outer, ())}
    labels, view, nodes = look.model.labels, look.model.view, {n.region: n.name for n in look.model.objects}
    present = {f"part{n}" for n in np.unique(labels).tolist() if n}
    cut = {region for region in present if region not in solid | empty}
    for region in sorted(solid & present | {one for one in cut if _is_cut(look, one)}):
        rows, columns = np.nonzero(labels == int(region.removeprefix("part")))
        squares = [
            look.frame.square(column + view.west, row + view.south)
            for row, column in zip(rows.tolist(), columns.tolist(), strict=True)
        ]
        felt = colours.get(region, set())
        extent = numbers["extent"].get(region, 0)
        bounds = region not in isolated and bool(around.get(region, set()) & empty)
        situation = _situation(region in cut, region in isolated, bounds, felt, extent)
        truth = look.moment.truth.of(squares).kind
        yield RegionSeen(situation, extent, numbers["mass"].get(region, 0), nodes.get(region, ""), truth)


def _situation(cut: bool, isolated: bool, bounds: bool, felt: set[str], extent: int) -> str:
    """Return which case of kb/asp/interpretation.lp a region is."""
    verge, other = "b" in felt, bool(felt - {"b"})
    if cut:
        return "cut"
    if isolated:
        return {(True, True): "isolated_both", (True, False): "island", (False, True): "own_colour"}.get(
            (verge, other), "isolated"
        )
    if bounds:
        return "bounding"
    if verge:
        return "felt_verge"
    if other:
        return "felt_long" if extent > LONGEST_OBJECT else "own_colour"
    return "undecided"


def _is_cut(look: LookedAt, region: str) -> bool:
    """Return whether a region was cut out of the bounds because of what was felt, and never held."""
    return any(region_of_map.name == region for region_of_map in look.model.percept.regions)


def fits_seen(look: LookedAt) -> Iterator[FitSeen]:
    """Yield the objects whose shape is decided at this moment."""
    given = given_to(look, "shapes")
    numbers: dict[str, dict[str, int]] = {"open_squares": {}, "full_squares": {}}
    fits: dict[str, list[tuple[int, str, int]]] = {}
    for name, arguments in given:
        if name in numbers:
            numbers[name][arguments[0]] = int(arguments[1])
        if name == "fit":
            fits.setdefault(arguments[0], []).append((int(arguments[3]), arguments[1], int(arguments[2])))
    for node, found in sorted(fits.items()):
        true = look.moment.nodes.get(node)
        if true is not None:
            order = tuple((shape, misfit) for _, shape, misfit in sorted(found))
            open_, full = (numbers[name].get(node, 0) for name in ("open_squares", "full_squares"))
            yield FitSeen(node, order, open_, full, true.kind, true.shape)


def places_seen(look: LookedAt) -> Iterator[PlaceSeen]:
    """Yield the facts about places that are not certain."""
    measured: dict[int, tuple[str, int]] = {}

    def noted(case: str, measure: int) -> int:
        """Return a number that stands for a measure in the place of a confidence."""
        measured[FIRST_NOTE + len(measured)] = case, measure
        return FIRST_NOTE + len(measured) - 1

    told = [fact for fact in look.moment.facts if fact.startswith(PLACES_TOLD)]
    facts = place_facts(look.model, look.places, Chances(look.model, look.places.rooms, noted))
    for statement in statements(look.moment._replace(facts=(*told, *facts))):
        if found := measured.pop(statement.confidence, None):  # once: what is stated both ways is one fact
            yield PlaceSeen(*found, statement.true == 1)


def tried_seen(look: LookedAt) -> Iterator[TriedSeen]:
    """Yield the objects that no motion has moved, which are objects in truth."""
    unmoved = {node.name: len(set(node.resisted)) for node in look.model.objects if not node.moved}
    for statement in statements(look.moment, ("movable",)):
        node = atom_parts(statement.fact)[1][0]
        if node in unmoved and look.moment.nodes[node].kind == "object":
            yield TriedSeen(unmoved[node], statement.true == 1)


def given_to(look: LookedAt, encoding: str) -> list[tuple[str, tuple[str, ...]]]:
    """Return the facts that an encoding was given at this moment, as name and arguments; [] where it was not asked."""
    # The last time: it may have been asked before the model was made anew. Of cut regions alone it is asked besides.
    asked = (facts for name, facts in reversed(look.decisions) if name == encoding)
    found = next((facts for facts in asked if not any(fact.startswith("cut(") for fact in facts)), ())
    return [atom_parts(fact) for fact in found]
