"""Lines become statements: a command is a line, a query goes on to its full stop."""

import re
from collections.abc import Collection

MAX_STATEMENT_CHARACTERS = 20_000  # a longer statement is ended, and then refused; a convention
QUERY_SIGN, MORE_SIGN = "?-", ";"
FACT_COMMANDS = frozenset({"assume", "retract", "goal", "since", "why", "whynot"})  # they take facts or rules
# The beginning of a query without `?-`: an atom, perhaps negated; an aggregate; or a variable that is compared.
QUERY_START = re.compile(r"(not\s+)*(-?_*[a-z]\w*\s*\(|#\w+\s*\{|[A-Z]\w*\s*[=<>!])")
QUOTED = re.compile(r'"(?:\\.|[^"\\])*("?)', re.DOTALL)
FULL_STOP = re.compile(r"(?<!\.)\.(?!\S)")
OPEN_END = re.compile(r"(,|;|:|:-|=|<|>|\|)$")  # a fact command goes on after such an end


def is_query(text: str, commands: Collection[str]) -> bool:
    """Return whether a statement that begins with this text is a query."""
    text = text.lstrip()
    if text.startswith(QUERY_SIGN):
        return True
    word = re.match(r"[a-z]+", text)
    if word is not None and word[0] in commands and not text[word.end() :].startswith("("):
        return False
    return QUERY_START.match(text) is not None


def _unquoted(text: str) -> str:
    """Return a text of the same length without what stands within quotes; one quote is left where they stay open."""
    return QUOTED.sub(lambda found: ("_" if found[1] else '"') + "_" * (len(found[0]) - 1), text)


def without_comment(line: str) -> str:
    """Return a line without the comment at its end; a `%` within quotes begins none.

    >>> without_comment('X = "5%".  % a share')
    'X = "5%".'
    """
    return line[: len(_unquoted(line).partition("%")[0])].rstrip()


def query_end(text: str) -> int:
    """Return the index behind the full stop that ends a query; -1 when there is none.

    >>> query_end("X = 1..3, room(R). help")
    18
    """
    found = FULL_STOP.search(_unquoted(text))
    return -1 if found is None else found.end()


def has_open_end(text: str) -> bool:
    """Return whether a fact or rule goes on behind a text: a bracket or a quotation is open, or more must follow."""
    shown, stripped = _unquoted(text), text.rstrip()
    depth = sum((char in "({[") - (char in ")}]") for char in shown)
    rule_goes_on = ":-" in stripped and not stripped.endswith(".")
    return '"' in shown or depth > 0 or rule_goes_on or OPEN_END.search(stripped) is not None


class StatementBuffer:
    """Collects lines until they are statements."""

    def __init__(self, commands: Collection[str]) -> None:
        self._commands = commands
        self._text = ""
        self._is_query = False

    @property
    def is_open(self) -> bool:
        """Whether a statement was begun and goes on."""
        return bool(self._text)

    def clear(self) -> None:
        """Forget the statement that was begun."""
        self._text = ""

    def finish(self) -> list[str]:
        """Return the statement that was begun, as if it ended here; [] for none."""
        text, self._text = self._text.strip(), ""
        return [text] if text else []

    def feed(self, line: str) -> list[str]:
        """Take a line and return the statements that it completes, in order."""
        line = line.rstrip("\r\n")
        done: list[str] = []
        if self.is_open and (not line.strip() or line.lstrip().startswith(QUERY_SIGN) or self._is_left(line)):
            done = self.finish()
        if not self.is_open:
            if not line.strip() or line.lstrip().startswith("%"):
                return done
            self._is_query = is_query(line, self._commands)
            word = re.split(r"[\s.(]", line.strip(), maxsplit=1)[0]
            if not self._is_query and word not in FACT_COMMANDS:
                return [*done, line.strip()]
        self._text += ("\n" if self._text else "") + without_comment(line)
        return done + self._completed()

    def _is_left(self, line: str) -> bool:
        """Return whether a line is a command, while the query that was begun is whole but for its full stop."""
        word = re.match(r"[a-z]+", line)
        command = word is not None and word[0] in self._commands and not is_query(line, self._commands)
        return command and not has_open_end(self._text)

    def _completed(self) -> list[str]:
        """Return the statements that the text holds; keep the rest, if it goes on."""
        if len(self._text) > MAX_STATEMENT_CHARACTERS:
            return self.finish()
        if not self._is_query:
            return [] if has_open_end(self._text) else self.finish()
        end = query_end(self._text)
        if end < 0:
            return []
        query, rest = self._text[:end].strip(), self._text[end:].strip()
        self._text = ""
        return [query, *(self.feed(rest) if rest else [])]
