"""docs/reference/vocabulary.md, made from the documentation blocks of the encodings and the declared fact files.

python docs/build_vocabulary.py            write it
python docs/build_vocabulary.py --check    exit 1 when it is stale, or when an interface is not documented
"""

import argparse
import re
import sys
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "reference" / "vocabulary.md"
FIRST = "belief"  # the world model comes before the encodings that build it
BLOCK = re.compile(r"%\*!\s*(.*?)\*%", re.DOTALL)
SIGNATURE = re.compile(r"([a-z_]\w*)(?:\(([^)]*)\))?")
HEAD = """\
# Vocabulary

Every predicate between the parts of Utak's mind. Made from the encodings by `python docs/build_vocabulary.py`; do not
edit. **in** marks what an encoding is given, **out** what it answers.
"""


class Entry(NamedTuple):
    """A documented predicate: as written, its name and arity, the text, the meaning of its arguments, and its role."""

    form: str
    signature: tuple[str, int]
    text: str
    arguments: tuple[str, ...]
    role: str


def encodings() -> list[Path]:
    """Return all encodings, files or folders, and the parts that they share; the world model's own vocabulary first."""
    sys.path.insert(0, str(ROOT))
    from utak.kb.reasoning.encodings import ENCODING_FOLDERS, SHARED_PARTS, all_encodings

    parts = [path for folder in ENCODING_FOLDERS for path in folder.iterdir() if path.stem in SHARED_PARTS]
    return sorted([*all_encodings(), *parts], key=lambda path: (path.stem != FIRST, path.parent.parent.name, path.stem))


def entries(text: str) -> list[Entry]:
    """Return the documented predicates of an encoding, in its order."""
    inputs, shown = _signatures(text, "#defined"), _signatures(text, "#show")
    found = []
    for block in BLOCK.findall(text):
        match = SIGNATURE.match(block)
        if match is None:
            raise ValueError(f"no predicate at the start of a documentation block: {block[:60]!r}")
        arity = len(match[2].split(",")) if match[2] else 0
        signature = match[1], arity
        body, _, arguments = textwrap.dedent(block[match.end() :]).partition("Args:")
        role = "in" if signature in inputs else "out" if signature in shown else ""
        found.append(Entry(match[0], signature, " ".join(body.split()), tuple(_items(arguments)), role))
    return found


def _signatures(text: str, word: str) -> set[tuple[str, int]]:
    return {(name, int(arity)) for name, arity in re.findall(rf"^{word}\s+(\w+)/(\d+)\.", text, re.MULTILINE)}


def _items(text: str) -> Iterator[str]:
    for item in re.split(r"^\s*-\s", text, flags=re.MULTILINE)[1:]:
        yield " ".join(item.split())


def title(text: str) -> str:
    """Return the comment at the top of an encoding."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("% "):
            break
        lines.append(line[2:])
    return " ".join(lines)


def undocumented(text: str) -> set[tuple[str, int]]:
    """Return inputs and answers of an encoding that have no documentation block."""
    return (_signatures(text, "#defined") | _signatures(text, "#show")) - {e.signature for e in entries(text)}


def section(path: Path) -> str:
    """Return one encoding's part of the page: a part for each file of a folder."""
    if path.is_dir():
        files = sorted(path.glob("*.lp"))
        lines = [f"## {path.relative_to(ROOT)}", "", f"One encoding in {len(files)} files.", ""]
        return "\n".join([*lines, *map(section, files)])
    text = path.read_text()
    mark = "###" if path.parent.name != "asp" else "##"
    lines = [f"{mark} {path.relative_to(ROOT)}", "", title(text), ""]
    for entry in entries(text):
        role = f" **{entry.role}**" if entry.role else ""
        lines.append(f"- `{entry.form}`{role} {entry.text}")
        lines += [f"  - {argument}" for argument in entry.arguments]
        if path.stem == FIRST and (short := short_entry(entry)):
            lines.append(f"- `{short}`{role} {short_text(entry)}")
    return "\n".join(lines) + "\n"


def short_entry(entry: Entry) -> str:
    """Return the short form of a predicate of the world model as it is written; "" where it has none."""
    sys.path.insert(0, str(ROOT))
    from utak.kb.language.vocabulary import BELIEF_PREDICATES

    declared = BELIEF_PREDICATES.get(entry.signature)
    return f"{entry.form.rpartition(',')[0]})" if declared is not None and declared.short else ""


def short_text(entry: Entry) -> str:
    """Return what the short form of a predicate says."""
    return f"It is known: `{entry.form.rpartition(',')[0]}, 100)`."


