"""The kinds of subgoals, as planner/asp/aims.lp and planner.screen.moves know them."""

from enum import StrEnum


class SubgoalKind(StrEnum):
    """What a subgoal is for.

    Attributes
    ----------
    ATTAIN : reach a place where the goal holds.
    INSPECT : look closely at, or feel, something that was seen.
    EXPLORE : look where the floor borders on squares that were never seen.
    PASS : try a passage that is only assumed.
    SETTLE : look closely at a boundary of the floor that was seen coarsely.
    """

    ATTAIN = "attain"
    INSPECT = "inspect"
    EXPLORE = "explore"
    PASS = "pass"
    SETTLE = "settle"
