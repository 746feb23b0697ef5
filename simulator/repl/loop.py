"""The loop of `utak repl`: statements are read and executed until `quit` or the end of the input."""

from utak.kb.reasoning.query import QueryEngine
from utak.simulator.repl.commands import PROMPT_COMMANDS
from utak.simulator.repl.completion import CompletionWord, completions
from utak.simulator.repl.dialogue import Dialogue
from utak.simulator.repl.printer import open_printer
from utak.simulator.repl.reading import History, LineReader, open_reader
from utak.simulator.repl.statements import StatementBuffer
from utak.simulator.run.story import Story


def converse(story: Story, engine: QueryEngine, certificate: str = "") -> None:
    """Talk with the user of the standard streams about a story, until the input ends or they leave."""
    # With the text of a certificate, which is told with the verdict.
    printer, history = open_printer(), History()
    dialogue = Dialogue(story, engine, printer, PROMPT_COMMANDS, certificate)
    reader = open_reader(lambda text: complete(dialogue, text), history, lambda text: is_whole(dialogue, text))
    kind = "an episode" if story.is_recorded else "a run"
    printer.note(f"{kind} at step {story.at}; help lists what there is, ?- asks, Tab completes, quit leaves")
    read_and_obey(dialogue, reader, history)


def read_and_obey(dialogue: Dialogue, reader: LineReader, history: History | None = None) -> None:
    """Read lines and execute the statements in them, until the input ends or one says to quit."""
    # None to remember none.
    buffer = StatementBuffer(dialogue.names)
    while True:
        try:
            statements = _read(dialogue, reader, buffer)
            for statement in buffer.finish() if statements is None else statements:
                if reader.is_terminal and history is not None:
                    history.append(statement)
                if not dialogue.obey(statement):
                    return
            if statements is None:
                return
        except KeyboardInterrupt:
            if not reader.is_terminal:
                raise
            buffer.clear()


def _read(dialogue: Dialogue, reader: LineReader, buffer: StatementBuffer) -> list[str] | None:
    """Return the statements that the next input completes; None at the end of the input."""
    try:
        lines = reader.read(dialogue.prompt, buffer.is_open).splitlines() or [""]
    except EOFError:
        if reader.is_terminal:
            print()
        return None
    return [statement for line in lines for statement in buffer.feed(line)]


def is_whole(dialogue: Dialogue, text: str) -> bool:
    """Return whether a text is a whole statement, or ends in an empty line."""
    buffer = StatementBuffer(dialogue.names)
    for line in text.split("\n"):
        buffer.feed(line)
    return not buffer.is_open


def complete(dialogue: Dialogue, text: str) -> tuple[str, list[CompletionWord]]:
    """Return the word at the end of a text and what completes it: what is believed at this step is known by name."""
    facts: list[str] = []
    parameters: list[str] = []
    try:
        if dialogue.story.is_awake:
            facts = list(dialogue.known_facts())
        parameters = list(dialogue.story.conditions.task.parameters)
    except Exception:
        pass
    return completions(text, dialogue.names, facts, parameters)
