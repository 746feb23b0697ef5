"""Utak from Python: scenarios, runs and episodes, what the robot believes, and other minds in its body.

    import utak
    scenario = utak.Scenario.read("examples/go_next_room")
    run = utak.Run(scenario)
    episode = run.finish()
    episode[2].world.query("shape(X, square, C)")

Nothing is loaded before a name is used, so `import utak` takes a few milliseconds.

Modules in reading order:

scenario    a world with a task, from a folder or from texts
run         the robot in a scenario, step by step; forks of a run
mind        another mind in the same body
episode     the record of a run, and its steps
beliefs     what is believed after a step, and the answers to questions about it
errors      what is raised besides ValueError and TypeError
explaining  why something is believed or was done
markup      tables and captions for notebooks, as HTML
gym         TABLETOP as a Gymnasium environment (extra `gym`)
"""

from importlib import import_module

TYPE_CHECKING = False  # not imported from typing, which takes most of the time of `import utak`
if TYPE_CHECKING:
    from kb.body import Grasp, Impression, Move, Push, Release, Turn
    from kb.language.diagnostics import BadInputError, CannotOpenError
    from kb.reasoning.query import QueryLimitError
    from utak.beliefs import Answer, World
    from utak.episode import Episode, Step
    from utak.errors import RunNotRepeatedError
    from utak.explaining import ReasonTree
    from utak.mind import Mind, Verdict
    from utak.run import Plan, Run
    from utak.scenario import Scenario

__all__ = [
    "Answer",
    "BadInputError",
    "CannotOpenError",
    "Episode",
    "Grasp",
    "Impression",
    "Mind",
    "Move",
    "Plan",
    "Push",
    "QueryLimitError",
    "ReasonTree",
    "Release",
    "Run",
    "RunNotRepeatedError",
    "Scenario",
    "Step",
    "Turn",
    "Verdict",
    "World",
]

_MODULES = {
    **dict.fromkeys(("Grasp", "Impression", "Move", "Push", "Release", "Turn"), "kb.body"),
    **dict.fromkeys(("BadInputError", "CannotOpenError"), "kb.language.diagnostics"),
    "QueryLimitError": "kb.reasoning.query",
    **dict.fromkeys(("Answer", "World"), "utak.beliefs"),
    **dict.fromkeys(("Episode", "Step"), "utak.episode"),
    "ReasonTree": "utak.explaining",
    "RunNotRepeatedError": "utak.errors",
    **dict.fromkeys(("Mind", "Verdict"), "utak.mind"),
    **dict.fromkeys(("Plan", "Run"), "utak.run"),
    "Scenario": "utak.scenario",
}


if not TYPE_CHECKING:  # so that type checkers know the public names and no others

    def __getattr__(name: str) -> object:
        """Return a public name; its module is imported when the name is first used."""
        if name not in _MODULES:
            raise AttributeError(f"module 'utak' has no attribute {name!r}")
        try:
            value = getattr(import_module(_MODULES[name]), name)
        except ImportError as error:
            foreign = _foreign_package()
            if foreign:
                raise ImportError(
                    f"utak needs its own package of this name, and Python finds {foreign} first"
                ) from error
            raise
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted({*globals(), *__all__})


def _foreign_package() -> str:
    """Return the file of a package that is not Utak's, although it bears the name of one of Utak's; "" without any."""
    from importlib.util import find_spec
    from pathlib import Path

    home = Path(__file__).resolve().parent.parent
    for name in ("geometry", "kb", "planner", "simulator"):
        spec = find_spec(name)
        places = (
            [spec.origin]
            if spec is not None and spec.origin
            else list(getattr(spec, "submodule_search_locations", None) or ())
        )
        if places and not Path(places[0]).resolve().is_relative_to(home / name):
            return places[0]
    return ""
