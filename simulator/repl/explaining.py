"""Commands that explain: why, whynot."""

import re
from typing import TYPE_CHECKING

from utak.kb.evidence.reason import Depth
from utak.kb.language.diagnostics import BadInputError
from utak.simulator.repl.dialogue import Dialogue
from utak.simulator.terminal.streams import escape_controls

if TYPE_CHECKING:
    from utak.simulator.explaining.questions import Questions

CELL_QUESTION = re.compile(r"cell\s+(\d{1,9})")


def why(dialogue: Dialogue, rest: str) -> None:
    """Print why a fact is believed, a command was given, or a cell shows what it shows, as a tree of reasons."""
    question, depth = asked(rest)
    questions, at = _questions(dialogue), dialogue.story.at
    if not question:
        raise BadInputError.about("why", "why", "nothing is asked", "such as why step. or why kind(o1, object, C).")
    if question == "step":
        reason = questions.why_step(at)
    elif cell := CELL_QUESTION.fullmatch(question):
        reason = questions.why_cell(int(cell[1]), at)
    else:
        reason = questions.why(question, at)
    dialogue.printer.say(escape_controls(reason.text(Depth(depth))))


def why_not(dialogue: Dialogue, rest: str) -> None:
    """Print why a fact is not believed: what is missing, or in the way."""
    question, depth = asked(rest)
    if not question:
        raise BadInputError.about("whynot", "whynot", "nothing is asked", "such as whynot shape(o1, square, C).")
    reason = _questions(dialogue).why_not(question, dialogue.story.at)
    dialogue.printer.say(escape_controls(reason.text(Depth(depth))))


def _questions(dialogue: Dialogue) -> "Questions":
    """Return the questions about a story up to its current step; say once when rules of the run are not given."""
    from utak.simulator.explaining.questions import Questions  # takes clingo

    story = dialogue.story
    lines = story.lines[: story.at + 1]
    questions = Questions(story.header, lines, story.result, story.rule_files, dialogue.certificate)
    if not dialogue.told_lacking:
        dialogue.told_lacking = True
        if lacking := questions.lacking:
            dialogue.printer.tell(f"{lacking}; give rules with utak repl --kb FILE")
    return questions


def asked(rest: str) -> tuple[str, str]:
    """Return what is asked, without its full stop, and the depth: the word before it, or mid.

    >>> asked("long shape(o1, square, 90).")
    ('shape(o1, square, 90)', 'long')
    """
    word, _, after = rest.strip().partition(" ")
    depth, question = (word, after) if word in tuple(Depth) else (Depth.MID, rest)
    return question.strip().removesuffix(".").strip(), depth
