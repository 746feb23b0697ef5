"""Reconciliation of the task with the world model: the object that each parameter means (kb/asp/reconciliation.lp)."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from kb.language.terms import Symbol
from kb.objects.proportions import possible_rectangle_shapes
from kb.reasoning.encodings import KB_ENCODINGS
from kb.reasoning.solver import solve
from kb.reasoning.user_rules import rules_reach
from kb.task.task import Task
from kb.world.model import Node, WorldModel

NO_MEANINGS: Mapping[str, str] = MappingProxyType({})


class Reconciliation(NamedTuple):
    """The objects of the world model that the task's parameters mean.

    Parameters and nodes are given by their names.

    Attributes
    ----------
    binding : parameter -> node, of each bound parameter.
    hypothesised : parameters of goals that match nothing seen so far.
    doubtful : (parameter, node) pairs that need another observation to decide.
    contradicted : (parameter, node, property) where the best match contradicts a claim; property is shape or colour.
    unmovable : (parameter, node) pairs that match, but the task moves the parameter and the node cannot be moved.
    measurable : (parameter, node) pairs that may match, which a better estimate of the node's size decides.
    as_well : (parameter, node) pairs where the node matches as well as the one that the parameter is bound to, the
        parameter is carried, and neither node was moved: a plan may mean either. () where users' rules take part, which
        then decide alone.
    """

    binding: Mapping[str, str]
    hypothesised: tuple[str, ...]
    doubtful: tuple[tuple[str, str], ...]
    contradicted: tuple[tuple[str, str, str], ...]
    unmovable: tuple[tuple[str, str], ...] = ()
    measurable: tuple[tuple[str, str], ...] = ()
    as_well: tuple[tuple[str, str], ...] = ()


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
    refused: Iterable[tuple[str, str]] = (),
    world: Iterable[str] = (),
) -> Reconciliation:
    """Return the best match of the task's object parameters with objects of the world model.

    Parameters
    ----------
    task : the task, with its parameters, the claims about them and the goals.
    model : the world model, whose objects may be meant.
    distances : the length of the way to each node, in squares, by its name; nodes without a known way may be missing.
    before : parameter -> node, the binding up to now; it is kept unless another one is clearly better.
    rules : files with users' rules, solved together with kb/asp/reconciliation.lp.
    carried : the names of the parameters that the goals move.
    planned : parameter -> node, as the task plan under way means them; kept while no other node matches better.
    kept : the names of the parameters that may mean nothing but what they are bound to, in every plan.
    given_up : (parameter, node) pairs where what is asked cannot be done with the node as far as is known; others that
        match equally well are preferred.
    refused : (parameter, node) pairs that users' rules leave to no task plan; never bound.
    world : facts of the world model that users' rules name, without full stops.

    Returns
    -------
    The binding, parameter -> node, and what is open about it, all by name: parameters of goals that match nothing seen
    so far, and pairs (parameter, node) that need another observation, contradict a claim, cannot be moved, or that a
    better estimate of the node's size decides, or that match
    as well as what is bound. All are empty when the encodings have no answer.

    Raises
    ------
    BadInputError : users' rules cause an error.
    """
    facts = [*_task_facts(task), *(f"carried({x})" for x in carried)]
    facts += [fact for node in model.objects for fact in _node_facts(node)]
    facts += [f"distance({name},{round(way)})" for name, way in sorted(distances.items())]
    facts += [f"bound_before({x},{node})" for x, node in sorted(before.items())]
    facts += [f"planned({x},{node})" for x, node in sorted(planned.items())]
    facts += [f"kept({x})" for x in sorted(kept)]
    facts += [f"given_up({x},{node})" for x, node in sorted(given_up)]
    facts += [*(f"refused({x},{node})" for x, node in sorted(refused)), *world]
    found: dict[str, list[tuple[str, ...]]] = {}
    for atom in solve([KB_ENCODINGS / "reconciliation.lp", *rules], facts) or ():
        found.setdefault(atom.name, []).append(tuple(str(a) for a in atom.arguments))
    return Reconciliation(
        {atom[0]: atom[1] for atom in found.get("bind", ())},
        tuple(x for (x,) in found.get("hypothesised", ())),
        tuple((x, node) for x, node in found.get("doubtful", ())),
        tuple((x, node, p) for x, node, p in found.get("contradicted", ())),
        tuple((x, node) for x, node in found.get("unmovable", ())),
        tuple((x, node) for x, node in found.get("measurable", ())),
        () if rules_reach("reconciliation", rules) else tuple((x, node) for x, node in found.get("as_well", ())),
    )


def as_well_by_parameter(reconciled: Reconciliation) -> Mapping[str, tuple[str, ...]]:
    """Return, by parameter, the nodes that match it as well as the one that it is bound to."""
    found: dict[str, tuple[str, ...]] = {}
    for parameter, node in reconciled.as_well:
        found[parameter] = (*found.get(parameter, ()), node)
    return found


def _task_facts(task: Task) -> Iterable[str]:
    """Yield the object parameters and their claims as facts for kb/asp/reconciliation.lp, without full stops.

    These are `wanted(Parameter)`, `named(Parameter)` where a goal mentions it, and
    `claim(Parameter,shape|colour,Value,Percent)`.
    """
    for name, parameter in task.parameters.items():
        if parameter.kind == "object":
            yield f"wanted({name})"
            if name in task.goal_parameters:
                yield f"named({name})"
    for claim in task.claims:
        x, value = claim.fact.args
        assert isinstance(x, Symbol)
        yield f"claim({x},{claim.fact.name},{value},{claim.confidence})"


def _node_facts(node: Node) -> Iterable[str]:
    """Yield what is believed about an object as facts for kb/asp/reconciliation.lp, without full stops.

    Percents are confidences: that it is an object, or that it has the value. These are `candidate(Node,Percent)` and
    `has(Node,shape|colour,Value,Percent)`; `settled(Node,shape|colour)` where no impression can change it;
    `fixed(Node)` and `moved(Node)`; and `may_be(Node,shape,square|brick)`, what a rectangle may be as far as its size
    is known.
    """
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
        yield f"may_be({node.name},shape,{shape})"
