"""Utak from Python: scenarios, runs and episodes, what the robot believes, and other minds in its body.

    import utak
    scenario = utak.Scenario.read("examples/go_next_room")
    run = utak.Run(scenario)
    episode = run.finish()
    episode[2].world.query("shape(X, square, C)")

Nothing is loaded before a name is used, so `import utak` takes a few milliseconds.

Modules in reading order:

scenario       a world with a task, from a folder or from texts
run            the robot in a scenario, step by step; forks of a run
mind           another mind in the same body
episode        the record of a run, and its steps
beliefs        what is believed after a step, and the answers to questions about it
explaining     why something is believed or was done
markup         tables and captions for notebooks, as HTML
gym            TABLETOP as a Gymnasium environment (extra `gym`)
launcher       the starting point of the command and of its processes
pytest_plugin  scenario folders as tests of pytest
"""

import os
from importlib import import_module

# Installed, `geometry`, `kb`, `planner` and `simulator` lie within this package. In a checkout they lie beside it.
if not os.path.isdir(os.path.join(__path__[0], "kb")):  # noqa: PTH112, PTH118
    __path__.append(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))  # noqa: PTH100, PTH120

TYPE_CHECKING = False  # not imported from typing, which takes most of the time of `import utak`
if TYPE_CHECKING:
    from utak.beliefs import Answer as Answer, World as World
    from utak.episode import Episode as Episode, Step as Step
    from utak.explaining import ReasonTree as ReasonTree
    from utak.kb.body import (
        Grasp as Grasp,
        Impression as Impression,
        Move as Move,
        Push as Push,
        Release as Release,
        Turn as Turn,
    )
    from utak.kb.language.diagnostics import BadInputError as BadInputError, CannotOpenError as CannotOpenError
    from utak.kb.reasoning.query import QueryLimitError as QueryLimitError
    from utak.mind import Mind as Mind, Verdict as Verdict
    from utak.run import Plan as Plan, Run as Run
    from utak.scenario import Scenario as Scenario
    from utak.simulator.certificates.search import NoCertificateError as NoCertificateError
    from utak.simulator.run.session import RunNotRepeatedError as RunNotRepeatedError

_MODULES = {
    **dict.fromkeys(("Grasp", "Impression", "Move", "Push", "Release", "Turn"), "utak.kb.body"),
    **dict.fromkeys(("BadInputError", "CannotOpenError"), "utak.kb.language.diagnostics"),
    "QueryLimitError": "utak.kb.reasoning.query",
    **dict.fromkeys(("Answer", "World"), "utak.beliefs"),
    **dict.fromkeys(("Episode", "Step"), "utak.episode"),
    "ReasonTree": "utak.explaining",
    "NoCertificateError": "utak.simulator.certificates.search",
    "RunNotRepeatedError": "utak.simulator.run.session",
    **dict.fromkeys(("Mind", "Verdict"), "utak.mind"),
    **dict.fromkeys(("Plan", "Run"), "utak.run"),
    "Scenario": "utak.scenario",
}
__all__ = sorted(_MODULES)


if not TYPE_CHECKING:  # so that type checkers know the public names and no others

    def __getattr__(name: str) -> object:
        """Return a public name; its module is imported when the name is first used."""
        if name not in _MODULES:
            raise AttributeError(f"module 'utak' has no attribute {name!r}")
        value = getattr(import_module(_MODULES[name]), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted({*globals(), *__all__})
