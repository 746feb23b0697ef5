"""An episode as text: of each step the action, the reason, the true table, the plan and the facts that changed."""

from collections.abc import Iterator

from utak.kb.language.diagnostics import BadInputError
from utak.kb.world.stated_plan import ROBOT_STEP_INDENT, stated_plan
from utak.simulator.episode.episode import Episode
from utak.simulator.replay.changes import changes
from utak.simulator.run.story import recorded_story
from utak.simulator.terminal.action_in_words import end_in_words, others_in_words, step_in_words
from utak.simulator.terminal.streams import escape_controls, one_line

MAX_LISTED_FACTS = 40  # facts of one kind of change that a step lists; a convention


def transcript(name: str, episode: Episode) -> Iterator[str]:
    """Yield the text of each step of an episode, and of its end."""
    story = recorded_story(name, episode)
    before: list[str] | None = None
    planned: list[str] = []
    while True:
        line, facts = story.line, [one_line(fact) for fact in story.line["belief"]["facts"]]
        head = step_in_words(line)
        plan = _plan(facts)
        same = bool(plan) and _without_robot(plan) == _without_robot(planned)
        told = [f"plan as before: {plan[0]}", *_robot(plan)] if same else plan  # or that there is none, as before
        head = "\n".join([head, *others_in_words(line)])
        yield "\n".join([head, escape_controls(story.picture()).rstrip("\n"), *told, *_changes(before, facts), "", ""])
        before, planned = facts, plan
        if not story.advance():
            break
    if episode.result is None:
        yield "the episode was cut short here\n"
    else:
        yield f"{end_in_words(episode.result)}\n"


def _plan(facts: list[str]) -> list[str]:
    """Return the lines that tell the task plan of a step, its present step first; [] where it has none."""
    try:
        plan = stated_plan(facts)
    except BadInputError as bad:
        return [f"the facts of the plan are damaged: {one_line(bad.problems[0].what)}"]
    lines = [] if plan is None else [one_line(line) for line in plan.lines()]
    steps = [line for line in lines if line.startswith((">", " "))]
    return [*steps, *(line for line in lines if line not in steps)]


def _robot(plan: list[str]) -> list[str]:
    """Return the lines of a plan that tell the steps of the robot itself."""
    return [line for line in plan if line.startswith(ROBOT_STEP_INDENT)]


def _without_robot(plan: list[str]) -> list[str]:
    """Return the lines of a plan that stay while a step of it is done."""
    return [line for line in plan if not line.startswith(ROBOT_STEP_INDENT)]


def _changes(before: list[str] | None, facts: list[str]) -> Iterator[str]:
    """Yield one line for each fact that changed; None stands for the facts before the first step."""
    if before is None:
        yield f"{len(facts)} facts"
        return
    found = changes(before, facts)
    yield from _listed([f"~ {new}  was {old}" for old, new in found.changed], "changed")
    yield from _listed([f"+ {fact}" for fact in found.added], "added")
    yield from _listed([f"- {fact}" for fact in found.removed], "removed")
    for name, count in found.edges.items():
        yield f"~ outline of {name}: {count} edge{'s' if count > 1 else ''}"


def _listed(rows: list[str], word: str) -> Iterator[str]:
    """Yield the first rows, and how many more there are."""
    yield from rows[:MAX_LISTED_FACTS]
    if len(rows) > MAX_LISTED_FACTS:
        yield f"... {len(rows) - MAX_LISTED_FACTS} more {word}"
