"""The knowledge of the robot, kept up to date: the pipeline from one impression to the next world model, on one page.

    impression ->  localisation   what happened: the frame, the robot's place, objects in hand (kb.localisation)
               ->  mapping        counts solved, completions drawn: the map view (kb.mapping)
               ->  perception     regions of the map, and what each of them is (kb.perception)
               ->  objects        nodes of objects seen and of objects held (kb.objects, kb.world.objects)
               ->  world          the world model (kb.world.model)

State lies in three places: the localisation tracker (`Tracker`), the touches (`Touches`) and the names of objects
(`ObjectNames`). Two caches spare work: the completions of the last impression and the shapes measured so far.
"""

from copy import deepcopy
from dataclasses import replace
from itertools import takewhile
from pathlib import Path

from utak.kb.body import Command, Grasp, Impression
from utak.kb.localisation.field_account import Accommodation
from utak.kb.localisation.known.state import TrackerState
from utak.kb.localisation.standing import standing
from utak.kb.localisation.tracker import Tracker
from utak.kb.mapping.object_heat import NO_COMPLETION_SUMMARY, summarise_completions
from utak.kb.mapping.occupancy import OPEN, MapView
from utak.kb.objects.held_object import held_or_moved
from utak.kb.objects.touches import Touches
from utak.kb.perception.interpretation import interpret_regions
from utak.kb.perception.regions import map_regions
from utak.kb.perception.seams import PartedMap, part_mixed_regions
from utak.kb.world.model import MAX_FREE_PROBABILITY, Node, WorldModel
from utak.kb.world.object_names import ObjectNames
from utak.kb.world.objects import (
    MapRegions,
    classified,
    grasped,
    held_node,
    lay_upon,
    seen_objects,
    separate_felt_things,
    with_movability,
    with_persistence,
    within_reach,
)


