"""What Utak knows, kept up to date: from each impression to a new world model.

The way of one impression: regions (kb.perception.regions), their interpretation (kb/asp), accommodation
(kb.localisation.tracker),
objects and their shapes, and the tree (kb.world.model).
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import boxes
from kb.body import DIRECTIONS, Command, Grasp, Impression
from kb.localisation.hypotheses.explanation import Accommodated
from kb.localisation.state import TrackerState
from kb.localisation.tracker import Tracker
from kb.mapping.object_heat import NOTHING_IMAGINED, imagine
from kb.mapping.occupancy import FREE, FULL, OPEN, MapView
from kb.mapping.patch import Patch, covered, patch_of
from kb.objects.held_object import ROUNDING, HeldObject, seen_insets, seen_short, slack_of
from kb.objects.proportions import reshaped
from kb.objects.shape_fit import Measured, Measurer
from kb.perception.frame import AROUND
from kb.perception.interpretation import Kinds, interpret, shapes
from kb.perception.protrusions import VERGE, protrusions, told_apart
from kb.perception.regions import Percept, Region, label_of, map_regions
from kb.world.model import SPACE, Names, Node, WorldModel, solid, space, unsettled

Mask = NDArray[np.bool_]
LEAST_OBJECT = 5  # percent: a region is kept as a possible object from here on
LARGEST_OBJECT = 24  # squares: what is longer than this and undecided is verge
MAYBE = 0.4  # that a square is covered which the slack of a load's outline leaves open
BESIDE = 0.05  # the same where the outline as it is believed stays out of it: who walks there is hardly stopped
FIXED = 3  # pushes or turns in a row that did not move a thing: then it cannot be moved


class Knowledge:
    """The knowledge base of one robot: its memory, and the world model that follows from it."""

    def __init__(self, rules: tuple[Path, ...] = ()) -> None:
        self.tracker = Tracker()
        self.rules = rules
        self.felt: dict[tuple[int, int], str] = {}
        self.objects: tuple[Node, ...] = ()
        self._names = Names()
        self._touch: tuple[str | None, ...] = ()
        self._imagined = NOTHING_IMAGINED
        self._measurer = Measurer()

    @property
    def memory(self) -> TrackerState:
        """Return what the localisation tracker believes now."""
        return self.tracker.state

    def wake(self, impression: Impression) -> tuple[WorldModel, Accommodated]:
        """The first world model: the default one, an empty floor about Utak, accommodated to the first impression."""
        return self._model(impression, self.tracker.wake(impression))

    def perceive(self, command: Command, impression: Impression) -> tuple[WorldModel, Accommodated]:
        """The world model after a command and its impression."""
        if isinstance(command, Grasp):
            self._grasp(command.direction)
        accommodated = self.tracker.accommodate(command, impression)
        if self.memory.lost and self.memory.held is None:
            return self.begin_anew(impression, lost=True)
        return self._model(impression, accommodated)

    def begin_anew(self, impression: Impression, lost: bool = False) -> tuple[WorldModel, Accommodated]:
        """Forget all but where he has been, and see as if for the first time. impression : the newest one."""
        self.tracker = self.tracker.anew()
        self._names.forget()
        woken = self.tracker.wake(impression)
        woken = woken._replace(explanation=woken.explanation._replace(how="lost" if lost else "anew"))
        return self._model(impression, woken)

    def _grasp(self, direction: str) -> None:
        """Believe that the thing on an adjacent square is in hand, if one of known outline lies or is felt there."""
        x, y = self.memory.square
        beside = self.memory.frame.beside(direction)
        square = None if beside is None else (x + beside[0], y + beside[1])
        there = [n for n in self.objects if square in n.patch.squares()] or self._felt_at(direction)
        node = min(there, key=lambda n: n.name not in self.memory.loads, default=None)
        if node is None or node.polygon is None or self.memory.held is not None:
            return
        load = HeldObject(
            name=node.name,
            polygon=node.polygon,
            first=node.polygon,
            slack=slack_of(node.polygon),
            insets=seen_insets(node.polygon),
            shape=node.shape,
            colour=node.colour,
            support=node.support,
        )
        self.tracker.grasp(load)

    def _felt_at(self, direction: str) -> list[Node]:
        """The objects one of which he may feel in a direction: those that lie about there, if that may be no wall."""
        colour = self._touch[DIRECTIONS.index(direction)] if self._touch else None
        x, y = self.memory.square
        named = [(x + i, y + j) for i, j in self.memory.frame.may_name(direction)]
        known = [self.memory.occupancy.state[self.memory.occupancy.index(*square)] for square in named]
        if colour is None or all(state == FULL for state in known):
            return []
        about = {(i + dx, j + dy) for i, j in named for dx, dy in (*AROUND, (0, 0))}
        return [node for node in self.objects if node.colour in (None, colour) and about & node.patch.squares()]

    def _model(self, impression: Impression, accommodated: Accommodated) -> tuple[WorldModel, Accommodated]:
        if accommodated.explanation.remaps:
            self.felt.clear()  # its squares were those of another lattice
            self._imagined = NOTHING_IMAGINED
        self._feel(impression)
        counted = self.memory.occupancy.view(self.memory.track[: len(self.memory.been)])
        self._imagined = imagined = imagine(counted, self._imagined)
        view = counted._replace(
            probability=imagined.probability(counted.probability), by_counts=counted.probability, sure=self.memory.sure
        )
        self.tracker.keep_completions(imagined.pictures)
        occupied = view.seen & (view.probability > SPACE)
        percept, labels = map_regions(occupied, view.seen, view.state != OPEN, view.probability)
        touched = [(f"part{labels[view.locate(x, y)]}", colour) for (x, y), colour in sorted(self.felt.items())]
        kinds = interpret(percept, touched, self.rules)
        percept, labels, kinds = self._told_apart(percept, labels, kinds, view)
        model = WorldModel(
            self.memory.frame,
            self.memory.place,
            view,
            labels,
            percept,
            kinds,
            objects=(),
            looked_from=self.memory.looked_from,
            barred=self.memory.closed,
            spread=self.memory.spread,
            likely_spread=self.memory.likely_spread,
            leeway=self.memory.leeway,
            held=self.memory.held,
            imagined=imagined,
            touch=impression.touch,
            felt=dict(self.felt),
            lost=self.memory.lost,
            anew=bool(self.memory.been),
            shaken=self.memory.shaken,
            contradicted=accommodated.explanation.residual > 0,
        )
        self.objects = self._objects(model)
        if self.memory.loads:
            model = replace(model, beneath=model.space)
        self._measure_loads()
        for load in self.memory.loads.values():
            model, patch = _laid(model, load)
            self.objects += (_node(load, patch, int(model.labels.max())),)
        self.objects = tuple(sorted(self.objects, key=lambda node: int(node.name[1:])))
        return replace(model, objects=self.objects), accommodated

    def _told_apart(
        self, percept: Percept, labels: NDArray[np.int32], kinds: Kinds, view: MapView
    ) -> tuple[Percept, NDArray[np.int32], Kinds]:
        """The regions, with what was felt to be a thing that stands against the verge as regions of their own."""
        bounds = np.array([kinds.of(f"part{n}", "object") == 0 for n in range(int(labels.max()) + 1)])[labels]
        occupied = solid(view) & bounds
        felt = {view.locate(x, y): colour for (x, y), colour in self.felt.items()}
        felt = {place: colour for place, colour in felt.items() if occupied[place]}
        if all(colour == VERGE for colour in felt.values()):
            return percept, labels, kinds
        labels, regions, kind = labels.copy(), [*percept.regions], dict(kinds.kind)
        for thing in told_apart(protrusions(space(view), occupied, view.seen), felt):
            label = int(labels.max()) + 1
            labels[thing] = label
            regions.append(part_of_verge(thing, label, view))
            kind[f"part{label}"] = {"object": 95}
        left = set(np.unique(labels).tolist())
        there = tuple(region for region in regions if label_of(region.name) in left)
        return percept._replace(regions=there), labels, kinds._replace(kind=kind)

    def _feel(self, impression: Impression) -> None:
        self._touch = impression.touch
        x, y = self.memory.square
        loaded = {square for load in self.memory.loads.values() for square in load.possible.squares()}
        for direction, colour in zip(DIRECTIONS, impression.touch, strict=True):
            beside = self.memory.frame.beside(direction)
            if beside is None:
                continue
            square = x + beside[0], y + beside[1]
            if colour is None or square in loaded:
                self.felt.pop(square, None)
            else:
                self.felt[square] = colour

    def _objects(self, model: WorldModel) -> tuple[Node, ...]:
        regions = [r for r in model.percept.regions if _may_be_object(r.name, r.extent, model.kinds)]
        parts = _parts(model, [label_of(r.name) for r in regions])
        patches = [patch_of(part.mask, part.view) for part in parts]
        names = self._names.assign(patches, self.memory.loads)
        measured = {n: self._measurer.measure(p, model.view) for n, p in zip(names, patches, strict=True)}
        shape = shapes(_shape_facts(measured), self.rules)
        return tuple(
            Node(
                name=name,
                kind="object",
                confidence=model.kinds.of(region.name, "object"),
                region=region.name,
                patch=patch,
                open=left[0],
                vague=left[1],
                shape=shape.get(name, {}),
                polygon=measured[name].polygon,
                colour=self._colour(patch),
                support=_support(part.mask, part.view),
                short=seen_short(measured[name].polygon),
                insets=seen_insets(measured[name].polygon),
            )
            for name, region, part, patch in sorted(
                zip(names, regions, parts, patches, strict=True), key=lambda entry: int(entry[0][1:])
            )
            for left in [unsettled(part.mask, part.view)]
        )

    def _measure_loads(self) -> None:
        """Tell the shape of loads that were found to be larger than they seemed."""
        for name, load in self.memory.loads.items():
            if not load.shape:
                measured = self._measurer.measure_whole(covered(load.first))
                shape = shapes(_shape_facts({name: measured}), self.rules)
                self.tracker.update_object(replace(load, shape=shape.get(name, {})))

    def _colour(self, patch: Patch) -> str | None:
        colours = [self.felt[square] for square in sorted(patch.squares()) if square in self.felt]
        return colours[0] if colours else None


class _Part(NamedTuple):
    """The part of a map about one region, with a square to spare, and where the region lies on it."""

    view: MapView
    mask: Mask


def _parts(model: WorldModel, labels: list[int]) -> list[_Part]:
    """The parts of the map about some regions."""
    framing = boxes(model.labels, int(model.labels.max()))
    found = []
    for label in labels:
        south, west, north, east = framing[label].tolist()
        rows, columns = slice(max(south - 1, 0), north + 2), slice(max(west - 1, 0), east + 2)
        found.append(_Part(model.view.part(rows, columns), model.labels[rows, columns] == label))
    return found


def _node(load: HeldObject, patch: Patch, label: int) -> Node:
    """The node of a thing that he has held. patch : the squares that it covers, or may cover."""
    movable = 99 if load.proven else 0 if load.stuck >= FIXED else 50
    return Node(
        name=load.name,
        kind="object",
        confidence=100,
        region=f"part{label}",
        patch=patch,
        open=0,
        shape=reshaped(load.shape, load.polygon, load.lying_insets),
        polygon=load.polygon,
        colour=load.colour,
        support=load.support,
        movable=movable,
        moved=load.proven,
        turned=load.turned,
        stuck=load.stuck,
        dubious=load.dubious,
        inexact=load.inexact,
        astray=load.astray > ROUNDING,
        short=load.short,
        insets=load.lying_insets,
    )


def _laid(model: WorldModel, load: HeldObject) -> tuple[WorldModel, Patch]:
    """The model with a load laid upon its map, as a region of its own, and the squares that it covers or may cover.

    Utak's own square stays his, for he is a point; but what a load covers in part is no longer settled. Walls that it
    would only reach into by its play stay walls: it does not.
    """
    view, labels = model.view, model.labels.copy()
    lies, sure, possible = (model.squares(p.squares()) for p in (covered(load.polygon), load.sure, load.possible))
    patch = patch_of(possible & ((view.state != FULL) | lies), view)
    here = view.locate(*model.place)
    shared = view.state[here] == FREE and possible[here]
    sure[here] = possible[here] = False
    label = int(labels.max()) + 1
    open_ = possible & (view.state != FULL)
    labels[open_] = label
    state = np.where(sure, np.int8(FULL), np.where(possible & (view.state == FREE), np.int8(OPEN), view.state))
    beside = open_ & ~lies

    def lying(chance: NDArray[np.float32]) -> NDArray[np.float32]:
        may = np.where(beside, np.maximum(chance, np.float32(BESIDE)), np.float32(MAYBE))
        return np.where(sure, np.float32(1), np.where(open_, may, chance))

    probability = lying(view.probability)
    by_counts = None if view.by_counts is None else lying(view.by_counts)
    if shared:
        state[here] = OPEN
    seen = view.seen | possible
    kinds = Kinds({**model.kinds.kind, f"part{label}": {"object": 100}}, model.kinds.hidden_passages)
    laid = view._replace(state=state.astype(np.int8), probability=probability, by_counts=by_counts, seen=seen)
    return replace(model, view=laid, labels=labels, kinds=kinds), patch


def part_of_verge(thing: Mask, label: int, view: MapView) -> Region:
    """The region of a thing that stands against the verge."""
    rows, columns = np.nonzero(thing)
    settled = int(100 * (view.state[thing] == FULL).sum() // len(rows))
    extent = int(max(np.ptp(rows), np.ptp(columns))) + 1
    return Region(f"part{label}", True, settled, False, extent, round(10 * float(view.probability[thing].sum())))


def _may_be_object(region: str, extent: int, kinds: Kinds) -> bool:
    return extent <= LARGEST_OBJECT and kinds.of(region, "object") >= LEAST_OBJECT


def _shape_facts(measured: Mapping[str, Measured]) -> list[str]:
    facts = []
    for name, result in measured.items():
        facts += [f"open_squares({name},{result.open})", f"full_squares({name},{result.full})"]
        facts += [f"fit({name},{shape},{misfit},{i})" for i, (shape, misfit) in enumerate(result.fits, 1)]
    return facts


def _support(mask: Mask, view: MapView) -> tuple[int, ...]:
    numbers = np.unique(view.settled_by[mask & ((view.state == FULL) | (view.state == FREE))])
    return tuple(int(n) for n in numbers if n >= 0)