def files_section() -> str:
    """Return the part about the declared vocabulary of the kinds of fact files."""
    sys.path.insert(0, str(ROOT))
    from utak.kb.language.vocabulary import EXPECTATION_VOCABULARY, GOAL_VOCABULARY, START_VOCABULARY, WORLD_VOCABULARY
    from utak.simulator.scenario.trialfile import TRIAL_VOCABULARY

    parts: Mapping[str, Mapping[str, Sequence[object]]] = {
        "world.lp": WORLD_VOCABULARY,
        "start.lp": START_VOCABULARY,
        "goal.lp": GOAL_VOCABULARY,
        "expect.lp": EXPECTATION_VOCABULARY,
        "trial.lp": TRIAL_VOCABULARY,
    }
    where = "kb/language/vocabulary.py, simulator/scenario/trialfile.py"
    lines = ["## Fact files", "", f"What may stand in the files of a scenario ({where}).", ""]
    for name, vocabulary in parts.items():
        forms = [_form(predicate, slots) for predicate, slots in vocabulary.items()]
        lines.append(f"- **{name}**: " + ", ".join(f"`{form}`" for form in forms))
    return "\n".join(lines) + "\n"


def questions_section() -> str:
    """Return the part about which predicates of the world model are open."""
    sys.path.insert(0, str(ROOT))
    from utak.kb.language.vocabulary import BELIEF_PREDICATES, Openness

    words = {
        Openness.NEVER: "nothing: it is known completely",
        Openness.UNSEEN: "things not seen yet",
        Openness.UNTOLD: "things not seen yet, and things of which it says nothing",
        Openness.UNBOUND: "parameters of the task of which it says nothing",
    }
    lines = ["## What may hold besides what is believed", ""]
    lines += ["Questions are answered by this table (kb/language/vocabulary.py; docs/files.md says how).", ""]
    lines += ["| predicate | more of it may hold of | its confidence |", "|---|---|---|"]
    for (name, arity), declared in BELIEF_PREDICATES.items():
        but = f", but for {', '.join(sorted(declared.settled))}" if declared.settled else ""
        turns = "between 0 and 100 it may turn out otherwise" if declared.confident else ""
        if declared.long is not None:
            turns = f"it may hold where `{declared.long[0]}/{declared.long[1]}` is between 0 and 100"
        lines.append(f"| `{name}/{arity}` | {words[declared.open]}{but} | {turns} |")
    return "\n".join(lines) + "\n"


def rules_section() -> str:
    """Return the part about the predicates that rules of users may derive."""
    sys.path.insert(0, str(ROOT))
    from utak.kb.reasoning.interfaces import READ_ONLY_PREDICATES, USER_RULE_INTERFACES

    lines = ["## What rules of users may derive", ""]
    lines += [
        "The encodings that rules of `--kb` reach, and what stands in the arguments (kb/reasoning/interfaces.py).",
        "",
    ]
    for name, interface in USER_RULE_INTERFACES.items():
        forms = [
            _form(p, [s.name for s in slots])
            for (p, n), slots in interface.items()
            if (p, n) not in READ_ONLY_PREDICATES
        ]
        lines.append(f"- **{name}.lp**: " + ", ".join(f"`{form}`" for form in forms))
    return "\n".join(lines) + "\n"


def _form(predicate: str, slots: Sequence[object]) -> str:
    inner = ", ".join(str(getattr(slot, "name", slot)) for slot in slots)
    return f"{predicate}({inner})" if inner else predicate


def page() -> str:
    """Return the whole page."""
    sections = [*(section(path) for path in encodings()), questions_section(), rules_section(), files_section()]
    return "\n".join([HEAD, *sections])


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the page, or check it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only say whether the page is as it must be")
    check = parser.parse_args(arguments).check
    missing = {
        str(file.relative_to(ROOT)): sorted(undocumented(file.read_text()))
        for path in encodings()
        for file in (sorted(path.glob("*.lp")) if path.is_dir() else [path])
    }
    for name, signatures in missing.items():
        for predicate, arity in signatures:
            print(f"{name}: {predicate}/{arity} is not documented", file=sys.stderr)
    if check and (not PAGE.exists() or PAGE.read_text() != page()):
        print("docs/reference/vocabulary.md is stale: run python docs/build_vocabulary.py", file=sys.stderr)
        return 1
    if not check:
        PAGE.write_text(page())
    return int(any(missing.values()))


if __name__ == "__main__":
    sys.exit(main())
