"""The parts of explanations: frozen values that JSON can hold."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class RuleText:
    """A rule, constraint or weak constraint as it stands in its file."""

    file: str  # the name of the file
    line: int  # where it begins, from 1
    column: int
    text: str  # the rule on one line
    kind: str  # fact, rule, choice, disjunction, constraint or weak (a weak constraint)
    sentence: str  # its plain sentence with placeholders; '' when it has none


@dataclass(frozen=True)
class RuleInstance:
    """A rule with values for its variables."""

    rule: RuleText  # the rule
    values: tuple[tuple[str, str], ...]  # (name, value) of each variable that the rule names
    sentence: str  # its sentence with these values, or the text of the rule when it has none


@dataclass(frozen=True)
class Price:
    """The price that a weak constraint adds to the cost of an answer."""

    level: int  # the level of priority; a higher level decides first
    weight: int  # the price, in the units of the encoding
    instance: RuleInstance  # the weak constraint with its values


@dataclass(frozen=True)
class RivalChoice:
    """Another way to choose, held against the answer."""

    atom: str  # the atom that could have been chosen; '' for none of them
    verdict: str  # dearer, equal, cheaper (the answer was not proved to be the best), or forbidden
    # (level, cost) of the best answer with this choice, the highest level first; () when it is forbidden
    costs: tuple[tuple[int, int], ...]
    level: int | None  # the highest level on which the costs differ; None when none does
    difference: int  # the cost on that level beyond that of the answer; 0 when there is none
    prices: tuple[Price, ...]  # what only this choice pays, the highest level first
    saved: tuple[Price, ...]  # what only the answer pays
    forbidden_by: tuple[RuleInstance, ...]  # the constraints that no answer with this choice can keep
    sentence: str  # all this in one sentence
    proved: bool = True  # whether the search for the best answer with this choice was complete


@dataclass(frozen=True)
class ProofNode:
    """A claim and what it rests on."""

    # Given (an input fact), assumed (a fact that is not given, but would be), derived, chosen, absent (a negated atom),
    # negated (a negation of anything else), comparison, aggregate, each (a conditional literal), or stated (a literal
    # that holds whatever is given)
    kind: str
    claim: str  # the claim in the words of the program, such as `kind(a,object,95)` or `30 <= 35`
    words: str  # the claim in plain words
    instance: RuleInstance | None = None  # the rule that derives it, with values; None for a claim that no rule derives
    # What the rule's body consists of, in its order; () for a leaf
    children: "tuple[ProofNode, ...]" = field(default=(), repr=False)
    rivals: tuple[RivalChoice, ...] = field(default=(), repr=False)  # for a chosen atom the other ways to choose

    @property
    def sentence(self) -> str:
        """The reason: the sentence of the rule, or the claim in plain words when no rule derives it."""
        return self.instance.sentence if self.instance else self.words


@dataclass(frozen=True)
class Proof:
    """Why an atom holds in an answer."""

    encoding: str  # the name of the encoding, or `belief` for what is asked in queries
    root: ProofNode  # the claim, and what it rests on


@dataclass(frozen=True)
class Absence:
    """Why an atom does not hold, and the least change of the given facts with which it would."""

    encoding: str  # the name of the encoding
    atom: str  # the atom
    missing: tuple[str, ...]  # facts that would have to be given
    in_way: tuple[str, ...]  # given facts that would have to be absent
    partial: bool  # whether a smaller change, or any at all, may exist beyond the candidates or the time of the search
    found: bool  # whether a change was found; else `missing` and `in_way` are ()
    sentence: str  # all this in one sentence
    # For an atom that could have been chosen, how it compares with the answer; else None
    rival: RivalChoice | None = None
    proof: Proof | None = None  # why the atom holds after the change; None when no change was found
