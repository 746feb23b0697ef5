"""The task plan: what is brought where, in which order; chosen by planner/asp/task, verified by geometry.

setting       problem_of: the problem of a stage, from what is believed
task_plan     TaskPlan, Errand, RefutedStep: the values
history       DoneErrands: what was done before a plan is made
facts         the facts of the encoding
offers        Offers: places for things that are in the way
rule_effects  doors that users' rules close, and rules that leave no plan
proposal      propose: one answer of the encoding
settling      the plan where something is open: found, seen, felt or moved away
search        make_plan: the encoding proposes, geometry verifies or refutes
intention     Intention: the plan under way, kept while it holds
"""
