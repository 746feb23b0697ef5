"""The kind of a subgoal: what the robot wants at the squares that it walks to."""

from enum import StrEnum


class SubgoalKind(StrEnum):
    """The purpose of a subgoal. The values are the constants of `aim/3` in planner/asp/deciding/subgoals.lp."""

    ATTAIN = "attain"  # the goal of the present stage holds at the squares
    INSPECT = "inspect"  # from the squares the robot sees or feels an object that may be the wanted one
    EXPLORE = "explore"  # the squares are a frontier: they border on squares that were never seen
    PASS = "pass"  # the way to the squares leads over squares that are only assumed to be free
    SETTLE = "settle"  # from the squares the robot sees a boundary of the floor that was seen coarsely
    FEEL = "feel"  # from the squares the robot feels walls that may be things
