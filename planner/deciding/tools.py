"""The stateful parts that one decision uses. The Decider owns them and lends them for the time of a call."""

from typing import NamedTuple

from planner.carrying.plan_executor import PlanExecutor
from planner.deciding.pursuit import Pursuer
from planner.deciding.verification import Verifier


class Tools(NamedTuple):
    """The tools of a transporter or a clearer of obstacles while it decides. Neither of them keeps them.

    Attributes
    ----------
    executor : follows manipulation plans, and remembers the one under way.
    pursuer : walks after subgoals, and remembers the present route.
    verifier : makes sure of what is believed, and remembers what was looked at for that.
    """

    executor: PlanExecutor
    pursuer: Pursuer
    verifier: Verifier
