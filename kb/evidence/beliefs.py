"""Reasons for the facts of the world model: the rules that derived them, down to cells, touches and commands."""

import re
from collections.abc import Callable
from itertools import islice
from typing import Protocol

from utak.kb.evidence.inputs import Given, input_reason, squares_reason, stretch_reason
from utak.kb.evidence.plans import DECIDED_BY, PLAN_ENCODING, TASK_PLAN_NAMES, plan_fact_reason
from utak.kb.evidence.proving import words_of
from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.evidence.record import Record
from utak.kb.evidence.witness import (
    beside_reason,
    command_reason,
    felt_reason,
    line_squares,
    node_squares,
    seen_reason,
    touch_reasons,
)
from utak.kb.language.atoms import atom_parts, long_form
from utak.kb.language.diagnostics import BadInputError, did_you_mean
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.vocabulary import thing_positions
from utak.kb.tracing.decisions import SolverCall
from utak.kb.world.chances import MAX_DOOR_WIDTH
from utak.kb.world.model import FACT_UNITS_PER_SQUARE, FLOOR_NODE, ROOT_NODE, VERGE_NODE

PART_NAME = re.compile(r"(o\d+)_\d+")  # of a part of an object


class AnswerProver(Protocol):
    """Explains the answer of an encoding."""

    def __call__(self, call: SolverCall, atom: str, leaf: Callable[[str], Reason]) -> Reason:
        """Return the reason why an answer holds an atom; leaf : returns the reason of an input of the encoding."""


