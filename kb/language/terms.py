"""Facts and their terms as values, each with its place in the source.

Two terms are equal when their content is equal; their places are not compared.
"""

from dataclasses import dataclass, field

from utak.kb.language.diagnostics import SourceSpan


@dataclass(frozen=True, slots=True)
class Number:
    """An integer of 32 bits."""

    value: int  # the integer
    span: SourceSpan = field(compare=False)  # the place in the source

    def __str__(self) -> str:
        """Return the integer in decimal digits, after a minus sign when it is negative."""
        return str(self.value)


@dataclass(frozen=True, slots=True)
class Text:
    """A quoted string."""

    value: str  # the characters themselves, without quotes, and with escapes replaced
    span: SourceSpan = field(compare=False)  # the place in the source

    def __str__(self) -> str:
        """Return the string in quotes, with escapes."""
        quoted = self.value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
        return f'"{quoted}"'


@dataclass(frozen=True, slots=True)
class Symbol:
    """A name with or without arguments, such as `square` or `corner(northeast)`. A fact is a symbol, too."""

    name: str  # the name
    args: tuple["Term", ...]  # the arguments in order; () for a plain name
    span: SourceSpan = field(compare=False)  # the place in the source

    @property
    def signature(self) -> tuple[str, int]:
        """The name and the number of arguments, such as ("at", 2)."""
        return self.name, len(self.args)

    def __str__(self) -> str:
        """Return the term without blanks: `at(utak,corner(northeast))`."""
        return f"{self.name}({','.join(map(str, self.args))})" if self.args else self.name


Term = Number | Text | Symbol  # an argument of a fact
Fact = Symbol  # a whole fact
