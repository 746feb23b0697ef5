"""The table of commands, and the small ones."""

from collections.abc import Mapping

from utak.kb.language.diagnostics import did_you_mean
from utak.simulator.repl import asking, changing, explaining, travelling
from utak.simulator.repl.dialogue import QUIT_WORDS, Dialogue, PromptCommand
from utak.simulator.repl.picture import STYLES, draw_belief
from utak.simulator.terminal.action_in_words import TRUE_TABLE_NOTICE

FRAME_NOTICE = """\
In facts, places and lengths are whole hundredths of a square, in the robot's frame: east and north from where it woke,
north being the way it faced then. Confidences are percent. The robot is called utak or org. A query is answered by a
table, yes, no, or don't know: what may hold once more is known. docs/asking.md has all of it."""


def show(dialogue: Dialogue, rest: str) -> None:
    """Print the believed map, or the true table for `show truth`."""
    what = rest.removesuffix(".").strip()
    if what == "truth":
        dialogue.printer.say(f"{TRUE_TABLE_NOTICE}\n{dialogue.story.picture()}".rstrip("\n"))
    elif what:
        hint = did_you_mean(what, ["truth"])
        dialogue.printer.tell(f"show draws what is believed, show truth the true table; {hint}".rstrip("; "))
    else:
        picture = draw_belief(dialogue.story.facts, dialogue.printer.width)
        if picture.rows:
            dialogue.printer.picture(picture.rows, STYLES)
        dialogue.printer.say("\n".join(picture.legend))


def help_(dialogue: Dialogue, rest: str) -> None:
    """Print what there is, or more about one command."""
    name = rest.removesuffix(".").strip()
    usages = {key: (one.usage, one.summary) for key, one in dialogue.commands.items()}
    if command := dialogue.commands.get(name):
        dialogue.printer.say("\n".join(filter(None, (command.usage, command.summary, command.details))))
    elif name in QUIT_WORDS:
        dialogue.printer.say("quit, exit\nleave; so does the end of the input")
    elif name:
        hint = did_you_mean(name, usages) or "help alone lists what there is"
        dialogue.printer.tell(f"there is no command {name[:40]}; {hint}")
    else:
        width = max(len(usage) for usage, _ in usages.values())
        lines = [f"{usage.ljust(width)}  {summary}" for usage, summary in usages.values()]
        lines.append(f"{'quit'.ljust(width)}  leave (so does the end of the input)")
        dialogue.printer.say("\n".join([*lines, "", FRAME_NOTICE]))


# In the order in which `help` lists them.
PROMPT_COMMANDS: Mapping[str, PromptCommand] = {
    "?-": PromptCommand(
        "?- QUERY.",
        "ask what the robot believes: ?- object(X), shape(X, square, C).",
        asking.ask,
        "The body of a rule over the facts at this step. It goes on over lines to its full stop; an empty line ends\n"
        "it, too. Where it begins with an atom, ?- may be left out. Long answers come a page at a time: ; shows more.",
    ),
    ";": PromptCommand(";", "more rows of the last answer, or more facts", asking.more),
    "facts": PromptCommand(
        "facts [WORD]", "the facts at this step; with a word those that name it", asking.facts, "utak and org are one."
    ),
    "since": PromptCommand(
        "since FACT.",
        "since which step the fact holds, and when it held before",
        asking.since,
        "_ stands for any value: since shape(o1, square, _). Any query may stand for the fact.",
    ),
    "worlds": PromptCommand(
        "worlds [N]",
        "the likeliest possible worlds, and what would decide between them",
        asking.worlds,
        "Each is what holds of all that is not settled; those after the first are told by what is otherwise in them.\n"
        "The chance of a fact is the share of the worlds in which it holds (kb/asp/alternatives.lp).",
    ),
    "diff": PromptCommand(
        "diff T1 T2 [WORD]",
        "the facts that hold at only one of two steps",
        travelling.diff,
        "Outlines are only counted, unless a word is given that names them, such as diff 0 3 segment.",
    ),
    "step": PromptCommand("step [N]", "go on by one step, or by N", travelling.step),
    "back": PromptCommand("back [N]", "go back by one step, or by N", travelling.back),
    "run": PromptCommand("run", "go on to the end", travelling.run),
    "goto": PromptCommand("goto T", "go to step T, back or on", travelling.goto),
    "plan": PromptCommand(
        "plan",
        "what is wanted and planned, what the robot does next, and why",
        changing.plan,
        "Of each step of the plan: what it does, the doors on its way, about how many commands it takes, and whether\n"
        "its way is verified over sure floor or only hoped to be free; > marks the present step. Then the cost of the\n"
        "whole plan with its lower bound, and what geometry refuted, and when. The facts say the same:\n"
        "    ?- plan(I, S), takes(I, K), not verified(I).",
    ),
    "goal": PromptCommand(
        "goal FACT.",
        "replace the goals and decide anew from here; alone: list them",
        changing.goal,
        "As in goal.lp, several facts on a line; new parameters as in start.lp:\n"
        "    goal object(y). shape(y, brick). at(utak, y).\n"
        "The impression of this step is interpreted anew. Where things began stays where they were at first.",
    ),
    "assume": PromptCommand(
        "assume FACT.",
        "let a fact or a rule count from here; alone: list what is assumed",
        changing.assume,
        "A fact of a predicate that an encoding knows counts there, as a rule of --kb does: shape(o1, square, 90).\n"
        "What no encoding takes counts for queries alone, and you are told so. Rules are taken, too:\n"
        "    assume kind(R, verge, 60) :- region(R, nonzero, _), extent(R, N), N > 20.\n"
        "A recorded episode is repeated first, as a run.",
    ),
    "retract": PromptCommand("retract FACT.", "take an assumption back from here", changing.retract),
    "show": PromptCommand("show [truth]", "the believed map as a picture; show truth: the true table", show),
    "save": PromptCommand(
        "save FILE",
        "write the episode up to this step",
        changing.save,
        "An episode or an empty file is overwritten, any other file only with save --force FILE. The header of a run\n"
        "that was changed here states the changes; utak run --resume refuses it.",
    ),
    "help": PromptCommand("help [COMMAND]", "this, or more about a command", help_),
    "why": PromptCommand(
        "why [short|long] FACT. | step. | cell N.", "why a fact, this step's command, or a cell", explaining.why
    ),
    "whynot": PromptCommand(
        "whynot [short|long] FACT.", "what is missing for a fact, or in the way", explaining.why_not
    ),
}
