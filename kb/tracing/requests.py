"""Requests about the answers of logic programs and the responses to them, both as JSON values."""

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any

import clingo

from utak.kb.tracing.alternatives import weigh
from utak.kb.tracing.answers import GroundedProgram, TraceError, instances
from utak.kb.tracing.candidates import CandidateFacts, candidate_facts
from utak.kb.tracing.changes import least_change
from utak.kb.tracing.instrument import condition_infos, is_choice, literal_info
from utak.kb.tracing.syntax import JsonValues, ParsedProgram, ProgramPart, parsed


def respond(request: JsonValues) -> JsonValues:
    """Return the response to a request."""
    parts = tuple(ProgramPart(file, line, text) for file, line, text in request["parts"])
    try:
        if request["task"] == "statements":
            return _statements(parts)
        grounded = _grounded(parts, tuple(request["facts"]))
        if request["task"] == "trace":
            return _trace(grounded, request["answer"])
        if request["task"] == "answer":
            found = grounded.best_answer([(clingo.parse_term(request["atom"]), True)])
            return {"atoms": None if found is None else sorted(found.atoms)}
        if request["task"] == "candidates":
            return _candidates(grounded, request["atom"], request["known"])
        if request["task"] == "change":
            return _change(grounded, request["atom"], request["candidates"])
        return weigh(grounded, request["answer"], request["heads"], request["none"])
    except TraceError as error:
        return {"failed": str(error)}


def _candidates(grounded: GroundedProgram, atom: str, known: Sequence[str]) -> JsonValues:
    """Return the facts that might be given besides for an atom to hold, as JSON values."""
    facts, atoms = ([clingo.parse_term(text) for text in texts] for texts in (grounded.facts, known))
    return candidate_facts(grounded.program, facts, atoms, clingo.parse_term(atom))._asdict()


def _change(grounded: GroundedProgram, atom: str, candidates: JsonValues) -> JsonValues:
    """Return the least change with which an atom holds, as JSON values."""
    given = CandidateFacts(**candidates)
    return least_change(grounded.program, grounded.facts, given, clingo.parse_term(atom))._asdict()


@lru_cache(maxsize=8)
def _grounded(parts: tuple[ProgramPart, ...], facts: tuple[str, ...]) -> GroundedProgram:
    """Return a program grounded with its facts; the last few are kept."""
    return GroundedProgram(parts, facts)


def _statements(parts: tuple[ProgramPart, ...]) -> JsonValues:
    """Return what a program consists of."""
    try:
        program = parsed(parts)
    except RuntimeError as error:
        raise TraceError(f"the program cannot be read: {error}") from None
    return {
        "statements": [
            {key: value for key, value in one._asdict().items() if key != "node"} for one in program.statements
        ],
        "units": unit_infos(program),
        "shown": sorted(map(list, program.shown)),
        "declared": sorted(map(list, program.defined)),
    }


def unit_infos(program: ParsedProgram) -> list[JsonValues]:
    """Return what an explanation needs to know of the units of a program, as JSON values."""
    return [
        {
            "statement": unit.statement,
            "names": list(unit.names),
            "literals": [literal_info(one) for one in unit.node.body],
            "conditions": [] if program.statements[unit.statement].kind == "weak" else condition_infos(unit.node),
            "choice": is_choice(unit),
        }
        for unit in program.units
    ]


def _trace(grounded: GroundedProgram, answer: Sequence[str]) -> JsonValues:
    """Return the atoms of an answer set and all instances of rules that hold in it."""
    atoms = grounded.whole_answer(answer)
    return {"atoms": sorted(map(str, atoms)), **instance_infos(instances(grounded.parts, atoms))}


def instance_infos(symbols: Iterable[clingo.Symbol]) -> JsonValues:
    """Return the helping atoms of kb.tracing.instrument as JSON values."""
    found: dict[str, list[Any]] = {"trace__on": [], "trace__head": [], "trace__element": []}
    for symbol in sorted(symbols):
        unit, *rest = symbol.arguments
        entry: list[Any]
        if symbol.name == "trace__on":
            entry = [_texts(rest[0]), _literals(rest[1])]
        elif symbol.name == "trace__head":
            entry = [rest[0].number, _texts(rest[1]), str(rest[2]), _literals(rest[3])]
        else:
            entry = [rest[0].number, rest[1].number, _texts(rest[2]), _literals(rest[3]), _literals(rest[4])]
        found[symbol.name].append([unit.number, *entry])
    return {"on": found["trace__on"], "heads": found["trace__head"], "elements": found["trace__element"]}


def _texts(values: clingo.Symbol) -> list[str]:
    """Return the members of a tuple as texts."""
    return list(map(str, values.arguments))


def _literals(values: clingo.Symbol) -> list[Any]:
    """Return literals as JSON values: an atom as text, the tuple of a comparison or an aggregate as a list of texts."""
    pairs = ((one, one.type == clingo.SymbolType.Function and not one.name) for one in values.arguments)
    return [_texts(one) if is_tuple else str(one) for one, is_tuple in pairs]
