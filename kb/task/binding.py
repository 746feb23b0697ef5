"""Reconciliation of the task with the world model: the object that each parameter means (kb/asp/reconciliation.lp)."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from utak.kb.objects.proportions import possible_rectangle_shapes
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.rulebook import RuleAtom
from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import read_rules, rules_reach, rules_to_blame
from utak.kb.task.described import claim_facts
from utak.kb.task.task import APPEARANCES, Task
from utak.kb.world.model import Node, WorldModel

RECONCILIATION = KB_ENCODINGS / "reconciliation.lp"
NO_MEANINGS: Mapping[str, str] = MappingProxyType({})


class Reconciliation(NamedTuple):
    """The things, doors and rooms of the world model that the task's parameters mean."""

    binding: Mapping[str, str]  # parameter -> node, door or room, of each bound parameter
    hypothesised: tuple[str, ...]  # parameters of goals that match nothing seen so far
    doubtful: tuple[tuple[str, str], ...]  # (parameter, node) pairs that need another observation to decide
    # (parameter, node, property) where the best match contradicts a claim; property: see `claim`
    contradicted: tuple[tuple[str, str, str], ...]
    # (parameter, node, property) where the parameter means nothing, and the node is as claimed in all but the property
    near_misses: tuple[tuple[str, str, str], ...] = ()
    # (parameter, node) pairs that match, but the task moves the parameter and the node cannot be moved
    unmovable: tuple[tuple[str, str], ...] = ()
    # (parameter, node) pairs that may match, which a better estimate of the node's size decides
    measurable: tuple[tuple[str, str], ...] = ()
    # (parameter, node) pairs where the node matches as well as the one that the parameter is bound to, the parameter is
    # carried, and neither node was moved: a plan may mean either. () where users' rules take part, which then decide
    # alone.
    as_well: tuple[tuple[str, str], ...] = ()
    facts: tuple[str, ...] = ()  # what the encoding was given


def reconcile(
    task: Task,
    model: WorldModel,
    distances: Mapping[str, float],
    before: Mapping[str, str],
    rules: tuple[Path, ...] = (),
    carried: Iterable[str] = (),
    planned: Mapping[str, str] = NO_MEANINGS,
    kept: Iterable[str] = (),
    given_up: Iterable[tuple[str, str]] = (),
    refused: Iterable[Iterable[tuple[str, str]]] = (),
    world: Iterable[str] = (),
    places: Iterable[str] = (),
) -> Reconciliation:
    """Return the best match of the task's parameters with the world model; `places`: see kb.task.described."""
    facts = [*_task_facts(task), *(f"carried({x})" for x in carried), *places]
    facts += [fact for node in model.objects for fact in _node_facts(node)]
    facts += [f"distance({name},{round(way)})" for name, way in sorted(distances.items())]
    facts += [f"bound_before({x},{node})" for x, node in sorted(before.items())]
    facts += [f"planned({x},{node})" for x, node in sorted(planned.items())]
    facts += [f"kept({x})" for x in sorted(kept)]
    facts += [f"given_up({x},{node})" for x, node in sorted(given_up)]
    facts += [f"refused({n},{x},{node})" for n, pairs in enumerate(refused, 1) for x, node in sorted(pairs)]
    facts += world
    reached = rules_reach(RECONCILIATION.stem, rules)
    if reached:  # what they state of a node counts in place of what was seen of it
        facts += [f"seen{fact[len('has') :]}" for fact in facts if fact.startswith("has(")]
    found: dict[str, list[tuple[str, ...]]] = {}
    for atom in solve([RECONCILIATION, *rules], facts) or ():
        found.setdefault(atom.name, []).append(tuple(str(a) for a in atom.arguments))
    return Reconciliation(
        {atom[0]: atom[1] for atom in found.get("bind", ())},
        tuple(x for (x,) in found.get("hypothesised", ())),
        tuple((x, node) for x, node in found.get("doubtful", ())),
        tuple((x, node, p) for x, node, p in found.get("contradicted", ())),
        tuple((x, node, p) for x, node, p in found.get("near_miss", ())),
        tuple((x, node) for x, node in found.get("unmovable", ())),
        tuple((x, node) for x, node in found.get("measurable", ())),
        () if reached else tuple((x, node) for x, node in found.get("as_well", ())),
        tuple(facts),
    )


def rules_that_deny(parameter: str, reconciled: Reconciliation, rules: tuple[Path, ...]) -> str:
    """Return the places of the users' rules without which a parameter would mean something; "" for none."""
    return " and ".join(rules_to_blame(RECONCILIATION, rules, reconciled.facts, partial(_is_unbound, parameter)))


def rules_on_what_fits(parameter: str, task: Task, rules: tuple[Path, ...]) -> str:
    """Return the places of the users' rules that state kinds, or what is claimed of a parameter; "" for none."""
    facts = [claim.fact for claim in task.claims if claim.fact.name in APPEARANCES]
    values = [str(fact.args[1]) for fact in facts if str(fact.args[0]) == parameter]

    def decides(atom: RuleAtom) -> bool:
        """Return whether a stated atom may decide what fits."""
        value = {("shape", 3): 1, ("has", 4): 2}.get(atom.signature)
        return atom.signature == ("kind", 3) or (value is not None and atom.constants[value] in (None, *values))

    stating = read_rules(rules).statements if rules else ()
    places = [one.line for one in stating if one.declares is None and any(map(decides, one.heads))]
    return " and ".join(dict.fromkeys(places))


def _is_unbound(parameter: str, atoms: Sequence[Any]) -> bool:
    """Return whether an answer binds a parameter to nothing."""
    return not any(atom.name == "bind" and str(atom.arguments[0]) == parameter for atom in atoms)


def as_well_by_parameter(reconciled: Reconciliation) -> Mapping[str, tuple[str, ...]]:
    """Return, by parameter, the nodes that match it as well as the one that it is bound to."""
    found: dict[str, tuple[str, ...]] = {}
    for parameter, node in reconciled.as_well:
        found[parameter] = (*found.get(parameter, ()), node)
    return found


def _task_facts(task: Task) -> Iterable[str]:
    """Yield the object parameters and their claims as facts for kb/asp/reconciliation.lp, without full stops."""
    for name, parameter in task.parameters.items():
        if parameter.kind == "object":
            yield f"wanted({name})"
        if name in task.goal_parameters and (parameter.kind == "object" or name in task.described):
            yield f"named({name})"
    yield from claim_facts(task)


def _node_facts(node: Node) -> Iterable[str]:
    """Yield what is believed about an object as facts for kb/asp/reconciliation.lp, without full stops."""
    yield f"candidate({node.name},{node.confidence})"
    for shape, confidence in sorted(node.shape.items()):
        yield f"has({node.name},shape,{shape},{confidence})"
    if node.colour is not None:
        yield f"has({node.name},colour,{node.colour},99)"
        yield f"settled({node.name},colour)"
    if node.open == 0:
        yield f"settled({node.name},shape)"
    if node.movable == 0:
        yield f"fixed({node.name})"
    if node.moved:
        yield f"moved({node.name})"
    for shape in possible_rectangle_shapes(node.polygon, node.insets):
        yield f"may_have({node.name},shape,{shape})"
