"""The task: what the user claims and wants, and the objects of the world model that are meant.

Modules in reading order:

task     parameters, claims and goals, read from start.lp and goal.lp
binding  the object of the world model that each parameter means

Public names: `Task`, `Parameter`, `Claim`, `read_task`, `task_of`, `reconcile`, `Reconciliation`.
"""
