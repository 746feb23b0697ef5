"""Encodings as explanations need them: their rules with sentences, users' rules that reach them, and who is asked.

Programs without users' rules are asked in this process, others in the separate process of kb.reasoning.worker.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from utak.kb.explanation.values import RuleInstance, RuleText
from utak.kb.language.reader import facts_from_text
from utak.kb.language.source_text import Source, read_source, source_from_bytes
from utak.kb.language.vocabulary import BELIEF_PREDICATES
from utak.kb.reasoning.encodings import all_encodings, encoding_files, encoding_path
from utak.kb.reasoning.rulebook import Statement
from utak.kb.reasoning.sentences import PredicateWords, RuleWords, fill, read_sentences
from utak.kb.reasoning.user_rules import MAX_RULE_SECONDS, read_rules, rules_worker, words_of_rules
from utak.kb.tracing.requests import respond
from utak.kb.tracing.syntax import JsonValues, ProgramPart

HELPING_PREFIX = "trace__"  # begins the names of the atoms that helping rules derive
BELIEF = "belief"  # the encoding that declares the believed facts, over which the rules of queries reason
OBJECT_RULE = "object(N) :- kind(N, object, C)."  # the meaning of object(N) in queries
SHORT_FORMS = "".join(f" #defined {name}/{arity}." for (name, arity), one in BELIEF_PREDICATES.items() if one.long)
QUERY_PARTS = (ProgramPart("queries", 1, f"{OBJECT_RULE}{SHORT_FORMS}"),)


# Requests that may take any time without users' rules, too: where facts may change, clingo grounds a sum for each set
# of them, and nothing stops it. They go to a process that can be killed.
UNBOUNDED_TASKS = ("change",)
MAX_OWN_SECONDS = 60.0  # for one of these about our own rules alone, which takes seconds on a machine that is not busy


class ExplanationError(Exception):
    """Says that nothing can be explained: there is no such encoding, or the decision is not one of its answers."""


class RuleUnit(NamedTuple):
    """A rule with one alternative of each of its pools."""

    rule: RuleText  # the rule
    variables: tuple[str, ...]  # the names that the rule gives to its global variables
    names: tuple[str, ...]  # the same with those of hidden variables; instances have a value for each
    literals: tuple[JsonValues, ...]  # what is known of each literal of its body (kb.tracing.instrument.literal_info).
    conditions: tuple[tuple[JsonValues, ...], ...]  # the same of the conditions of each atom of its head


class DecisionProgram:
    """An encoding, with the users' rules that reach it."""

    def __init__(self, encoding: str, rule_files: Sequence[str] = (), seconds: float | None = None) -> None:
        self.encoding, self._seconds = encoding, seconds
        path = _path_of(encoding)
        self._users: tuple[Statement, ...] = ()
        if rule_files:
            book = read_rules(rule_files)
            self._users = book.query_rules if encoding == BELIEF else book.rules_reaching(encoding)
        _refuse_helping_names([atom.name for one in self._users for atom in (*one.heads, *one.body)])
        own = _parts_of(path)
        written = [ProgramPart(one.source.file, one.at[0], one.written) for one in self._users]
        self.parts: tuple[ProgramPart, ...] = (*written, *own, *(QUERY_PARTS if encoding == BELIEF else ()))
        found = self.ask({"task": "statements"})
        rules, words = _rules_with_words(found["statements"], self._users, own)
        self.words = with_short_forms(words) if encoding == BELIEF else words
        self.units = tuple(_unit(one, rules, found["statements"]) for one in found["units"])
        self.shown = frozenset((name, arity) for name, arity in found["shown"])
        self.declared = frozenset((name, arity) for name, arity in found["declared"])

    def ask(self, request: JsonValues) -> JsonValues:
        """Return the response of kb.tracing to a request about this program; ExplanationError when it fails."""
        whole = {**request, "parts": [list(part) for part in self.parts]}
        if self._users or request["task"] in UNBOUNDED_TASKS:
            seconds = self._seconds or (MAX_RULE_SECONDS if self._users else MAX_OWN_SECONDS)
            found = rules_worker().exchange({"trace": whole}, seconds)
            if "limit" in found:
                raise ExplanationError(f"the explanation was given up: {found['limit']}")
            if "error" in found:
                raise ExplanationError(f"the explanation failed: {found['error']}")
        else:
            found = respond(whole)
        if "failed" in found:
            raise ExplanationError(found["failed"])
        return found

    def instance(self, unit: RuleUnit, values: Sequence[str]) -> RuleInstance:
        """Return a rule with values for its named variables."""
        names = unit.variables if len(values) == len(unit.variables) else unit.names
        given = dict(zip(names, values, strict=True))
        shown = tuple((name, given[name]) for name in unit.variables)
        return RuleInstance(unit.rule, shown, fill(unit.rule.sentence, given) or unit.rule.text)


def decision_program(encoding: str, rule_files: tuple[str, ...] = ()) -> DecisionProgram:
    """Return an encoding with the users' rules that reach it; the same object while no file changes."""
    return _kept_program(encoding, rule_files, texts_of(rule_files))


