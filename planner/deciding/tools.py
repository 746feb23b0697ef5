"""The stateful parts that one decision uses. The Decider owns them and lends them for the time of a call."""

from typing import NamedTuple

from planner.carrying.plan_executor import PlanExecutor
from planner.deciding.pursuit import Pursuer
from planner.deciding.verification import Verifier


class Tools(NamedTuple):
    """What a transporter or a clearer of obstacles works with while it decides. Neither of them keeps it.

    Attributes
    ----------
    executor : follows manipulation plans.
    pursuer : walks after subgoals.
    verifier : makes sure of what is believed.
    """

    executor: PlanExecutor
    pursuer: Pursuer
    verifier: Verifier
