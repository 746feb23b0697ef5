"""The parts of explanations: frozen values that JSON can hold."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class RuleText:
    """A rule, constraint or weak constraint as it stands in its file.

    Attributes
    ----------
    file : the name of the file.
    line, column : where it begins, from 1.
    text : the rule on one line.
    kind : fact, rule, choice, disjunction, constraint or weak (a weak constraint).
    sentence : its plain sentence with placeholders; '' when it has none.
    """

    file: str
    line: int
    column: int
    text: str
    kind: str
    sentence: str


@dataclass(frozen=True)
class RuleInstance:
    """A rule with values for its variables.

    Attributes
    ----------
    rule : the rule.
    values : (name, value) of each variable that the rule names.
    sentence : its sentence with these values, or the text of the rule when it has none.
    """

    rule: RuleText
    values: tuple[tuple[str, str], ...]
    sentence: str

    def as_dict(self) -> dict[str, Any]:
        """Return the instance as JSON values: file, line, column, rule, values, sentence."""
        place = {"file": self.rule.file, "line": self.rule.line, "column": self.rule.column}
        return place | {"rule": self.rule.text, "values": dict(self.values), "sentence": self.sentence}


@dataclass(frozen=True)
class Price:
    """The price that a weak constraint adds to the cost of an answer.

    Attributes
    ----------
    level : the level of priority; a higher level decides first.
    weight : the price, in the units of the encoding.
    instance : the weak constraint with its values.
    """

    level: int
    weight: int
    instance: RuleInstance

    def as_dict(self) -> dict[str, Any]:
        """Return the price as JSON values: level, weight, and those of the instance."""
        return {"level": self.level, "weight": self.weight} | self.instance.as_dict()


@dataclass(frozen=True)
class RivalChoice:
    """Another way to choose, held against the answer.

    Attributes
    ----------
    atom : the atom that could have been chosen; '' for none of them.
    verdict : dearer, equal, cheaper (the answer was not proved to be the best), or forbidden.
    costs : (level, cost) of the best answer with this choice, the highest level first; () when it is forbidden.
    level : the highest level on which the costs differ; None when none does.
    difference : the cost on that level beyond that of the answer; 0 when there is none.
    prices : what only this choice pays, the highest level first.
    saved : what only the answer pays.
    forbidden_by : the constraints that no answer with this choice can keep.
    sentence : all this in one sentence.
    proved : whether the search for the best answer with this choice was complete.
    """

    atom: str
    verdict: str
    costs: tuple[tuple[int, int], ...]
    level: int | None
    difference: int
    prices: tuple[Price, ...]
    saved: tuple[Price, ...]
    forbidden_by: tuple[RuleInstance, ...]
    sentence: str
    proved: bool = True

    def as_dict(self) -> dict[str, Any]:
        """Return the rival as JSON values, under the names of the attributes."""
        return {
            "atom": self.atom,
            "verdict": self.verdict,
            "costs": [list(cost) for cost in self.costs],
            "level": self.level,
            "difference": self.difference,
            "prices": [price.as_dict() for price in self.prices],
            "saved": [price.as_dict() for price in self.saved],
            "forbidden_by": [one.as_dict() for one in self.forbidden_by],
            "sentence": self.sentence,
            "proved": self.proved,
        }


@dataclass(frozen=True)
class ProofNode:
    """A claim and what it rests on.

    Attributes
    ----------
    kind : given (an input fact), assumed (a fact that is not given, but would be), derived, chosen, absent (a negated
        atom), negated (a negation of anything else), comparison, aggregate, each (a conditional literal), or stated (a
        literal that holds whatever is given).
    claim : the claim in the words of the program, such as `kind(a,object,95)` or `30 <= 35`.
    words : the claim in plain words.
    instance : the rule that derives it, with values; None for a claim that no rule derives.
    children : what the rule's body consists of, in its order; () for a leaf.
    rivals : for a chosen atom the other ways to choose.
    """

    kind: str
    claim: str
    words: str
    instance: RuleInstance | None = None
    children: "tuple[ProofNode, ...]" = field(default=(), repr=False)
    rivals: tuple[RivalChoice, ...] = field(default=(), repr=False)

    @property
    def sentence(self) -> str:
        """The reason: the sentence of the rule, or the claim in plain words when no rule derives it."""
        return self.instance.sentence if self.instance else self.words

    def walk(self) -> "Iterator[ProofNode]":
        """Yield this node and all nodes below it, each claim once, a node before its children."""
        seen: set[int] = set()
        waiting = [self]
        while waiting:
            node = waiting.pop()
            if id(node) not in seen:
                seen.add(id(node))
                yield node
                waiting += reversed(node.children)


@dataclass(frozen=True)
class Proof:
    """Why an atom holds in an answer.

    Attributes
    ----------
    encoding : the name of the encoding, or `belief` for what is asked in queries.
    root : the claim, and what it rests on.
    """

    encoding: str
    root: ProofNode


@dataclass(frozen=True)
class Absence:
    """Why an atom does not hold, and the least change of the given facts with which it would.

    Attributes
    ----------
    encoding : the name of the encoding.
    atom : the atom.
    missing : facts that would have to be given.
    in_way : given facts that would have to be absent.
    partial : whether a smaller change, or any at all, may exist beyond the candidates or the time of the search.
    found : whether a change was found; else `missing` and `in_way` are ().
    sentence : all this in one sentence.
    rival : for an atom that could have been chosen, how it compares with the answer; else None.
    proof : why the atom holds after the change; None when no change was found.
    """

    encoding: str
    atom: str
    missing: tuple[str, ...]
    in_way: tuple[str, ...]
    partial: bool
    found: bool
    sentence: str
    rival: RivalChoice | None = None
    proof: Proof | None = None