class FactExplainer:
    """Explains the facts of the world model of a run."""

    def __init__(self, record: Record, prove: AnswerProver) -> None:
        self.record = record
        self._prove = prove

    def explain(self, fact: str, step: int) -> Reason:
        """Return the reason why a fact is believed at a step."""
        wanted = plain_fact(fact)
        found = self.reason(wanted, step)
        if found is None:
            raise self._not_believed(wanted, step)
        return found

    def reason(self, fact: str, step: int) -> Reason | None:
        """Return the reason of a fact without a full stop at a step; None when it is not believed then."""
        if fact not in self.record.steps[step].fact_set:
            return None
        name, arguments = atom_parts(fact)
        if name == "parameter":
            return Reason(fact, words_of("belief", fact), ReasonKind.TASK, "the task")
        if name in TASK_PLAN_NAMES:
            return plan_fact_reason(self, fact, step)
        long = long_form(fact)
        if long in self.record.steps[step].fact_set:
            known = self.reason(long, step)
            below = [] if known is None else [known]
        else:
            below = self._below(fact, name, arguments, step)
        return Reason(fact, _in_words(fact, name, arguments), ReasonKind.FACT, f"step {step}", tuple(below))

    def decision(self, encoding: str, atom: str, step: int, oldest: int = 0) -> Reason | None:
        """Return the reason of an atom of an encoding's newest answer between two steps; None when none holds it."""
        found = self.record.last_answer(step, encoding, atom, oldest)
        return None if found is None else self.prove(found[1], atom, found[0])

    def prove(self, call: SolverCall, atom: str, step: int) -> Reason:
        """Return the reason of an atom of an answer that was given at a step, with the reasons of its inputs."""

        def leaf(given: str) -> Reason:
            """Return the reason of an input of the encoding."""
            if call.encoding == PLAN_ENCODING and given.startswith("may_mean("):
                return self._possible_meaning(given, step)
            made = self._agenda_with(given, step) if call.encoding == PLAN_ENCODING else None
            if made is not None and given in (made.answer or ()):
                return self.prove(made, given, step)
            return input_reason(self.record, Given(given, made or call, step), self.reason)

        return self._prove(call, atom, leaf)

    def _agenda_with(self, given: str, step: int) -> SolverCall | None:
        """Return the choice of the agenda that has what the task plan was given, such as what S is stuck with."""
        asked = (call for call in self.record.decisions(step) if call.encoding == DECIDED_BY)
        return next((call for call in asked if given in (*call.facts, *(call.answer or ()))), None)

    def _below(self, fact: str, name: str, arguments: tuple[str, ...], step: int) -> list[Reason]:
        """Return what a believed fact rests on."""
        node = arguments[0]
        if name == "kind":
            return self._kind_reasons(node, arguments[1], arguments[2], step)
        if name == "shape":
            found = self.decision("shapes", fact, step)
            return [found] if found else [squares_reason(self.record, step, node)]
        if name == "colour":
            felt = felt_reason(self.record, step, node_squares(self.record.steps[step], node), arguments[1], node)
            return [felt] if felt else [squares_reason(self.record, step, node)]
        if name in ("door", "width", "threshold", "connects", "crosses"):
            return self._door_reasons(name, arguments, step)
        if name == "borders":
            return self._facts([f"link({node},", f"rect({arguments[1]},"], step)
        if name == "corner":
            return self._corner_reasons(arguments, step)
        if name == "movable":
            return self._movable_reasons(node, arguments[1], step)
        if name in ("may_be", "joined", "hidden", "plug", "loc"):
            found = self.decision("chances", fact, step, oldest=step)
            return [*([found] if found else []), *self._facts([f"stretch({node},"] * (name == "plug"), step)]
        if name == "held":
            return self._grasp_reasons(node, step)
        if name == "segment":
            return self._segment_reasons(node, arguments, step)
        if name == "adjacent":
            return self._touching_reasons(arguments[0], arguments[1], step)
        if name == "stretch":
            return [stretch_reason(self.record, step, arguments)]
        if name in ("region", "part_of"):
            return self._region_reasons(node, step)
        if name == "bound":
            return self._meaning_reasons(arguments[0], arguments[1], step)
        if name in ("offset", "in", "rect") and node == ROOT_NODE:
            return [self._pose_reason(step), *self._facts([f"room({arguments[1]})"] * (name == "in"), step)]
        if name == "room":
            return self._room_reasons(node, step)
        if name == "unseen":
            counts = f"the counts of the impressions up to {step} leave them open"
            return [Reason(f"{arguments[1]} squares of {node} are open", counts, ReasonKind.MEASURED, f"step {step}")]
        return self._other_reasons(name, arguments, step)

    def _touching_reasons(self, one: str, other: str, step: int) -> list[Reason]:
        """Return why two things touch: where they lie, what the robot feels of one, the wall beside the other."""
        first, second = sorted((one, other), key=lambda thing: (thing != ROOT_NODE, thing == VERGE_NODE))
        places = [f"{'offset' if one == ROOT_NODE else 'rect'}({one}," for one in (first, second) if one != VERGE_NODE]
        if first == ROOT_NODE:
            return [*touch_reasons(self.record, step, second), *self._facts(places, step)]
        beside = beside_reason(self.record, step, first) if second == VERGE_NODE else None
        return [*self._facts(places, step), *([] if beside is None else [beside])]

    def _meaning_reasons(self, parameter: str, node: str, step: int) -> list[Reason]:
        """Return why a parameter means a node: by reconciliation, and by the task plan where that chose."""
        atom = f"bind({parameter},{node})"
        found = [self.decision("reconciliation", atom, step)]
        bound = self.record.last_answer(step, "reconciliation", atom)
        if bound is not None and f"planned({parameter},{node})" in bound[1].facts:
            found.append(self.decision(PLAN_ENCODING, f"meaning({parameter},{node})", step))
        return [reason for reason in found if reason is not None]

    def _possible_meaning(self, given: str, step: int) -> Reason:
        """Return why the task plan was told that a parameter may mean a node: by reconciliation."""
        pair = ",".join(atom_parts(given)[1])
        found = [self.decision("reconciliation", f"{name}({pair})", step) for name in ("as_well", "bind")]
        below = tuple(reason for reason in found if reason is not None)[:1]
        return Reason(given, words_of(PLAN_ENCODING, given), ReasonKind.INPUT, f"step {step}", below)

    def _other_reasons(self, name: str, arguments: tuple[str, ...], step: int) -> list[Reason]:
        """Return what facts rest on that geometry measures alone: places, outlines, rooms and the pathgraph."""
        node = arguments[-1] if name == "child" else arguments[0]
        if name in ("link", "junction"):
            node = FLOOR_NODE
        if node == ROOT_NODE:
            return [Reason("the robot is the root of the world model", "", ReasonKind.CONVENTION)]
        if name == "offset" and node in (FLOOR_NODE, VERGE_NODE):
            return [self._pose_reason(step)]
        if (found := PART_NAME.fullmatch(node)) is not None:
            return [squares_reason(self.record, step, found[1])]
        if name == "in":
            about = self._facts([f"kind({node},object,", f"room({arguments[1]})"], step)
            return [self._shares_reason(node, step), squares_reason(self.record, step, node), *about]
        return [squares_reason(self.record, step, node)]

    def _shares_reason(self, node: str, step: int) -> Reason:
        """Return in which rooms the middle of a thing may lie."""
        facts = [atom_parts(fact)[1] for fact in self.record.steps[step].long_facts if fact.startswith(f"in({node},")]
        rooms = " and ".join(f"{room} with {share} percent" for _, room, share in facts)
        because = (
            f"by the squares in which it may lie: {rooms}; near a door both sides count alike, and the likeliest "
            "room has what was counted for such shares"
        )
        return Reason(f"the middle of {node} lies in one of these rooms", because, ReasonKind.MEASURED, f"step {step}")

    def _room_reasons(self, room: str, step: int) -> list[Reason]:
        """Return why a part of the floor is a room: the doors that bound it, as far as they are believed."""
        now = self.record.steps[step]
        leading = [atom_parts(fact)[1] for fact in now.long_facts if fact.startswith("connects(")]
        doors = [door for door, one, *_ in leading if one == room]
        ends = f"{room} ends at walls, at what was not seen yet, or at necks that are not sure enough to be doors"
        parted = (
            []
            if doors
            else [Reason("no believed door leads from it to another room", ends, ReasonKind.MEASURED, f"step {step}")]
        )
        floor = squares_reason(self.record, step, FLOOR_NODE)
        return [*self._facts([f"door({door}{end}" for door in doors for end in (",", ")")], step), *parted, floor]

    def _region_reasons(self, region: str, step: int) -> list[Reason]:
        """Return why there is a region of the map: the cells that show the squares of its node."""
        if (found := PART_NAME.fullmatch(region)) is not None:
            return [squares_reason(self.record, step, found[1])]
        facts = self.record.steps[step].facts
        whole = next((atom_parts(fact)[1][1] for fact in facts if fact.startswith(f"part_of({region},")), FLOOR_NODE)
        return [squares_reason(self.record, step, whole)]

    def _kind_reasons(self, node: str, kind: str, confidence: str, step: int) -> list[Reason]:
        """Return why a node is of a kind: the interpretation of its region, or that it was moved."""
        if node == ROOT_NODE:
            return [Reason("the robot is itself in the world", "", ReasonKind.CONVENTION)]
        now = self.record.steps[step]
        if node in now.moved:
            return self._motion_reasons(node, step)
        region = now.regions.get(node)
        if region is not None:
            found = self.decision("interpretation", f"kind({region},{kind},{confidence})", step, oldest=step)
            if found is not None:
                return [found]
            colour = next((fact for fact in now.long_facts if fact.startswith(f"colour({node},")), None)
            if colour is not None:
                return self._facts([colour], step)
        return [squares_reason(self.record, step, node)]

    def _segment_reasons(self, node: str, arguments: tuple[str, ...], step: int) -> list[Reason]:
        """Return why a piece of a boundary is believed: the cells on its two sides. The node lies on its left."""
        now = self.record.steps[step]
        west, south, east, north = (int(value) / FACT_UNITS_PER_SQUARE for value in arguments[2:6])
        inside = line_squares(now, (west, south), (east, north), 0.5)
        outside = line_squares(now, (west, south), (east, north), -0.5)
        return [
            seen_reason(self.record, step, inside, node != FLOOR_NODE, "the squares on its left"),
            seen_reason(self.record, step, outside, node == FLOOR_NODE, "the squares on its right"),
        ]

    def _door_reasons(self, name: str, arguments: tuple[str, ...], step: int) -> list[Reason]:
        """Return why a door is believed: the neck of the floor that rooms.lp takes for a door."""
        if name == "crosses":
            return self._facts([f"link({arguments[0]},", f"threshold({arguments[1]},"], step)
        door = arguments[0]
        if name != "door":
            return [*self._facts([f"door({door},"], step), *_measured_between(name, arguments, step)]
        ends = self.record.steps[step].necks.get(door)
        for number, call in self.record.answers(step, "rooms") if ends is not None else ():
            for atom in call.answer or ():
                kind, (neck, *_) = atom_parts(atom)
                if kind == "door" and [tuple(end) for end in call.about[int(neck)]] == ends:
                    return [self.prove(call, atom, number), *_door_doubts(arguments, atom, step)]
        return [squares_reason(self.record, step, FLOOR_NODE)]

    def _corner_reasons(self, arguments: tuple[str, ...], step: int) -> list[Reason]:
        """Return why a corner is the furthest one: the answer of corners.lp with its place."""
        side, east, north, share = arguments
        for number, call in self.record.answers(step, "corners"):
            for atom in call.answer or ():
                kind, parts = atom_parts(atom)
                if kind == "furthest" and parts[0] == side and f"convex({parts[1]},{east},{north})" in call.facts:
                    return [self.prove(call, atom, number), *_corner_counts(share, step)]
        return [squares_reason(self.record, step, FLOOR_NODE)]

    def _movable_reasons(self, node: str, confidence: str, step: int) -> list[Reason]:
        """Return why a node is believed to be movable, or not: motions with it, or that it was never tried."""
        if node in self.record.steps[step].moved:
            return self._motion_reasons(node, step)
        if confidence == "0":
            tried = self._motion_reasons(node, step)
            if tried:
                return tried
        said = (
            self.prove(call, atom, number)
            for number, call in self.record.answers(step, "movable", step)
            for atom in call.answer or ()  # those of users' rules come first
            if atom_parts(atom)[1][0] == node
        )
        return [*islice(said, 1), *self._facts([f"kind({node},object,"], step)]

    def _grasp_reasons(self, node: str, step: int) -> list[Reason]:
        """Return why a node is believed to be in hand: the newest grasp."""
        for number in range(step, -1, -1):
            action = self.record.steps[number].action
            if action is not None and action["do"] == "grasp":
                return [command_reason(self.record.steps[number]), squares_reason(self.record, step, node)]
        return [squares_reason(self.record, step, node)]

    def _motion_reasons(self, node: str, step: int) -> list[Reason]:
        """Return the newest grasp and the newest push or turn while a node was in hand, and the cells that show it."""
        held = f"held({node})"
        for number in range(step, -1, -1):
            now = self.record.steps[number]
            if held in now.fact_set and now.action is not None and now.action["do"] in ("push", "turn"):
                return [command_reason(now), *self._grasp_reasons(node, number)]
        return []

    def _pose_reason(self, step: int) -> Reason:
        """Return why the robot believes itself where it does: the explanation of its newest impression."""
        for _, call in self.record.answers(step, "accommodation", step):
            if call.answer:
                return self.prove(call, call.answer[0], step)
        now = self.record.steps[step]
        counts = {letter: now.status.count(letter) for letter in "pen"}
        because = (
            f"the motion ended as predicted: of 160 cells {counts['p']} are as predicted, {counts['e']} show what is "
            f"new, {counts['n']} contradict the map"
        )
        return Reason(
            f"the impression was {now.pose}",
            because,
            ReasonKind.MEASURED,
            f"step {step}",
            (command_reason(now),),
            counts,
        )

    def _facts(self, starts: list[str], step: int) -> list[Reason]:
        """Return the reasons of the believed facts that begin with some texts, in the order of these."""
        now = self.record.steps[step]
        facts = [fact for start in starts for fact in now.long_facts if fact.startswith(start)]
        return [reason for fact in facts if (reason := self.reason(fact, step)) is not None]

    def _not_believed(self, fact: str, step: int) -> BadInputError:
        """Return the error that a fact is not believed, with the nearest believed one as a hint."""
        name, _ = atom_parts(fact)
        near = did_you_mean(fact, [other for other in self.record.steps[step].facts if other.startswith(f"{name}(")])
        hint = near or "whynot tells what is missing"
        return BadInputError.about("why", fact, f"this is not believed at step {step}", hint)


