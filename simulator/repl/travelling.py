"""Going through a story: step, back, run, goto; and what changed between two steps."""

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress

from utak.simulator.episode.episode import EpisodeLine
from utak.simulator.repl.asking import names_word
from utak.simulator.repl.dialogue import Dialogue
from utak.simulator.run.interrupts import defer_interrupt
from utak.simulator.terminal.action_in_words import describe
from utak.simulator.terminal.progress import StepProgress
from utak.simulator.terminal.streams import escape_controls

MAX_GOTO_STEP = 1_000_000  # the greatest number of steps that a command takes; a convention
OUTLINE_START = "segment("  # facts about outlines: many of them change at every step


def whole_number(text: str) -> int | None:
    """Return the number that a text denotes, 0 to MAX_GOTO_STEP; None for anything else."""
    if text.isascii() and text.isdigit() and len(text) <= 9 and int(text) <= MAX_GOTO_STEP:
        return int(text)
    return None


def step(dialogue: Dialogue, rest: str) -> None:
    """Go on by one step, or by a number of them."""
    text = rest.removesuffix(".") or "1"
    count = whole_number(text)
    if not count:
        dialogue.printer.tell(f"step takes a number of steps, not {text[:40]}")
        return
    advance(dialogue, count)


def run(dialogue: Dialogue, rest: str) -> None:
    """Go on to the end."""
    advance(dialogue, None)


def back(dialogue: Dialogue, rest: str) -> None:
    """Go back by one step, or by a number of them."""
    text = rest.removesuffix(".") or "1"
    count, story = whole_number(text), dialogue.story
    if not count:
        dialogue.printer.tell(f"back takes a number of steps, not {text[:40]}")
    elif story.at == 0:
        dialogue.printer.tell("this is step 0, the first one")
    else:
        story.go_to(max(0, story.at - count))
        dialogue.printer.say(told_step(story.line))


def goto(dialogue: Dialogue, rest: str) -> None:
    """Go to a step: back, or on by as many steps as are needed."""
    text, story = rest.removesuffix("."), dialogue.story
    wanted = whole_number(text)
    if wanted is None:
        dialogue.printer.tell(f"goto takes the number of a step, not {text[:40] or 'nothing'}")
    elif wanted < len(story.lines):
        story.go_to(wanted)
        dialogue.printer.say(told_step(story.line))
    else:
        story.go_to(len(story.lines) - 1)
        advance(dialogue, wanted - story.at)
        if story.at < wanted and story.result is not None:
            dialogue.printer.tell(f"there is no step {wanted}: the last is {story.at}")


def advance(dialogue: Dialogue, count: int | None) -> None:
    """Advance by `count` steps, or to the end for None, and print each step."""
    story, printer, done = dialogue.story, dialogue.printer, 0

    def announce() -> None:
        """Print how to stop after the first Ctrl-C."""
        with suppress(RuntimeError):  # something is being printed just now
            printer.tell("the step comes to its end first; Ctrl-C once more breaks it off, and it did not happen")

    while done != count:
        with defer_interrupt(announce) as pressed, StepProgress() as progress:
            progress.begin(story.at + 1)
            moved = story.advance()
        if not moved:
            break
        done += 1
        printer.say(told_step(story.line))
        if pressed:
            printer.tell("interrupted")
            return
    if story.result is not None:
        printer.say(told_result(story.result))
    elif done != count or done == 0:
        printer.tell("there are no more steps")


def told_step(line: EpisodeLine) -> str:
    """Return one line about a step: its number, the command before it and the reason of that."""
    why = escape_controls(str(line.get("why", "")), False)
    return f"step {line['step']}: {describe(line.get('action'))}: {why}"


def told_result(result: EpisodeLine) -> str:
    """Return one line about the end of a run."""
    reason = escape_controls(str(result["reason"]), False)
    return f"{result['verdict']} after {result['steps']} steps: {reason}"


def diff(dialogue: Dialogue, rest: str) -> None:
    """Print the facts that hold at only one of two steps."""
    parts, story = rest.removesuffix(".").split(), dialogue.story
    numbers = [whole_number(part) for part in parts[:2]]
    if len(parts) not in (2, 3) or None in numbers:
        dialogue.printer.tell("diff takes the numbers of two steps, and perhaps a word, such as diff 0 3 o1")
        return
    steps = [number for number in numbers if number is not None]
    for number in steps:
        if number >= len(story.lines):
            what = f"there is no step {number} yet: the last is {len(story.lines) - 1}"
            dialogue.printer.tell(f"{what}; goto {number} goes there" if story.result is None else what)
            return
    before, after = (story.facts_at(number) for number in steps)
    word = parts[2] if len(parts) == 3 else ""
    dialogue.printer.say("\n".join(differences(before, after, word)) or "no difference")


def differences(before: Sequence[str], after: Sequence[str], word: str = "") -> list[str]:
    """Return the facts of two steps that hold at one of them alone: `- fact`, `+ fact`, sorted by the fact."""
    old, new = ({fact for fact in facts if not word or names_word(fact, word)} for facts in (before, after))
    changes = sorted((fact, sign) for sign, facts in (("-", old - new), ("+", new - old)) for fact in facts)
    listed = [f"{sign} {fact}" for fact, sign in changes if word or not fact.startswith(OUTLINE_START)]
    if not word:
        counts = Counter(fact[len(OUTLINE_START) :].partition(",")[0] for fact, _ in changes if _is_outline(fact))
        listed += [f"~ {count} pieces of the outline of {node}" for node, count in sorted(counts.items())]
    return listed


def _is_outline(fact: str) -> bool:
    """Return whether a fact is a piece of an outline."""
    return fact.startswith(OUTLINE_START)
