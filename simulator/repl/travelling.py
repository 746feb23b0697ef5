"""Going through a story: step, back, run, goto; and what changed between two steps."""

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress

from utak.simulator.repl.asking import names_word
from utak.simulator.repl.dialogue import Dialogue
from utak.simulator.replay.changes import is_outline, outlined_node
from utak.simulator.run.interrupts import defer_interrupt
from utak.simulator.scenario.settings import MAX_STEPS
from utak.simulator.terminal.action_in_words import end_in_words, step_in_words
from utak.simulator.terminal.progress import StepProgress


def whole_number(text: str) -> int | None:
    """Return the number that a text denotes, 0 to MAX_STEPS; None for anything else."""
    if text.isascii() and text.isdigit() and len(text) <= 9 and int(text) <= MAX_STEPS:
        return int(text)
    return None


def _count(dialogue: Dialogue, command: str, rest: str) -> int:
    """Return the number of steps that `step` or `back` is given, 1 without one; say what is wrong and return 0."""
    text = rest.removesuffix(".") or "1"
    if count := whole_number(text):
        return count
    dialogue.printer.tell(f"{command} takes a number of steps, not {text[:40]}")
    return 0


def step(dialogue: Dialogue, rest: str) -> None:
    """Go on by one step, or by a number of them."""
    if count := _count(dialogue, "step", rest):
        advance(dialogue, count)


def run(dialogue: Dialogue, rest: str) -> None:
    """Go on to the end."""
    advance(dialogue, None)


def back(dialogue: Dialogue, rest: str) -> None:
    """Go back by one step, or by a number of them."""
    story = dialogue.story
    if not (count := _count(dialogue, "back", rest)):
        return
    if story.at == 0:
        dialogue.printer.tell("this is step 0, the first one")
        return
    story.go_to(max(0, story.at - count))
    dialogue.printer.say(step_in_words(story.line))


def goto(dialogue: Dialogue, rest: str) -> None:
    """Go to a step: back, or on by as many steps as are needed."""
    text, story = rest.removesuffix("."), dialogue.story
    wanted = whole_number(text)
    if wanted is None:
        dialogue.printer.tell(f"goto takes the number of a step, not {text[:40] or 'nothing'}")
    elif wanted < len(story.lines):
        story.go_to(wanted)
        dialogue.printer.say(step_in_words(story.line))
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
        printer.say(step_in_words(story.line))
        if pressed:
            printer.tell("interrupted")
            return
    if story.result is not None:
        printer.say(end_in_words(story.result))
    elif done != count or done == 0:
        printer.tell("there are no more steps")


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
    listed = [f"{sign} {fact}" for fact, sign in changes if word or not is_outline(fact)]
    if not word:
        counts = Counter(outlined_node(fact) for fact, _ in changes if is_outline(fact))
        listed += [f"~ {count} pieces of the outline of {node}" for node, count in sorted(counts.items())]
    return listed