def _corner_counts(share: str, step: int) -> list[Reason]:
    """Return from where the percent of belief in a corner comes; [] for what is settled."""
    if share in ("0", "100"):
        return []
    because = f"of corners with squares about them that were as likely floor and wall, {share} percent were corners"
    return [Reason("how sure it is", f"{because}, by what was counted", ReasonKind.MEASURED, f"step {step}")]


def _door_doubts(arguments: tuple[str, ...], chosen: str, step: int) -> list[Reason]:
    """Return why a door is not believed as rooms.lp measures it; [] where it is."""
    share = arguments[-1]
    if share == atom_parts(chosen)[1][-1]:
        return []
    because = f"of necks measured alike {share} percent were doors, by what was counted"
    return [Reason("it is not beyond doubt", because, ReasonKind.MEASURED, f"step {step}")]


def _measured_between(name: str, arguments: tuple[str, ...], step: int) -> list[Reason]:
    """Return between what the bounds of the width of a door were measured; [] for other facts of doors."""
    if name != "width" or len(arguments) != 3:
        return []
    least, most = (f"{int(value) / FACT_UNITS_PER_SQUARE:g} squares" for value in arguments[1:])
    sure = f"the floor on its line that is free beyond doubt is {least} wide"
    walls = f"the nearest squares that are wall beyond doubt, on both ends, leave at most {most} between them"
    beyond = "no wall beyond doubt was seen on both ends" if _is_unbounded(arguments[2]) else walls
    return [Reason("its bounds", f"{sure}; {beyond}", ReasonKind.MEASURED, f"step {step}")]


