"""The task plan as the facts of a step state it, read back as a value: in words, and as JSON values."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from utak.kb.language.atoms import atom_parts
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import source_from_bytes
from utak.kb.language.vocabulary import LENGTH_ARGUMENT, PLAN_PREDICATES, ROBOT_STEPS, SETTLING_WORDS, check_facts

PLAN_NAMES = frozenset(name for name, _ in PLAN_PREDICATES)
STUCK_WORDS = {  # what the robot may be stuck with beside goals, in words; goals keep their names
    "robot": "the robot's own goals",
    "all": "all goals for objects together",
    "plan": "what users' rules leave of the plan",
}
CERTAINTY_WORDS = {
    "verified": "geometry found a way over squares that are each free with 94 percent or more",
    "hoped": "geometry found a way over floor that is only hoped to be free",
    "not asked": "geometry was not asked for its way when the plan was made",
}
ROBOT_STEP_INDENT = "      "  # before a line that tells a step of the robot itself
HERE_PLACE = "here"  # the place of everything where it was when the plan was made
START_WORD = "start"  # in stood(start): the robot stands where it was when the plan was made


class PlanGoal(NamedTuple):
    """A goal for which the plan was made."""

    name: str  # g1, g2, ... in the order of the task.
    # What the task states for it, as facts without full stops; () for a goal that a user's rule added
    means: tuple[str, ...]
    attained: bool  # whether the plan attains it


class PlanStep(NamedTuple):
    """A step of the plan."""

    number: int  # its number; 0 is the present step
    step: str  # as the encoding writes it, such as carry(o1,g1_r2)
    serves: tuple[str, ...]  # the names of the goals that hold at its place
    doors: tuple[str, ...]  # the doors on its way
    commands: int | None  # about how many commands it takes; None when geometry was not asked
    verified: bool  # whether its way is surely free; else it is only hoped to be

    @property
    def certainty(self) -> str:
        """The answer of geometry in a word: `verified`, `hoped` or `not asked`."""
        return "verified" if self.verified else "not asked" if self.commands is None else "hoped"

    @property
    def explained(self) -> str:
        """The step in words, with what geometry said of its way; a step that settles something has none."""
        return self.words if self.settles else f"{self.words}; {CERTAINTY_WORDS[self.certainty]}"

    @property
    def line(self) -> str:
        """The step with what is known of it, as a line of text; `>` marks the present step."""
        through = f", through {' and '.join(self.doors)}" if self.doors else ""
        takes = "" if self.commands is None else f"about {_commands(self.commands)}, "
        known = "" if self.settles else f"; {takes}{self.certainty}"
        return f"{'>' if self.number == 0 else ' '} {self.number} {self.step}: {self.words}{through}{known}"

    @property
    def settles(self) -> bool:
        """Whether it settles something that is open, and brings nothing anywhere."""
        return self.step.partition("(")[0] in SETTLING_WORDS

    @property
    def words(self) -> str:
        """The step in words."""
        name, _, rest = self.step.partition("(")
        subject, _, place = rest.removesuffix(")").partition(",")
        if name in SETTLING_WORDS:
            return SETTLING_WORDS[name].format(STUCK_WORDS.get(subject, subject))
        goals = f"to where {' and '.join(self.serves)} holds" if self.serves else f"to {place or subject}"
        if name == "arrive":
            return f"the robot goes {goals}"
        return f"{subject} is moved aside to {place}" if name == "clear" else f"{subject} is brought {goals}"


class PlanRefutation(NamedTuple):
    """A step that geometry refuted when the plan was made."""

    number: int  # the number of the refutation
    step: str  # as the encoding writes it
    circumstances: tuple[str, ...]  # on what the refutation rests: at(N,P), stood(N) and shut(D), as text

    @property
    def words(self) -> str:
        """The refutation in words."""
        told = " and ".join(map(circumstance_in_words, self.circumstances))
        return f"{self.step} is refuted by what was known then" + (f", while {told}" if told else "")


@dataclass(frozen=True)
class StatedPlan:
    """The task plan of a step: what the robot means to do, from its present step on; or that there is none."""

    goals: tuple[PlanGoal, ...]  # the goals for which it was made, in the order of the task
    steps: tuple[PlanStep, ...]  # the steps that are left, in order
    refutations: tuple[PlanRefutation, ...] = ()  # the steps that geometry refuted when it was made
    # About how many commands the whole plan takes, with the steps that are done; None where it is not stated, or
    # geometry was not asked, because there is one way to plan it
    cost: int | None = None
    # A number of commands that no plan stays below, by the estimates of the search; None likewise
    least: int | None = None
    # Whether the search ended with it, or there was none; else it is the best one that was found up to the bound on
    # rounds
    proved: bool = False
    # The steps of the robot itself with which the present step goes on; the first one is that of the next command
    robot: tuple[str, ...] = ()

    @property
    def found(self) -> bool:
        """Whether there is a plan that attains all goals."""
        return self.cost is not None or (bool(self.steps) and not self.unmet)

    @property
    def gap(self) -> int | None:
        """The cost less the lower bound, in commands; None where they are not stated."""
        return None if self.cost is None or self.least is None else self.cost - self.least

    @property
    def unmet(self) -> tuple[str, ...]:
        """The names of the goals that it does not attain."""
        return tuple(goal.name for goal in self.goals if not goal.attained)

    @property
    def cost_words(self) -> str:
        """The cost in words: how many commands, the lower bound, and how the search ended; "" where there is none."""
        end = "the search ended with it" if self.proved else "best found, not proved"
        if self.cost:
            what = f"about {_commands(self.cost)} for the whole plan; lower bound by the estimates of the search"
            return f"{what} {self.least}, gap {self.gap}; {end}"
        return "" if self.proved or not self.found else end

    def lines(self) -> Iterator[str]:
        """Yield the plan as lines of text: its goals, its steps, its cost, and what was refuted."""
        for goal in self.goals:
            means = f": {' and '.join(goal.means)}" if goal.means else ""
            yield f"goal {goal.name}{means}{'' if goal.attained else '; not attained'}"
        if not self.steps:
            yield "no step is left" if self.found else "no plan that was found attains all goals"
        elif not self.found:
            yield "what is planned so far does not attain all goals; what is open is settled first"
        for step in self.steps:
            yield step.line
            if step.number == 0:
                yield from (f"{ROBOT_STEP_INDENT}{robot_step_in_words(one)}" for one in self.robot)
        if self.cost_words:
            yield f"cost: {self.cost_words}" if self.cost else self.cost_words
        yield from (f"refuted: {refutation.words}" for refutation in self.refutations)

    def __str__(self) -> str:
        """Return the plan as text."""
        return "\n".join(self.lines())

    def as_dict(self) -> dict[str, Any]:
        """Return the plan as JSON values, as `utak plan --json` prints it."""
        return {
            "found": self.found,
            "goals": [{"name": g.name, "means": list(g.means), "attained": g.attained} for g in self.goals],
            "steps": [
                {
                    "number": one.number,
                    "step": one.step,
                    "words": one.words,
                    "serves": list(one.serves),
                    "doors": list(one.doors),
                    "commands": one.commands,
                    "certainty": one.certainty,
                }
                for one in self.steps
            ],
            "robot": [{"step": one, "words": robot_step_in_words(one)} for one in self.robot],
            "cost": self.cost,
            "least": self.least,
            "gap": self.gap,
            "proved": self.proved,
            "refuted": [
                {"step": one.step, "given": list(one.circumstances), "words": one.words} for one in self.refutations
            ],
        }


def robot_step_in_words(step: str) -> str:
    """Return a step of the robot itself in words; lengths in squares, Utak's frame."""
    name, arguments = atom_parts(step)
    types, words = ROBOT_STEPS[name]
    return words.format(
        *(f"{int(a) / 100:g}" if kind is LENGTH_ARGUMENT else a for a, kind in zip(arguments, types, strict=True))
    )


