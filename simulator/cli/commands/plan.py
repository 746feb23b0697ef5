"""`utak plan`: what the robot means to do at a step of a run or of an episode."""

import argparse
import sys

from utak.kb.language.diagnostics import BadInputError
from utak.kb.world.stated_plan import StatedPlan, stated_plan
from utak.simulator.cli.commands.given import given_story, go_to
from utak.simulator.run.story import Story
from utak.simulator.terminal import exits
from utak.simulator.terminal.printing import as_json
from utak.simulator.terminal.streams import escape_controls, one_line


def execute(options: argparse.Namespace) -> int:
    """Go to the step and print its plan."""
    story = given_story(options)
    if options.at is not None:
        go_to(story, options.story, options.at)
        plan = plan_of(story, options.story)
    else:
        plan = _found(story, options.story)
    step = story.at
    if options.json:
        print(as_json({"step": step, "plan": None if plan is None else plan.as_dict()}))
    elif plan is not None:
        print(escape_controls("\n".join([f"step {step}", *plan.lines()])))
    if plan is None or not plan.found:
        print(_absence(story, options.at, plan), file=sys.stderr)
        return exits.NOT_REACHED
    return exits.SUCCESS


def plan_of(story: Story, name: str) -> StatedPlan | None:
    """Return the plan at the current step of a story; None when there is none."""
    try:
        return stated_plan(story.facts)
    except BadInputError as bad:
        first = bad.problems[0]
        what = f"belief.facts, a fact of the plan: {first.what}: the episode is damaged"
        raise BadInputError.at(name, what, first.hint, story.at + 2) from None


def _found(story: Story, name: str) -> StatedPlan | None:
    """Return a plan for all goals that has steps: the first one of a run, the last one of an episode."""
    if story.is_recorded:
        last = len(story.lines) - 1
        for step in range(last, -1, -1):
            story.go_to(step)
            if (plan := plan_of(story, name)) is not None and plan.found and plan.steps:
                return plan
        story.go_to(last)
        return plan_of(story, name)
    while ((plan := plan_of(story, name)) is None or not (plan.found and plan.steps)) and story.advance():
        pass
    return plan


def _absence(story: Story, asked: int | None, plan: StatedPlan | None) -> str:
    """Return in words that there is no plan, and why where that is known."""
    what = "no step has a plan" if asked is None else f"step {story.at} has no plan"
    what += " that attains all goals" if plan is not None and plan.steps else ""
    if story.result is not None:
        return f"utak plan: {what}; {story.result['verdict']}: {one_line(str(story.result['reason']))}"
    return f"utak plan: {what}"