def _is_unbounded(most: str) -> bool:
    """Return whether the greatest width of a door, in hundredths of squares as text, is that of the largest table."""
    return int(most) >= int(FACT_UNITS_PER_SQUARE * MAX_DOOR_WIDTH)


def _in_words(fact: str, name: str, arguments: tuple[str, ...]) -> str:
    """Return a believed fact in words. The floor counts from where the robot woke, and lies relative to the robot."""
    if name == "offset" and arguments[0] == FLOOR_NODE:
        east, north = (int(value) / FACT_UNITS_PER_SQUARE for value in arguments[1:])
        return f"where the robot believes that it woke lies {east:g} squares east and {north:g} north of where it is"
    if name == "kind" and len(arguments) == 3 and arguments[0] in (FLOOR_NODE, VERGE_NODE):
        return f"the squares of the {arguments[0]} are such with {arguments[2]} percent on average"
    if name == "width" and len(arguments) == 3 and _is_unbounded(arguments[2]):
        least, what = int(arguments[1]) / FACT_UNITS_PER_SQUARE, f"what is taken for door {arguments[0]}"
        return f"{what} is at least {least:g} squares wide" if least else f"nothing settled bounds how wide {what} is"
    return words_of("belief", fact)


def plain_fact(fact: str) -> str:
    """Return a fact as the world model states it: without blanks and full stop, and with org for utak.

    >>> plain_fact(" offset(utak, 0, -150). ")
    'offset(org,0,-150)'
    """
    name, arguments = atom_parts(fact.strip())
    things = thing_positions((name, len(arguments)))
    named = [ROOT_NODE if at in things and argument == ROBOT else argument for at, argument in enumerate(arguments)]
    return f"{name}({','.join(named)})" if named else name


def with_node(atom: str) -> str:
    """Return an atom of a predicate that users' rules define for queries, with org for utak, as these hold it.

    >>> with_node("alone(utak)")
    'alone(org)'
    """
    name, arguments = atom_parts(atom)
    return f"{name}({','.join(ROOT_NODE if one == ROBOT else one for one in arguments)})" if arguments else name
