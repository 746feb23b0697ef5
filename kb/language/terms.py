"""The values of a fact file: facts and their terms, each with the place where it stands.

Two terms are equal when they say the same, wherever they stand.
"""

from dataclasses import dataclass, field

from kb.language.diagnostics import Span


@dataclass(frozen=True, slots=True)
class Number:
    """An integer of 32 bits."""

    value: int
    span: Span = field(compare=False)

    def __str__(self) -> str:
        return str(self.value)


@dataclass(frozen=True, slots=True)
class Text:
    """A quoted string, without its quotes and escapes."""

    value: str
    span: Span = field(compare=False)

    def __str__(self) -> str:
        quoted = self.value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
        return f'"{quoted}"'


@dataclass(frozen=True, slots=True)
class Symbol:
    """A name, with arguments or without: `square`, `corner(northeast)`. A whole fact is a symbol too."""

    name: str
    args: tuple["Term", ...]
    span: Span = field(compare=False)

    @property
    def signature(self) -> tuple[str, int]:
        """The name and the number of arguments."""
        return self.name, len(self.args)

    def __str__(self) -> str:
        return f"{self.name}({','.join(map(str, self.args))})" if self.args else self.name


Term = Number | Text | Symbol
Fact = Symbol
