"""The decisions of an episode as programs that plain clingo reads: encoding, rules and facts of each in one file.

A file is named by step, encoding and number, such as 0007-shapes-2.lp: the third decision of step 7 (they count from
0). Its best answer set, by `python -m clingo FILE`, is what the robot decided. `index.jsonl` has a line for each
decision, also for those that were made before and have no file of their own.

Nothing is left out of an encoding; negated atoms with an anonymous variable are written otherwise, for viasp.
"""

import json
import re
from collections.abc import Sequence
from pathlib import Path

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import source_from_bytes
from utak.kb.reasoning.encodings import encoding_path, encoding_text
from utak.kb.reasoning.user_rules import read_rules
from utak.simulator.episode.episode import Episode, EpisodeLine
from utak.simulator.episode.record import rules_sum
from utak.simulator.scenario.folder_writer import check_folder, whole_folder

INDEX_NAME = "index.jsonl"
# A comment, a text in quotes, or a negated atom with its name and arguments.
NEGATED_ATOM = re.compile(r'%\*(?s:.*?)\*%|%[^\n]*|"(?:[^"\\]|\\.)*"|\bnot\s+([a-z]\w*)\(([^()]*)\)')
RULES_HEAD = "% The user's rules that take part in this encoding (--kb)."


class ProgramDump:
    """Writes the decisions of the lines of one episode into a folder, in the order of the lines."""

    def __init__(self, folder: Path | str, name: str, kb_files: Sequence[str] = (), force: bool = False) -> None:
        self._folder, self._name = Path(folder), name
        self._sums = {rules_sum(path): path for path in kb_files}
        self._head: EpisodeLine = {}
        self._files: dict[tuple[int, int], EpisodeLine] = {}  # entries of the index by step and number
        check_folder(self._folder, force)

    def _begin(self) -> None:
        """Make the folder and an empty index in it."""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            (self._folder / INDEX_NAME).unlink(missing_ok=True)  # a link is replaced, not followed
            (self._folder / INDEX_NAME).touch()
        except (OSError, ValueError) as error:
            raise CannotOpenError(str(self._folder), getattr(error, "strerror", None) or str(error)) from None

    def add(self, line: EpisodeLine) -> None:
        """Write the decisions of a line."""
        if "step" not in line:
            if not self._head:
                self._head = line
                self._begin()
            return
        step = line["step"]
        for number, decision in enumerate(line["belief"].get("solved", ())):
            encoding = decision[0]
            if len(decision) == 2:
                entry = self._files.get((decision[1][0], decision[1][1]))
                if entry is None or entry["encoding"] != encoding:
                    raise self._damaged(step, f"decision {number} refers to one that is not there")
                entry = entry | {"step": step, "number": number}
            else:
                entry = self._new_file(step, number, encoding, decision[1], decision[2])
            self._files[step, number] = entry
            self._append(INDEX_NAME, json.dumps(entry) + "\n")

    def _new_file(
        self, step: int, number: int, encoding: str, facts: Sequence[str], answer: Sequence[str] | None
    ) -> EpisodeLine:
        """Write the program of one decision, and return its entry of the index."""
        try:
            path = encoding_path(encoding)
        except FileNotFoundError:
            raise self._damaged(step, f"decision {number} is of an encoding that utak does not have") from None
        self._check_facts(step, number, facts)
        given = self._rule_files(step)
        rules = read_rules(given).rules_reaching(encoding) if given else ()
        answered = "there is no answer" if answer is None else f"{len(answer)} atoms, see {INDEX_NAME}"
        parts = [f"% Decision {number} of step {step}: {path.name}. What the robot decided: {answered}."]
        program = [RULES_HEAD, *(one.written for one in rules)] if rules else []
        parts.append(without_anonymous_negation("\n".join([*program, encoding_text(path).rstrip()])))
        parts += ["% The facts of this decision.", *(f"{fact}." for fact in facts)]
        name = f"{step:04d}-{encoding}-{number}.lp"
        (self._folder / name).unlink(missing_ok=True)  # a link is replaced, not followed
        self._append(name, "\n".join([*parts, ""]))
        return {"file": name, "step": step, "number": number, "encoding": encoding, "answer": answer}

    def _check_facts(self, step: int, number: int, facts: Sequence[str]) -> None:
        """Raise BadInputError unless facts are facts: an episode of somebody else's must not bring rules or scripts."""
        for fact in facts:
            try:
                single = len(parse_facts(source_from_bytes(self._name, f"{fact}.".encode("utf-8", "replace")))) == 1
            except BadInputError:
                single = False
            if not single:
                raise self._damaged(step, f"decision {number} was given {fact[:40]!r}, which is no fact")

    def _rule_files(self, step: int) -> list[str]:
        """Return the files of rules that the run had at a step; raise BadInputError when one is missing."""
        stages = [entry for entry in self._head.get("forked", ()) if entry["until"] > step]
        sums: list[str] = (stages[0] if stages else self._head)["options"]["kb"]
        missing = [one for one in sums if one not in self._sums]
        if missing:
            what = f"the run had a file of rules that is not given, with the SHA-256 sum {missing[0][:80]}"
            raise BadInputError.at(self._name, what, "give it with --kb")
        return [self._sums[one] for one in sums]

    def _append(self, name: str, text: str) -> None:
        try:
            with (self._folder / name).open("a", encoding="utf-8", newline="\n") as stream:
                stream.write(text)
        except OSError as error:
            raise CannotOpenError(str(self._folder / name), error.strerror or str(error)) from None

    def _damaged(self, step: int, what: str) -> BadInputError:
        return BadInputError.at(self._name, f"{what}: the episode is damaged", line=step + 2)


def without_anonymous_negation(text: str) -> str:
    r"""Return a program in which `not p(X, _)` is `not some_p_1(X)`, with `some_p_1(X) :- p(X, _).` at its end.

    >>> without_anonymous_negation("q(X) :- r(X), not p(X, _).")
    'q(X) :- r(X), not some_p_1(X).\nsome_p_1(A1) :- p(A1, _).'
    """
    helpers: dict[str, str] = {}

    def rewritten(found: re.Match[str]) -> str:
        arguments = [part.strip() for part in (found[2] or "").split(",")]
        if "_" not in arguments:
            return found[0]
        kept = [number for number, argument in enumerate(arguments, 1) if argument != "_"]
        name = "_".join(["some", found[1], *map(str, kept)])
        variables = [f"A{number}" if number in kept else "_" for number in range(1, len(arguments) + 1)]
        head = _atom(name, [f"A{number}" for number in kept])
        helpers[name] = f"{head} :- {_atom(found[1], variables)}."
        return f"not {_atom(name, [arguments[number - 1] for number in kept])}"

    return "\n".join([NEGATED_ATOM.sub(rewritten, text), *helpers.values()])


def _atom(name: str, arguments: Sequence[str]) -> str:
    return f"{name}({', '.join(arguments)})" if arguments else name


def dump_episode(
    folder: Path | str, name: str, episode: Episode, last: int | None, kb_files: Sequence[str], force: bool = False
) -> None:
    """Write the decisions of a recorded episode into a folder."""
    with whole_folder(Path(folder), force) as part:
        dump = ProgramDump(part, name, kb_files)
        for line in (episode.header, *episode.steps):
            if last is None or line.get("step", 0) <= last:
                dump.add(line)
