"""The task: what the user claims and wants, and the things, doors and rooms of the world model that are meant.

Modules in reading order:

task          parameters, claims and goals, read from start.lp and goal.lp
described     measures of what is claimed: where things are at first, their sizes, doors and rooms
binding       the thing, door or room of the world model that each parameter means
pieces        pieces that touch, and may be one thing or several
apart         parts of the floor that no seen floor joins, and those that they may be joined with
stretches     stretches of what bounds the floor that were never felt, and may be things
alternatives  where things may be that mean nothing seen, and what else may be, with their chances

Public names: `Task`, `Parameter`, `Claim`, `read_task`, `task_of`, `reconcile`, `Reconciliation`.
"""
