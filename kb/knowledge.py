"""What Utak knows, kept up to date: from each impression to a new world model.

The way of one impression: regions (kb.regions), their interpretation (kb/asp), accommodation (kb.accommodation),
objects and their shapes, and the tree (kb.worldmodel).
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from kb.accommodation import Accommodated, Memory
from kb.body import Command, Impression
from kb.evidence import FREE, FULL, OPEN, MapView
from kb.interpretation import Kinds, interpret, shapes
from kb.lattice import turned
from kb.measuring import Measured, Measurer
from kb.regions import map_regions
from kb.worldmodel import SPACE, Names, Node, Patch, WorldModel, patch_of, unsettled

TOUCHES = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))  # clockwise from his north
LEAST_OBJECT = 5  # percent: a region is kept as a possible object from here on
LARGEST_OBJECT = 24  # squares: what is longer than this and undecided is verge


class Knowledge:
    """The knowledge base of one robot: its memory, and the world model that follows from it."""

    def __init__(self, rules: tuple[Path, ...] = ()) -> None:
        self.memory = Memory()
        self.rules = rules
        self.felt: dict[tuple[int, int], str] = {}
        self._names = Names()
        self._measurer = Measurer()

    def wake(self, impression: Impression) -> tuple[WorldModel, Accommodated]:
        """The first world model: the default one, an empty floor about Utak, accommodated to the first impression."""
        return self._model(impression, self.memory.wake(impression))

    def perceive(self, command: Command, impression: Impression) -> tuple[WorldModel, Accommodated]:
        """The world model after a command and its impression."""
        return self._model(impression, self.memory.accommodate(command, impression))

    def _model(self, impression: Impression, accommodated: Accommodated) -> tuple[WorldModel, Accommodated]:
        if accommodated.explanation.how == "turned":
            self.felt.clear()  # its squares were those of another lattice
        self._feel(impression)
        view = self.memory.evidence.view()._replace(sure=self.memory.sure)
        occupied = view.seen & (view.probability > SPACE)
        percept, labels = map_regions(occupied, view.seen, view.state != OPEN, view.probability)
        touched = [(f"part{labels[view.locate(x, y)]}", colour) for (x, y), colour in sorted(self.felt.items())]
        kinds = interpret(percept, touched, self.rules)
        model = WorldModel(
            self.memory.lattice,
            self.memory.place,
            view,
            labels,
            percept,
            kinds,
            objects=(),
            looked_from=self.memory.looked_from,
            barred=frozenset(self.memory.barred),
            spread=self.memory.spread,
        )
        return replace(model, objects=self._objects(model)), accommodated

    def _feel(self, impression: Impression) -> None:
        x, y = self.memory.square
        for (east, north), colour in zip(TOUCHES, impression.touch, strict=True):
            column, row = (round(v) for v in turned(east, north, self.memory.lattice.angle))
            if colour is None:
                self.felt.pop((x + column, y + row), None)
            else:
                self.felt[x + column, y + row] = colour

    def _objects(self, model: WorldModel) -> tuple[Node, ...]:
        regions = [r for r in model.percept.regions if _may_be_object(r.name, r.extent, model.kinds)]
        masks = [model.labels == int(r.name[4:]) for r in regions]
        patches = [patch_of(mask, model.view) for mask in masks]
        names = self._names.assign(patches)
        measured = {n: self._measurer.measure(p, model.view) for n, p in zip(names, patches, strict=True)}
        shape = shapes(_shape_facts(measured), self.rules)
        return tuple(
            Node(
                name=name,
                kind="object",
                confidence=model.kinds.of(region.name, "object"),
                region=region.name,
                patch=patch,
                open=unsettled(mask, model.view),
                shape=shape.get(name, {}),
                polygon=measured[name].polygon,
                colour=self._colour(patch),
                support=_support(mask, model.view),
            )
            for name, region, mask, patch in sorted(
                zip(names, regions, masks, patches, strict=True), key=lambda entry: int(entry[0][1:])
            )
        )

    def _colour(self, patch: Patch) -> str | None:
        colours = [self.felt[square] for square in sorted(patch.squares()) if square in self.felt]
        return colours[0] if colours else None


def _may_be_object(region: str, extent: int, kinds: Kinds) -> bool:
    return extent <= LARGEST_OBJECT and kinds.of(region, "object") >= LEAST_OBJECT


def _shape_facts(measured: Mapping[str, Measured]) -> list[str]:
    facts = []
    for name, result in measured.items():
        facts += [f"open_squares({name},{result.open})", f"full_squares({name},{result.full})"]
        facts += [f"fit({name},{shape},{misfit},{i})" for i, (shape, misfit) in enumerate(result.fits, 1)]
    return facts


def _support(mask: np.ndarray[tuple[int, ...], np.dtype[np.bool_]], view: MapView) -> tuple[int, ...]:
    numbers = np.unique(view.settled_by[mask & ((view.state == FULL) | (view.state == FREE))])
    return tuple(int(n) for n in numbers if n >= 0)
