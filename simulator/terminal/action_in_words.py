"""Lines of an episode as text: its actions, steps and end."""

from typing import Any

from utak.simulator.terminal.streams import one_line

TRUE_TABLE_NOTICE = "the true table, which the robot may believe to be otherwise:"  # above every picture of the truth


def describe(action: dict[str, Any] | None) -> str:
    """Return an action of an episode as text, such as `move(1.5, -2)`; "wake" for None.

    >>> describe({"do": "move", "east": 1.5, "north": -2.0})
    'move(1.5, -2)'
    """
    if action is None:
        return "wake"
    values = [f"{v:g}" if isinstance(v, float) else str(v) for k, v in action.items() if k != "do"]
    return f"{action['do']}({', '.join(values)})" if values else str(action["do"])


def step_in_words(line: dict[str, Any]) -> str:
    """Return a step of an episode in one line: its number, its action and its reason."""
    return f"step {line['step']}: {describe(line['action'])}: {one_line(str(line['why']))}"


def others_in_words(line: dict[str, Any]) -> list[str]:
    """Return what others did before the command of a step, and what they could not do; a line for each kind."""
    done = ", ".join(line.get("disturbed", ()))
    told = [f"before it others put elsewhere: {done}"] if done else []
    return told + [f"not disturbed: {one_line(fact)}: {one_line(why)}" for fact, why in line.get("refused", {}).items()]


def end_in_words(result: dict[str, Any]) -> str:
    """Return the end of a run in one line."""
    return f"{result['verdict']} after {result['steps']} steps: {one_line(str(result['reason']))}"


def truth_in_words(achieved: bool | None, words: str = "achieved") -> str:
    """Return what is said of the truth behind a verdict; "" where nothing is expected of it."""
    return {None: "", True: f", {words}", False: ", not achieved"}[achieved]
