"""The state of a conversation at the prompt, and the execution of one statement."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

from utak.kb.language.diagnostics import BadInputError, CannotOpenError, did_you_mean
from utak.kb.reasoning.query import QueryAnswer, QueryEngine, QueryLimitError
from utak.simulator.repl.printer import Printer
from utak.simulator.repl.statements import MORE_SIGN, QUERY_SIGN, is_query
from utak.simulator.run.changes import Change, changed_conditions
from utak.simulator.run.session import CannotAdoptError
from utak.simulator.run.story import Story
from utak.simulator.terminal.streams import StreamError

QUIT_WORDS = ("quit", "exit")
MAX_BUG_CHARACTERS = 500  # characters of the text of a bug that are printed; a convention


class PromptCommand(NamedTuple):
    """A command of the prompt."""

    usage: str  # how it is called
    summary: str  # what it does, in one line
    # Executes it: (dialogue, what was typed behind the name without a full stop at its end)
    run: "Callable[[Dialogue, str], None]"
    details: str = ""  # more about it, for `help NAME`; '' for nothing


class Dialogue:
    """A conversation about one story: a run or a recorded episode."""

    def __init__(
        self,
        story: Story,
        engine: QueryEngine,
        printer: Printer,
        commands: Mapping[str, PromptCommand],
        certificate: str = "",
    ) -> None:
        self.story, self.engine, self.printer = story, engine, printer
        self.commands, self.certificate = commands, certificate
        self.rest: Iterator[bool] | None = None  # prints the pages of the last answer that were not printed yet
        self.told_lacking = False  # whether it was said that rules of the run are not given

    @property
    def names(self) -> list[str]:
        """The names of all commands."""
        return sorted({*self.commands, *QUIT_WORDS})

    @property
    def prompt(self) -> str:
        """The prompt: the current step, and how many assumptions count there."""
        try:
            assumed = len(self.story.conditions.assumptions) if self.story.changes else 0
        except BadInputError:  # a damaged episode; the commands say so
            assumed = 0
        marks = f" +{assumed} assumed" if assumed else ""
        return f"utak {self.story.at}{marks}> "

    def known_facts(self) -> Sequence[str]:
        """Return the facts that queries see: what is believed at this step, and what is assumed for queries."""
        story = self.story
        assumed = story.conditions.assumptions if story.changes else ()
        return [*story.facts, *(fact for one in assumed for fact in one.facts if fact not in story.facts)]

    def ask(self, query: str, max_rows: int) -> QueryAnswer:
        """Return the answer to a query at this step; raises as `QueryEngine.ask`."""
        self.engine.use_rules(self.story.rule_files)
        return self.engine.ask(self.known_facts(), query, max_rows)

    def live_story(self, kind: str, text: str) -> Story:
        """Return the story as a run that can be changed; a recorded episode is repeated up to this step first."""
        # Raises BadInputError when the episode cannot be repeated, or the change that is meant has errors.
        if self.story.is_recorded:
            changed_conditions(self.story.conditions, Change(self.story.at, kind, text))
            self.printer.tell(
                f"the run of {self.story.name} is repeated up to step {self.story.at}, to go on from there"
            )
            self.story, differing = self.story.relive()
            if differing is not None:
                what = "what is believed differs from what was recorded, by another version of utak"
                self.printer.tell(f"from step {differing} on {what}: what is believed now counts")
        return self.story

    def obey(self, statement: str) -> bool:
        """Execute a statement. Return False when it says to quit. Errors are printed, not raised."""
        name, rest = self._parts(statement)
        if name in QUIT_WORDS and not rest:
            return False
        try:
            if name != MORE_SIGN:
                self.rest = None
            self._execute(name, rest)
        except (BadInputError, CannotOpenError, QueryLimitError, CannotAdoptError) as problem:
            self.printer.tell(str(problem))
        except KeyboardInterrupt:
            self.printer.tell("interrupted")
        except (BrokenPipeError, StreamError):
            raise
        except Exception as bug:  # the prompt must come back, whatever happens
            self.printer.tell(f"this is a bug of ours: {type(bug).__name__}: {str(bug)[:MAX_BUG_CHARACTERS]}")
        return True

    def _parts(self, statement: str) -> tuple[str, str]:
        """Return the name of a statement's command and what follows it; a query has the name `?-`."""
        text = statement.strip()
        if is_query(text, self.names):
            return QUERY_SIGN, text.removeprefix(QUERY_SIGN)
        if text.rstrip(". ") == MORE_SIGN:
            return MORE_SIGN, ""
        found = re.match(r"[^\s.]*", text)
        name = found[0] if found else ""
        rest = text[len(name) :].strip()
        return name, "" if rest == "." else rest

    def _execute(self, name: str, rest: str) -> None:
        """Execute a command by its name."""
        if name in self.commands:
            self.commands[name].run(self, rest)
        else:
            hint = did_you_mean(name, self.names) or "help lists what there is, ?- asks"
            hint = f"{name} takes nothing behind it" if name in self.names else hint
            self.printer.tell(f"unknown command {name[:40]}; {hint}")