@lru_cache(maxsize=64)
def _kept_program(encoding: str, rule_files: tuple[str, ...], _texts: tuple[str, ...]) -> DecisionProgram:
    """Return an encoding with users' rules; the last ones are kept, as long as the texts of the files stay the same."""
    return DecisionProgram(encoding, rule_files)


def texts_of(rule_files: Sequence[str]) -> tuple[str, ...]:
    """Return the texts of files; CannotOpenError or BadInputError when one cannot be read or is no text of ours."""
    return tuple(read_source(path).text for path in rule_files)


def canonical(atoms: Sequence[str]) -> tuple[str, ...]:
    """Return atoms as clingo writes them, without full stops, in their order."""
    # Raises BadInputError for a text that is no fact: text of an episode never reaches clingo unread. Raises
    # ExplanationError for a name that explanations use themselves.
    text = "\n".join(atom if atom.rstrip().endswith(".") else f"{atom}." for atom in atoms)
    found = tuple(str(fact) for fact in facts_from_text(text))
    _refuse_helping_names(found)
    return found


def _refuse_helping_names(names: Sequence[str]) -> None:
    """Raise ExplanationError when an atom or a name begins like those of helping rules (kb.tracing.instrument)."""
    for name in names:
        if name.startswith(HELPING_PREFIX):
            raise ExplanationError(f"names that begin with {HELPING_PREFIX} belong to explanations: {name}")


def encoding_names() -> tuple[str, ...]:
    """Return the names of all encodings, sorted."""
    return tuple(path.stem for path in all_encodings())


def _path_of(encoding: str) -> Path:
    """Return the path of an encoding, a file or a folder; ExplanationError when there is none of that name."""
    try:
        return encoding_path(encoding)
    except FileNotFoundError as error:
        raise ExplanationError(f"{error}; there are {', '.join(encoding_names())}") from None


def _parts_of(encoding: Path) -> list[ProgramPart]:
    """Return the files of an encoding as parts of a program, each named from the folder of our packages on."""
    root = encoding.parents[2]
    return [
        ProgramPart(path.relative_to(root).as_posix(), 1, path.read_text(encoding="utf-8"))
        for path in encoding_files(encoding)
    ]


def _rules_with_words(
    statements: Sequence[JsonValues], users: Sequence[Statement], own: Sequence[ProgramPart]
) -> tuple[list[RuleText], Mapping[tuple[str, int], PredicateWords]]:
    """Return the rules of a program with their sentences, and how predicates read."""
    ours = statements[len(users) :]  # and, for queries, QUERY_PARTS
    found: dict[str, RuleWords] = {}
    for part in own:
        source = source_from_bytes(part.file, part.text.encode("utf-8"))
        places = [((one["line"], one["column"]), one["variables"]) for one in ours if one["file"] == part.file]
        found[part.file], problems = read_sentences(source, places)
        if problems:
            raise ExplanationError(str(problems[0]))
    sentences, words = words_of_users(users)
    rules = [
        RuleText(one.source.file, *one.at, " ".join(one.written.split()), entry["kind"], sentence)
        for one, entry, sentence in zip(users, statements, sentences, strict=False)
    ]
    for entry in ours:
        at = (entry["line"], entry["column"])
        sentence = found[entry["file"]].sentences.get(at, "") if entry["file"] in found else ""
        rules.append(RuleText(entry["file"], *at, entry["text"], entry["kind"], sentence))
    for one in found.values():
        words |= one.predicates
    return rules, words


def with_short_forms(
    words: Mapping[tuple[str, int], PredicateWords],
) -> Mapping[tuple[str, int], PredicateWords]:
    """Return how predicates of the world model read, with their short forms: as the long ones, without the percent."""
    known = dict(words)
    for signature, declared in BELIEF_PREDICATES.items():
        long = words.get(declared.long) if declared.long is not None else None
        if long is not None:
            holds = long.holds.replace(f" with {{{long.variables[-1]}}} percent", "")
            absent = f"it is not known that {holds}"
            known.setdefault(signature, PredicateWords(long.name, long.variables[:-1], holds, absent))
    return known


def words_of_users(users: Sequence[Statement]) -> tuple[list[str], dict[tuple[str, int], PredicateWords]]:
    """Return the sentence of each of some users' rules, '' for none, and how predicates read in their files."""
    words: dict[tuple[str, int], PredicateWords] = {}
    sentences: dict[tuple[Source, tuple[int, int]], str] = {}
    for source in dict.fromkeys(one.source for one in users):
        found, _ = words_of_rules(source, [one for one in users if one.source == source])
        words = {**found.predicates, **words}
        sentences |= {(source, at): text for at, text in found.sentences.items()}
    return [sentences.get((one.source, one.at), "") for one in users], words


def _unit(entry: JsonValues, rules: Sequence[RuleText], statements: Sequence[JsonValues]) -> RuleUnit:
    """Return a unit from the response of kb.tracing."""
    return RuleUnit(
        rules[entry["statement"]],
        tuple(statements[entry["statement"]]["variables"]),
        tuple(entry["names"]),
        tuple(entry["literals"]),
        tuple(map(tuple, entry["conditions"])),
    )
