"""The agenda: which activity comes next for the present stage of a task, and with which verdict the robot gives up.

decider       stages of the task, one after the other
activities    what the robot does next for a stage, and what came of that
choice        planner/asp/deciding/activities.lp asked: the next activity, or the end
own_goals     where the robot itself shall be
blame         the constraints that leave no way

Public names: Decider.
"""
