"""The world model after a step, and the answers to questions about it."""

import atexit
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from html import escape
from pathlib import Path
from typing import Any

from utak.kb.reasoning.query import QueryEngine
from utak.markup import framed, table
from utak.simulator.replay.drawing import belief_svg

MAX_ROWS_SHOWN = 100  # rows of an answer that a notebook shows; a convention


@dataclass(frozen=True)
class Answer:
    """The answer to a question about what is believed.

    It is true when what was asked certainly holds, for at least one binding of its variables. It shows itself in
    notebooks as a table.

    Attributes
    ----------
    kind : str
        "bindings", "yes", "no" or "don't know"; "bindings" only for a question with variables.
    variables : tuple of str
        The names of the variables, in the order in which they appear.
    rows : tuple of tuples
        The values of the variables in each binding: integers, or terms as text.
    more : bool
        Whether there are more rows.
    """

    kind: str
    variables: tuple[str, ...] = ()
    rows: tuple[tuple[int | str, ...], ...] = ()
    more: bool = False

    def __bool__(self) -> bool:
        """Return whether what was asked certainly holds. "don't know" is false, too."""
        return self.kind in ("yes", "bindings")

    def __len__(self) -> int:
        """Return the number of bindings."""
        return len(self.rows)

    def __iter__(self) -> Iterator[dict[str, int | str]]:
        """Yield each binding as the value of each variable by its name."""
        return (dict(zip(self.variables, row, strict=True)) for row in self.rows)

    def __str__(self) -> str:
        """Return a table of the bindings, or the kind of the answer in words."""
        from utak.kb.reasoning.query import QueryAnswer

        return str(QueryAnswer(self.kind, self.variables, self.rows, self.more))

    def __repr__(self) -> str:
        """Return the answer as `print` shows it, so that it can be read at a prompt."""
        return str(self)

    def _repr_html_(self) -> str:
        if self.kind != "bindings":
            return escape(self.kind)
        shown = table(self.variables, self.rows[:MAX_ROWS_SHOWN])
        hidden = len(self.rows) - MAX_ROWS_SHOWN
        others = [f"and {hidden} more row{'s' * (hidden != 1)}"] if hidden > 0 else []
        others += ["and others that were not looked for"] if self.more else []
        return shown + (f"<p>{', '.join(others)}</p>" if others else "")


@dataclass(frozen=True, repr=False)
class World:
    """The world model: what is believed after an impression. It shows itself in notebooks as a picture.

    Attributes
    ----------
    step : int
        The number of the step after which it is believed.
    facts : tuple of str
        The world model as facts with full stops (docs/reference/vocabulary.md). Lengths are hundredths of squares in
        the robot frame, confidences are percent.
    belief : mapping
        All that the episode records of the belief, as JSON values (docs/files.md); `facts` are one of its keys.
    rules : tuple of str
        The files with users' rules, whose predicates questions can use.
    """

    step: int
    facts: tuple[str, ...]
    belief: Mapping[str, Any] = field(compare=False)
    rules: tuple[str, ...] = ()

    def query(self, question: str) -> Answer:
        """Return the answer to a question.

        Parameters
        ----------
        question : str
            The body of a rule, such as `object(X), shape(X, square, C), C > 50`. It certainly holds, certainly does not
            hold, or is not known (docs/files.md, Questions).

        Returns
        -------
        Answer
            Yes, no, don't know, or the bindings of the variables with which it certainly holds.

        Raises
        ------
        BadInputError
            The question has an error; the message names the place.
        CannotOpenError
            A file with users' rules cannot be read any more.
        QueryLimitError
            It takes too much time or memory.
        """
        changed = tuple(Path(file).stat().st_mtime_ns if Path(file).exists() else 0 for file in self.rules)
        found = _engine(self.rules, changed).ask(self.facts, question)
        return Answer(found.kind, found.variables, found.rows, found.more)

    @property
    def place(self) -> tuple[float, float]:
        """The believed place of the robot: (east, north) in squares, robot frame; (0, 0) where nothing is recorded."""
        east, north = self.belief.get("place", (0.0, 0.0))
        return float(east), float(north)

    @property
    def bound(self) -> dict[str, str]:
        """The meaning of the parameters of the task: the name of a node for each parameter that is bound."""
        return dict(self.belief.get("bound", {}))

    def __contains__(self, fact: str) -> bool:
        """Return whether a fact is among the facts, word by word; blanks and the full stop do not count."""
        return "".join(fact.split()).removesuffix(".") + "." in self.facts

    def __iter__(self) -> Iterator[str]:
        """Yield the facts."""
        return iter(self.facts)

    def __len__(self) -> int:
        """Return the number of facts."""
        return len(self.facts)

    def __bool__(self) -> bool:
        """Return True: a world without facts is a world, too."""
        return True

    def __repr__(self) -> str:
        """Return the number of facts and the objects that are believed in."""
        nodes = [fact[len("kind(") :].split(",")[0] for fact in self.facts if fact.startswith("kind(")]
        objects = sorted({name for name in nodes if name not in ("org", "floor", "verge")}, key=lambda n: (len(n), n))
        return f"<World at step {self.step}: {len(self.facts)} facts; objects: {', '.join(objects) or 'none'}>"

    def _repr_svg_(self) -> str:
        return belief_svg(self.facts, self.place)

    def _repr_html_(self) -> str:
        return framed(escape(repr(self)[1:-1]), self._repr_svg_())


def world_of(line: Mapping[str, Any], rules: tuple[str, ...] = ()) -> World:
    """Return what is believed in the line of an episode's step."""
    return World(line["step"], tuple(line["belief"]["facts"]), line["belief"], rules)


@cache
def _engine(rules: tuple[str, ...], changed: tuple[int, ...]) -> QueryEngine:
    """Return the engine that answers questions with some rules: one process for each, until Python ends."""
    engine = QueryEngine(rules=rules)
    atexit.register(engine.close)
    return engine
