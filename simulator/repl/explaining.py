"""`why` and `whynot`: the table of functions that explain.

To add an explanation, put a function into `EXPLAINERS`, or give `converse` another table. It takes the story at its
current step, what was typed behind the command (without the depth and the full stop), and the depth: short, mid or
long. It returns the text to print, and raises BadInputError for what it cannot read.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from kb.language.diagnostics import BadInputError, Problem, SourceSpan
from simulator.run.story import Story
from simulator.terminal.action_in_words import describe
from simulator.terminal.streams import escape_controls

DEPTHS = ("short", "mid", "long")
DEFAULT_DEPTH = "mid"


class Explainer(NamedTuple):
    """A command that explains.

    Attributes
    ----------
    usage : how it is called, for `help`.
    summary : what it does, in one line.
    explain : returns the explanation of what was typed: (story, rest, depth) -> text.
    """

    usage: str
    summary: str
    explain: Callable[[Story, str, str], str]


def reason_of_step(story: Story, rest: str, depth: str) -> str:
    """Return the reason of the command before the current step; raise BadInputError for another question."""
    if rest != "step":
        what = f"this is not explained: {rest[:40]}" if rest else "nothing is asked"
        span = SourceSpan(1, 1, max(1, len(rest)))
        raise BadInputError([Problem("why", span, what, rest, "why step. gives the reason of this step")])
    line = story.line
    why = escape_controls(str(line.get("why", "")), lines=False)
    return f"step {line['step']}: {describe(line.get('action'))}: {why}"


EXPLAINERS: Mapping[str, Explainer] = {
    "why": Explainer("why step.", "the reason of the command before this step", reason_of_step),
}


def asked(rest: str) -> tuple[str, str]:
    """Return what is asked, without its full stop, and the depth: the word before it, or DEFAULT_DEPTH.

    >>> asked("long shape(o1, square, 90).")
    ('shape(o1, square, 90)', 'long')
    """
    word, _, after = rest.strip().partition(" ")
    depth, question = (word, after) if word in DEPTHS else (DEFAULT_DEPTH, rest)
    return question.strip().removesuffix(".").strip(), depth
