"""An episode's action as text."""

from typing import Any


def describe(action: dict[str, Any] | None) -> str:
    """Return an action of an episode as text, such as `move(1.5, -2)`; "wake" for None.

    >>> describe({"do": "move", "east": 1.5, "north": -2.0})
    'move(1.5, -2)'
    """
    if action is None:
        return "wake"
    values = [f"{v:g}" if isinstance(v, float) else str(v) for k, v in action.items() if k != "do"]
    return f"{action['do']}({', '.join(values)})" if values else str(action["do"])
