"""The task: what the user claims and wants, and the things, doors and rooms of the world model that are meant.

Modules in reading order:

task          parameters, claims and goals, read from start.lp and goal.lp
described     measures of what is claimed: where things are at first, their sizes, doors and rooms
binding       the thing, door or room of the world model that each parameter means
pieces        pieces that touch, and may be one thing or several
alternatives  where things may be that mean nothing seen, and which pieces are one thing, with their chances

Public names: `Task`, `Parameter`, `Claim`, `read_task`, `task_of`, `reconcile`, `Reconciliation`.
"""