class Knowledge:
    """The knowledge of one robot: what it remembers, and the world model that follows from it."""

    def __init__(self, rules: tuple[Path, ...] = ()) -> None:
        self.tracker = Tracker()
        self.rules = rules
        self.objects: tuple[Node, ...] = ()
        self._touches = Touches()
        self._names = self._former_names = ObjectNames()  # on this map; on the one of before
        self._completions = NO_COMPLETION_SUMMARY

    @property
    def memory(self) -> TrackerState:
        """Return what the localisation tracker believes now: frame, place (map frame), map, track and held objects."""
        return self.tracker.state

    def wake(self, impression: Impression) -> tuple[WorldModel, Accommodation]:
        """Take in the first impression."""
        return self._update(impression, self.tracker.wake(impression))

    def perceive(self, command: Command, impression: Impression) -> tuple[WorldModel, Accommodation]:
        """Take in the impression that followed a command."""
        if isinstance(command, Grasp):
            self._grasp(command.direction)
        accommodated = self.tracker.accommodate(command, impression)
        if accommodated.explanation.how == "lost":
            return self._begin_elsewhere(command, impression, self.tracker.elsewhere())
        if self.memory.lost and self.memory.in_hand is None:
            return self._begin_elsewhere(command, impression, self.tracker.anew(lost=True))
        return self._update(impression, self._recognised(command) or accommodated)

    def begin_anew(self, impression: Impression) -> tuple[WorldModel, Accommodation]:
        """Forget all but the track, and begin a new map with the newest impression."""
        self.tracker = self.tracker.anew()
        self._names.forget()
        woken = self.tracker.wake(impression)
        return self._update(impression, woken._replace(explanation=woken.explanation._replace(how="anew")))

    def _begin_elsewhere(
        self, command: Command, impression: Impression, begun: Tracker
    ) -> tuple[WorldModel, Accommodation]:
        """Begin a new map with the newest impression, and keep the old one: the robot does not know where it is."""
        held, former = self.memory.held_objects, begun.state.former
        if self.memory.former is None and former is not None:
            self._former_names = deepcopy(self._names)
            moved = (load for name, load in held.items() if name not in former.held_objects)
            self._former_names.miss({load.name: len(load.possible.squares()) for load in moved})
        self.tracker = begun
        self._names.forget()
        woken = self.tracker.wake(impression)
        woken = woken._replace(explanation=woken.explanation._replace(how="lost"))
        return self._update(impression, self._recognised(command) or woken)

    def _recognised(self, command: Command) -> Accommodation | None:
        """Go on with the map of before if what was seen since fits at one place of it; else return None."""
        accommodated = self.tracker.recognise(command)
        if accommodated is not None:
            self._names = self._former_names.counted(self._names)
            self._touches.forget_squares()
            self._completions = NO_COMPLETION_SUMMARY
        return accommodated

    def _grasp(self, direction: str) -> None:
        """Believe that an object is in hand, if one of known outline is, or is felt, on the adjacent square."""
        memory = self.memory
        there = within_reach(self.objects, self._touches, memory.frame, memory.occupancy, memory.square, direction)
        node = min(there, key=lambda n: n.name not in memory.held_objects, default=None)
        if node is not None and node.polygon is not None and memory.in_hand is None:
            self.tracker.grasp(grasped(node))

    def _update(self, impression: Impression, accommodated: Accommodation) -> tuple[WorldModel, Accommodation]:
        """Return the world model after an impression that localisation has taken in already."""
        if accommodated.explanation.remaps:  # all squares are those of another frame now
            self._touches.forget_squares()
            self._completions = NO_COMPLETION_SUMMARY
        if accommodated.explanation.change is not None:  # others changed what is there
            change = accommodated.explanation.change
            self._touches.forget(change.squares)
            gone = (node for node in self.objects if node.name in change.gone)
            self._names.miss({node.name: len(node.patch.squares()) for node in gone})
            self._completions = NO_COMPLETION_SUMMARY
        self._feel(impression)
        view = self._map()
        regions = self._regions(view)
        model = self._world(impression, view, regions)
        return self._with_objects(model), accommodated

    def _feel(self, impression: Impression) -> None:
        """Take in the colours of the 8 adjacent squares, except on squares that moved or held objects may cover."""
        memory = self.memory
        loads = held_or_moved(memory.held_objects, memory.in_hand)
        held = {square for load in loads.values() for square in load.possible.squares()}
        self._touches.feel(impression.touch, memory.frame, memory.square, held)
        felt = self._touches.colours
        for name, load in memory.held_objects.items() if memory.sure else ():
            colours = {felt[square] for square in load.possible.squares() if square in felt}
            if name not in loads and len(colours) > 1:
                self.tracker.withdraw(name)

    def _map(self) -> MapView:
        """Return the map view: counts solved, and probabilities of open squares from completions drawn anew."""
        memory = self.memory
        counted = memory.occupancy.view(memory.track[: len(memory.been)])
        self._completions = summarise_completions(counted, self._completions)
        self.tracker.keep_completions(self._completions.pictures)
        probability = self._completions.probability(counted.probability)
        for x, y in memory.passed:
            probability[counted.locate(x, y)] = 0.0
        return counted._replace(
            probability=probability,
            by_counts=counted.probability,
            sure=memory.sure,
        )

    def _regions(self, view: MapView) -> MapRegions:
        """Return the regions of the map and what each of them is, as seen and as felt."""
        occupied = view.seen & (view.probability > MAX_FREE_PROBABILITY)
        settled = (view.state != OPEN) & view.sure
        percept, labels = map_regions(occupied, view.seen, settled, view.probability)
        felt = self._touches.colours
        parted = PartedMap(percept, labels)
        if view.sure:  # else a colour may have been felt beside the square for which it is taken
            places = {view.locate(x, y): colour for (x, y), colour in sorted(felt.items())}
            parted = part_mixed_regions(percept, labels, places, settled, view.probability)
        percept, labels, _ = parted
        touched = [(f"part{labels[view.locate(x, y)]}", colour) for (x, y), colour in sorted(felt.items())]
        regions = MapRegions(percept, labels, interpret_regions(percept, touched, self.rules), parted.unsettled)
        return separate_felt_things(regions, view, felt, self.rules)

    def _world(self, impression: Impression, view: MapView, regions: MapRegions) -> WorldModel:
        """Return the world model without objects, from the tracker, the touches, the map view and its regions."""
        memory = self.memory
        return WorldModel(
            memory.frame,
            memory.place,
            view,
            regions.labels,
            regions.percept,
            regions.kinds,
            objects=(),
            looked_from=memory.looked_from,
            looked_since=memory.looked_since,
            barred=memory.closed,
            spread=memory.spread,
            likely_spread=memory.likely_spread,
            leeway=memory.leeway,
            standing=standing(memory),
            held=memory.in_hand,
            may_hold=memory.may_hold,
            imagined=self._completions,
            touch=impression.touch,
            felt=dict(self._touches.colours),
            unsettled_seams=regions.unsettled_seams,
            lost=memory.lost,
            anew=bool(memory.been),
            elsewhere=memory.former is not None and not memory.slips,
            interrupted=bool(memory.been or memory.lifted_at),
            shaken=memory.shaken,
            contradicted=len(list(takewhile(bool, reversed(memory.residuals)))),
        )

    def _with_objects(self, model: WorldModel) -> WorldModel:
        """Return a world model with its objects: those seen on the map, and those that were held."""
        held = self.memory.held_objects
        objects = seen_objects(model, lambda patches: self._names.assign(patches, held), self._touches, self.rules)
        if held:
            model = replace(model, floor_under_moved=model.space)
        for load in list(held.values()):
            self.tracker.update_object(classified(load, self.rules))
        for load in self.memory.held_objects.values():
            model, patch = lay_upon(model, load)
            objects += (held_node(load, patch, int(model.labels.max())),)
        nodes = with_movability(sorted(objects, key=lambda node: int(node.name[1:])), model, self.rules)
        self.objects = with_persistence(nodes, self.memory, self.rules)
        self.tracker.keep_things(
            {node.name: frozenset(node.patch.squares()) for node in self.objects if node.name not in held}
        )
        return replace(model, objects=self.objects, missing=self._names.missing)