def stated_plan(facts: Iterable[str], name: str = "facts") -> StatedPlan | None:
    """Return the plan that the facts of a step state, or that no plan was found; None when they say nothing of it."""
    text = [f"{fact.removesuffix('.')}." for fact in facts if fact.partition("(")[0] in PLAN_NAMES]
    source = source_from_bytes(name, "\n".join(text).encode("utf-8", "replace"))
    found = [fact for fact in parse_facts(source) if (fact.name, len(fact.args)) in PLAN_PREDICATES]
    types = {predicate: declared.arguments for (predicate, _), declared in PLAN_PREDICATES.items()}
    if problems := check_facts(source, found, types):
        raise BadInputError(problems)
    said: dict[str, list[tuple[str, ...]]] = {}
    for fact in found:
        said.setdefault(fact.name, []).append(tuple(map(str, fact.args)))
    return _plan(said) if said.keys() & {"plan", "price", "unmet"} else None


def _plan(said: Mapping[str, list[tuple[str, ...]]]) -> StatedPlan:
    """Return the plan of facts that fit the vocabulary; said : the arguments of all facts, by predicate."""

    def of(predicate: str, key: str) -> tuple[str, ...]:
        """Return the second arguments of the facts of a predicate whose first one is a key, in order."""
        return tuple(sorted((row[1] for row in said.get(predicate, ()) if row[0] == key), key=_by_number))

    unmet = {name for (name,) in said.get("unmet", ())}
    verified = {number for (number,) in said.get("verified", ())}
    names = {name for (name,) in said.get("goal", ())} | unmet  # users' rules may add goals that are unmet
    goals = [PlanGoal(name, of("means", name), name not in unmet) for name in sorted(names, key=_by_number)]
    steps = [
        PlanStep(
            int(number),
            step,
            of("serves", number),
            of("passes", number),
            next(map(int, of("takes", number)), None),
            number in verified,
        )
        for number, step in sorted(said.get("plan", ()), key=lambda row: int(row[0]))
    ]
    refutations = [
        PlanRefutation(int(number), step, of("given", number))
        for step, number in sorted(said.get("refuted", ()), key=lambda row: int(row[1]))
    ]
    cost, least, end = next(iter(said.get("price", ())), (None, None, "found" if unmet else "proved"))
    if steps and cost == "0":  # no step takes nothing: geometry was not asked
        cost, least = None, None
    return StatedPlan(
        tuple(goals),
        tuple(steps),
        tuple(refutations),
        None if cost is None else int(cost),
        None if least is None else int(least),
        end == "proved",
        tuple(step for _, step in sorted(said.get("step", ()), key=lambda row: int(row[0]))),
    )


def _by_number(name: str) -> tuple[str, int, str]:
    """Return a key that sorts names by their letters, then by the number at their end: g2 before g10."""
    letters = name.rstrip("0123456789")
    digits = name[len(letters) :]
    return letters, int(digits) if digits else -1, name


def circumstance_in_words(circumstance: str) -> str:
    """Return a circumstance of a refutation in words; circumstance : at(N,P), stood(N) or shut(D), as text."""
    (kind, _, rest) = circumstance.removesuffix(")").partition("(")
    name, _, place = rest.partition(",")
    if kind == "at":
        return f"{name} is where it was" if place == HERE_PLACE else f"{name} is at {place}"
    if kind == "stood":
        return f"the robot stands where it {'was' if name == START_WORD else f'put {name}'}"
    return f"door {name} is not passed"


def _commands(number: int) -> str:
    """Return a number of commands in words."""
    return f"{number} command{'s' * (number != 1)}"
