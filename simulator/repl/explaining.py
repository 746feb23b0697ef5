"""`why` and `whynot`: the table of functions that explain.

To add an explanation, put a function into `EXPLAINERS`, or give `converse` another table. It takes the story at its
current step, what was typed behind the command (without the depth and the full stop), and the depth: short, mid or
long. It returns the text to print, and raises BadInputError for what it cannot read.
"""

import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from utak.kb.evidence.reason import Depth
from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.simulator.run.story import Story
from utak.simulator.terminal.streams import escape_controls

if TYPE_CHECKING:
    from utak.simulator.explaining.questions import Questions

CELL_QUESTION = re.compile(r"cell\s+(\d{1,9})")


class Explainer(NamedTuple):
    """A command that explains."""

    usage: str  # how it is called, for `help`
    summary: str  # what it does, in one line
    explain: Callable[[Story, str, str], str]  # returns the explanation of what was typed: (story, rest, depth) -> text


def why(story: Story, rest: str, depth: str) -> str:
    """Return why a fact is believed, a command was given, or a cell shows what it shows, as a tree of reasons."""
    questions, at = _questions(story), story.line["step"]
    cell = CELL_QUESTION.fullmatch(rest)
    if rest == "step":
        reason = questions.why_step(at)
    elif cell:
        reason = questions.why_cell(int(cell[1]), at)
    elif rest:
        reason = questions.why(rest, at)
    else:
        raise _nothing_asked("why", "such as why step. or why kind(o1, object, C).")
    return escape_controls(reason.text(Depth(depth)))


def why_not(story: Story, rest: str, depth: str) -> str:
    """Return why a fact is not believed: what is missing, or in the way. Parameters as of `why`."""
    if not rest:
        raise _nothing_asked("whynot", "such as whynot shape(o1, square, C).")
    return escape_controls(_questions(story).why_not(rest, story.line["step"]).text(Depth(depth)))


def _questions(story: Story) -> "Questions":
    """Return the questions about a story up to its current step."""
    from utak.simulator.explaining.questions import Questions

    lines = story.lines[: story.at + 1]
    return Questions(story.header, lines, story.result, story.rule_files)


def _nothing_asked(command: str, hint: str) -> BadInputError:
    """Return the error that nothing is asked."""
    return BadInputError([Problem(command, SourceSpan(1, 1, 1), "nothing is asked", command, hint)])


EXPLAINERS: Mapping[str, Explainer] = {
    "why": Explainer("why [short|long] FACT. | step. | cell N.", "why a fact, this step's command, or a cell", why),
    "whynot": Explainer("whynot [short|long] FACT.", "what is missing for a fact, or in the way", why_not),
}


def asked(rest: str) -> tuple[str, str]:
    """Return what is asked, without its full stop, and the depth: the word before it, or mid.

    >>> asked("long shape(o1, square, 90).")
    ('shape(o1, square, 90)', 'long')
    """
    word, _, after = rest.strip().partition(" ")
    depth, question = (word, after) if word in tuple(Depth) else (Depth.MID, rest)
    return question.strip().removesuffix(".").strip(), depth
