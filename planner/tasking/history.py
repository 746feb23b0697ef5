"""The history of a run: what was brought where before a task plan is made, as facts of the past of that plan."""

import math
from collections.abc import Container, Mapping, Sequence
from typing import NamedTuple

from utak.geometry.kernels.arrays import XY
from utak.planner.oracles.problem import HERE
from utak.planner.situation import Situation
from utak.planner.tasking.task_plan import Errand

MAX_DISPLACEMENT = 0.5  # squares by which a thing may lie elsewhere than at a place: half a square
ELSEWHERE = "elsewhere"  # the place of a thing that lies neither where it was at first nor where an errand put it


class _Done(NamedTuple):
    """An errand that was done."""

    name: str  # the object that was brought somewhere
    places: Mapping[str, str]  # the names of the places of all objects before
    moment: int  # the number of points on its track when it was put down
    errand: Errand | None = None  # the errand of a plan that came to its end so; None for none


class DoneErrands:
    """Remembers what was brought somewhere, by tracks: by the plan, or by whatever else the robot did."""

    def __init__(self) -> None:
        """Make a history in which nothing was done."""
        self._done: list[_Done] = []

    def note(self, situation: Situation, ended: Errand | None = None) -> None:
        """Note what was brought somewhere and put down, and by which errand of a plan, if one came to its end now."""
        by = "" if ended is None else ended.subject
        now = situation.renamed
        self._done = [
            one._replace(name=now.get(one.name, one.name), places={now.get(x, x): p for x, p in one.places.items()})
            for one in self._done
        ]
        for name, track in sorted(situation.carried.items()):
            moments = [done.moment for done in self._done if done.name == name] or [1]
            rest = track[: moments[-1]]
            if (name != situation.model.held or name == by) and math.dist(rest[-1], track[-1]) > MAX_DISPLACEMENT:
                if self._done and self._done[-1].name == name:  # what was moved last and is moved on is one errand
                    self._done[-1] = self._done[-1]._replace(moment=len(track))
                else:
                    places = {**self.places(situation), name: self._place(name, rest)}
                    self._done.append(_Done(name, places, len(track)))
        if self._done and self._done[-1].name == by:
            self._done[-1] = self._done[-1]._replace(errand=ended)

    def places(self, situation: Situation) -> dict[str, str]:
        """Return the names of the places at which objects lie now, by object."""
        return {name: self._place(name, track) for name, track in sorted(situation.carried.items())}

    def _place(self, name: str, track: Sequence[XY]) -> str:
        """Return the name of the place at the end of the track of an object, as planner/asp/task/history.lp has it."""
        if math.dist(track[0], track[-1]) <= MAX_DISPLACEMENT:
            return HERE
        put = [
            number
            for number, done in enumerate(self._done)
            if done.name == name and math.dist(track[: done.moment][-1], track[-1]) <= MAX_DISPLACEMENT
        ]
        return f"put_{put[-1]}" if put else ELSEWHERE

    def facts(self, situation: Situation, arrived: Container[str] = ()) -> tuple[str, ...]:
        """Return what was done, without what a plan may go on with, and where things lay and lie, as facts."""
        found: list[str] = []
        goes_on = self._done and self._done[-1].errand is None and self._done[-1].name not in arrived
        past = self._done[:-1] if goes_on else self._done
        for number, (name, places, _, errand) in enumerate(past):
            found.append(f"done({'clear' if errand is None else errand.action}({name},put_{number}),{number})")
            found += [f"done(go({door}),{number})" for door in (() if errand is None else errand.doors)]
            found += [f"lay({other},{place},{number})" for other, place in places.items()]
        now = self.places(situation).items()
        return (*found, *(f"lay({name},{place},{len(past)})" for name, place in now if place != HERE))
