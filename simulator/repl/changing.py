"""Commands that change what counts from this step on: assume, retract, goal; and save."""

import shlex
from pathlib import Path

from utak.kb.world.stated_plan import stated_plan
from utak.simulator.episode.episode import STANDARD_OUTPUT, EpisodeLine, EpisodeLog
from utak.simulator.repl.dialogue import Dialogue
from utak.simulator.repl.travelling import differences
from utak.simulator.run.changes import RunConditions
from utak.simulator.run.story import Story
from utak.simulator.terminal.action_in_words import describe
from utak.simulator.terminal.streams import escape_controls, one_line

MAX_DIFFERENCES_SHOWN = 20  # facts that a change changes, which are printed; a convention


def assume(dialogue: Dialogue, rest: str) -> None:
    """Assume facts or rules from this step on; without any, list what is assumed."""
    if not rest:
        assumed = dialogue.story.conditions.assumptions
        lines = [f"{one.written}  % {told_reach(one.reaches)}" for one in assumed]
        dialogue.printer.say("\n".join(lines) if lines else "nothing is assumed at this step")
        return
    story = dialogue.live_story("assume", rest)
    known = {one.written for one in story.conditions.assumptions}
    after = _change(dialogue, story, "assume", rest)
    for one in after.assumptions:
        if one.written not in known:
            dialogue.printer.say(f"assumed from step {story.at} on: {one.written} It {told_reach(one.reaches)}.")


def retract(dialogue: Dialogue, rest: str) -> None:
    """Take assumptions back from this step on."""
    if not rest:
        dialogue.printer.tell("retract takes an assumption; assume alone lists them")
        return
    story = dialogue.live_story("retract", rest)
    before = {one.written for one in story.conditions.assumptions}
    after = _change(dialogue, story, "retract", rest)
    for written in sorted(before - {one.written for one in after.assumptions}):
        dialogue.printer.say(f"no longer assumed from step {story.at} on: {written}")


def goal(dialogue: Dialogue, rest: str) -> None:
    """Replace the goals from this step on; without any, list them."""
    if not rest:
        dialogue.printer.say("\n".join(f"{fact}." for fact in dialogue.story.conditions.task.goals))
        return
    story = dialogue.live_story("goal", rest)
    after = _change(dialogue, story, "goal", rest)
    dialogue.printer.say(f"wanted from step {story.at} on: {' '.join(f'{fact}.' for fact in after.task.goals)}")
    plan(dialogue, "")


def _change(dialogue: Dialogue, story: Story, kind: str, text: str) -> RunConditions:
    """Change a run; print what is believed otherwise and done otherwise since. Return what counts now."""
    facts, action, before = story.facts, story.next_action, len(story.lines)
    after = story.change(kind, text)
    if len(story.lines) < before:
        left = f"steps {story.at + 1} to {before - 1}" if before - story.at > 2 else f"step {before - 1}"
        dialogue.printer.tell(f"forgotten: {left}; the run goes on otherwise from step {story.at}")
    changed = differences(facts, story.facts)
    for line in changed[:MAX_DIFFERENCES_SHOWN]:
        dialogue.printer.say(line)
    if len(changed) > MAX_DIFFERENCES_SHOWN:
        dialogue.printer.say(f"... and {len(changed) - MAX_DIFFERENCES_SHOWN} more")
    if kind != "goal" and story.next_action != action:
        plan(dialogue, "")
    elif kind != "goal" and not changed:
        dialogue.printer.tell(f"nothing that is believed or done next changes at step {story.at}")
    return after


def told_reach(reaches: tuple[str, ...]) -> str:
    """Return in words where an assumption counts.

    >>> told_reach(("shapes",)), told_reach(())
    ('counts in shapes.lp', 'counts for queries alone')
    """
    return f"counts in {', '.join(f'{name}.lp' for name in reaches)}" if reaches else "counts for queries alone"


def plan(dialogue: Dialogue, rest: str) -> None:
    """Print what is wanted, the task plan with its cost and what was refuted, what is done next and why."""
    story = dialogue.story
    facts = story.facts
    goals = " ".join(f"{fact}." for fact in story.conditions.task.goals)
    lines = [f"wanted: {goals}"]
    bound = [fact for fact in facts if fact.startswith("bound(")]
    lines += [f"meant: {' '.join(bound)}"] if bound else []
    planned = stated_plan(facts)
    lines += (
        [
            "planned:" if planned.found else "not planned:",
            *(f"  {one_line(one)}" for one in planned.lines()),
        ]
        if planned
        else []
    )
    if story.result is not None:
        lines.append(f"the run has ended: {story.result['verdict']}: {escape_controls(str(story.result['reason']))}")
    elif (coming := story.next_action) is None:
        lines.append("what is done next is not known: the episode ends here")
    else:
        action, why = coming
        lines.append(f"next: {'nothing' if action is None else describe(action)}: {one_line(why)}")
    dialogue.printer.say("\n".join([*lines, *_routes(story.line)]))


def _routes(line: EpisodeLine) -> list[str]:
    """Return lines about the routes that were weighed for the next command, where the episode records them."""
    told = []
    for route in line["belief"].get("routes", ()):
        points = " ".join(f"({e:g},{n:g})" for e, n in route["points"])
        told.append(f"{'chosen route' if route['chosen'] else 'other route'}: {points}")
    return told


def save(dialogue: Dialogue, rest: str) -> None:
    """Write the episode up to this step into a file."""
    try:
        words = shlex.split(rest)
    except ValueError:
        words = []
    force = "--force" in words
    names = [word for word in words if word != "--force"]
    if len(names) != 1:
        dialogue.printer.tell("save takes the name of a file, such as save EP.jsonl; --force overwrites any file")
        return
    story = dialogue.story
    path = names[0] if names[0] == STANDARD_OUTPUT else str(Path(names[0]).expanduser())
    lines = [story.header, *story.lines[: story.at + 1]]
    lines += [] if story.result is None else [{"result": story.result}]
    with EpisodeLog(path, force=force) as log:
        for line in lines:
            log.write(line)
    changed = "; its header tells of the changes, and only utak repl goes on from it" if story.changes else ""
    dialogue.printer.tell(f"steps 0 to {story.at} are saved in {one_line(path)}{changed}")
