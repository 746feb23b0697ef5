"""`utak plan`: what the robot means to do at a step of a run or of an episode."""

import argparse
import sys
from typing import TYPE_CHECKING, Any

from utak.simulator.cli.commands.query import go_to, step_number
from utak.simulator.cli.commands.run import add_settings, settings_of
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.printing import as_json
from utak.simulator.terminal.streams import escape_controls

if TYPE_CHECKING:
    from utak.kb.world.stated_plan import StatedPlan
    from utak.simulator.run.live_story import LiveStory
    from utak.simulator.run.recorded_story import RecordedStory


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser(
        "plan",
        help="show what the robot means to do: the task plan of a step",
        description="Show the task plan: its steps with their cost and what geometry says of each, the lower bound, "
        "and what was refuted.",
        epilog="Of a scenario, without --at, the robot runs until it has a plan or a verdict; of an episode the last "
        "plan that has steps left is shown. Where no plan attains all goals, those that none attains, what was refuted "
        "and the steps that settle what is open are shown as far as they are known, and the exit code is 1.",
    )
    part.add_argument("story", metavar="SCENARIO|EP.jsonl", help="a scenario folder, which is run, or an episode")
    part.add_argument("--at", type=step_number, metavar="STEP", help="the step whose plan is shown (0: on waking)")
    part.add_argument("--json", action="store_true", help="print the plan as one JSON object")
    add_settings(part)
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Go to the step and print its plan."""
    from utak.simulator.run.story import open_story

    refuse_links(options, options.story)
    story = open_story(options.story, settings_of(options))
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


def plan_of(story: "LiveStory | RecordedStory", name: str) -> "StatedPlan | None":
    """Return the plan at the current step of a story; None when there is none."""
    from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
    from utak.kb.world.stated_plan import stated_plan

    try:
        return stated_plan(story.facts)
    except BadInputError as bad:
        first = bad.problems[0]
        what = f"belief.facts, a fact of the plan: {first.what}: the episode is damaged"
        raise BadInputError([Problem(name, SourceSpan(story.at + 2, 1, 1), what, hint=first.hint)]) from None


def _found(story: "LiveStory | RecordedStory", name: str) -> "StatedPlan | None":
    """Return a plan for all goals that has steps: the first one of a run, the last one of an episode."""
    from utak.simulator.run.recorded_story import RecordedStory

    if isinstance(story, RecordedStory):
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


def _absence(story: "LiveStory | RecordedStory", asked: int | None, plan: "StatedPlan | None") -> str:
    """Return in words that there is no plan, and why where that is known."""
    what = "no step has a plan" if asked is None else f"step {story.at} has no plan"
    what += " that attains all goals" if plan is not None and plan.steps else ""
    if story.result is not None:
        return f"utak plan: {what}; {story.result['verdict']}: {escape_controls(str(story.result['reason']), False)}"
    return f"utak plan: {what}"
