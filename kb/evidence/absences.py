"""Why a fact is not believed: the smallest change of what encodings were given, or what is believed in its place."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from utak.kb.evidence.beliefs import FactExplainer, plain_fact, with_node
from utak.kb.evidence.inputs import Given, input_reason
from utak.kb.evidence.plans import TASK_PLAN_NAMES, planned_choice
from utak.kb.evidence.proving import call_deriving, query_predicates, unknown_predicate
from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.explanation.query_absence import explain_query_absence
from utak.kb.explanation.values import Absence
from utak.kb.explanation.whynot import explain_absence
from utak.kb.language.atoms import atom_parts, long_form
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.vocabulary import BELIEF_PREDICATES, Signature, thing_positions
from utak.kb.perception.interpretation import surest_kind
from utak.kb.tracing.decisions import SolverCall

NAMED = re.compile("[odr][0-9]+")  # the names of things, rooms and doors
KINDS_BY_LETTER = {"o": ("object", "node"), "r": ("room", "room"), "d": ("door", "door")}  # with what states each
WIDER_SHAPES = ("rectangle", "polygon")  # of several classes each
INSTEAD_SHOWN = 6  # believed facts that are named in the place of a missing one, at most; a convention


class AbsenceExplainer:
    """Explains why facts of the world model are not believed."""

    def __init__(self, facts: FactExplainer, rule_files: Sequence[str] = ()) -> None:
        self._facts, self._rule_files = facts, tuple(rule_files)

    def explain(self, fact: str, step: int) -> Reason:
        """Return why a fact is not believed at a step."""
        wanted = plain_fact(fact)
        if wanted in self._facts.record.steps[step].fact_set:
            raise _error(wanted, f"this is believed at step {step}: why tells the reason")
        name, arguments = atom_parts(wanted)
        signature = (name, len(arguments))
        if signature == ("object", 1):
            return self._no_object(wanted, arguments[0], step)
        if signature not in BELIEF_PREDICATES:
            return self._not_derived(wanted, signature, step)
        if meant := self._as_meant(wanted, step):
            return self.explain(meant, step)
        if absent := self._no_such(wanted, step):
            return absent
        if long := long_form(wanted, "C"):
            return self._not_known(wanted, long, step)
        for call, atom, number in self._decisions(wanted, step):
            return self._absence(wanted, step, call, atom, number)
        return self._instead(wanted, step)

    def _as_meant(self, wanted: str, step: int) -> str:
        """Return a fact about the thing that a word of the task means, if one names a thing in it; else ""."""
        name, arguments = atom_parts(wanted)
        bound, things = self._facts.record.steps[step].bound, thing_positions((name, len(arguments)))
        meant = [bound.get(one, one) if at in things else one for at, one in enumerate(arguments)]
        return f"{name}({','.join(meant)})" if meant != [*arguments] else ""

    def _no_such(self, wanted: str, step: int) -> Reason | None:
        """Return that a thing, room or door that a fact names is not believed to be there; None where all are."""
        name, arguments = atom_parts(wanted)
        facts = [atom_parts(fact) for fact in self._facts.record.steps[step].facts]
        for one in () if name in (*TASK_PLAN_NAMES, "held") else filter(NAMED.fullmatch, arguments):
            kind, stated = KINDS_BY_LETTER[one[0]]
            named = (parts[0] for word, parts in facts if word == stated)
            there = [other for other in dict.fromkeys(named) if NAMED.fullmatch(other)]
            if one in there:
                continue
            because = f"no {kind} {one} is believed to be there at this step; {', '.join(there) or 'none'} is"
            below = tuple(self._alternatives(wanted, step))
            if kind == "door":  # its name says nothing of where it would be: the best of all that are none
                opening = next(self._opening(step), None)
                below += () if opening is None else (self._absence(f"door({one})", step, *opening),)
                because += "" if opening is None else "; of the necks that are no doors this comes nearest"
            data = {"missing": [wanted], "in_way": [], "partial": False, "found": True}
            return Reason(f"not {wanted}", because, ReasonKind.NEGATION, f"step {step}", below, data)
        return None

    def _no_object(self, wanted: str, node: str, step: int) -> Reason:
        """Return why a node is no object."""
        start = f"kind({node},object,"
        if any(fact.startswith(start) for fact in self._facts.record.steps[step].facts):
            raise _error(wanted, f"this is believed at step {step}: why tells the reason")
        below = self.explain(f"{start}C)", step)
        because = f"object({node}) stands for kind({node}, object, C), which is not believed"
        return Reason(f"not {wanted}", because, ReasonKind.NEGATION, f"step {step}", (below,), below.data)

    def _not_known(self, wanted: str, long: str, step: int) -> Reason:
        """Return why a short form does not hold: how sure the fact is, or why it is not believed at all."""
        start = f"{long.removesuffix('C)')}"
        found = [fact for fact in self._facts.record.steps[step].facts if fact.startswith(start)]
        below = tuple(reason for fact in found if (reason := self._facts.reason(fact, step)) is not None)
        if not below:
            below = (self.explain(long, step),)
            return Reason(
                f"not {wanted}", f"{long} is not believed", ReasonKind.NEGATION, f"step {step}", below, below[0].data
            )
        because = f"{wanted} is stated only with 100 percent; {', '.join(found)} is believed"
        data = {"missing": [f"{start}100)"], "in_way": found, "partial": False, "found": True}
        return Reason(f"not {wanted}", because, ReasonKind.NEGATION, f"step {step}", below, data)

    def _not_derived(self, wanted: str, signature: Signature, step: int) -> Reason:
        """Return why an atom of a predicate that users' rules define does not hold; BadInputError for others."""
        if signature in query_predicates(self._rule_files):
            wanted = with_node(wanted)
            found = explain_query_absence(self._facts.record.steps[step].facts, wanted, self._rule_files)
            in_way = tuple(reason for fact in found.in_way if (reason := self._facts.reason(fact, step)) is not None)
            return self._reason_of(wanted, found, in_way, step)
        call = call_deriving(self._facts.record.decisions(step), wanted, self._rule_files)
        if call is None:
            raise BadInputError([unknown_predicate(wanted, signature, self._rule_files)])
        return self._absence(wanted, step, call, wanted, step)

    def _decisions(self, fact: str, step: int) -> Iterator[tuple[SolverCall, str, int]]:
        """Yield the answer of an encoding that could derive a fact, the atom that would be it, its step."""
        name, arguments = atom_parts(fact)
        now = self._facts.record.steps[step]
        if name == "kind" and len(arguments) == 3 and arguments[0] in now.regions:
            confidence = _number_or(arguments[2], surest_kind(arguments[1]))
            atom = f"kind({now.regions[arguments[0]]},{arguments[1]},{confidence})"
            yield from self._calls("interpretation", atom, step)
        elif name == "shape" and len(arguments) == 3 and f"node({arguments[0]})" in now.fact_set:
            node, shape = arguments[:2]
            call, number = self._newest("shapes", step, f"fit({node},")
            found = [atom_parts(atom)[1] for atom in call.answer or () if atom.startswith(f"shape({node},")]
            # With any confidence: with that of the likeliest class, so that it takes its place.
            alike = [int(percent) for _, other, percent in found if (other in WIDER_SHAPES) == (shape in WIDER_SHAPES)]
            sure = max(alike, default=100)
            if call.facts:
                yield call, f"shape({node},{shape},{_number_or(arguments[2], sure)})", number
        elif name == "bound" and len(arguments) == 2:
            yield from self._calls("reconciliation", f"bind({arguments[0]},{arguments[1]})", step)
        elif name == "corner":
            yield from self._corner(arguments, step)
        elif name == "plan" and len(arguments) == 2:
            chosen = planned_choice(self._facts.record, arguments[0], arguments[1], step)
            yield from ((call, atom, made) for call, atom, made in chosen if _is_offered(arguments[1], call))

    def _calls(self, encoding: str, atom: str, step: int) -> Iterator[tuple[SolverCall, str, int]]:
        """Yield the answers of an encoding at a step, the newest first."""
        yield from ((call, atom, step) for _, call in self._facts.record.answers(step, encoding, step))

    def _newest(self, encoding: str, step: int, needs: str) -> tuple[SolverCall, int]:
        """Return the newest answer of an encoding up to a step whose facts have one that begins with `needs`."""
        oldest = self._facts.record.steps[step].first_impression
        for number, call in self._facts.record.answers(step, encoding, oldest):
            if any(fact.startswith(needs) for fact in call.facts):
                return call, number
        return SolverCall(encoding, (), (), ()), step

    def _opening(self, step: int) -> Iterator[tuple[SolverCall, str, int]]:
        """Yield the answer of rooms.lp with the neck that comes nearest to being a door and is none."""
        for _, call in self._facts.record.answers(step, "rooms", step):
            for atom in call.answer or ():
                name, arguments = atom_parts(atom)
                if name == "opening":
                    neck = next(fact for fact in call.facts if fact.startswith(f"neck({arguments[0]},"))
                    yield call, f"door({arguments[0]},{atom_parts(neck)[1][4]})", step

    def _corner(self, arguments: Sequence[str], step: int) -> Iterator[tuple[SolverCall, str, int]]:
        """Yield the answer of corners.lp, if there is a convex corner at the place that is not the furthest."""
        for _, call in self._facts.record.answers(step, "corners", step):
            for fact in call.facts:
                number, *place = atom_parts(fact)[1]
                if place == list(arguments[1:3]):
                    yield call, f"furthest({arguments[0]},{number})", step

    def _absence(self, fact: str, step: int, call: SolverCall, atom: str, made: int) -> Reason:
        """Return why an answer, made at a step, does not hold an atom, with the reasons of what is in the way."""
        found = explain_absence(call.encoding, call.facts, call.answer, atom, self._rule_files)
        in_way = tuple(
            input_reason(self._facts.record, Given(given, call, made), self._facts.reason) for given in found.in_way
        )
        region = self._facts.record.steps[step].regions.get((atom_parts(fact)[1] or ("",))[0], "")
        said = f"{region} is its region of the map; {found.sentence}" if region and region in atom else found.sentence
        return self._reason_of(fact, replace(found, sentence=said), in_way, step)

    def _reason_of(self, fact: str, found: Absence, in_way: tuple[Reason, ...], step: int) -> Reason:
        """Return an absence as a reason. in_way : the reasons of what is in the way."""
        several, without = len(found.missing) > 1, ", and without what is in the way," if found.in_way else ""
        so = f"with {'all that is missing' if several else 'it'}{without} {found.atom} would hold"
        needed = tuple(Reason(f"missing: {given}", so, ReasonKind.REJECTED) for given in found.missing)
        rival = (Reason(found.rival.atom, found.rival.sentence, ReasonKind.REJECTED),) if found.rival else ()
        data = {
            "encoding": found.encoding,
            "atom": found.atom,
            "missing": list(found.missing),
            "in_way": list(found.in_way),
            "partial": found.partial,
            "found": found.found,
        }
        below = (*rival, *needed, *in_way, *self._alternatives(fact, step))
        return Reason(f"not {fact}", found.sentence, ReasonKind.NEGATION, f"step {step}", below, data)

    def _instead(self, fact: str, step: int) -> Reason:
        """Return why a fact is not believed that no encoding derives: it is measured, and something else was."""
        instead = tuple(self._alternatives(fact, step))
        name, arguments = atom_parts(fact)
        thing = (arguments or ("",))[0]
        if name in TASK_PLAN_NAMES:
            planned = any(atom_parts(one)[0] in TASK_PLAN_NAMES for one in self._facts.record.steps[step].facts)
            unheard = (
                "no such step was offered when the plan was made"
                if name == "plan"
                else "the task plan does not state it"
            )
            because = unheard if planned else "there is no task plan at this step"
            because += "; it states this" if instead else ""
        elif name == "held" and (last := self._last_held(fact, step)) is not None:
            because = f"it was in hand up to step {last} and is no longer" + ("; this is, instead" if instead else "")
        elif name == "held" and instead:
            because = "it was never in hand up to this step; this is in hand instead"
        elif name == "shape" and not instead and f"node({thing})" in self._facts.record.steps[step].fact_set:
            because = f"no class of shapes was fitted to what is known of {thing}"
        elif name == "movable" and instead:
            because = "it would have to be moved, or seen not to move, for that; this is believed instead"
        elif name == "may_be" and instead:
            because = f"{thing} means nothing that was seen, and its places are counted otherwise: these are believed"
        elif name == "may_be":
            facts = self._facts.record.steps[step].facts
            instead = tuple(
                reason
                for fact in facts
                if fact.startswith(f"bound({thing},") and (reason := self._facts.reason(fact, step)) is not None
            )
            because = f"{thing} means something, which is there" if instead else f"the task names no object {thing}"
        elif name == "loc":
            at = tuple(fact for fact in self._facts.record.steps[step].long_facts if fact.startswith("loc("))
            instead = tuple(reason for fact in at if (reason := self._facts.reason(fact, step)) is not None)
            because = (
                "nothing speaks for that square: these are believed"
                if instead
                else "the robot is lost, or began a map anew that lies anywhere"
            )
        elif name == "hidden" and not instead:
            because = f"{thing} is no part of the floor that no seen floor joins with that of the robot"
        elif name in ("plug", "stretch") and not instead:
            because = f"no stretch {thing} was measured: no wall there was left unfelt with floor on both sides"
        elif name == "joined" and not instead:
            because = "no border that they have in common was measured, or they were felt in different colours"
        elif name in ("door", "connects") and instead:
            because = "this is believed of it instead"
        elif instead:
            how = "felt" if name == "colour" else "measured"
            because = f"it would have to be {how} so; this is believed instead"
        elif f"node({thing})" in self._facts.record.steps[step].fact_set:
            because = f"{thing} is believed to be there, but nothing that was seen, felt or done says this of it"
        else:
            because = f"nothing is believed to be {thing} at this step"
        data = {"missing": [fact], "in_way": [reason.claim for reason in instead], "partial": False, "found": True}
        return Reason(f"not {fact}", because, ReasonKind.NEGATION, f"step {step}", instead, data)

    def _last_held(self, fact: str, step: int) -> int | None:
        """Return the last step before another one at which a thing was in hand; None when it never was."""
        return next((n for n in range(step - 1, -1, -1) if fact in self._facts.record.steps[n].fact_set), None)

    def _alternatives(self, fact: str, step: int) -> Iterator[Reason]:
        """Yield the reasons of believed facts of the same predicate about the same thing."""
        name, arguments = atom_parts(fact)
        start = f"{name}({arguments[0]}," if len(arguments) > 1 else f"{name}("
        facts = [other for other in self._facts.record.steps[step].long_facts if other.startswith(start)]
        for other in facts[:INSTEAD_SHOWN]:
            reason = self._facts.reason(other, step)
            if reason is not None:
                yield reason


def _is_offered(planned: str, call: SolverCall) -> bool:
    """Return whether the place of a step of the plan was offered; True for steps that bring nothing to a place."""
    action, arguments = atom_parts(planned)
    subject = arguments[0] if len(arguments) > 1 else ROBOT
    return action not in ("carry", "clear", "arrive") or f"place({subject},{arguments[-1]})" in call.facts


def _number_or(text: str, default: int) -> int:
    """Return the number that a text denotes; the default for a variable."""
    return int(text) if text.removeprefix("-").isdigit() else default


def _error(text: str, what: str) -> BadInputError:
    """Return the error `what` about a question."""
    return BadInputError.about("whynot", text, what)
